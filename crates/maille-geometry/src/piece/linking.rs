//! The linking number of two closed curves of segments and arcs.
//!
//! A curve is replaced by a polygon with its corners on it, so fine that no point moves by more than a quarter of the distance of the
//! curves: they do not meet on the way, and the linking number stays. A run of length L along which the tangent turns by τ < π in all
//! moves by at most L sin(τ/2): all tangents are within τ/2 of the one half way, so run and chord stray from its line by at most
//! half of that each, counted from the nearer end. An arc alone moves by its sagitta. The linking number of two polygons is the
//! sum of Gauss's integral over pairs of edges. With differences of their ends it is the solid angle of a parallelogram
//! seen from the origin,
//!
//! ```text
//! lk = 1/4π Σ Ω(a, b, c, d),   a = q₀ − p₀, b = q₀ − p₁, c = q₁ − p₁, d = q₁ − p₀
//! ```
//!
//! for edges p₀p₁ and q₀q₁, and Ω is the sum of those of two triangles (Van Oosterom and Strackee 1983, "The Solid
//! Angle of a Plane Triangle"), each accurate to rounding. The sum must come out as a whole number.

use super::shape::Piece;
use crate::circle::Vec3;
use std::f64::consts::PI;

/// Chords of one curve, at most.
const MAX_CHORDS: usize = 4096;
/// Ends that meet, relative to the length of a piece.
const MEET: f64 = 1e-9;
/// How far from a whole number a sum may be.
const WHOLE: f64 = 1e-3;

/// How often two closed curves, each given by its pieces in order, are linked: [`linking_number`](crate::linking_number)
/// for curves. `apart` is a distance that they keep, such as the least of
/// [`piece_distance_minima`](crate::piece_distance_minima); the smaller it is, the more work.
///
/// The sign is that of the directions in which the curves run: a circle runs counter-clockwise about its normal.
///
/// None if a curve is not closed (each piece must begin where the one before it ends, to 1e-9 of its length), or if
/// `apart` is so small that a curve would need more than 4,096 chords.
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
/// // The frame comes down through the ring, whose centre is 1 away from it.
/// assert_eq!(curve_linking_number(&ring, &frame, 1.0), Some(-1));
/// ```
pub fn curve_linking_number(a: &[Piece], b: &[Piece], apart: f64) -> Option<i32> {
    if !(is_closed(a) && is_closed(b) && apart > 0.0) {
        return None;
    }
    let count = |curve: &[Piece]| Polygon::new(curve, apart).take(MAX_CHORDS + 1).count();
    if count(a).max(count(b)) > MAX_CHORDS {
        return None;
    }
    let mut angle = 0.0;
    for p in Polygon::new(a, apart) {
        for q in Polygon::new(b, apart) {
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

/// The edges of a polygon that stands for a closed curve.
struct Polygon<'a> {
    curve: &'a [Piece],
    apart: f64,
    /// The piece that comes next, and which of its chords.
    next: usize,
    chord: usize,
    /// Where the edge before ends.
    at: Vec3,
}

impl<'a> Polygon<'a> {
    fn new(curve: &'a [Piece], apart: f64) -> Self {
        Polygon { curve, apart, next: 0, chord: 0, at: curve[0].point(0.0) }
    }

    fn to(&mut self, end: Vec3) -> Option<[Vec3; 2]> {
        let start = std::mem::replace(&mut self.at, end);
        Some([start, end])
    }
}

impl Iterator for Polygon<'_> {
    type Item = [Vec3; 2];

    fn next(&mut self) -> Option<[Vec3; 2]> {
        let piece = self.curve.get(self.next)?;
        let n = chords(piece, self.apart);
        if n > 1.0 {
            self.chord += 1;
            let end = piece.point(self.chord as f64 / n);
            if self.chord as f64 >= n {
                (self.next, self.chord) = (self.next + 1, 0);
            }
            return self.to(end);
        }
        // As many pieces as one chord may stand for: at most a third of the curve, so that the polygon has three edges.
        let (first, mut length, mut turn_rad) = (self.next, piece.length(), sweep_rad(piece));
        self.next += 1;
        while let Some(following) = self.curve.get(self.next).filter(|_| 3 * (self.next - first) < self.curve.len()) {
            length += following.length();
            turn_rad += self.curve[self.next - 1].tangent(1.0).angle(&following.tangent(0.0)) + sweep_rad(following);
            if turn_rad >= PI || length * (0.5 * turn_rad).sin() > 0.25 * self.apart {
                break;
            }
            self.next += 1;
        }
        let end = self.curve[self.next - 1].point(1.0);
        self.to(end)
    }
}

fn sweep_rad(piece: &Piece) -> f64 {
    if let Piece::Arc(arc) = piece { arc.sweep_rad() } else { 0.0 }
}

/// So many chords of a piece that none is further from its arc than a quarter of `apart`.
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
