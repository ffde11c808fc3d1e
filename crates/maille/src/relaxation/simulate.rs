//! Finite sheets under pulls and weight: a quasi-static run by the energy method, from the starting state to the last
//! position of the pulled edges that the sheet can follow.
//!
//! The same energy, Newton iteration and step bound as for the periodic cell. Pulled elements have targets (eq. 4.1.8)
//! that move on in equal steps; each step starts where the last one ended. Once a target is missed by more than τ, the
//! sheet has locked, and the last step is bisected.

pub mod force;

use crate::{
    model::Model,
    record::{FrameRecord, pose_records},
    relaxation::{
        Configuration, SheetEnergy,
        limit::EnergyOptions,
        load::{Bend, Drag, Floor, Loads, PositionTarget},
    },
    solver::newton::{Outcome, minimize},
    state::{Pose, State},
    topology,
};
use maille_design::InvalidInput;
use maille_geometry::Vec3;
use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeSet, VecDeque},
    sync::atomic::{AtomicBool, Ordering},
};

/// The elements that `place` names: those of an edge (left and right along a1, bottom and top along a2), an element of
/// one cell (`flat@0,1`), or its copies in all cells (`flat`).
#[doc(hidden)]
pub fn elements_at(model: &Model, place: &str) -> Result<Vec<usize>, InvalidInput> {
    let all = 0..model.elements.len();
    // An edge is where a coordinate along a lattice vector, or less it, is least.
    let (axis, sign) = match place {
        "left" => (0, 1.0),
        "right" => (0, -1.0),
        "top" => (1, -1.0),
        "bottom" => (1, 1.0),
        name => {
            let of = |e: &usize| {
                let full = &model.elements[*e].name;
                full == name || full.split_once('@').is_some_and(|(kind, _)| kind == name)
            };
            let found: Vec<usize> = all.filter(of).collect();
            if found.is_empty() {
                let kinds: BTreeSet<&str> =
                    model.elements.iter().map(|e| e.name.split_once('@').map_or(&*e.name, |(kind, _)| kind)).collect();
                let kinds: Vec<&str> = kinds.into_iter().collect();
                return Err(InvalidInput::new(
                    "place",
                    format!("\"{name}\" is neither an edge nor an element of the sheet"),
                    format!(
                        "give left, right, top or bottom, or an element: {}, or one copy, as {}",
                        kinds.join(", "),
                        model.elements[0].name
                    ),
                ));
            }
            return Ok(found);
        }
    };
    let inwards = |e: usize| sign * (model.reference_inverse * model.start.poses[e].position.xy())[axis];
    let least = all.clone().map(inwards).fold(f64::INFINITY, f64::min);
    Ok(all.filter(|e| inwards(*e) < least + 1e-6).collect())
}

/// What is done to a sheet. Lengths in units of the reference radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Elements whose reference point is held; they may turn.
    pub fix: Vec<usize>,
    /// Elements that are pulled, and their way: displacements from the start that they come to one after the other, each
    /// in an equal share of the pull.
    pub pull: Vec<(usize, Vec<Vec3>)>,
    /// Weight of each element, in [`WEIGHT_UNIT`]s.
    pub gravity: Vec3,
    /// Constant forces on single elements besides, in [`WEIGHT_UNIT`]s.
    pub forces: Vec<(usize, Vec3)>,
    /// Height of a floor.
    pub floor: Option<f64>,
    /// Curvatures along x and y of a surface to which all elements that are not held are drawn at the end of the pull, in 1/R: see [`Bend`].
    pub bend: Option<[f64; 2]>,
    /// Steps of the pull; with a drag, of the whole motion.
    pub steps: u32,
    /// With a drag the sheet does not come to rest: each step is one implicit step of overdamped motion. Under weight 1 a
    /// free element sinks by 1/drag in a step.
    pub drag: Option<f64>,
    /// Parameters of the energy method; those of its periodic cell play no part.
    pub options: EnergyOptions,
}

/// τ of a simulated sheet: how far a pulled element misses its place where the sheet locks. Larger than that of a limit, so
/// that forces at a lock stay small.
pub const TAU: f64 = 0.002;

/// A gravity or force of size 1 pulls an element with this force, in β R: so small that it makes little overlap.
pub const WEIGHT_UNIT: f64 = 1e-3;
/// Under weight, α of the first minimisations, as parts of the last one's.
const SOFTER: [f64; 5] = [1e-5, 1e-4, 1e-3, 1e-2, 0.1];
/// A sheet under weight is at rest where the forces that nothing balances are this part of all forces, both as norms over
/// the elements.
const UNBALANCED: f64 = 1e-4;
/// Halvings of the step in which a sheet locks.
const HALVINGS: usize = 8;
/// They go on until the last place of a pull that was reached and the first one that was missed are this part of τ apart: of the
/// element that locks, the force at the stop is then at least 1 − this of the largest, whatever the steps.
const FINEST: f64 = 0.25;
/// Halvings at most: more are below rounding.
const MOST_HALVINGS: usize = 50;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The whole pull was done; without a pull: the sheet is at rest.
    Reached,
    /// The sheet locked before.
    Locked,
    /// A minimisation did not converge.
    NotConverged,
    /// The caller asked to stop.
    Interrupted,
}

/// A state that the minimisation accepted.
pub struct Accepted<'a> {
    /// Minimisation, counted from 0.
    pub run: u32,
    /// State of this minimisation, counted from 0.
    pub state_of_run: u32,
    /// Share of the pull that it aims at.
    pub share: f64,
    /// Energy, in β R².
    pub energy: f64,
    /// The state.
    pub state: &'a State,
}

/// What a step came to, be it reached or not: a run goes on from those of an earlier one, to the same end bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Share of the pull that it aims at.
    pub share: f64,
    /// Minimisations up to its end.
    pub runs: u32,
    /// Their Newton iterations.
    pub iterations: usize,
    /// Their random kicks.
    pub kicks: usize,
    /// Energy at its end, in β R².
    pub energy: f64,
    /// How it ended; `None` for a minimum.
    pub failed: Option<Failed>,
    /// Norm of the last gradient.
    pub gradient_norm: f64,
    /// Largest distance of a pulled element from its target, in R.
    pub miss: f64,
    /// Position, in R, and unit quaternion w, x, y, z of each element.
    pub poses: Vec<[f64; 7]>,
}

/// Why a step is no minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Failed {
    /// Too many iterations.
    NotConverged,
    /// No decrease was found.
    Stalled,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// How it ended.
    pub end: End,
    /// Largest share of the pull that was reached.
    pub share: f64,
    /// The state there; of a run that failed at once, its last.
    pub state: State,
    /// Energy there.
    pub energy: f64,
    /// Newton iterations of all runs.
    pub iterations: usize,
    /// Random kicks of all runs.
    pub kicks: usize,
    /// Steps against the drag that ended without a balance of forces: where the energy jumps, or the iterations were done.
    pub unbalanced: usize,
    /// The states that were reached, one for each position of the pull, the state before it first.
    pub path: Vec<FrameRecord>,
    /// The states of `path`.
    pub rests: Vec<State>,
    /// Whether the links are those of the start.
    pub links_ok: bool,
    /// Smallest gap of the state, where rings are near each other.
    pub smallest_gap: Option<f64>,
    /// What happened, where `end` does not say it.
    pub note: Option<String>,
}

struct Run<'a> {
    model: &'a Model,
    setup: &'a Setup,
    cancel: &'a AtomicBool,
    watch: &'a mut dyn FnMut(&Accepted<'_>),
    keep: &'a mut dyn FnMut(&Step),
    known: VecDeque<Step>,
    /// Whether all steps so far are kept.
    keeps: bool,
    runs: u32,
    iterations: usize,
    kicks: usize,
    unbalanced: usize,
    path: Vec<FrameRecord>,
    rests: Vec<State>,
}

/// The end of one minimisation.
struct Rest {
    state: State,
    energy: f64,
    outcome: Outcome,
    gradient_norm: f64,
    /// Largest distance of a pulled element from its target.
    miss: f64,
}

/// The displacement when `share` of the way is done: from 0 to its points in turn, each in an equal share.
#[doc(hidden)]
pub fn along(way: &[Vec3], share: f64) -> Vec3 {
    let done = share * way.len() as f64;
    let leg = (done.floor() as usize).min(way.len().saturating_sub(1));
    let from = if leg == 0 { Vec3::zeros() } else { way[leg - 1] };
    way.get(leg).map_or(from, |to| from.lerp(to, done - leg as f64))
}

impl Setup {
    /// Whether no constant force acts.
    fn is_weightless(&self) -> bool {
        self.gravity == Vec3::zeros() && self.forces.is_empty()
    }

    /// The loads when `share` of the pull is done.
    fn loads(&self, model: &Model, share: f64, alpha: f64) -> Loads {
        let weights = (0..model.elements.len()).map(|e| (e, self.gravity));
        let forces: Vec<(usize, Vec3)> = weights
            .chain(self.forces.iter().copied())
            .filter(|(_, force)| *force != Vec3::zeros())
            .map(|(e, force)| (e, force * WEIGHT_UNIT))
            .collect();
        // Targets so stiff that all forces together cost them half of the threshold.
        let all: f64 = forces.iter().map(|(_, force)| force.norm()).sum();
        let all =
            all + self.drag.map_or(0.0, |drag| drag * WEIGHT_UNIT * self.longest_step() * model.elements.len() as f64);
        let stiffness = all / (self.options.tau * self.pull.len().max(1) as f64);
        let target = |(element, way): &(usize, Vec<Vec3>)| PositionTarget {
            element: *element,
            position: model.start.poses[*element].position + along(way, share),
            weight: stiffness.max(1.0),
        };
        Loads {
            forces,
            targets: self.pull.iter().map(target).collect(),
            held: self.fix.clone(),
            floor: self.floor.map(|height| Floor { height, alpha }),
            drag: None,
            bend: self.bend.map(|curvature| self.bent(model, curvature.map(|k| k * share), stiffness.max(1.0))),
        }
    }

    /// The surface with these curvatures through the middle of the sheet.
    fn bent(&self, model: &Model, curvature: [f64; 2], weight: f64) -> Bend {
        let places = || model.start.poses.iter().map(|pose| pose.position);
        let middle = [0, 1].map(|axis| places().map(|x| x[axis]).sum::<f64>() / model.elements.len() as f64);
        let free = |e: &usize| !self.fix.contains(e) && !self.pull.iter().any(|(pulled, _)| pulled == e);
        let heights = places().map(|x| x.z).enumerate().filter(|(e, _)| free(e)).collect();
        Bend { curvature, middle, heights, weight }
    }

    /// The longest way of a pulled element in one step.
    fn longest_step(&self) -> f64 {
        let legs = |way: &Vec<Vec3>| {
            let from = std::iter::once(Vec3::zeros()).chain(way.iter().copied());
            from.zip(way).map(|(from, to)| (to - from).norm()).fold(0.0, f64::max) * way.len() as f64
        };
        self.pull.iter().map(|(_, way)| legs(way)).fold(0.0, f64::max) / f64::from(self.steps.max(1))
    }

    fn check(&self, model: &Model) -> Result<(), InvalidInput> {
        let mut seen = BTreeSet::new();
        for e in self.fix.iter().chain(self.pull.iter().map(|p| &p.0)) {
            if !seen.insert(e) {
                return Err(InvalidInput::new(
                    "pull",
                    format!("\"{}\" is fixed or pulled twice", model.elements[*e].name),
                    "an element at a corner belongs to two edges: name edges that share none",
                ));
            }
        }
        let field = if self.gravity == Vec3::zeros() { "force" } else { "gravity" };
        self.loads(model, 1.0, self.options.alpha).check(model).map_err(|problem| match problem.field.as_str() {
            "gravity" => InvalidInput { field: field.into(), ..problem },
            _ => problem,
        })
    }
}

impl Run<'_> {
    /// Comes to rest, or makes a step against the drag. A weight is small against α, so that elements would bounce along stiff walls for long: with soft
    /// contacts first they do not. The softest ones are for the fall, before the pull.
    fn relax(&mut self, share: f64, from: &State) -> Rest {
        let rest = match self.known.pop_front().filter(|step| step.share == share) {
            Some(step) => self.again(&step),
            None => {
                self.known.clear();
                self.anew(share, from)
            }
        };
        if self.reached(&rest) {
            self.unbalanced += usize::from(rest.outcome != Outcome::Minimum);
            let poses = pose_records(self.model, &rest.state);
            self.path.push(FrameRecord { run: self.runs - 1, share, energy: rest.energy, poses });
            self.rests.push(rest.state.clone());
        }
        rest
    }

    /// The end of a step of an earlier run.
    fn again(&mut self, step: &Step) -> Rest {
        (self.runs, self.iterations, self.kicks) = (step.runs, step.iterations, step.kicks);
        Rest {
            state: State { poses: step.poses.iter().map(pose).collect(), ..self.model.start.clone() },
            energy: step.energy,
            outcome: match step.failed {
                None => Outcome::Minimum,
                Some(Failed::NotConverged) => Outcome::NotConverged,
                Some(Failed::Stalled) => Outcome::Stalled,
            },
            gradient_norm: step.gradient_norm,
            miss: step.miss,
        }
    }

    fn anew(&mut self, share: f64, from: &State) -> Rest {
        let comes_to_rest_slowly = self.setup.drag.is_none() && !self.setup.is_weightless();
        let softer = match (comes_to_rest_slowly, self.runs) {
            (false, _) => &[],
            (true, 0) => &SOFTER[..],
            (true, _) => &SOFTER[2..],
        };
        let mut from = from.clone();
        for softness in softer {
            from = self.minimise(share, &from, *softness).state;
        }
        let rest = self.minimise(share, &from, 1.0);
        // A run goes on from the first step that is not kept.
        match self.step(share, &rest).filter(|_| self.keeps) {
            Some(step) => (self.keep)(&step),
            None => self.keeps = false,
        }
        rest
    }

    /// A step to keep: none that was stopped on its way, or has numbers that are none.
    fn step(&self, share: f64, rest: &Rest) -> Option<Step> {
        let failed = match rest.outcome {
            Outcome::Minimum => None,
            Outcome::NotConverged => Some(Failed::NotConverged),
            Outcome::Stalled => Some(Failed::Stalled),
            Outcome::Interrupted | Outcome::Eigen(_) => return None,
        };
        let &Rest { energy, gradient_norm, miss, .. } = rest;
        let &Run { runs, iterations, kicks, .. } = self;
        let whole = [energy, gradient_norm, miss].iter().all(|x| x.is_finite()) && !self.cancel.load(Ordering::Relaxed);
        let poses = rest.state.poses.iter().map(numbers).collect();
        whole.then_some(Step { share, runs, iterations, kicks, energy, failed, gradient_norm, miss, poses })
    }

    /// Minimises with the part `softness` of α.
    fn minimise(&mut self, share: f64, from: &State, softness: f64) -> Rest {
        let Run { model, setup, runs, .. } = *self;
        let alpha = softness * setup.options.alpha;
        let contacts = EnergyOptions { alpha, ..setup.options.clone() }.contacts(model);
        let mut loads = setup.loads(model, share, alpha);
        loads.drag = setup.drag.map(|drag| Drag { from: from.poses.clone(), coefficient: drag * WEIGHT_UNIT });
        let energy = SheetEnergy { loads, seed: setup.options.seed, ..SheetEnergy::new(model, &contacts) };
        let start = Configuration::start(from.clone());
        let mut state_of_run = 0;
        let mut see = |x: &Configuration, energy: f64, _: usize| {
            (self.watch)(&Accepted { run: runs, state_of_run, share, energy, state: &x.state });
            state_of_run += 1;
        };
        let mut options = setup.options.newton();
        let forces = energy.loads.forces.iter().map(|(_, force)| force.norm_squared()).sum::<f64>().sqrt();
        options.gradient_tolerance = (UNBALANCED * forces).max(options.gradient_tolerance);
        let end = minimize(&energy, start, &options, self.cancel, &mut see);
        self.runs += 1;
        self.iterations += end.iterations;
        self.kicks += end.kicks;
        let state = end.point.state;
        let far = |t: &PositionTarget| (state.poses[t.element].position - t.position).norm();
        let above = energy.loads.bend.as_ref().map_or(0.0, |bend| bend.miss(&state));
        let miss = energy.loads.targets.iter().map(far).fold(above, f64::max);
        Rest { state, energy: end.energy, outcome: end.outcome, gradient_norm: end.gradient_norm, miss }
    }

    /// Whether `rest` is the end of a step. Motion goes on without a balance of forces: the next step makes up for it.
    fn reached(&self, rest: &Rest) -> bool {
        let ended = match rest.outcome {
            Outcome::Minimum => true,
            Outcome::Stalled | Outcome::NotConverged => self.setup.drag.is_some(),
            Outcome::Interrupted | Outcome::Eigen(_) => false,
        };
        ended && rest.miss <= self.setup.options.tau
    }

    fn end(&self, end: End, share: f64, rest: &Rest, note: Option<String>) -> Simulation {
        let (model, state) = (self.model, rest.state.clone());
        Simulation {
            end,
            share,
            energy: rest.energy,
            iterations: self.iterations,
            kicks: self.kicks,
            unbalanced: self.unbalanced,
            path: self.path.clone(),
            rests: self.rests.clone(),
            links_ok: topology::links_kept(model, &state),
            smallest_gap: topology::smallest_gap(model, &state).map(|(gap, _)| gap),
            state,
            note,
        }
    }
}

fn numbers(pose: &Pose) -> [f64; 7] {
    let (x, turn) = (pose.position, pose.rotation.quaternion());
    [x.x, x.y, x.z, turn.w, turn.i, turn.j, turn.k]
}

fn pose(&[x, y, z, w, i, j, k]: &[f64; 7]) -> Pose {
    Pose { position: Vec3::new(x, y, z), rotation: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)) }
}

/// Lets the finite sheet `model` come to rest, then pulls it; with a drag, moves it step by step. `watch` sees every accepted state.
pub fn simulate(
    model: &Model,
    setup: &Setup,
    cancel: &AtomicBool,
    watch: &mut dyn FnMut(&Accepted<'_>),
) -> Result<Simulation, InvalidInput> {
    simulate_from(model, setup, Vec::new(), cancel, watch, &mut |_| {})
}

/// The same, going on from the steps of an earlier run of this model and setup, which are `known` in their order; `keep` is given each
/// one that is new.
pub fn simulate_from(
    model: &Model,
    setup: &Setup,
    known: Vec<Step>,
    cancel: &AtomicBool,
    watch: &mut dyn FnMut(&Accepted<'_>),
    keep: &mut dyn FnMut(&Step),
) -> Result<Simulation, InvalidInput> {
    setup.check(model)?;
    let (path, rests, known) = (Vec::new(), Vec::new(), known.into());
    let mut run = Run {
        model,
        setup,
        cancel,
        watch,
        keep,
        known,
        keeps: true,
        runs: 0,
        iterations: 0,
        kicks: 0,
        unbalanced: 0,
        path,
        rests,
    };
    let (mut share, mut rest) = (0.0, run.relax(0.0, &model.start));
    // The last position that was reached, then the first one that was missed.
    let moves = !setup.pull.is_empty() || setup.drag.is_some() || setup.bend.is_some();
    let steps = if moves { setup.steps.max(1) } else { 0 };
    let mut missed = (!run.reached(&rest)).then_some(0.0);
    let mut step = 0;
    let mut failed = None;
    while missed.is_none() && step < steps {
        step += 1;
        let next = f64::from(step) / f64::from(steps);
        let trial = run.relax(next, &rest.state);
        match run.reached(&trial) {
            true => (share, rest) = (next, trial),
            false => (missed, failed) = (Some(next), Some(trial)),
        }
    }
    let Some(mut missed) = missed else { return Ok(run.end(End::Reached, share, &rest, None)) };
    // How far the surface moves where it is farthest from the middle.
    let sag = setup.bend.map_or(0.0, |curvature| setup.bent(model, curvature, 1.0).miss(&model.start));
    let way = (setup.longest_step() * f64::from(setup.steps.max(1))).max(sag);
    for halving in 0..MOST_HALVINGS {
        let locks = failed.as_ref().is_some_and(|trial| trial.outcome == Outcome::Minimum);
        let fine = !locks || (missed - share) * way <= FINEST * setup.options.tau;
        if missed == 0.0 || cancel.load(Ordering::Relaxed) || halving >= HALVINGS && fine {
            break;
        }
        let middle = 0.5 * (share + missed);
        let trial = run.relax(middle, &rest.state);
        match run.reached(&trial) {
            true => (share, rest) = (middle, trial),
            false => (missed, failed) = (middle, Some(trial)),
        }
    }
    let deciding = failed.as_ref().unwrap_or(&rest);
    let (end, note) = match &deciding.outcome {
        Outcome::Minimum => (End::Locked, None),
        Outcome::Interrupted => (End::Interrupted, None),
        other => {
            let why = format!("{other:?}, |gradient| {:.2e}", deciding.gradient_norm);
            (End::NotConverged, Some(format!("the run towards {missed:.4} of the pull did not converge: {why}")))
        }
    };
    Ok(run.end(end, share, &rest, note))
}
