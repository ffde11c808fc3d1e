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

/// Where a pull without a bound ended.
enum Pulled {
    /// From here it can go on for ever.
    Apart(Box<Strained>),
    /// Something holds it.
    Held,
    /// Neither, at this l1.
    Neither(f64),
}

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
        let (mut farthest, mut held) = (None, false);
        for start in starts.clone() {
            let pulled = search.pull_apart(start, direction_deg);
            if cancel.load(Ordering::Relaxed) {
                return (self.nothing(Status::Interrupted, ExactFigures::default()), None);
            }
            match pulled {
                None => {}
                Some(Pulled::Held) => held = true,
                Some(Pulled::Neither(l1)) => farthest = Some(farthest.unwrap_or(l1).max(l1)),
                Some(Pulled::Apart(at)) => {
                    let mut outcome = self.nothing(Status::Unbounded, ExactFigures::default());
                    let gradient = search.family.gradient(&search.family.parameters(&at), l2);
                    (outcome.runs, outcome.iterations) = (search.runs, search.iterations);
                    outcome.note =
                        Some(format!("no chain of links; at l1 = {:.3} nothing is left that could hold it", at.l1));
                    (outcome.state, outcome.gradient) = (at.state, gradient);
                    return (outcome, None);
                }
            }
        }
        let (runs, iterations) = (search.runs, search.iterations);
        if !held && let Some(l1) = farthest {
            let figures = ExactFigures { l1_uncertified: Some(l1), ..ExactFigures::default() };
            let note =
                Some(format!("no chain of links; pulled to l1 = {l1:.3}, where nothing holds it and it is not apart"));
            return (LimitOutcome { runs, iterations, note, ..self.nothing(Status::Uncertified, figures) }, None);
        }
        let unbounded = f64::INFINITY;
        let found = self.search(0, direction_deg, l2, starts, (unbounded, across), cancel);
        if cancel.load(Ordering::Relaxed) {
            return (self.nothing(Status::Interrupted, ExactFigures::default()), None);
        }
        let reached = found.best.as_ref().map(|best| Strained::at(best, 1.0, l2, across));
        let tally = Tally { runs: found.runs + runs, iterations: found.iterations + iterations, ..found };
        let mut outcome = self.judge(0, direction_deg, l2, unbounded, tally, ExactFigures::default(), cancel);
        if outcome.note.is_none() {
            outcome.note = Some("held by contacts without a chain of links: there is no bound".into());
        }
        (outcome, reached)
    }
}

impl Search<'_> {
    /// Pulls in stages until the sheet is apart or goes no further. `None` where l2 is not reached.
    fn pull_apart(&mut self, from: Strained, direction_deg: f64) -> Option<Pulled> {
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
                return Some(Pulled::Held);
            }
            (x, known) = (end.point, end.multipliers);
            if comes_apart(model, &x.state, direction_deg) && topology::links_kept(model, &x.state) {
                let [l2, shear] = self.family.free_of(&x.p, self.l2);
                return Some(Pulled::Apart(Box::new(Strained { l1: x.p[0], l2, shear, state: x.state })));
            }
        }
        Some(Pulled::Neither(x.p[0]))
    }
}
