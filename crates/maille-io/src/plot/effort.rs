//! What limits cost, against the direction of the pull: the common part of the plots of steps and of times.

use super::chart::{Chart, Point, Series, sample};
use super::compare::{captions, differences, l2_label, l2_values, title};
use super::frame::{Entry, Frame, INK, Layout};
use super::look::{self, Look};
use super::scale::Axis;
use crate::record::NamedRecord;
use maille::record::LimitRow;

/// A cost of a limit.
pub(super) struct Effort {
    pub(super) subtitle: &'static str,
    /// Name and unit of the axis.
    pub(super) axis: &'static str,
    pub(super) of: fn(&LimitRow) -> f64,
    /// Further paragraphs of the caption.
    pub(super) caption: Vec<String>,
}

pub(super) fn svg(records: &[NamedRecord], effort: Effort, layout: Layout) -> String {
    let (apart, labels) = differences(records);
    let rows = || records.iter().flat_map(|named| &named.record.rows);
    let values: Vec<f64> = rows().map(effort.of).collect();
    let y = Axis::of_effort(&values);
    let l2 = l2_values(rows());
    let (of_l2, of_record) = (look::of_l2(&l2), look::of_records(records.len()));
    // By l2 alone, or, with several records, line and colour by its record and marker by its l2.
    let look = |record: usize, k: usize| match (records.len(), l2.len()) {
        (1, _) => of_l2[k].clone(),
        (_, 1) => of_record[record].clone(),
        _ => of_record[record].with_l2(&of_l2[k]),
    };
    let mut series = Vec::new();
    for (i, named) in records.iter().enumerate() {
        for (k, l2) in l2.iter().enumerate() {
            let of_l2 = named.record.rows.iter().filter(|row| row.l2 == *l2);
            // Nothing at all has no place on a logarithmic axis.
            let value = |row| Some((effort.of)(row)).filter(|y_value| !y.is_logarithmic() || *y_value > 0.0);
            let mut points: Vec<Point> =
                of_l2.map(|row| Point { x: row.direction_deg, y: value(row), hollow: false }).collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            if !points.is_empty() {
                series.push(Series { look: look(i, k), points });
            }
        }
    }
    let mut legend = Vec::new();
    if records.len() > 1 {
        legend.push(Entry::Heading(apart));
        legend.extend(labels.iter().zip(&of_record).map(|(label, look)| sample(look, true, l2.len() == 1, label)));
    }
    if let ([only], true) = (&l2[..], records.len() > 1) {
        legend.push(Entry::Heading(format!("l₂ = {}", l2_label(*only))));
    } else {
        legend.push(Entry::Heading("l₂ across the pull".into()));
        legend.extend(l2.iter().zip(&of_l2).map(|(l2, look)| match records.len() {
            1 => sample(look, true, true, &l2_label(*l2)),
            _ => sample(&Look { color: INK.into(), ..look.clone() }, false, true, &l2_label(*l2)),
        }));
    }
    let mut caption = captions(records, &labels);
    caption.extend(effort.caption);
    let nothing = values.iter().filter(|value| **value <= 0.0).count();
    if y.is_logarithmic() && nothing > 0 {
        caption.push(format!("Not shown: {nothing} of {} limits that took none.", values.len()));
    }
    let directions: Vec<f64> = rows().map(|row| row.direction_deg).collect();
    let scale = if y.is_logarithmic() { ", logarithmic" } else { "" };
    Chart {
        frame: Frame { title: title(records), subtitle: effort.subtitle.into(), legend, caption },
        x: Axis::of_directions(&directions),
        names: ["Direction of the pull, counter-clockwise from x".into(), format!("{}{scale}", effort.axis)],
        y,
        series,
        bands: Vec::new(),
    }
    .svg(layout)
}
