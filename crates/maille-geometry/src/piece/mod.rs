//! Pieces of a curve, segments and circular arcs: the local minima of the distance of two of them, and linking numbers.
//!
//! | module | what it holds |
//! | --- | --- |
//! | `shape` | [`Segment`], [`Arc`], [`Piece`]: points, ends, the nearest point of the line or circle of a piece |
//! | `biarc` | two arcs between points with tangents |
//! | `line_circle` | all minima of the distance of a line and a circle |
//! | `minima` | all minima of the distance of two pieces |
//! | `linking` | the linking number of two closed curves of pieces |

mod biarc;
mod line_circle;
mod linking;
mod minima;
mod shape;

pub use biarc::biarc;
pub use linking::curve_linking_number;
pub use minima::{MAX_PIECE_MINIMA, PieceMinima, PieceMinimum, piece_distance_minima};
pub use shape::{Arc, Piece, Place, Segment};
