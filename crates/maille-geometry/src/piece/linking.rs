//! The linking number of two closed curves of segments and arcs.
//!
//! Arcs are replaced by chords, so many that no point moves by more than a quarter of the distance of the curves: they
//! do not meet on the way, and the linking number stays. That of two polygons is the sum of Gauss's integral over pairs
//! of edges. With differences of their ends it is the solid angle of a parallelogram seen from the origin,
//!
//! ```text
//! lk = 1/4π Σ Ω(a, b, c, d),   a = q₀ − p₀, b = q₀ − p₁, c = q₁ − p₁, d = q₁ − p₀
//! ```
//!
//! for edges p₀p₁ and q₀q₁, and Ω is the sum of those of two triangles (Van Oosterom and Strackee 1983, "The Solid
//! Angle of a Plane Triangle"), each accurate to rounding. The sum must come out as a whole number.

use super::{minima::piece_distance_minima, shape::Piece};
use crate::circle::Vec3;
use std::f64::consts::PI;

/// Chords of one curve, at most.
const MAX_CHORDS: f64 = 4096.0;
/// Ends that meet, relative to the length of a piece.
const MEET: f64 = 1e-9;
/// How far from a whole number a sum may be.
const WHOLE: f64 = 1e-3;

/// How often two closed curves, each given by its pieces in order, are linked: [`linking_number`](crate::linking_number)
/// for curves.
///
/// The sign is that of the directions in which the curves run: a circle runs counter-clockwise about its normal.
///
/// None if a curve is not closed (each piece must begin where the one before it ends, to 1e-9 of its length), or if
/// they are so near to each other that their pieces would need more than 4,096 chords. They must not meet.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Piece, Segment, Vec3, curve_linking_number};
///
/// let ring = [Piece::circle(Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0))];
/// let corners = [[0.0, 0.0, -1.0], [3.0, 0.0, -1.0], [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]].map(Vec3::from);
/// let frame: Vec<Piece> =
///     (0..4).map(|i| Piece::Segment(Segment::new(corners[i], corners[(i + 1) % 4]).unwrap())).collect();
/// // The frame comes down through the ring.
/// assert_eq!(curve_linking_number(&ring, &frame), Some(-1));
/// ```
pub fn curve_linking_number(a: &[Piece], b: &[Piece]) -> Option<i32> {
    if !is_closed(a) || !is_closed(b) {
        return None;
    }
    let pairs = || a.iter().flat_map(|x| b.iter().map(move |y| (x, y)));
    let apart = pairs().map(|(x, y)| piece_distance_minima(x, y).closest().distance).fold(f64::INFINITY, f64::min);
    let count = |curve: &[Piece]| curve.iter().map(|piece| chords(piece, apart)).sum::<f64>();
    if count(a).max(count(b)) > MAX_CHORDS {
        return None;
    }
    let edges = |piece: &Piece| {
        let (piece, n) = (*piece, chords(piece, apart));
        (0..n as usize).map(move |i| [i as f64 / n, (i + 1) as f64 / n].map(|t| piece.point(t)))
    };
    let mut angle = 0.0;
    for p in a.iter().flat_map(edges) {
        for q in b.iter().flat_map(edges) {
            let corners = [q[0] - p[0], q[0] - p[1], q[1] - p[1], q[1] - p[0]];
            angle += solid_angle(corners[0], corners[1], corners[2]) + solid_angle(corners[0], corners[2], corners[3]);
        }
    }
    let number = angle / (4.0 * PI);
    ((number - number.round()).abs() < WHOLE).then(|| number.round() as i32)
}

fn is_closed(curve: &[Piece]) -> bool {
    let meet = |(x, y): (&Piece, &Piece)| (x.point(1.0) - y.point(0.0)).norm() <= MEET * x.length().max(y.length());
    !curve.is_empty() && curve.iter().zip(curve.iter().cycle().skip(1)).all(meet)
}

/// So many chords of a piece that none is further from its arc than a quarter of `apart`; infinite if that is 0.
fn chords(piece: &Piece, apart: f64) -> f64 {
    match piece {
        Piece::Segment(_) => 1.0,
        Piece::Arc(arc) => {
            // The sagitta R (1 − cos x), x half of a chord's angle; three for a circle, at least.
            let half = 2.0 * (apart / (8.0 * arc.circle().radius)).min(0.5).sqrt().asin();
            (0.5 * arc.sweep_rad() / half).max(arc.sweep_rad() / 2.1).ceil()
        }
    }
}

/// The solid angle of a triangle seen from the origin, positive if a, b, c are right-handed.
fn solid_angle(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let [x, y, z] = [a, b, c].map(|v| v.norm());
    let volume = a.dot(&b.cross(&c));
    2.0 * volume.atan2(x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y)
}
