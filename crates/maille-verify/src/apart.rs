//! A proved lower bound of the distance of two circles.
//!
//! With p(θ) = C + ϱ (cos θ u + sin θ v) on the one circle, its height z and its distance ρ from the axis of the other one of
//! radius R, the distance is d(θ) = √f, f = z² + (ρ − R)² = |x|² + R² − 2Rρ, x = p − c. On the arc |θ − m| ≤ w
//!
//! - d is ϱ-Lipschitz in θ, so d ≥ d(m) − ϱ w;
//! - let q be x across the axis: |q′|, |q″| ≤ ϱ, so ρ″ = (|q′|² − ρ′²)/ρ + q·q″/ρ ≤ ϱ²/ρ₀ + ϱ with ρ₀ = ρ(m) − ϱ w > 0, and
//!   (|x|²)″ ≥ −2ϱ e, e the length of C − c in p's plane. Hence f″ ≥ −K, K = 2ϱ e + 2R (ϱ²/ρ₀ + ϱ), and
//!   f ≥ f(m) − |f′(m)| w − K w²/2.
//!
//! Arcs on which neither proves d ≥ t are halved. Where the circles touch at a point, the second bound needs some ten arcs for each
//! decade of the tolerance. Where they touch along an arc, about √(K/(2t·tolerance)) a radian; but
//!
//! - d ≥ |z|, and z runs between its ends h ± ϱ sin τ, so d ≥ |h| − ϱ sin τ: sharp for rings that lie on one another.
//!
//! Rounding: `slack` bounds the error of a coordinate. It is charged to d, as 2dδ + δ² to f, and as 2ϱδ(1 + R/ρ₀) to f′.

use crate::sheet::{Vec3, frame};
use maille_geometry::Circle;

/// What is known of the distance of two circles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Apart {
    /// Proved to be at least what was asked.
    Proved,
    /// There are points this near.
    Nearer(f64),
    /// Neither could be shown with [`ARCS`] arcs.
    Unknown(f64),
}

/// Arcs that are examined at most.
const ARCS: usize = 4_000_000;
/// Arcs of the first division.
const FIRST: usize = 8;

/// Whether the circles are at least `least` apart, `slack` being the error of their coordinates.
pub(crate) fn apart(one: &Circle, other: &Circle, least: f64, slack: f64) -> Apart {
    // The smaller one is divided into arcs.
    let (a, b) = if one.radius >= other.radius { (one, other) } else { (other, one) };
    let between = b.center - a.center;
    if between.norm() - a.radius - b.radius - slack >= least {
        return Apart::Proved;
    }
    let tilt = a.normal.cross(&b.normal).norm();
    if between.dot(&a.normal).abs() - b.radius * tilt - 4.0 * slack >= least {
        return Apart::Proved;
    }
    let arm = Arc::new(a, b);
    let mut nearest = f64::INFINITY;
    let half = std::f64::consts::PI / FIRST as f64;
    let mut open: Vec<(f64, f64)> = (0..FIRST).map(|k| (half * (2 * k + 1) as f64, half)).collect();
    let mut arcs = 0;
    while let Some((mid, half)) = open.pop() {
        arcs += 1;
        let at = arm.at(mid);
        nearest = nearest.min(at.distance);
        if at.distance + slack < least {
            return Apart::Nearer(arm.nearest(mid, half));
        }
        if arcs > ARCS {
            return Apart::Unknown(nearest);
        }
        // The arc's ends lie a little beyond, so that rounded halves leave no space between.
        if !arm.keeps(&at, half * (1.0 + 1e-9) + 1e-15, least, slack) {
            open.extend([(mid - 0.5 * half, 0.5 * half), (mid + 0.5 * half, 0.5 * half)]);
        }
    }
    Apart::Proved
}

/// A lower bound of the distance, at least half of it, if it is not 0 to rounding.
pub(crate) fn some_distance(a: &Circle, b: &Circle, slack: f64) -> Option<f64> {
    let mut least = a.radius.min(b.radius);
    while least > 1e3 * slack {
        match apart(a, b, least, slack) {
            Apart::Proved => return Some(least),
            Apart::Nearer(found) | Apart::Unknown(found) => least = (0.7 * found).min(0.7 * least),
        }
    }
    None
}

/// The smaller circle as seen from the larger one.
pub(crate) struct Arc<'a> {
    of: &'a Circle,
    between: Vec3,
    u: Vec3,
    v: Vec3,
    radius: f64,
    in_plane: f64,
}

/// The distance of a point of the arc.
pub(crate) struct Point {
    pub distance: f64,
    /// Derivative of the squared distance with the angle.
    pub slope: f64,
    axis: f64,
}

impl<'a> Arc<'a> {
    /// Points of `b`, distances from `a`.
    pub fn new(a: &'a Circle, b: &Circle) -> Self {
        let (u, v) = frame(&b.normal);
        let between = b.center - a.center;
        let in_plane = (between - b.normal.into_inner() * between.dot(&b.normal)).norm();
        Arc { of: a, between, u, v, radius: b.radius, in_plane }
    }

    /// The point at `angle`.
    pub fn at(&self, angle: f64) -> Point {
        let (sin, cos) = angle.sin_cos();
        let (out, along) = (self.u * cos + self.v * sin, self.v * cos - self.u * sin);
        let n = &self.of.normal;
        let x = self.between + out * self.radius;
        let z = x.dot(n);
        let q = x - n.into_inner() * z;
        let axis = q.norm();
        let turn = if axis > 0.0 { q.dot(&along) / axis } else { 0.0 };
        let slope = 2.0 * self.radius * (x.dot(&along) - self.of.radius * turn);
        Point { distance: z.hypot(axis - self.of.radius), slope, axis }
    }

    /// Whether all of the arc around `at` is proved to be `least` away.
    fn keeps(&self, at: &Point, half: f64, least: f64, slack: f64) -> bool {
        let moved = self.radius * half;
        if at.distance - moved - slack >= least {
            return true;
        }
        let axis = at.axis - moved - slack;
        if axis <= 0.0 {
            return false;
        }
        let (of, own) = (self.of.radius, self.radius);
        let bend = 2.0 * own * (self.in_plane + slack) + 2.0 * of * (own * own / axis + own);
        let slope = at.slope.abs() + 2.0 * own * slack * (1.0 + of / axis);
        let value = at.distance * at.distance - (2.0 * at.distance + slack) * slack;
        value - slope * half - 0.5 * bend * half * half >= least * least
    }

    /// The least distance near an angle, by halving between its neighbours (golden section).
    fn nearest(&self, mid: f64, half: f64) -> f64 {
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (mid - half, mid + half);
        for _ in 0..60 {
            let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
            if self.at(left).distance < self.at(right).distance { high = right } else { low = left }
        }
        self.at(0.5 * (low + high)).distance.min(self.at(mid).distance)
    }
}

/// Distance of the point of `b` at `angle` in its [`frame`] from `a`.
#[cfg(test)]
fn distance_at(a: &Circle, b: &Circle, angle: f64) -> f64 {
    let (u, v) = frame(&b.normal);
    crate::sheet::distance(&(b.center + (u * angle.cos() + v * angle.sin()) * b.radius), a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Unit;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn circle(center: [f64; 3], normal: [f64; 3], radius: f64) -> Circle {
        Circle::new(center.into(), Unit::new_normalize(normal.into()), radius)
    }

    /// Against a hundred thousand points: what is proved is never above the least that is seen, and 1e-9 below it is proved.
    #[test]
    fn random_pairs_are_as_far_apart_as_their_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for k in 0..300 {
            let mut vector = |size: f64| [0; 3].map(|_| size * rng.random_range(-1.0..1.0));
            let (center, n, m) = (vector(1.5), vector(1.0), vector(1.0));
            let radius = 10.0_f64.powf(rng.random_range(-3.0..0.0));
            let (a, b) = (circle([0.0; 3], n, 1.0), circle(center, m, radius));
            let steps = 20_000;
            let seen = (0..steps).map(|k| distance_at(&a, &b, f64::from(k) / f64::from(steps) * std::f64::consts::TAU));
            let seen = seen.fold(f64::INFINITY, f64::min);
            // The grid is off by less than ϱ times half a step.
            let off = radius * std::f64::consts::PI / f64::from(steps);
            assert!(matches!(apart(&a, &b, seen - off, 1e-14), Apart::Proved), "{k}");
            match apart(&a, &b, seen + 1e-9, 1e-14) {
                Apart::Nearer(found) => assert!(found <= seen + 1e-9 && found >= seen - off - 1e-12, "{k}"),
                other => panic!("{k}: {other:?}"),
            }
        }
    }

    #[test]
    fn touching_and_flat_pairs_are_proved_to_the_tolerance() {
        let a = circle([0.0; 3], [0.0, 0.0, 1.0], 1.0);
        // Coaxial; parallel and offset; across; nearly coaxial with a tilt.
        let cases = [
            (circle([0.0, 0.0, 0.2], [0.0, 0.0, 1.0], 1.0), 0.2),
            (circle([0.05, 0.0, 0.2], [0.0, 0.0, 1.0], 1.0), 0.2),
            (circle([0.0, 1.8, 0.0], [1.0, 0.0, 0.0], 1.0), 0.2),
            (circle([2.2, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0), 0.2),
            (circle([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.8), 0.2),
        ];
        for (b, distance) in cases {
            assert!(matches!(apart(&a, &b, distance - 1e-9, 1e-14), Apart::Proved), "{b:?}");
            assert!(matches!(apart(&a, &b, distance + 1e-9, 1e-14), Apart::Nearer(_)), "{b:?}");
        }
    }
}
