//! Tori, and the gaps between their surfaces.
//!
//! Symbols: major radius `R`, minor radius `r`, distance of the core circles `d` (all lengths).

use crate::circle::Circle;
use crate::circle_circle::minimum::Minima;
use crate::circle_circle::one_pair::circle_distance_minima;

/// A ring of round wire: the points at distance `r` from a core circle (Definition 3.0.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// The core circle. Its radius is the major radius `R`.
    pub circle: Circle,
    /// The minor radius `r`, that of the wire (length); `0 < r < R` for a ring with a hole.
    pub minor_radius: f64,
}

/// The gap between two tori: `d_c − r₁ − r₂`, with `d_c` the distance of their core circles (Theorem 3.3.1).
///
/// The tori overlap if and only if the gap is negative: by the triangle inequality, a point within `r₁` of one
/// circle and `r₂` of the other exists if and only if `d_c < r₁ + r₂`. For separate tori the gap is the distance of
/// their surfaces; for overlapping tori it is minus the overlap along the segment between the nearest points of the
/// circles. NaN for invalid circles, see [`circle_distance_minima`].
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Torus, Vec3, torus_gap};
///
/// // Two rings stacked on a common axis, 0.5 apart.
/// let ring = |height| Torus {
///     circle: Circle::new(Vec3::new(0.0, 0.0, height), Vec3::z_axis(), 1.0),
///     minor_radius: 0.125,
/// };
/// assert_eq!(torus_gap(&ring(0.0), &ring(0.5)), 0.25);
/// ```
pub fn torus_gap(a: &Torus, b: &Torus) -> f64 {
    circle_distance_minima(&a.circle, &b.circle).closest().distance - (a.minor_radius + b.minor_radius)
}

/// The minima of the distance of the core circles, and the local gap `d − r₁ − r₂` at each of them, both in
/// ascending order (Proposition 3.3.2).
///
/// A negative gap is a local overlap; the first gap equals [`torus_gap`]. Maxima of the distance are left out: tori
/// do not touch there.
pub fn torus_gaps(a: &Torus, b: &Torus) -> (Minima, impl ExactSizeIterator<Item = f64> + use<>) {
    let minima = circle_distance_minima(&a.circle, &b.circle);
    let reach = a.minor_radius + b.minor_radius;
    let gaps = minima.clone().into_distances().map(move |distance| distance - reach);
    (minima, gaps)
}
