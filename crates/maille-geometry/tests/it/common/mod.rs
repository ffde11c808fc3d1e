//! Pairs of circles for the tests, and a brute-force oracle that shares no code with the crate.

use std::f64::consts::{PI, TAU};

use maille_geometry::{Circle, Vec3, linking_number};
use nalgebra::{Rotation3, UnitVector3};
pub use rand::rngs::ChaCha8Rng as Rng;
use rand::{RngExt, SeedableRng};

pub fn rng(seed: u64) -> Rng {
    Rng::seed_from_u64(seed)
}

/// Uniform on the unit sphere.
pub fn direction(rng: &mut Rng) -> UnitVector3<f64> {
    let z: f64 = rng.random_range(-1.0..1.0);
    let angle = rng.random_range(0.0..TAU);
    let rho = (1.0 - z * z).sqrt();
    UnitVector3::new_normalize(Vec3::new(rho * angle.cos(), rho * angle.sin(), z))
}

pub fn rotation(rng: &mut Rng) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&direction(rng), rng.random_range(0.0..PI))
}

pub fn unit(x: f64, y: f64, z: f64) -> UnitVector3<f64> {
    UnitVector3::new_normalize(Vec3::new(x, y, z))
}

pub fn circle(center: [f64; 3], normal: [f64; 3], radius: f64) -> Circle {
    Circle::new(Vec3::from(center), unit(normal[0], normal[1], normal[2]), radius)
}

pub fn scale(a: &Circle, b: &Circle) -> f64 {
    (b.center - a.center).norm().max(a.radius).max(b.radius)
}

pub fn moved(c: &Circle, by: &Rotation3<f64>, shift: &Vec3) -> Circle {
    Circle::new(by * c.center + shift, UnitVector3::new_normalize(by * *c.normal), c.radius)
}

pub type Pair = (Circle, Circle);
pub type Family = fn(&mut Rng) -> Pair;

/// The families of random pairs.
pub const FAMILIES: [(&str, Family); 6] = [
    ("uniform", uniform),
    ("linked", linked),
    ("thin gap", thin_gap),
    ("near degenerate", near_degenerate),
    ("unequal", unequal),
    ("symmetric", symmetric),
];

pub fn uniform(rng: &mut Rng) -> Pair {
    let offset = Vec3::from_fn(|_, _| rng.random_range(-2.0..2.0));
    let radius = rng.random_range(0.2..1.5);
    (Circle::new(Vec3::zeros(), direction(rng), 1.0), Circle::new(offset, direction(rng), radius))
}

pub fn linked(rng: &mut Rng) -> Pair {
    loop {
        let pair = uniform(rng);
        if linking_number(&pair.0, &pair.1) != 0 {
            return pair;
        }
    }
}

/// Pairs whose distance at one point is 1e-9 … 0.05, with any angle between the tangents there.
pub fn thin_gap(rng: &mut Rng) -> Pair {
    let a = Circle::new(Vec3::zeros(), direction(rng), 1.0);
    let on_a = a.point(rng.random_range(-PI..PI));
    let gap = 10f64.powf(rng.random_range(-9.0..-1.3));
    let radius = rng.random_range(0.5..1.5);
    let normal = direction(rng);
    let b = Circle::new(Vec3::zeros(), normal, radius);
    let on_b = b.point(rng.random_range(-PI..PI));
    let across = (on_b.cross(&normal) / radius).cross(&(a.normal.cross(&on_a)));
    let across = if across.norm() > 1e-6 { across.normalize() } else { *direction(rng) };
    (a, Circle::new(on_a + across * gap - on_b, normal, radius))
}

/// A degenerate pair with its radii, offset and normal perturbed by 1e-12 … 1e-2.
pub fn near_degenerate(rng: &mut Rng) -> Pair {
    let (a, b) = degenerate(rng);
    let by = 10f64.powf(rng.random_range(-12.0..-2.0));
    let part = |rng: &mut Rng| if rng.random_bool(0.7) { by } else { 0.0 };
    let center = b.center + *direction(rng) * part(rng);
    let normal = UnitVector3::new_normalize(*b.normal + *direction(rng) * part(rng));
    (a, Circle::new(center, normal, b.radius * (1.0 + part(rng) * rng.random_range(-1.0..1.0))))
}

/// Degenerate up to rounding: all families of the crate documentation, in random poses.
pub fn degenerate(rng: &mut Rng) -> Pair {
    let radius = if rng.random_bool(0.5) { 1.0 } else { rng.random_range(0.3..1.5) };
    let d = rng.random_range(0.0..2.5);
    let a = circle([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    let angle: f64 = rng.random_range(0.0..TAU);
    let b = match rng.random_range(0..8) {
        0 => circle([0.0, 0.0, d], [0.0, 0.0, 1.0], radius),
        1 => circle([d, 0.0, 0.0], [0.0, 0.0, -1.0], radius),
        2 => circle([0.0; 3], [angle.cos(), 0.0, angle.sin()], radius),
        3 => circle([0.0; 3], [0.0, 0.0, 1.0], 1.0),
        // Perpendicular, through the centre of A or a point of its axis.
        4 => circle([radius, 0.0, 0.0], [0.0, 1.0, 0.0], radius),
        5 => circle([radius * angle.cos(), radius * angle.sin(), d], [0.0, 0.0, 1.0], radius),
        6 => villarceau(rng.random_range(0.02..0.98), 1.0, rng.random_bool(0.5)).1,
        // A meridian pair: B is centred on a point of A.
        _ => circle([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], radius.min(1.0)),
    };
    let (by, shift) = (rotation(rng), *direction(rng));
    (moved(&a, &by, &shift), moved(&b, &by, &shift))
}

/// Circles of radius `radius` at the constant distance `distance`.
pub fn villarceau(distance: f64, radius: f64, left: bool) -> Pair {
    let tilt = (distance / radius).asin() * if left { -1.0 } else { 1.0 };
    (circle([0.0; 3], [0.0, 0.0, 1.0], radius), circle([distance, 0.0, 0.0], [0.0, tilt.sin(), tilt.cos()], radius))
}

/// Radii from 1e-3 to 1, offsets of any of the lengths.
pub fn unequal(rng: &mut Rng) -> Pair {
    let length = |rng: &mut Rng| 10f64.powf(rng.random_range(-3.0..0.0));
    let offset = *direction(rng) * length(rng);
    let a = Circle::new(Vec3::zeros(), direction(rng), length(rng));
    let near = if rng.random_bool(0.5) { a.point(rng.random_range(-PI..PI)) } else { Vec3::zeros() };
    (a, Circle::new(offset + near, direction(rng), length(rng)))
}

/// Positions on a coarse grid with symmetry planes, as in designs of chainmail.
pub fn symmetric(rng: &mut Rng) -> Pair {
    let step = |rng: &mut Rng| f64::from(rng.random_range(-4..=4)) * 0.5;
    let offset = Vec3::from_fn(|_, _| step(rng));
    let normal = |rng: &mut Rng| loop {
        let v = Vec3::from_fn(|_, _| f64::from(rng.random_range(-1..=1)));
        if v.norm() > 0.5 {
            return UnitVector3::new_normalize(v);
        }
    };
    let radius = f64::from(rng.random_range(1..=3)) * 0.5;
    (Circle::new(Vec3::zeros(), normal(rng), 1.0), Circle::new(offset, normal(rng), radius))
}

/// A minimum found by sampling.
#[derive(Clone, Copy, Debug)]
pub struct Oracle {
    pub distance: f64,
    pub point_b: Vec3,
}

/// The distance of points along circle B from circle A, by the simplest formula.
pub struct Along {
    u: Vec3,
    v: Vec3,
    b: Circle,
    a: Circle,
}

impl Along {
    pub fn new(a: &Circle, b: &Circle) -> Self {
        let n = *b.normal;
        let aside = if n.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
        let u = (aside - n * n.dot(&aside)).normalize();
        Self { u, v: n.cross(&u), a: *a, b: *b }
    }

    pub fn point(&self, angle: f64) -> Vec3 {
        self.b.center + self.b.radius * (self.u * angle.cos() + self.v * angle.sin())
    }

    pub fn angle(&self, point: &Vec3) -> f64 {
        let w = point - self.b.center;
        w.dot(&self.v).atan2(w.dot(&self.u))
    }

    /// Is there no barrier between two points of B on the shorter arc?
    pub fn is_level_between(&self, p: &Vec3, q: &Vec3, by: f64) -> bool {
        let (from, to) = (self.angle(p), self.angle(q));
        let arc = (to - from + PI).rem_euclid(TAU) - PI;
        let highest = self.distance(from).max(self.distance(to)) + by;
        (0..=64).all(|i| self.distance(from + arc * f64::from(i) / 64.0) <= highest)
    }

    pub fn distance(&self, angle: f64) -> f64 {
        self.distance_at(angle.cos(), angle.sin())
    }

    fn distance_at(&self, cos: f64, sin: f64) -> f64 {
        let w = self.b.center - self.a.center + self.b.radius * (self.u * cos + self.v * sin);
        let z = w.dot(&self.a.normal);
        let flat = w - *self.a.normal * z;
        let radial = flat.norm() - self.a.radius;
        (z * z + radial * radial).sqrt()
    }
}

/// The cosines and sines of the samples.
pub fn sample_angles(count: usize) -> Vec<(f64, f64, f64)> {
    (0..count)
        .map(|i| {
            let angle = i as f64 * TAU / count as f64;
            (angle, angle.cos(), angle.sin())
        })
        .collect()
}

/// The local minima along B of the distance from A: local minima of the samples, refined by golden-section search.
/// Minima shallower than `1e-11` of the pair's largest length are left out: rounding creates such where the
/// distance is constant.
pub fn oracle(a: &Circle, b: &Circle, angles: &[(f64, f64, f64)]) -> Vec<Oracle> {
    let along = Along::new(a, b);
    let shallow = 1e-11 * scale(a, b);
    let values: Vec<f64> = angles.iter().map(|&(_, cos, sin)| along.distance_at(cos, sin)).collect();
    let n = values.len();
    let mut found = Vec::new();
    for i in 0..n {
        let (left, right) = (values[(i + n - 1) % n], values[(i + 1) % n]);
        if values[i] > left || values[i] >= right {
            continue;
        }
        let rises = |step: usize| {
            (1..n)
                .map(|k| values[(i + k * step) % n] - values[i])
                .find(|rise| rise.abs() > shallow)
                .is_some_and(|rise| rise > 0.0)
        };
        if rises(1) && rises(n - 1) {
            let width = TAU / n as f64;
            let angle = golden(|t| along.distance(t), angles[i].0 - width, angles[i].0 + width);
            found.push(Oracle { distance: along.distance(angle), point_b: along.point(angle) });
        }
    }
    found
}

fn golden(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut p, mut q) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut fp, mut fq) = (f(p), f(q));
    while high - low > 1e-13 {
        if fp < fq {
            (high, q, fq) = (q, p, fp);
            p = high - ratio * (high - low);
            fp = f(p);
        } else {
            (low, p, fp) = (p, q, fq);
            q = low + ratio * (high - low);
            fq = f(q);
        }
    }
    0.5 * (low + high)
}
