//! Derivatives against finite differences, and invariance under rigid motion, scaling and exchange of the circles.

use std::f64::consts::PI;

use crate::common::{
    self, FAMILIES, Pair, degenerate, direction, linked, moved, rng, rotation, scale, thin_gap, unequal, uniform,
};
use maille_geometry::{Circle, Minima, Vec3, circle_distance_minima, point_circle_distance};
use rand::RngExt;

const GENERIC: [fn(&mut common::Rng) -> Pair; 4] = [uniform, linked, thin_gap, unequal];

#[test]
fn frames_are_right_handed_and_angles_invert_points() {
    let mut rng = rng(1);
    for _ in 0..10_000 {
        let circle = Circle::new(*direction(&mut rng), direction(&mut rng), rng.random_range(0.1..2.0));
        let (u, v) = circle.frame();
        assert!((u.cross(&v) - *circle.normal).norm() < 1e-15 && u.dot(&v).abs() < 1e-15);
        let angle = rng.random_range(-PI..PI);
        let found = circle.angle_rad(&circle.point(angle));
        assert!((found - angle).sin().abs() < 1e-14, "{angle} {found}");
    }
    for z in [1.0, -1.0] {
        let (u, v) = common::circle([0.0; 3], [0.0, 0.0, z], 1.0).frame();
        assert_eq!(u.cross(&v), Vec3::new(0.0, 0.0, z));
    }
}

#[test]
fn point_distance_is_the_smallest_of_samples() {
    let mut rng = rng(2);
    for _ in 0..500 {
        let circle = Circle::new(*direction(&mut rng), direction(&mut rng), rng.random_range(0.1..2.0));
        let p = *direction(&mut rng) * rng.random_range(0.0..3.0);
        let nearest = point_circle_distance(&p, &circle);
        assert!((nearest.distance - (nearest.point - p).norm()).abs() < 1e-14);
        assert!((circle.point(nearest.angle_rad) - nearest.point).norm() < 1e-14);
        let sampled = (0..2000).map(|i| (circle.point(f64::from(i) * PI / 1000.0) - p).norm());
        let sampled = sampled.fold(f64::INFINITY, f64::min);
        assert!(sampled >= nearest.distance - 1e-14 && sampled < nearest.distance + 1e-5 * circle.radius + 1e-2);
    }
    let on_axis = point_circle_distance(&Vec3::new(0.0, 0.0, 3.0), &common::circle([0.0; 3], [0.0, 0.0, 1.0], 4.0));
    assert!(on_axis.on_axis && on_axis.angle_rad == 0.0 && on_axis.distance == 5.0);
}

/// `g(α, β) = ½ |A(α) − B(β)|²` around every minimum, by central differences.
#[test]
fn gradient_and_hessian_agree_with_finite_differences() {
    let mut rng = rng(3);
    let mut checked = 0;
    for index in 0..4_000 {
        let (a, b) = GENERIC[index % 3](&mut rng);
        for m in circle_distance_minima(&a, &b).as_slice() {
            let half_sq = |i: f64, j: f64, step: f64| {
                let gap = a.point(a.angle_rad(&m.point_a) + i * step) - b.point(m.angle_b_rad() + j * step);
                0.5 * gap.norm_squared()
            };
            let first = |i: f64, j: f64| (half_sq(i, j, 1e-6) - half_sq(-i, -j, 1e-6)) / 2e-6;
            let second =
                |i: f64, j: f64| (half_sq(i, j, 1e-4) - 2.0 * half_sq(0.0, 0.0, 1e-4) + half_sq(-i, -j, 1e-4)) / 1e-8;
            let (aa, bb, sum) = (second(1.0, 0.0), second(0.0, 1.0), second(1.0, 1.0));
            let mixed = 0.5 * (sum - aa - bb);
            let expected = [[aa, mixed], [mixed, bb]];
            for i in 0..2 {
                let slope = first(1.0 - i as f64, i as f64);
                assert!((m.gradient[i] - slope).abs() < 2e-9, "{:?} {slope}", m.gradient);
                for j in 0..2 {
                    assert!((m.hessian[i][j] - expected[i][j]).abs() < 1e-6, "{:?} {expected:?}", m.hessian);
                }
            }
            checked += 1;
        }
    }
    assert!(checked > 5_000, "{checked}");
}

/// The minima of both pairs agree, with points mapped by `map` and lengths scaled by `factor`.
fn assert_same(p: &Minima, q: &Minima, unit: f64, factor: f64, map: impl Fn(&Vec3) -> Vec3, what: &str) {
    assert_eq!(p.as_slice().len(), q.as_slice().len(), "{what}: {p:?} {q:?}");
    for m in p.as_slice() {
        let determinant = |h: [[f64; 2]; 2]| h[0][0] * h[1][1] - h[0][1] * h[0][1];
        let condition = determinant(m.hessian) / (m.hessian[0][0] + m.hessian[1][1]).powi(2);
        let hit = q.as_slice().iter().any(|n| {
            let near = |x: &Vec3, y: &Vec3| condition < 1e-3 || (map(x) - y).norm() < 1e-9 * unit * factor;
            (m.distance * factor - n.distance).abs() < 1e-12 * unit * factor
                && near(&m.point_a, &n.point_a)
                && near(&m.point_b, &n.point_b)
        });
        assert!(hit, "{what}: {m:?} not in {q:?}");
    }
}

#[test]
fn generic_minima_move_with_the_pair() {
    let mut rng = rng(4);
    for index in 0..12_000 {
        let (a, b) = GENERIC[index % 4](&mut rng);
        let (unit, minima) = (scale(&a, &b), circle_distance_minima(&a, &b));

        let (by, shift) = (rotation(&mut rng), *direction(&mut rng) * unit);
        let turned = circle_distance_minima(&moved(&a, &by, &shift), &moved(&b, &by, &shift));
        assert_same(&minima, &turned, unit, 1.0, |p| by * p + shift, "moved");

        let factor = 10f64.powf(rng.random_range(-3.0..3.0));
        let scaled = |c: &Circle| Circle::new(c.center * factor, c.normal, c.radius * factor);
        let larger = circle_distance_minima(&scaled(&a), &scaled(&b));
        assert_same(&minima, &larger, unit, factor, |p| p * factor, "scaled");

        let swapped = circle_distance_minima(&b, &a);
        let back: Vec<_> = swapped.as_slice().to_vec();
        assert_eq!(back.len(), minima.as_slice().len());
        for (m, n) in minima.as_slice().iter().zip(&back) {
            assert!((m.distance - n.distance).abs() < 1e-12 * unit);
        }
        let reversed = Circle { normal: -b.normal, ..b };
        assert_same(&minima, &circle_distance_minima(&a, &reversed), unit, 1.0, |p| *p, "reversed");
    }
}

/// In degenerate positions rounding may add or merge minima of equal distance; the distance itself does not change.
#[test]
fn the_distance_is_invariant_in_every_family() {
    let mut rng = rng(5);
    let families = FAMILIES.map(|(_, family)| family);
    for index in 0..14_000 {
        let family = families.get(index % 7).copied().unwrap_or(degenerate);
        let (a, b) = family(&mut rng);
        let (unit, distance) = (scale(&a, &b), circle_distance_minima(&a, &b).closest().distance);
        let (by, shift) = (rotation(&mut rng), *direction(&mut rng) * unit);
        let factor = 10f64.powf(rng.random_range(-3.0..3.0));
        let scaled = |c: &Circle| Circle::new(c.center * factor, c.normal, c.radius * factor);
        let others = [
            circle_distance_minima(&moved(&a, &by, &shift), &moved(&b, &by, &shift)).closest().distance,
            circle_distance_minima(&scaled(&a), &scaled(&b)).closest().distance / factor,
            circle_distance_minima(&b, &a).closest().distance,
        ];
        for other in others {
            assert!((distance - other).abs() < 1e-12 * unit, "{distance} {others:?} {a:?} {b:?}");
        }
    }
}
