//! `maille verify` of a file that `maille prove` wrote.

use crate::{
    exit::{self, wrong},
    output,
    progress::Progress,
};
use maille_verify::proof::Proof;
use miette::{IntoDiagnostic, Result, WrapErr};
use rayon::prelude::*;
use serde::Serialize;
use std::{fs, path::Path};

/// A proof with what was found of it.
#[derive(Serialize)]
pub struct VerifiedProof {
    proof: String,
    design: String,
    outcome: &'static str,
    cell: String,
    direction_deg: f64,
    l2: f64,
    l1_at_most: f64,
    l1_found: Option<f64>,
    nodes: usize,
    boxes: usize,
    /// Boxes that are not refuted.
    failed: usize,
    /// The line of the first of them.
    line: Option<usize>,
}

/// Whether a path is that of a proof.
pub fn is_proof(path: &Path) -> bool {
    path.is_file() && path.extension().is_some_and(|e| e == "proof")
}

/// Reads a proof and checks every box.
pub fn verified(path: &Path, pool: &rayon::ThreadPool, quiet: bool) -> Result<VerifiedProof> {
    let name = path.display().to_string();
    let text = fs::read_to_string(path).into_diagnostic().wrap_err_with(|| format!("cannot read {name}"))?;
    let help = "the file is damaged, was edited, or proves nothing: write it again with `maille prove`";
    let proof =
        Proof::read(&text).map_err(|(line, problem)| wrong(exit::RECORD, format!("{name}:{line}: {problem}"), help))?;
    let progress = Progress::new("boxes", 0, proof.len(), quiet);
    let check = |k: usize| {
        let result = proof.check(k).err();
        progress.step();
        result
    };
    let failed: Vec<usize> = pool.install(|| (0..proof.len()).into_par_iter().filter_map(check).collect());
    progress.finish();
    let claim = &proof.claim;
    Ok(VerifiedProof {
        proof: name,
        design: proof.design.clone(),
        outcome: if failed.is_empty() { "proved" } else { "false" },
        cell: claim.cell.clone(),
        direction_deg: claim.direction_deg,
        l2: claim.l2,
        l1_at_most: claim.l1_at_most,
        l1_found: claim.l1_found,
        nodes: proof.nodes(),
        boxes: proof.len(),
        failed: failed.len(),
        line: failed.first().copied(),
    })
}

impl VerifiedProof {
    /// The exit code.
    pub fn code(&self) -> u8 {
        if self.failed == 0 { exit::DONE } else { exit::RECORD }
    }

    /// Says it on the screen.
    pub fn tell(&self) {
        let at_most = (self.l1_at_most * 1e9).ceil() / 1e9;
        output::say!("{}: {}, {}\u{b0}, l2 = {}", self.proof, self.design, self.direction_deg, self.l2);
        match self.line {
            None => output::say!(
                "  proved for the cell {}: no state has l1 above {at_most:.9}; {} boxes",
                self.cell,
                self.boxes
            ),
            Some(line) => output::say!(
                "  FALSE: {} of {} boxes are not refuted by what the file says, the first in line {line}",
                self.failed,
                self.boxes
            ),
        }
    }
}
