//! `simulation.json` and `frames.jsonl`: what a simulated sheet leaves behind.
//!
//! Their folder is never a mixture: `simulation.json` is removed first and written last, and has the checksum of both.

use super::{
    error::{RecordError, complete},
    lock::FolderLock,
    run::sha256,
};
use crate::{files, mesh::Tile};
use maille::{
    design::Design,
    error::InvalidInput,
    limit::energy::EnergyOptions,
    model::Model,
    record::FrameRecord,
    simulate::{End, Setup, Simulation, elements_at},
};
use maille_geometry::Vec3;
use serde::{Deserialize, Serialize};
use std::{fs, io::Write, path::Path};

/// Names of the two files of the record.
pub const SIMULATION: [&str; 2] = ["simulation.json", "frames.jsonl"];

/// What was done to a finite sheet, and what came out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulationRecord {
    /// Version of the format, 1.
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// The design, with the minor radius that was used.
    pub design: Design,
    /// Cells along a1 and a2, as `10x10`.
    pub tile: String,
    /// What was done to it.
    pub setup: SheetPlan,
    /// What came out.
    pub outcome: SimulationOutcome,
    /// SHA-256, in hexadecimal, of this document without this field, on one line, with `frames.jsonl` behind it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// What is done to a finite sheet, as given: places by their names (see [`elements_at`]), lengths in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetPlan {
    /// Where elements are held.
    pub fix: Vec<String>,
    /// Where they are pulled.
    pub pull: Vec<PulledPlace>,
    /// Weight of every element, in [`maille::simulate::WEIGHT_UNIT`].
    pub gravity: Option<[f64; 3]>,
    /// Where else forces act.
    pub force: Vec<LoadedPlace>,
    /// Height of a floor.
    pub floor: Option<f64>,
    /// Steps of the pull; with a drag, of the whole motion.
    pub steps: u32,
    /// What slows the sheet.
    #[serde(default)]
    pub drag: Option<f64>,
    /// Weight of the contacts against the pulls, α/β.
    #[serde(default = "usual_alpha")]
    pub alpha: f64,
    /// Largest miss of a pulled element that is still no lock, in R.
    #[serde(default = "usual_tau")]
    pub tau: f64,
    /// Newton iterations of one step at most.
    pub max_iterations: u32,
    /// Seed of everything random.
    pub seed: u64,
}

/// A place and its way: displacements from the start, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PulledPlace {
    /// Its name.
    pub place: String,
    /// The displacements.
    pub way: Vec<[f64; 3]>,
}

/// A place and the force on each of its elements, in [`maille::simulate::WEIGHT_UNIT`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadedPlace {
    /// Its name.
    pub place: String,
    /// The force.
    pub force: [f64; 3],
}

fn usual_alpha() -> f64 {
    EnergyOptions::default().alpha
}

fn usual_tau() -> f64 {
    EnergyOptions::default().tau
}

impl SheetPlan {
    /// Whether nothing is pulled and no force acts.
    pub fn is_still(&self) -> bool {
        self.pull.is_empty() && self.force.is_empty() && self.gravity.is_none_or(|g| g == [0.0; 3])
    }

    /// The plan on the elements of a sheet. A wrong place names its field: `fix`, `pull` or `force`.
    pub fn setup(&self, model: &Model) -> Result<Setup, InvalidInput> {
        let at = |field: &str, place: &str| {
            elements_at(model, place).map_err(|problem| InvalidInput { field: field.into(), ..problem })
        };
        let mut fix = Vec::new();
        for place in &self.fix {
            for element in at("fix", place)? {
                if !fix.contains(&element) {
                    fix.push(element); // a corner belongs to two edges
                }
            }
        }
        let (mut pull, mut forces) = (Vec::new(), Vec::new());
        for PulledPlace { place, way } in &self.pull {
            let way: Vec<Vec3> = way.iter().map(|by| Vec3::from(*by) / model.unit).collect();
            pull.extend(at("pull", place)?.into_iter().map(|element| (element, way.clone())));
        }
        for LoadedPlace { place, force } in &self.force {
            forces.extend(at("force", place)?.into_iter().map(|element| (element, Vec3::from(*force))));
        }
        let options = EnergyOptions {
            alpha: self.alpha,
            tau: self.tau,
            max_iterations: self.max_iterations as usize,
            seed: self.seed,
            ..EnergyOptions::default()
        };
        let gravity = self.gravity.map_or_else(Vec3::zeros, Vec3::from);
        let floor = self.floor.map(|height| (height - model.origin.z) / model.unit);
        Ok(Setup { fix, pull, gravity, forces, floor, steps: self.steps, drag: self.drag, options })
    }
}

impl SimulationRecord {
    /// What came of a plan for `tile` of `design`, compiled as `model`.
    pub fn new(design: &Design, tile: Tile, plan: SheetPlan, model: &Model, end: &Simulation) -> Self {
        SimulationRecord {
            schema: 1,
            version: env!("CARGO_PKG_VERSION").into(),
            design: design.clone(),
            tile: tile.to_string(),
            setup: plan,
            outcome: SimulationOutcome {
                end: end.end,
                share: end.share,
                smallest_gap: end.smallest_gap.map(|gap| gap * model.unit),
                links_ok: end.links_ok,
                iterations: end.iterations,
                kicks: end.kicks,
                unbalanced: end.unbalanced,
                note: end.note.clone(),
            },
            sha256: None,
        }
    }

    /// With the checksum of itself and its frames.
    pub fn sealed(mut self, frames: &[FrameRecord]) -> Self {
        self.sha256 = None;
        let text = serde_json::to_string(&self).expect("no map with odd keys") + "\n" + &write_frames(frames);
        self.sha256 = Some(sha256(text.as_bytes()));
        self
    }
}

/// Writes a simulation to its folder, which is created if it is not there.
pub fn save_simulation(folder: &Path, record: SimulationRecord, frames: &[FrameRecord]) -> Result<(), RecordError> {
    let _lock = FolderLock::take(folder)?;
    files::remove_leftovers(folder).map_err(|(path, e)| RecordError::io("remove", path)(e))?;
    let [first, second] = SIMULATION.map(|name| folder.join(name));
    if first.exists() {
        fs::remove_file(&first).map_err(RecordError::io("remove", &first))?;
    }
    let texts = [(second, write_frames(frames)), (first, write_simulation(&record.sealed(frames)))];
    for (path, text) in texts {
        files::replace(&path, |out| out.write_all(text.as_bytes())).map_err(RecordError::io("write", &path))?;
    }
    Ok(())
}

/// Reads a simulation from its folder.
pub fn open_simulation(folder: &Path) -> Result<(SimulationRecord, Vec<FrameRecord>), RecordError> {
    let [first, second] = SIMULATION.map(|name| folder.join(name));
    let read = |path: &Path| {
        let text = fs::read_to_string(path).map_err(RecordError::io("read", path))?;
        Ok::<_, RecordError>((path.display().to_string(), text))
    };
    let ((file, text), (frames_file, lines)) = (read(&first)?, read(&second)?);
    let record = read_simulation(&file, &text)?;
    let frames = read_frames(&frames_file, &lines)?;
    if let Some(expected) = record.sha256.clone() {
        let found = record.clone().sealed(&frames).sha256.unwrap_or_default();
        if found != expected {
            return Err(RecordError::Edited {
                file: format!("{file} or {frames_file}"),
                found,
                expected,
                by: SIMULATION[0],
            });
        }
    }
    Ok((record, frames))
}

/// What came out of a simulation. Lengths in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulationOutcome {
    /// How it ended.
    pub end: End,
    /// Largest share of the pull that was reached.
    pub share: f64,
    /// Smallest gap there; negative where tori overlap.
    pub smallest_gap: Option<f64>,
    /// Whether the links are those of the start.
    pub links_ok: bool,
    /// Newton iterations.
    pub iterations: usize,
    /// Random kicks.
    pub kicks: usize,
    /// Steps against a drag that ended without a balance of forces.
    #[serde(default)]
    pub unbalanced: usize,
    /// What happened, where `end` does not say it.
    pub note: Option<String>,
}

/// The record as text.
pub fn write_simulation(record: &SimulationRecord) -> String {
    serde_json::to_string_pretty(record).expect("no map with odd keys") + "\n"
}

/// Reads the record; `file` is the name to show in errors.
pub fn read_simulation(file: &str, text: &str) -> Result<SimulationRecord, RecordError> {
    complete(file, text)?;
    let record: SimulationRecord =
        serde_json::from_str(text).map_err(|e| RecordError::malformed(file, e.line(), e.to_string()))?;
    match record.schema {
        1 => Ok(record),
        n => Err(RecordError::malformed(file, 1, format!("schema {n} is not known; this program reads 1"))),
    }
}

/// The frames as text, one a line.
pub fn write_frames(frames: &[FrameRecord]) -> String {
    frames.iter().map(|f| serde_json::to_string(f).expect("no map with odd keys") + "\n").collect()
}

/// Reads frames; `file` is the name to show in errors.
pub fn read_frames(file: &str, text: &str) -> Result<Vec<FrameRecord>, RecordError> {
    complete(file, text)?;
    let read = |(i, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|e| RecordError::malformed(file, i + 1, e.to_string()))
    };
    text.lines().enumerate().map(read).collect()
}
