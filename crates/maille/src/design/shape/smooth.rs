//! Smooth curves as biarcs.

use super::core::MOST_PIECES;
use maille_geometry::{Piece, Vec3, biarc};
use std::f64::consts::TAU;

/// Points of a span at which its deviation is measured.
const SAMPLES: usize = 8;

/// A smooth closed curve, given by point and derivative at 0 ≤ t ≤ 2π, as biarcs of `spans` equal spans of t, each halved until its sampled
/// points are within `tolerance`. With how far they are at most.
pub(super) fn smooth(spans: usize, tolerance: f64, at: impl Fn(f64) -> [Vec3; 2]) -> Option<(Vec<Piece>, f64)> {
    let whole = spans.max(1) as f64;
    // Places count spans, so that halves of them are exact, and the last point is the first one, to the last digit.
    let t = |place: f64| TAU * (place % whole) / whole;
    let mut open: Vec<[f64; 2]> = (0..spans.max(1)).rev().map(|k| [k as f64, k as f64 + 1.0]).collect();
    let (mut pieces, mut deviation) = (Vec::new(), 0.0_f64);
    while let Some([first, last]) = open.pop() {
        if pieces.len() + 2 * (open.len() + 1) > MOST_PIECES {
            return None;
        }
        let ([start, leaving], [end, arriving]) = (at(t(first)), at(t(last)));
        let pair = biarc(start, leaving, end, arriving)?;
        let away = |sample: usize| {
            let point = at(t(first + (last - first) * sample as f64 / SAMPLES as f64))[0];
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

/// A closed cubic spline through points: see `Shape::Spline`.
pub(super) fn through_points(points: &[[f64; 3]], tolerance: f64) -> Option<(Vec<Piece>, f64)> {
    let n = points.len();
    let at = |k: usize| Vec3::from(points[k % n]);
    let chord = |k: usize| (at(k + 1) - at(k)).norm();
    // The derivative by chord length, at each point, of the parabola through it and its neighbours.
    let slope = |k: usize| {
        let (before, after) = (chord(k + n - 1), chord(k));
        let (arrives, leaves) = ((at(k) - at(k + n - 1)) / before, (at(k + 1) - at(k)) / after);
        (arrives * after + leaves * before) / (before + after)
    };
    let slopes: Vec<Vec3> = (0..n).map(slope).collect();
    smooth(n, tolerance, |t| {
        let place = t / TAU * n as f64;
        // A whole number that rounding lowered stays that number.
        let k = ((place + 1e-9).floor() as usize) % n;
        let (u, h) = ((place - k as f64).max(0.0), chord(k));
        let (p, q, v, w) = (at(k), at(k + 1), slopes[k] * h, slopes[(k + 1) % n] * h);
        let (rise, bend) = (q - p, v + w - (q - p) * 2.0);
        let cubic = rise - v - bend;
        [p + v * u + (cubic + bend * u) * (u * u), v + cubic * (2.0 * u) + bend * (3.0 * u * u)]
    })
}
