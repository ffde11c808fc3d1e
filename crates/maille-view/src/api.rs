//! What the page and the server say to each other, as JSON. `web/src/types.ts` is written from these types by a test.

use maille::{
    design::Design,
    lattice::Shift,
    record::{LimitRow, PoseRecord, StateRecord},
    relaxation::simulate::End,
};
use maille_io::ListedProblem;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What the page starts with; a bundle has it inside.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Start {
    /// Version of the program.
    pub version: String,
    /// The built-in designs.
    pub designs: Vec<Listed>,
    /// Records that can be opened, by their folders.
    pub records: Vec<Listed>,
    /// Names of the weaves that `/api/new` makes.
    pub weaves: Vec<String>,
    /// What the page opens with.
    pub opened: Shown,
    /// The colours of the program's pictures.
    pub palette: Palette,
    /// Whether this is a bundle: a page without a server.
    pub bundle: bool,
}

/// A built-in design, or a record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listed {
    /// Its name, or its folder.
    pub name: String,
    /// A line on it; of a record, what it holds.
    pub title: String,
}

/// Colours as `#rrggbb`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Palette {
    /// Of the kinds of elements, in turn.
    pub kinds: Vec<String>,
    /// Of loads, from little to most.
    pub loads: Vec<String>,
    /// Of an element without load.
    pub unloaded: String,
    /// Of forces.
    pub force: String,
}

/// A design with what is known of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Shown {
    /// The name that errors show: a built-in name or a path.
    pub name: String,
    /// File that `/api/save` may replace.
    pub file: Option<String>,
    /// The design file.
    pub text: String,
    /// Values that its parameters begin with, in place of the file's.
    pub parameters: BTreeMap<String, f64>,
    /// The limits of a record.
    pub map: Option<ShownMap>,
    /// The states of a simulation.
    pub simulation: Option<ShownSimulation>,
}

/// A finite sheet that was simulated, or a piece of a sheet that was rolled.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ShownSimulation {
    /// Its folder.
    pub source: String,
    /// The whole sheet; its cell is the tile.
    pub sheet: Sheet,
    /// States, in the order of the pull.
    pub frames: Vec<Frame>,
    /// States in the file: more than `frames` where they are too many to show.
    pub total: usize,
    /// How it ended.
    pub end: End,
    /// What happened, where `end` does not say it.
    pub note: Option<String>,
}

/// A state of a simulated sheet.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Frame {
    /// Its number in the file, from 0.
    pub number: usize,
    /// Share of the pull.
    pub share: f64,
    /// Energy, in β R².
    pub energy: f64,
    /// Distance between the pulled place and the one opposite to it, relative to the start.
    pub stretch: Option<f64>,
    /// Mean force along the pull, in the unit of weights.
    pub mean_force: Option<f64>,
    /// Which roll it is, where it is no state of a simulation.
    pub roll: Option<String>,
    /// Poses of the elements.
    pub poses: Vec<PoseRecord>,
}

/// A record to open, by its folder as it was listed.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpenRecord {
    /// The folder.
    pub name: String,
}

/// A state of which the pairs of rings are asked for.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measure {
    /// Of what.
    pub subject: Subject,
    /// The cell, or the tile of a finite sheet.
    pub cell: String,
    /// Whether the sheet is finite.
    pub finite: bool,
    /// First lattice vector.
    pub a1: [f64; 3],
    /// Second lattice vector.
    pub a2: [f64; 3],
    /// Poses of the elements.
    pub poses: Vec<PoseRecord>,
}

/// Limits that need no solving.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ShownMap {
    /// The record's folder, or how the map was made.
    pub source: String,
    /// The cells of its states.
    pub sheets: Vec<Sheet>,
    /// The limits.
    pub limits: Vec<Limit>,
}

/// A design file, and what the sliders change in it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subject {
    /// The name that errors show.
    pub name: String,
    /// The design file.
    pub text: String,
    /// Minor radius of every ring that gives none, in place of the file's.
    #[serde(default)]
    pub minor_radius: Option<f64>,
    /// Elements so many times as far apart.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// Values of parameters, in place of the file's.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
}

/// What is wrong with a design, and what it looks like all the same, if that is known.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Judged {
    /// As `maille check` lists them.
    pub problems: Vec<ListedProblem>,
    /// The design of the file, before any change, if it can be read.
    pub design: Option<Design>,
    /// Its start, overlaps included.
    pub sheet: Option<Sheet>,
}

/// A design compiled for one cell. Lengths in the file's unit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Sheet {
    /// Name of the design.
    pub name: String,
    /// A line on it.
    pub title: String,
    /// Unit of length, if the file names one.
    pub unit: Option<String>,
    /// The cell, as in a record.
    pub cell: String,
    /// The reference radius R.
    pub reference_radius: f64,
    /// First lattice vector of the start.
    pub a1: [f64; 3],
    /// Second lattice vector of the start.
    pub a2: [f64; 3],
    /// Kind of each element; elements that differ by a translation alone share one.
    pub kinds: Vec<usize>,
    /// First ring of each element.
    pub first_ring: Vec<usize>,
    /// Poses of the elements at the start.
    pub poses: Vec<PoseRecord>,
    /// The rings of all elements.
    pub rings: Vec<Ring>,
    /// Pairs of rings that are linked or near each other at the start.
    pub pairs: Vec<Pair>,
}

/// A ring in its element's frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ring {
    /// Its element.
    pub element: usize,
    /// Centre relative to the element's reference point.
    pub offset: [f64; 3],
    /// Unit normal.
    pub normal: [f64; 3],
    /// Radius of the core circle; of another curve that of a ball that holds it.
    pub major_radius: f64,
    /// Radius of the wire.
    pub minor_radius: f64,
    /// Of another curve, points along it, from the centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<Vec<[f64; 3]>>,
    /// Whether that curve has two ends.
    pub open: bool,
}

/// Two rings that are linked or near each other.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Pair {
    /// Ring of the cell.
    pub ring_a: usize,
    /// Ring of the image.
    pub ring_b: usize,
    /// The image's cell.
    pub shift: Shift,
    /// Linking number, 0 where the two are not linked.
    pub number: i32,
    /// Gap between the tori, negative where they overlap.
    pub gap: f64,
}

/// A limit: its row, its state, and the pairs of rings in that state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Limit {
    /// The row of `limits.csv`.
    pub row: LimitRow,
    /// The line of `states.jsonl`.
    pub state: StateRecord,
    /// Pairs of rings that are linked or near each other in it.
    pub pairs: Vec<Pair>,
}

/// Limits to find. The answer is a stream of [`SolveEvent`]s.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solve {
    /// Who asks: a newer request of the same name ends an older one.
    pub slot: String,
    /// Of what.
    pub subject: Subject,
    /// Directions of the pull, degrees.
    pub directions_deg: Vec<f64>,
    /// Stretch − 1 held across it.
    pub l2: Vec<f64>,
    /// The width is left to the sheet; `l2` is then `[0]`.
    pub lateral_free: bool,
}

/// What a solve says meanwhile.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolveEvent {
    /// So many limits will come.
    Begun(usize),
    /// A cell of limits to come.
    Sheet(Box<Sheet>),
    /// A limit.
    Limit(Box<Limit>),
    /// No more will come: all are there, or the solve was cancelled.
    Ended {
        /// A newer request, or a page that has gone.
        cancelled: bool,
    },
    /// It failed.
    Failed(Refused),
}

/// A file to make.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Export {
    /// `stl`, `3mf`, `obj`, `ply`, `glb`, `png`, `csv` or `svg`.
    pub format: String,
    /// Of what.
    pub subject: Subject,
    /// Cells along a1 and a2.
    pub tile: [u32; 2],
    /// A state other than the start.
    #[serde(default)]
    pub state: Option<StateRecord>,
    /// Its cell.
    #[serde(default)]
    pub cell: Option<String>,
    /// Whether the cell is a finite sheet.
    #[serde(default)]
    pub finite: bool,
    /// `csv` and `svg`: the rows.
    #[serde(default)]
    pub rows: Vec<LimitRow>,
}

/// Values of a design file to replace.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// The design file.
    pub text: String,
    /// The values, in turn.
    pub changes: Vec<Change>,
}

/// A value of a design file to replace.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Path of the value, as in problems.
    pub field: String,
    /// The new value, as TOML.
    pub value: String,
}

/// A design to make, of a weave or of one ring.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct New {
    /// Name of the design.
    pub name: String,
    /// Name of the weave; without one, the design is a single ring to go on from.
    pub weave: Option<String>,
    /// Major radius.
    pub major: f64,
    /// Minor radius.
    pub minor: f64,
    /// Unit of both.
    pub unit: String,
}

/// A design file to write, into the folder that the program runs in.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Save {
    /// Its name, without folders; or the file that was opened.
    pub file: String,
    /// Its text.
    pub text: String,
    /// Replace another file than the one that was opened.
    pub overwrite: bool,
}

/// A design file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Text {
    /// Name or path.
    pub name: String,
    /// The text.
    pub text: String,
}

/// What is at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Activity {
    /// Solves that run or wait.
    pub solves: usize,
}

/// Why a request was refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refused {
    /// What is wrong.
    pub problem: String,
    /// What would be right.
    pub help: String,
    /// Of a design: all that is wrong with it.
    pub problems: Vec<ListedProblem>,
}
