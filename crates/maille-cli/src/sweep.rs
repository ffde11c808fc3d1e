//! `maille sweep`: the maps of a study.

use crate::{
    exit::{self, wrong},
    input::{Input, file_name},
    map::{self, RunArgs, Solved, Tally},
    output::{self, counted, say},
    records, remedy,
};
use maille_io::{
    builtin,
    record::{FolderLock, Mark, NamedRecord, RECORDS},
    run::{Map, OpenMap},
    study::{Study, StudyDesign},
    table::{Field, Table},
};
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

/// Limits of many designs, radii, spacings, or any other numbers of a design
///
/// Writes a folder: records/ with one record for each design and its parameters, as `maille characterize` writes them, and
/// limits.csv with the rows of all. What varies is in columns of limits.csv. All cores work until the last limit. The same command
/// continues a run that was stopped (Ctrl-C, SIGTERM, or a crash).
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille sweep --example > radius.toml
  maille sweep radius.toml
  maille table radius --where direction=45
  maille plot radius --where l2=0

A study:
  directions = \"0:180:15\"       # or [0, 45]; so with l2, minor_radius and spacing
  l2 = [-0.125, 0]
  keep_links = true             # leave values out with which rings are linked otherwise
  cell = \"auto\"                 # as in `maille characterize`; also effort, starts, seed
  [[designs]]
  design = \"1.1\"                # built in, or a file beside the study
  minor_radius = \"0.04:0.12:0.02\"
  spacing = [0.95, 1]           # factor of all distances between elements
  [designs.vary]                # any other number, by its place; * stands for anything
  \"elements.standing-*.rings.major_radius\" = [0.5, 0.75, 1]
  \"lattice.a1.x\" = \"2.3:2.6:0.1\"
  [[designs]]
  design = \"1.1\"
  name = \"1.1-free\"             # of its records; needed where a design stands twice
  lateral = \"free\"              # so with shear, compression = true, directions and l2:
  directions = \"0:90:5\"         # a design's own, or, above, those of all designs

Exit codes:
    0  every limit was found, or it was proved that there is none
    5  the records are written, but some limits were not found
    6  some designs could not be used; the records of the others are written
  130  interrupted")]
pub struct Args {
    /// The study, a TOML file
    #[arg(required_unless_present = "example")]
    study: Option<PathBuf>,
    /// Folder that is written [default: maille-out/STUDY]
    #[arg(long)]
    out: Option<PathBuf>,
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

/// The maps of a study, and the designs that cannot be used, with the reason.
struct Plan {
    maps: Vec<Planned>,
    unused: Vec<(String, Report)>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let Some(path) = &args.study else {
        output::print(EXAMPLE.as_bytes())?;
        return Ok(ExitCode::from(exit::DONE));
    };
    let study = read(path)?;
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let out = args.out.clone().unwrap_or_else(|| Path::new("maille-out").join(file_name(&stem)));
    let Plan { maps, mut unused } = plan(&study, path.parent().unwrap_or(Path::new("")), &out, args.run.overwrite)?;
    if maps.is_empty() {
        tell(unused);
        return Ok(ExitCode::from(exit::LEFT_OUT));
    }
    output::folder(&out, "a folder is written")?;
    let _lock = FolderLock::take(&out, &[Mark::Records])?;
    let mut open: Vec<(&str, OpenMap)> = Vec::new();
    for planned in &maps {
        match map::open(&planned.map, &planned.input) {
            Ok(map) => open.push((&planned.name, map)),
            Err(report) if remedy::code(&report) == exit::DESIGN => unused.push((planned.name.clone(), report)),
            Err(report) => {
                tell(unused);
                return Err(report);
            }
        }
    }
    let used: Vec<PathBuf> = open.iter().filter_map(|(_, map)| map.folder().map(Path::to_owned)).collect();
    let begun = Instant::now();
    let Solved { records, tally, total, interrupted } = map::solve(open, &out, args.run.threads, args.quiet)?;
    if !used.is_empty() {
        let name = |(folder, record): (&PathBuf, _)| NamedRecord {
            name: records::name(folder),
            record,
            sensitivities: Vec::new(),
        };
        let named: Vec<NamedRecord> = used.iter().zip(records).map(name).collect();
        let table = Table::new(&named, Field::all(&named, true));
        output::write(&out.join("limits.csv"), table.csv().as_bytes())?;
    }
    let Tally { there, now, unanswered } = tally;
    if !args.quiet && !used.is_empty() {
        let seconds = begun.elapsed().as_secs_f64();
        let limits = if there < total { format!("{there} of {total} limits") } else { counted(there, "limit") };
        say!("{limits} in {}, {now} of them now, in {seconds:.1} s", counted(used.len(), "record"));
        say!("all rows are in {}", out.join("limits.csv").display());
        if unanswered > 0 {
            let (limits, folder) = (counted(unanswered, "limit"), output::quoted(&out.display().to_string()));
            say!(
                "{limits} not found: `maille table {folder} --where l1=none` shows which, docs/guide/certificates.md what to try"
            );
        }
    }
    let code = if unused.is_empty() { args.run.code(unanswered > 0) } else { exit::LEFT_OUT };
    tell(unused);
    Ok(exit::ended(interrupted, code, args.quiet))
}

/// Designs that could not be used are errors: told even if nothing else is, and last.
pub fn tell(unused: Vec<(String, Report)>) {
    // One mistake can keep many variants from use: said once.
    let mut said: Vec<(Vec<String>, String)> = Vec::new();
    for (name, report) in unused {
        let text = format!("{:?}", remedy::added(report));
        match said.iter_mut().find(|(_, known)| *known == text) {
            Some((names, _)) => names.push(name),
            None => said.push((vec![name], text)),
        }
    }
    for (names, text) in said {
        let others = match names.len() - 1 {
            0 => String::new(),
            n => format!(" and {}", counted(n, "other")),
        };
        eprintln!("{}{others} could not be used:\n{text}", names[0]);
    }
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

/// Every map of the study. Designs that cannot be used stop nothing.
fn plan(study: &Study, folder: &Path, out: &Path, overwrite: bool) -> Result<Plan> {
    let mut plan = Plan { maps: Vec::new(), unused: Vec::new() };
    for of_study in &study.designs {
        let StudyDesign { design, name, .. } = of_study;
        let file = folder.join(design);
        let found = if builtin(design).is_some() { design.clone() } else { file.display().to_string() };
        let input = match Input::read(&found) {
            Ok(input) => input,
            Err(report) => {
                plan.unused.push((design.clone(), report));
                continue;
            }
        };
        for variant in of_study.variants() {
            let name = file_name(name.as_deref().unwrap_or(&input.design.name)) + &variant.suffix;
            if plan.maps.iter().any(|known| known.name == name) {
                let help = "name each design and value once, or give one of them another `name`";
                return Err(wrong(exit::USAGE, format!("{name} is in the study twice"), help));
            }
            match input.varied(&variant) {
                Ok(input) => {
                    let map = of_study.map(Some(out.join(RECORDS).join(&name)), overwrite);
                    plan.maps.push(Planned { name, input, map });
                }
                Err(report) => plan.unused.push((name, report)),
            }
        }
    }
    Ok(plan)
}
