//! Bends that are too tight for a wire, and wires that run into themselves.

use super::core::ball;
use maille_geometry::{Piece, PieceMinimum, Vec3, piece_distance_minima};
use std::f64::consts::PI;

/// Least radius of the arcs among `pieces`; none where all are straight.
pub(crate) fn tightest(pieces: &[Piece]) -> Option<f64> {
    let radii = pieces.iter().filter_map(|piece| match piece {
        Piece::Segment(_) => None,
        Piece::Arc(arc) => Some(arc.circle().radius),
    });
    radii.min_by(f64::total_cmp)
}

/// How near the core comes to itself where the tube of radius `r` runs into itself; none where it does not.
///
/// Points count that are a local minimum of their distance, or, at corners, pieces that are no neighbours. Those that are nearer along the curve than
/// half of the circle with the wire's radius, π r, are parts of one bend.
pub(super) fn self_overlap(pieces: &[Piece], closed: bool, r: f64) -> Option<f64> {
    let mut at = vec![0.0];
    pieces.iter().for_each(|piece| at.push(at[at.len() - 1] + piece.length()));
    let total = at[pieces.len()];
    least_below(pieces, 2.0 * r, |i, j, m| {
        let place = |k: usize, p: &Vec3| at[k] + pieces[k].length() * pieces[k].nearest(p);
        let way = (place(j, &m.point_b) - place(i, &m.point_a)).abs();
        (if closed { way.min(total - way) } else { way }) > PI * r
    })
}

/// The same for the struts of a frame; those that share a vertex do not count.
pub(super) fn frame_overlap(struts: &[Piece], edges: &[[u32; 2]], r: f64) -> Option<f64> {
    least_below(struts, 2.0 * r, |i, j, _| !edges[i].iter().any(|vertex| edges[j].contains(vertex)))
}

/// The least distance of two pieces below `most`, at minima that count.
fn least_below(pieces: &[Piece], most: f64, counts: impl Fn(usize, usize, &PieceMinimum) -> bool) -> Option<f64> {
    let balls: Vec<(Vec3, f64)> = pieces.iter().map(ball).collect();
    let mut least: Option<f64> = None;
    for i in 0..pieces.len() {
        for j in i + 1..pieces.len() {
            if (balls[i].0 - balls[j].0).norm() - balls[i].1 - balls[j].1 >= most {
                continue;
            }
            for m in piece_distance_minima(&pieces[i], &pieces[j]).as_slice() {
                if m.distance < most && counts(i, j, m) && least.is_none_or(|d| m.distance < d) {
                    least = Some(m.distance);
                }
            }
        }
    }
    least
}
