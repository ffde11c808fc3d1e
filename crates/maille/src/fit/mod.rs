//! A design for wanted limits: free numbers of a design are moved until its limits are those.
//!
//! Least squares: the sum of squares of weight × (l1 − wanted) over all targets is made small over the free numbers, each between its
//! bounds. Every design on the way is solved for all targets as any design is, and its certified limits give their derivatives by every free
//! number at no further solve (`sensitivity`), so each step is a Levenberg–Marquardt step within the bounds. A design is not taken if its
//! rings overlap as written and it does not allow that, if they are linked in another way, or if it has no certified limit for a target. Limits have kinks and the sum
//! has several minima: further starts are drawn within the bounds, far from the best one and near to it. What is found is a
//! design that was solved, no estimate. That no design of the family does better is not proved.

mod descent;
mod family;
mod options;
mod search;
mod step;
mod target;

pub use family::{Family, FreeNumber, Make};
pub use options::FitOptions;
pub use target::{Target, Targets, Wanted};

use crate::{answer::Answer, design::Design, error::InvalidInput, sheet::Sheet};
use descent::descend;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use search::{Point, Refused, Search, head};
use std::{
    cell::Cell,
    sync::atomic::{AtomicBool, Ordering},
};

/// How a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Every target is reached within the tolerance.
    Reached,
    /// All starts ended before.
    Missed,
    /// It was cancelled.
    Interrupted,
}

/// What a fit found: the best design that was solved.
#[derive(Clone, Debug)]
pub struct Fit {
    /// How it ended.
    pub ended: Ended,
    /// Values of the free numbers.
    pub numbers: Vec<f64>,
    /// The design with them.
    pub design: Design,
    /// Its answers to the targets.
    pub answers: Vec<Answer>,
    /// Those of the given design.
    pub before: Vec<Answer>,
    /// Factor of the wanted values: 1 but for a shape.
    pub factor: f64,
    /// How far each limit is from its target, in the units of the target.
    pub misses: Vec<f64>,
    /// Starts that were searched.
    pub starts: usize,
    /// Designs that were solved, the refused ones too.
    pub designs: usize,
}

/// How far a fit is.
#[derive(Clone, Copy, Debug)]
pub struct FitProgress {
    /// The current start, from 1.
    pub start: usize,
    /// Designs that were solved.
    pub designs: usize,
    /// The largest miss of the best design yet.
    pub worst_miss: f64,
}

/// The numbers of a family with which its design has the wanted limits, as nearly as could be found. After `cancel` the best design
/// yet comes back.
///
/// # Errors
/// For no starts, numbers without bounds or a tolerance that is not positive; what is wrong with the given design, and where it has no certified limit
/// for a target, or no factor of the shape above 0, or was cancelled before it was solved.
pub fn fit(
    family: &Family<'_>,
    targets: &Targets,
    options: &FitOptions,
    progress: &dyn Fn(FitProgress),
    cancel: &AtomicBool,
) -> Result<Fit, InvalidInput> {
    family.check()?;
    if options.starts == 0 || options.designs == 0 {
        return Err(InvalidInput::new("starts", "without starts or designs nothing is found", "give 1 or more"));
    }
    if !(options.tolerance.is_finite() && options.tolerance > 0.0) {
        let problem = format!("{} is no tolerance", options.tolerance);
        return Err(InvalidInput::new("tolerance", problem, "give a number above 0"));
    }
    let first: Vec<f64> = family.numbers.iter().map(|n| n.value).collect();
    let written = (family.make)(&first).map_err(head)?;
    let links = Sheet::in_cells(&written, options.cells.clone()).map_err(head)?.model().links.clone();
    let search = Search { family, targets, options, links, solved: Cell::new(0), cancel };
    let shares = family.numbers.iter().map(|n| (n.value - n.min) / (n.max - n.min)).collect();
    let given = search.solve(shares).map_err(Refused::of_the_given)?;
    let before = given.answers.clone();
    let (mut best, mut starts) = (given.clone(), 0);
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    while starts < options.starts && !search.reached(&best) && !cancel.load(Ordering::Relaxed) {
        starts += 1;
        let begin = if starts == 1 { Some(given.clone()) } else { drawn(&search, &best, starts, &mut random) };
        let tell = |point: &Point, best: &Point| {
            let better = if point.cost() < best.cost() { point } else { best };
            progress(FitProgress { start: starts, designs: search.solved.get(), worst_miss: better.worst_miss() });
        };
        if let Some(found) = begin.map(|begin| descend(&search, begin, &|point| tell(point, &best)))
            && found.cost() < best.cost()
        {
            best = found;
        }
    }
    let ended = match search.reached(&best) {
        true => Ended::Reached,
        false if cancel.load(Ordering::Relaxed) => Ended::Interrupted,
        false => Ended::Missed,
    };
    Ok(Fit {
        ended,
        numbers: search.values(&best.shares),
        factor: targets.factor(&best.l1),
        misses: best.misses,
        design: best.design,
        answers: best.answers,
        before,
        starts,
        designs: search.solved.get(),
    })
}

/// How far from the best a start near it is drawn, as a share of each range.
const NEAR: f64 = 0.1;
/// How often a refused start is halved towards the best design.
const DRAWS: i32 = 5;

/// A start: every second one anywhere in the bounds, the others near the best design. What is refused is drawn towards the best.
fn drawn(search: &Search<'_>, best: &Point, number: usize, random: &mut ChaCha8Rng) -> Option<Point> {
    let near = number % 2 == 1;
    let share = |x: &f64| match near {
        true => (x + NEAR * random.random_range(-1.0..1.0)).clamp(0.0, 1.0),
        false => random.random_range(0.0..1.0),
    };
    let drawn: Vec<f64> = best.shares.iter().map(share).collect();
    (0..DRAWS).find_map(|k| {
        let towards = |(b, x): (&f64, &f64)| b + (x - b) * 0.5f64.powi(k);
        search.solve(best.shares.iter().zip(&drawn).map(towards).collect()).ok()
    })
}
