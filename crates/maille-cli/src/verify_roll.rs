//! `maille verify` of the rolls of a sheet.

use crate::{
    exit::{self, wrong},
    findings::{code, marked, outcome, say_checks, text, unreadable},
    output,
    progress::Progress,
    records,
};
use maille_io::roll::{ROLL, ROLLS, ROLLS_TABLE};
use maille_verify::{Finding, RollReport, RollTexts, RollVerifier, Verdict};
use miette::Result;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// Rolls with all that was found.
#[derive(Serialize)]
pub struct VerifiedRolls {
    record: String,
    design: String,
    outcome: &'static str,
    certified: usize,
    proved: usize,
    files: Vec<Finding>,
    rolls: Vec<RollReport>,
}

/// Whether a folder is to be verified as rolls.
pub fn is_roll(named: &Path) -> bool {
    let folder = records::folder(named);
    folder.join(ROLL).is_file() || folder.join(ROLLS).is_file()
}

/// Derives rolls anew.
pub fn verified(named: &Path, pool: &rayon::ThreadPool, quiet: bool) -> Result<VerifiedRolls> {
    let folder = records::folder(named);
    let read = |name: &str| {
        let help = "its run was killed: the same `maille roll` command writes it";
        text(&folder, name)?.ok_or_else(|| wrong(exit::RECORD, format!("{} has no {name}", folder.display()), help))
    };
    let (head, states, table) = (read(ROLL)?, read(ROLLS)?, read(ROLLS_TABLE)?);
    let texts = RollTexts { head: &head, states: &states, table: &table };
    let verifier = RollVerifier::new(&texts).map_err(|e| unreadable(&folder, &e))?;
    let progress = Progress::new("rolls", 0, verifier.len(), quiet);
    let roll = |k: usize| {
        let report = verifier.roll(k);
        progress.step();
        report
    };
    let rolls: Vec<RollReport> =
        pool.install(|| (0..verifier.len()).into_par_iter().with_max_len(1).map(roll).collect());
    progress.finish();
    let proved = |roll: &&RollReport| roll.certified && roll.findings.iter().all(|f| f.verdict == Verdict::Proved);
    let mut out = VerifiedRolls {
        record: records::name(&folder),
        design: verifier.design().to_owned(),
        outcome: "",
        certified: rolls.iter().filter(|roll| roll.certified).count(),
        proved: rolls.iter().filter(proved).count(),
        files: verifier.files().to_vec(),
        rolls,
    };
    out.outcome = outcome(out.code());
    Ok(out)
}

impl VerifiedRolls {
    /// How the program ends.
    pub fn code(&self) -> u8 {
        let all = self.files.iter().chain(self.rolls.iter().flat_map(|roll| &roll.findings));
        code(all.map(|finding| finding.verdict).max(), self.proved, self.certified)
    }

    /// In words.
    pub fn tell(&self, all: bool) {
        let (rolls, proved, certified) = (self.rolls.len(), self.proved, self.certified);
        output::say!("{}: {rolls} rolls, {proved} of {certified} certified ones proved", self.record);
        for finding in &self.files {
            output::say!("  {:<12} {}", "files", marked(finding));
        }
        say_checks(self.rolls.iter().map(|roll| &roll.findings[..]));
        if self.rolls.iter().any(|roll| roll.wrap.is_none()) {
            output::say!(
                "  what is proved is proved of pieces that go half round, and of elements that one link joins, or two"
            );
        }
        let told = |roll: &&RollReport| all || roll.findings.iter().any(|f| f.verdict >= Verdict::Open);
        for roll in self.rolls.iter().filter(told) {
            let tube = roll.wrap.map(|cells| format!(", {cells} cells round, {}", roll.sought));
            let given = roll.at_curvature.map(|curvature| format!(", curvature {curvature}, {}", roll.sought));
            let tube = tube.or(given).unwrap_or_default();
            output::say!("  along {}\u{b0}, axis {}{tube}, {}", roll.direction_deg, roll.axis, roll.status);
            for finding in roll.findings.iter().filter(|f| all || f.verdict >= Verdict::Open) {
                output::say!("    {:<12} {}", finding.check.name(), marked(finding));
            }
        }
    }
}
