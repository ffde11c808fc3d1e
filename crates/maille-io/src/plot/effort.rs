//! What limits cost, against the direction of the pull: iterations of the solver, or wall time.

use super::chart::{Chart, Point, Series};
use super::compare::{captions, differences, l2_values, title};
use super::frame::{Frame, Layout};
use super::records::Looks;
use super::scale::Axis;
use crate::record::NamedRecord;
use maille::record::LimitRow;

/// A cost of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Iterations of the solver.
    Steps,
    /// Wall time.
    WallTime,
}

impl Cost {
    fn of(self, row: &LimitRow) -> f64 {
        match self {
            Cost::Steps => row.iterations as f64,
            // The time of an image is that of writing it.
            Cost::WallTime if row.image_of_deg.is_some() => 0.0,
            Cost::WallTime => row.wall_s,
        }
    }

    fn subtitle(self) -> &'static str {
        match self {
            Cost::Steps => "Iterations of the solver for each limit",
            Cost::WallTime => "Wall time of each limit",
        }
    }

    /// Name and unit of the axis.
    fn axis(self) -> &'static str {
        match self {
            Cost::Steps => "Iterations",
            Cost::WallTime => "Wall time in seconds",
        }
    }

    /// Further paragraphs of the caption.
    fn caption(self, records: &[NamedRecord], labels: &[String]) -> Vec<String> {
        match self {
            Cost::Steps => {
                let of_method =
                    |method: &str| records.iter().any(|n| n.record.rows.iter().any(|row| row.method == method));
                let words = [
                    ("exact", "Exact method: quadratic programs, of all starts of a limit."),
                    ("energy", "Energy method: Newton iterations, of all minimisations of a limit."),
                ];
                words.into_iter().filter(|(method, _)| of_method(method)).map(|(_, words)| words.into()).collect()
            }
            Cost::WallTime => {
                let total = |(named, label): (&NamedRecord, &String)| {
                    let total: f64 = named.record.rows.iter().map(|row| row.wall_s).sum();
                    format!("{label} {total:.3} s")
                };
                let totals: Vec<String> = records.iter().zip(labels).map(total).collect();
                vec![
                    format!("Sum over all limits: {}.", totals.join("  ·  ")),
                    "Times depend on the machine, on its load and on the number of threads.".into(),
                ]
            }
        }
    }
}

/// The plot of one record or several, as SVG.
pub fn cost_svg(records: &[NamedRecord], cost: Cost, layout: Layout) -> String {
    let apart = differences(records);
    let rows = || records.iter().flat_map(|named| &named.record.rows);
    let values: Vec<f64> = rows().map(|row| cost.of(row)).collect();
    let y = Axis::of_effort(&values);
    let looks = Looks::new(records.len(), l2_values(rows()));
    let mut series = Vec::new();
    for (i, named) in records.iter().enumerate() {
        for (k, l2) in looks.l2.iter().enumerate() {
            let of_l2 = named.record.rows.iter().filter(|row| row.l2 == *l2);
            let mut points: Vec<Point> =
                of_l2.map(|row| Point { x: row.direction_deg, y: y.shown(cost.of(row)), hollow: false }).collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            if !points.is_empty() {
                series.push(Series { look: looks.of(i, k), points });
            }
        }
    }
    let mut caption = captions(records, &apart.1);
    caption.extend(cost.caption(records, &apart.1));
    let nothing = values.iter().filter(|value| **value <= 0.0).count();
    if y.is_logarithmic() && nothing > 0 {
        caption.push(format!("Not shown: {nothing} of {} limits that took none.", values.len()));
    }
    let directions: Vec<f64> = rows().map(|row| row.direction_deg).collect();
    let frame =
        Frame { title: title(records), subtitle: cost.subtitle().into(), legend: looks.full_legend(&apart), caption };
    let names = ["Direction of the pull, counter-clockwise from x".into(), format!("{}{}", cost.axis(), y.words())];
    let axes = [Axis::of_directions(&directions), y];
    Chart { gap: "took none: image of another direction", ..Chart::of_lines(frame, axes, names, series) }.svg(layout)
}
