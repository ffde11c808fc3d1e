//! The limit of one pull by the energy method (chapter 5): l1 is raised step by step, the elements reset each time,
//! until the target is missed by more than τ; then the last step is bisected.

use crate::{
    answer::Answer,
    error::InvalidInput,
    lattice::Direction,
    model::Model,
    record::{Status, StepRecord},
    relaxation::{
        Configuration, ContactOptions, HessianMethod, MinimaMethod, SheetEnergy,
        barrier::ContactLaw,
        flat::FLAT_CURVATURE,
        target::{Protocol, Target},
    },
    solver::{
        descent::steepest_descent,
        newton::{Minimization, NewtonOptions, Outcome, minimize},
        shifted::{Reading, shifted_newton},
    },
    state::State,
    topology::{self, separation::comes_apart, side_signs::SideSigns},
};
use nalgebra::Matrix2;
use serde::{Deserialize, Serialize};
use std::{sync::atomic::AtomicBool, time::Instant};

/// How the energy is minimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Minimiser {
    /// Newton's iteration with floored eigenvalues.
    #[default]
    Newton,
    /// Newton's iteration with growing shifts γ 1 of the Hessian (Algorithm 4.3.2), trials from the same point.
    NewtonShifted,
    /// Algorithm 4.3.2 to the letter: trials add up, γ is not reset.
    NewtonPrinted,
    /// Plain gradient descent, which the thesis rejects.
    GradientDescent,
}

/// Parameters of the energy method. Lengths are in units of the design's reference radius R, energies in β R².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyOptions {
    /// How a deformation is imposed and judged.
    pub protocol: Protocol,
    /// Weight of the contacts, α/β.
    pub alpha: f64,
    /// Weight of E_b, k_b/β (corner protocol).
    pub corner_weight: f64,
    /// Threshold τ: on |F − F_target| (strain protocol), or on a corner's distance in R (corner protocol).
    pub tau: f64,
    /// Step of l1.
    pub l1_step: f64,
    /// The bisection stops at this width of l1.
    pub l1_resolution: f64,
    /// Non-minimal points on each side of a contact (§4.1.2).
    pub samples: usize,
    /// Spacing of those points, radians; `None`: from the expected width of an overlap.
    pub sample_spacing_rad: Option<f64>,
    /// How the Hessian is found.
    pub hessian: HessianMethod,
    /// How minima are found.
    pub minima: MinimaMethod,
    /// Newton iterations of one run at most.
    pub max_iterations: usize,
    /// Seed of the kicks that end stalls.
    pub seed: u64,
    /// Keep every step of every run with its size and time.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub steps: bool,
    /// What an overlap costs.
    #[serde(default)]
    pub contact_law: ContactLaw,
    /// How the energy is minimised.
    #[serde(default)]
    pub minimiser: Minimiser,
    /// Refuse steps that flip a side sign (§4.3.3).
    #[serde(default)]
    pub side_signs: bool,
    /// |gradient| of a run that is at rest, in β R.
    #[serde(default = "gradient_tolerance")]
    pub gradient_tolerance: f64,
    /// Points on each circle of a pair that touches along nearly the whole circle; 0: minima alone, as in records of before.
    #[serde(default)]
    pub flat_points: usize,
}

fn gradient_tolerance() -> f64 {
    1e-6
}

impl Default for EnergyOptions {
    fn default() -> Self {
        EnergyOptions {
            protocol: Protocol::Strain,
            alpha: 1e5,
            corner_weight: 100.0,
            tau: 1e-4,
            l1_step: 0.05,
            l1_resolution: 5e-4,
            samples: 1,
            sample_spacing_rad: None,
            hessian: HessianMethod::Analytic,
            minima: MinimaMethod::Enumeration,
            max_iterations: 400,
            seed: 1,
            steps: false,
            contact_law: ContactLaw::Barrier,
            minimiser: Minimiser::Newton,
            side_signs: false,
            gradient_tolerance: gradient_tolerance(),
            flat_points: 64,
        }
    }
}

/// l1 is not raised beyond this.
const L1_MOST: f64 = 20.0;
/// l1 is not lowered beyond this.
const L1_LEAST: f64 = -0.95;
/// Floor of the curvature in Newton's step, in β.
const CURVATURE_FLOOR: f64 = 1e-3;
/// Negative curvature that makes a saddle, in β.
const SADDLE_TOLERANCE: f64 = 1e-5;
/// Random kicks in a run.
const MAX_KICKS: usize = 3;

/// The options with everything that follows from them or is fixed: what a record needs to repeat a run.
#[doc(hidden)]
#[derive(Clone, Debug, Serialize)]
pub struct EnergyParameters {
    #[serde(flatten)]
    options: EnergyOptions,
    sample_offsets_rad: Vec<f64>,
    flat_curvature: f64,
    curvature_floor: f64,
    saddle_tolerance: f64,
    max_kicks: usize,
    l1_least: f64,
    l1_most: f64,
}

impl EnergyOptions {
    /// As many points as can follow a flat pair's circle; 0 is allowed beside these.
    #[doc(hidden)]
    pub const FLAT_POINTS: std::ops::RangeInclusive<usize> = 16..=1024;

    /// Whether they can be used.
    ///
    /// # Errors
    /// For a length, weight or angle that is not positive, and a number of points out of range.
    pub(crate) fn check(&self) -> Result<(), InvalidInput> {
        let positive = [
            ("alpha", self.alpha),
            ("corner_weight", self.corner_weight),
            ("gradient_tolerance", self.gradient_tolerance),
            ("tau", self.tau),
            ("l1_step", self.l1_step),
            ("l1_resolution", self.l1_resolution),
            ("sample_spacing_rad", self.sample_spacing_rad.unwrap_or(1.0)),
        ];
        if let Some((name, x)) = positive.into_iter().find(|(_, x)| !(x.is_finite() && *x > 0.0)) {
            return Err(InvalidInput::new(name, format!("{name} = {x} is not positive"), "give a positive number"));
        }
        if self.flat_points != 0 && !Self::FLAT_POINTS.contains(&self.flat_points) {
            let problem = format!("flat_points = {} is out of range", self.flat_points);
            let (least, most) = (Self::FLAT_POINTS.start(), Self::FLAT_POINTS.end());
            return Err(InvalidInput::new(
                "flat_points",
                problem,
                format!("give 0, or a whole number from {least} to {most}"),
            ));
        }
        Ok(())
    }

    /// All parameters and tolerances of a run on `model`.
    #[doc(hidden)]
    pub fn parameters(&self, model: &Model) -> EnergyParameters {
        EnergyParameters {
            options: self.clone(),
            sample_offsets_rad: self.sample_offsets_rad(model),
            flat_curvature: FLAT_CURVATURE,
            curvature_floor: CURVATURE_FLOOR,
            saddle_tolerance: SADDLE_TOLERANCE,
            max_kicks: MAX_KICKS,
            l1_least: L1_LEAST,
            l1_most: L1_MOST,
        }
    }

    /// The contact energy on `model`.
    #[doc(hidden)]
    pub fn contacts(&self, model: &Model) -> ContactOptions {
        ContactOptions {
            law: self.contact_law,
            alpha: self.alpha,
            sample_offsets_rad: self.sample_offsets_rad(model),
            minima: self.minima,
            flat_points: self.flat_points,
        }
    }

    /// Tolerances of one minimisation.
    #[doc(hidden)]
    pub fn newton(&self) -> NewtonOptions {
        NewtonOptions {
            gradient_tolerance: self.gradient_tolerance,
            curvature_floor: CURVATURE_FLOOR,
            saddle_tolerance: SADDLE_TOLERANCE,
            max_iterations: self.max_iterations,
            max_kicks: MAX_KICKS,
        }
    }

    /// Offsets of the non-minimal points. The default spacing follows the overlap that balances the pull at the
    /// threshold: depth p = √(4 β τ r̂ / (3 α)), half width √(2 r̂ p) / R; the points divide the half width evenly.
    #[doc(hidden)]
    pub fn sample_offsets_rad(&self, model: &Model) -> Vec<f64> {
        let touching = 2.0 * model.rings.iter().map(|r| r.minor_radius).sum::<f64>() / model.rings.len() as f64;
        let depth = (4.0 * self.tau * touching / (3.0 * self.alpha)).sqrt();
        let half_width = (2.0 * touching * depth).sqrt() / model.largest_radius;
        let spacing = self.sample_spacing_rad.unwrap_or(half_width / (self.samples as f64 + 1.0));
        (1..=self.samples).flat_map(|k| [-(k as f64) * spacing, k as f64 * spacing]).collect()
    }
}

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
