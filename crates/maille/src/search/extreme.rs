//! Extremes of a weave that are no strains: the thickest wire with which it exists, the state with the largest clearance, and the
//! closest cell (in [`super::closest`]).
//!
//! The program of a limit with another parameter p in place of l1. All rings must keep the core distance
//!
//! - thickest wire: (1 + p)(r_a + r_b), so that the minor radii (1 + p) r are as large as can be;
//! - largest clearance: r_a + r_b + p, so that the smallest gap p is as large as can be.
//!
//! Over all poses, and over the lattice where it is free: a1 along its direction, a2 in the plane (a common turn changes
//! nothing). Links are kept as in a limit, and the certificate is the same. No bound is known that proves such a state
//! the best of all, so the most that is claimed is `local`, with the number of starts and of distinct values they led to.

use super::{
    local::LocalSolution,
    multistart::{Entered, Multistart, Target, verdict},
    options::THIN_WIRE,
    starts::{Start, explored_with_own_wire},
    stop::StopRule,
};
use crate::{
    answer::Answer,
    design::Design,
    lattice::Cell,
    model::Model,
    program::{LatticeFamily, Parameter},
    question::Effort,
    record::Status,
    state::State,
    topology,
};
use maille_geometry::Vec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is as large, or as small, as can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extreme {
    /// All minor radii, in the proportions of the design.
    ThickestWire,
    /// The smallest gap between the tori of two rings.
    LargestClearance,
    /// The least area of the cell in which every gap is at least this, in reference radii. The lattice is free.
    ClosestCell {
        /// The gap.
        gap: f64,
    },
}

/// How the search goes.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtremeOptions {
    /// Whether the lattice may change.
    pub lattice_free: bool,
    /// How long it is searched.
    pub effort: Effort,
    /// So many starts in place of an effort.
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    pub seed: u64,
}

impl Default for ExtremeOptions {
    fn default() -> Self {
        ExtremeOptions { lattice_free: true, effort: Effort::Normal, starts: None, seed: 1 }
    }
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

impl Extreme {
    /// Different sizes of rings with the wire that was found; NaN where none was.
    pub fn sizes(self, answer: &Answer, model: &Model) -> Vec<Size> {
        let factor = if self == Extreme::ThickestWire { answer.value.unwrap_or(f64::NAN) } else { 1.0 };
        let mut out: Vec<Size> = Vec::new();
        for ring in &model.rings {
            let [major_radius, minor_radius] = [ring.major_radius, ring.minor_radius * factor].map(|x| x * model.unit);
            if !out.iter().any(|s| (s.major_radius, s.minor_radius) == (major_radius, minor_radius)) {
                out.push(Size { major_radius, minor_radius });
            }
        }
        out
    }

    /// The smallest gap of the state, in the design's unit; `None` where the wire was sought, or no state was found.
    pub fn clearance(self, answer: &Answer, model: &Model) -> Option<f64> {
        let gap = match self {
            Extreme::ThickestWire => None,
            Extreme::LargestClearance => answer.value,
            Extreme::ClosestCell { .. } => answer.value.and(answer.gap),
        };
        gap.map(|gap| gap * model.unit)
    }

    /// The area of the closest cell as a share of the written one; `None` where something else was sought.
    pub fn area_share(self, answer: &Answer) -> Option<f64> {
        answer.value.filter(|_| matches!(self, Extreme::ClosestCell { .. }))
    }

    /// The widest gap that was found where no cell has the one that was asked for, in the design's unit.
    pub fn widest_instead(self, answer: &Answer, model: &Model) -> Option<f64> {
        let Extreme::ClosestCell { gap } = self else { return None };
        answer.gap.filter(|widest| answer.value.is_none() && *widest < gap).map(|widest| widest * model.unit)
    }

    /// The state of the answer as a design. It allows overlaps at the start only where the design did and some are left.
    pub fn design(self, answer: &Answer, design: &Design, model: &Model) -> Design {
        let mut out = answer.state.design(design, model).rounded();
        let (word, words, factor) = match self {
            Extreme::ThickestWire => ("tightest", "thickest wire", answer.value.unwrap_or(1.0) * (1.0 - SPARED)),
            Extreme::LargestClearance => ("roomiest", "widest gaps", 1.0),
            Extreme::ClosestCell { .. } => ("closest", "closest cell", 1.0),
        };
        out.title = format!("{}, {words}", if out.title.is_empty() { &out.name } else { &out.title });
        out.name = format!("{}-{word}", out.name);
        out.minor_radius = out.minor_radius.map(|r| r * factor);
        let rings = out.elements.iter_mut().flat_map(|element| &mut element.rings);
        rings.for_each(|ring| ring.minor_radius = ring.minor_radius.map(|r| r * factor));
        out = out.settled();
        if design.allow_initial_overlap {
            out.allow_initial_overlap = false;
            out.allow_initial_overlap = Model::compile(&out, Cell::PRIMITIVE).is_err();
        }
        out
    }
}

/// An extreme, with the lattice free or held.
pub(super) struct Sought {
    pub what: Extreme,
    pub lattice_free: bool,
}

impl Target for Sought {
    /// p first, then the lattice where it is free.
    fn family(&self, model: &Model) -> LatticeFamily {
        let base = [model.start.a1, model.start.a2];
        let goal = match self.what {
            Extreme::ThickestWire => Parameter { thicken: 1.0, weight: 1.0, ..Parameter::default() },
            // A closest cell first needs room.
            Extreme::LargestClearance | Extreme::ClosestCell { .. } => {
                Parameter { widen: 1.0, weight: 1.0, ..Parameter::default() }
            }
        };
        let mut parameters = vec![goal];
        if self.lattice_free {
            let rates = [[base[0].normalize(), Vec3::zeros()], [Vec3::zeros(), Vec3::x()], [Vec3::zeros(), Vec3::y()]];
            parameters.extend(rates.map(|rate| Parameter { rate, ..Parameter::default() }));
        }
        LatticeFamily { base, parameters, metric: None }
    }

    /// With thin wire, or with a p below every gap.
    fn enter(&self, model: &Model, start: Start, _: &AtomicBool) -> Entered {
        let p = self.first_parameters(model, &start.state);
        Entered { at: Some((start.state, p)), iterations: 0 }
    }

    fn explored(&self, model: &Model, seed: u64, number: usize) -> Start {
        explored_with_own_wire(model, seed, number)
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        Start::written(solution.state.clone())
    }
}

impl Sought {
    /// Parameters at a start.
    pub(crate) fn first_parameters(&self, model: &Model, state: &State) -> Vec<f64> {
        let goal = match self.what {
            Extreme::ThickestWire => THIN_WIRE - 1.0,
            Extreme::LargestClearance | Extreme::ClosestCell { .. } => {
                topology::smallest_gap(model, state).map_or(0.0, |(gap, _)| gap.min(0.0))
            }
        };
        let lattice = if self.lattice_free { 3 } else { 0 };
        std::iter::once(goal).chain(std::iter::repeat_n(0.0, lattice)).collect()
    }
}

/// Searches for an extreme of `model` on the current thread pool. The result does not depend on the number of threads.
///
/// The value is the factor of the minor radii, or the clearance in reference radii. The status is `local` with a complete
/// certificate, else `uncertified`; `not-converged` where no start led to a state without overlap.
///
/// # Panics
/// For a closest cell, which [`closest_cell`](super::closest::closest_cell) searches.
pub fn extreme(model: &Model, what: Extreme, options: &ExtremeOptions, cancel: &AtomicBool) -> Answer {
    assert!(!matches!(what, Extreme::ClosestCell { .. }), "a closest cell is searched by closest_cell");
    let target = Sought { what, lattice_free: options.lattice_free };
    let search = Multistart { target: &target, upper_bound: f64::INFINITY, seed: options.seed, cancel };
    let straight = vec![Start::written(model.start.clone())];
    let mut found = search.run(model, straight, StopRule::of(options.effort, options.starts));
    let interrupted = cancel.load(Ordering::Relaxed);
    let Some(best) = found.best.take() else {
        let status = if interrupted { Status::Interrupted } else { Status::NotConverged };
        return found.counted(Answer::new(model, status));
    };
    let status = if interrupted { Status::Interrupted } else { verdict(&best, f64::INFINITY) };
    let value = Some(if what == Extreme::ThickestWire { 1.0 + best.value() } else { best.value() });
    let gradient = best.state.deformation_gradient(model);
    found.counted(Answer { value, gradient, ..Answer::new(model, status) }).with_solution(model, best)
}
