//! Room in a weave: the thickest wire with which it exists, and the state with the largest clearance.
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
    options::{ExtremeOptions, THIN_WIRE},
    starts::{Start, explored_with_own_wire},
    stop::StopRule,
};
use crate::{
    answer::Answer,
    model::Model,
    program::{LatticeFamily, Parameter},
    record::Status,
    state::State,
    topology,
};
use maille_geometry::Vec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is as large as can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Room {
    /// All minor radii, in the proportions of the design.
    Wire,
    /// The smallest gap between the tori of two rings.
    Clearance,
}

/// It, with the lattice free or held.
pub(super) struct Sought {
    pub what: Room,
    pub lattice_free: bool,
}

impl Target for Sought {
    /// p first, then the lattice where it is free.
    fn family(&self, model: &Model) -> LatticeFamily {
        let base = [model.start.a1, model.start.a2];
        let goal = match self.what {
            Room::Wire => Parameter { thicken: 1.0, weight: 1.0, ..Parameter::default() },
            Room::Clearance => Parameter { widen: 1.0, weight: 1.0, ..Parameter::default() },
        };
        let mut parameters = vec![goal];
        if self.lattice_free {
            let rates = [[base[0].normalize(), Vec3::zeros()], [Vec3::zeros(), Vec3::x()], [Vec3::zeros(), Vec3::y()]];
            parameters.extend(rates.map(|rate| Parameter { rate, ..Parameter::default() }));
        }
        LatticeFamily { base, parameters, metric: None, roll: None }
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
            Room::Wire => THIN_WIRE - 1.0,
            Room::Clearance => topology::smallest_gap(model, state).map_or(0.0, |(gap, _)| gap.min(0.0)),
        };
        let lattice = if self.lattice_free { 3 } else { 0 };
        std::iter::once(goal).chain(std::iter::repeat_n(0.0, lattice)).collect()
    }
}

/// Searches for it on the current thread pool. The value is the factor of the minor radii, or the clearance in reference radii.
pub(super) fn largest_room(model: &Model, what: Room, options: &ExtremeOptions, cancel: &AtomicBool) -> Answer {
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
    let value = Some(if what == Room::Wire { 1.0 + best.value() } else { best.value() });
    let gradient = best.state.deformation_gradient(model);
    found.counted(Answer { value, gradient, ..Answer::new(model, status) }).with_solution(model, best)
}
