//! Degenerate positions: closed forms in random poses, exact and perturbed by 1e-6 … 1e-12.

use crate::common::{circle, direction, moved, oracle, rng, rotation, sample_angles, scale, villarceau};
use maille_geometry::{
    Approaches, Circle, Minima, PairKind, Vec3, circle_distance_approaches, circle_distance_minima, linking_number,
};
use nalgebra::UnitVector3;

/// Distance of circles in parallel planes `height` apart, their axes `offset` apart.
fn parallel_distance(height: f64, offset: f64, p: f64, q: f64) -> f64 {
    height.hypot((offset - p - q).max((p - q).abs() - offset).max(0.0))
}

/// Name, circles, distance, kind, and whether the minima are a continuum.
fn specimens() -> Vec<(&'static str, Circle, Circle, f64, PairKind, bool)> {
    use PairKind::{Coaxial, Concentric, Coplanar, Equidistant, Generic};
    let base = circle([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    let level = |x: f64, z: f64, radius: f64| circle([x, 0.0, z], [0.0, 0.0, 1.0], radius);
    let mut list = Vec::new();
    for (name, x, z, radius, kind) in [
        ("coaxial, equal", 0.0, 0.7, 1.0, Coaxial),
        ("coaxial, unequal", 0.0, 0.7, 0.4, Coaxial),
        ("coaxial in one plane", 0.0, 0.0, 0.4, Coaxial),
        ("coincident", 0.0, 0.0, 1.0, Coaxial),
        ("coplanar, crossing", 0.8, 0.0, 0.6, Coplanar),
        ("coplanar, touching outside", 1.5, 0.0, 0.5, Coplanar),
        ("coplanar, touching inside", 0.5, 0.0, 0.5, Coplanar),
        ("coplanar, nested", 0.2, 0.0, 0.5, Coplanar),
        ("coplanar, nested, larger", 0.2, 0.0, 1.5, Coplanar),
        ("coplanar, apart", 2.5, 0.0, 0.5, Coplanar),
        ("through the axis, level", 0.6, 0.3, 0.6, Generic),
        ("through the centre, level", 0.6, 0.0, 0.6, Coplanar),
    ] {
        let other = level(x, z, radius);
        list.push((name, base, other, parallel_distance(z, x, 1.0, radius), kind, kind == Coaxial));
    }
    for (name, angle, radius) in [
        ("concentric, tilted", 0.8_f64, 0.7),
        ("concentric, standing", 0.5 * std::f64::consts::PI, 1.3),
        ("concentric, equal", 0.3, 1.0),
    ] {
        let other = circle([0.0; 3], [angle.sin(), 0.0, angle.cos()], radius);
        list.push((name, base, other, (1.0 - radius).abs(), Concentric, false));
    }
    // B is perpendicular to A and passes through its centre: nearest in the common plane of symmetry, or at the
    // centre. There the angle on A is free: if B is larger, A is a meridian around a point of it.
    for (name, radius) in [("standing through the centre", 0.3), ("the same, touching", 0.5), ("the same, larger", 1.7)]
    {
        let other = circle([radius, 0.0, 0.0], [0.0, 1.0, 0.0], radius);
        let kind = if radius > 1.0 { Equidistant } else { Generic };
        list.push((name, base, other, (1.0 - 2.0 * radius).abs().min(1.0), kind, radius > 1.0));
    }
    list.push(("meridian, equal", base, circle([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0), 1.0, Equidistant, true));
    list.push(("meridian", base, circle([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.4), 0.4, Equidistant, true));
    for (name, distance, left) in [("Villarceau", 0.3, false), ("Villarceau, left", 0.9, true), ("close", 1e-3, false)]
    {
        let (a, b) = villarceau(distance, 1.0, left);
        list.push((name, a, b, distance, Equidistant, true));
    }
    list
}

fn in_both_orders(a: &Circle, b: &Circle) -> [Minima; 2] {
    [circle_distance_minima(a, b), circle_distance_minima(b, a)]
}

#[test]
fn closed_forms_in_random_poses() {
    let mut rng = rng(11);
    for (name, a, b, distance, kind, continuum) in specimens() {
        for pose in 0..40 {
            let (by, shift) = (rotation(&mut rng), *direction(&mut rng) * f64::from(pose.min(1)));
            let (a, b) = if pose == 0 { (a, b) } else { (moved(&a, &by, &shift), moved(&b, &by, &shift)) };
            for minima in in_both_orders(&a, &b) {
                let found = minima.closest().distance;
                assert!((found - distance).abs() < 1e-14 * scale(&a, &b), "{name}: {found} for {distance}");
                assert_eq!((minima.kind, minima.continuum), (kind, continuum), "{name}: {minima:?}");
                if continuum {
                    assert_eq!(minima.as_slice().len(), 1, "{name}");
                }
            }
        }
    }
}

#[test]
fn crossing_and_concentric_pairs_have_two_minima() {
    for (name, a, b, distance, _, _) in specimens() {
        if name.contains("crossing") || name.contains("concentric") {
            for minima in in_both_orders(&a, &b) {
                let distances: Vec<_> = minima.as_slice().iter().map(|m| m.distance).collect();
                assert_eq!(distances.len(), 2, "{name}: {distances:?}");
                assert!(distances.iter().all(|d| (d - distance).abs() < 1e-15), "{name}: {distances:?}");
            }
        }
    }
}

/// A perturbation changes the distance by no more than its size times a length, and the result agrees with sampling
/// where the samples resolve it.
#[test]
fn nearly_degenerate_pairs_are_near_their_closed_forms() {
    let angles = sample_angles(720);
    let mut rng = rng(12);
    for (name, a, b, distance, _, _) in specimens() {
        for size in [1e-6, 1e-8, 1e-10, 1e-12] {
            for case in 0..30 {
                let (offset, tilt, swell) = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0)][case % 3];
                let normal = UnitVector3::new_normalize(*b.normal + *direction(&mut rng) * size * tilt);
                let center = b.center + *direction(&mut rng) * size * offset;
                let disturbed = Circle::new(center, normal, b.radius + size * swell);
                let (by, shift) = (rotation(&mut rng), *direction(&mut rng));
                let (a, b) = (moved(&a, &by, &shift), moved(&disturbed, &by, &shift));
                let unit = scale(&a, &b);
                for (minima, (a, b)) in in_both_orders(&a, &b).iter().zip([(a, b), (b, a)]) {
                    let found = minima.closest().distance;
                    let bound = size * (offset + 2.0 * tilt * b.radius.max(a.radius) + swell) + 1e-13;
                    assert!((found - distance).abs() < bound, "{name}, {size:e}: {found} for {distance}");
                    let sampled = oracle(&a, &b, &angles);
                    let lowest = sampled.iter().map(|o| o.distance).fold(f64::INFINITY, f64::min);
                    assert!(found < lowest + 1e-13 * unit, "{name}, {size:e}: {found} above {lowest}");
                }
            }
        }
    }
}

/// Parallel circles have a closed form for separate axes too.
#[test]
fn parting_axes_follow_the_closed_form() {
    for size in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        for (height, radius) in [(0.7, 1.0), (0.7, 0.4), (0.0, 0.4), (0.0, 1.0), (1e-9, 1.0), (size, 1.0 - size)] {
            let a = circle([0.0; 3], [0.0, 0.0, 1.0], 1.0);
            let b = circle([size, 0.0, height], [0.0, 0.0, 1.0], radius);
            let expected = parallel_distance(height, size, 1.0, radius);
            for minima in in_both_orders(&a, &b) {
                let found = minima.closest().distance;
                assert!((found - expected).abs() < 3e-16, "{size:e}, {height}, {radius}: {found:e} for {expected:e}");
            }
        }
    }
}

/// Concentric, slightly tilted circles: the distance varies by the square of the tilt only, and still the two
/// minima, on the intersection of the planes, are found to the accuracy of the normals.
#[test]
fn hardly_tilted_circles_are_nearest_on_the_common_line() {
    for (tilt, accuracy) in [(1e-2_f64, 1e-12), (1e-4, 1e-10), (1e-6, 1e-8)] {
        for radius in [0.7, 1.0, 1.2] {
            let a = circle([0.0; 3], [0.0, 0.0, 1.0], 1.0);
            let b = circle([0.0; 3], [tilt.sin(), 0.0, tilt.cos()], radius);
            for minima in in_both_orders(&a, &b) {
                assert_eq!(minima.as_slice().len(), 2, "{tilt:e}, {radius}");
                for m in minima.as_slice() {
                    assert!((m.distance - (1.0 - radius).abs()).abs() < 1e-15, "{tilt:e}, {radius}: {m:?}");
                    assert!(m.point_a.x.abs() < accuracy && m.point_b.x.abs() < accuracy, "{tilt:e}, {radius}: {m:?}");
                }
            }
        }
    }
}

/// Linked circles of radius R with centres ϱ apart have distance ϱ only if they are a Villarceau pair; close to one
/// the minima are isolated again.
#[test]
fn leaving_a_villarceau_pair() {
    for size in [1e-3, 1e-6, 1e-9, 1e-12] {
        let (a, b) = villarceau(0.5, 1.0, false);
        assert_eq!(linking_number(&a, &b).abs(), 1);
        let further = Circle::new(b.center * (1.0 + size), b.normal, b.radius);
        let minima = circle_distance_minima(&a, &further);
        assert!(!minima.continuum, "{size:e}: {minima:?}");
        // Along the offset the distance grows by size/2 on one side and falls on the other, to first order.
        let found = minima.closest().distance;
        assert!((found - 0.5).abs() < size, "{size:e}: {found}");
    }
}

/// Regression: the search did not terminate on such numbers.
#[test]
fn numbers_that_make_no_circle_have_no_distance() {
    let sound = circle([0.3, 0.2, 0.1], [0.0, 1.0, 1.0], 1.0);
    let with = |change: fn(&mut Circle)| {
        let mut c = circle([1.0, 0.0, 0.5], [1.0, 0.2, 0.0], 0.8);
        change(&mut c);
        c
    };
    let none = [
        with(|c| c.center.x = f64::NAN),
        with(|c| c.center.y = f64::INFINITY),
        with(|c| c.radius = f64::NAN),
        with(|c| c.radius = -1.0),
        with(|c| c.radius = 0.0),
        with(|c| c.radius = f64::MAX),
        with(|c| c.radius = 5e-324),
        with(|c| c.normal = UnitVector3::new_unchecked(c.center * f64::NAN)),
        with(|c| c.normal = UnitVector3::new_unchecked(c.center * 0.0)),
    ];
    for c in &none {
        for minima in in_both_orders(&sound, c) {
            assert!(minima.as_slice().len() == 1 && minima.closest().distance.is_nan(), "{c:?}: {minima:?}");
        }
        let mut batch = [Approaches::NONE; 2];
        circle_distance_approaches(&[(sound, *c), (*c, sound)], &[f64::INFINITY; 2], &mut batch);
        assert!(batch.iter().all(|found| found.as_slice()[0].distance.is_nan()), "{c:?}: {batch:?}");
    }
}

/// Regression: the square of such a tilt underflows, and the points were off by a hundredth.
#[test]
fn a_tilt_too_small_for_its_square_is_none() {
    for tilt in [1e-12, 1e-100, 1e-149, 1e-151, 4.5e-162, 1e-200, 5e-324] {
        let a = circle([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], 0.99);
        let b = Circle::new(
            a.center + Vec3::new(0.0, 0.98, 0.004),
            UnitVector3::new_unchecked(Vec3::new(-tilt, 0.0, 1.0)),
            1.0,
        );
        for minima in in_both_orders(&a, &b) {
            for m in minima.as_slice() {
                assert!((m.distance - 0.004).abs() < 1e-11, "{tilt:e}: {m:?}");
                assert!(((m.point_a - m.point_b).norm() - m.distance).abs() < 1e-14, "{tilt:e}: {m:?}");
                assert!((m.direction_b[0].hypot(m.direction_b[1]) - 1.0).abs() < 1e-14, "{tilt:e}: {m:?}");
            }
        }
    }
}

/// Regression: the search bisected every interval to the smallest width, which took two seconds per pair.
#[test]
fn a_circle_too_small_for_its_squares_is_a_point() {
    let mut rng = rng(41);
    let small = |center: [f64; 3], normal: Vec3| Circle::new(center.into(), UnitVector3::new_normalize(normal), 1e-83);
    for _ in 0..200 {
        let a = Circle::new(Vec3::zeros(), direction(&mut rng), 1e83);
        for b in [small([0.0; 3], *direction(&mut rng)), small([0.0, 0.0, 1e-90], *a.normal)] {
            for minima in in_both_orders(&a, &b) {
                let closest = minima.closest();
                assert!(minima.continuum && (closest.distance / 1e83 - 1.0).abs() < 1e-15, "{minima:?}");
                assert!(((closest.point_a - closest.point_b).norm() / 1e83 - 1.0).abs() < 1e-15, "{minima:?}");
            }
        }
    }
}
