//! `maille replay`: solves rows of a record again, from the inputs that the record holds.

use crate::{
    at::{At, parse_at},
    exit::{self, wrong},
    output::{counted, say},
    records::{self, read_record},
    remedy::DAMAGED,
};
use maille::record::{LimitRow, Status};
use maille_io::run::{ReplayError, Replayed, replay};
use miette::{Report, Result};
use std::{path::PathBuf, process::ExitCode, sync::atomic::AtomicBool};

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
    let rows: Vec<&LimitRow> = match args.at {
        Some(at) => record.rows.iter().filter(|r| at.fits(r.direction_deg, r.l2)).collect(),
        None => record.rows.iter().filter(|r| r.l1.is_none()).collect(),
    };
    match args.at {
        Some(at) if rows.is_empty() => {
            let rows = record.rows.iter().take(6).map(|r| format!("  --at direction={},l2={}", r.direction_deg, r.l2));
            let help = format!("it has, among others:\n{}", rows.collect::<Vec<_>>().join("\n"));
            return Err(wrong(exit::RECORD, format!("the record has no row at {at}"), help));
        }
        None if rows.is_empty() => say!("every row of the record has a limit; name one with --at direction=…,l2=…"),
        _ => {}
    }
    let replayed = replay(&record, &rows, &AtomicBool::new(false)).map_err(|error| match error {
        ReplayError::Record(error) => Report::new(error),
        ReplayError::Design(_) => wrong(exit::RECORD, error.to_string(), DAMAGED),
    })?;
    for row in &replayed {
        let Replayed { then, now, .. } = row;
        say!("{}°, l2 = {}", then.direction_deg, then.l2);
        say!("  recorded  {}", line(then));
        say!("  now       {}{}", line(&now.row), if row.agrees() { "" } else { "   DIFFERS" });
        if let Some(note) = &now.state.note {
            say!("  note      {note}");
        }
    }
    let agrees = replayed.iter().all(Replayed::agrees);
    Ok(ExitCode::from(if agrees { exit::DONE } else { exit::INCOMPLETE }))
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
    let effort = [counted(row.iterations as usize, "iteration"), counted(row.runs as usize, "start")].join(", ");
    format!("{}{l1}{certificate}  {effort}", row.status.name())
}
