//! `maille verify` of a surface of all strains.

use crate::{
    exit::{self, wrong},
    findings::{code, marked, outcome, say_checks, text, unreadable},
    output,
    progress::Progress,
    records,
};
use maille_io::boundary::{SURFACE, SURFACE_STATES};
use maille_verify::{Finding, SurfaceTexts, SurfaceVerifier, Verdict, VertexReport};
use miette::Result;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// A surface with all that was found.
#[derive(Serialize)]
pub struct VerifiedSurface {
    surface: String,
    design: String,
    outcome: &'static str,
    certified: usize,
    proved: usize,
    files: Vec<Finding>,
    vertices: Vec<VertexReport>,
}

/// Vertices that are named where not all are.
const NAMED: usize = 5;

/// Whether a folder is to be verified as a surface.
pub fn is_surface(named: &Path) -> bool {
    let folder = records::folder(named);
    folder.join(SURFACE).is_file() || folder.join("boundary.jsonl").is_file()
}

/// Derives a surface anew.
pub fn verified(named: &Path, pool: &rayon::ThreadPool, quiet: bool) -> Result<VerifiedSurface> {
    let folder = records::folder(named);
    let read = |name: &str| {
        let help = "its run was killed, or is older than this file: the same `maille boundary` command writes it";
        text(&folder, name)?.ok_or_else(|| wrong(exit::RECORD, format!("{} has no {name}", folder.display()), help))
    };
    let (head, states, table) = (read(SURFACE)?, read(SURFACE_STATES)?, read("boundary.csv")?);
    let meshes = ["boundary.obj", "boundary.ply"].map(|name| Ok((name, text(&folder, name)?)));
    let meshes: Vec<(&str, Option<String>)> = meshes.into_iter().collect::<Result<_>>()?;
    let meshes: Vec<(&str, &str)> = meshes.iter().filter_map(|(name, text)| Some((*name, text.as_deref()?))).collect();
    let texts = SurfaceTexts { head: &head, states: &states, table: &table, meshes: &meshes };
    let verifier = SurfaceVerifier::new(&texts).map_err(|e| unreadable(&folder, &e))?;
    let progress = Progress::new("vertices", 0, verifier.len(), quiet);
    let vertex = |k: usize| {
        let report = verifier.vertex(k);
        progress.step();
        report
    };
    let vertices: Vec<VertexReport> =
        pool.install(|| (0..verifier.len()).into_par_iter().with_max_len(1).map(vertex).collect());
    progress.finish();
    let proved = |v: &&VertexReport| v.certified && v.findings.iter().all(|f| f.verdict == Verdict::Proved);
    let mut out = VerifiedSurface {
        surface: records::name(&folder),
        design: verifier.design().to_owned(),
        outcome: "",
        certified: vertices.iter().filter(|v| v.certified).count(),
        proved: vertices.iter().filter(proved).count(),
        files: verifier.files().to_vec(),
        vertices,
    };
    out.outcome = outcome(out.code());
    Ok(out)
}

impl VerifiedSurface {
    /// How the program ends.
    pub fn code(&self) -> u8 {
        let all = self.files.iter().chain(self.vertices.iter().flat_map(|v| &v.findings));
        code(all.map(|finding| finding.verdict).max(), self.proved, self.certified)
    }

    /// In words.
    pub fn tell(&self, all: bool) {
        let (vertices, proved, certified) = (self.vertices.len(), self.proved, self.certified);
        output::say!("{}: {vertices} vertices, {proved} of {certified} certified ones proved", self.surface);
        for finding in &self.files {
            output::say!("  {:<12} {}", "files", marked(finding));
        }
        say_checks(self.vertices.iter().map(|vertex| &vertex.findings[..]));
        let told = |v: &&VertexReport| all || v.findings.iter().any(|f| f.verdict >= Verdict::Open);
        let chosen: Vec<&VertexReport> = self.vertices.iter().filter(told).collect();
        let most = if all { chosen.len() } else { NAMED };
        for vertex in chosen.iter().take(most) {
            let [x, y, z] = vertex.direction;
            output::say!("  vertex {}, ray {x:.4}, {y:.4}, {z:.4}, {}", vertex.vertex, vertex.status);
            for finding in vertex.findings.iter().filter(|f| all || f.verdict >= Verdict::Open) {
                output::say!("    {:<12} {}", finding.check.name(), marked(finding));
            }
        }
        if chosen.len() > most {
            output::say!("  {} more vertices: --rows lists all", chosen.len() - most);
        }
    }
}
