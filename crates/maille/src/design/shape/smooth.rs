//! Smooth curves as biarcs.

use super::core::MOST_PIECES;
use maille_geometry::{Piece, Vec3, biarc};
use std::f64::consts::TAU;

/// Points of a span at which its deviation is measured.
const SAMPLES: usize = 8;

/// A smooth closed curve, given by point and derivative at 0 ≤ t ≤ 2π, as biarcs of equal spans of t, so many that sampled points are
/// within `tolerance`. From `spans` on, always twice as many.
pub(super) fn smooth(spans: usize, tolerance: f64, at: impl Fn(f64) -> [Vec3; 2]) -> Option<(Vec<Piece>, f64)> {
    let mut spans = spans.max(1);
    while 2 * spans <= MOST_PIECES {
        let t = |k: f64| TAU * k / spans as f64;
        let mut pieces = Vec::with_capacity(2 * spans);
        let mut worst: f64 = 0.0;
        for k in 0..spans {
            // The last point is the first one, to the last digit.
            let ([start, leaving], [end, arriving]) = (at(t(k as f64)), at(t(((k + 1) % spans) as f64)));
            let pair = biarc(start, leaving, end, arriving)?;
            for sample in 1..SAMPLES {
                let point = at(t(k as f64 + sample as f64 / SAMPLES as f64))[0];
                let away = pair.iter().map(|piece| (piece.point(piece.nearest(&point)) - point).norm());
                worst = worst.max(away.fold(f64::INFINITY, f64::min));
            }
            pieces.extend(pair);
        }
        if worst <= tolerance {
            return Some((pieces, worst));
        }
        spans *= 2;
    }
    None
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
