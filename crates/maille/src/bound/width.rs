//! How wide a disc can be along several directions at once: the largest Σ_k |y_k × N| over unit vectors N, from above.
//!
//! The disc of a ring with normal N and major radius R has the half-width R |n × N| along a unit vector n. So this is the most that the
//! ring's half-widths along its forces y_k, times these forces, add up to.
//!
//! **Proof.** f(N) = Σ |y_k × N| is convex and homogeneous. Let a triangle have unit corners v₁, v₂, v₃ in a plane at the distance d
//! from the origin. A unit vector in its cone is p/|p| with p in the flat triangle, |p| ≥ d. So f there is at most max f(v_i)/d. Half of
//! the sphere is divided into such triangles, those of the largest bound first, until the bound meets the largest value seen. f(−N) = f(N).

use maille_geometry::Vec3;
use std::{cmp::Ordering, collections::BinaryHeap};

/// Relative distance of bound and value at which the search ends.
const CLOSE: f64 = 1e-10;
/// Triangles after which it ends in any case: then the bound is less sharp.
const MOST_PATCHES: usize = 4000;

/// The half-widths of a disc of radius 1 with normal `normal` along `forces`, times the forces.
pub(super) fn width(forces: &[Vec3], normal: &Vec3) -> f64 {
    forces.iter().map(|y| y.cross(normal).norm()).sum()
}

/// A unit vector at which the half-widths are at least as large as at `normal`: the gradient's direction, as they are convex.
pub(super) fn wider(forces: &[Vec3], normal: &Vec3) -> Vec3 {
    let gradient: Vec3 = forces
        .iter()
        .filter_map(|y| {
            let width = y.cross(normal).norm();
            (width > 0.0).then(|| (normal * y.norm_squared() - y * y.dot(normal)) / width)
        })
        .sum();
    gradient.try_normalize(f64::MIN_POSITIVE).unwrap_or(*normal)
}

/// A triangle of normals, with the half-widths at its corners.
struct Patch {
    bound: f64,
    corners: [Vec3; 3],
    values: [f64; 3],
}

impl Patch {
    fn new(corners: [Vec3; 3], values: [f64; 3]) -> Self {
        let [a, b, c] = corners;
        let plane = (b - a).cross(&(c - a)).normalize();
        let distance = plane.dot(&a).abs();
        let most = values.into_iter().fold(0.0, f64::max);
        Patch { bound: most / distance, corners, values }
    }
}

impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        self.bound == other.bound
    }
}

impl Eq for Patch {}

impl PartialOrd for Patch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Patch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// An upper bound of Σ |y_k × N| over unit vectors N, within 1e-10 of the maximum unless the forces are nearly parallel.
pub(super) fn largest_width(forces: &[Vec3]) -> f64 {
    let all: f64 = forces.iter().map(Vec3::norm).sum();
    let f = |normal: &Vec3| width(forces, normal);
    // Coplanar forces have their plane's normal.
    let pairs = forces.iter().enumerate().flat_map(|(k, y)| forces[..k].iter().map(move |z| y.cross(z)));
    let crossed = pairs.filter_map(|n| n.try_normalize(1e-12 * all * all)).map(|n| f(&n)).fold(0.0, f64::max);
    if crossed >= all * (1.0 - CLOSE) || all == 0.0 {
        return all;
    }
    let mut best = crossed;
    let mut patches = BinaryHeap::new();
    let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
    for [a, b] in [[x, y], [y, -x], [-x, -y], [-y, x]] {
        patches.push(Patch::new([a, b, z], [f(&a), f(&b), f(&z)]));
    }
    for _ in 0..MOST_PATCHES {
        let Some(top) = patches.pop() else { break };
        best = top.values.into_iter().fold(best, f64::max);
        if top.bound <= best * (1.0 + CLOSE) {
            return top.bound.min(all);
        }
        let [a, b, c] = top.corners;
        let [fa, fb, fc] = top.values;
        let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
        let [fab, fbc, fca] = [f(&ab), f(&bc), f(&ca)];
        patches.push(Patch::new([a, ab, ca], [fa, fab, fca]));
        patches.push(Patch::new([ab, b, bc], [fab, fb, fbc]));
        patches.push(Patch::new([ca, bc, c], [fca, fbc, fc]));
        patches.push(Patch::new([ab, bc, ca], [fab, fbc, fca]));
    }
    patches.peek().map_or(all, |patch| patch.bound.min(all))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn random(rng: &mut ChaCha8Rng) -> Vec3 {
        Vec3::from_fn(|_, _| rng.random_range(-1.0..1.0))
    }

    /// Never passed, and met by ascent from some of many normals.
    #[test]
    fn largest_width_is_the_largest() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        for count in [2, 3, 4, 8] {
            for flat in [1.0, 1e-3, 0.0] {
                let forces: Vec<Vec3> =
                    (0..count).map(|_| random(&mut rng).component_mul(&Vec3::new(1.0, 1.0, flat))).collect();
                let most = largest_width(&forces);
                let mut seen = 0.0_f64;
                for _ in 0..200 {
                    let mut normal = random(&mut rng).normalize();
                    (0..100).for_each(|_| normal = wider(&forces, &normal));
                    seen = seen.max(width(&forces, &normal));
                }
                assert!(seen <= most * (1.0 + 1e-14), "{count} {flat}: {seen} above {most}");
                assert!(seen >= most * (1.0 - 1e-9), "{count} {flat}: {seen} far below {most}");
            }
        }
    }

    /// Three forces of length 1 along the axes: Σ √(1 − N_k²) is largest where all N_k² are ⅓.
    #[test]
    fn forces_along_the_axes() {
        let most = largest_width(&[Vec3::x(), Vec3::y(), Vec3::z()]);
        assert!((most - 6.0_f64.sqrt()).abs() < 1e-9);
    }
}
