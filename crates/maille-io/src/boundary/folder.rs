//! A surface as a record: `surface.json` says what it is of and how its rays are joined, `surface.jsonl` has a state for each
//! row of `boundary.csv`. The journal has ends of rays as they were found first; neighbours can have handed on better ones.

use super::journal::{SURFACE, surface_head};
use crate::record::{JournalHead, RecordError, sha256};
use maille::{
    design::Design,
    survey::surface::{Boundary, BoundaryOptions, BoundaryVertex},
};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::{collections::BTreeMap, fs, path::Path};

/// Name of the file of states.
pub const SURFACE_STATES: &str = "surface.jsonl";
const TABLE: &str = "boundary.csv";
const SCHEMA: u32 = 1;

/// What a surface is of.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SurfaceRecord {
    /// Version of this file.
    pub schema: u32,
    /// Version of the program.
    pub program_version: String,
    /// Hash of the design and of the parameters that decide where a ray ends.
    pub input_hash: String,
    /// The design as computed.
    pub design: Design,
    /// What was asked.
    pub parameters: BoundaryOptions,
    /// Names of the elements of each cell, in the order of the poses.
    pub cells: BTreeMap<String, Vec<String>>,
    /// Corners of the triangles: rows of the table, from 0.
    pub triangles: Vec<[usize; 3]>,
    /// Largest expected distance between the surface and its triangles, where it is known.
    pub arch: Option<f64>,
    /// Edges beyond the tolerance.
    pub open: usize,
    /// Edges along which the distance jumps.
    pub jumps: usize,
    /// Whether all rays were solved.
    pub complete: bool,
    /// SHA-256 of the states, of the table and of the meshes.
    pub files: BTreeMap<String, String>,
    /// SHA-256 of all else in this file, as JSON with sorted keys; none of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checksum: Option<String>,
}

impl SurfaceRecord {
    /// That of a surface; `files` are its other files as written, with their names.
    pub fn new(
        design: &Design,
        options: &BoundaryOptions,
        surface: &Boundary,
        cells: BTreeMap<String, Vec<String>>,
        files: &[(&str, &[u8])],
    ) -> Self {
        let JournalHead { program_version, input_hash, .. } = surface_head(design, options);
        let mut record = SurfaceRecord {
            schema: SCHEMA,
            program_version,
            input_hash,
            design: design.clone(),
            parameters: options.clone(),
            cells,
            triangles: surface.triangles.clone(),
            arch: Some(surface.arch).filter(|arch| arch.is_finite()),
            open: surface.open,
            jumps: surface.jumps,
            complete: surface.complete,
            files: files.iter().map(|(name, bytes)| ((*name).to_owned(), sha256(bytes))).collect(),
            checksum: None,
        };
        let mut all = json!(record);
        all.sort_all_objects();
        record.checksum = Some(sha256(all.to_string().as_bytes()));
        record
    }

    /// How near the triangles are expected to be, and why not nearer.
    pub fn accuracy(&self) -> String {
        let (asked, arch) = (self.parameters.tolerance, self.arch.unwrap_or(f64::INFINITY));
        let not = |why: String| {
            format!("the tolerance of {asked:.1e} is not reached: {why}; worst expected distance {arch:.1e}")
        };
        let edges = |n: usize| if n == 1 { "1 edge".to_owned() } else { format!("{n} edges") };
        match (self.complete, self.open, self.jumps) {
            (false, ..) => "the rays are not all solved".into(),
            (_, 0, 0) => format!("the surface is expected within {arch:.1e} of the triangles (asked: {asked:.1e})"),
            (_, 0, jumps) => not(format!("{} beyond it lie where the distance jumps from ray to ray", edges(jumps))),
            (_, open, jumps) => {
                let rays = self.triangles.iter().flatten().max().map_or(0, |most| most + 1);
                not(format!("stopped at {rays} rays with {} beyond it", edges(open + jumps)))
            }
        }
    }
}

/// The states of a surface, a line each.
pub fn surface_states(surface: &Boundary) -> String {
    let line = |vertex: &BoundaryVertex| serde_json::to_string(vertex).expect("a vertex is an object") + "\n";
    surface.vertices.iter().map(line).collect()
}

/// Reads a folder of `maille boundary`, and checks that its files are those that were written.
pub fn open_surface(folder: &Path) -> Result<(SurfaceRecord, Boundary), RecordError> {
    let read = |name: &str| {
        let path = folder.join(name);
        fs::read(&path).map(|bytes| (path.display().to_string(), bytes)).map_err(RecordError::io("read", &path))
    };
    let (file, bytes) = read(SURFACE)?;
    let record: SurfaceRecord =
        serde_json::from_slice(&bytes).map_err(|e| RecordError::json(&file, e.line().max(1), &e))?;
    if record.schema != SCHEMA {
        let problem = format!("schema {}; this program reads schema {SCHEMA}", record.schema);
        return Err(RecordError::malformed(&file, 1, problem));
    }
    let whole = |name: &str| {
        let (file, bytes) = read(name)?;
        let (found, expected) = (sha256(&bytes), record.files.get(name).cloned().unwrap_or_default());
        match found == expected {
            true => Ok((file, bytes)),
            false => Err(RecordError::Edited { file, found, expected, by: SURFACE }),
        }
    };
    whole(TABLE)?;
    let (file, states) = whole(SURFACE_STATES)?;
    let text = String::from_utf8_lossy(&states);
    let vertex = |(k, line): (usize, &str)| {
        serde_json::from_str::<BoundaryVertex>(line).map_err(|e| RecordError::json(&file, k + 1, &e))
    };
    let vertices = text.lines().enumerate().map(vertex).collect::<Result<Vec<_>, _>>()?;
    let SurfaceRecord { arch, open, jumps, complete, .. } = record;
    let arch = arch.unwrap_or(f64::INFINITY);
    let surface = Boundary { vertices, triangles: record.triangles.clone(), arch, open, jumps, complete };
    Ok((record, surface))
}
