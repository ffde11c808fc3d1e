//! `maille reproduce`: which maps chapter 6 of the thesis needs, and the files that are made of their records.

use crate::{
    exit::{self, wrong},
    input::Input,
    map::{self, Solved, Tally, pool},
    output::{self, say},
    records,
};
use maille::{
    design::{Design, Source},
    lattice::Cell,
    model::Model,
    relaxation::{limit::EnergyOptions, target::Protocol},
    search::ExactOptions,
    survey::{CellChoice, MapQuestion, Method},
};
use maille_io::{
    DesignSource, chapter6,
    plot::Quantity,
    record::{FolderLock, NamedRecord},
    report::{self, MINIMA, MINIMA_DEG, NOTCHED, SCALED, STEPS, Sheet, Verdict, figures, page, sheet_png, statements},
    run::Map,
};
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde_json::json;
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Chapter 6 of the thesis computed anew, as one page
///
/// Writes a folder with index.html (each statement beside what was measured), figures/, sheets/ (pictures of the designs),
/// statements.json, and records/ with one record for each design, radius and method, as `maille characterize` writes
/// them. A run that was stopped goes on where it was with the same command.
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

/// Designs of the thesis, in its order.
const DESIGNS: [&str; 13] = ["1.1", "1.2", "1.3", "2", "3.1", "3.2", "3.3", "3.4", "4.1", "4.2", "4.3", "5.1", "5.2"];
/// Divisors of R: the minor radii of the thesis.
const DIVISORS: [u32; 2] = [10, 20];
/// The rectangular cell of a triangular lattice.
const RECTANGULAR: &str = "1,0;-1,2";
/// Two cells of 3.x and the thesis's corner distances, with a threshold as large as a plot can show.
const CORNERS_TAU: f64 = 0.1;
/// Between markers of the energy method on exact curves, and where directions are few.
const MARKERS_DEG: f64 = 15.0;
/// Statement 5: 1.1 in another size. No power of two, so that rounding differs.
const SCALE: (&str, f64) = ("1.1", 7.3);

const L2: [f64; 6] = [-0.375, -0.25, -0.125, 0.0, 0.125, 0.25];
/// l2 of the energy method where only its cost is asked.
const COST_L2: [f64; 3] = [-0.25, 0.0, 0.25];
/// Pulls of which every step is kept (Figure 6.1): the designs, with --quick those of the first two, the direction and l2.
const STEPPED: [&str; 4] = ["1.1", "3.1", "2", "5.2"];
const STEPPED_DEG: f64 = 30.0;
const STEPPED_L2: [f64; 2] = [-0.25, 0.25];

/// A design of the chapter.
struct Chosen {
    /// Its name in the thesis, which its records have.
    name: &'static str,
    design: Design,
    /// The file that it was given by.
    given: Option<PathBuf>,
}

/// A map with its design.
struct Planned {
    name: String,
    input: Input,
    map: Map,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let chosen = chosen(&args.only, args.designs.as_deref())?;
    let usual = if args.quick { "reproduction-quick" } else { "reproduction" };
    let out = args.out.clone().unwrap_or_else(|| usual.into());
    output::folder(&out, "a folder is written")?;
    let plan = plan(&chosen, args.quick, &out)?;
    let _lock = FolderLock::take(&out)?;
    let open = plan.iter().map(|p| Ok((p.name.as_str(), map::open(&p.map, &p.input)?))).collect::<Result<Vec<_>>>()?;
    let Solved { tally: Tally { there, now, unanswered }, total, interrupted, .. } =
        map::solve(open, &out, args.threads, args.quiet)?;
    if interrupted {
        if !args.quiet {
            eprintln!("{there} of {total} limits are in the records, {now} of them now");
            eprintln!("interrupted; the same command goes on from here");
        }
        return Ok(ExitCode::from(exit::INTERRUPTED));
    }
    let records = records::read(&plan.iter().filter_map(|p| p.map.out.clone()).collect::<Vec<_>>())?;
    let findings = pool(args.threads)?.install(|| write(&out, &chosen, args.quick, &records))?;
    if !args.quiet {
        for finding in &findings {
            say!("statement {}: {}", finding.number, finding.verdict.words());
        }
        let unmeasured = findings.iter().filter(|f| f.verdict == Verdict::NotMeasured).count();
        if unmeasured > 0 {
            say!("{unmeasured} need other designs than these");
        }
        say!("{there} limits are in {} records, {now} of them now; {unanswered} were not found", plan.len());
        say!("look at {}", out.join("index.html").display());
    }
    Ok(ExitCode::from(if unanswered > 0 { exit::INCOMPLETE } else { exit::DONE }))
}

/// The designs that are asked for, in the order of the thesis, those of `folder` before the built-in ones.
fn chosen(names: &[String], folder: Option<&Path>) -> Result<Vec<Chosen>> {
    if let Some(unknown) = names.iter().find(|name| !DESIGNS.contains(&name.as_str())) {
        return Err(wrong(
            exit::USAGE,
            format!("\"{unknown}\" is no design of chapter 6"),
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
            Ok(Chosen { name, design: Design { name: name.into(), ..source.read()? }, given: file })
        })
        .collect()
}

/// The files of a folder that are named as designs of the thesis; refused where there is none, or another TOML file.
fn given(folder: &Path) -> Result<Vec<PathBuf>> {
    let names =
        || format!("name its files as in the thesis: {}", DESIGNS.map(|name| format!("{name}.toml")).join(", "));
    let entries = std::fs::read_dir(folder)
        .map_err(|e| wrong(exit::USAGE, format!("{} is no folder that can be read: {e}", folder.display()), names()))?;
    let mut files = Vec::new();
    for entry in entries {
        let file = entry.into_diagnostic()?.path();
        if file.extension().is_some_and(|extension| extension == "toml") {
            if !file.file_stem().is_some_and(|stem| DESIGNS.iter().any(|name| stem == *name)) {
                return Err(wrong(exit::USAGE, format!("{} is no design of chapter 6", file.display()), names()));
            }
            files.push(file);
        }
    }
    if files.is_empty() {
        return Err(wrong(exit::USAGE, format!("{} has no design of chapter 6", folder.display()), names()));
    }
    Ok(files)
}

/// Every map of the run.
fn plan(chosen: &[Chosen], quick: bool, out: &Path) -> Result<Vec<Planned>> {
    let step = if quick { 15.0 } else { 7.5 };
    let turn = |step: f64| -> Vec<f64> { (0..(180.0 / step) as u32).map(|k| step * f64::from(k)).collect() };
    let rectangular: Cell = RECTANGULAR.parse().map_err(|e| miette!("{e:?}"))?;
    let exact = || Method::Exact(ExactOptions::default());
    let energy = || Method::Energy(EnergyOptions::default());
    let records = out.join("records");
    let mut plan: Vec<Planned> = Vec::new();
    let mut add =
        |design: Design, divisor: u32, words: &str, method: Method, cell, directions_deg: Vec<f64>, l2: &[f64]| {
            let name = format!("{}-R{divisor}-{words}", design.name);
            let minor_radius = design.reference_radius / f64::from(divisor);
            let input = Input::of(design.with_minor_radius(minor_radius));
            let map = Map {
                question: MapQuestion { method, cells: CellChoice::from(cell), directions_deg, l2: l2.to_vec() },
                quantity: Quantity::Lambda1,
                out: Some(records.join(&name)),
                overwrite: false,
            };
            plan.push(Planned { name, input, map });
        };
    let own = Cell::PRIMITIVE;
    for Chosen { name, design, .. } in chosen {
        let name = *name;
        let l2 = if ["1.1", "1.2"].contains(&name) { &L2[..] } else { &L2[1..] };
        let by_text = design.source == Source::ThesisText;
        let sheared = name.starts_with("3.");
        for divisor in DIVISORS {
            add(design.clone(), divisor, "exact", exact(), own, turn(step), l2);
            if sheared && !(quick && name == "3.4") {
                add(design.clone(), divisor, "exact-rectangular", exact(), rectangular, turn(step), l2);
            }
            if NOTCHED.contains(&name) {
                add(design.clone(), divisor, &format!("exact{MINIMA}"), exact(), own, MINIMA_DEG.to_vec(), l2);
            }
            if by_text && !quick {
                add(design.clone(), divisor, "energy", energy(), own, turn(MARKERS_DEG), l2);
            }
            if by_text && sheared && !quick {
                let (directions, l2) = (turn(MARKERS_DEG), [-0.25, 0.0]);
                add(design.clone(), divisor, "energy-rectangular", energy(), rectangular, directions, &l2);
            }
        }
        if STEPPED[..if quick { 2 } else { 4 }].contains(&name) {
            let method = Method::Energy(EnergyOptions { steps: true, ..EnergyOptions::default() });
            add(design.clone(), 10, &format!("energy{STEPS}"), method, own, vec![STEPPED_DEG], &STEPPED_L2);
        }
        // The energy method's cost alone.
        if if quick { ["1.1", "3.1"].contains(&name) } else { !by_text } {
            add(design.clone(), 10, "energy", energy(), own, turn(30.0), &COST_L2);
        }
        if ["3.1", "3.2", "3.3"].contains(&name) && !(quick && name != "3.1") {
            let corners = || {
                let options =
                    EnergyOptions { protocol: Protocol::Corners, tau: CORNERS_TAU, ..EnergyOptions::default() };
                Method::Energy(options)
            };
            // The peaks and 10° beside them tell whether one is wider.
            let peaks = [30.0, 90.0, 150.0].map(|peak| [peak - 10.0, peak, peak + 10.0]).concat();
            let (directions, l2) = if quick { (peaks, &[0.0][..]) } else { (turn(MARKERS_DEG), &L2[1..]) };
            add(design.clone(), 10, "corners", corners(), own, directions.clone(), l2);
            add(design.clone(), 10, "corners-rectangular", corners(), rectangular, directions, l2);
        }
        if name == SCALE.0 {
            let name = design.name.clone() + SCALED;
            add(Design { name, ..design.scaled(SCALE.1) }, 10, "exact", exact(), own, turn(15.0), &[-0.25, 0.0]);
        }
    }
    Ok(plan)
}

/// Pixels of a sheet's picture.
const PICTURE: [u32; 2] = [480, 360];

/// Writes page, figures, pictures and verdicts.
fn write(out: &Path, chosen: &[Chosen], quick: bool, records: &[NamedRecord]) -> Result<Vec<report::Finding>> {
    let maps: Vec<report::Map> = records
        .iter()
        .map(|named| {
            report::Map::of(named).map_err(|e| miette!("the design of {} cannot be compiled: {e:?}", named.name))
        })
        .collect::<Result<_>>()?;
    let findings = statements(&maps);
    let figures = figures(records, &maps);
    let [drawn, pictures] = ["figures", "sheets"].map(|name| out.join(name));
    [out, &drawn, &pictures].into_iter().try_for_each(output::remove_leftovers)?;
    for figure in &figures {
        output::write(&drawn.join(format!("{}.svg", figure.file)), figure.svg.as_bytes())?;
    }
    let mut sheets = Vec::new();
    for Chosen { name, design, given } in chosen {
        let png = sheet_png(design, PICTURE).into_diagnostic().wrap_err_with(|| format!("cannot draw {name}"))?;
        output::write(&pictures.join(format!("{name}.png")), &png)?;
        let model = Model::compile(design, Cell::PRIMITIVE).map_err(|e| miette!("{name} cannot be compiled: {e:?}"))?;
        sheets.push(Sheet {
            name: design.name.clone(),
            title: design.title.clone(),
            source: design.source,
            given: given.as_ref().map(|file| file.display().to_string()),
            counts: [model.elements.len(), model.links.len()],
            png,
        });
    }
    let text = serde_json::to_string_pretty(&json!({ "statements": findings })).into_diagnostic()?;
    output::write(&out.join("statements.json"), format!("{text}\n").as_bytes())?;
    let command = if quick { "maille reproduce --quick" } else { "maille reproduce" };
    let given: Vec<&str> = chosen.iter().filter(|design| design.given.is_some()).map(|design| design.name).collect();
    let coordinates = match given.len() {
        0 => "All coordinates are ours: the thesis's pictures of its designs are lost, and its text gives no numbers."
            .into(),
        n if n == chosen.len() => "All designs were given.".into(),
        _ => format!("Given were {}; the coordinates of the others are ours.", given.join(", ")),
    };
    let words = format!(
        "Made by {command}, version {}, from {} records with {} limits of {} designs. Limits are those of each design's \
         own cell, as in the thesis. {coordinates}",
        env!("CARGO_PKG_VERSION"),
        records.len(),
        maps.iter().map(|map| map.rows.len()).sum::<usize>(),
        chosen.len(),
    );
    output::write(&out.join("index.html"), page(&words, &findings, &sheets, &maps, &figures).as_bytes())?;
    Ok(findings)
}
