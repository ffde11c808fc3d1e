//! What can go wrong.

use miette::Diagnostic;
use thiserror::Error;

/// Most pixels on one side.
pub(super) const MOST_SIDE: u32 = 16_384;

/// What keeps a picture from being drawn.
#[derive(Debug, Error, Diagnostic, PartialEq)]
pub enum RenderError {
    /// The picture has no pixels, or too many.
    #[error("a picture of {width} × {height} pixels cannot be drawn")]
    #[diagnostic(help("take from 16 to {MOST_SIDE} pixels a side"))]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// No ring is in the patch.
    #[error("no ring is in the picture")]
    #[diagnostic(help("take a larger patch or tile"))]
    Nothing,
    /// The patch has too many rings.
    #[error("the picture would show {rings:.0} rings; {most} are possible")]
    #[diagnostic(help("take a smaller patch or tile"))]
    TooManyRings {
        /// Rings, about.
        rings: f64,
        /// Most rings.
        most: usize,
    },
    /// Loads or arrows are asked for where no contact forces are known.
    #[error("no contact forces are known of this state")]
    NoForces,
    /// The pixels could not be written as PNG.
    #[error("the picture cannot be written as PNG: {0}")]
    Encode(String),
}
