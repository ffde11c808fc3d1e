//! The kinematic Poisson ratio ν = −ln(1 + l2)/ln(1 + l1) at the limits with free width, against the direction of the pull.
//!
//! At a limit the width need not be unique: the ratio is a band between the values of the largest and the least l2.

use super::chart::{Chart, Point, Series, legend_of_records};
use super::compare::{captions, differences, title};
use super::frame::{Frame, Layout};
use super::look;
use super::scale::Axis;
use crate::record::NamedRecord;
use maille::record::LimitRow;

/// Below this l1 the ratio of the logarithms says nothing.
const LEAST_L1: f64 = 1e-4;

/// Least and largest ratio of a row, where its width was free.
fn ratios(row: &LimitRow) -> Option<[f64; 2]> {
    let (l1, least, most) = (row.l1?, row.l2_min?, row.l2_max?);
    let free = row.lateral.as_deref() == Some("free") && l1 > LEAST_L1 && least > -1.0;
    free.then(|| [most, least].map(|l2| -l2.ln_1p() / l1.ln_1p()))
}

/// The plot of one record or several, as SVG; `None` where no limit has a free width.
pub fn poisson_svg(records: &[NamedRecord], layout: Layout) -> Option<String> {
    let (apart, labels) = differences(records);
    let looks = look::of_records(records.len());
    let (mut series, mut bands) = (Vec::new(), Vec::new());
    for (named, look) in records.iter().zip(&looks) {
        let mut rows: Vec<&LimitRow> = named.record.rows.iter().collect();
        rows.sort_by(|a, b| a.direction_deg.total_cmp(&b.direction_deg));
        let ends = |k: usize| {
            let point = |row: &&LimitRow| Point { x: row.direction_deg, y: ratios(row).map(|r| r[k]), hollow: false };
            rows.iter().map(point).collect::<Vec<_>>()
        };
        let [least, most] = [ends(0), ends(1)];
        // A gap in the limits is a gap in the band.
        let runs = least.split(|p| p.y.is_none()).zip(most.split(|p| p.y.is_none()));
        for (low, high) in runs.filter(|(low, _)| !low.is_empty()) {
            let around = low.iter().chain(high.iter().rev()).copied().collect();
            bands.push((around, format!("{}40", look.color)));
        }
        series.extend([least, most].map(|points| Series { look: look.clone(), points }));
    }
    let values: Vec<f64> = series.iter().flat_map(|s| &s.points).filter_map(|point| point.y).collect();
    if values.is_empty() {
        return None;
    }
    let mut caption = captions(records, &labels);
    caption.push("Where the two curves of a record part, the width at the limit is not unique: the sheet was found at both ends.".into());
    let directions: Vec<f64> = records.iter().flat_map(|n| &n.record.rows).map(|row| row.direction_deg).collect();
    let chart = Chart {
        frame: Frame {
            title: title(records),
            subtitle: "Kinematic Poisson ratio at the limit, width left to the sheet".into(),
            legend: legend_of_records(apart, &labels),
            caption,
        },
        x: Axis::of_directions(&directions),
        y: Axis::linear(values.into_iter()),
        names: [
            "Direction of the pull, counter-clockwise from x".into(),
            "ν = −ln(1 + l₂)/ln(1 + l₁) (no unit)".into(),
        ],
        series,
        bands,
    };
    Some(chart.svg(layout))
}
