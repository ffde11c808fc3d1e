//! Directions that no chain of links binds.
//!
//! A sheet whose cells are not linked along a pull mostly comes apart: it is pulled until a state is found from which l1 can grow
//! for ever, which proves that the limit is [`Status::Unbounded`]. But elements can hold each other without a link, a ring in a cage
//! of rings, say: then there is a limit as any other, only without a bound.

use super::{
    multistart::{CellStarts, Entered, Target},
    options::{UNLINKED_STAGE, UNLINKED_STAGES},
    starts::{Start, explored_with_own_wire},
    stretch::{ExactMethod, Stretch},
};
use crate::{
    answer::Answer,
    lattice::shifts_within,
    model::Model,
    program::SheetProgram,
    record::Status,
    solver::{
        certificate::GAP_TOLERANCE,
        sqp::{SqpOptions, maximize},
    },
    state::State,
    topology::{self, separation::comes_apart},
};
use maille_geometry::Vec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// A sheet that has come apart: a state and its parameters.
struct Separated {
    state: State,
    p: Vec<f64>,
}

impl ExactMethod<'_> {
    /// The limit of a stretch that no chain of links binds; with the state of one that is found.
    pub(super) fn unlinked(
        &self,
        stretch: &Stretch,
        neighbour: Option<Start>,
        cancel: &AtomicBool,
    ) -> (Answer, CellStarts) {
        let model = &self.models[0];
        if let Some(apart) = apart_as_written(model, stretch) {
            return (self.apart(stretch, apart, 0, 0), Vec::new());
        }
        let stop = self.stop();
        let drawn = (0..stop.least as usize).map(|k| explored_with_own_wire(model, self.options.seed, k));
        let (mut runs, mut iterations) = (0, 0);
        for start in neighbour.iter().cloned().chain(drawn) {
            let (apart, more) = pull_apart(model, stretch, start, cancel);
            (runs, iterations) = (runs + 1, iterations + more);
            if cancel.load(Ordering::Relaxed) {
                return (self.without_state(Status::Interrupted), Vec::new());
            }
            if let Some(apart) = apart {
                return (self.apart(stretch, apart, runs, iterations), Vec::new());
            }
        }
        let search = self.search(stretch, f64::INFINITY, cancel);
        let mut found = search.run(model, neighbour.into_iter().collect(), stop);
        if cancel.load(Ordering::Relaxed) {
            return (self.without_state(Status::Interrupted), Vec::new());
        }
        (found.runs, found.iterations) = (found.runs + runs, found.iterations + iterations);
        let reached = found.best.iter().map(|best| (model.cell, stretch.start(best))).collect();
        let wave = found.best.as_ref().and_then(|best| search.waves(&self.models[0], best).curvature());
        let answer = self.judge(&self.models[0], stretch, f64::INFINITY, found, cancel);
        if cancel.load(Ordering::Relaxed) {
            return (self.without_state(Status::Interrupted), Vec::new());
        }
        match answer.status {
            Status::Local => {
                let note = Some("held by contacts without a chain of links: there is no bound".into());
                (Answer { note, wave, ..answer }, reached)
            }
            // No limit, only where the search was stopped.
            Status::Uncertified if answer.contacts.is_empty() => {
                let note = Some("no chain of links, and no contact held it where the search was stopped".into());
                let Answer { runs, iterations, .. } = answer;
                (Answer { runs, iterations, note, ..self.without_state(Status::Uncertified) }, Vec::new())
            }
            _ => (answer, reached),
        }
    }

    /// What is said of a sheet that has come apart.
    fn apart(&self, stretch: &Stretch, apart: Separated, runs: u64, iterations: u64) -> Answer {
        let Separated { state, p } = apart;
        let gradient = stretch.lattices(&self.models[0]).gradient(&p, stretch.l2);
        let note = Some(format!("no chain of links; at l1 = {:.3} nothing is left that could hold it", p[0]));
        Answer { state, gradient, runs, iterations, note, ..self.without_state(Status::Unbounded) }
    }
}

/// The written state at the l2 that is held, where its cells are so far apart that nothing can hold them.
///
/// Each cell lies in a ball of radius ϱ about a point of its own. On the way to l2 and with any l1 ≥ 0 no vector of the lattice
/// becomes shorter than min(1, 1 + l2) of what it is; where this leaves the shortest one above 2 ϱ, no cell ever meets another.
fn apart_as_written(model: &Model, stretch: &Stretch) -> Option<Separated> {
    let start = &model.start;
    let thickest = model.rings.iter().map(|ring| ring.minor_radius).fold(0.0, f64::max);
    let middle = start.poses.iter().map(|pose| pose.position).sum::<Vec3>() / start.poses.len() as f64;
    let reaches = start.poses.iter().zip(&model.elements).map(|(pose, e)| (pose.position - middle).norm() + e.reach);
    let radius = reaches.fold(0.0, f64::max) + thickest;
    let near = 2.0 * radius / (1.0 + stretch.l2).min(1.0);
    let apart = shifts_within(&Vec3::zeros(), &start.a1, &start.a2, near).into_iter().all(|shift| shift == [0, 0]);
    // Elements that the lattice carries along move within their cell.
    let rigid = model.elements.iter().all(|element| element.anchor == [0.0; 2]);
    let touches = topology::smallest_gap(model, start).is_some_and(|(gap, _)| gap < 0.0);
    if !apart || !rigid || touches {
        return None;
    }
    let written = Start { l2: stretch.l2, ..Start::written(start.clone()) };
    let p = stretch.lattices(model).parameters(&written);
    let state = SheetProgram::new(model, &stretch.family(model)).posed(written.state, p.clone()).state;
    // What others can check: the state alone must show it.
    comes_apart(model, &state, stretch.direction).then_some(Separated { state, p })
}

/// Pulls in stages to a state from which the pull can go on for ever, if it gets there; with the quadratic programs that it took.
fn pull_apart(model: &Model, stretch: &Stretch, from: Start, cancel: &AtomicBool) -> (Option<Separated>, u64) {
    let Entered { at, mut iterations } = stretch.enter(model, from, cancel);
    let Some((state, p)) = at else { return (None, iterations) };
    let pull = stretch.family(model);
    let program = SheetProgram::new(model, &pull);
    let mut x = program.posed(state, p);
    let mut known = Vec::new();
    for stage in 0..UNLINKED_STAGES {
        let enough = x.p[0] + UNLINKED_STAGE * 2.0_f64.powi(stage);
        let end = maximize(&program, x, known, &SqpOptions { enough, ..SqpOptions::default() }, cancel);
        iterations += end.iterations as u64;
        if end.point.p[0] <= enough || end.violation > GAP_TOLERANCE {
            return (None, iterations);
        }
        (x, known) = (end.point, end.multipliers);
        if comes_apart(model, &x.state, stretch.direction) && topology::links_kept(model, &x.state) {
            return (Some(Separated { state: x.state, p: x.p }), iterations);
        }
    }
    (None, iterations)
}
