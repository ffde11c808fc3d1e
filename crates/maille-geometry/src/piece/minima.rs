//! All local minima of the distance of two pieces.
//!
//! A minimum lies inside both pieces, at an end of one and inside the other, or at an end of both.
//!
//! - Inside both it is a minimum of the distance of the two whole lines or circles. Of two lines that is one point;
//!   of a line and a circle, `line_circle`; of two circles, [`circle_distance_minima`].
//! - At an end `e` of one it is the point of the other's line or circle that is nearest to `e`, which is unique, or an
//!   end of the other. It is a minimum if the distance does not fall into a piece from its end: with `y` on the other
//!   and the inward unit tangent `τ`, if `(e − y)·τ ≥ 0`.
//!
//! So the list is complete. Slopes within [`ROUNDING`] of the pair's size count as zero, and a point that is found
//! twice is kept once. **Constant distance** (parallel segments, coaxial arcs, …): there the slopes at ends are zero,
//! so both ends of the common stretch are found, and nothing between them.

use super::line_circle::line_circle_minima;
use super::shape::{Arc, Piece, Place};
use crate::{circle::Vec3, circle_circle::one_pair::circle_distance_minima, tolerance::ROUNDING};
use arrayvec::ArrayVec;

/// The largest number of minima of two pieces: four of two circles ([`MAX_MINIMA`](crate::MAX_MINIMA)), one from each
/// of the four ends to the inside of the other piece, and four between ends.
pub const MAX_PIECE_MINIMA: usize = 12;

/// Points that are nearer to each other than this, relative to the pair's size, on both pieces, are one minimum.
const SAME: f64 = 1e-9;

/// A piece that is smaller than this part of the pair's size is no more than a point in it.
const POINT: f64 = 1e-7;

/// A local minimum of the distance between pieces A and B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceMinimum {
    /// The distance (length).
    pub distance: f64,
    /// The point on A.
    pub point_a: Vec3,
    /// The point on B.
    pub point_b: Vec3,
    /// Where on A.
    pub place_a: Place,
    /// Where on B.
    pub place_b: Place,
}

/// All local minima of the distance of two pieces, in ascending order: at least one.
#[derive(Clone, Debug)]
pub struct PieceMinima {
    found: ArrayVec<PieceMinimum, MAX_PIECE_MINIMA>,
}

impl PieceMinima {
    /// The minima, in ascending order of distance.
    pub fn as_slice(&self) -> &[PieceMinimum] {
        &self.found
    }

    /// The one with the smallest distance, which is the distance of the pieces.
    pub fn closest(&self) -> &PieceMinimum {
        &self.found[0]
    }

    /// Adds the nearest of the ends and middles with their nearest points, if it is nearer than all: where rounding hides one piece beside the
    /// other, no minimum is told from its neighbours. NaN of pieces that are not finite.
    fn add_nearest(&mut self, size: f64, a: &Piece, b: &Piece) {
        const PARTS: [f64; 3] = [0.0, 0.5, 1.0];
        let from_a = PARTS.map(|t| (a.point(t), b.point(b.nearest(&a.point(t)))));
        let from_b = PARTS.map(|t| (a.point(a.nearest(&b.point(t))), b.point(t)));
        let all = from_a.into_iter().chain(from_b).map(|(x, y)| ((x - y).norm(), x, y));
        let (distance, x, y) = all.min_by(|m, n| m.0.total_cmp(&n.0)).expect("a piece has a middle");
        if self.found.iter().all(|m| distance < m.distance - SAME * size) {
            self.add(size, (Place::Inside, x), (Place::Inside, y));
        }
    }

    fn add(&mut self, size: f64, (place_a, point_a): (Place, Vec3), (place_b, point_b): (Place, Vec3)) {
        let near = |x: &Vec3, y: &Vec3| (x - y).norm() <= SAME * size;
        if !self.found.iter().any(|m| near(&m.point_a, &point_a) && near(&m.point_b, &point_b)) {
            let distance = (point_a - point_b).norm();
            self.found.push(PieceMinimum { distance, point_a, point_b, place_a, place_b });
        }
    }
}

/// Every local minimum of the distance between two pieces, the smallest first.
///
/// Distances are accurate to about `1e-15` of the pair's size. Of pieces that are not finite the one minimum is NaN.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Piece, Segment, Vec3, piece_distance_minima};
///
/// // A bar that stands in a ring, off its centre.
/// let ring = Piece::circle(Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0));
/// let bar = Segment::new(Vec3::new(0.0, 0.3, -2.0), Vec3::new(0.0, 0.3, 2.0)).unwrap();
/// let minima = piece_distance_minima(&ring, &Piece::Segment(bar));
/// assert_eq!(minima.as_slice().len(), 1);
/// assert!((minima.closest().distance - 0.7).abs() < 1e-15);
/// ```
pub fn piece_distance_minima(a: &Piece, b: &Piece) -> PieceMinima {
    let mut out = PieceMinima { found: ArrayVec::new() };
    let ((at_a, size_a), (at_b, size_b)) = (a.extent(), b.extent());
    let size = size_a.max(size_b).max((at_a - at_b).norm());
    let (ends_a, ends_b) = (a.ends(), b.ends());

    // At ends, first: where the distance is constant, they stand for what is between.
    let rises = |slope: f64| slope >= -ROUNDING * size;
    for (place, e, inward) in ends_a.iter().flatten() {
        if let Some(y) = b.foot(e).filter(|y| rises((e - y).dot(inward))) {
            out.add(size, (*place, *e), (Place::Inside, y));
        }
        for (other, y, inward_b) in ends_b.iter().flatten() {
            if rises((e - y).dot(inward)) && rises((y - e).dot(inward_b)) {
                out.add(size, (*place, *e), (*other, *y));
            }
        }
    }
    for (place, e, inward) in ends_b.iter().flatten() {
        if let Some(y) = a.foot(e).filter(|y| rises((e - y).dot(inward))) {
            out.add(size, (Place::Inside, y), (*place, *e));
        }
    }

    match (a, b) {
        (Piece::Segment(line_a), Piece::Segment(line_b)) => {
            let (u, v) = (line_a.along(), line_b.along());
            let normal = u.cross(&v);
            let sin_sq = normal.norm_squared();
            if sin_sq > ROUNDING * ROUNDING {
                let x = at_a + *u * (at_b - at_a).cross(&v).dot(&normal) / sin_sq;
                inside(&mut out, size, [a, b], &x, false);
            }
        }
        (Piece::Segment(line), Piece::Arc(arc)) => {
            for x in line_circle_minima(&at_a, &line.along(), arc.circle()) {
                inside(&mut out, size, [a, b], &x, false);
            }
        }
        (Piece::Arc(arc), Piece::Segment(line)) => {
            for x in line_circle_minima(&at_b, &line.along(), arc.circle()) {
                inside(&mut out, size, [b, a], &x, true);
            }
        }
        (Piece::Arc(arc_a), Piece::Arc(arc_b)) => {
            let minima = circle_distance_minima(arc_a.circle(), arc_b.circle());
            // Ends of a stretch along which the distance is constant stand for it, if it has any.
            let ended = |distance: f64| {
                minima.continuum && out.found.iter().any(|m| (m.distance - distance).abs() <= SAME * size)
            };
            let new: ArrayVec<(Vec3, Vec3), { crate::MAX_MINIMA }> = minima
                .as_slice()
                .iter()
                .filter_map(|m| Some((a.foot(&m.point_a)?, b.foot(&m.point_b)?)))
                .filter(|(x, y)| {
                    let runs = !stays(size, [arc_a, arc_b], [*x, *y]) && !stays(size, [arc_b, arc_a], [*y, *x]);
                    !(ended((x - y).norm()) && runs)
                })
                .collect();
            for (x, y) in new {
                out.add(size, (Place::Inside, x), (Place::Inside, y));
            }
        }
    }
    if out.found.is_empty() || size_a.min(size_b) < POINT * size {
        out.add_nearest(size, a, b);
    }
    out.found.sort_by(|m, n| m.distance.total_cmp(&n.distance));
    out
}

/// Whether a point runs round a whole circle at the same distance from one point of another arc, in its middle or far away for its size: such a stretch
/// has no end.
fn stays(size: f64, [round, other]: [&Arc; 2], [x, y]: [Vec3; 2]) -> bool {
    let across = round.circle().center * 2.0 - x;
    round.is_closed() && Piece::Arc(*other).foot(&across).is_some_and(|foot| (foot - y).norm() <= SAME * size)
}

/// Adds the point of the first piece's line at `x` and the nearest one of the other piece, if both lie inside.
fn inside(out: &mut PieceMinima, size: f64, [line, other]: [&Piece; 2], x: &Vec3, swapped: bool) {
    if let (Some(x), Some(y)) = (line.foot(x), other.foot(x)) {
        let (first, second) = ((Place::Inside, x), (Place::Inside, y));
        if swapped { out.add(size, second, first) } else { out.add(size, first, second) }
    }
}
