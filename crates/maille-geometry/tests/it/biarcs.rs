//! Biarcs: ends and tangents, circles exactly, and how near they come to smooth curves.

use crate::common::{direction, rng};
use maille_geometry::{Piece, Vec3, biarc};
use rand::RngExt;
use std::f64::consts::TAU;

/// Unit tangents at the start and at the end.
fn tangents(piece: &Piece) -> [Vec3; 2] {
    let h = 1e-6;
    [piece.point(h) - piece.point(0.0), piece.point(1.0) - piece.point(1.0 - h)].map(|v| v.normalize())
}

#[test]
fn ends_and_tangents_are_those_asked_for() {
    let mut rng = rng(30);
    for _ in 0..10_000 {
        let (p, q) = (*direction(&mut rng), *direction(&mut rng) * rng.random_range(0.1..3.0));
        let (s, t) = (*direction(&mut rng), *direction(&mut rng));
        let [a, b] = biarc(p, s, q, t).unwrap();
        let size = a.length().max(b.length());
        assert!(
            (a.point(0.0) - p).norm() < 1e-12 * size && (b.point(1.0) - q).norm() < 1e-12 * size,
            "{p} {s} {q} {t}"
        );
        assert!((a.point(1.0) - b.point(0.0)).norm() < 1e-12 * size);
        let ([s2, m], [n, t2]) = (tangents(&a), tangents(&b));
        let far = (s - s2).norm().max((m - n).norm()).max((t - t2).norm());
        assert!(far < 1e-4, "{far} {p} {s} {q} {t}");
    }
}

#[test]
fn straight_ones_are_segments_and_impossible_ones_are_none() {
    let [a, b] = biarc(Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0, Vec3::x()).unwrap();
    assert!(matches!((a, b), (Piece::Segment(_), Piece::Segment(_))), "{a:?} {b:?}");
    assert!(biarc(Vec3::zeros(), Vec3::x(), -Vec3::x(), Vec3::x()).is_none());
    assert!(biarc(Vec3::x(), Vec3::x(), Vec3::x(), Vec3::y()).is_none());
    assert!(biarc(Vec3::zeros(), Vec3::zeros(), Vec3::x(), Vec3::y()).is_none());
}

/// The largest distance of the curve from its biarcs, measured at so many points of each span.
fn deviation(curve: impl Fn(f64) -> Vec3, spans: usize) -> f64 {
    let tangent = |t: f64| (curve(t + 1e-6) - curve(t - 1e-6)) / 2e-6;
    let mut worst = 0.0_f64;
    for i in 0..spans {
        let at = |x: f64| TAU * (i as f64 + x) / spans as f64;
        let pieces = biarc(curve(at(0.0)), tangent(at(0.0)), curve(at(1.0)), tangent(at(1.0))).unwrap();
        for k in 1..40 {
            let p = curve(at(f64::from(k) / 40.0));
            // A golden section on either piece.
            let far = |piece: &Piece| {
                let (mut low, mut high, ratio) = (0.0, 1.0, 0.5 * (5f64.sqrt() - 1.0));
                let f = |t: f64| (piece.point(t) - p).norm();
                for _ in 0..60 {
                    let (x, y) = (high - ratio * (high - low), low + ratio * (high - low));
                    if f(x) < f(y) { high = y } else { low = x }
                }
                f(0.5 * (low + high))
            };
            worst = worst.max(far(&pieces[0]).min(far(&pieces[1])));
        }
    }
    worst
}

#[test]
fn smooth_curves_are_approached_with_the_third_power() {
    let circle = |t: f64| Vec3::new(t.cos(), t.sin(), 0.0);
    assert!(deviation(circle, 3) < 1e-9);
    let ellipse = |t: f64| Vec3::new(2.0 * t.cos(), t.sin(), 0.0);
    // The (1,4) knot of Tang et al. 2023, in units of R + a.
    let knot = |t: f64| {
        let (sin, cos) = (4.0 * t).sin_cos();
        Vec3::new((5.5 + 2.7 * cos) * t.cos(), (5.5 + 2.7 * cos) * t.sin(), -2.7 * sin) / 8.2
    };
    for (name, curve, spans) in [("ellipse", &ellipse as &dyn Fn(f64) -> Vec3, 24), ("knot", &knot, 64)] {
        let found: Vec<f64> = [1, 2, 4].iter().map(|k| deviation(curve, spans * k)).collect();
        println!("{name}: {spans} spans and their multiples: {found:?}");
        for pair in found.windows(2) {
            let power = (pair[0] / pair[1]).log2();
            assert!((2.7..3.3).contains(&power), "{name}: {found:?}");
        }
    }
}
