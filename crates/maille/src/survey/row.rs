//! A limit as a row and a state of a record. Nothing is searched or measured here: figures of the answer are
//! written in the file's unit.

use super::request::{Finished, Method, Task};
use crate::{
    answer::{Answer, CellTrend, FreeRanges},
    bound::DualForce,
    model::Model,
    record::{ChainRecord, DualRecord, LimitRow, RollRecord, StateRecord, Status, contact_records, pose_records},
};
use maille_geometry::Vec3;

/// What a row says of its question.
pub(super) struct Asked<'a> {
    pub task: &'a Task,
    pub method: &'a Method,
    /// Common minor radius of the rings.
    pub minor_radius: Option<f64>,
    /// The direction that was solved, where this is an image.
    pub image_of_deg: Option<f64>,
}

impl Asked<'_> {
    /// The answer, a state of `model`, as a row and a state.
    pub(crate) fn finished(&self, model: &Model, answer: &Answer, wall_s: f64) -> Finished {
        let state = state_record(self.task.direction_deg, self.task.l2, model, answer);
        Finished { row: self.row(model, answer, wall_s), state }
    }

    fn row(&self, model: &Model, answer: &Answer, wall_s: f64) -> LimitRow {
        let Asked { task, method, minor_radius, image_of_deg } = *self;
        let limit = answer.limit();
        let number = |x: f64| limit.map(|_| x);
        let [lambda1, lambda2] = answer.principal_squared();
        let gap = answer.gap.map(|gap| gap * model.unit);
        let certificate = answer.certificate.as_ref();
        let across = method.across();
        let word = |free: bool| if free { "free" } else { "fixed" }.to_owned();
        let held = FreeRanges { l2: [task.l2; 2], shear: [0.0; 2] };
        let ranges = if across.any() { answer.free } else { Some(held) }.filter(|_| limit.is_some());
        // Inside a model the unit is R.
        let [a1, a2] = model.cell.primitive(answer.state.a1, answer.state.a2);
        let by_cell: Vec<String> = answer.by_cell.iter().map(CellTrend::label).collect();
        // A proven limit does not grow, whichever cell it is found in.
        let last = answer.by_cell.last().filter(|_| by_cell.len() > 1);
        let grows_with_cell = last.map(|last| last.cell == answer.cell && answer.status != Status::Global);
        let wave = answer.wave.filter(|_| answer.status == Status::Local);
        LimitRow {
            design: model.name.clone(),
            minor_radius,
            direction_deg: task.direction_deg,
            l2: task.l2,
            method: method.name().into(),
            cell: model.cell.to_string(),
            status: answer.status,
            l1: limit,
            lambda1: number(lambda1),
            lambda2: number(lambda2),
            stretch1: number(lambda1.sqrt()),
            stretch2: number(lambda2.max(0.0).sqrt()),
            max_overlap: gap.map(|gap| (-gap).max(0.0)),
            min_gap: gap,
            iterations: answer.iterations,
            runs: answer.runs,
            wall_s,
            bound_l1: answer.bound,
            bound_kind: answer.bound_kind.map(|kind| kind.to_string()),
            bound_gap: answer.bound.zip(limit).map(|(bound, l1)| bound - l1),
            dual_residual: certificate.map(|c| c.dual_residual),
            complementarity: certificate.map(|c| c.complementarity),
            min_multiplier: certificate.map(|c| c.min_multiplier).filter(|m| m.is_finite()),
            min_curvature: certificate.and_then(|c| c.min_curvature).filter(|m| m.is_finite()),
            zero_modes: certificate.map(|c| c.zero_modes as u64),
            links_ok: answer.links_ok,
            n_starts: answer.n_starts,
            n_distinct: answer.n_distinct,
            own_image_force: answer.own_image_force,
            l1_uncertified: answer.value.filter(|_| answer.status == Status::Uncertified),
            lateral: Some(word(across.lateral_free)),
            shear: Some(word(across.shear_free)),
            l2_min: ranges.map(|r| r.l2[0]),
            l2_max: ranges.map(|r| r.l2[1]),
            shear_min: ranges.map(|r| r.shear[0]),
            shear_max: ranges.map(|r| r.shear[1]),
            a1_x: number(a1.x),
            a1_y: number(a1.y),
            a2_x: number(a2.x),
            a2_y: number(a2.y),
            end: Some(if method.compression() { "least" } else { "largest" }.to_owned()),
            by_cell: (!by_cell.is_empty()).then(|| by_cell.join("; ")),
            image_of_deg,
            grows_with_cell,
            better_chance: limit.and(answer.better_chance),
            wave_curvature: wave.map(|wave| wave.least),
            wave_q1: wave.map(|wave| wave.q[0]),
            wave_q2: wave.map(|wave| wave.q[1]),
            extreme: None,
        }
    }
}

/// The state of an answer, in the file's unit.
pub(super) fn state_record(direction_deg: f64, l2: f64, model: &Model, answer: &Answer) -> StateRecord {
    let f = answer.gradient;
    let position = |v: Vec3| -> [f64; 3] { (v * model.unit).into() };
    let poses = pose_records(model, &answer.state);
    let chain = answer.chain.as_ref().map(|chain| ChainRecord {
        vector: chain.vector,
        length: chain.length * model.unit,
        rings: chain.rings.clone(),
    });
    let force = |dual: &DualForce| DualRecord {
        tie: dual.kind.name().into(),
        rings: dual.rings.clone(),
        force: dual.force.into(),
    };
    StateRecord {
        direction_deg,
        l2,
        status: answer.status,
        a1: position(answer.state.a1),
        a2: position(answer.state.a2),
        roll: RollRecord::of(&answer.state),
        deformation_gradient: [[f[(0, 0)], f[(0, 1)]], [f[(1, 0)], f[(1, 1)]]],
        poses,
        residual: answer.residual.filter(|r| r.is_finite()),
        note: answer.note.clone(),
        contacts: contact_records(model, &answer.contacts),
        chain,
        dual: answer.dual.iter().map(force).collect(),
        steps: answer.steps.clone(),
    }
}
