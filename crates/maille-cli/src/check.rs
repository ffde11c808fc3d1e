//! `maille check`: design files, validated without solving.

use crate::{
    exit,
    input::{Input, Setting, problems},
    output, remedy,
    watch::watch,
};
use maille::{lattice::Cell, topology};
use maille_io::ListedProblem;
use miette::{Report, Result};
use serde::Serialize;
use serde_json::json;
use std::process::ExitCode;

/// Design files, checked without solving
///
/// Reads each file, compiles it, and looks for overlap. What is wrong is shown with its line; --json lists it for scripts.
/// Warnings name what can be solved but is odd: elements that nothing is linked to, elements of one shape with unequal numbers of
/// neighbours, a sheet that does not hold together, an unknown unit.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille check my-weave.toml
  maille check designs/*.toml --quiet && echo all can be solved
  maille check --watch my-weave.toml
  maille new x --weave kings-mail --wire 16swg --id 7/16in -o - | maille check -

Exit codes: 0 all can be solved, perhaps with warnings; 3 one is wrong or missing.")]
pub struct Args {
    /// TOML files, built-in designs, or - for standard input
    #[arg(required = true, value_name = "FILE")]
    designs: Vec<String>,
    /// A value for a parameter of the designs' files, as radius=5.0; several with commas
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    set: Vec<Setting>,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// Check again whenever a file is saved
    #[arg(long)]
    watch: bool,
    /// Print only what is wrong
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    match args.watch {
        true => watch(&args.designs, || once(args)),
        false => once(args),
    }
}

fn once(args: &Args) -> Result<ExitCode> {
    let (mut files, mut worst) = (Vec::new(), exit::DONE);
    for name in &args.designs {
        match check(name, &args.set) {
            Ok(found) => {
                if !args.json {
                    for warning in &found.warnings {
                        eprintln!("{}", line(name, warning));
                    }
                }
                if !args.json && !args.quiet {
                    output::say!("{name}: {}", words(&found));
                }
                files.push(json!(found));
            }
            Err(report) => {
                worst = worst.max(remedy::code(&report));
                if !args.json {
                    eprintln!("{report:?}");
                }
                files.push(json!({ "file": name, "ok": false, "problems": problems(&report), "warnings": [] }));
            }
        }
    }
    if args.json {
        output::print_json(&json!({ "files": files }))?;
    }
    Ok(ExitCode::from(worst))
}

/// What is told of a file that can be solved.
#[derive(Serialize)]
struct Found {
    file: String,
    ok: bool,
    problems: [(); 0],
    warnings: Vec<ListedProblem>,
    design: String,
    unit: Option<String>,
    elements: usize,
    rings: usize,
    links: usize,
    smallest_gap: Option<f64>,
    bound: bool,
}

fn check(name: &str, settings: &[Setting]) -> Result<Found, Report> {
    let input = Input::read_with(name, settings, None)?;
    let model = input.compile(&input.design, Cell::PRIMITIVE)?;
    Ok(Found {
        file: name.to_owned(),
        ok: true,
        problems: [],
        warnings: input.warnings(&model),
        elements: model.elements.len(),
        rings: model.rings.len(),
        links: model.links.len(),
        smallest_gap: model.starting_gap().map(|(gap, _)| gap),
        bound: !topology::binding_vectors(&model).is_empty(),
        design: input.design.name,
        unit: input.design.unit,
    })
}

/// `my-weave.toml:17: warning: …`.
fn line(name: &str, warning: &ListedProblem) -> String {
    let place = warning.line.map_or(String::new(), |line| format!("{line}:"));
    let help = warning.help.as_ref().map_or(String::new(), |help| format!("\n  help: {help}"));
    format!("{name}:{place} warning: {}{help}", warning.problem)
}

fn words(found: &Found) -> String {
    let unit = found.unit.as_ref().map_or(String::new(), |u| format!(" {u}"));
    let gap = match found.smallest_gap {
        Some(gap) if gap < 0.0 => format!(", overlap {:.6}{unit} (allowed by the file)", -gap),
        Some(gap) => format!(", smallest gap {gap:.6}{unit}"),
        None => String::new(),
    };
    let warnings = match found.warnings.len() {
        0 => String::new(),
        1 => " with 1 warning".into(),
        n => format!(" with {n} warnings"),
    };
    let [rings, links] =
        [(found.rings, "ring"), (found.links, "link")].map(|(count, what)| output::counted(count, what));
    format!("OK{warnings}; {rings}, {links} per cell{gap}")
}
