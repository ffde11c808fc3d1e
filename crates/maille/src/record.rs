//! What a run leaves behind: one row a limit, and the state that proves it.

mod row;

pub use row::{Column, Entry, Kind, LIMIT_COLUMNS, LimitRow, Status, Unit};

use crate::{
    model::{Element, Model},
    program::Contact,
    state::{Pose, Roll, State},
};
use maille_geometry::Vec3;
use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// Version of the record's files.
pub const RECORD_SCHEMA: u32 = 1;

/// Pose of one element: `position + rotation · (offset in the design)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseRecord {
    /// Name of the element, with the copy's cell in a supercell: `flat`, `flat@1,0`.
    pub element: String,
    /// Position of its reference point, in the file's unit.
    pub position: [f64; 3],
    /// Rotation from the design's pose, unit quaternion `[w, x, y, z]`.
    pub rotation: [f64; 4],
}

/// The poses of a state, in the file's unit.
pub fn pose_records(model: &Model, state: &State) -> Vec<PoseRecord> {
    let record = |(element, pose): (&Element, &Pose)| {
        let q = pose.rotation.quaternion();
        PoseRecord {
            element: element.name.clone(),
            position: (pose.position * model.unit).into(),
            rotation: [q.w, q.i, q.j, q.k],
        }
    };
    model.elements.iter().zip(&state.poses).map(record).collect()
}

/// One line of `frames.jsonl`: a state of a simulated sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameRecord {
    /// Minimisation that it belongs to, counted from 0.
    pub run: u32,
    /// Share of the pull.
    pub share: f64,
    /// Energy, in β R².
    pub energy: f64,
    /// Poses of the elements.
    pub poses: Vec<PoseRecord>,
}

/// One line of `forces.csv`: what holds a simulated sheet in one of its frames, see [`crate::relaxation::simulate::force`].
#[derive(Clone, Debug, PartialEq)]
pub struct ForceRow {
    /// Share of the pull.
    pub share: f64,
    /// Distance of the first pulled place from the one opposite to it, along the pull, by that at the start.
    pub stretch: Option<f64>,
    /// Force along the pull on an element of the first pulled place, their mean; positive where it stretches the sheet.
    /// Forces are in [`crate::relaxation::simulate::WEIGHT_UNIT`]s, 1e-3 β R.
    pub mean_force: Option<f64>,
    /// F in the plane, rows first: row i, column k is ∂x_i/∂X_k.
    pub deformation: Option<[[f64; 2]; 2]>,
    /// Energy, in β R².
    pub energy: f64,
    /// Force of the floor along z.
    pub floor_force: Option<f64>,
    /// Sum of the sizes of the forces with which the surface of a bend draws the elements.
    pub bend_force: Option<f64>,
    /// Force of each place that is fixed or pulled on the sheet.
    pub forces: Vec<[f64; 3]>,
}

/// A contact that carries force in a locked state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactRecord {
    /// Ring of the solved cell, counted through all elements.
    pub ring_a: usize,
    /// Ring of the image.
    pub ring_b: usize,
    /// The image's cell.
    pub shift: [i32; 2],
    /// Point on A's core circle, in the file's unit.
    pub point_a: [f64; 3],
    /// Point on B's core circle.
    pub point_b: [f64; 3],
    /// Unit vector from A's point to B's: the direction of the force on B.
    pub normal: [f64; 3],
    /// Force per unit of pull: dl1 for each reference radius by which this gap is widened.
    pub force: f64,
}

/// The contacts of a state, in the file's unit.
pub fn contact_records(model: &Model, contacts: &[Contact]) -> Vec<ContactRecord> {
    let position = |v: Vec3| -> [f64; 3] { (v * model.unit).into() };
    let record = |c: &Contact| ContactRecord {
        ring_a: c.pair.ring_a,
        ring_b: c.pair.ring_b,
        shift: c.pair.shift,
        point_a: position(c.point_a),
        point_b: position(c.point_b),
        normal: (c.point_b - c.point_a).normalize().into(),
        force: c.force,
    };
    contacts.iter().map(record).collect()
}

/// The chain of links that binds in the bound: rings with their cells, the last an image of the first. Rings and cells are
/// counted in the first cell of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainRecord {
    /// Lattice vector that the chain joins, in those cells.
    pub vector: [i32; 2],
    /// Its length, in the file's unit.
    pub length: f64,
    /// (ring, cell) along the chain.
    pub rings: Vec<(usize, [i32; 2])>,
}

/// The force of one tie in a proof by the link bound, see `docs/theory/bounds.md`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DualRecord {
    /// `link` of a, b; `strand-pair` of a, a', both linked with b; `crossing-pairs` of a, a' and b, b'; `chain`.
    pub tie: String,
    /// Its rings, each with its cell: counted in the design's own cell; along a chain in the first cell of the run.
    pub rings: Vec<(usize, [i32; 2])>,
    /// y for a unit pull, lengths in reference radii.
    pub force: [f64; 3],
}

/// One step of a run of the energy method: a Newton iteration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Which run of the search, from 1.
    pub run: u64,
    /// l1 that the run aims at.
    pub l1: f64,
    /// Energy after the step, in β R².
    pub energy: f64,
    /// The farthest that an element's reference point or a lattice vector moved in it, in R.
    pub size: f64,
    /// Whether the step left a saddle, or a stall by a random kick.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub perturbed: bool,
    /// Its wall time.
    pub wall_s: f64,
}

/// How a sheet is rolled, see `docs/theory/roll.md`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RollRecord {
    /// u, the unit vector along which the sheet is rolled. The axis is along w, to its left.
    pub along: [f64; 2],
    /// Turn about w from a cell to the next along a1 and along a2.
    pub turn_rad: [f64; 2],
}

impl StateRecord {
    /// The state, for the model of its cell; `None` where it has other elements.
    pub fn state(&self, model: &Model) -> Option<State> {
        let names = model.elements.iter().map(|e| e.name.as_str());
        if !self.poses.iter().map(|p| p.element.as_str()).eq(names) {
            return None;
        }
        let length = |x: [f64; 3]| Vec3::from(x) / model.unit;
        let pose = |p: &PoseRecord| {
            let [w, x, y, z] = p.rotation;
            let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            Pose { position: length(p.position), rotation }
        };
        let along = |[x, y]: [f64; 2]| Vec3::new(x, y, 0.0);
        let roll = self.roll.map(|roll| Roll { along: along(roll.along), turn_rad: roll.turn_rad });
        Some(State { poses: self.poses.iter().map(pose).collect(), a1: length(self.a1), a2: length(self.a2), roll })
    }
}

impl RollRecord {
    /// That of a state.
    pub fn of(state: &State) -> Option<Self> {
        state.roll.map(|roll| RollRecord { along: [roll.along.x, roll.along.y], turn_rad: roll.turn_rad })
    }
}

/// One line of `states.jsonl`: the state at the limit of one row (or the last state of a failed search).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StateRecord {
    /// Direction of the row.
    pub direction_deg: f64,
    /// l2 of the row.
    pub l2: f64,
    /// Status of the row.
    pub status: Status,
    /// Deformed lattice vectors of the solved cell, in the file's unit.
    pub a1: [f64; 3],
    /// Deformed second lattice vector of the solved cell.
    pub a2: [f64; 3],
    /// How images are turned; absent where the sheet is flat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll: Option<RollRecord>,
    /// In-plane deformation gradient, rows `[[Fxx, Fxy], [Fyx, Fyy]]`.
    pub deformation_gradient: [[f64; 2]; 2],
    /// Poses of the elements of the solved cell.
    pub poses: Vec<PoseRecord>,
    /// Last residual of the search: the distance to the target that the threshold judges.
    pub residual: Option<f64>,
    /// A sentence on what happened, where the status alone does not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Contacts that carry force (exact method).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactRecord>,
    /// The binding chain of the bound (exact method).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chain: Option<ChainRecord>,
    /// The forces that prove the bound, or that no state has this l2, where the chain does not (exact method).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dual: Vec<DualRecord>,
    /// The steps of all runs (energy method, where they were asked for).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<StepRecord>,
}
