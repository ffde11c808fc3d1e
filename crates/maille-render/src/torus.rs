//! Where a ray meets a torus, and how far a point is from one.

use maille_geometry::{Torus, Vec3};

/// A ray `o + t d`, `t ≥ 0`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin `o`.
    pub origin: Vec3,
    /// Unit direction `d`.
    pub direction: Vec3,
}

impl Ray {
    /// The point `o + t d`.
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// The smallest `t` in `[0, most]` at which a ray that starts outside of the torus meets it.
///
/// With `s` counted from the point of the ray nearest to the centre, `k` the square of its distance, `a + b s` the
/// height over the plane of the core circle and `m = k + R² − r²`, the implicit equation
/// `(|p|² + R² − r²)² = 4 R² (|p|² − (p·N)²)` is the depressed quartic
///
/// `f(s) = s⁴ + 2 (m − 2 R² (1 − b²)) s² + 8 R² a b s + m² − 4 R² (k − a²)`, positive outside.
///
/// Between its critical points, the roots of a depressed cubic, `f` is monotone: the first of them with `f ≤ 0` ends the
/// bracket of the entry, which Newton's method with bisection closes to a few units in the last place. So a ray that
/// grazes is decided by the sign of `f` at a minimum, where errors of the minimum count only to second order; a graze
/// of less than about 1e-15 R⁴ in `f` falls to either side.
pub fn first_hit(torus: &Torus, ray: &Ray, most: f64) -> Option<f64> {
    let (big, small) = (torus.circle.radius, torus.minor_radius);
    let from_center = ray.origin - torus.circle.center;
    let nearest = -from_center.dot(&ray.direction);
    let foot = from_center + ray.direction * nearest;
    let k = foot.norm_squared();
    let sphere = (big + small) * (big + small) - k;
    if sphere < 0.0 {
        return None;
    }
    let (a, b) = (foot.dot(&torus.circle.normal), ray.direction.dot(&torus.circle.normal));
    let half = sphere.sqrt();
    let (mut low, mut high) = ((-half).max(-nearest), half.min(most - nearest));
    if b == 0.0 {
        if a.abs() > small {
            return None;
        }
    } else {
        let (one, other) = ((-small - a) / b, (small - a) / b);
        low = low.max(one.min(other));
        high = high.min(one.max(other));
    }
    if low > high {
        return None;
    }
    let m = k + big * big - small * small;
    let p = 2.0 * m - 4.0 * big * big * (1.0 - b * b);
    let q = 8.0 * big * big * a * b;
    let w = m * m - 4.0 * big * big * (k - a * a);
    let f = |s: f64| ((s * s + p) * s + q) * s + w;
    let slope = |s: f64| (4.0 * s * s + 2.0 * p) * s + q;
    if f(low) <= 0.0 {
        return Some(low + nearest);
    }
    let (critical, count) = cubic_roots(p / 2.0, q / 4.0);
    let inside = critical[..count].iter().copied().filter(|s| *s > low && *s < high);
    let mut before = low;
    for s in inside.chain([high]) {
        if f(s) <= 0.0 {
            return Some(falling_root(f, slope, before, s) + nearest);
        }
        before = s;
    }
    None
}

/// The real roots of `x³ + g x + h`, ascending; a double root may come twice or not at all.
fn cubic_roots(g: f64, h: f64) -> ([f64; 3], usize) {
    let polish = |x: f64| {
        let slope = 3.0 * x * x + g;
        if slope == 0.0 { x } else { x - ((x * x + g) * x + h) / slope }
    };
    let discriminant = h * h / 4.0 + g * g * g / 27.0;
    if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        let large = (-h / 2.0 - root.copysign(h)).cbrt();
        let x = if large == 0.0 { 0.0 } else { large - g / (3.0 * large) };
        return ([polish(x), 0.0, 0.0], 1);
    }
    let size = 2.0 * (-g / 3.0).sqrt();
    let third = (3.0 * h / (g * size)).clamp(-1.0, 1.0).acos() / 3.0;
    let turn = std::f64::consts::TAU / 3.0;
    ([third + turn, third - turn, third].map(|angle| polish(size * angle.cos())), 3)
}

/// The root in `[low, high]` of an `f` that falls there from above zero to zero or below.
fn falling_root(f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let mut s = 0.5 * (low + high);
    for _ in 0..80 {
        let value = f(s);
        if value > 0.0 {
            low = s
        } else {
            high = s
        }
        let newton = s - value / slope(s);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - s).abs() <= 4.0 * f64::EPSILON * s.abs().max(1e-3 * (high - low)) || next == low || next == high {
            return next;
        }
        s = next;
    }
    s
}

/// Distance of a point from the surface, negative inside: `hypot(z, ρ − R) − r`.
pub fn distance(torus: &Torus, p: &Vec3) -> f64 {
    let delta = p - torus.circle.center;
    let z = delta.dot(&torus.circle.normal);
    let rho = (delta.norm_squared() - z * z).max(0.0).sqrt() - torus.circle.radius;
    (z * z + rho * rho).sqrt() - torus.minor_radius
}

/// Outward unit normal and unit tangent along the core circle at a point of the surface.
pub fn frame_at(torus: &Torus, p: &Vec3) -> (Vec3, Vec3) {
    let axis = torus.circle.normal.into_inner();
    let delta = p - torus.circle.center;
    let z = delta.dot(&axis);
    let radial = (delta - axis * z).normalize();
    let normal = (radial * (delta.dot(&radial) - torus.circle.radius) + axis * z).normalize();
    (normal, axis.cross(&radial))
}
