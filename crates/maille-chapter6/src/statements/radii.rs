//! What the radii of the rings and the size of the sheet do to limits.

use super::{
    cases::{Cases, Finding, finding},
    cause::cause,
};
use crate::{
    map::{EXACT_TIE, Map, SCALED, at, by_radius, degrees, extreme, range, ratio_label, signed},
    plan::MINIMA_DEG,
};

/// Statement 2.
pub(super) fn thinner_goes_further(maps: &[Map]) -> Finding {
    let mut limits = Cases::of("the thinner ring goes further");
    let mut spreads = Cases::of("the difference grows");
    let mut least_gain = f64::INFINITY;
    for (thick, thin) in by_radius(maps).into_iter().filter(|(thick, _)| thick.is_plain()) {
        for (row, before, after) in thick.both(thin) {
            least_gain = least_gain.min(after - before);
            limits.compare(after - before, thick.tie(), || {
                let because = cause(&[thick, thin], maps, row.l2);
                format!("{}, {}°: {before:.4}, thinner {after:.4}. {because}", at(thick, row.l2), row.direction_deg)
            });
        }
        for (l2, before, after) in thick.spreads(thin) {
            spreads.compare(after - before, thick.tie(), || {
                let because = cause(&[thick, thin], maps, l2);
                format!("{}: largest less least λ₁ − 1 is {before:.4}, thinner {after:.4}. {because}", at(thick, l2))
            });
        }
    }
    let mut evidence = vec![
        format!("The thinner ring goes further in {} (a direction and an l₂).", limits.score()),
        format!("Largest less least λ₁ − 1 grows with it in {}.", spreads.score()),
    ];
    if limits.count() > 0 {
        evidence.push(format!("Least gain in l₁: {least_gain:.4}."));
    }
    let of_2 = spreads.exceptions.iter().filter(|text| text.starts_with("2,")).count();
    let found = finding(
        2,
        "A smaller r/R raises the limit in every direction, and the difference between largest and least limit; for the \
         difference design 2 is somewhat of an exception.",
        evidence,
        vec![limits, spreads],
    );
    match of_2 {
        0 if maps.iter().any(|map| map.design == "2") => found.except(
            "2: the exception that the thesis names is not seen with these coordinates; the difference grows as in the other designs"
                .into(),
        ),
        _ => found,
    }
}

/// Designs that differ in the major radius of the standing rings, the larger first.
pub(crate) const MAJOR: [[&str; 2]; 2] = [["1.1", "1.2"], ["3.1", "3.2"]];
/// Rates that differ by less, relative to the larger, are roughly the same.
const SAME_RATE: f64 = 0.1;

/// Statement 4.
pub(super) fn major_radius(maps: &[Map]) -> Finding {
    let mut directions = Cases::of("the same directions");
    let mut larger = Cases::of("the larger R has the larger limit");
    let mut rates = Cases::of("the difference falls at the same rate");
    for [big, small] in MAJOR {
        for a in maps.iter().filter(|map| map.design == big && map.is_plain()) {
            let same = |b: &&Map| b.design == small && b.is_plain() && (b.ratio, &b.method) == (a.ratio, &a.method);
            let Some(b) = maps.iter().find(same) else { continue };
            let mut before: Option<(f64, f64, f64)> = None;
            for (row, of_a, of_b) in a.both(b) {
                larger.compare(of_a - of_b, a.tie(), || {
                    let because = cause(&[a, b], maps, row.l2);
                    format!("{}, {}°: {of_a:.4}, {small} {of_b:.4}. {because}", at(a, row.l2), row.direction_deg)
                });
            }
            for l2 in a.l2() {
                let (Some(turn_a), Some(turn_b)) = (a.turn(l2), b.turn(l2)) else { continue };
                for (sign, word) in [(1.0, "least"), (-1.0, "largest")] {
                    let [of_a, of_b] = [&turn_a, &turn_b].map(|turn| extreme(turn, sign, a.tie()));
                    let [best_a, best_b] = [&turn_a, &turn_b].map(|turn| extreme(turn, sign, EXACT_TIE));
                    let agree = best_a.iter().all(|d| of_b.contains(d)) && best_b.iter().all(|d| of_a.contains(d));
                    directions.add(agree, || {
                        let because = cause(&[a, b], maps, l2);
                        format!(
                            "{}: {word} at {}, of {small} at {}. {because}",
                            at(a, l2),
                            degrees(&of_a),
                            degrees(&of_b)
                        )
                    });
                }
            }
            for (l2, spread_a, spread_b) in a.spreads(b) {
                if let Some((l2_before, was_a, was_b)) = before {
                    let (fall_a, fall_b) = (was_a - spread_a, was_b - spread_b);
                    let off = (fall_a - fall_b).abs() / fall_a.abs().max(fall_b.abs()).max(f64::MIN_POSITIVE);
                    rates.add(off <= SAME_RATE, || {
                        format!(
                            "{}, l₂ from {} to {}: the difference falls by {fall_a:.3}, of {small} by {fall_b:.3}. {}",
                            a.label(),
                            signed(l2_before),
                            signed(l2),
                            [l2_before, l2].map(|l2| cause(&[a, b], maps, l2)).join(" "),
                        )
                    });
                }
                before = Some((l2, spread_a, spread_b));
            }
        }
    }
    let evidence = vec![
        format!("The directions of least and largest limit agree in {}.", directions.score()),
        format!("The larger R has the larger limit in {} (a direction and an l₂).", larger.score()),
        format!("Largest less least λ₁ − 1 falls with l₂ at the same rate (within 10 %) in {}.", rates.score()),
    ];
    finding(
        4,
        "1.1 against 1.2 and 3.1 against 3.2: the same directions of least and largest limit; the larger R has the larger \
         limit everywhere; the difference falls with l₂ at roughly the same rate, in λ₁ − 1.",
        evidence,
        vec![directions, larger, rates],
    )
}

/// Limits of one sheet in two sizes differ by rounding alone.
const ROUNDING: f64 = 1e-9;

/// Statement 5.
pub(super) fn scale(maps: &[Map]) -> Finding {
    let mut cases = Cases::of("the same limit");
    let mut most: f64 = 0.0;
    for scaled in maps {
        let Some(name) = scaled.design.strip_suffix(SCALED) else { continue };
        let same = |map: &&Map| {
            map.design == name
                && map.is_plain()
                && map.method == scaled.method
                && (map.ratio - scaled.ratio).abs() < 1e-9
        };
        let Some(map) = maps.iter().find(same) else { continue };
        for (row, a, b) in scaled.both(map) {
            most = most.max((a - b).abs());
            cases.add((a - b).abs() <= ROUNDING, || {
                format!("{}, {}°: {b}, scaled {a}", at(map, row.l2), row.direction_deg)
            });
        }
    }
    let evidence = vec![format!("{} agree to 1e-9; largest difference of l₁ {most:.1e}.", cases.score())];
    finding(5, "Scaling every length by one factor leaves the limits unchanged.", evidence, vec![cases])
}

/// Statement 8.
pub(super) fn sharpness(maps: &[Map]) -> Finding {
    let mut cases = Cases::of("the notch is blunter with the thinner ring (l₂ ≤ 0)");
    let mut evidence = Vec::new();
    let mut extended = Vec::new();
    for (thick, thin) in by_radius(maps).into_iter().filter(|(thick, _)| thick.minima) {
        for l2 in thick.l2() {
            for direction in [0.0, 90.0] {
                let (Some(before), Some(after)) = (notch(thick, l2, direction), notch(thin, l2, direction)) else {
                    continue;
                };
                let text = format!(
                    "{}, {direction}°: curvature {before:.2}, with {} {after:.2}",
                    at(thick, l2),
                    ratio_label(thin.ratio)
                );
                if l2 > 0.0 {
                    extended.push((before, after));
                    continue;
                }
                if direction == 0.0 {
                    evidence.push(text.clone() + ".");
                }
                cases.compare(before - after, 1e-6 * before.abs(), || text);
            }
        }
    }
    evidence.insert(
        0,
        format!(
            "With the thinner ring the curve of λ₁ − 1 is less curved inwards at its minima at 0° and 90° in {}.",
            cases.score()
        ),
    );
    if !extended.is_empty() {
        let all = || extended.iter().flat_map(|(before, after)| [*before, *after]);
        let (low, high) = range(all());
        let bulging = all().filter(|x| *x <= 0.0).count();
        evidence.push(format!(
            "For l₂ > 0 there is no notch, or hardly one, and none is judged: the curvature is from {low:.2} to {high:.2}, and {bulging} of {} \
                 curves bulge.",
            all().count()
        ));
    }
    if cases.count() > 0 {
        evidence.push(
            "Where a chain of length d along a lattice vector s binds, λ₁ − 1 = (e + c sin²θ)/cos²θ beside it, e = (d/s)² − 1, c = 1 − \
             (1 + l₂)²: a smooth minimum of curvature 1/e + 2 c/e², which falls with r for every l₂ ≤ 0. The secant over a step \
             of the map would measure the step."
                .into(),
        );
    }
    finding(
        8,
        "The minima at 0° and 90° become less sharp as the minor radius falls (1.2, 4.3).",
        evidence,
        vec![cases],
    )
}

/// How much the polar curve ρ = λ1 − 1 is curved inwards at a direction: (ρ ρ″ − ρ² − 2 ρ′²)/(ρ² + ρ′²)^(3/2), the derivatives by
/// central differences; below 0 it bulges, as a circle does.
pub(super) fn notch(map: &Map, l2: f64, direction_deg: f64) -> Option<f64> {
    let step_deg = MINIMA_DEG[1];
    let of = |d: f64| map.lambda1((direction_deg + d).rem_euclid(180.0), l2).filter(|rho| *rho > 0.0);
    let (before, here, after, step) = (of(-step_deg)?, of(0.0)?, of(step_deg)?, step_deg.to_radians());
    let (first, second) = ((after - before) / (2.0 * step), (after - 2.0 * here + before) / (step * step));
    let size = here * here + first * first;
    Some((here * second - here * here - 2.0 * first * first) / size.powf(1.5))
}
