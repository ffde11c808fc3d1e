//! Bends that are too tight for a wire, and wires that run into themselves.

use super::core::ball;
use maille_geometry::{Piece, Vec3, piece_distance_minima};
use std::f64::consts::PI;

/// Least radius of the arcs among `pieces`; none where all are straight.
pub(in super::super) fn tightest(pieces: &[Piece]) -> Option<f64> {
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
pub(in super::super) fn self_overlap(pieces: &[Piece], r: f64) -> Option<f64> {
    let n = pieces.len();
    let mut at = vec![0.0];
    pieces.iter().for_each(|piece| at.push(at[at.len() - 1] + piece.length()));
    let total = at[n];
    let balls: Vec<(Vec3, f64)> = pieces.iter().map(ball).collect();
    let mut least: Option<f64> = None;
    for i in 0..n {
        for j in i + 1..n {
            if (balls[i].0 - balls[j].0).norm() - balls[i].1 - balls[j].1 >= 2.0 * r {
                continue;
            }
            for m in piece_distance_minima(&pieces[i], &pieces[j]).as_slice() {
                let place = |k: usize, p: &Vec3| at[k] + pieces[k].length() * pieces[k].nearest(p);
                let way = (place(j, &m.point_b) - place(i, &m.point_a)).abs();
                if m.distance < 2.0 * r && way.min(total - way) > PI * r && least.is_none_or(|d| m.distance < d) {
                    least = Some(m.distance);
                }
            }
        }
    }
    least
}

/// The same for the struts of a frame, those apart that share a vertex.
pub(in super::super) fn frame_overlap(struts: &[Piece], edges: &[[u32; 2]], r: f64) -> Option<f64> {
    let mut least: Option<f64> = None;
    for (i, one) in struts.iter().enumerate() {
        for (j, other) in struts.iter().enumerate().skip(i + 1) {
            if edges[i].iter().any(|vertex| edges[j].contains(vertex)) {
                continue;
            }
            let distance = piece_distance_minima(one, other).closest().distance;
            if distance < 2.0 * r && least.is_none_or(|d| distance < d) {
                least = Some(distance);
            }
        }
    }
    least
}
