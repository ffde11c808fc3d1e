//! A design for wanted limits: free numbers of a design are moved until its limits are those.
//!
//! Least squares: the sum of squares of weight × (l1 − wanted) over all targets is made small over the free numbers, each between its
//! bounds. Every design on the way is solved for all targets as any design is, and its certified limits give their derivatives by every free
//! number at no further solve (`sensitivity`), so each step is a Levenberg–Marquardt step within the bounds. A design whose
//! rings overlap, or are linked in another way, or that has no certified limit for a target, is not taken. Limits have kinks and the sum
//! has several minima: further starts are drawn within the bounds, far from the best one and near to it. What is found is a
//! design that was solved, no estimate. That no design of the family does better is not proved.

mod descent;
mod family;
mod step;
mod target;

pub use family::{Family, FreeNumber, Make};
pub use target::{Target, Targets, Wanted};

use crate::{
    answer::Answer,
    design::Design,
    error::InvalidInput,
    model::Link,
    question::{Effort, Question},
    record::Status,
    sensitivity,
    sheet::Sheet,
    survey::CellChoice,
};
use descent::descend;
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::{
    cell::Cell as Count,
    sync::atomic::{AtomicBool, Ordering},
};

/// How a fit searches.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// Starts, the first of them the given design.
    pub starts: usize,
    /// Seed of the starts that are drawn, and of the search of each limit.
    pub seed: u64,
    /// Every miss at most this, in units of l1, ends the fit.
    pub tolerance: f64,
    /// Designs that are solved from one start, at most.
    pub designs: usize,
    /// The cells of each limit.
    pub cells: CellChoice,
    /// How long each limit is searched.
    pub effort: Effort,
}

impl Default for FitOptions {
    fn default() -> Self {
        let (cells, effort) = (CellChoice::Auto, Effort::Normal);
        FitOptions { starts: 8, seed: 1, tolerance: 1e-6, designs: 60, cells, effort }
    }
}

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

/// A design that was solved for all targets.
#[derive(Clone)]
struct Point {
    /// Each number as a share of its range.
    shares: Vec<f64>,
    design: Design,
    sheet: Sheet,
    answers: Vec<Answer>,
    l1: Vec<f64>,
    residuals: DVector<f64>,
}

impl Point {
    fn cost(&self) -> f64 {
        self.residuals.norm_squared()
    }
}

/// Why a design was not taken.
enum Refused {
    Design(InvalidInput),
    Limit(Target, Status),
    Shape,
    Interrupted,
}

/// What all starts share.
struct Search<'a> {
    family: &'a Family<'a>,
    targets: &'a Targets,
    options: &'a FitOptions,
    /// Links of the given design.
    links: Vec<Link>,
    solved: Count<usize>,
    cancel: &'a AtomicBool,
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
    let search = Search { family, targets, options, links, solved: Count::new(0), cancel };
    let shares = family.numbers.iter().map(|n| (n.value - n.min) / (n.max - n.min)).collect();
    let given = search.solve(shares).map_err(Refused::of_the_given)?;
    let before = given.answers.clone();
    let (mut best, mut starts) = (given.clone(), 0);
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    while starts < options.starts && !search.reached(&best) && !cancel.load(Ordering::Relaxed) {
        starts += 1;
        let begin = if starts == 1 { Some(given.clone()) } else { search.drawn(&best, starts, &mut random) };
        let tell = |point: &Point, best: &Point| {
            let better = if point.cost() < best.cost() { point } else { best };
            progress(FitProgress {
                start: starts,
                designs: search.solved.get(),
                worst_miss: search.worst_miss(better),
            });
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
        misses: targets.misses(&best.l1).unwrap_or_default(),
        design: best.design,
        answers: best.answers,
        before,
        starts,
        designs: search.solved.get(),
    })
}

fn head(problems: Vec<InvalidInput>) -> InvalidInput {
    let none = || InvalidInput::new("design", "cannot be used", "check it by itself");
    problems.into_iter().next().unwrap_or_else(none)
}

impl Refused {
    /// The error where the given design itself cannot be used.
    fn of_the_given(self) -> InvalidInput {
        match self {
            Refused::Design(problem) => problem,
            Refused::Limit(target, status) => {
                let (direction, l2) = (target.direction_deg, target.l2);
                let problem = format!("along {direction}\u{b0} at l2 {l2} the given design is {}", status.name());
                InvalidInput::new("targets", problem, "begin with a design that has every limit that is wanted")
            }
            Refused::Shape => {
                let problem = "the given design does not stretch along the directions of the shape";
                InvalidInput::new("targets", problem, "begin with a design whose limits there are above 0")
            }
            Refused::Interrupted => {
                InvalidInput::new("fit", "was interrupted before the given design was solved", "begin it again")
            }
        }
    }
}

impl Search<'_> {
    fn values(&self, shares: &[f64]) -> Vec<f64> {
        let value = |(n, share): (&FreeNumber, &f64)| match *share {
            // The ends exactly.
            1.0 => n.max,
            share => n.min + share * (n.max - n.min),
        };
        self.family.numbers.iter().zip(shares).map(value).collect()
    }

    /// The design with these shares, solved for all targets.
    fn solve(&self, shares: Vec<f64>) -> Result<Point, Refused> {
        self.solved.set(self.solved.get() + 1);
        let first = |problems| Refused::Design(head(problems));
        let design = (self.family.make)(&self.values(&shares)).map_err(first)?;
        let sheet = Sheet::in_cells(&design, self.options.cells.clone()).map_err(first)?;
        if sheet.model().links != self.links {
            let problem = "its rings are linked in another way than those of the given design";
            return Err(Refused::Design(InvalidInput::new("design", problem, "give narrower bounds")));
        }
        let questions: Vec<Question> = self.targets.iter().map(|target| self.question(target)).collect();
        let answers = questions.par_iter().map(|question| sheet.answer_until(question, self.cancel));
        let answers = answers.collect::<Result<Vec<_>, _>>().map_err(Refused::Design)?;
        let mut l1 = Vec::with_capacity(answers.len());
        for (answer, target) in answers.iter().zip(self.targets.iter()) {
            match (answer.limit(), answer.status) {
                (Some(value), _) => l1.push(value),
                (None, Status::Interrupted) => return Err(Refused::Interrupted),
                (None, status) => return Err(Refused::Limit(*target, status)),
            }
        }
        let residuals = self.targets.residuals(&l1).ok_or(Refused::Shape)?;
        Ok(Point { shares, design, sheet, answers, l1, residuals })
    }

    fn question(&self, target: &Target) -> Question {
        Question { effort: self.options.effort, seed: self.options.seed, ..target.question() }
    }

    /// Derivatives of the residuals by the shares.
    ///
    /// # Errors
    /// Where the design or an answer has none.
    fn slopes(&self, point: &Point) -> Result<DMatrix<f64>, InvalidInput> {
        let rates = self.family.rates(&self.values(&point.shares))?;
        let mut slopes = DMatrix::zeros(point.answers.len(), rates.len());
        for (k, (answer, target)) in point.answers.iter().zip(self.targets.iter()).enumerate() {
            let model = point.sheet.model_of(answer);
            let along = sensitivity::gradient(&model, &self.question(target), answer, &rates)?;
            slopes.row_mut(k).copy_from_slice(&along);
        }
        Ok(self.targets.residual_slopes(&point.l1, &slopes))
    }

    fn worst_miss(&self, point: &Point) -> f64 {
        let misses = self.targets.misses(&point.l1).unwrap_or_default();
        misses.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    fn reached(&self, point: &Point) -> bool {
        self.worst_miss(point) <= self.options.tolerance
    }

    /// A start: every second one anywhere in the bounds, the others near the best design. What is refused is drawn towards the best.
    fn drawn(&self, best: &Point, number: usize, random: &mut ChaCha8Rng) -> Option<Point> {
        let near = number % 2 == 1;
        let share = |x: &f64| match near {
            true => (x + NEAR * random.random_range(-1.0..1.0)).clamp(0.0, 1.0),
            false => random.random_range(0.0..1.0),
        };
        let drawn: Vec<f64> = best.shares.iter().map(share).collect();
        (0..DRAWS).find_map(|k| {
            let towards = |(b, x): (&f64, &f64)| b + (x - b) * 0.5f64.powi(k);
            self.solve(best.shares.iter().zip(&drawn).map(towards).collect()).ok()
        })
    }
}

/// How far from the best a start near it is drawn, as a share of each range.
const NEAR: f64 = 0.1;
/// How often a refused start is halved towards the best design.
const DRAWS: i32 = 5;
