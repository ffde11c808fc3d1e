//! `maille replay`: solves rows of a record again, from the inputs that the record holds.

use crate::{
    at::{At, parse_at},
    exit::{self, wrong},
    output, records,
    source::read_record,
};
use maille::{
    model::Model,
    record::{LimitRow, Status},
    survey::{Finished, MapQuestion, Task, characterize},
};
use miette::{Report, Result};
use std::{
    path::PathBuf,
    process::ExitCode,
    sync::{Mutex, atomic::AtomicBool},
};

/// Solve rows of a record again, by default those without a limit, and compare
///
/// A record holds the design and every parameter, so a failing solve is saved by itself: send the folder, replay it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille replay maille-out/1.3
  maille replay maille-out/1.3/run.json --at direction=30,l2=-0.125

Exit codes: 0 all rows came out as recorded, 5 some did not, 4 the record cannot be read.")]
pub struct Args {
    /// A record's folder, or the run.json in it; NAME stands for maille-out/NAME
    record: PathBuf,
    /// The rows to solve, as direction=30,l2=-0.125; what is not named stays open
    #[arg(long, value_parser = parse_at, allow_hyphen_values = true)]
    at: Option<At>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let record = read_record(&records::folder(&args.record))?;
    let MapQuestion { method, cells, l2, .. } = record.run.question()?;
    let design = &record.run.design;
    let models: Vec<Model> = cells
        .iter()
        .map(|cell| {
            Model::compile(design, *cell).map_err(|p| damaged(format!("the record's design cannot be used: {}", p[0])))
        })
        .collect::<Result<_>>()?;
    let rows: Vec<&LimitRow> = match args.at {
        Some(at) => record.rows.iter().filter(|r| at.fits(r.direction_deg, r.l2)).collect(),
        None => record.rows.iter().filter(|r| r.l1.is_none()).collect(),
    };
    if rows.is_empty() {
        match args.at {
            Some(at) => {
                let rows =
                    record.rows.iter().take(6).map(|r| format!("  --at direction={},l2={}", r.direction_deg, r.l2));
                let help = format!("it has, among others:\n{}", rows.collect::<Vec<_>>().join("\n"));
                return Err(wrong(exit::RECORD, format!("the record has no row at {at}"), help));
            }
            None => output::say!("every row of the record has a limit; name one with --at direction=…,l2=…"),
        }
    }
    let mut directions: Vec<f64> = rows.iter().map(|r| r.direction_deg).collect();
    directions.dedup();
    let wanted = |task: Task| rows.iter().any(|r| (r.direction_deg, r.l2) == (task.direction_deg, task.l2));
    let found = Mutex::new(Vec::<Finished>::new());
    let cancel = AtomicBool::new(false);
    characterize(&models, design.minor_radius, &method, &directions, &l2, &wanted, &cancel, &|row| {
        found.lock().unwrap_or_else(|e| e.into_inner()).push(row);
    });
    let found = found.into_inner().unwrap_or_else(|e| e.into_inner());
    let mut same = true;
    for then in rows {
        let Some(now) = found.iter().find(|f| (f.row.direction_deg, f.row.l2) == (then.direction_deg, then.l2)) else {
            continue;
        };
        let agrees = then.status == now.row.status && close(then.l1, now.row.l1);
        same &= agrees;
        output::say!("{}°, l2 = {}", then.direction_deg, then.l2);
        output::say!("  recorded  {}", line(then));
        output::say!("  now       {}{}", line(&now.row), if agrees { "" } else { "   DIFFERS" });
        if let Some(note) = &now.state.note {
            output::say!("  note      {note}");
        }
    }
    Ok(ExitCode::from(if same { exit::DONE } else { exit::INCOMPLETE }))
}

/// A record whose run.json is not what `characterize` writes.
fn damaged(problem: String) -> Report {
    wrong(
        exit::RECORD,
        problem,
        "the file is damaged or was edited: restore it, or compute the record again with --overwrite",
    )
}

fn close(a: Option<f64>, b: Option<f64>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9,
        (a, b) => a.is_none() && b.is_none(),
    }
}

fn line(row: &LimitRow) -> String {
    let number = |name: &str, x: Option<f64>| x.map_or(String::new(), |x| format!("  {name} {x:.3e}"));
    let l1 = row.l1.map_or(String::new(), |l1| format!("  l1 {l1:.12}"));
    let certificate = match row.status {
        Status::L2Unreachable | Status::Unbounded => String::new(),
        _ => [
            number("uncertified l1", row.l1_uncertified),
            number("gap", row.min_gap),
            number("dual", row.dual_residual),
            number("least multiplier", row.min_multiplier),
            number("least curvature", row.min_curvature),
        ]
        .concat(),
    };
    format!("{}{l1}{certificate}  {} iterations, {} starts", row.status.name(), row.iterations, row.runs)
}
