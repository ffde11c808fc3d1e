//! `maille sweep`: the maps of a study.

use crate::{
    exit::{self, wrong},
    input::{Input, file_name},
    map::{self, RunArgs, Solved, Tally},
    output::{self, say},
    records, remedy,
};
use maille_io::{
    builtin,
    record::{FolderLock, NamedRecord},
    run::{Map, OpenMap},
    study::{Study, StudyDesign},
    table::{Field, Table},
};
use miette::{IntoDiagnostic, Result, WrapErr};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

/// Limits of many designs, radii, spacings, or any other numbers of a design
///
/// Writes a folder: records/ with one record for each design and its parameters, as `maille characterize` writes
/// them, and limits.csv with the rows of all. All cores work until the last limit. A run that was stopped goes on where it
/// was with the same command.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille sweep --example > radius.toml
  maille sweep radius.toml
  maille plot maille-out/radius/records/* --quantity stretch -o radius.svg
  maille table maille-out/radius/records/* --where direction=45

A study:
  directions = \"0:180:15\"       # or [0, 45]; so with l2, minor_radius and spacing
  l2 = [-0.125, 0]
  cell = \"auto\"                 # as in `maille characterize`; effort, starts and seed, too
  [[designs]]
  design = \"1.1\"                # built in, or a file beside the study
  minor_radius = \"0.04:0.12:0.02\"
  spacing = [0.95, 1]           # of the elements, in that of the design
  [designs.vary]                # any other number, by its place; * stands for anything
  \"elements.standing-*.rings.major_radius\" = [0.5, 0.75, 1]
  \"lattice.a1.x\" = \"2.3:2.6:0.1\"

Exit codes: 0 every limit was found or proved not to be there, 5 the records are written but some limits were not \
found or some designs could not be used, 130 interrupted.")]
pub struct Args {
    /// The study, a TOML file
    #[arg(required_unless_present = "example")]
    study: Option<PathBuf>,
    #[command(flatten)]
    run: RunArgs,
    /// Print a study to begin with
    #[arg(long, exclusive = true)]
    example: bool,
    /// No progress and no summary
    #[arg(long, short)]
    quiet: bool,
}

const EXAMPLE: &str = "\
# How the limits of 1.1 and 3.1 change with the wire. All values in units of the in-plane ring's major radius.
directions = \"0:90:15\"
l2 = [-0.125, 0]

[[designs]]
design = \"1.1\"
minor_radius = \"0.04:0.12:0.04\"

[[designs]]
design = \"3.1\"
minor_radius = [0.05, 0.1]
";

/// One map of the study.
struct Planned {
    name: String,
    input: Input,
    map: Map,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let Some(path) = &args.study else {
        output::print(EXAMPLE.as_bytes())?;
        return Ok(ExitCode::from(exit::DONE));
    };
    let study = read(path)?;
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let out = args.run.out.clone().unwrap_or_else(|| Path::new("maille-out").join(file_name(&stem)));
    let plan = plan(&study, path.parent().unwrap_or(Path::new("")), &out, args.run.overwrite)?;
    output::folder(&out, "a folder is written")?;
    let _lock = FolderLock::take(&out)?;
    let mut open: Vec<(&str, OpenMap)> = Vec::new();
    let mut unused = Vec::new();
    for planned in &plan {
        match map::open(&planned.map, &planned.input) {
            Ok(map) => open.push((&planned.name, map)),
            Err(report) if remedy::code(&report) == exit::DESIGN => unused.push((&planned.name, report)),
            Err(report) => return Err(report),
        }
    }
    let used: Vec<PathBuf> = open.iter().filter_map(|(_, map)| map.folder().map(Path::to_owned)).collect();
    let begun = Instant::now();
    let Solved { records, tally, total, interrupted } = map::solve(open, &out, args.run.threads, args.quiet)?;
    if !used.is_empty() {
        let name = |(folder, record): (&PathBuf, _)| NamedRecord { name: records::name(folder), record };
        let named: Vec<NamedRecord> = used.iter().zip(records).map(name).collect();
        let table = Table::new(&named, Field::all(true));
        output::write(&out.join("limits.csv"), table.csv().as_bytes())?;
    }
    let Tally { there, now, unanswered } = tally;
    if !args.quiet {
        for (name, report) in &unused {
            eprintln!("{name} could not be used:\n{report:?}");
        }
        let seconds = begun.elapsed().as_secs_f64();
        let of_total = if there < total { format!(" of {total}") } else { String::new() };
        say!(
            "{there}{of_total} limits are in {} records, {now} of them now in {seconds:.1} s; {unanswered} were not found",
            used.len()
        );
        say!("all rows are in {}", out.join("limits.csv").display());
    }
    Ok(exit::ended(interrupted, unanswered > 0 || !unused.is_empty(), args.quiet))
}

fn read(path: &Path) -> Result<Study> {
    if path.is_dir() {
        return Err(wrong(exit::USAGE, format!("{} is a folder, not a study", path.display()), "give a TOML file"));
    }
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            let help = "a study is a TOML file that names designs: `maille sweep --example > my-study.toml` writes one; `maille \
                        characterize` takes a design itself";
            return Err(wrong(exit::USAGE, format!("there is no study {}", path.display()), help));
        }
        Err(e) => return Err(e).into_diagnostic().wrap_err_with(|| format!("cannot read {}", path.display())),
    };
    Ok(Study::read(&path.display().to_string(), &text)?)
}

/// Every map of the study.
fn plan(study: &Study, folder: &Path, out: &Path, overwrite: bool) -> Result<Vec<Planned>> {
    let mut plan: Vec<Planned> = Vec::new();
    for of_study in &study.designs {
        let StudyDesign { design, .. } = of_study;
        let file = folder.join(design);
        let design = if builtin(design).is_some() { design.clone() } else { file.display().to_string() };
        let input = Input::read(&design, None)?;
        for variant in of_study.variants() {
            let name = file_name(&input.design.name) + &variant.suffix;
            if plan.iter().any(|known| known.name == name) {
                let help = "name each design and value once";
                return Err(wrong(exit::USAGE, format!("{name} is in the study twice"), help));
            }
            let map = study.map(Some(out.join("records").join(&name)), overwrite);
            plan.push(Planned { name, input: input.varied(&variant)?, map });
        }
    }
    Ok(plan)
}
