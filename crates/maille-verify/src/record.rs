//! The texts of a record as plain data: what is written, with no opinion on what it means.
//!
//! Only the fields that are verified are read; others may be there.

use serde::{Deserialize, de::DeserializeOwned};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use thiserror::Error;

/// The files of a record. What is not there is `None`.
#[derive(Clone, Copy, Debug)]
pub struct Texts<'a> {
    /// `run.json`.
    pub run: &'a str,
    /// `limits.csv`.
    pub limits: Option<&'a str>,
    /// `states.jsonl`.
    pub states: Option<&'a str>,
    /// `sensitivities.csv`, which a record has where it was asked for.
    pub sensitivities: Option<&'a str>,
}

/// A file that cannot be read as what it should be.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{file}:{line}: {problem}")]
pub struct Unreadable {
    /// Name of the file.
    pub file: &'static str,
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub problem: String,
}

pub(crate) const RUN: &str = "run.json";
pub(crate) const LIMITS: &str = "limits.csv";
pub(crate) const STATES: &str = "states.jsonl";
/// Written beside the others on request.
pub(crate) const SENSITIVITIES: &str = "sensitivities.csv";

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Run {
    pub schema: u64,
    pub input_hash: String,
    pub design: Design,
    pub parameters: Value,
    pub counters: Counters,
    /// SHA-256 of each file; after it, while the files are replaced, that of the one before.
    #[serde(default)]
    pub files: BTreeMap<String, Vec<String>>,
}

#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub(crate) struct Counters {
    pub rows: BTreeMap<String, u64>,
    pub iterations: u64,
    pub runs: u64,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Design {
    pub name: String,
    pub minor_radius: Option<f64>,
    pub reference_radius: f64,
    pub lattice: Lattice,
    /// How far biarcs may be from the smooth curves for which they stand.
    #[serde(default)]
    pub curve_tolerance: Option<f64>,
    pub elements: Vec<Element>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Lattice {
    pub a1: [f64; 3],
    pub a2: [f64; 3],
    /// Whether a1 is the only one.
    #[serde(default)]
    pub single: bool,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Element {
    pub name: String,
    pub center: [f64; 3],
    pub rings: Vec<Ring>,
    /// Tubes round other curves.
    #[serde(default)]
    pub curves: Vec<CurveSpec>,
}

impl Design {
    /// Whether all is made of rings.
    pub fn is_round(&self) -> bool {
        self.elements.iter().all(|element| element.curves.is_empty())
    }
}

/// A form as it is written in a design.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Form {
    Stadium {
        straight: f64,
        radius: f64,
    },
    Square {
        side: f64,
        #[serde(default)]
        fillet: f64,
    },
    Hexagon {
        side: f64,
        #[serde(default)]
        fillet: f64,
    },
    Polyline {
        points: Vec<[f64; 3]>,
        #[serde(default)]
        fillet: f64,
        #[serde(default = "closed")]
        closed: bool,
    },
    Path {
        from: Option<[f64; 3]>,
        parts: Vec<Part>,
    },
    Spline {
        points: Vec<[f64; 3]>,
        #[serde(default = "closed")]
        closed: bool,
    },
    Frame {
        vertices: Vec<[f64; 3]>,
        edges: Vec<[usize; 2]>,
    },
    Ellipse {
        a: f64,
        b: f64,
    },
    TorusKnot {
        p: f64,
        q: f64,
        #[serde(rename = "R")]
        circle_radius: f64,
        a: f64,
    },
}

fn closed() -> bool {
    true
}

/// A part of a path.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Part {
    pub to: [f64; 3],
    pub through: Option<[f64; 3]>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct CurveSpec {
    pub shape: Form,
    pub normal: [f64; 3],
    pub along: [f64; 3],
    pub offset: [f64; 3],
    pub minor_radius: Option<f64>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Ring {
    pub major_radius: f64,
    pub normal: [f64; 3],
    #[serde(default)]
    pub offset: [f64; 3],
    pub minor_radius: Option<f64>,
}

/// One row of `limits.csv`.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct Row {
    pub design: String,
    pub minor_radius: Option<f64>,
    pub direction_deg: f64,
    pub l2: f64,
    pub method: String,
    pub cell: String,
    pub status: String,
    pub l1: Option<f64>,
    pub lambda1: Option<f64>,
    pub lambda2: Option<f64>,
    pub stretch1: Option<f64>,
    pub stretch2: Option<f64>,
    pub max_overlap: Option<f64>,
    pub min_gap: Option<f64>,
    pub iterations: u64,
    pub runs: u64,
    pub bound_l1: Option<f64>,
    pub bound_kind: Option<String>,
    pub bound_gap: Option<f64>,
    pub dual_residual: Option<f64>,
    pub complementarity: Option<f64>,
    pub min_multiplier: Option<f64>,
    pub min_curvature: Option<f64>,
    pub zero_modes: Option<u64>,
    pub n_starts: Option<u64>,
    pub n_distinct: Option<u64>,
    pub links_ok: Option<bool>,
    pub own_image_force: Option<f64>,
    pub l1_uncertified: Option<f64>,
    #[serde(default)]
    pub lateral: Option<String>,
    #[serde(default)]
    pub shear: Option<String>,
    #[serde(default)]
    pub l2_min: Option<f64>,
    #[serde(default)]
    pub l2_max: Option<f64>,
    #[serde(default)]
    pub shear_min: Option<f64>,
    #[serde(default)]
    pub shear_max: Option<f64>,
    #[serde(default)]
    pub a1_x: Option<f64>,
    #[serde(default)]
    pub a1_y: Option<f64>,
    #[serde(default)]
    pub a2_x: Option<f64>,
    #[serde(default)]
    pub a2_y: Option<f64>,
    #[serde(default)]
    pub end: Option<String>,
    #[serde(default)]
    pub wave_curvature: Option<f64>,
    #[serde(default)]
    pub wave_q1: Option<f64>,
    #[serde(default)]
    pub wave_q2: Option<f64>,
    #[serde(default)]
    pub extreme: Option<String>,
    /// Columns that are not empty.
    #[serde(skip)]
    pub present: BTreeSet<String>,
}

/// One line of `states.jsonl`, in the file's unit.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct State {
    pub direction_deg: f64,
    pub l2: f64,
    pub status: String,
    pub a1: [f64; 3],
    pub a2: [f64; 3],
    pub deformation_gradient: [[f64; 2]; 2],
    pub poses: Vec<Pose>,
    #[serde(default)]
    pub contacts: Vec<Contact>,
    #[serde(default)]
    pub chain: Option<Chain>,
    #[serde(default)]
    pub dual: Vec<Dual>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Pose {
    pub element: String,
    pub position: [f64; 3],
    pub rotation: [f64; 4],
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Contact {
    pub ring_a: usize,
    pub ring_b: usize,
    pub shift: [i32; 2],
    pub point_a: [f64; 3],
    pub point_b: [f64; 3],
    pub normal: [f64; 3],
    pub force: f64,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Chain {
    pub vector: [i32; 2],
    pub length: f64,
    pub rings: Vec<(usize, [i32; 2])>,
}

/// The force of one tie in the proof of a bound.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Dual {
    pub tie: String,
    pub rings: Vec<(usize, [i32; 2])>,
    pub force: [f64; 3],
}

/// A text file ends with a newline; otherwise its last line may have lost its end.
fn complete(file: &'static str, text: &str) -> Result<(), Unreadable> {
    if text.is_empty() || text.ends_with('\n') {
        return Ok(());
    }
    let line = text.matches('\n').count() + 1;
    Err(Unreadable { file, line, problem: "the file ends within this line: it was cut off".into() })
}

pub(crate) fn json<T: DeserializeOwned>(file: &'static str, line: usize, text: &str) -> Result<T, Unreadable> {
    serde_json::from_str(text).map_err(|e| Unreadable {
        file,
        line: if line == 0 { e.line() } else { line },
        problem: e.to_string(),
    })
}

pub(crate) fn read_run(text: &str) -> Result<Run, Unreadable> {
    complete(RUN, text)?;
    json(RUN, 0, text)
}

pub(crate) fn read_states(text: &str) -> Result<Vec<State>, Unreadable> {
    complete(STATES, text)?;
    text.lines().enumerate().map(|(k, line)| json(STATES, k + 1, line)).collect()
}

/// The rows, and the names of the columns.
pub(crate) fn read_rows(text: &str) -> Result<(Vec<Row>, BTreeSet<String>), Unreadable> {
    complete(LIMITS, text)?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| Unreadable { file: LIMITS, line: 1, problem: e.to_string() })?.clone();
    let columns = header.iter().map(str::to_owned).collect();
    let rows = reader.records().enumerate().map(|(k, record)| {
        let wrong = |problem: String| Unreadable { file: LIMITS, line: k + 2, problem };
        let record = record.map_err(|e| wrong(e.to_string()))?;
        let row: Row = record.deserialize(Some(&header)).map_err(|e| wrong(e.to_string()))?;
        // A design may be named as a number.
        let fields = || header.iter().zip(&record).filter(|(name, text)| *name != "design" && !text.is_empty());
        if fields().any(|(_, text)| text.parse().is_ok_and(|x: f64| !x.is_finite())) {
            return Err(wrong("a number is not finite".into()));
        }
        Ok(Row { present: fields().map(|(name, _)| name.to_owned()).collect(), ..row })
    });
    Ok((rows.collect::<Result<_, _>>()?, columns))
}

impl Row {
    /// Whether the column stands there with something in it.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.present.contains(column)
    }

    pub(crate) fn certified(&self) -> bool {
        matches!(self.status.as_str(), "global" | "local")
    }

    /// Whether the state is to show that l1 can grow for ever.
    pub(crate) fn comes_apart(&self) -> bool {
        self.status == "unbounded"
    }
}
