//! The most that the half-widths of one disc along several forces can be.
//!
//! **Normals.** Rings a, b with normals N_a, N_b are linked, their tori disjoint. For every force y
//!
//! y·(c_b − c_a) ≤ R_a |y × N_a| + R_b |y × N_b| − (r_a + r_b) |y|:
//!
//! moved along y by less than r_a + r_b, b is still linked with a, so the discs meet, and the centres are no further apart along y than
//! both discs are wide. A ring has one normal in all of its links. So the forces y_k at it count R max_N Σ |y_k × N| together.
//!
//! f(N) = Σ |y_k × N| is convex, and f(tN) = |t| f(N). Points p = Σ t_i v_i of a flat triangle with unit corners and no edge longer than e have
//! |p|² = 1 − Σ_(i<j) t_i t_j |v_i − v_j|² ≥ 1 − e²/3. So f of the unit vectors in its cone is at most max f(v_i)/√(1 − e²/3).

use crate::sheet::{ROUNDING, Vec3};
use std::{cmp::Ordering, collections::BinaryHeap};

/// Triangles closer to the largest value than this, relatively, are not divided.
const CLOSE: f64 = 1e-12;
/// Triangles after which the rest is not divided, either.
const MOST: usize = 40_000;
/// Forces whose planes are climbed from.
const SEEDS: usize = 16;
/// Roundings of one force's part of f, with room.
const OPERATIONS: f64 = 40.0;

struct Triangle {
    corners: [Vec3; 3],
    values: [f64; 3],
    /// What f does not exceed in its cone.
    most: f64,
}

impl Triangle {
    fn new(corners: [Vec3; 3], values: [f64; 3]) -> Self {
        let [a, b, c] = corners;
        let edge_sq = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        let least = (1.0 - edge_sq * (1.0 + OPERATIONS * ROUNDING) / 3.0).sqrt() * (1.0 - OPERATIONS * ROUNDING);
        Triangle { corners, values, most: values.into_iter().fold(0.0, f64::max) / least }
    }
}

impl PartialEq for Triangle {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Triangle {}

impl PartialOrd for Triangle {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Triangle {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most.total_cmp(&other.most)
    }
}

/// A bound of f over unit vectors, rounded upwards.
pub(crate) fn most_width(forces: &[Vec3]) -> f64 {
    let all: f64 = forces.iter().map(|y| y.norm()).sum();
    let f = |n: &Vec3| forces.iter().map(|y| y.cross(n).norm()).sum::<f64>();
    let half: Vec<Vec3> = (-1..=1)
        .flat_map(|x| (-1..=1).flat_map(move |y| (0..=1).map(move |z| [x, y, z])))
        .filter(|n| *n != [0, 0, 0])
        .map(|n| Vec3::from(n.map(f64::from)).normalize())
        .collect();
    let few = &forces[..forces.len().min(SEEDS)];
    let crossed = few.iter().flat_map(|y| few.iter().map(move |z| y.cross(z)));
    let seeds = half.into_iter().chain(crossed.filter_map(|n| n.try_normalize(1e-12 * all * all)));
    let mut seen = seeds.map(|n| f(&climbed(forces, n))).fold(0.0, f64::max);
    let mut left = octants(&f);
    for _ in 0..MOST {
        let enough = seen * (1.0 + CLOSE);
        // Forces in one plane reach the sum of all, beyond which nothing is. Of all that are left, the first can hold the most.
        if enough >= all || left.peek().is_none_or(|triangle| triangle.most <= enough) {
            break;
        }
        let Some(Triangle { corners: [a, b, c], values: [p, q, r], .. }) = left.pop() else { break };
        let middles = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
        let [x, y, z] = middles;
        let [s, t, u] = middles.map(|n| f(&n));
        seen = seen.max(s).max(t).max(u);
        let parts = [([a, x, z], [p, s, u]), ([x, b, y], [s, q, t]), ([z, y, c], [u, t, r]), (middles, [s, t, u])];
        left.extend(parts.map(|(corners, values)| Triangle::new(corners, values)));
    }
    let most = left.peek().map_or(0.0, |triangle| triangle.most).max(seen * (1.0 + CLOSE)).min(all);
    most + (OPERATIONS + forces.len() as f64) * ROUNDING * all
}

/// Half of the sphere; f is the same on the other one.
fn octants(f: &impl Fn(&Vec3) -> f64) -> BinaryHeap<Triangle> {
    let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
    let corners = [[x, y, z], [y, -x, z], [-x, -y, z], [-y, x, z]];
    corners.map(|corners| Triangle::new(corners, corners.map(|n| f(&n)))).into()
}

/// Uphill from n: along its gradient a convex f is no smaller.
fn climbed(forces: &[Vec3], mut n: Vec3) -> Vec3 {
    for _ in 0..60 {
        let parts = forces.iter().map(|y| {
            let across = y.norm_squared() * n - y.dot(&n) * y;
            across / y.cross(&n).norm().max(f64::MIN_POSITIVE)
        });
        n = parts.sum::<Vec3>().try_normalize(f64::MIN_POSITIVE).unwrap_or(n);
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    /// Never passed by random normals, and met where the largest is known.
    #[test]
    fn width_is_the_most_of_all_normals() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let mut random =
            |flat: f64| Vec3::from_fn(|i, _| rng.random_range(-1.0..1.0) * if i == 2 { flat } else { 1.0 });
        for flat in [1.0, 0.1, 1e-4] {
            for _ in 0..5 {
                let forces: Vec<Vec3> = (0..5).map(|_| random(flat)).collect();
                let most = most_width(&forces);
                let f = |n: &Vec3| forces.iter().map(|y| y.cross(n).norm()).sum::<f64>();
                let mut seen = 0.0_f64;
                for _ in 0..2000 {
                    let n = random(1.0).normalize();
                    assert!(f(&n) <= most);
                    seen = seen.max(f(&climbed(&forces, n)));
                }
                assert!(seen <= most && seen >= most * (1.0 - 1e-9), "{seen} {most}");
            }
        }
        assert!((most_width(&[Vec3::x(), Vec3::y(), Vec3::z()]) - 6.0_f64.sqrt()).abs() < 1e-9);
        assert!((most_width(&[Vec3::x(), -2.0 * Vec3::x()]) - 3.0).abs() < 1e-13);
    }
}
