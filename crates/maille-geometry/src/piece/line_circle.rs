//! All local minima of the distance of a line and a circle.
//!
//! Let t be the position on the line from the foot of the circle's centre, `q(t) = q₀ + t v` the projection of the
//! line onto the circle's plane, from the centre, and `Δ = |q₀ × v|²`. Half the squared distance of the line's point
//! from the circle has the derivatives
//!
//! ```text
//! f'(t) = t − R q·v / |q|,   f''(t) = 1 − R Δ / |q|³.
//! ```
//!
//! `|q|` is least at one t₀ and grows to both sides, so f'' ≥ 0 but for one interval (t₋, t₊) about t₀, where
//! `|q|³ < R Δ`; it is empty if `|q(t₀)|³ ≥ R Δ`. Hence f has at most one minimum to the right of t₊, which exists
//! if f'(t₊) < 0, and at most one to the left of t₋. As `|q·v| ≤ |v| |q|`, both lie within `|t| ≤ R |v|`. To the right
//! of t₊ f' is convex, so Newton's method comes down from `R |v|` to the root without passing it; likewise on the left.

use crate::{
    circle::{Circle, Vec3},
    tolerance::ROUNDING,
};
use arrayvec::ArrayVec;

/// Newton's method doubles the digits, but for two minima that merge.
const MAX_STEPS: usize = 80;

/// The points of the line through `p` along the unit vector `u` at which its distance from the circle has a local
/// minimum: one or two.
pub(super) fn line_circle_minima(p: &Vec3, u: &Vec3, circle: &Circle) -> ArrayVec<Vec3, 2> {
    let foot = p + u * (circle.center - p).dot(u);
    let delta = foot - circle.center;
    let flat = |x: &Vec3| x - *circle.normal * circle.normal.dot(x);
    let (q0, v) = (flat(&delta), flat(u));
    let (speed_sq, cross) = (v.norm_squared(), q0.cross(&v).norm());
    let speed = speed_sq.sqrt();
    let r = circle.radius;
    let mut out = ArrayVec::new();
    if speed == 0.0 {
        out.push(foot); // parallel to the axis
        return out;
    }
    // The slope; on the axis, to rounding, that to the side `side`.
    let noise = ROUNDING * (p - circle.center).norm();
    let slope = |t: f64, side: f64| {
        let q = q0 + v * t;
        let length = q.norm();
        t - r * if length <= noise { side * speed } else { q.dot(&v) / length }
    };
    let lowest = -q0.dot(&v) / speed_sq;
    let bend_sq = (r * cross * cross).cbrt().powi(2);
    let half_width = (bend_sq - (cross / speed).powi(2)).max(0.0).sqrt() / speed;
    for side in [-1.0, 1.0] {
        let from = lowest + side * half_width;
        let there = side * slope(from, side);
        // A root at t₀ of a slope that only rises is found from the right.
        if there < 0.0 || there == 0.0 && half_width == 0.0 && side > 0.0 {
            let mut t = side * r * speed;
            for _ in 0..MAX_STEPS {
                let q = (q0 + v * t).norm();
                let next = t - slope(t, side) / (1.0 - r * (cross / q) * (cross / q) / q);
                // Rounding ends it: the step turns round, or passes the interval's end.
                if !(side * (t - next) > 0.0 && side * (next - from) >= 0.0) {
                    break;
                }
                t = next;
            }
            out.push(foot + u * t);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(p: &Vec3, circle: &Circle) -> f64 {
        crate::circle::point_circle_distance(p, circle).distance
    }

    #[test]
    fn known_positions() {
        let circle = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
        let at = |p: [f64; 3], u: [f64; 3]| {
            let found = line_circle_minima(&Vec3::from(p), &Vec3::from(u), &circle);
            let mut out: Vec<[f64; 3]> = found.iter().map(|x| (*x).into()).collect();
            out.sort_by(|a, b| a.partial_cmp(b).unwrap());
            out
        };
        // Through the axis: both points of the circle in its plane.
        assert_eq!(at([3.0, 0.0, 0.5], [1.0, 0.0, 0.0]), [[-1.0, 0.0, 0.5], [1.0, 0.0, 0.5]]);
        // A secant crosses the circle twice.
        let secant = at([3.0, 0.6, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(secant.len(), 2);
        assert!(secant.iter().all(|x| (x[0].abs() - 0.8).abs() < 1e-15), "{secant:?}");
        // Outside, and parallel to the axis, there is one.
        assert_eq!(at([5.0, 2.0, 0.0], [1.0, 0.0, 0.0]), [[0.0, 2.0, 0.0]]);
        assert_eq!(at([0.3, 0.0, 7.0], [0.0, 0.0, 1.0]), [[0.3, 0.0, 0.0]]);
        assert_eq!(at([0.0, 0.0, 7.0], [0.0, 0.0, 1.0]), [[0.0, 0.0, 0.0]]);
        // Tangent from inside: at the height where both minima merge.
        let merged = at([1.0, 1.0 - 1e-9, 0.0], [1.0, 0.0, 0.0]);
        assert!(merged.iter().all(|x| distance(&Vec3::from(*x), &circle) < 1e-12), "{merged:?}");
    }
}
