//! `maille verify`: records derived anew, by code that shares nothing with the solver.

use crate::{
    exit,
    findings::{code, marked, outcome, say_checks, text, unreadable},
    map, output,
    progress::Progress,
    records,
    records::is_record,
    verify_proof::{self, VerifiedProof},
    verify_roll::{self, VerifiedRolls, is_roll},
    verify_surface::{self, VerifiedSurface, is_surface},
};
use maille_io::record::RunRecord;
use maille_verify::{Finding, RowReport, Texts, Verdict, Verifier};
use miette::Result;
use rayon::prelude::*;
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Derive each state of a record anew, by other means than it was found, and say what is proved
///
/// Of each row with a limit: that it has what its status says; its strains from its lattice; that no two rings overlap by more than 1e-9 R,
/// by a bound on whole arcs; linking numbers by Gauss's integral; that the recorded contact forces push and balance the pull to
/// 1e-6, from differences of gaps; that no small motion raises l1, to second order; its bound, from the chain or the forces that the state names. Of rows
/// without one: that no state has their l2, or that l1 can grow for ever. And that the files are whole, unedited, and fit together.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille verify 1.1                       maille-out/1.1
  maille verify 1.1 1.2 radius            many, and all records of a sweep
  maille verify 1.1 --rows                a line for each row
  maille verify 1.1 --json
  maille verify 1.1-boundary              a surface of `maille boundary`: each vertex
  maille verify european-4-in-1-roll      rolls of `maille roll`: each state
  maille verify maille-out/2-0deg.proof   a proof that `maille prove` wrote

What a row claims is derived, or false, or open. Not judged: what the search did (n_starts, n_distinct, better_chance, iterations, runs, wall_s), and
that rings never crossed on the way. docs/reliability.md has the method.

Exit codes: 0 all certified rows are proved, 4 something is false or unreadable, 5 something could not be proved.")]
pub struct Args {
    /// Folders of records, of surfaces or of rolls, NAME stands for maille-out/NAME; or files of `maille prove`
    #[arg(required = true, value_name = "RECORD")]
    records: Vec<PathBuf>,
    /// A line for each row, not only for those that are not proved
    #[arg(long, conflicts_with = "json")]
    rows: bool,
    /// All findings as one JSON document
    #[arg(long)]
    json: bool,
    /// Threads [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress
    #[arg(long, short)]
    quiet: bool,
}

/// A record with all that was found.
#[derive(Serialize)]
struct Verified {
    record: String,
    design: String,
    outcome: &'static str,
    certified: usize,
    proved: usize,
    files: Vec<Finding>,
    rows: Vec<RowReport>,
}

/// Rows that are named where not all are.
const NAMED: usize = 20;

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let pool = map::pool(args.threads)?;
    let (mut all, mut proofs, mut surfaces, mut rolls) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for named in &args.records {
        match verify_proof::is_proof(named) {
            true => proofs.push(verify_proof::verified(named, &pool, args.quiet)?),
            false if is_surface(named) => surfaces.push(verify_surface::verified(named, &pool, args.quiet)?),
            false if is_roll(named) => rolls.push(verify_roll::verified(named, &pool, args.quiet)?),
            false => {
                for folder in records::of_sweep(records::folder(named)) {
                    all.push(verified(&folder, &pool, args.quiet)?);
                }
            }
        }
    }
    if args.json {
        output::print_json(
            &serde_json::json!({ "records": all, "proofs": proofs, "surfaces": surfaces, "rolls": rolls }),
        )?;
    } else {
        all.iter().for_each(|record| tell(record, args.rows));
        surfaces.iter().for_each(|surface| surface.tell(args.rows));
        rolls.iter().for_each(|rolls| rolls.tell(args.rows));
        proofs.iter().for_each(VerifiedProof::tell);
    }
    let codes = || {
        let of_records = all.iter().map(Verified::code).chain(surfaces.iter().map(VerifiedSurface::code));
        let of_records = of_records.chain(rolls.iter().map(VerifiedRolls::code));
        of_records.chain(proofs.iter().map(VerifiedProof::code))
    };
    let worst = codes().max().unwrap_or(exit::DONE);
    let refuted = codes().any(|code| code == exit::RECORD);
    Ok(ExitCode::from(if refuted { exit::RECORD } else { worst }))
}

fn verified(folder: &Path, pool: &rayon::ThreadPool, quiet: bool) -> Result<Verified> {
    let name = folder.display().to_string();
    is_record(folder)?;
    let run = text(folder, "run.json")?.unwrap_or_default();
    let (limits, states) = (text(folder, "limits.csv")?, text(folder, "states.jsonl")?);
    let sensitivities = text(folder, "sensitivities.csv")?;
    let texts = Texts {
        run: &run,
        limits: limits.as_deref(),
        states: states.as_deref(),
        sensitivities: sensitivities.as_deref(),
    };
    let verifier = Verifier::new(&texts).map_err(|e| unreadable(folder, &e))?;
    // What follows from the design alone, and is no claim of the solver: how far its curves are from their arcs.
    if let Ok(record) = serde_json::from_str::<RunRecord>(&run) {
        record.check_curve_deviation(&format!("{name}/run.json"))?;
    }
    let progress = Progress::new("rows", 0, verifier.len(), quiet);
    let row = |k: usize| {
        let report = verifier.row(k);
        progress.step();
        report
    };
    let rows: Vec<RowReport> = pool.install(|| (0..verifier.len()).into_par_iter().with_max_len(1).map(row).collect());
    progress.finish();
    let certified = rows.iter().filter(|row| row.certified).count();
    let proved = rows.iter().filter(|row| row.certified && row.proved()).count();
    let mut out = Verified {
        record: name,
        design: verifier.design().to_owned(),
        outcome: "",
        certified,
        proved,
        files: verifier.files().to_vec(),
        rows,
    };
    out.outcome = outcome(out.code());
    Ok(out)
}

impl Verified {
    fn code(&self) -> u8 {
        let of_files = self.files.iter().map(|f| f.verdict).max();
        let of_rows = self.rows.iter().filter_map(RowReport::verdict).max();
        code(of_files.max(of_rows), self.proved, self.certified)
    }
}

fn tell(record: &Verified, all: bool) {
    output::say!(
        "{}: {}, {} of {} certified ones proved",
        record.record,
        output::counted(record.rows.len(), "row"),
        record.proved,
        record.certified
    );
    for finding in &record.files {
        output::say!("  {:<12} {}", "files", marked(finding));
    }
    say_checks(record.rows.iter().map(|row| &row.findings[..]));
    let told = |row: &&RowReport| all || row.findings.iter().any(|f| f.verdict >= Verdict::Open);
    let rows: Vec<&RowReport> = record.rows.iter().filter(told).collect();
    let most = if all { rows.len() } else { NAMED };
    for row in rows.iter().take(most) {
        output::say!("  {}°, l2 = {}, {}", row.direction_deg, row.l2, row.status);
        for finding in row.findings.iter().filter(|f| all || f.verdict >= Verdict::Open) {
            output::say!("    {:<12} {}", finding.check.name(), marked(finding));
        }
    }
    if rows.len() > most {
        output::say!("  {} more rows: --rows lists all", rows.len() - most);
    }
}
