//! Exact distances, gaps and linking numbers of circles and tori in three-dimensional space.
//!
//! A ring of round wire is a [`Torus`]: a core [`Circle`] of radius `R` and a wire of radius `r`. Whether two rings
//! touch, overlap or are linked follows from their core circles alone, so most of this crate is about two
//! circles. Other curves are made of [pieces](Piece), segments and arcs. All functions work on `f64`, start no
//! threads and allocate nothing on the heap.
//!
//! # Example
//!
//! Two unit rings in perpendicular planes, linked like two links of a chain:
//!
//! ```
//! use maille_geometry::{Circle, Torus, Vec3, circle_distance_minima, linking_number, torus_gap};
//!
//! let a = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
//! let b = Circle::new(Vec3::new(0.8, 0.0, 0.0), Vec3::y_axis(), 1.0);
//!
//! // Every local minimum of the distance, smallest first: the circles are 0.8 apart at two places.
//! let minima = circle_distance_minima(&a, &b);
//! assert_eq!(minima.as_slice().len(), 2);
//! assert!((minima.closest().distance - 0.8).abs() < 1e-15);
//!
//! // With wire of radius 0.1, a gap of 0.6 is left between the surfaces.
//! let wire = 0.1;
//! let gap = torus_gap(&Torus { circle: a, minor_radius: wire }, &Torus { circle: b, minor_radius: wire });
//! assert!((gap - 0.6).abs() < 1e-15);
//!
//! // They are linked once; the sign depends on the orientation of the normals.
//! assert_eq!(linking_number(&a, &b), 1);
//! ```
//!
//! # What is computed, and where
//!
//! | question | function | source |
//! | --- | --- | --- |
//! | How far is a point from a circle? | [`point_circle_distance`] | `circle.rs` |
//! | Where are the local minima of the distance of two circles? | [`circle_distance_minima`] | `circle_circle/one_pair` |
//! | The same for many pairs at once | [`circle_distance_approaches`] | `circle_circle/many_pairs` |
//! | A cheap lower bound of the distance | [`circle_distance_lower_bound`] | `circle_circle/lower_bound.rs` |
//! | A cross-check of the minima by polynomial roots | [`circle_distance_minima_polynomial`] | `circle_circle/polynomial.rs` |
//! | How wide is the gap between two tori? | [`torus_gap`], [`torus_gaps`] | `torus.rs` |
//! | Where are the local minima of the distance of two segments or arcs? | [`piece_distance_minima`] | `piece` |
//! | How often are two closed curves of them linked? | [`curve_linking_number`] | `piece/linking.rs` |
//! | Which ball around a set of points is the smallest? | [`smallest_ball_center`] | `ball.rs` |
//! | Are two circles linked, and with which sign? | [`linking_number`], [`interlocks`] | `linking.rs` |
//!
//! # Method
//!
//! The distance of two circles can have two local minima, and rings often touch at both. A local search from one
//! start finds one of them, so the minima are *isolated* first, by a proof that none is missed, and only then
//! computed:
//!
//! 1. The pair is reduced to six numbers in a common frame; the smaller circle is described by its angle θ
//!    (`circle_circle/pair_frame.rs`, `normalized_pair.rs`).
//! 2. *Fast method* (`circle_circle/fast`), for nearly all pairs: Descartes' rule of signs on Bernstein
//!    coefficients counts the critical points on eight arcs of θ, undecided arcs are bisected, and Halley's
//!    iteration finds the minimum on each isolating arc. It is written once, over a trait that stands for one `f64`
//!    or a SIMD register (`simd.rs`).
//! 3. *Exhaustive method* (`circle_circle/exhaustive`), for degenerate and nearly degenerate pairs: bounds on the
//!    third derivative decide each interval of θ, or it is bisected.
//!
//! A file imports only files above it in this list: `tolerance`, `circle`, `simd`, then within `circle_circle` the
//! result types (`minimum`, `approach`), the frames (`angle`, `normalized_pair`, `pair_frame`, `simd_frame`),
//! `fast` and `exhaustive`, `one_pair`, `many_pairs`; `lower_bound`, `polynomial`, `piece`, `linking`, `torus` and
//! `ball` stand beside or above them.
//!
//! # Accuracy
//!
//! Distances are accurate to about `1e-15` of the pair's largest length (radii and distance of the centres), in
//! degenerate positions too. Tested on 120,000 random pairs of six families against dense sampling: no minimum
//! missed, no false one, and no distance more than `7e-16` above the sampled one (`tests/it/completeness.rs`). Random
//! pairs have met at most two minima; at most three isolated ones are possible.
//!
//! # Degenerate positions
//!
//! - **Constant distance** (coaxial circles, and two other families, see [`PairKind`]): the minima form a
//!   continuum; one representative is returned, and [`Minima::continuum`] is set.
//! - **A point on the axis of the other circle** has no nearest point there: the distance has a kink, which is
//!   never a minimum except on a continuum; [`PointOnCircle::on_axis`] reports it for a single point.
//! - **Circles that intersect** have distance 0 at each intersection; their linking number is undefined.
//! - **Invalid input** (non-finite numbers, non-positive radii, normals that are not unit vectors, lengths beyond
//!   `1e±90`): the minima are NaN. [`Circle::new`] asserts valid radii in debug builds.
//!
//! # Units
//!
//! Lengths are in the caller's unit, angles in radians. [`ROUNDING`], relative to the largest length of a pair, is
//! the only tolerance that decides between answers.
//!
//! # Source
//!
//! Numbers of sections, equations, definitions and theorems, and Appendix A, are those of the thesis *Mechanical
//! Characterization of Rigid Discrete Interlocking Materials*.

mod ball;
mod circle;
mod circle_circle;
mod linking;
mod piece;
mod simd;
mod tolerance;
mod torus;

pub use ball::smallest_ball_center;
pub use circle::{Circle, PointOnCircle, Vec3, point_circle_distance};
pub use circle_circle::approach::{Approach, Approaches};
pub use circle_circle::lower_bound::circle_distance_lower_bound;
pub use circle_circle::many_pairs::{Instructions, circle_distance_approaches, circle_distance_approaches_with};
pub use circle_circle::minimum::{MAX_MINIMA, Minima, Minimum, PairKind};
pub use circle_circle::one_pair::circle_distance_minima;
pub use circle_circle::polynomial::circle_distance_minima_polynomial;
pub use linking::{interlocks, linking_number};
pub use piece::{
    Arc, MAX_PIECE_MINIMA, Piece, PieceMinima, PieceMinimum, Place, Segment, biarc, curve_linking_number,
    piece_distance_minima,
};
pub use tolerance::ROUNDING;
pub use torus::{Torus, torus_gap, torus_gaps};

/// Runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
