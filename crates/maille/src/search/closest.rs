//! The closest cell: the lattice of least area in which all rings of different elements keep a gap.
//!
//! A gap of g is the same as no overlap with every minor radius larger by g/2, so the program is that of such a sheet, own images
//! included: over all poses and the lattice (a1 along its direction, a2 in the plane), t = 1 − A/A₀ is maximised under the
//! rows of `program/area.rs`. A start whose gaps are too small first goes to one where they are wide enough, by the
//! largest clearance. The certificate is that of a limit. No bound is known that a search could attain, so the most that is claimed is
//! `local`.

use super::{
    local::LocalSolution,
    multistart::{Entered, Multistart, Target, verdict},
    options::{ExtremeOptions, FEASIBLE},
    room::{Room, Sought, largest_room},
    starts::{Start, explored_with_own_wire},
    stop::StopRule,
};
use crate::{
    answer::Answer,
    model::Model,
    program::{LatticeFamily, Parameter, SheetProgram},
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    topology::smallest_gap,
};
use std::sync::atomic::{AtomicBool, Ordering};

/// Gaps are wider than asked for by this, in units of the reference radius: what rounding of a saved state could take.
const SPARED_GAP: f64 = 1e-11;

/// The least area of a sheet whose rings are as thick as the gap makes them.
struct LeastArea;

/// The clearance that a start first needs, with the lattice free.
const ROOM: Sought = Sought { what: Room::Clearance, lattice_free: true };

impl Target for LeastArea {
    /// t first, then the lattice.
    fn family(&self, model: &Model) -> LatticeFamily {
        let mut family = ROOM.family(model);
        family.parameters[0] = Parameter { saves_area: true, weight: 1.0, ..Parameter::default() };
        family
    }

    /// From where gaps are wide enough.
    fn enter(&self, model: &Model, start: Start, cancel: &AtomicBool) -> Entered {
        let family = ROOM.family(model);
        let program = SheetProgram::new(model, &family);
        let p = ROOM.first_parameters(model, &start.state);
        let options = SqpOptions { enough: 0.0, ..SqpOptions::default() };
        let end = maximize(&program, program.posed(start.state, p), Vec::new(), &options, cancel);
        let wide = end.point.p[0] >= -FEASIBLE && end.violation <= FEASIBLE;
        let mut p = end.point.p;
        p[0] = 1.0 - family.area_share(&end.point.state);
        Entered { at: wide.then_some((end.point.state, p)), iterations: end.iterations as u64 }
    }

    fn explored(&self, model: &Model, seed: u64, number: usize) -> Start {
        explored_with_own_wire(model, seed, number)
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        Start::written(solution.state.clone())
    }
}

/// Searches for the cell of least area in which every gap is at least `gap` (in reference radii), on the current thread pool. The
/// result does not depend on the number of threads. The lattice is free, whatever the options say.
///
/// The value is the area as a share of the written one. Where no start led to such a cell, the answer has the state and the gap of
/// the widest that was found.
pub(super) fn closest_cell(model: &Model, gap: f64, options: &ExtremeOptions, cancel: &AtomicBool) -> Answer {
    let mut thick = model.clone();
    thick.rings.iter_mut().for_each(|ring| ring.minor_radius += 0.5 * (gap + SPARED_GAP));
    let search = Multistart { target: &LeastArea, upper_bound: f64::INFINITY, seed: options.seed, cancel };
    let straight = vec![Start::written(model.start.clone())];
    let mut found = search.run(&thick, straight, StopRule::of(options.effort, options.starts));
    let interrupted = cancel.load(Ordering::Relaxed);
    let Some(best) = found.best.take() else {
        if interrupted {
            return found.counted(Answer::new(model, Status::Interrupted));
        }
        let options = ExtremeOptions { lattice_free: true, ..options.clone() };
        let widest = largest_room(model, Room::Clearance, &options, cancel);
        let Answer { state, gradient, gap, .. } = widest;
        return found.counted(Answer { state, gradient, gap, ..Answer::new(model, Status::NotConverged) });
    };
    let status = if interrupted { Status::Interrupted } else { verdict(&best, f64::INFINITY) };
    let (value, gradient) = (Some(1.0 - best.value()), best.state.deformation_gradient(model));
    let answer = found.counted(Answer { value, gradient, ..Answer::new(model, status) }).with_solution(&thick, best);
    Answer { gap: smallest_gap(model, &answer.state).map(|(gap, _)| gap), ..answer }
}
