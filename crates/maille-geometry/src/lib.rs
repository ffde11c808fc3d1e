//! Distances, contacts and linking of circles and tori in space.
//!
//! Pure kernels on `f64`: no files, no threads, no heap. A ring of chainmail is a [`Torus`], the set of points at
//! distance `r` from a [`Circle`]; everything that the mechanics asks about two rings follows from their circles:
//!
//! | question | answer |
//! | --- | --- |
//! | how far is a point from a circle? | [`point_circle_distance`] |
//! | where is the distance of two circles locally smallest? | [`circle_distance_minima`]: all such places |
//! | the same for many pairs | [`circle_distance_approaches`]: several at once, by the machine's widest registers |
//! | the same by the polynomial of degree 8 | [`circle_distance_minima_polynomial`]: a cross-check, fragile in doubles |
//! | how wide are the gaps between two rings? | [`torus_score`], [`torus_scores`] |
//! | are two rings linked, and in which sense? | [`linking_number`], [`interlocks`] |
//!
//! The order of the modules is `circle ← lane, grid ← reduced ← relative ← arcs ← count ← brackets ← halving, quick, bounds ←
//! search ← placed ← single, minima ← solve, batch, polynomial, torus`, with `linking` and `floor` beside them: `relative`
//! reduces a pair to six numbers and evaluates the distance along one circle, `count`, `brackets` and `quick` find the minima of
//! ordinary pairs, `single` those of one pair in registers, `halving`, `placed`, `solve` and `batch` those of many, `bounds`
//! proves what it can on an interval, `search` (on the angles of `grid`) and `polynomial` find the minima in two other ways.
//!
//! Lengths carry the caller's unit, angles are radians. Radii must be positive and finite and normals of unit length;
//! debug builds assert it in [`Circle::new`].

mod arcs;
mod batch;
mod bounds;
mod brackets;
mod circle;
mod count;
mod floor;
mod grid;
mod halving;
mod lane;
mod linking;
mod minima;
mod placed;
mod polynomial;
mod quick;
mod reduced;
mod relative;
mod search;
mod single;
mod solve;
mod torus;

/// A vector or point in space.
pub type Vec3 = nalgebra::Vector3<f64>;

/// What counts as rounding, relative to the largest length of a pair: `1e-14`, about fifty units in the last place.
///
/// Two circles whose distance varies by less along the whole circle are a continuum of minima, planes tilted by less
/// are parallel. It is the only tolerance of this crate that decides between answers.
pub const ROUNDING: f64 = 1e-14;

pub use batch::{Approach, Approaches, Instructions, circle_distance_approaches, circle_distance_approaches_with};
pub use circle::{Circle, PointOnCircle, point_circle_distance};
pub use floor::circle_distance_floor;
pub use linking::{interlocks, linking_number};
pub use minima::{MAX_MINIMA, Minima, Minimum, PairKind, circle_distance_minima};
pub use polynomial::circle_distance_minima_polynomial;
pub use torus::{Torus, torus_score, torus_scores};
