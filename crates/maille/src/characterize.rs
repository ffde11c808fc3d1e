//! Characterisation: limits over directions and lateral strains, as rows and states of a record.

use crate::{
    energy::target::direction,
    limit::{EnergyMethod, EnergyOptions, LimitOutcome},
    model::Model,
    record::{LimitRow, PoseRecord, StateRecord, Status},
    topology,
};
use rayon::prelude::*;
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// One limit to find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Direction of the pull, degrees counter-clockwise from x.
    pub direction_deg: f64,
    /// Stretch − 1 held across it.
    pub l2: f64,
}

/// A finished row with its state.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The row of the table.
    pub row: LimitRow,
    /// The state at the limit.
    pub state: StateRecord,
}

/// The tasks of a map: every l2 with every direction, in the order of the table.
pub fn tasks(directions_deg: &[f64], l2: &[f64]) -> Vec<Task> {
    l2.iter().flat_map(|&l2| directions_deg.iter().map(move |&direction_deg| Task { direction_deg, l2 })).collect()
}

/// Finds the limits of `tasks` on the current thread pool and hands each over as it is finished, in any order.
///
/// Every limit starts from the design's state alone, so rows do not depend on the number of threads. After `cancel`
/// the tasks under way come back as interrupted and the others not at all.
pub fn characterize(
    model: &Model,
    minor_radius: Option<f64>,
    options: &EnergyOptions,
    tasks: &[Task],
    cancel: &AtomicBool,
    finished: &(dyn Fn(Finished) + Sync),
) {
    let method = EnergyMethod::new(model, options.clone(), cancel);
    tasks.par_iter().with_max_len(1).for_each(|task| {
        if cancel.load(Ordering::Relaxed) {
            return;
        }
        let begun = Instant::now();
        let outcome = method.limit(task.direction_deg, task.l2, cancel);
        let (row, state) = report(model, minor_radius, task, &outcome, begun.elapsed().as_secs_f64());
        finished(Finished { row, state });
    });
}

fn report(model: &Model, minor_radius: Option<f64>, task: &Task, outcome: &LimitOutcome, wall_s: f64) -> (LimitRow, StateRecord) {
    let f = outcome.gradient;
    let earned = outcome.status == Status::ThresholdReached;
    let along = direction(task.direction_deg);
    let c = f.transpose() * f;
    let (mean, half) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, ((c[(0, 0)] - c[(1, 1)]) / 2.0).hypot(c[(0, 1)]));
    let gap = topology::smallest_gap(model, &outcome.state).map(|(gap, _)| gap * model.unit);
    let number = |x: f64| earned.then_some(x);
    let row = LimitRow {
        design: model.name.clone(),
        minor_radius,
        direction_deg: task.direction_deg,
        l2: task.l2,
        method: "energy".into(),
        cell: model.cell.to_string(),
        status: outcome.status,
        l1: number(along.dot(&(f * along)) - 1.0),
        lambda1: number(mean + half),
        lambda2: number(mean - half),
        stretch1: number((mean + half).sqrt()),
        stretch2: number((mean - half).max(0.0).sqrt()),
        max_overlap: gap.filter(|_| earned).map(|gap| (-gap).max(0.0)),
        min_gap: gap.filter(|_| earned),
        iterations: outcome.iterations,
        runs: outcome.runs,
        wall_s,
    };
    let position = |v: maille_geometry::Vec3| -> [f64; 3] { (v * model.unit).into() };
    let poses = model
        .elements
        .iter()
        .zip(&outcome.state.poses)
        .map(|(element, pose)| {
            let q = pose.rotation.quaternion();
            PoseRecord { element: element.name.clone(), position: position(pose.position), rotation: [q.w, q.i, q.j, q.k] }
        })
        .collect();
    let state = StateRecord {
        direction_deg: task.direction_deg,
        l2: task.l2,
        status: outcome.status,
        a1: position(outcome.state.a1),
        a2: position(outcome.state.a2),
        deformation_gradient: [[f[(0, 0)], f[(0, 1)]], [f[(1, 0)], f[(1, 1)]]],
        poses,
        residual: outcome.residual.is_finite().then_some(outcome.residual),
        note: outcome.note.clone(),
    };
    (row, state)
}
