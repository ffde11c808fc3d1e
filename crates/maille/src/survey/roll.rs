//! How tightly a sheet can be rolled along many directions, both ways, with its width held and left to it.
//!
//! Each limit is first found from its own starts. Then limits that are less than a neighbouring one are sought again from the neighbours'
//! states: those of the next directions, and with the width free that of the held width. A result does not depend on the number
//! of threads.

use crate::{
    answer::Answer,
    error::InvalidInput,
    lattice::{Across, Cell, Direction},
    model::{Model, of_cell},
    question::{Effort, Question, Sense},
    record::{StateRecord, Status},
    search::{
        ExtremeOptions,
        curl::{Curl, continued_roll, tightest_roll},
    },
    state::State,
    survey::{CellChoice, row::state_record},
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// Which rolls are asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RollQuestion {
    /// Directions that are rolled, in degrees.
    pub directions_deg: Vec<f64>,
    /// What is left to the sheet, each asked on its own.
    pub free: Vec<Across>,
    /// Cells.
    pub cells: CellChoice,
    /// How long a limit is searched.
    pub effort: Effort,
    /// So many starts in place of an effort.
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    pub seed: u64,
}

/// One roll, as a record has it. Lengths are in the design's unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RollLimit {
    /// Direction that is rolled.
    pub direction_deg: f64,
    /// `largest`: the axis lies below the sheet; `least`: above it.
    pub sense: Sense,
    /// What is left to the sheet.
    pub free: Across,
    /// How sure it is.
    pub status: Status,
    /// κ, the turn for each unit of the written length along the direction, where it is certified.
    pub curvature: Option<f64>,
    /// The same where it is not.
    pub curvature_uncertified: Option<f64>,
    /// Radius at which the sheet has its written length, 1/|κ|, in reference radii.
    pub bend_radius: Option<f64>,
    /// Mean distance of the elements from the axis, in reference radii.
    pub neutral_radius: Option<f64>,
    /// Length of the sheet at that distance, as a share of the written one.
    pub neutral_stretch: Option<f64>,
    /// Width along the axis − 1.
    pub l2: Option<f64>,
    /// γ, how far a line along the direction leans along the axis.
    pub shear: Option<f64>,
    /// The cell that was solved.
    pub cell: Cell,
    /// Smallest gap.
    pub min_gap: Option<f64>,
    /// Largest entry of c + Σ μ ∇g.
    pub dual_residual: Option<f64>,
    /// Largest |μ g|.
    pub complementarity: Option<f64>,
    /// Least multiplier.
    pub min_multiplier: Option<f64>,
    /// Least curvature of the Lagrangian.
    pub min_curvature: Option<f64>,
    /// Motions without curvature.
    pub zero_modes: Option<u64>,
    /// Whether the links are those of the design.
    pub links_ok: Option<bool>,
    /// Starts that were solved, but for those of neighbours.
    pub n_starts: u64,
    /// Distinct certified values among them.
    pub n_distinct: u64,
    /// Whether a neighbour's state led here.
    pub continued: bool,
    /// Quadratic programs.
    pub iterations: u64,
    /// Wall time.
    pub wall_s: f64,
    /// The state, with its contacts.
    pub state: StateRecord,
}

impl RollLimit {
    /// Whether two are of one question.
    pub fn same_question(&self, other: &RollLimit) -> bool {
        (self.direction_deg, self.sense, self.free) == (other.direction_deg, other.sense, other.free)
    }

    /// Whether it is certified.
    pub fn is_limit(&self) -> bool {
        self.curvature.is_some()
    }
}

impl RollQuestion {
    /// Whether it can be asked.
    ///
    /// # Errors
    /// Without directions, or with one that is no number.
    pub fn check(&self) -> Result<(), InvalidInput> {
        if self.directions_deg.is_empty() {
            return Err(InvalidInput::new("directions_deg", "there is none", "give at least one direction"));
        }
        self.cells.check()?;
        self.asked().into_iter().try_for_each(|limit| Question::curvature_along(limit.direction_deg, 1.0).check())
    }

    /// All limits that are asked for, without answers.
    pub fn asked(&self) -> Vec<RollLimit> {
        let of = |(free, sense, direction_deg)| RollLimit { direction_deg, sense, free, ..RollLimit::default() };
        let senses = [Sense::Largest, Sense::Least];
        let all = self.free.iter().flat_map(|free| {
            senses.into_iter().flat_map(move |sense| self.directions_deg.iter().map(move |d| (*free, sense, *d)))
        });
        all.map(of).collect()
    }

    fn options(&self) -> ExtremeOptions {
        ExtremeOptions { lattice_free: true, effort: self.effort, starts: self.starts, seed: self.seed }
    }
}

/// A value has to be larger by this share to take another's place.
const BETTER: f64 = 1e-7;
/// Rounds in which limits are sought again from their neighbours' states.
const ROUNDS: usize = 4;

fn curl(limit: &RollLimit) -> Curl {
    Curl { direction: Direction::of_degrees(limit.direction_deg), sign: limit.sense.sign(), free: limit.free }
}

/// A row of an answer, a state of `model`.
fn row(asked: &RollLimit, model: &Model, answer: &Answer, continued: bool, wall_s: f64) -> RollLimit {
    let (target, certificate) = (curl(asked), answer.certificate.as_ref());
    let (u, w) = (target.direction.along(), target.direction.across());
    let solved = answer.value.is_some();
    let strain = |a: nalgebra::Vector2<f64>, b: nalgebra::Vector2<f64>| solved.then(|| a.dot(&(answer.gradient * b)));
    let curvature = answer.value.map(|value| value / model.unit);
    let certified = matches!(answer.status, Status::Global | Status::Local);
    let neutral = answer.state.neutral_surface_of(model).filter(|_| solved);
    RollLimit {
        status: answer.status,
        curvature: curvature.filter(|_| certified),
        curvature_uncertified: curvature.filter(|_| !certified),
        bend_radius: answer.value.map(|value| 1.0 / value.abs()).filter(|radius| radius.is_finite()),
        neutral_radius: neutral.map(|neutral| neutral.radius),
        neutral_stretch: neutral.map(|neutral| neutral.stretch),
        l2: strain(w, w).map(|width| width - 1.0),
        shear: strain(w, u),
        cell: answer.cell,
        min_gap: answer.gap.map(|gap| gap * model.unit),
        dual_residual: certificate.map(|c| c.dual_residual),
        complementarity: certificate.map(|c| c.complementarity),
        min_multiplier: certificate.map(|c| c.min_multiplier).filter(|m| m.is_finite()),
        min_curvature: certificate.and_then(|c| c.min_curvature).filter(|c| c.is_finite()),
        zero_modes: certificate.map(|c| c.zero_modes as u64),
        links_ok: answer.links_ok,
        n_starts: answer.n_starts.unwrap_or(0),
        n_distinct: answer.n_distinct.unwrap_or(0),
        continued,
        iterations: answer.iterations,
        wall_s,
        state: state_record(asked.direction_deg, 0.0, model, answer),
        ..asked.clone()
    }
}

/// Answers what is asked and not `known`, and seeks again what a neighbour is better than. `found` gets every row as soon as it is
/// found; a later row of the same question takes its place. The rows come in the order of [`RollQuestion::asked`]; after `cancel` some may
/// be missing.
pub fn rolls(
    models: &[Model],
    question: &RollQuestion,
    known: &[RollLimit],
    cancel: &AtomicBool,
    found: &(dyn Fn(&RollLimit) + Sync),
) -> Vec<RollLimit> {
    let options = question.options();
    let solve = |asked: RollLimit| {
        if let Some(there) = known.iter().rev().find(|other| other.same_question(&asked)) {
            return Some(there.clone());
        }
        let begun = Instant::now();
        let answer = tightest_roll(models, curl(&asked), &options, &[], cancel);
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let limit = row(&asked, &of_cell(models, answer.cell), &answer, false, begun.elapsed().as_secs_f64());
        found(&limit);
        Some(limit)
    };
    let solved: Vec<Option<RollLimit>> = question.asked().into_par_iter().with_max_len(1).map(solve).collect();
    let mut limits: Vec<RollLimit> = solved.into_iter().flatten().collect();
    for _ in 0..ROUNDS {
        let again = |limit: &RollLimit| {
            let from = better_neighbours(models, &limits, limit);
            if from.is_empty() || cancel.load(Ordering::Relaxed) {
                return None;
            }
            let begun = Instant::now();
            let answer = continued_roll(models, curl(limit), &options, &from, cancel)?;
            let new = row(limit, &of_cell(models, answer.cell), &answer, true, begun.elapsed().as_secs_f64());
            let (n_starts, n_distinct) = (limit.n_starts, limit.n_distinct);
            let new = RollLimit { n_starts, n_distinct, iterations: limit.iterations + new.iterations, ..new };
            (new.is_limit() && value(&new) > value(limit) + BETTER * value(limit).abs()).then_some(new)
        };
        let improved: Vec<Option<RollLimit>> = limits.par_iter().with_max_len(1).map(again).collect();
        if improved.iter().all(Option::is_none) || cancel.load(Ordering::Relaxed) {
            break;
        }
        for (limit, new) in limits.iter_mut().zip(improved) {
            if let Some(new) = new {
                found(&new);
                *limit = new;
            }
        }
    }
    limits
}

/// |κ| of a certified limit with the sign that was asked for; less than any where there is none.
fn value(limit: &RollLimit) -> f64 {
    limit.curvature.map_or(f64::NEG_INFINITY, |curvature| limit.sense.sign() * curvature)
}

/// States of the neighbours that are better than `limit`: of the next direction on either side, and of what leaves less to the sheet.
fn better_neighbours(models: &[Model], all: &[RollLimit], limit: &RollLimit) -> Vec<(Cell, State)> {
    // A direction and its opposite are one.
    let turn = |other: &RollLimit| (other.direction_deg - limit.direction_deg).rem_euclid(180.0);
    let kin = || all.iter().filter(|other| other.sense == limit.sense);
    let beside = || kin().filter(|other| other.free == limit.free && turn(other) > 0.0);
    let next = beside().min_by(|a, b| turn(a).total_cmp(&turn(b)));
    let last = beside().max_by(|a, b| turn(a).total_cmp(&turn(b)));
    let held = kin().filter(|other| other.direction_deg == limit.direction_deg && other.free == Across::HELD);
    let held = held.filter(|_| limit.free != Across::HELD);
    let better = next.into_iter().chain(last).chain(held).filter(|other| value(other) > value(limit) + BETTER);
    let state = |other: &RollLimit| Some((other.cell, other.state.state(&of_cell(models, other.cell))?));
    better.filter_map(state).collect()
}
