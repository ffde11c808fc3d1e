//! A certificate on the screen and in JSON.

use maille::solve::certificate::Certificate;
use serde_json::{Value, json};

/// One line of what was checked.
pub fn line(c: &Certificate) -> String {
    let curvature = c.min_curvature.map_or("none free".into(), |x| format!("least curvature {x:.2e}"));
    format!("smallest gap {:.1e}, residual {:.1e}, {curvature}", c.smallest_gap, c.dual_residual)
}

/// Its figures, `null` where one is not finite; the gap in the file's unit, of which R is `unit`.
pub fn json(c: &Certificate, unit: f64) -> Value {
    let finite = |x: f64| x.is_finite().then_some(x);
    json!({
        "smallest_gap": finite(c.smallest_gap * unit),
        "dual_residual": finite(c.dual_residual),
        "complementarity": finite(c.complementarity),
        "min_multiplier": finite(c.min_multiplier),
        "min_curvature": c.min_curvature.and_then(finite),
        "zero_modes": c.zero_modes,
    })
}
