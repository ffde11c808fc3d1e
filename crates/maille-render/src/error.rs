//! What can go wrong.

use maille::model::MEMORY_LIMIT_BYTES;
use miette::Diagnostic;
use std::fmt;
use thiserror::Error;

/// Most pixels on one side.
pub(super) const MOST_SIDE: u32 = 16_384;
/// Most pixels of a picture.
pub(super) const MOST_PIXELS: u32 = (MEMORY_LIMIT_BYTES / BYTES_OF_PIXEL) as u32;
/// Memory that a pixel takes while it is drawn, in bytes: 1.12 GB for 4000 × 3000.
const BYTES_OF_PIXEL: f64 = 100.0;

/// What keeps a picture from being drawn.
#[derive(Debug, Error, PartialEq)]
pub enum RenderError {
    /// The picture has no pixels, or too many.
    #[error("a picture of {width} × {height} pixels cannot be drawn")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// No ring is in the patch.
    #[error("no ring is in the picture")]
    Nothing,
    /// The patch has too many rings.
    #[error("the picture would show {rings:.0} rings; {most} are possible")]
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

impl Diagnostic for RenderError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::Size { .. } => Some(Box::new(format!(
                "take from 16 to {MOST_SIDE} pixels a side, and at most {} million in all",
                MOST_PIXELS / 1_000_000
            ))),
            Self::Nothing => Some(Box::new("take a larger patch or tile")),
            Self::TooManyRings { .. } => Some(Box::new("take a smaller patch or tile")),
            Self::NoForces | Self::Encode(_) => None,
        }
    }
}
