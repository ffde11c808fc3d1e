//! The smallest ball that holds curves. Any ball that holds them bounds their links: with the smallest one the bounds are those
//! of the program.

use nalgebra::{DMatrix, DVector, Vector3};

type Vec3 = Vector3<f64>;

/// Points that are taken at most.
const STEPS: usize = 1000;

/// That of `points` which is farthest from `p`; `p` without points.
pub(crate) fn farthest(points: impl Iterator<Item = Vec3>, p: &Vec3) -> Vec3 {
    points.max_by(|x, y| (x - p).norm().total_cmp(&(y - p).norm())).unwrap_or(*p)
}

/// The centre of the smallest ball around what has `far(p)` as its farthest point from p.
///
/// A ball around points of it is no larger than that around all; it grows with each point that lies outside, until none does.
pub(crate) fn center(from: Vec3, far: impl Fn(&Vec3) -> Vec3) -> Vec3 {
    let reach = |p: &Vec3| (far(p) - p).norm();
    let mut on = vec![far(&from)];
    let (mut at, mut radius) = (on[0], 0.0);
    let mut best = from;
    for _ in 0..STEPS {
        if reach(&at) < reach(&best) {
            best = at;
        }
        if reach(&at) <= radius * (1.0 + 1e-14) {
            break;
        }
        on.push(far(&at));
        let (larger, kept, center) = around(&on);
        // Rounding is all that is left.
        if larger <= radius {
            break;
        }
        (radius, on, at) = (larger, kept, center);
    }
    best
}

/// Radius and centre of the smallest ball around at most five points, and those that span it.
fn around(points: &[Vec3]) -> (f64, Vec<Vec3>, Vec3) {
    let subsets = 1..1_u32 << points.len();
    let balls = subsets.filter(|set| set.count_ones() < 5).filter_map(|set| {
        let on: Vec<Vec3> = (0..points.len()).filter(|k| set >> k & 1 == 1).map(|k| points[k]).collect();
        let center = equidistant(&on)?;
        Some((points.iter().map(|p| (p - center).norm()).fold(0.0, f64::max), on, center))
    });
    let none = (0.0, points.to_vec(), points[0]);
    balls.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.len().cmp(&b.1.len()))).unwrap_or(none)
}

/// The centre of the smallest sphere through the points.
fn equidistant(on: &[Vec3]) -> Option<Vec3> {
    let n = on.len() - 1;
    let side = |k: usize| on[k + 1] - on[0];
    let products = DMatrix::from_fn(n, n, |i, j| side(i).dot(&side(j)));
    let halves = DVector::from_fn(n, |i, _| 0.5 * side(i).norm_squared());
    let shares = if n == 0 { halves } else { products.lu().solve(&halves)? };
    let center = on[0] + (0..n).map(|k| side(k) * shares[k]).sum::<Vec3>();
    center.iter().all(|x| x.is_finite()).then_some(center)
}
