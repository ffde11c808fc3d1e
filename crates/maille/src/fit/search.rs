//! One design of the family: solved for all targets, with its derivatives, or refused.

use super::{
    bounds::{Bounds, with_radii},
    family::{Family, FreeNumber},
    options::FitOptions,
    place,
    target::{Measure, Target, Targets},
};
use crate::{
    answer::Answer,
    lattice::Direction,
    model::{Link, Model},
    question::Question,
    record::Status,
    sensitivity::DesignVector,
    sheet::Sheet,
};
use maille_design::{Design, InvalidInput};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::{cell::Cell, sync::atomic::AtomicBool};

/// A design that was solved for all targets.
#[derive(Clone)]
pub(super) struct Point {
    /// Each number as a share of its range.
    pub shares: Vec<f64>,
    pub design: Design,
    pub measured: Measured,
    pub values: Vec<f64>,
    pub deviations: Vec<f64>,
    pub misses: Vec<f64>,
    /// Of the misses times their weights.
    pub cost: f64,
}

/// What the values of a design are.
#[derive(Clone)]
pub(super) enum Measured {
    /// Its limits.
    Limits { sheet: Sheet, answers: Vec<Answer> },
    /// The bounds of its limits, with their derivatives.
    Bounds(Vec<DesignVector>),
}

impl Point {
    /// The answers of limits.
    pub fn answers(&self) -> &[Answer] {
        match &self.measured {
            Measured::Limits { answers, .. } => answers,
            Measured::Bounds(_) => &[],
        }
    }

    pub fn worst_miss(&self) -> f64 {
        self.misses.iter().copied().map(f64::abs).fold(0.0, f64::max)
    }
}

/// The same with the derivatives of its deviations by the shares.
pub(super) struct Solved {
    pub point: Point,
    pub slopes: DMatrix<f64>,
}

/// Why a design was not taken.
pub(super) enum Refused {
    Design(InvalidInput),
    Limit(Target, Status),
    NoRatio(Target),
    Shape,
    Interrupted,
}

/// What all starts share.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub family: &'a Family<'a>,
    pub targets: &'a Targets,
    pub options: &'a FitOptions,
    /// Links of the given design.
    pub links: &'a [Link],
    /// The given design in its own cell.
    pub model: &'a Model,
    /// Where the elements are, if not where the family writes them: only for numbers that are all radii.
    pub place: Option<&'a Design>,
    /// A design near by: its states are the first starts.
    pub near: Option<&'a Point>,
    /// Which free number goes to which by each symmetry of the given design.
    pub symmetries: &'a [Vec<usize>],
    /// Whether bounds stand for limits.
    pub by_bounds: bool,
    pub solved: &'a Cell<usize>,
    pub cancel: &'a AtomicBool,
}

/// The first of the problems.
pub(super) fn head(problems: Vec<InvalidInput>) -> InvalidInput {
    let none = || InvalidInput::new("design", "cannot be used", "check it by itself");
    problems.into_iter().next().unwrap_or_else(none)
}

impl Refused {
    fn first(problems: Vec<InvalidInput>) -> Self {
        Refused::Design(head(problems))
    }

    /// The error where the given design itself cannot be used.
    pub fn of_the_given(self) -> InvalidInput {
        match self {
            Refused::Design(problem) => problem,
            Refused::Limit(target, status) => {
                let problem = format!("{} of the given design is {}", target.words(), status.name());
                InvalidInput::new("targets", problem, "begin with a design that has every limit that is wanted")
            }
            Refused::NoRatio(target) => {
                let problem = format!(
                    "{} of the given design is not known: its limit allows more than one width, or no stretch",
                    target.words()
                );
                let help = "leave it out; `maille characterize DESIGN --lateral free` tells the widths of each limit";
                InvalidInput::new("targets", problem, help)
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
    /// The same with the elements where `design` has them, where only radii are free.
    pub fn at<'b>(&'b self, design: &'b Design) -> Search<'b> {
        Search { place: self.family.of_radii().then_some(design), ..*self }
    }

    /// The same near a point.
    pub fn near<'b>(&'b self, point: &'b Point) -> Search<'b> {
        Search { near: Some(point), ..*self }
    }

    /// Numbers as shares of their ranges.
    pub fn shares(&self, values: &[f64]) -> Vec<f64> {
        self.family.numbers.iter().zip(values).map(|(n, x)| ((x - n.min) / (n.max - n.min)).clamp(0.0, 1.0)).collect()
    }

    pub fn values(&self, shares: &[f64]) -> Vec<f64> {
        let value = |(n, share): (&FreeNumber, &f64)| match *share {
            // The ends exactly.
            1.0 => n.max,
            share => n.min + share * (n.max - n.min),
        };
        self.family.numbers.iter().zip(shares).map(value).collect()
    }

    /// The design with these shares, measured for all targets.
    pub fn solve(&self, shares: Vec<f64>) -> Result<Point, Refused> {
        self.solved.set(self.solved.get() + 1);
        let design = self.design(&shares)?;
        let (values, measured) = if self.by_bounds { self.bounds(&design)? } else { self.limits(&design)? };
        let deviations = self.targets.deviations(&values).ok_or(Refused::Shape)?;
        let misses: Vec<f64> =
            self.targets.iter().zip(&deviations).map(|(target, deviation)| target.wanted.miss(*deviation)).collect();
        let weighted = self.targets.iter().zip(&misses).map(|(target, miss)| target.weight * miss);
        let cost = self.options.norm.of(&DVector::from_iterator(misses.len(), weighted));
        Ok(Point { shares, design, measured, values, deviations, misses, cost })
    }

    /// The design with these shares.
    pub fn design(&self, shares: &[f64]) -> Result<Design, Refused> {
        let made = (self.family.make)(&self.values(shares)).map_err(Refused::first)?;
        Ok(if let Some(place) = self.place { place::at(made, place) } else { made })
    }

    fn same_links(&self, model: &Model) -> Result<(), Refused> {
        if model.links == self.links {
            return Ok(());
        }
        let problem = "its rings are linked in another way than those of the given design";
        Err(Refused::Design(InvalidInput::new("design", problem, "give narrower bounds")))
    }

    fn limits(&self, design: &Design) -> Result<(Vec<f64>, Measured), Refused> {
        let sheet = Sheet::in_cells(design, self.options.cells.clone()).map_err(Refused::first)?;
        self.same_links(sheet.model())?;
        let questions: Vec<Question> = self.targets.iter().map(|target| self.question(target)).collect();
        let near = self.near.map_or(&[][..], Point::answers);
        let answer = |(k, question): (usize, &Question)| match near.get(k) {
            Some(near) => sheet.answer_near(question, near, self.cancel),
            None => sheet.answer_until(question, self.cancel),
        };
        let answers = questions.par_iter().enumerate().map(answer);
        let answers = answers.collect::<Result<Vec<_>, _>>().map_err(Refused::Design)?;
        let mut values = Vec::with_capacity(answers.len());
        for (answer, target) in answers.iter().zip(self.targets.iter()) {
            match (target.measure.value(answer), answer.status) {
                (Some(value), _) => values.push(value),
                (None, Status::Interrupted) => return Err(Refused::Interrupted),
                (None, _) if answer.is_limit() => return Err(Refused::NoRatio(*target)),
                (None, status) => return Err(Refused::Limit(*target, status)),
            }
        }
        Ok((values, Measured::Limits { sheet, answers }))
    }

    /// Bounds follow from links and radii: where the design's elements are written does not matter.
    fn bounds(&self, design: &Design) -> Result<(Vec<f64>, Measured), Refused> {
        let model = with_radii(self.model, design);
        let bounds = Bounds::new(&model);
        let of = |target: &Target| {
            let Measure::Stretch { direction_deg, l2 } = target.measure else {
                return Err(Refused::Limit(*target, Status::Unbounded));
            };
            let direction = Direction::of_degrees(direction_deg);
            let bound = bounds.by_links(direction, l2);
            let l1 = bound.l1().ok_or(Refused::Limit(*target, Status::L2Unreachable))?;
            Ok((l1, bounds.slopes(&bound, direction)))
        };
        let targets: Vec<Target> = self.targets.iter().copied().collect();
        let found = targets.par_iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let (values, slopes) = found.into_iter().unzip();
        Ok((values, Measured::Bounds(slopes)))
    }

    pub fn question(&self, target: &Target) -> Question {
        Question { effort: self.options.effort, seed: self.options.seed, ..target.question() }
    }

    pub fn reached(&self, point: &Point) -> bool {
        point.worst_miss() <= self.options.tolerance
    }
}
