//! `maille check`: design files, validated without solving.

use crate::{
    exit,
    input::{Input, problems},
    output, remedy,
    watch::watch,
};
use maille::{lattice::Cell, topology};
use miette::{Report, Result};
use serde_json::{Value, json};
use std::process::ExitCode;

/// Design files, checked without solving
///
/// Reads each file, compiles it, and looks for overlap. What is wrong is shown with its line; --json lists it for scripts.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille check my-weave.toml
  maille check designs/*.toml --quiet && echo all right
  maille check --watch my-weave.toml
  maille new x --weave kings-mail --wire 16swg --id 7/16in -o - | maille check -

Exit codes: 0 all are right, 3 one is wrong or missing.")]
pub struct Args {
    /// TOML files, built-in designs, or - for standard input
    #[arg(required = true, value_name = "FILE")]
    designs: Vec<String>,
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
        match check(name) {
            Ok(found) => {
                if !args.json && !args.quiet {
                    output::say!("{name}: {}", words(&found));
                }
                files.push(found);
            }
            Err(report) => {
                worst = worst.max(remedy::code(&report));
                if !args.json {
                    eprintln!("{report:?}");
                }
                files.push(json!({ "file": name, "ok": false, "problems": problems(&report) }));
            }
        }
    }
    if args.json {
        output::print_json(&json!({ "files": files }))?;
    }
    Ok(ExitCode::from(worst))
}

fn check(name: &str) -> Result<Value, Report> {
    let input = Input::read(name, None)?;
    let model = input.compile(&input.design, Cell::PRIMITIVE)?;
    let gap = topology::smallest_gap(&model, &model.start).map(|(gap, _)| gap * model.unit);
    Ok(json!({
        "file": name,
        "ok": true,
        "problems": [],
        "design": input.design.name,
        "unit": input.design.unit,
        "elements": model.elements.len(),
        "rings": model.rings.len(),
        "links": model.links.len(),
        "smallest_gap": gap,
        "bound": !topology::binding_vectors(&model).is_empty(),
    }))
}

fn words(found: &Value) -> String {
    let gap = match found["smallest_gap"].as_f64() {
        Some(gap) if gap < 0.0 => format!(", overlap {:.6} (allowed by the file)", -gap),
        Some(gap) => format!(", smallest gap {gap:.6}"),
        None => String::new(),
    };
    let unit = found["unit"].as_str().map_or(String::new(), |u| format!(" {u}"));
    let free = match found["bound"].as_bool() {
        Some(true) => "",
        _ => "; no chain of links joins the cells: no pull has a bound",
    };
    format!("right; {} rings, {} links a cell{gap}{unit}{free}", found["rings"], found["links"])
}
