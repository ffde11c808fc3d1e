//! Local maximisation from one start: maximise, polish, certify, and begin again from a perturbed state where no certificate
//! holds.

use super::{
    options::{
        FEASIBLE, HOPELESS_GAIN, HOPELESS_ROUNDS, RESTART_SIZE, ROUNDS, SLOW_GAIN, SLOW_ITERATIONS, STALLED_GAIN,
    },
    starts::perturbed,
};
use crate::{
    model::Model,
    program::{
        Contact, Posed, SheetProgram,
        flat::{COAXIAL, SHIFTED},
    },
    solver::{
        balance::balance,
        certificate::{Certificate, certify, measure_curvature, measure_gaps},
        constraints::{Derivatives, Multiplier, violation},
        polish::polish,
        sqp::{Program, SqpOptions, maximize},
    },
    state::State,
    topology,
};
use rand::rngs::ChaCha8Rng;
use std::{
    collections::BTreeSet,
    sync::atomic::{AtomicBool, Ordering},
};

/// What one start led to.
pub(super) struct LocalSolution {
    pub state: State,
    /// Parameters; the first is what was maximised.
    pub p: Vec<f64>,
    pub certificate: Certificate,
    /// Contacts that carry, force per unit of the first parameter.
    pub contacts: Vec<Contact>,
    pub links_ok: bool,
    /// Whether the certificate holds and the links are those of the start.
    pub certified: bool,
    /// Pairs that touch along nearly the whole circle, see [`crate::program::flat`].
    pub flat: BTreeSet<u64>,
}

impl LocalSolution {
    /// What was maximised.
    pub(crate) fn value(&self) -> f64 {
        self.p[0]
    }

    fn of(solve: Solve) -> Self {
        let Solve { x: Posed { state, p, .. }, certificate, contacts, links_ok, certified, flat } = solve;
        LocalSolution { state, p, certificate, contacts, links_ok, certified, flat }
    }
}

/// The end of a round.
struct Solve {
    x: Posed,
    certificate: Certificate,
    contacts: Vec<Contact>,
    links_ok: bool,
    certified: bool,
    flat: BTreeSet<u64>,
}

/// From a start to a certified state, or to the best feasible one; with the quadratic programs that it took. Where no certificate
/// holds, the search begins again from a perturbed state, up to `restarts` times.
pub(super) fn local_maximize(
    model: &Model,
    program: &mut SheetProgram<'_>,
    start: Posed,
    course: Course,
    rng: &mut ChaCha8Rng,
    cancel: &AtomicBool,
) -> (Option<LocalSolution>, u64) {
    let Course { restarts, first_radius, floor } = course;
    let mut rounds = Rounds { model, cancel, floor, iterations: 0, hopeless: false, last_resort: None };
    let (mut x, mut best): (Posed, Option<Solve>) = (start, None);
    for restart in 0..=restarts {
        if restart > 0 {
            let size = RESTART_SIZE * restart as f64;
            program.forget_released_pairs();
            x = program.posed(perturbed(model, &x.state, size, rng), x.p.clone());
        }
        let (end, solve) = rounds.round(program, x, first_radius);
        if solve.certified {
            best = Some(solve);
            break;
        }
        x = end;
        let better = best.as_ref().is_none_or(|b| program.value(&solve.x) > program.value(&b.x));
        if better && feasible(program, &solve.x) {
            best = Some(solve);
        }
        if rounds.hopeless || cancel.load(Ordering::Relaxed) {
            break;
        }
    }
    if best.as_ref().is_none_or(|best| !best.certified) {
        best = rounds.last_resort.take().or(best);
    }
    (best.map(LocalSolution::of), rounds.iterations)
}

/// How a local maximisation goes on from its start.
pub(super) struct Course {
    /// How often it begins again from a perturbed state where no certificate holds.
    pub restarts: usize,
    /// First half width of the trust box.
    pub first_radius: f64,
    /// The best certified value of earlier starts in its cell. In a larger cell a start that will stay below it is given up.
    pub floor: f64,
}

struct Rounds<'a> {
    model: &'a Model,
    cancel: &'a AtomicBool,
    floor: f64,
    /// Whether the start was given up.
    hopeless: bool,
    iterations: u64,
    /// Certified at a small cost in the value, if nothing better is found.
    last_resort: Option<Solve>,
}

impl Rounds<'_> {
    /// Keeps a last resort that has the links of the start, measured by true gaps; its pairs must not be shifted, see `round`.
    fn keep(&mut self, program: &mut SheetProgram<'_>, found: Option<(Posed, Certificate)>) {
        let Some((x, mut certificate)) = found.filter(|_| self.last_resort.is_none()) else { return };
        if !program.shifted(&x, &certificate.multipliers, SHIFTED).is_empty() {
            return;
        }
        measure_gaps(program, &x, &mut certificate);
        measure_curvature(program, &x, &mut certificate);
        let links_ok = topology::links_kept(self.model, &x.state);
        if certificate.holds() && links_ok && !program.is_outside(&x) {
            balance(program, &x, &mut certificate);
            let contacts = program.contacts(&x, &certificate.multipliers);
            let flat = program.flat_pairs().clone();
            self.last_resort = Some(Solve { x, certificate, contacts, links_ok, certified: true, flat });
        }
    }

    /// Maximises and polishes in turns, until a certificate holds or nothing more is promised.
    fn round(&mut self, program: &mut SheetProgram<'_>, start: Posed, first_radius: f64) -> (Posed, Solve) {
        let mut x = start;
        let mut known: Vec<Multiplier> = Vec::new();
        let (mut pause_at, mut first_radius) = (0.1, first_radius);
        let mut last = None;
        let larger = self.model.cell.copies() > 1;
        let mut gain = f64::INFINITY;
        for round in 0..ROUNDS {
            let mut options = SqpOptions { pause_at, first_radius, ..SqpOptions::default() };
            if larger && gain.abs() < SLOW_GAIN {
                options.max_iterations = SLOW_ITERATIONS;
            }
            let before = program.value(&x);
            let end = maximize(program, x, known, &options, self.cancel);
            self.iterations += end.iterations as u64;
            if self.cancel.load(Ordering::Relaxed) {
                // What was stopped on its way is no answer, and its polish can take seconds.
                let certificate = certify(program, &end.point, &end.multipliers);
                let (contacts, flat) = (Vec::new(), program.flat_pairs().clone());
                let (links_ok, certified) = (false, false);
                return (end.point.clone(), Solve { x: end.point, certificate, contacts, links_ok, certified, flat });
            }
            let used_up = larger && end.iterations >= options.max_iterations;
            gain = program.value(&end.point) - before;
            let stalled = used_up && gain < STALLED_GAIN;
            let ((mut polished, mut certificate), last_resort) = polish(program, &end);
            self.keep(program, last_resort);
            // A polish that goes astray ends with overlaps: then the state before it is kept, which has none.
            if !certificate.holds() && !feasible(program, &polished) && feasible(program, &end.point) {
                certificate = certify(program, &end.point, &end.multipliers);
                if certificate.holds_to_first_order() {
                    measure_curvature(program, &end.point, &mut certificate);
                }
                polished = end.point.clone();
            }
            let locked = certificate.holds();
            let mut carrying = certificate.multipliers.clone();
            let shifted = locked && program.release_flat_pairs(&polished, &mut carrying, SHIFTED);
            if !shifted {
                measure_gaps(program, &polished, &mut certificate);
            }
            let links_ok = topology::links_kept(self.model, &polished.state);
            let outside = end.outside || program.is_outside(&polished);
            let certified = !shifted && certificate.holds() && links_ok && !outside;
            let contacts = program.contacts(&polished, &certificate.multipliers);
            let flat = program.flat_pairs().clone();
            // Where heights of flat pairs lock what their gaps do not: on from there by gaps.
            let on = shifted || locked && !certified && program.release_flat_pairs(&polished, &mut carrying, COAXIAL);
            (x, known) = if on { (polished.clone(), carrying) } else { (end.point, end.multipliers) };
            last = Some(Solve { x: polished, certificate, contacts, links_ok, certified, flat });
            self.hopeless = outside;
            if certified || outside {
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
            let promised = HOPELESS_ROUNDS * gain.abs().max(HOPELESS_GAIN);
            self.hopeless = larger && round > 0 && program.value(&x) + promised < self.floor;
            if self.hopeless || stalled || end.settled && round > 0 {
                break;
            }
            pause_at *= 0.2;
            first_radius = (10.0 * pause_at).clamp(1e-3, 0.1);
        }
        let mut solve: Solve = last.unwrap_or_else(|| unreachable!("at least one round"));
        measure_curvature(program, &solve.x, &mut solve.certificate);
        if solve.certified {
            balance(program, &solve.x, &mut solve.certificate);
            solve.contacts = program.contacts(&solve.x, &solve.certificate.multipliers);
        }
        (x, solve)
    }
}

fn feasible(program: &SheetProgram<'_>, x: &Posed) -> bool {
    violation(&program.rows(x, 0.0, Derivatives::None)) < FEASIBLE
}
