//! Where two circles are near each other: local minima of their distance, and the direction in which they are least linked.

use maille_verify::proof::plain::{across, add, cross, dot, length, unit};
use std::f64::consts::TAU;

/// Points of the second circle from which minima are sought.
const POINTS: usize = 48;
/// The golden ratio, and cuts of the arc between two points: to 1e-4 of it.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const CUTS: usize = 18;
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
    let on = |cos: f64, sin: f64| add(&u.map(|x| x * cos), sin, &v);
    let arm = |angle: f64| on(angle.cos(), angle.sin());
    let far: Vec<f64> = table.iter().map(|(cos, sin)| foot(a, &add(centre, *radius, &on(*cos, *sin))).1).collect();
    let mut out: Vec<Near> = Vec::new();
    let n = far.len();
    for k in 0..n {
        let least = far[k] <= far[(k + 1) % n] && far[k] < far[(k + n - 1) % n];
        if !least || far[k] > (reach + 0.2 * radius).powi(2) {
            continue;
        }
        let step = TAU / n as f64;
        let (near, distance) = refined(a, b, arm, (k as f64 - 1.0) * step, (k as f64 + 1.0) * step);
        if distance < reach {
            out.push(near);
        }
    }
    out
}

/// The least distance of a point of b from circle a, by golden section between the two neighbours of a point of the table: where
/// the circles run side by side the minimum is flat, and Newton's method leaves it.
fn refined(a: &Circle, b: &Circle, arm: impl Fn(f64) -> [f64; 3], mut low: f64, mut high: f64) -> (Near, f64) {
    let at = |angle: f64| {
        let y = arm(angle);
        let (x, square) = foot(a, &add(&b.0, b.2, &y));
        ([x, y], square)
    };
    let inner = |low: f64, high: f64| high - GOLDEN * (high - low);
    let (mut p, mut q) = (inner(low, high), inner(high, low));
    let (mut at_p, mut at_q) = (at(p), at(q));
    for _ in 0..CUTS {
        if at_p.1 < at_q.1 {
            (high, q, at_q) = (q, p, at_p);
            p = inner(low, high);
            at_p = at(p);
        } else {
            (low, p, at_p) = (p, q, at_q);
            q = inner(high, low);
            at_q = at(q);
        }
    }
    let (near, square) = if at_p.1 < at_q.1 { at_p } else { at_q };
    (near, square.sqrt())
}

/// The unit vector n for which R_a √(1 − (n·n_a)²) + R_b √(1 − (n·n_b)²) − n·w is about smallest.
pub(crate) fn least_overlap(normals: &[[f64; 3]; 2], radii: [f64; 2], w: &[f64; 3]) -> [f64; 3] {
    let mut n = unit(w);
    let mut best = (f64::INFINITY, n);
    for turn in 0..TURNS {
        let flat = normals.map(|normal| across(&n, &normal));
        let sizes = [length(&flat[0]), length(&flat[1])];
        let overlap = radii[0] * sizes[0] + radii[1] * sizes[1] - dot(&n, w);
        if overlap < best.0 {
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
