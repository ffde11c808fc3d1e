//! The best that one start leads to: maximise, polish, certify, and kick where no certificate holds.

use crate::{
    constraint::{
        Contact, Posed, SheetProgram,
        flat::{COAXIAL, SHIFTED},
    },
    model::Model,
    solve::{
        certificate::{Certificate, measure_curvature, measure_gaps},
        kkt::polish,
        rows::{Derivatives, Multiplier, violation},
        sqp::{Program, SqpOptions, maximize},
    },
    state::{Pose, State},
    topology::{
        self,
        crossing::{Motion, StepBound},
    },
};
use maille_geometry::Vec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rounds of maximising and polishing between kicks.
pub(super) const ROUNDS: usize = 10;
/// Size of the first kick, in reference radii and radians; the next ones are multiples.
const KICK: f64 = 0.003;

/// A solve from one start.
pub(super) struct Solve {
    pub(super) x: Posed,
    pub(super) certificate: Certificate,
    pub(super) contacts: Vec<Contact>,
    pub(super) links_ok: bool,
    pub(super) certified: bool,
}

/// What [`climb`] found.
pub(super) struct Climbed {
    /// The certified state, or the best feasible one.
    pub(super) best: Option<Solve>,
    /// Quadratic programs.
    pub(super) iterations: u64,
}

/// From a start to a certified state, with up to `kicks` kicks.
pub(super) fn climb(
    model: &Model,
    program: &mut SheetProgram<'_>,
    start: Posed,
    kicks: usize,
    rng: &mut ChaCha8Rng,
    cancel: &AtomicBool,
) -> Climbed {
    let mut climber = Climber { model, cancel, iterations: 0, last_resort: None };
    let (mut x, mut best): (Posed, Option<Solve>) = (start, None);
    for kick in 0..=kicks {
        if kick > 0 {
            let size = KICK * kick as f64;
            program.forget_released_pairs();
            x = program.posed(shaken_from(model, &x.state, size, rng), x.p.clone());
        }
        let (end, solve) = climber.round(program, x);
        if solve.certified {
            best = Some(solve);
            break;
        }
        x = end;
        let better = best.as_ref().is_none_or(|b| program.value(&solve.x) > program.value(&b.x));
        if better && feasible(program, &solve.x) {
            best = Some(solve);
        }
        if cancel.load(Ordering::Relaxed) {
            break;
        }
    }
    if best.as_ref().is_none_or(|best| !best.certified) {
        best = climber.last_resort.take().or(best);
    }
    Climbed { best, iterations: climber.iterations }
}

struct Climber<'a> {
    model: &'a Model,
    cancel: &'a AtomicBool,
    iterations: u64,
    /// Certified at the cost of a hair of the value, for want of better.
    last_resort: Option<Solve>,
}

impl Climber<'_> {
    /// Keeps a last resort that has the links of the start, measured by true gaps; its pairs must not be shifted, see `round`.
    fn keep(&mut self, program: &mut SheetProgram<'_>, found: Option<(Posed, Certificate)>) {
        let Some((x, mut certificate)) = found.filter(|_| self.last_resort.is_none()) else { return };
        if !program.shifted(&x, &certificate.multipliers, SHIFTED).is_empty() {
            return;
        }
        measure_gaps(program, &x, &mut certificate);
        measure_curvature(program, &x, &mut certificate);
        let links_ok = topology::links_kept(self.model, &x.state);
        if certificate.holds() && links_ok {
            let contacts = program.contacts(&x, &certificate.multipliers);
            self.last_resort = Some(Solve { x, certificate, contacts, links_ok, certified: true });
        }
    }

    /// Maximises and polishes in turns, until a certificate holds or nothing more is promised.
    fn round(&mut self, program: &mut SheetProgram<'_>, start: Posed) -> (Posed, Solve) {
        let mut x = start;
        let mut known: Vec<Multiplier> = Vec::new();
        let (mut pause_at, mut first_radius) = (0.1, 0.1);
        let mut last = None;
        for round in 0..ROUNDS {
            let options = SqpOptions { pause_at, first_radius, ..SqpOptions::default() };
            let end = maximize(program, x, known, &options, self.cancel);
            self.iterations += end.iterations as u64;
            let ((polished, mut certificate), last_resort) = polish(program, &end);
            self.keep(program, last_resort);
            let locked = certificate.holds();
            let mut carrying = certificate.multipliers.clone();
            let shifted = locked && program.release_flat_pairs(&polished, &mut carrying, SHIFTED);
            if !shifted {
                measure_gaps(program, &polished, &mut certificate);
            }
            let links_ok = topology::links_kept(self.model, &polished.state);
            let certified = !shifted && certificate.holds() && links_ok;
            let contacts = program.contacts(&polished, &certificate.multipliers);
            // Where heights of flat pairs lock what their gaps do not: on from there by gaps.
            let on = shifted || locked && !certified && program.release_flat_pairs(&polished, &mut carrying, COAXIAL);
            (x, known) = if on { (polished.clone(), carrying) } else { (end.point, end.multipliers) };
            last = Some(Solve { x: polished, certificate, contacts, links_ok, certified });
            if certified {
                break;
            }
            if on {
                (pause_at, first_radius) = (1e-2, 0.03);
                continue;
            }
            if end.settled && program.release_flat_pairs(&x, &mut known, COAXIAL) || program.take_flat_pairs(&x) {
                known.clear();
                (pause_at, first_radius) = (1e-2, 0.03);
                continue;
            }
            if end.settled && round > 0 {
                break;
            }
            pause_at *= 0.2;
            first_radius = (10.0 * pause_at).clamp(1e-3, 0.1);
        }
        let mut solve: Solve = last.unwrap_or_else(|| unreachable!("at least one round"));
        measure_curvature(program, &solve.x, &mut solve.certificate);
        (x, solve)
    }
}

fn feasible(program: &SheetProgram<'_>, x: &Posed) -> bool {
    violation(&program.rows(x, 0.0, Derivatives::None)) < 1e-9
}

/// `state` with its elements moved and turned by up to `size`, less where circles could meet.
pub(super) fn shaken_from(model: &Model, state: &State, size: f64, rng: &mut ChaCha8Rng) -> State {
    let mut vector = || Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
    let elements = state.poses.iter().map(|_| (vector(), vector())).collect();
    let motion = Motion { elements, lattice: [Vec3::zeros(); 2], carried: false };
    let fraction = StepBound::new(model, state).largest_fraction(model, &motion, f64::INFINITY);
    let moved = state
        .poses
        .iter()
        .zip(&motion.elements)
        .map(|(p, (shift, turn))| p.moved(&(shift * fraction), &(turn * fraction)));
    State { poses: moved.collect(), ..state.clone() }
}

/// Largest force between an element and its own image.
pub(super) fn own_image_force(model: &Model, contacts: &[Contact]) -> f64 {
    let element = |ring: usize| model.rings[ring].element;
    let own = contacts.iter().filter(|c| element(c.pair.ring_a) == element(c.pair.ring_b));
    own.map(|c| c.force).fold(0.0, f64::max)
}

/// A primitive cell's state repeated over the cell of `model`.
pub(super) fn tiled(model: &Model, state: &State) -> State {
    let copies = model.cell.cosets();
    let poses = copies.iter().flat_map(|&coset| {
        let shift = state.translation(coset);
        state.poses.iter().map(move |pose| Pose { position: pose.position + shift, ..*pose })
    });
    let [a1, a2] = model.cell.vectors(state.a1, state.a2);
    State { poses: poses.collect(), a1, a2 }
}
