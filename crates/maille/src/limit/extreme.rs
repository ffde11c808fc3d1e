//! Extremes of a weave that are no pulls: the thickest wire with which it exists, and the state with the most room.
//!
//! The program of a limit with another parameter p in place of l1. All rings must keep the core distance
//!
//! - thickest wire: (1 + p)(r_a + r_b), so that the minor radii (1 + p) r are as large as can be;
//! - widest gap: r_a + r_b + p, so that the smallest gap p is as large as can be.
//!
//! Over all poses, and over the lattice where it is free: a1 along its direction, a2 in the plane (a common turn changes
//! nothing). Links are kept as in a limit, and the certificate is the same. No bound is known that proves such a state
//! the best of all, so the most that is claimed is `local`, with the number of starts and of distinct values they led to.

use super::climb::{Climbed, Solve, climb, shaken_from};
use crate::{
    constraint::{Contact, Parameter, Pull, SheetProgram},
    design::Design,
    model::Model,
    record::Status,
    solve::certificate::Certificate,
    state::State,
    topology,
};
use maille_geometry::Vec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is as large as can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// All minor radii, in the proportions of the design.
    ThickestWire,
    /// The smallest gap between the tori of two rings.
    WidestGap,
}

/// How the search goes.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtremeOptions {
    /// Whether the lattice may change.
    pub lattice_free: bool,
    /// Starts: the design's state, then shaken ones.
    pub starts: usize,
    /// Seed of the shaking.
    pub seed: u64,
}

impl Default for ExtremeOptions {
    fn default() -> Self {
        ExtremeOptions { lattice_free: true, starts: 8, seed: 1 }
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct ExtremeOutcome {
    /// What was sought.
    pub what: Extreme,
    /// `local` with a complete certificate, else `uncertified`; `not-converged` where no start led to a feasible state.
    pub status: Status,
    /// Thickest wire: factor of the minor radii. Widest gap: the gap, in reference radii. `None` without a feasible state.
    pub value: Option<f64>,
    /// The state; the design's where there is none.
    pub state: State,
    /// Its certificate.
    pub certificate: Option<Certificate>,
    /// Its loaded contacts, force per unit of p.
    pub contacts: Vec<Contact>,
    /// Whether the links are those of the design.
    pub links_ok: bool,
    /// Starts that were solved.
    pub n_starts: u64,
    /// Distinct certified values among them, apart by more than 1e-7.
    pub n_distinct: u64,
    /// Quadratic programs.
    pub iterations: u64,
}

/// A ring's size in the design's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// R.
    pub major_radius: f64,
    /// r.
    pub minor_radius: f64,
}

impl Size {
    /// Makers' aspect ratio: inner diameter / wire diameter.
    pub fn aspect_ratio(&self) -> f64 {
        (self.major_radius - self.minor_radius) / self.minor_radius
    }
}

/// A saved design is thinner by this share: what its rounding could make overlap.
const SPARED: f64 = 1e-9;

impl ExtremeOutcome {
    /// Different sizes of rings with the wire that was found; NaN where none was.
    pub fn sizes(&self, model: &Model) -> Vec<Size> {
        let factor = if self.what == Extreme::ThickestWire { self.value.unwrap_or(f64::NAN) } else { 1.0 };
        let mut out: Vec<Size> = Vec::new();
        for ring in &model.rings {
            let [major_radius, minor_radius] = [ring.major_radius, ring.minor_radius * factor].map(|x| x * model.unit);
            if !out.iter().any(|s| (s.major_radius, s.minor_radius) == (major_radius, minor_radius)) {
                out.push(Size { major_radius, minor_radius });
            }
        }
        out
    }

    /// The widest gap, in the design's unit; `None` where the wire was sought.
    pub fn gap(&self, model: &Model) -> Option<f64> {
        self.value.filter(|_| self.what == Extreme::WidestGap).map(|gap| gap * model.unit)
    }

    /// The state as a design.
    pub fn design(&self, design: &Design, model: &Model) -> Design {
        let mut out = self.state.design(design, model);
        let (words, factor) = match self.what {
            Extreme::ThickestWire => ("tightest", self.value.unwrap_or(1.0) * (1.0 - SPARED)),
            Extreme::WidestGap => ("roomiest", 1.0),
        };
        out.name = format!("{} {words}", out.name);
        out.minor_radius = out.minor_radius.map(|r| r * factor);
        let rings = out.elements.iter_mut().flat_map(|element| &mut element.rings);
        rings.for_each(|ring| ring.minor_radius = ring.minor_radius.map(|r| r * factor));
        out
    }
}

/// What one start led to.
struct Found {
    best: Option<Best>,
    iterations: u64,
}

/// A [`Solve`] that threads can hand over.
struct Best {
    value: f64,
    state: State,
    certificate: Certificate,
    contacts: Vec<Contact>,
    links_ok: bool,
    certified: bool,
}

/// Values that differ by less are the same.
const SAME: f64 = 1e-7;
/// Kicks of a solve whose certificate stays incomplete.
const KICKS: usize = 3;
/// Wire of the starts as a share of the design's: thin, so that elements find their places.
const THIN: f64 = 0.2;
/// Amplitudes of the shaken starts, in reference radii and radians.
const SHAKES: [f64; 6] = [0.03, 0.1, 0.3, 0.05, 0.2, 0.5];

/// Searches for an extreme of `model` on the current thread pool. The result does not depend on the number of threads.
pub fn extreme(model: &Model, what: Extreme, options: &ExtremeOptions, cancel: &AtomicBool) -> ExtremeOutcome {
    let pull = pull(model, what, options.lattice_free);
    let from = |k: usize| -> Found {
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(k as u64));
        let state = match k {
            0 => model.start.clone(),
            _ => shaken_from(model, &model.start, SHAKES[(k - 1) % SHAKES.len()], &mut rng),
        };
        let mut p = vec![0.0; pull.parameters.len()];
        p[0] = first_parameter(model, what, &state);
        let mut program = SheetProgram::new(model, &pull);
        let start = program.posed(state, p);
        let Climbed { best, iterations } = climb(model, &mut program, start, KICKS, &mut rng, cancel);
        let best = best.map(|Solve { x, certificate, contacts, links_ok, certified }| Best {
            value: x.p[0],
            state: x.state,
            certificate,
            contacts,
            links_ok,
            certified,
        });
        Found { best, iterations }
    };
    let starts: Vec<usize> = (0..options.starts.max(1)).collect();
    let solved = starts.par_iter().with_max_len(1).filter(|_| !cancel.load(Ordering::Relaxed)).map(|k| from(*k));
    let solved: Vec<Found> = solved.collect();
    let (n_starts, iterations) = (solved.len() as u64, solved.iter().map(|s| s.iterations).sum());
    let mut distinct: Vec<f64> = Vec::new();
    let mut best: Option<Best> = None;
    for solve in solved.into_iter().filter_map(|s| s.best) {
        let value = solve.value;
        if solve.certified && !distinct.iter().any(|other| (other - value).abs() < SAME) {
            distinct.push(value);
        }
        // The first of equals counts, whatever thread it came from.
        if best.as_ref().is_none_or(|b| (solve.certified, value) > (b.certified, b.value + SAME)) {
            best = Some(solve);
        }
    }
    let nothing = ExtremeOutcome {
        what,
        status: if cancel.load(Ordering::Relaxed) { Status::Interrupted } else { Status::NotConverged },
        value: None,
        state: model.start.clone(),
        certificate: None,
        contacts: Vec::new(),
        links_ok: false,
        n_starts,
        n_distinct: distinct.len() as u64,
        iterations,
    };
    let Some(best) = best else { return nothing };
    let p = best.value;
    ExtremeOutcome {
        status: match (nothing.status, best.certified) {
            (Status::Interrupted, _) => Status::Interrupted,
            (_, true) => Status::Local,
            (_, false) => Status::Uncertified,
        },
        value: Some(if what == Extreme::ThickestWire { 1.0 + p } else { p }),
        state: best.state,
        certificate: Some(best.certificate),
        contacts: best.contacts,
        links_ok: best.links_ok,
        ..nothing
    }
}

/// p at a start: thin wire, or below every gap.
pub(super) fn first_parameter(model: &Model, what: Extreme, state: &State) -> f64 {
    match what {
        Extreme::ThickestWire => THIN - 1.0,
        Extreme::WidestGap => topology::smallest_gap(model, state).map_or(0.0, |(gap, _)| gap.min(0.0)),
    }
}

/// p first, then the lattice where it is free.
pub(super) fn pull(model: &Model, what: Extreme, lattice_free: bool) -> Pull {
    let base = [model.start.a1, model.start.a2];
    let goal = match what {
        Extreme::ThickestWire => Parameter { thicken: 1.0, weight: 1.0, ..Parameter::default() },
        Extreme::WidestGap => Parameter { widen: 1.0, weight: 1.0, ..Parameter::default() },
    };
    let mut parameters = vec![goal];
    if lattice_free {
        let rates = [[base[0].normalize(), Vec3::zeros()], [Vec3::zeros(), Vec3::x()], [Vec3::zeros(), Vec3::y()]];
        parameters.extend(rates.map(|rate| Parameter { rate, ..Parameter::default() }));
    }
    Pull { base, parameters, metric: None }
}
