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
//! | how wide are the gaps between two rings? | [`torus_gap`], [`torus_gaps`] |
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

mod circle;
mod circle_circle;
mod linking;
mod simd;
mod tolerance;
mod torus;

pub use circle::{Circle, PointOnCircle, Vec3, point_circle_distance};
pub use circle_circle::approach::{Approach, Approaches};
pub use circle_circle::lower_bound::circle_distance_lower_bound;
pub use circle_circle::many_pairs::{Instructions, circle_distance_approaches, circle_distance_approaches_with};
pub use circle_circle::minimum::{MAX_MINIMA, Minima, Minimum, PairKind};
pub use circle_circle::one_pair::circle_distance_minima;
pub use circle_circle::polynomial::circle_distance_minima_polynomial;
pub use linking::{interlocks, linking_number};
pub use tolerance::ROUNDING;
pub use torus::{Torus, torus_gap, torus_gaps};
