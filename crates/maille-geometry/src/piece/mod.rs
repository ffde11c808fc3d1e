//! Pieces of a curve: segments and circular arcs, and the local minima of the distance of two of them.
//!
//! | module | what it holds |
//! | --- | --- |
//! | `shape` | [`Segment`], [`Arc`], [`Piece`]: points, ends, the nearest point of the line or circle of a piece |
//! | `line_circle` | all minima of the distance of a line and a circle |
//! | `minima` | all minima of the distance of two pieces |

mod line_circle;
mod minima;
mod shape;

pub use minima::{MAX_PIECE_MINIMA, PieceMinima, PieceMinimum, piece_distance_minima};
pub use shape::{Arc, Piece, Place, Segment};
