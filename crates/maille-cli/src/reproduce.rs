//! `maille reproduce`: the maps of chapter 6 of the thesis, and the files that are made of their records.

use crate::{
    exit::{self, wrong},
    input::Input,
    map::{self, Solved, Tally, pool},
    output::{self, counted, say},
    records,
};
use maille::design::Design;
use maille_chapter6::{Chosen, DESIGNS, Planned, Verdict, plan, report};
use maille_io::{
    DesignSource, chapter6,
    record::{FolderLock, Mark, RECORDS},
};
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Chapter 6 of the thesis computed anew, as one page
///
/// Writes a folder with index.html (each statement beside what was measured), figures/, sheets/ (pictures of the designs),
/// statements.json, and records/ with one record for each design, radius and method, as `maille characterize` writes
/// them. If it is interrupted, the same command continues it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille reproduce --quick                      coarse: directions every 15\u{b0}, little of the energy method
  maille reproduce                              directions every 7.5\u{b0}, both methods
  maille reproduce --only 1.1,1.2 --out mine --threads 4
  maille reproduce --designs my-coordinates --out theirs       1.1.toml, 2.toml and so on of that folder in place of ours
  maille plot reproduction/records/3.1-R10-exact --quantity lambda1 -o 3.1.svg

Limits are those of each design's own cell, as in the thesis, and of the rectangular cell for 3.x. The starts are ours, as the
thesis's pictures are lost: `maille inspect 1.1-chapter6` shows one, designs/chapter6/ has them.

Exit codes: 0 every limit was found or proved not to be there, 5 the page is written but some were not found, \
130 interrupted.")]
pub struct Args {
    /// Folder of all that is made [default: reproduction, or reproduction-quick]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Coarse, in minutes
    #[arg(long)]
    quick: bool,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Only these designs, as 1.1,3.1 [default: the thirteen of the thesis]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    only: Vec<String>,
    /// A folder of TOML files named as in the thesis, 1.1.toml to 5.2.toml: their coordinates are taken in place of ours
    #[arg(long, value_name = "FOLDER")]
    designs: Option<PathBuf>,
    /// No progress and no summary
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let chosen = chosen(&args.only, args.designs.as_deref())?;
    let usual = if args.quick { "reproduction-quick" } else { "reproduction" };
    let out = args.out.clone().unwrap_or_else(|| usual.into());
    output::folder(&out, "a folder is written")?;
    let plan = plan(&chosen, args.quick, &out.join(RECORDS)).map_err(|e| miette!("{e:?}"))?;
    // Records that are there are continued; what they have been made into is made again.
    let _lock = FolderLock::take(&out, &[Mark::Records])?;
    let open = |p: &Planned| map::open(&p.map, &Input::of(p.design.clone()));
    let open = plan.iter().map(|p| Ok((p.name.as_str(), open(p)?))).collect::<Result<Vec<_>>>()?;
    let Solved { tally: Tally { there, now, unanswered }, total, interrupted, .. } =
        map::solve(open, &out, args.threads, args.quiet)?;
    if interrupted {
        if !args.quiet {
            eprintln!("{there} of {total} limits are in the records, {now} of them now");
            eprintln!("interrupted; the same command continues from here");
        }
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let records = records::read(&plan.iter().filter_map(|p| p.map.out.clone()).collect::<Vec<_>>())?;
    let report = pool(args.threads)?.install(|| report(&chosen, args.quick, &records)).into_diagnostic()?;
    ["", "figures", "sheets"].map(|folder| out.join(folder)).iter().try_for_each(|f| output::remove_leftovers(f))?;
    report.files.iter().try_for_each(|(name, bytes)| output::write(&out.join(name), bytes))?;
    if !args.quiet {
        for finding in &report.findings {
            say!("statement {}: {}", finding.number, finding.verdict.words());
        }
        let unmeasured = report.findings.iter().filter(|f| f.verdict == Verdict::NotMeasured).count();
        if unmeasured > 0 {
            say!("{unmeasured} need other designs than these");
        }
        say!(
            "{} in {}, {now} of them now; {unanswered} not found",
            counted(there, "limit"),
            counted(plan.len(), "record")
        );
        say!("look at {}", out.join("index.html").display());
    }
    Ok(ExitCode::from(if unanswered > 0 { exit::INCOMPLETE } else { exit::DONE }))
}

/// The designs that are asked for, in the order of the thesis, those of `folder` before the built-in ones.
fn chosen(names: &[String], folder: Option<&Path>) -> Result<Vec<Chosen>> {
    if let Some(unknown) = names.iter().find(|name| !DESIGNS.contains(&name.as_str())) {
        return Err(wrong(
            exit::USAGE,
            format!("\"{unknown}\" is not a design of chapter 6"),
            format!("there are {}", DESIGNS.join(", ")),
        ));
    }
    let given = folder.map(given).transpose()?.unwrap_or_default();
    let wanted = DESIGNS.into_iter().filter(|d| names.is_empty() || names.iter().any(|name| name == d));
    wanted
        .map(|name| {
            let file = given.iter().find(|file| file.file_stem().is_some_and(|stem| stem == name)).cloned();
            let source = match &file {
                Some(file) => {
                    let text = std::fs::read_to_string(file)
                        .into_diagnostic()
                        .wrap_err_with(|| format!("cannot read {}", file.display()))?;
                    DesignSource::new(file.display().to_string(), text)
                }
                None => {
                    let start = chapter6(name).ok_or_else(|| miette!("design {name} is not built in"))?;
                    DesignSource::new(format!("{} (built in)", start.name), start.toml)
                }
            };
            Ok(Chosen {
                name,
                design: Design { name: name.into(), ..source.read()? },
                given: file.map(|file| file.display().to_string()),
            })
        })
        .collect()
}

/// The files of a folder that are named as designs of the thesis; refused where there is none, or another TOML file.
fn given(folder: &Path) -> Result<Vec<PathBuf>> {
    let names =
        || format!("name its files as in the thesis: {}", DESIGNS.map(|name| format!("{name}.toml")).join(", "));
    let entries = std::fs::read_dir(folder).map_err(|e| {
        wrong(exit::USAGE, format!("{} is not a folder that can be read: {e}", folder.display()), names())
    })?;
    let mut files = Vec::new();
    for entry in entries {
        let file = entry.into_diagnostic()?.path();
        if file.extension().is_some_and(|extension| extension == "toml") {
            if !file.file_stem().is_some_and(|stem| DESIGNS.iter().any(|name| stem == *name)) {
                return Err(wrong(exit::USAGE, format!("{} is not a design of chapter 6", file.display()), names()));
            }
            files.push(file);
        }
    }
    if files.is_empty() {
        return Err(wrong(exit::USAGE, format!("{} has no design of chapter 6", folder.display()), names()));
    }
    Ok(files)
}
