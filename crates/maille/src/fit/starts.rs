//! Where the descents after the first begin.

use super::{
    descent::descend,
    family::NumberKind,
    options::FitOptions,
    place::linked_as,
    search::{Point, Refused, Search},
    target::Measure,
};
use crate::sensitivity::RingVector;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::{cell::Cell, sync::atomic::Ordering};

/// How far from the best a start near it is drawn, as a share of each range.
const NEAR: f64 = 0.1;
/// How many starts are drawn until one has all limits.
const DRAWS: usize = 20;
/// How often the last of them is halved towards the best design.
const HALVINGS: i32 = 5;
/// Descents on bounds: so many from anywhere, then the others from the best of them.
const DRAWN_BY_BOUNDS: usize = 100;
const BY_BOUNDS: usize = 160;
/// A bound takes a time like the cube of the number of elements. For more than these there are fewer descents, and from `MOST_ELEMENTS` on none.
const ELEMENTS: usize = 16;
const MOST_ELEMENTS: usize = 40;
/// Designs of one of them, at most.
const DESIGNS_BY_BOUNDS: usize = 25;
/// Shares of the numbers that are drawn anew before a descent from the best, in turn.
const REDRAWN: [f64; 3] = [0.1, 0.2, 0.3];
/// A number is drawn about one of these shares of its range, within this.
const LEVELS: [f64; 3] = [0.05, 0.5, 0.95];
const SPREAD: f64 = 0.05;
/// So many designs whose bounds are what is wanted are measured by their limits, at most.
const MEASURED: usize = 3;

/// Start number `number`, from 2: every second one anywhere in the ranges, the others near the best design. Each start has random
/// numbers of its own. Where bounds say something, the former is a design whose bounds are what is wanted; `tell` hears of the descents on
/// bounds, how many are done of how many.
pub(super) fn start(search: &Search<'_>, best: &Point, number: usize, tell: &dyn Fn([usize; 2])) -> Option<Point> {
    let mut random = ChaCha8Rng::seed_from_u64(search.options.seed);
    random.set_stream(number as u64);
    let near = number % 2 == 1;
    let of_bounds = if near { None } else { by_bounds(search, &mut random, tell) };
    of_bounds.or_else(|| drawn(search, best, near, &mut random))
}

/// A start that was drawn. If none that was drawn has all limits, the last one is drawn towards the best design.
fn drawn(search: &Search<'_>, best: &Point, near: bool, random: &mut ChaCha8Rng) -> Option<Point> {
    let mut draw = || -> Vec<f64> {
        if !near {
            return symmetric(search, random);
        }
        best.shares.iter().map(|x| (x + NEAR * random.random_range(-1.0..1.0)).clamp(0.0, 1.0)).collect()
    };
    let mut last = Vec::new();
    for _ in 0..DRAWS {
        last = draw();
        match search.solve(last.clone()) {
            Ok(point) => return Some(point),
            Err(Refused::Interrupted) => return None,
            Err(_) => {}
        }
    }
    (1..=HALVINGS).find_map(|k| {
        let towards = |(b, x): (&f64, &f64)| b + (x - b) * 0.5f64.powi(k);
        search.solve(best.shares.iter().zip(&last).map(towards).collect()).ok()
    })
}

/// Shares from anywhere in the ranges. Numbers that a symmetry of the given design maps to each other are alike, the symmetry being
/// drawn anew each time: many wanted profiles are symmetric.
fn symmetric(search: &Search<'_>, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut draw = |_| LEVELS[random.random_range(0..LEVELS.len())] + random.random_range(-SPREAD..SPREAD);
    let mut shares: Vec<f64> = search.family.numbers.iter().map(&mut draw).collect();
    let symmetry = random.random_range(0..=search.symmetries.len());
    let Some(image) = search.symmetries.get(symmetry) else { return shares };
    let mut known = vec![false; shares.len()];
    for first in 0..shares.len() {
        let mut at = first;
        while !known[at] {
            known[at] = true;
            shares[at] = shares[first];
            at = image[at];
        }
    }
    shares
}

/// A design whose bounds are what is wanted, as nearly as many descents find one, measured by its limits. A bound takes a small
/// part of the time of its limit, and is often attained. After the first descents, each begins at the best design yet with some of its
/// numbers drawn anew: from anywhere, nearly all end in the same poor minimum.
fn by_bounds(search: &Search<'_>, random: &mut ChaCha8Rng, tell: &dyn Fn([usize; 2])) -> Option<Point> {
    let stretches = search.targets.iter().all(|target| matches!(target.measure, Measure::Stretch { .. }));
    let elements = search.model.elements.len();
    if !search.family.of_radii() || !stretches || elements >= MOST_ELEMENTS {
        return None;
    }
    let fewer = |descents: usize| descents * ELEMENTS.pow(3) / elements.max(ELEMENTS).pow(3);
    let (options, solved) = (FitOptions { designs: DESIGNS_BY_BOUNDS, ..search.options.clone() }, Cell::new(0));
    let bounds = Search { options: &options, by_bounds: true, solved: &solved, ..*search };
    let measured = |point: &Point| solved_in_place(search, thinned(search, point.shares.clone()));
    let (mut found, mut best): (Vec<Point>, Option<Point>) = (Vec::new(), None);
    let mut measurements = 0;
    for k in 0..fewer(BY_BOUNDS) {
        if search.cancel.load(Ordering::Relaxed) || measurements == MEASURED {
            break;
        }
        tell([k, fewer(BY_BOUNDS)]);
        let mut shares = symmetric(search, random);
        if let (true, Some(best)) = (k >= fewer(DRAWN_BY_BOUNDS), found.first()) {
            let share = REDRAWN[k % REDRAWN.len()];
            let redrawn = |(x, best): (f64, &f64)| if random.random_range(0.0..1.0) < share { x } else { *best };
            shares = shares.into_iter().zip(&best.shares).map(redrawn).collect();
        }
        let Ok(begin) = bounds.solve(shares) else { continue };
        let end = descend(&bounds, begin, &mut |_| ());
        if bounds.reached(&end) {
            measurements += 1;
            best = best.into_iter().chain(measured(&end)).min_by(|a, b| a.cost.total_cmp(&b.cost));
            if best.as_ref().is_some_and(|best| search.reached(best)) {
                return best;
            }
        }
        let after = found.partition_point(|other| other.cost <= end.cost);
        found.insert(after, end);
    }
    best.or_else(|| found.iter().take(MEASURED).find_map(measured))
}

/// The design with these shares, measured, its rings linked as those of the given one.
pub(super) fn solved_in_place(search: &Search<'_>, shares: Vec<f64>) -> Option<Point> {
    let place = linked_as(search.family, search.model, &search.values(&shares), search.cancel)?;
    search.at(&place).solve(shares).ok()
}

/// Shares with wires as thin as they go where R − r stays: bounds by links stay, and rings have more room to attain them.
fn thinned(search: &Search<'_>, mut shares: Vec<f64>) -> Vec<f64> {
    let Ok(rates) = search.family.rates(&search.values(&shares)) else { return shares };
    let of = |k: usize, kind: NumberKind| -> Option<Vec<usize>> {
        let rings = rates[k].rings.iter().enumerate();
        let moved =
            |ring: &RingVector| if kind == NumberKind::MajorRadius { ring.major_radius } else { ring.minor_radius };
        let rings = rings.filter(|(_, ring)| moved(ring) != 0.0).map(|(i, _)| i).collect();
        (search.family.numbers[k].kind == kind).then_some(rings)
    };
    let numbers = &search.family.numbers;
    for minor in 0..shares.len() {
        let Some(rings) = of(minor, NumberKind::MinorRadius) else { continue };
        let same = |major: &usize| of(*major, NumberKind::MajorRadius).is_some_and(|others| others == rings);
        let Some(major) = (0..shares.len()).find(same) else { continue };
        let [across, along] = [minor, major].map(|k| numbers[k].max - numbers[k].min);
        let thinner = f64::min(shares[minor] * across, shares[major] * along);
        shares[minor] -= thinner / across;
        shares[major] -= thinner / along;
    }
    shares
}
