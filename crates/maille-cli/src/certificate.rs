//! What an answer rests on, on the screen.

use crate::output::counted;
use maille::{answer::Answer, solver::certificate::Certificate};

/// What the search came to.
pub fn search(found: &Answer) -> String {
    let (starts, distinct) = (found.n_starts.unwrap_or(0), found.n_distinct.unwrap_or(0));
    let kept = if found.links_ok == Some(true) { "kept" } else { "LOST" };
    format!(
        "{} led to {}; links {kept}",
        counted(starts as usize, "start"),
        counted(distinct as usize, "certified value")
    )
}

/// One line of what was checked.
pub fn line(c: &Certificate) -> String {
    let curvature = c.min_curvature.map_or("none free".into(), |x| format!("least curvature {x:.2e}"));
    format!("smallest gap {:.1e}, residual {:.1e}, {curvature}", c.smallest_gap, c.dual_residual)
}
