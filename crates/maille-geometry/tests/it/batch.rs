//! Batches against the function for one pair and against sampling, on every instruction set that the machine
//! supports.

use crate::common::{FAMILIES, Pair, degenerate, oracle, rng, sample_angles, scale};
use maille_geometry::{
    Approaches, Circle, Instructions, Vec3, circle_distance_approaches, circle_distance_approaches_with,
    circle_distance_minima,
};
use nalgebra::UnitVector3;

fn pairs() -> Vec<(&'static str, Vec<Pair>)> {
    let mut families = FAMILIES.to_vec();
    families.push(("degenerate", degenerate));
    // Not a multiple of any register width: the last block is not full.
    families
        .iter()
        .enumerate()
        .map(|(seed, (name, family))| {
            let mut rng = rng(70 + seed as u64);
            (*name, (0..3_001).map(|_| family(&mut rng)).collect())
        })
        .collect()
}

fn batch(set: Instructions, pairs: &[Pair]) -> Vec<Approaches> {
    let mut out = vec![Approaches::NONE; pairs.len()];
    circle_distance_approaches_with(set, pairs, &vec![f64::INFINITY; pairs.len()], &mut out);
    out
}

/// On one instruction set bit by bit, whatever the neighbouring pairs are; between sets up to rounding.
#[test]
fn every_instruction_set_gives_the_same_minima() {
    for (name, pairs) in pairs() {
        let baseline = batch(Instructions::Baseline, &pairs);
        for set in Instructions::available() {
            let found = batch(set, &pairs);
            let others = batch(set, &pairs[7..]);
            assert!(found[7..].iter().zip(&others).all(|(p, q)| p == q), "{name} {set:?}");
            for (k, (p, q)) in found.iter().zip(&baseline).enumerate() {
                let ((a, b), [p, q]) = (&pairs[k], [p.as_slice(), q.as_slice()]);
                let unit = scale(a, b);
                assert!((p[0].distance - q[0].distance).abs() < 1e-10 * unit, "{name} {set:?} {k}: {p:?} {q:?}");
                if !name.ends_with("degenerate") {
                    let same = p.iter().zip(q).all(|(p, q)| (p.distance - q.distance).abs() < 1e-10 * unit);
                    assert!(p.len() == q.len() && same, "{name} {set:?} {k}: {p:?} {q:?}");
                }
            }
        }
    }
}

#[test]
fn the_batch_has_the_minima_of_each_pair() {
    let widest = Instructions::available().last().unwrap();
    let angles = sample_angles(720);
    for (name, pairs) in pairs() {
        for (k, ((a, b), found)) in pairs.iter().zip(batch(widest, &pairs)).enumerate() {
            let unit = scale(a, b);
            let single = circle_distance_minima(a, b);
            if name == "near degenerate" || name == "degenerate" {
                // For a nearly constant distance the number of minima depends on rounding; the distance does not.
                assert!((found.as_slice()[0].distance - single.closest().distance).abs() < 1e-10 * unit, "{name} {k}");
                continue;
            }
            assert_eq!(found.as_slice().len(), single.as_slice().len(), "{name} {k}: {a:?} {b:?}");
            for (p, q) in found.as_slice().iter().zip(single.as_slice()) {
                assert!((p.distance - q.distance).abs() < 1e-10 * unit, "{name} {k}: {p:?} {q:?}");
                let there = b.center + p.direction_b * b.radius;
                // Minima of equal distance may be in either order.
                let near = |q: &maille_geometry::Minimum| (q.point_b - there).norm() < 1e-6 * unit;
                assert!(single.as_slice().iter().any(near), "{name} {k}: {p:?} {single:?}");
            }
            for expected in oracle(a, b, &angles).iter().filter(|_| k % 10 == 0) {
                let hit = found.as_slice().iter().any(|m| (m.distance - expected.distance).abs() < 1e-9 * unit);
                assert!(hit, "{name} {k}: missed {expected:?}");
            }
        }
    }
}

/// The special position agrees with that of the function for one pair, on every set: for exact, random and nearly
/// special pairs.
#[test]
fn the_batch_tells_the_kind_of_each_pair() {
    let mut seen = Vec::new();
    for (name, pairs) in pairs() {
        for set in Instructions::available() {
            for (k, ((a, b), found)) in pairs.iter().zip(batch(set, &pairs)).enumerate() {
                let kind = found.kind(a, b);
                assert_eq!(kind, circle_distance_minima(a, b).kind, "{name} {set:?} {k}: {a:?} {b:?}");
                if !seen.contains(&kind) {
                    seen.push(kind);
                }
            }
        }
    }
    assert_eq!(seen.len(), 5, "{seen:?}");
}

#[test]
fn what_is_out_of_reach_has_no_minima_and_nothing_else_is_lost() {
    let mut left_out = 0;
    for (name, pairs) in pairs() {
        let reach: Vec<f64> = pairs.iter().enumerate().map(|(k, (a, b))| scale(a, b) * 0.1 * (k % 7) as f64).collect();
        let mut out = vec![Approaches::NONE; pairs.len()];
        circle_distance_approaches(&pairs, &reach, &mut out);
        let all = batch(Instructions::available().last().unwrap(), &pairs);
        for ((found, whole), reach) in out.iter().zip(&all).zip(&reach) {
            match found.as_slice().is_empty() {
                true => assert!(whole.as_slice()[0].distance > *reach, "{name}"),
                false => assert_eq!(found, whole, "{name}"),
            }
            left_out += usize::from(found.as_slice().is_empty());
        }
    }
    assert!(left_out > 2_000, "{left_out}");
}

/// Regression: neither of two roots was valid, but the product of their flags said that both were; the distance was
/// off by 5e-9.
#[test]
fn a_pair_near_an_axis_is_left_to_the_single_kernel() {
    let normal = |x, y, z| UnitVector3::new_normalize(Vec3::new(x, y, z));
    let a = Circle::new(Vec3::repeat(7.556001431015456), normal(1.0, 0.0, 0.0), 7.555436039954612);
    let center = Vec3::new(7.527053408706127, 0.0, 7.556001422354441);
    let b = Circle::new(
        center,
        normal(7.728488108867381e-10, 7.556001431123296e-10, -3.2451625575085826),
        7.556001503874342,
    );
    // Computed with 50 digits.
    let exact = 7.527047960694394;
    for set in Instructions::available() {
        let found = batch(set, &[(a, b)]);
        assert!(
            found[0].as_slice().len() == 1 && (found[0].as_slice()[0].distance - exact).abs() < 1e-13,
            "{set:?} {found:?}"
        );
    }
}
