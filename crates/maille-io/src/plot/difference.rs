//! How much the limits of a sheet differ between directions: largest less smallest, against l2.

use super::chart::{Chart, Point, Series, hollow_note, legend_of_records};
use super::compare::{captions, differences, l2_values, title};
use super::frame::{Frame, Layout};
use super::look;
use super::scale::{Axis, range};
use crate::{quantity::Quantity, record::NamedRecord};
use maille::record::LimitRow;

/// The plot of one record or several, as SVG.
pub fn difference_svg(records: &[NamedRecord], quantity: Quantity, layout: Layout) -> String {
    // Of 1 + l1 and of l1 the difference is the same.
    let spread = if quantity == Quantity::Stretch { Quantity::L1 } else { quantity };
    let (apart, labels) = differences(records);
    let looks = look::of_records(records.len());
    let series: Vec<Series> = records
        .iter()
        .zip(&looks)
        .map(|(named, look)| {
            let rows = &named.record.rows;
            let points = l2_values(rows.iter()).into_iter().map(|l2| point(rows, l2, spread)).collect();
            Series { look: look.clone(), points }
        })
        .collect();
    let points = || series.iter().flat_map(|series| &series.points);
    let mut legend = legend_of_records(apart, &labels);
    let mut caption = captions(records, &labels);
    if points().any(|point| point.hollow) {
        legend.push(hollow_note("some directions have no limit"));
    }
    if spread == Quantity::Lambda1 {
        caption.push("λ₁ is the larger eigenvalue of C = FᵀF; where l₁ < l₂ it is the one across the pull.".into());
    }
    caption.push("0 would be a sheet that locks at the same stretch in every direction that was computed.".into());
    let l2 = l2_values(records.iter().flat_map(|named| &named.record.rows));
    let frame = Frame {
        title: title(records),
        subtitle: "How much the limit depends on the direction of the pull, for each l₂".into(),
        legend,
        caption,
    };
    let axes = [Axis::of_l2(&l2), Axis::linear(points().filter_map(|point| point.y))];
    let names = [
        "l₂, stretch held across the pull, less 1".into(),
        format!("Largest less smallest {} of all directions", spread.symbol()),
    ];
    Chart { gap: "fewer than two directions have a limit", ..Chart::of_lines(frame, axes, names, series) }.svg(layout)
}

/// Nothing where fewer than two directions have a limit; hollow where only some have.
fn point(rows: &[LimitRow], l2: f64, spread: Quantity) -> Point {
    let of_l2 = || rows.iter().filter(|row| row.l2 == l2);
    let found: Vec<f64> = of_l2().filter_map(|row| spread.of(row)).collect();
    let (min, max) = range(found.iter().copied());
    Point { x: l2, y: (found.len() > 1).then_some(max - min), hollow: found.len() < of_l2().count() }
}
