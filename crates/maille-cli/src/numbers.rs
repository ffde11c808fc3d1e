//! Numbers on the command line.

use maille::lattice::Cell;
pub use maille_io::numbers::{Numbers, parse, parse_l2};

/// A positive finite number.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err(format!("\"{text}\" is not a positive number")),
    }
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("\"{text}\" is not a number")),
    }
}

/// A cell, as 2x1 or "1,0;-1,2".
pub fn parse_cell(text: &str) -> Result<Cell, String> {
    text.parse().map_err(|e: maille::error::InvalidInput| format!("{}; {}", e.problem, e.help))
}
