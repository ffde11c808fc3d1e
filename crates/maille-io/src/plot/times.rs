//! Wall time of each limit.

use super::compare::differences;
use super::effort::{Effort, svg};
use super::frame::Layout;
use crate::record::NamedRecord;
use maille::record::LimitRow;

/// The plot of one record or several, as SVG.
pub fn times_svg(records: &[NamedRecord], layout: Layout) -> String {
    let labels = differences(records).1;
    let total = |(named, label): (&NamedRecord, &String)| {
        let total: f64 = named.record.rows.iter().map(|row| row.wall_s).sum();
        format!("{label} {total:.3} s")
    };
    let totals: Vec<String> = records.iter().zip(&labels).map(total).collect();
    let caption = vec![
        format!("Sum over all limits: {}.", totals.join("  ·  ")),
        "Times depend on the machine, on its load and on the number of threads. Images of other directions take none."
            .into(),
    ];
    // The time of an image is that of writing it.
    let of = |row: &LimitRow| if row.image_of_deg.is_some() { 0.0 } else { row.wall_s };
    svg(records, Effort { subtitle: "Wall time of each limit", axis: "Wall time in seconds", of, caption }, layout)
}
