//! Iterations of the solver for each limit.

use super::effort::{Effort, svg};
use super::frame::Layout;
use crate::record::NamedRecord;

/// The plot of one record or several, as SVG.
pub fn steps_svg(records: &[NamedRecord], layout: Layout) -> String {
    let of_method = |method: &str| records.iter().any(|n| n.record.rows.iter().any(|row| row.method == method));
    let mut caption = Vec::new();
    if of_method("exact") {
        caption.push("Exact method: quadratic programs, of all starts of a limit.".into());
    }
    if of_method("energy") {
        caption.push("Energy method: Newton iterations, of all minimisations of a limit.".into());
    }
    svg(
        records,
        Effort {
            subtitle: "Iterations of the solver for each limit",
            axis: "Iterations",
            of: |row| row.iterations as f64,
            caption,
        },
        layout,
    )
}
