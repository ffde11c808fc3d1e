//! No minimum is missed: `circle_distance_minima` against dense sampling, on 120,000 pairs.

use crate::common::{Along, FAMILIES, oracle, rng, sample_angles, scale};
use maille_geometry::{Circle, Minimum, circle_distance_minima, point_circle_distance};

const PAIRS_EACH: usize = 20_000;

#[test]
fn every_sampled_minimum_is_enumerated() {
    let angles = sample_angles(720);
    for (seed, (name, family)) in FAMILIES.iter().enumerate() {
        let mut rng = rng(seed as u64);
        let (mut missed, mut checked, mut continua, mut counts) = (0, 0, 0, [0usize; 5]);
        let (mut worst, mut false_ones) = (0.0_f64, 0);
        for index in 0..PAIRS_EACH {
            let (a, b) = family(&mut rng);
            let minima = circle_distance_minima(&a, &b);
            let unit = scale(&a, &b);
            counts[minima.as_slice().len()] += 1;
            continua += usize::from(minima.continuum);
            // Alternate which circle is sampled: the minima must be the same.
            let swapped = index % 2 == 1;
            let along = if swapped { Along::new(&b, &a) } else { Along::new(&a, &b) };
            let sampled = if swapped { oracle(&b, &a, &angles) } else { oracle(&a, &b, &angles) };
            let mut lowest = f64::INFINITY;
            for expected in &sampled {
                checked += 1;
                lowest = lowest.min(expected.distance);
                let hit = minima.as_slice().iter().any(|m| {
                    let point = if swapped { m.point_a } else { m.point_b };
                    // The sampled minimum, or a deeper one between the neighbouring samples.
                    let beside = (point - expected.point_b).norm() < 0.02 * unit && m.distance < expected.distance;
                    (m.distance - expected.distance).abs() < 1e-9 * unit
                        && along.is_level_between(&point, &expected.point_b, 1e-10 * unit)
                        || beside
                });
                if !hit {
                    missed += 1;
                    println!("{name} {index}: missed {expected:?} of {a:?} {b:?}, have {minima:?}");
                }
            }
            let best = minima.closest().distance;
            if lowest.is_finite() {
                worst = worst.max((best - lowest) / unit);
            }
            for m in minima.as_slice() {
                assert_on_circles(m, &a, &b);
                // What is returned is a minimum: no smaller distance next to it.
                let angle = along.angle(if swapped { &m.point_a } else { &m.point_b });
                // On the axis of the other circle it may be a minimum only on a very small scale.
                let scales = m.hessian[0][0].min(m.hessian[1][1]) / m.hessian[0][0].max(m.hessian[1][1]);
                let step = if scales < 1e-3 { 1e-7 } else { 1e-4 };
                let beside = [-step, -0.1 * step, 0.1 * step, step].map(|step| along.distance(angle + step));
                if beside.iter().any(|&d| d < m.distance - 1e-14 * unit) {
                    false_ones += 1;
                    println!("{name} {index}: no minimum {m:?} of {a:?} {b:?}");
                }
            }
        }
        println!(
            "{name}: {PAIRS_EACH} pairs, {checked} sampled minima, {missed} missed, {false_ones} false, \
             distance above the sampled by at most {worst:.1e}, \
             pairs with 1/2/3/4 minima {}/{}/{}/{}, continua {continua}",
            counts[1], counts[2], counts[3], counts[4]
        );
        assert_eq!((missed, false_ones), (0, 0), "{name}");
        assert!(worst < 1e-12, "{name}: {worst:e}");
        // Observed, not proved.
        assert_eq!((counts[3], counts[4]), (0, 0), "{name}: more than two minima");
    }
}

/// The fields of a minimum are consistent, and it is a minimum.
fn assert_on_circles(m: &Minimum, a: &Circle, b: &Circle) {
    let unit = scale(a, b);
    let close = 4e-15 * (unit + a.center.norm() + b.center.norm());
    assert!(((m.point_a - m.point_b).norm() - m.distance).abs() < close, "{m:?}");
    assert!((a.point(a.angle_rad(&m.point_a)) - m.point_a).norm() < close, "{m:?} {a:?}");
    assert!((b.point(m.angle_b_rad()) - m.point_b).norm() < close, "{m:?} {b:?}");
    assert!((point_circle_distance(&m.point_a, b).distance - m.distance).abs() < close, "{m:?}");
    assert!((point_circle_distance(&m.point_b, a).distance - m.distance).abs() < close, "{m:?}");
    let area = unit * unit;
    let [[aa, ab], [ba, bb]] = m.hessian;
    // Near the axis of the other circle (small aa or bb) the rounding of the angle changes the gradient by that
    // over aa or bb.
    let steepness = area / aa.abs().min(bb.abs());
    assert!(m.gradient.iter().all(|g| g.abs() < (1e-14 + 1e-15 * steepness) * area), "{m:?}");
    assert!(ab == ba && aa > -1e-12 * area && bb > -1e-12 * area && aa * bb - ab * ab > -1e-12 * area * area, "{m:?}");
}
