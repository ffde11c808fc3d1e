//! Directions that no chain of links binds.
//!
//! A sheet whose cells are not linked along a pull mostly comes apart: it is pulled until a state is found from which l1 can grow
//! for ever, which proves that the limit is [`Status::Unbounded`]. But elements can hold each other without a link, a ring in a cage
//! of rings, say: then there is a limit as any other, only without a bound.

use super::{
    ExactFigures, LimitOutcome,
    exact::{ExactMethod, Search, Tally},
    pull::Strained,
};
use crate::{
    constraint::SheetProgram,
    model::Model,
    record::Status,
    solve::{
        certificate::GAP_TOLERANCE,
        sqp::{SqpOptions, maximize},
    },
    topology::{self, apart::comes_apart},
};
use std::sync::atomic::{AtomicBool, Ordering};

/// The first stage of a pull; each further one is twice as long.
const STAGE: f64 = 0.125;
/// Stages at most: l1 = 128.
const STAGES: i32 = 10;

impl ExactMethod<'_> {
    /// The limit of a pull that no chain of links binds; with the state of one that is found.
    pub(super) fn unlinked(
        &self,
        direction_deg: f64,
        l2: f64,
        neighbour: Option<Strained>,
        cancel: &AtomicBool,
    ) -> (LimitOutcome, Option<Strained>) {
        let across = self.options.across;
        let starts: Vec<Strained> = neighbour.into_iter().chain(self.fresh(0, 0..self.options.starts.max(1))).collect();
        let mut search = self.searching(0, direction_deg, l2, across, cancel);
        for start in starts.clone() {
            let apart = search.pull_apart(start, direction_deg);
            if cancel.load(Ordering::Relaxed) {
                return (self.nothing(Status::Interrupted, ExactFigures::default()), None);
            }
            if let Some(at) = apart {
                let gradient = search.family.gradient(&search.family.parameters(&at), l2);
                let (runs, iterations) = (search.runs, search.iterations);
                let note = Some(format!("no chain of links; at l1 = {:.3} nothing is left that could hold it", at.l1));
                let nothing = self.nothing(Status::Unbounded, ExactFigures::default());
                return (LimitOutcome { state: at.state, gradient, runs, iterations, note, ..nothing }, None);
            }
        }
        let (runs, iterations) = (search.runs, search.iterations);
        let unbounded = f64::INFINITY;
        let found = self.search(0, direction_deg, l2, starts, (unbounded, across), cancel);
        if cancel.load(Ordering::Relaxed) {
            return (self.nothing(Status::Interrupted, ExactFigures::default()), None);
        }
        let reached = found.best.as_ref().map(|best| Strained::at(best, 1.0, l2, across));
        let tally = Tally { runs: found.runs + runs, iterations: found.iterations + iterations, ..found };
        let (runs, iterations) = (tally.runs, tally.iterations);
        let mut outcome = self.judge(0, direction_deg, l2, unbounded, tally, ExactFigures::default(), cancel);
        match outcome.status {
            Status::Local => outcome.note = Some("held by contacts without a chain of links: there is no bound".into()),
            // No limit, only where the search was stopped.
            Status::Uncertified if outcome.exact.as_ref().is_none_or(|figures| figures.contacts.is_empty()) => {
                let note = Some("no chain of links, and no contact held it where the search was stopped".into());
                let nothing = self.nothing(Status::Uncertified, ExactFigures::default());
                return (LimitOutcome { runs, iterations, note, ..nothing }, None);
            }
            _ => {}
        }
        (outcome, reached)
    }
}

impl Search<'_> {
    /// Pulls in stages to a state from which the pull can go on for ever, if it gets there.
    fn pull_apart(&mut self, from: Strained, direction_deg: f64) -> Option<Strained> {
        self.runs += 1;
        let at = self.at_lateral(from)?;
        let model: &Model = self.model;
        let pull = self.family.pull(self.l2);
        let program = SheetProgram::new(model, &pull);
        let p = self.family.parameters(&at);
        let mut x = program.posed(at.state, p);
        let mut known = Vec::new();
        for stage in 0..STAGES {
            let enough = x.p[0] + STAGE * 2.0_f64.powi(stage);
            let end = maximize(&program, x, known, &SqpOptions { enough, ..SqpOptions::default() }, self.cancel);
            self.iterations += end.iterations as u64;
            if end.point.p[0] <= enough || end.violation > GAP_TOLERANCE {
                return None;
            }
            (x, known) = (end.point, end.multipliers);
            if comes_apart(model, &x.state, direction_deg) && topology::links_kept(model, &x.state) {
                let [l2, shear] = self.family.free_of(&x.p, self.l2);
                return Some(Strained { l1: x.p[0], l2, shear, state: x.state });
            }
        }
        None
    }
}
