//! Linking numbers against the Gauss integral, their signs and symmetry; gaps of tori.

use std::f64::consts::{PI, TAU};

use crate::common::{FAMILIES, circle, oracle, rng, sample_angles, uniform};
use maille_geometry::{
    Arc, Circle, Piece, Segment, Torus, Vec3, circle_distance_minima, curve_linking_number, interlocks, linking_number,
    piece_distance_minima, torus_gap, torus_gaps,
};
use rand::RngExt;

/// The linking number with the distance of the curves, and the same with parts of it.
fn links(a: &[Piece], b: &[Piece]) -> Option<i32> {
    let pairs = a.iter().flat_map(|x| b.iter().map(move |y| piece_distance_minima(x, y).closest().distance));
    let apart = pairs.fold(f64::INFINITY, f64::min);
    let number = curve_linking_number(a, b, apart);
    if apart > 1e-3 && apart.is_finite() {
        assert_eq!(curve_linking_number(a, b, 0.4 * apart), number);
    }
    number
}

/// `1/4π ∮∮ (A − B)·(dA × dB)/|A − B|³` by the trapezoidal rule, which converges exponentially for disjoint circles.
fn gauss_integral(a: &Circle, b: &Circle, count: usize) -> f64 {
    let along = |c: &Circle| -> Vec<_> {
        let step = TAU / count as f64;
        let tangent = |t: f64| (c.point(t + 0.5 * PI) - c.center) * step;
        (0..count).map(|i| (c.point(i as f64 * step), tangent(i as f64 * step))).collect()
    };
    let (on_a, on_b) = (along(a), along(b));
    let pairs = on_a.iter().flat_map(|p| on_b.iter().map(move |q| (p, q)));
    let sum: f64 = pairs.map(|(p, q)| (p.0 - q.0).dot(&p.1.cross(&q.1)) / (p.0 - q.0).norm().powi(3)).sum();
    sum / (2.0 * TAU)
}

#[test]
fn equals_the_gauss_integral() {
    let mut rng = rng(21);
    let mut seen = [0; 3];
    while seen.iter().sum::<usize>() < 600 {
        let (a, b) = uniform(&mut rng);
        if circle_distance_minima(&a, &b).closest().distance < 0.2 {
            continue;
        }
        let (exact, integral) = (linking_number(&a, &b), gauss_integral(&a, &b, 160));
        assert!((integral - f64::from(exact)).abs() < 1e-3, "{exact} {integral} {a:?} {b:?}");
        seen[(exact + 1) as usize] += 1;
    }
    assert!(seen.iter().all(|&n| n > 15), "{seen:?}");
}

#[test]
fn is_symmetric_and_turns_with_the_normals() {
    let mut rng = rng(22);
    let mut linked = 0;
    for index in 0..60_000 {
        let (a, b) = FAMILIES[[0, 1, 2, 4][index % 4]].1(&mut rng);
        let number = linking_number(&a, &b);
        let reversed = |c: &Circle| Circle { normal: -c.normal, ..*c };
        assert_eq!(number, linking_number(&b, &a), "{a:?} {b:?}");
        assert_eq!(number, -linking_number(&reversed(&a), &b));
        assert_eq!(number, -linking_number(&a, &reversed(&b)));
        // Definition 3.4.2.
        assert_eq!(interlocks(&a, &b), number.abs() == 1);
        assert_eq!(interlocks(&b, &a), number.abs() == 1);
        linked += usize::from(number != 0);
    }
    assert!(linked > 15_000, "{linked}");
}

#[test]
fn convention_and_pairs_that_meet() {
    let base = circle([0.0; 3], [0.0, 0.0, 1.0], 1.0);
    // About −e_y, counter-clockwise: up through the plane of the base at x = 1.5, down at x = 0.5; about e_y
    // reversed.
    assert_eq!(linking_number(&base, &circle([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5)), 1);
    assert_eq!(linking_number(&base, &circle([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], 0.5)), -1);
    for (name, other) in [
        ("coplanar, crossing", circle([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.5)),
        ("coplanar, reversed", circle([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], 0.5)),
        ("coincident", base),
        ("coaxial", circle([0.0, 0.0, 0.5], [0.0, 0.0, 1.0], 1.0)),
        ("standing, meeting", circle([1.5, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5)),
        ("standing on the plane", circle([1.0, 0.0, 0.5], [0.0, 1.0, 0.0], 0.5)),
        ("through the disc twice", circle([0.0; 3], [0.0, 1.0, 0.0], 0.5)),
    ] {
        assert_eq!(linking_number(&base, &other), 0, "{name}");
        assert_eq!(linking_number(&other, &base), 0, "{name}");
        assert!(!interlocks(&base, &other), "{name}");
    }
}

#[test]
fn gaps_are_distances_minus_radii() {
    let mut rng = rng(23);
    let angles = sample_angles(720);
    for _ in 0..3_000 {
        let (a, b) = uniform(&mut rng);
        let mut torus = |circle| Torus { circle, minor_radius: rng.random_range(0.01..0.15) };
        let (p, q) = (torus(a), torus(b));
        let (minima, gaps) = torus_gaps(&p, &q);
        let gaps: Vec<f64> = gaps.collect();
        assert_eq!(gaps.len(), minima.as_slice().len());
        assert_eq!(gaps[0], torus_gap(&p, &q));
        assert!(gaps.is_sorted());
        let mut sampled: Vec<f64> = oracle(&a, &b, &angles).iter().map(|o| o.distance).collect();
        sampled.sort_by(f64::total_cmp);
        assert_eq!(gaps.len(), sampled.len());
        for (gap, distance) in gaps.iter().zip(sampled) {
            assert!((gap + p.minor_radius + q.minor_radius - distance).abs() < 1e-12);
        }
    }
}

/// A circle in so many arcs.
fn arcs(c: &Circle, count: usize) -> Vec<Piece> {
    let sweep = TAU / count as f64;
    (0..count).map(|i| Piece::Arc(Arc::new(*c, 0.3 + i as f64 * sweep, sweep).unwrap())).collect()
}

#[test]
fn circles_in_arcs_are_linked_as_circles() {
    let mut rng = rng(26);
    for (name, family) in FAMILIES {
        let mut linked = 0;
        for _ in 0..300 {
            let (a, b) = family(&mut rng);
            if circle_distance_minima(&a, &b).closest().distance < 1e-4 * a.radius.max(b.radius) {
                continue;
            }
            let known = linking_number(&a, &b);
            linked += known.abs();
            assert_eq!(links(&arcs(&a, 1), &arcs(&b, 1)), Some(known), "{name} {a:?} {b:?}");
            assert_eq!(links(&arcs(&b, 2), &arcs(&a, 5)), Some(known), "{name} {a:?} {b:?}");
        }
        assert!(name != "linked" || linked > 100);
    }
}

/// A closed curve that winds q times about the ring while it goes round once, and one that goes round p times.
#[test]
fn curves_on_a_torus_have_their_winding_numbers() {
    let wound = |p: i32, q: i32, tube: f64| -> Vec<Piece> {
        let n = 40 * (p + q.abs());
        let at = |i: i32| {
            let t = TAU * f64::from(i % n) / f64::from(n);
            let ((sin, cos), (aside, along)) = ((f64::from(q) * t).sin_cos(), (f64::from(p) * t).sin_cos());
            Vec3::new((1.0 + tube * cos) * along, (1.0 + tube * cos) * aside, tube * sin)
        };
        (0..n).map(|i| Piece::Segment(Segment::new(at(i), at(i + 1)).unwrap())).collect()
    };
    let core = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
    let axis = Circle::new(Vec3::new(20.0, 0.0, 0.0), Vec3::y_axis(), 20.0);
    let number = |q: i32| links(&[Piece::circle(core)], &wound(1, q, 0.3)).unwrap();
    let sign = number(1);
    assert_eq!(sign.abs(), 1);
    for q in -4..=4 {
        assert_eq!(number(q), sign * q, "{q}");
    }
    for p in 1..4 {
        let round = links(&wound(p, 1, 0.3), &[Piece::circle(axis)]).unwrap();
        assert_eq!(round.abs(), p);
        // Reversed, the sign changes.
        let back: Vec<Piece> = wound(p, 1, 0.3)
            .iter()
            .rev()
            .map(|piece| Piece::Segment(Segment::new(piece.point(1.0), piece.point(0.0)).unwrap()))
            .collect();
        assert_eq!(links(&back, &[Piece::circle(axis)]), Some(-round));
    }
    // Two curves of the same torus: on one inside the other, both numbers of windings multiply.
    assert_eq!(links(&wound(2, 3, 0.4), &wound(1, 0, 0.2)).unwrap().abs(), 3);
}

#[test]
fn open_and_touching_curves_have_no_linking_number() {
    let ring = |x: f64| Circle::new(Vec3::new(x, 0.0, 0.0), Vec3::z_axis(), 1.0);
    assert_eq!(links(&arcs(&ring(0.0), 3)[..2], &arcs(&ring(5.0), 1)), None);
    assert_eq!(links(&[], &arcs(&ring(5.0), 1)), None);
    assert_eq!(links(&arcs(&ring(0.0), 1), &arcs(&ring(1.0), 1)), None);
    assert_eq!(links(&arcs(&ring(0.0), 1), &arcs(&ring(5.0), 1)), Some(0));
}
