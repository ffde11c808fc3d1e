//! Where two circles are near each other: local minima of their distance, and the direction in which they are least linked.

use maille_verify::proof::plain::{across, add, cross, dot, length, unit};
use std::f64::consts::TAU;

/// Points of the second circle from which minima are sought.
const POINTS: usize = 32;
/// Newton steps, and the farthest that one goes, in radians.
const STEPS: usize = 6;
const FARTHEST: f64 = 0.2;
/// Steps towards the direction along which linked circles overlap least.
const TURNS: usize = 14;

/// A circle: centre, unit normal, radius.
pub(crate) type Circle = ([f64; 3], [f64; 3], f64);

/// A local minimum: the unit vectors from the centres to the two points.
pub(crate) type Near = [[f64; 3]; 2];

/// cos and sin of the points.
pub(crate) fn table() -> Vec<(f64, f64)> {
    let at = |k: usize| (TAU * k as f64 / POINTS as f64).sin_cos();
    (0..POINTS).map(at).map(|(sin, cos)| (cos, sin)).collect()
}

/// The point of a circle that is nearest to q, as a unit vector from its centre, and the distance squared.
fn foot((centre, normal, radius): &Circle, q: &[f64; 3]) -> ([f64; 3], f64) {
    let x = add(q, -1.0, centre);
    let (high, flat) = (dot(&x, normal), across(&x, normal));
    let far = length(&flat).max(1e-12);
    (flat.map(|k| k / far), high * high + (far - radius) * (far - radius))
}

/// Local minima of the distance that are below `reach`.
pub(crate) fn minima(a: &Circle, b: &Circle, table: &[(f64, f64)], reach: f64) -> Vec<Near> {
    let (centre, normal, radius) = b;
    let axis = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let u = unit(&cross(normal, &axis));
    let v = cross(normal, &u);
    let arms: Vec<[f64; 3]> = table.iter().map(|(cos, sin)| add(&u.map(|x| x * cos), *sin, &v)).collect();
    let far: Vec<f64> = arms.iter().map(|arm| foot(a, &add(centre, *radius, arm)).1).collect();
    let mut out: Vec<Near> = Vec::new();
    let n = arms.len();
    for k in 0..n {
        let least = far[k] <= far[(k + 1) % n] && far[k] < far[(k + n - 1) % n];
        if !least || far[k] > (reach + 0.25 * radius).powi(2) {
            continue;
        }
        let (near, distance) = refined(a, b, arms[k]);
        let known = |other: &Near| dot(&other[0], &near[0]) > 0.999 && dot(&other[1], &near[1]) > 0.999;
        if distance < reach && !out.iter().any(known) {
            out.push(near);
        }
    }
    out
}

/// Newton's method for the squared distance of points at angles along both circles.
fn refined(a: &Circle, b: &Circle, start: [f64; 3]) -> (Near, f64) {
    let between = |x: &[f64; 3], y: &[f64; 3]| add(&add(&add(&b.0, b.2, y), -1.0, &a.0), -a.2, x);
    let (mut x, mut y) = (foot(a, &add(&b.0, b.2, &start)).0, start);
    for _ in 0..STEPS {
        let (s, t, v) = (cross(&a.1, &x), cross(&b.1, &y), between(&x, &y));
        let (g, h) = (-a.2 * dot(&v, &s), b.2 * dot(&v, &t));
        let mut xx = a.2 * (a.2 + dot(&v, &x));
        let mut yy = b.2 * (b.2 - dot(&v, &y));
        let xy = -a.2 * b.2 * dot(&s, &t);
        let mut det = xx * yy - xy * xy;
        if det < 0.05 * (a.2 * b.2).powi(2) {
            let more = 0.1 * a.2 * b.2 + xy.abs();
            (xx, yy) = (xx.max(0.0) + more, yy.max(0.0) + more);
            det = xx * yy - xy * xy;
        }
        let (dx, dy) = (-(yy * g - xy * h) / det, -(xx * h - xy * g) / det);
        let far = dx.abs().max(dy.abs());
        let part = if far > FARTHEST { FARTHEST / far } else { 1.0 };
        (x, y) = (unit(&add(&x, dx * part, &s)), unit(&add(&y, dy * part, &t)));
        if far < 1e-6 {
            break;
        }
    }
    ([x, y], length(&between(&x, &y)))
}

/// The unit vector n for which R_a √(1 − (n·n_a)²) + R_b √(1 − (n·n_b)²) − n·w is about smallest.
pub(crate) fn least_overlap(normals: &[[f64; 3]; 2], radii: [f64; 2], w: &[f64; 3]) -> [f64; 3] {
    let mut n = unit(w);
    let mut best = (f64::INFINITY, n);
    for turn in 0..TURNS {
        let flat = normals.map(|normal| across(&n, &normal));
        let sizes = [length(&flat[0]), length(&flat[1])];
        let overlap = radii[0] * sizes[0] + radii[1] * sizes[1] - dot(&n, w);
        if overlap < best.0 && sizes[0] > 0.12 && sizes[1] > 0.12 {
            best = (overlap, n);
        }
        let mut rise = w.map(|x| -x);
        for k in 0..2 {
            rise = add(&rise, radii[k] / sizes[k].max(0.05), &flat[k]);
        }
        let step = 0.5 / (1.0 + 0.25 * turn as f64) / radii[0].max(radii[1]);
        n = unit(&add(&n, -step, &across(&rise, &n)));
    }
    best.1
}
