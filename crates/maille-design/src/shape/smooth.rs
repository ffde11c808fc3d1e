//! Smooth curves as biarcs.

use super::core::MOST_PIECES;
use maille_geometry::{Piece, Vec3, biarc};
use std::f64::consts::TAU;

/// Points of a span at which its deviation is measured.
const SAMPLES: usize = 8;

/// A smooth closed curve, given by point and derivative at 0 ≤ t ≤ 2π, as biarcs of `spans` equal spans of t: see [`biarcs`].
pub(super) fn smooth(spans: usize, tolerance: f64, at: impl Fn(f64) -> [Vec3; 2]) -> Option<(Vec<Piece>, f64)> {
    let spans = spans.max(1);
    // The last point is the first one, to the last digit.
    biarcs(spans, tolerance, |place| at(TAU * (place % spans as f64) / spans as f64))
}

/// A smooth curve, given by point and derivative at places that count spans, as biarcs: each span is halved until its sampled
/// points are within `tolerance`. With how far they are at most.
fn biarcs(spans: usize, tolerance: f64, at: impl Fn(f64) -> [Vec3; 2]) -> Option<(Vec<Piece>, f64)> {
    let mut open: Vec<[f64; 2]> = (0..spans).rev().map(|k| [k as f64, k as f64 + 1.0]).collect();
    let (mut pieces, mut deviation) = (Vec::new(), 0.0_f64);
    while let Some([first, last]) = open.pop() {
        if pieces.len() + 2 * (open.len() + 1) > MOST_PIECES {
            return None;
        }
        let ([start, leaving], [end, arriving]) = (at(first), at(last));
        let pair = biarc(start, leaving, end, arriving)?;
        let away = |sample: usize| {
            let point = at(first + (last - first) * sample as f64 / SAMPLES as f64)[0];
            let nearest = pair.iter().map(|piece| (piece.point(piece.nearest(&point)) - point).norm());
            nearest.fold(f64::INFINITY, f64::min)
        };
        let worst = (1..SAMPLES).map(away).fold(0.0, f64::max);
        if worst <= tolerance {
            deviation = deviation.max(worst);
            pieces.extend(pair);
        } else {
            let middle = 0.5 * (first + last);
            open.extend([[middle, last], [first, middle]]);
        }
    }
    Some((pieces, deviation))
}

/// A cubic spline through points: see `Shape::Spline`.
pub(super) fn through_points(points: &[[f64; 3]], closed: bool, tolerance: f64) -> Option<(Vec<Piece>, f64)> {
    let n = points.len();
    let spans = n - usize::from(!closed);
    let at = |k: usize| Vec3::from(points[k % n]);
    let chord = |k: usize| (at(k + 1) - at(k)).norm();
    // The derivative by chord length of the parabola through three points: at the middle one, point k, or at one end of the curve.
    let slope = |k: usize| {
        let middle = if closed { k + n } else { k.clamp(1, n - 2) };
        let (before, after) = (chord(middle - 1), chord(middle));
        let (arrives, leaves) = ((at(middle) - at(middle - 1)) / before, (at(middle + 1) - at(middle)) / after);
        let bend = (leaves - arrives) / (before + after);
        match k {
            0 if !closed => arrives - bend * before,
            _ if !closed && k == n - 1 => leaves + bend * after,
            _ => arrives + bend * before,
        }
    };
    let slopes: Vec<Vec3> = (0..n).map(slope).collect();
    biarcs(spans, tolerance, |place| {
        // The end of a closed curve is its start, to the last digit.
        let place = if closed { place % spans as f64 } else { place };
        let k = (place.floor() as usize).min(spans - 1);
        let (u, h) = (place - k as f64, chord(k));
        let (p, q, v, w) = (at(k), at(k + 1), slopes[k] * h, slopes[(k + 1) % n] * h);
        let (rise, bend) = (q - p, v + w - (q - p) * 2.0);
        let cubic = rise - v - bend;
        [p + v * u + (cubic + bend * u) * (u * u), v + cubic * (2.0 * u) + bend * (3.0 * u * u)]
    })
}
