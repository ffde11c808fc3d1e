//! Adversarial pairs against the sampling oracle: no wrong minimum, and no significant one missed.
//!
//! The environment variable `MAILLE_PAIRS` sets the number of pairs (default 70,000). `MAILLE_HARDEST` names a file
//! for the 5,000 pairs whose minima are closest to merging, which `validation/pairs.py` solves with 50 digits.
//! Results are in `docs/reliability.md`.

use crate::common::{
    Along, Family, Oracle, Pair, Rng, degenerate, direction, oracle, rng, sample_angles, scale, uniform, unit,
};
use maille_geometry::{Approaches, Circle, Minima, Minimum, Vec3, circle_distance_approaches, circle_distance_minima};
use nalgebra::UnitVector3;
use rand::RngExt;
use std::{fmt::Write as _, io::Write as _};

const FAMILIES: [(&str, Family); 7] = [
    ("merging", merging),
    ("nearly parallel", nearly_parallel),
    ("nearly coaxial", nearly_coaxial),
    ("unlike radii", unlike_radii),
    ("far from the origin", far),
    ("tiny", tiny),
    ("touching", touching),
];
/// A minimum is significant if it is surrounded by a barrier of this height, relative to the pair's size.
const SIGNIFICANT: f64 = 1e-9;
/// Number of pairs written for `validation/pairs.py`.
const HARDEST: usize = 5_000;

fn power(rng: &mut Rng, from: f64, to: f64) -> f64 {
    10f64.powf(rng.random_range(from..to))
}

fn shifted(pair: Pair, factor: f64, by: Vec3) -> Pair {
    let move_one = |c: Circle| Circle::new(c.center * factor + by, c.normal, c.radius * factor);
    (move_one(pair.0), move_one(pair.1))
}

/// On the path from a pair with two minima to one with one minimum, 1e-1 … 1e-14 before the point where one vanishes.
fn merging(rng: &mut Rng) -> Pair {
    loop {
        let (a, from) = uniform(rng);
        let (_, to) = uniform(rng);
        let between = |t: f64| {
            let normal = UnitVector3::new_normalize(from.normal.lerp(&to.normal, t));
            Circle::new(from.center.lerp(&to.center, t), normal, from.radius + (to.radius - from.radius) * t)
        };
        let count = |t: f64| circle_distance_minima(&a, &between(t)).as_slice().len();
        let at_start = count(0.0);
        if at_start == count(1.0) {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let near = power(rng, -14.0, -1.0);
        while high - low > near {
            let middle = 0.5 * (low + high);
            if count(middle) == at_start { low = middle } else { high = middle }
        }
        return (a, between(if rng.random_bool(0.5) { low } else { high }));
    }
}

fn nearly_parallel(rng: &mut Rng) -> Pair {
    let tilt = power(rng, -16.0, -1.0);
    let turn = rng.random_range(0.0..std::f64::consts::TAU);
    let a = Circle::new(Vec3::zeros(), unit(0.0, 0.0, 1.0), 1.0);
    let normal = unit(tilt * turn.cos(), tilt * turn.sin(), if rng.random_bool(0.5) { 1.0 } else { -1.0 });
    let aside = Vec3::new(rng.random_range(-2.5..2.5), rng.random_range(-0.1..0.1), 0.0);
    let height = if rng.random_bool(0.3) { 0.0 } else { power(rng, -12.0, 0.0) };
    (a, Circle::new(aside + Vec3::z() * height, normal, rng.random_range(0.2..1.5)))
}

fn nearly_coaxial(rng: &mut Rng) -> Pair {
    let (aside, tilt) = (power(rng, -16.0, -1.0), power(rng, -16.0, -1.0));
    let a = Circle::new(Vec3::zeros(), unit(0.0, 0.0, 1.0), 1.0);
    let radius = if rng.random_bool(0.5) { 1.0 } else { 1.0 + power(rng, -12.0, -1.0) };
    let center = *direction(rng) * aside + Vec3::z() * rng.random_range(-0.5..0.5);
    (a, Circle::new(center, UnitVector3::new_normalize(Vec3::z() + *direction(rng) * tilt), radius))
}

/// Radius ratios 1e-4 … 1e4, the smaller circle often close to the larger one.
fn unlike_radii(rng: &mut Rng) -> Pair {
    let a = Circle::new(Vec3::zeros(), direction(rng), 1.0);
    let radius = power(rng, -4.0, 4.0);
    let near = if rng.random_bool(0.7) { a.point(rng.random_range(-3.1..3.1)) } else { Vec3::zeros() };
    let b = Circle::new(near + *direction(rng) * power(rng, -6.0, 0.5) * radius.min(1.0), direction(rng), radius);
    // A large circle must come near the small one with a point, not with its centre.
    let rim = b.point(rng.random_range(-3.1..3.1)) - b.center;
    (a, if radius > 1.0 { Circle::new(b.center - rim, b.normal, radius) } else { b })
}

fn far(rng: &mut Rng) -> Pair {
    let by = *direction(rng) * power(rng, 2.0, 6.0);
    shifted(if rng.random_bool(0.5) { uniform(rng) } else { degenerate(rng) }, 1.0, by)
}

fn tiny(rng: &mut Rng) -> Pair {
    let pair = if rng.random_bool(0.5) { uniform(rng) } else { degenerate(rng) };
    shifted(pair, power(rng, -12.0, -6.0), Vec3::zeros())
}

/// Distances of 1e-16 … 1e-2 at one point.
fn touching(rng: &mut Rng) -> Pair {
    let (a, b) = uniform(rng);
    let (p, q) = (a.point(rng.random_range(-3.1..3.1)), b.point(rng.random_range(-3.1..3.1)));
    let gap = *direction(rng) * power(rng, -16.0, -2.0);
    (a, Circle::new(b.center + p - q + gap, b.normal, b.radius))
}

/// The rounding error of the input numbers themselves, which no method can avoid.
fn rounding((a, b): &Pair) -> f64 {
    let size = a.center.norm().max(b.center.norm()) + a.radius.max(b.radius);
    8.0 * f64::EPSILON * size
}

/// The smaller of the barriers in both directions from `expected` to the nearest lower point, or around the circle.
fn is_significant(along: &Along, expected: &Oracle, unit: f64) -> bool {
    let at = along.angle(&expected.point_b);
    let level = expected.distance + SIGNIFICANT * unit;
    let leaves = |side: f64| {
        // Growing steps: where minima are about to merge, the barriers are near.
        let mut step = 1e-6;
        while step < std::f64::consts::TAU {
            let d = along.distance(at + side * step);
            if d > level {
                return true;
            }
            if d < expected.distance - SIGNIFICANT * unit {
                return false;
            }
            step *= 1.05;
        }
        false
    };
    leaves(1.0) && leaves(-1.0)
}

/// How close minima are to merging: the smallest ratio of the determinant of the Hessian to its squared trace.
fn hardness(minima: &Minima) -> f64 {
    minima.as_slice().iter().map(flatness).fold(f64::INFINITY, f64::min)
}

fn flatness(m: &Minimum) -> f64 {
    let [[aa, ab], [_, bb]] = m.hessian;
    ((aa * bb - ab * ab) / (aa + bb).powi(2)).abs()
}

#[test]
fn no_adversarial_pair_has_a_wrong_or_missed_minimum() {
    let pairs: usize = std::env::var("MAILLE_PAIRS").map_or(70_000, |n| n.parse().expect("MAILLE_PAIRS is a number"));
    let angles = sample_angles(720);
    let mut hardest: Vec<(f64, Pair, Minima)> = Vec::new();
    let mut failures = 0;
    for (seed, (name, family)) in FAMILIES.iter().enumerate() {
        let mut rng = rng(900 + seed as u64);
        let (mut significant, mut missed, mut wrong, mut worst) = (0, 0, 0, 0.0_f64);
        for index in 0..pairs / FAMILIES.len() {
            let pair = family(&mut rng);
            let (a, b) = &pair;
            let minima = circle_distance_minima(a, b);
            let (along, unit) = (Along::new(a, b), scale(a, b));
            let allowed = 1e-9 * unit + rounding(&pair);
            let mut batch = [Approaches::NONE];
            circle_distance_approaches(&[pair], &[f64::INFINITY], &mut batch);
            let batched = batch[0].as_slice().iter().map(|approach| approach.distance).fold(f64::INFINITY, f64::min);
            if (batched - minima.closest().distance).abs() > allowed {
                wrong += 1;
                println!("{name} {index}: the batch has {batched}, not {:?}", minima.closest());
            }
            let mut lowest = f64::INFINITY;
            for expected in oracle(a, b, &angles) {
                lowest = lowest.min(expected.distance);
                if !is_significant(&along, &expected, unit) {
                    continue;
                }
                significant += 1;
                let near = |m: &Minimum| {
                    (m.distance - expected.distance).abs() <= allowed
                        && along.is_level_between(&m.point_b, &expected.point_b, allowed)
                };
                if !minima.as_slice().iter().any(near) {
                    missed += 1;
                    println!("{name} {index}: missed {expected:?} of {pair:?}, have {minima:?}");
                }
            }
            for m in minima.as_slice() {
                // The distance is that of the points; the gradient of g = d²/2 vanishes there, and its Hessian is
                // not negative.
                let at = along.angle(&m.point_b);
                let off = (along.distance(at) - m.distance).abs();
                let step = 1e-5 * (unit.min(a.radius) / b.radius).min(1.0);
                let half_sq = |angle: f64| 0.5 * along.distance(angle).powi(2);
                let [behind, here, ahead] = [-step, 0.0, step].map(|by| half_sq(at + by));
                let noise = rounding(&pair) * (m.distance + b.radius * step) / step;
                // Near the axis of A the derivatives change quickly.
                let slope = (half_sq(at + 0.1 * step) - half_sq(at - 0.1 * step)).abs() / (0.2 * step);
                let curve = (2.0 * here - ahead - behind) / (step * step);
                let area = unit * b.radius.min(unit);
                // On the axis of A it may be a minimum only on the scale of rounding.
                let curves = curve > 1e-5 * area + 4.0 * noise / step && flatness(m) > 1e-9;
                if off > allowed || slope > 1e-8 * area + 10.0 * noise || curves {
                    wrong += 1;
                    println!(
                        "{name} {index}: {m:?} of {pair:?} is off by {off:e}, slope {slope:e}, curves down by {curve:e}"
                    );
                }
            }
            if lowest.is_finite() {
                let above = minima.closest().distance - lowest;
                worst = worst.max((above - rounding(&pair)) / unit);
                wrong += usize::from(above > allowed);
            }
            // On a continuum any point is correct.
            if !minima.continuum {
                hardest.push((hardness(&minima), pair, minima));
            }
            if hardest.len() >= 4 * HARDEST {
                keep_hardest(&mut hardest);
            }
        }
        println!(
            "{name}: {} pairs, {significant} significant minima, {missed} missed, {wrong} wrong, distance above the sampled \
             by at most {worst:.1e}",
            pairs / FAMILIES.len()
        );
        failures += missed + wrong;
    }
    assert_eq!(failures, 0);
    if let Some(file) = std::env::var_os("MAILLE_HARDEST") {
        keep_hardest(&mut hardest);
        let mut out = std::fs::File::create(file).expect("the file of the hardest pairs");
        for (_, (a, b), minima) in &hardest {
            let mut line = String::new();
            for c in [a, b] {
                let (p, n) = (c.center, c.normal);
                write!(line, "{:?},{:?},{:?},{:?},{:?},{:?},{:?},", p.x, p.y, p.z, n.x, n.y, n.z, c.radius).unwrap();
            }
            let found: Vec<String> = minima.as_slice().iter().map(|m| format!("{:?}", m.distance)).collect();
            writeln!(out, "{line}{}", found.join(" ")).expect("the file of the hardest pairs");
        }
    }
}

fn keep_hardest(pairs: &mut Vec<(f64, Pair, Minima)>) {
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0));
    pairs.truncate(HARDEST);
}
