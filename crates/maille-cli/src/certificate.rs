//! A certificate on the screen and in JSON.

use maille::solver::certificate::Certificate;

/// One line of what was checked.
pub fn line(c: &Certificate) -> String {
    let curvature = c.min_curvature.map_or("none free".into(), |x| format!("least curvature {x:.2e}"));
    format!("smallest gap {:.1e}, residual {:.1e}, {curvature}", c.smallest_gap, c.dual_residual)
}
