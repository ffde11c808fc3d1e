//! Starts that overlap beyond repair.
//!
//! A design may say that its start overlaps (`allow_initial_overlap`). A limit is then sought from states that overlap, and where
//! no arrangement of such rings exists, every search for it ends in vain, after a long time. So the rings are asked first, with the
//! lattice free: by the two programs of [`super::room`], the largest clearance and the thickest wire, from a few perturbed starts each,
//! and each is stopped as soon as there is no overlap. Where none gets there nothing is proved: the answer is
//! [`Status::InfeasibleStart`](crate::record::Status::InfeasibleStart), which says what was tried.

use super::{
    multistart::Target,
    options::{FREEING_PERTURBATIONS, SLIGHT_OVERLAP},
    room::{Room, Sought},
    starts::{Use, perturbed, rng},
};
use crate::{
    model::Model,
    program::SheetProgram,
    solver::sqp::{SqpOptions, maximize},
    topology,
};
use std::sync::atomic::{AtomicBool, Ordering};

/// A start that overlaps, and no state without overlap was found.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Overlapping {
    /// The widest gap that was found, in reference radii: negative.
    widest: f64,
    /// Starts that were solved.
    starts: usize,
}

impl Overlapping {
    /// What was tried, as a sentence.
    pub(super) fn message(&self) -> String {
        let Overlapping { widest, starts } = self;
        format!(
            "the start overlaps, and {starts} starts with the lattice free led to no state without overlap: {:.6} R was the \
             least; nothing is proved",
            -widest
        )
    }
}

/// Looks for a state of the model's links without overlap, its lattice free; `None` where there is one, or the start is one, and
/// after `cancel`.
pub(super) fn beyond_repair(model: &Model, seed: u64, cancel: &AtomicBool) -> Option<Overlapping> {
    let gap = |state: &crate::state::State| topology::smallest_gap(model, state).map_or(f64::INFINITY, |(gap, _)| gap);
    let mut widest = gap(&model.start);
    if widest >= -SLIGHT_OVERLAP {
        return None;
    }
    let options = SqpOptions { enough: 0.0, ..SqpOptions::default() };
    let mut starts = 0;
    for what in [Room::Clearance, Room::Wire] {
        let sought = Sought { what, lattice_free: true };
        let pull = sought.family(model);
        for (k, size) in FREEING_PERTURBATIONS.into_iter().enumerate() {
            let mut stream = rng(seed, Use::Freeing, k as u64);
            let state = perturbed(model, &model.start, size, &mut stream);
            let p = sought.first_parameters(model, &state);
            let program = SheetProgram::new(model, &pull);
            let end = maximize(&program, program.posed(state, p), Vec::new(), &options, cancel);
            if cancel.load(Ordering::Relaxed) {
                return None;
            }
            starts += 1;
            if !topology::links_kept(model, &end.point.state) {
                continue;
            }
            widest = widest.max(gap(&end.point.state));
            if widest >= -SLIGHT_OVERLAP {
                return None;
            }
        }
    }
    Some(Overlapping { widest, starts })
}
