//! The limit of one pull by the energy method (chapter 5): l1 is raised step by step, the elements reset each time,
//! until the target is missed by more than τ; then the last step is bisected.

pub use super::options::{EnergyOptions, EnergyParameters, Minimiser};
use crate::{
    answer::Answer,
    lattice::Direction,
    model::Model,
    record::{Status, StepRecord},
    relaxation::{
        Configuration, ContactOptions, SheetEnergy,
        options::{L1_LEAST, L1_MOST},
        target::Target,
    },
    solver::{
        descent::steepest_descent,
        newton::{Minimization, Outcome, minimize},
        shifted::{Reading, shifted_newton},
    },
    state::State,
    topology::{self, separation::comes_apart, side_signs::SideSigns},
};
use nalgebra::Matrix2;
use std::{sync::atomic::AtomicBool, time::Instant};

/// Searches limits of one model by the energy method.
pub struct EnergyMethod<'a> {
    model: &'a Model,
    options: EnergyOptions,
    contacts: ContactOptions,
    side_signs: Option<SideSigns>,
    start: State,
    start_note: Option<String>,
}

impl<'a> EnergyMethod<'a> {
    /// Prepares the start of every run: the design's state, or, where that overlaps, the state in which the contact
    /// energy has resolved the overlap with the lattice held by the target energy.
    pub fn new(model: &'a Model, options: EnergyOptions, cancel: &AtomicBool) -> Self {
        let contacts = options.contacts(model);
        let side_signs = options.side_signs.then(|| SideSigns::new(model));
        let start = model.start.clone();
        let mut method = EnergyMethod { model, options, contacts, side_signs, start, start_note: None };
        if topology::smallest_gap(model, &model.start).is_some_and(|(gap, _)| gap < 0.0) {
            let (run, _, _) = method.run(Matrix2::identity(), cancel, &mut |_, _, _| {});
            if run.outcome == Outcome::Minimum {
                method.start = run.point.state;
            } else {
                method.start_note = Some(format!(
                    "the overlap of the starting state was not resolved: {:?}, |gradient| {:.2e}",
                    run.outcome, run.gradient_norm
                ));
            }
        }
        method
    }

    /// One minimisation towards the deformation `target`, from the start; with the residual and the measured F.
    /// `watch` sees the steps, see [`minimize`].
    fn run(
        &self,
        target: Matrix2<f64>,
        cancel: &AtomicBool,
        watch: &mut dyn FnMut(&Configuration, f64, usize),
    ) -> (Minimization<Configuration>, f64, Matrix2<f64>) {
        let target = Target::new(self.model, self.options.protocol, target, 1.0, self.options.corner_weight);
        let energy = SheetEnergy {
            target: Some(&target),
            hessian: self.options.hessian,
            side_signs: self.side_signs.as_ref(),
            seed: self.options.seed,
            ..SheetEnergy::new(self.model, &self.contacts)
        };
        let (start, options) = (Configuration::start(self.start.clone()), self.options.newton());
        let end = match self.options.minimiser {
            Minimiser::Newton => minimize(&energy, start, &options, cancel, watch),
            Minimiser::NewtonShifted => shifted_newton(&energy, start, &options, Reading::Corrected, cancel),
            Minimiser::NewtonPrinted => shifted_newton(&energy, start, &options, Reading::Printed, cancel),
            Minimiser::GradientDescent => steepest_descent(&energy, start, &options, cancel),
        };
        let residual = target.residual(self.model, &end.point.state, &end.point.corner);
        let measured = target.measured(self.model, &end.point.state, &end.point.corner);
        (end, residual, measured)
    }

    /// The limit of l1 along a direction with l2 held.
    pub fn limit(&self, direction: Direction, l2: f64, cancel: &AtomicBool) -> Answer {
        let mut search =
            Search { method: self, direction, l2, cancel, iterations: 0, runs: 0, restless: 0, steps: Vec::new() };
        let along = direction.along();
        let linked = topology::binds(self.model, [along.x, along.y]);
        if let Some(note) = &self.start_note {
            return search.end(Status::InfeasibleStart, None, Some(note.clone()));
        }
        search.climb(linked)
    }
}

/// One run of a search, as far as the search needs it.
#[derive(Clone)]
struct Trial {
    l1: f64,
    state: State,
    gradient: Matrix2<f64>,
    residual: f64,
    outcome: Outcome,
    gradient_norm: f64,
}

struct Search<'a> {
    method: &'a EnergyMethod<'a>,
    direction: Direction,
    l2: f64,
    cancel: &'a AtomicBool,
    iterations: u64,
    runs: u64,
    /// Runs that did not come to rest.
    restless: u64,
    /// Of all runs, where they are kept.
    steps: Vec<StepRecord>,
}

/// The farthest that an element's reference point or a lattice vector is from one state to the other, in R.
fn farthest(from: &State, to: &State) -> f64 {
    let elements = from.poses.iter().zip(&to.poses).map(|(a, b)| (b.position - a.position).norm());
    let lattice = [(to.a1 - from.a1).norm(), (to.a2 - from.a2).norm()];
    elements.chain(lattice).fold(0.0, f64::max)
}

impl Search<'_> {
    fn trial(&mut self, l1: f64) -> Trial {
        let (kept, run) = (&mut self.steps, self.runs + 1);
        let mut before: Option<(State, Instant, usize)> = None;
        let mut watch = |x: &Configuration, energy: f64, perturbations: usize| {
            if let Some((state, begun, earlier)) = &before {
                let (size, wall_s) = (farthest(state, &x.state), begun.elapsed().as_secs_f64());
                kept.push(StepRecord { run, l1, energy, size, perturbed: perturbations > *earlier, wall_s });
            }
            before = Some((x.state.clone(), Instant::now(), perturbations));
        };
        let watch: &mut dyn FnMut(&Configuration, f64, usize) =
            if self.method.options.steps { &mut watch } else { &mut |_, _, _| {} };
        let target = self.direction.gradient(l1, self.l2, 0.0);
        let (end, residual, gradient) = self.method.run(target, self.cancel, watch);
        self.iterations += end.iterations as u64;
        self.runs += 1;
        self.restless += u64::from(end.outcome != Outcome::Minimum);
        Trial { l1, state: end.point.state, gradient, residual, outcome: end.outcome, gradient_norm: end.gradient_norm }
    }

    fn reached(&self, trial: &Trial) -> bool {
        trial.outcome == Outcome::Minimum && trial.residual <= self.method.options.tau
    }

    /// Steps up from 0 (or down, where 0 itself is missed), then bisects between the last target that was reached and
    /// the first that was missed. A pull that no chain of links binds is over where the sheet has come apart.
    fn climb(&mut self, linked: bool) -> Answer {
        let options = &self.method.options;
        let first = self.trial(0.0);
        let upward = self.reached(&first);
        let (mut low, mut high) = if upward { (Some(first), None) } else { (None, Some(first)) };
        let mut steps = 0;
        while low.is_none() || high.is_none() {
            if let Some(stopped) = high.as_ref().filter(|t| t.outcome == Outcome::Interrupted) {
                return self.end(Status::Interrupted, Some(stopped.clone()), None);
            }
            steps += 1;
            let l1 = f64::from(steps) * if upward { options.l1_step } else { -options.l1_step };
            if l1 > L1_MOST {
                return self.end(Status::NotConverged, low, Some(format!("still within τ at l1 = {L1_MOST}")));
            }
            if l1 < L1_LEAST && self.restless > 0 {
                let note = format!(
                    "no l1 down to −0.95 reaches its target at this l2, and {} of {} runs did not converge",
                    self.restless, self.runs
                );
                return self.end(Status::NotConverged, high, Some(note));
            }
            if l1 < L1_LEAST {
                let note = "no l1 down to −0.95 reaches its target at this l2; nothing is proved".to_string();
                return self.end(Status::L2NotReached, high, Some(note));
            }
            let trial = self.trial(l1);
            if self.reached(&trial) {
                let model = self.method.model;
                let whole = |state: &State| {
                    topology::links_kept(model, state)
                        && topology::smallest_gap(model, state).is_none_or(|(gap, _)| gap >= 0.0)
                };
                if !linked && comes_apart(model, &trial.state, self.direction) && whole(&trial.state) {
                    let note = format!("no chain of links; at l1 = {l1} nothing is left that could hold it");
                    return self.end(Status::Unbounded, Some(trial), Some(note));
                }
                low = Some(trial);
            } else {
                high = Some(trial);
            }
        }
        let (mut low, mut high) = match (low, high) {
            (Some(low), Some(high)) => (low, high),
            _ => unreachable!("the loop ends with both"),
        };
        while (high.l1 - low.l1) > options.l1_resolution && high.outcome != Outcome::Interrupted {
            let trial = self.trial(0.5 * (low.l1 + high.l1));
            if self.reached(&trial) {
                low = trial;
            } else {
                high = trial;
            }
        }
        match &high.outcome {
            Outcome::Interrupted => self.end(Status::Interrupted, Some(high), None),
            Outcome::Minimum => {
                if topology::links_kept(self.method.model, &low.state) {
                    self.end(Status::ThresholdReached, Some(low), None)
                } else {
                    self.end(
                        Status::NotConverged,
                        Some(low),
                        Some("the links of the starting state were not kept".into()),
                    )
                }
            }
            other => {
                let why = format!(
                    "the run towards l1 = {} decides the limit and did not converge ({other:?}, |gradient| {:.2e})",
                    high.l1, high.gradient_norm
                );
                self.end(Status::NotConverged, Some(high), Some(why))
            }
        }
    }

    fn end(&self, status: Status, trial: Option<Trial>, note: Option<String>) -> Answer {
        let (state, gradient, residual) = match trial {
            Some(t) => (t.state, t.gradient, Some(t.residual)),
            None => (self.method.start.clone(), Matrix2::identity(), None),
        };
        let (model, along) = (self.method.model, self.direction.along());
        let reached = status == Status::ThresholdReached;
        // Of a search that failed, the links of its last state.
        let judged = reached || matches!(status, Status::L2NotReached | Status::NotConverged);
        Answer {
            value: reached.then(|| along.dot(&(gradient * along)) - 1.0),
            gap: reached.then(|| topology::smallest_gap(model, &state)).flatten().map(|(gap, _)| gap),
            links_ok: judged.then(|| topology::links_kept(model, &state)),
            state,
            gradient,
            residual,
            iterations: self.iterations,
            runs: self.runs,
            note,
            steps: self.steps.clone(),
            ..Answer::new(model, status)
        }
    }
}
