//! Rolls of a sheet as a record: how tightly it can be rolled along each direction, both ways, with the state of each.
//!
//! The folder has `roll.json`, what it is of; `rolls.jsonl`, a line for each roll with its state, from which an interrupted run goes on;
//! and `rolls.csv`, the same without states.

mod folder;
mod question;
mod run;

pub use folder::{ROLL, ROLLS, ROLLS_TABLE, RollFolder, RollRecordFile, in_order, open_rolls};
pub use question::{Axis, Kind, RollKey, RollQuestion, Sought};
pub use run::{RollError, find_rolls};

use crate::{
    answer::CertificateRecord,
    record::{csv_number, csv_text},
};
use maille::{
    answer::Answer,
    design::Design,
    lattice::{Across, Direction},
    model::Model,
    record::{ContactRecord, PoseRecord, RollRecord, StateRecord, Status, contact_records, pose_records},
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt::Write;

/// One roll: a line of `rolls.jsonl`. Lengths are in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roll {
    /// Direction that is rolled.
    pub direction_deg: f64,
    /// Where the axis is.
    pub axis: Axis,
    /// Cells of a tube that go round.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrap: Option<u32>,
    /// The curvature where it is given, in 1/unit, without the sign of the axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_curvature: Option<f64>,
    /// What is sought of a tube or at a given curvature; where it is not written, the largest curvature.
    #[serde(default, skip_serializing_if = "Sought::is_tightest")]
    pub sought: Sought,
    /// `free` where the width along the axis is left to the sheet, else `fixed`.
    pub lateral: String,
    /// The same of the shear.
    pub shear: String,
    /// Outcome of the search.
    pub status: Status,
    /// κ in 1/unit, above 0 where the axis is below; `None` where nothing was found.
    pub curvature: Option<f64>,
    /// Radius of the neutral surface, at the mean distance of the elements from the axis.
    pub neutral_radius: Option<f64>,
    /// Its length along the direction, as a share of the written one.
    pub neutral_stretch: Option<f64>,
    /// Stretch along the axis, minus 1.
    pub l2: Option<f64>,
    /// γ: how far lines along the direction lean along the axis.
    #[serde(default)]
    pub gamma: Option<f64>,
    /// What stopped the roll where no contact did.
    pub note: Option<String>,
    /// The cell of the state.
    pub cell: String,
    /// First lattice vector of that cell.
    pub a1: Option<[f64; 3]>,
    /// Second lattice vector.
    pub a2: Option<[f64; 3]>,
    /// How images are turned.
    pub roll: Option<RollRecord>,
    /// Poses of the elements of the cell.
    pub poses: Option<Vec<PoseRecord>>,
    /// Contacts that carry force.
    pub contacts: Vec<ContactRecord>,
    /// Smallest gap of two rings, negative where they overlap.
    pub min_gap: Option<f64>,
    /// What certifies the state.
    pub certificate: Option<CertificateRecord>,
    /// Whether the links are those of the design.
    pub links_ok: Option<bool>,
    /// Starts that were searched.
    pub n_starts: Option<u64>,
    /// Distinct certified curvatures among their ends.
    pub n_distinct: Option<u64>,
    /// Estimated chance that another start of the same kinds goes further.
    pub better_chance: Option<f64>,
    /// Wall time.
    pub wall_s: f64,
}

impl Roll {
    /// What was found of a roll, with these strains held or left to the sheet, in the cell of `model`.
    pub(crate) fn new(key: RollKey, free: Across, model: &Model, found: &Answer, wall_s: f64) -> Self {
        let RollKey { direction_deg, axis, wrap, at_curvature, sought } = key;
        let unit = model.unit;
        let solved = found.value.is_some();
        let neutral = found.state.neutral_surface_of(model).filter(|_| solved);
        let turned = || found.state.roll.map(|roll| roll.curvature(&model.reference_inverse));
        let curvature = found.value.and_then(|value| if sought == Sought::Tightest { Some(value) } else { turned() });
        let word = |free: bool| if free { "free" } else { "fixed" }.to_owned();
        let length = |a: maille_geometry::Vec3| -> [f64; 3] { (a * model.unit).into() };
        let direction = Direction::of_degrees(direction_deg);
        let (u, w) = (direction.along(), direction.across());
        Roll {
            direction_deg,
            axis,
            wrap,
            at_curvature,
            sought,
            lateral: word(free.lateral_free),
            shear: word(free.shear_free),
            status: found.status,
            curvature: curvature.map(|curvature| curvature / unit),
            neutral_radius: neutral.map(|n| n.radius * unit),
            neutral_stretch: neutral.map(|n| n.stretch),
            l2: solved.then(|| w.dot(&(found.gradient * w)) - 1.0),
            gamma: solved.then(|| w.dot(&(found.gradient * u))),
            note: found.note.clone(),
            cell: model.cell.to_string(),
            a1: solved.then(|| length(found.state.a1)),
            a2: solved.then(|| length(found.state.a2)),
            roll: RollRecord::of(&found.state).filter(|_| solved),
            poses: solved.then(|| pose_records(model, &found.state)),
            contacts: if solved { contact_records(model, &found.contacts) } else { Vec::new() },
            min_gap: found.gap.filter(|_| solved).map(|gap| gap * model.unit),
            certificate: found.certificate.as_ref().map(|c| CertificateRecord::new(c, model.unit)),
            links_ok: found.links_ok.filter(|_| solved),
            n_starts: found.n_starts,
            n_distinct: found.n_distinct,
            better_chance: found.better_chance,
            wall_s,
        }
    }

    /// What tells it from the others of its folder.
    pub fn key(&self) -> RollKey {
        let &Roll { direction_deg, axis, wrap, at_curvature, sought, .. } = self;
        RollKey { direction_deg, axis, wrap, at_curvature, sought }
    }

    /// Its state, as exports and pictures read one; `None` where nothing was found.
    pub fn state(&self) -> Option<StateRecord> {
        Some(StateRecord {
            direction_deg: self.direction_deg,
            l2: self.l2?,
            status: self.status,
            a1: self.a1?,
            a2: self.a2?,
            roll: Some(self.roll?),
            poses: self.poses.clone()?,
            contacts: self.contacts.clone(),
            ..StateRecord::default()
        })
    }

    /// Whether it is certified.
    pub fn is_certified(&self) -> bool {
        matches!(self.status, Status::Global | Status::Local)
    }
}

/// The document of all rolls of a design.
pub fn rolls_json(design: &Design, rolls: &[Roll]) -> Value {
    json!({ "design": design.name, "rolls": rolls })
}

/// A column of `rolls.csv`: its name and the value of a roll.
type RollColumn = (&'static str, fn(&Roll) -> String);

/// The columns of `rolls.csv`.
const COLUMNS: [RollColumn; 26] = [
    ("direction_deg", |r| csv_number(Some(r.direction_deg))),
    ("axis", |r| r.axis.name().into()),
    ("wrap", |r| r.wrap.map_or(String::new(), |cells| cells.to_string())),
    ("at_curvature", |r| csv_number(r.at_curvature)),
    ("sought", |r| if r.sought == Sought::Tightest { String::new() } else { r.sought.name().into() }),
    ("lateral", |r| r.lateral.clone()),
    ("shear", |r| r.shear.clone()),
    ("cell", |r| csv_text(&r.cell)),
    ("status", |r| r.status.name().into()),
    ("curvature", |r| csv_number(r.curvature)),
    ("neutral_radius", |r| csv_number(r.neutral_radius)),
    ("neutral_stretch", |r| csv_number(r.neutral_stretch)),
    ("l2", |r| csv_number(r.l2)),
    ("gamma", |r| csv_number(r.gamma)),
    ("min_gap", |r| csv_number(r.min_gap)),
    ("links_ok", |r| r.links_ok.map_or(String::new(), |ok| ok.to_string())),
    ("dual_residual", |r| csv_number(r.certificate.as_ref().map(|c| c.dual_residual))),
    ("complementarity", |r| csv_number(r.certificate.as_ref().map(|c| c.complementarity))),
    ("min_multiplier", |r| csv_number(r.certificate.as_ref().and_then(|c| c.min_multiplier))),
    ("min_curvature", |r| csv_number(r.certificate.as_ref().and_then(|c| c.min_curvature))),
    ("zero_modes", |r| r.certificate.as_ref().map_or(String::new(), |c| c.zero_modes.to_string())),
    ("n_starts", |r| r.n_starts.map_or(String::new(), |n| n.to_string())),
    ("n_distinct", |r| r.n_distinct.map_or(String::new(), |n| n.to_string())),
    ("better_chance", |r| csv_number(r.better_chance)),
    ("wall_s", |r| csv_number(Some(r.wall_s))),
    ("note", |r| r.note.as_deref().map_or(String::new(), csv_text)),
];

/// The table: a line for each roll.
pub fn rolls_csv(rolls: &[Roll]) -> String {
    let mut out = COLUMNS.map(|(name, _)| name).join(",") + "\n";
    for roll in rolls {
        let _ = writeln!(out, "{}", COLUMNS.map(|(_, of)| of(roll)).join(","));
    }
    out
}
