//! A design for wanted limits: free numbers of a design are moved until its limits are those.
//!
//! The sum of squares of weight × miss over all targets, or the largest of them, is made small over the free numbers, each between its
//! bounds. Every design on the way is solved for all targets, from the states of the last one first, and its certified limits give their derivatives by every free
//! number at no further solve (`sensitivity`), but for Poisson ratios (`slopes`). A step is that of a model: the tangents of the limits at the current design and at those that were
//! solved near it, as limits have kinks; within a box that shrinks where the model promises too much. A design is not taken if its
//! rings overlap as written and it does not allow that, if they are linked in another way, or if it has no certified limit for a target.
//! There are several minima: further starts are drawn within the bounds, by turns far from the best one and near to it; where all free numbers
//! are radii, the former are those whose proven bounds are what is wanted. What is found is a
//! design that was solved, no estimate: its limits are searched again, from no other state and at least with normal effort. That no design of the family does better is proved only where a bound of all of them forbids a target.
//!
//! The method, with its measurements: `docs/theory/fit.md`.

mod bounds;
mod descent;
mod family;
mod forbid;
mod options;
mod place;
mod search;
mod slopes;
mod starts;
mod step;
mod target;

pub use family::{Family, FreeNumber, Make, NumberKind};
pub use options::{FitOptions, Norm};
pub use place::linked_alike;
pub use target::{Measure, Target, Targets, Wanted};

use crate::{answer::Answer, lattice::Cell as LatticeCell, model::Model, sensitivity::permutations, sheet::Sheet};
use descent::descend;
use forbid::family_bounds;
use maille_design::{Design, InvalidInput};
use search::{Point, Refused, Search, head};
use serde::{Deserialize, Serialize};
use starts::{solved_in_place, start};
use std::{
    cell::Cell,
    sync::atomic::{AtomicBool, Ordering},
};

/// How a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    /// Factor of the wanted limits: 1 but for a shape.
    pub factor: f64,
    /// How far each value is from its target: 0 where that is reached, below 0 where the value is too small.
    pub misses: Vec<f64>,
    /// What is proved of each limit for all designs of the family: none has a larger one. Known where all free numbers are radii.
    pub bounds: Vec<Option<f64>>,
    /// Starts that were searched.
    pub starts: usize,
    /// Designs that were solved, the refused ones too.
    pub designs: usize,
}

impl Fit {
    /// Whether a target is proved to be out of reach of every design of the family, by the bound of its limit.
    pub fn is_forbidden(&self, targets: &Targets, target: usize) -> bool {
        let least = targets.iter().nth(target).filter(|_| !targets.is_shape()).and_then(|target| match target.wanted {
            Wanted::Value(value) | Wanted::AtLeast(value) => Some(value),
            Wanted::AtMost(_) => None,
        });
        let beyond = |(value, bound): (f64, f64)| value > bound + FORBIDDEN;
        least.zip(self.bounds[target]).is_some_and(beyond)
    }
}

/// A wanted limit is out of reach where it exceeds the bound by this, beyond the tolerance of bounds.
const FORBIDDEN: f64 = 1e-9;

/// How far a fit is.
#[derive(Clone, Debug)]
pub struct FitProgress {
    /// The current start, from 1.
    pub start: usize,
    /// Designs that were solved.
    pub designs: usize,
    /// The largest miss of the best design yet.
    pub worst_miss: f64,
    /// Its free numbers.
    pub numbers: Vec<f64>,
    /// While a start is sought by bounds: descents that are done, and all of them at most.
    pub by_bounds: Option<[usize; 2]>,
}

/// The numbers of a family with which its design has the wanted limits, as nearly as could be found. After `cancel` the best design
/// yet comes back.
///
/// `resumed` are the numbers of the best design of an earlier fit of the same family, and how many starts it had searched: the search goes
/// on from there.
///
/// # Errors
/// For a design with curves, no starts, numbers without bounds or a tolerance that is not positive; what is wrong with the given design, and where it has no certified limit
/// for a target, or no factor of the shape above 0, or was cancelled before it was solved.
pub fn fit(
    family: &Family<'_>,
    targets: &Targets,
    options: &FitOptions,
    resumed: Option<(&[f64], usize)>,
    progress: &dyn Fn(FitProgress),
    cancel: &AtomicBool,
) -> Result<Fit, InvalidInput> {
    family.check()?;
    options.check()?;
    let first: Vec<f64> = family.numbers.iter().map(|n| n.value).collect();
    let written = (family.make)(&first).map_err(head)?;
    let links = Sheet::in_cells(&written, options.cells.clone()).map_err(head)?.model().links.clone();
    let model = Model::compile(&written, LatticeCell::PRIMITIVE).map_err(head)?;
    if !model.is_round() {
        let help = "vary its numbers by a study instead";
        return Err(InvalidInput::new("design", "has curves, for which no derivatives are known yet", help));
    }
    let symmetries = family.rates(&first).map(|rates| permutations(&model, &rates)).unwrap_or_default();
    let solved = Cell::new(0);
    let search = Search {
        family,
        targets,
        options,
        links: &links,
        model: &model,
        place: None,
        near: None,
        symmetries: &symmetries,
        by_bounds: false,
        solved: &solved,
        cancel,
    };
    let given = search.solve(search.shares(&first)).map_err(Refused::of_the_given)?;
    let again = resumed.and_then(|(numbers, _)| solved_in_place(&search, search.shares(numbers)));
    let (mut best, mut starts) = (again.unwrap_or_else(|| given.clone()), resumed.map_or(0, |(_, starts)| starts));
    let mut is_confirmed = false;
    while starts < options.starts && !cancel.load(Ordering::Relaxed) {
        if search.reached(&best) {
            best = confirmed(&search, best);
            is_confirmed = search.reached(&best);
            if is_confirmed {
                break;
            }
        }
        starts += 1;
        let now = |point: &Point, by_bounds: Option<[usize; 2]>| {
            let better = if point.cost < best.cost { point } else { &best };
            progress(FitProgress {
                start: starts,
                designs: search.solved.get(),
                worst_miss: better.worst_miss(),
                numbers: search.values(&better.shares),
                by_bounds,
            });
        };
        let begin = match starts {
            1 => Some(best.clone()),
            _ => start(&search, &best, starts, &|done| now(&best, Some(done))),
        };
        let mut tell = |point: &Point| now(point, None);
        if let Some(found) = begin.map(|begin| descend(&search.at(&begin.design.clone()), begin, &mut tell))
            && found.cost < best.cost
        {
            best = found;
        }
    }
    if !is_confirmed {
        best = confirmed(&search, best);
    }
    let before = if options.effort == options.final_effort() { given } else { confirmed(&search, given) };
    let ended = match cancel.load(Ordering::Relaxed) {
        true => Ended::Interrupted,
        false if search.reached(&best) => Ended::Reached,
        false => Ended::Missed,
    };
    Ok(Fit {
        ended,
        numbers: search.values(&best.shares),
        factor: targets.factor(&best.values),
        bounds: family_bounds(&search),
        answers: best.answers().to_vec(),
        misses: best.misses,
        design: best.design,
        before: before.answers().to_vec(),
        starts,
        designs: search.solved.get(),
    })
}

/// A point as a map of its design finds it: with the final effort, from no state of another design. Where that is interrupted it stays as
/// it is.
fn confirmed(search: &Search<'_>, point: Point) -> Point {
    let options = FitOptions { effort: search.options.final_effort(), ..search.options.clone() };
    let last = Search { options: &options, solved: &Cell::new(0), ..*search };
    last.at(&point.design).solve(point.shares.clone()).unwrap_or(point)
}
