//! Tori and the gaps between them.

use crate::circle::Circle;
use crate::circle_circle::minimum::Minima;
use crate::circle_circle::one_pair::circle_distance_minima;

/// A ring: the points at distance `r` from a circle (Definition 3.0.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// The core circle; its radius is the major radius `R`.
    pub circle: Circle,
    /// The minor radius `r`, that of the wire; `0 < r < R` for a ring with a hole.
    pub minor_radius: f64,
}

/// The gap between two tori, `d_c − r₁ − r₂`, with `d_c` the distance of their core circles (Theorem 3.3.1).
///
/// They overlap if and only if it is negative: a point that lies within `r₁` of one circle and `r₂` of the other
/// exists if and only if `d_c < r₁ + r₂`, by the triangle inequality and the segment between the nearest points.
/// For tori that are apart it is their distance; for tori that overlap, minus the depth along that segment.
pub fn torus_gap(a: &Torus, b: &Torus) -> f64 {
    circle_distance_minima(&a.circle, &b.circle).closest().distance - (a.minor_radius + b.minor_radius)
}

/// The minima of the distance of the core circles, and the local gap `d − r₁ − r₂` at each, in the same ascending order
/// (Proposition 3.3.2). A gap below zero is a local overlap; the first gap is [`torus_gap`].
///
/// Minima only: at maxima of the distance nothing touches.
pub fn torus_gaps(a: &Torus, b: &Torus) -> (Minima, impl ExactSizeIterator<Item = f64> + use<>) {
    let minima = circle_distance_minima(&a.circle, &b.circle);
    let reach = a.minor_radius + b.minor_radius;
    let gaps = minima.clone().into_distances().map(move |distance| distance - reach);
    (minima, gaps)
}
