//! `maille characterize`: limits over directions and lateral strains, written as a record.

use crate::{
    input::{Input, file_name},
    numbers::{Numbers, parse, parse_l2, positive},
    plot::Shown,
    progress::Progress,
};
use maille::{
    characterize::{Finished, Method, Task, characterize, tasks},
    energy::{HessianMethod, MinimaMethod, target::Protocol},
    lattice::Cell,
    limit::{energy::EnergyOptions, exact::ExactOptions},
    model::Model,
    record::{LimitRow, StateRecord, Status},
};
use maille_io::{
    plot::{PolarPlot, parameter_words, polar_svg, svg_to_png},
    record::RecordFolder,
};
use miette::{IntoDiagnostic, Result, WrapErr};
use serde_json::json;
use std::{
    path::PathBuf,
    process::ExitCode,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

/// How far a sheet stretches in each direction before it locks
///
/// Writes a record, a folder with limits.csv (one row a limit), states.jsonl (the poses at every limit), polar.svg and
/// polar.png (stretch against direction) and run.json (all that is needed to repeat the run). A rerun with the same
/// inputs goes on where the last one stopped.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille characterize 1.1
  maille characterize 3.1 --directions 0:180:5 --l2 -0.25,-0.125,0
  maille characterize 1.2 --minor-radius 0.05 --quantity lambda1
  maille characterize 3.1 --method energy --cell \"1,0;-1,2\" --protocol corners --tau 0.1 --out corners-3.1
  maille characterize my-weave.toml --out results/my-weave")]
pub struct Args {
    /// A built-in design (see `maille designs`) or a TOML file
    design: String,
    /// Directions of the pull, degrees counter-clockwise from x: a list, or first:last:step
    #[arg(long, default_value = "0:180:5", value_parser = parse, allow_hyphen_values = true)]
    directions: Numbers,
    /// Stretch - 1 held across the pull: a list, or first:last:step
    #[arg(long, default_value = "-0.25:0.25:0.125", value_parser = parse_l2, allow_hyphen_values = true)]
    l2: Numbers,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive)]
    minor_radius: Option<f64>,
    /// How a limit is found
    #[arg(long, value_enum, default_value_t = MethodArg::Exact)]
    method: MethodArg,
    /// Cell: 1x1, 2x1, 2x2, …, an integer matrix as "1,0;-1,2", or auto: 1x1, and larger cells where an element
    /// presses on its own image (exact method)
    #[arg(long, default_value = "auto", value_parser = cell_choice)]
    cell: CellChoice,
    /// What polar.svg and polar.png show
    #[arg(long, value_enum, default_value_t = Shown::Stretch)]
    quantity: Shown,
    /// Folder of the record [default: maille-out/DESIGN]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace a record of other inputs in that folder
    #[arg(long)]
    overwrite: bool,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// No progress and no summary
    #[arg(long, short)]
    quiet: bool,
    /// Exact method: starts of a limit whose bound is not attained
    #[arg(long, default_value_t = ExactOptions::default().starts, value_parser = |t: &str| small(t, 10_000))]
    starts: usize,
    #[command(flatten, next_help_heading = "Energy method (lengths in units of the reference radius R)")]
    energy: EnergyArgs,
}

#[derive(clap::Args)]
struct EnergyArgs {
    /// How the deformation is imposed: on F itself, or on the cell's corners as in the thesis (biased in sheared cells)
    #[arg(long, value_enum, default_value_t = ProtocolArg::Strain)]
    protocol: ProtocolArg,
    /// Weight of the contacts against the targets, alpha/beta
    #[arg(long, default_value_t = EnergyOptions::default().alpha, value_parser = positive)]
    alpha: f64,
    /// Threshold on |F - F_target|, or on a corner's distance
    #[arg(long, default_value_t = EnergyOptions::default().tau, value_parser = positive)]
    tau: f64,
    /// Step of l1 before the bisection
    #[arg(long, default_value_t = EnergyOptions::default().l1_step, value_parser = positive)]
    l1_step: f64,
    /// Width of l1 at which the bisection stops
    #[arg(long, default_value_t = EnergyOptions::default().l1_resolution, value_parser = positive)]
    l1_resolution: f64,
    /// Sampled points on each side of a contact
    #[arg(long, default_value_t = EnergyOptions::default().samples, value_parser = |t: &str| small(t, 50))]
    samples: usize,
    /// Spacing of the sampled points in radians [default: from the expected overlap]
    #[arg(long, value_parser = positive)]
    sample_spacing: Option<f64>,
    /// Second derivatives: formulas, or the thesis's finite differences
    #[arg(long, value_enum, default_value_t = HessianArg::Analytic)]
    hessian: HessianArg,
    /// Minima of the circle-circle distance: complete enumeration, or the thesis's polynomial
    #[arg(long, value_enum, default_value_t = MinimaArg::Enumeration)]
    minima: MinimaArg,
}

/// `auto`, or one cell.
#[derive(Clone, Copy)]
enum CellChoice {
    Auto,
    One(Cell),
}

/// Cells that `auto` may go on to, in this order.
const LARGER: [&str; 4] = ["2x1", "1x2", "2x2", "3x3"];
/// Elements in a cell that `auto` goes on to, at most.
const MOST_ELEMENTS: usize = 40;

fn cell_choice(text: &str) -> Result<CellChoice, String> {
    match text {
        "auto" => Ok(CellChoice::Auto),
        _ => text
            .parse()
            .map(CellChoice::One)
            .map_err(|e: maille::error::InvalidInput| format!("{}; {}", e.problem, e.help)),
    }
}

impl CellChoice {
    /// The cells to compile: for the energy method `auto` is the design's own.
    fn cells(self, method: MethodArg, elements: usize) -> Vec<Cell> {
        match (self, method) {
            (CellChoice::One(cell), _) => vec![cell],
            (CellChoice::Auto, MethodArg::Energy) => vec![Cell::PRIMITIVE],
            (CellChoice::Auto, MethodArg::Exact) => {
                let larger = LARGER.iter().filter_map(|text| text.parse::<Cell>().ok());
                let larger = larger.filter(|cell| cell.copies() * elements <= MOST_ELEMENTS);
                std::iter::once(Cell::PRIMITIVE).chain(larger).collect()
            }
        }
    }
}

fn small(text: &str, most: usize) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if n <= most => Ok(n),
        _ => Err(format!("\"{text}\" is not a whole number from 0 to {most}")),
    }
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum MethodArg {
    /// Maximises l1 under all gaps, with a certificate and a proven bound
    Exact,
    /// The thesis's: an energy of contacts and targets, minimised
    Energy,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ProtocolArg {
    Strain,
    Corners,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum HessianArg {
    Analytic,
    FiniteDifference,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum MinimaArg {
    Enumeration,
    Polynomial,
}

impl EnergyArgs {
    fn options(&self, seed: u64) -> EnergyOptions {
        EnergyOptions {
            protocol: match self.protocol {
                ProtocolArg::Strain => Protocol::Strain,
                ProtocolArg::Corners => Protocol::Corners,
            },
            alpha: self.alpha,
            tau: self.tau,
            l1_step: self.l1_step,
            l1_resolution: self.l1_resolution,
            samples: self.samples,
            sample_spacing_rad: self.sample_spacing,
            hessian: match self.hessian {
                HessianArg::Analytic => HessianMethod::Analytic,
                HessianArg::FiniteDifference => HessianMethod::FiniteDifference,
            },
            minima: match self.minima {
                MinimaArg::Enumeration => MinimaMethod::Enumeration,
                MinimaArg::Polynomial => MinimaMethod::Polynomial,
            },
            seed,
            ..EnergyOptions::default()
        }
    }
}

/// The rows found so far, in the order of the tasks, and when they were last written.
struct Collected {
    folder: RecordFolder,
    rows: Vec<Option<(LimitRow, StateRecord)>>,
    written: Instant,
    failure: Option<miette::Report>,
}

/// A record is written at most this often while limits come in.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

impl Collected {
    fn finished(&self) -> (Vec<LimitRow>, Vec<StateRecord>) {
        self.rows.iter().flatten().cloned().unzip()
    }

    fn write(&mut self) -> Result<()> {
        let (rows, states) = self.finished();
        self.folder.write(&rows, &states)?;
        self.written = Instant::now();
        Ok(())
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let input = Input::read(&args.design, args.minor_radius)?;
    let cells = args.cell.cells(args.method, input.design.elements.len());
    let models: Vec<Model> = cells.iter().map(|cell| input.compile(&input.design, *cell)).collect::<Result<_>>()?;
    let method = match args.method {
        MethodArg::Exact => Method::Exact(ExactOptions { starts: args.starts.max(1), seed: args.seed }),
        MethodArg::Energy => Method::Energy(args.energy.options(args.seed)),
    };
    let parameters = json!({
        "method": method.name(),
        "cells": cells.iter().map(Cell::to_string).collect::<Vec<_>>(),
        "directions_deg": args.directions.0,
        "l2": args.l2.0,
        "options": match &method {
            Method::Exact(options) => json!(options.parameters()),
            Method::Energy(options) => json!(options.parameters(&models[0])),
        },
    });
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("maille-out").join(file_name(&input.design.name)));
    let version = env!("CARGO_PKG_VERSION");
    let (folder, old_rows, old_states) = RecordFolder::open(&out, &input.design, &parameters, version, args.overwrite)?;

    let all = tasks(&args.directions.0, &args.l2.0);
    let mut rows: Vec<Option<(LimitRow, StateRecord)>> = vec![None; all.len()];
    for (row, state) in old_rows.into_iter().zip(old_states) {
        if let Some(k) = all.iter().position(|t| (t.direction_deg, t.l2) == (row.direction_deg, row.l2)) {
            rows[k] = Some((row, state));
        }
    }
    let open: Vec<Task> = all.iter().zip(&rows).filter(|(_, row)| row.is_none()).map(|(task, _)| *task).collect();
    if !args.quiet {
        if maille::topology::binding_vectors(&models[0]).is_empty() {
            eprintln!("warning: no chain of links joins the cells of this design; every limit is unbounded");
        }
        if open.len() < all.len() {
            eprintln!("{} of {} limits are in {} already", all.len() - open.len(), all.len(), out.display());
        }
    }

    let cancel = Arc::new(AtomicBool::new(false));
    stop_on_interrupt(&cancel)?;
    let progress = Progress::new(open.len() as u64, args.quiet);
    let collected = Mutex::new(Collected { folder, rows, written: Instant::now(), failure: None });
    let receive = |found: Finished| {
        let row = &found.row;
        progress.step(format!("{}°, l2 = {}", row.direction_deg, row.l2));
        let mut collected = collected.lock().unwrap_or_else(|e| e.into_inner());
        if let Some(k) = all.iter().position(|t| (t.direction_deg, t.l2) == (row.direction_deg, row.l2)) {
            collected.rows[k] = Some((found.row, found.state));
        }
        if collected.written.elapsed() >= WRITE_INTERVAL
            && let Err(report) = collected.write()
        {
            collected.failure = Some(report);
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.map_or(0, usize::from))
        .build()
        .into_diagnostic()
        .wrap_err("cannot start the threads")?;
    let begun = Instant::now();
    let (directions, l2) = (&args.directions.0, &args.l2.0);
    let wanted = |task: Task| open.contains(&task);
    pool.install(|| {
        characterize(&models, input.design.minor_radius, &method, directions, l2, &wanted, &cancel, &receive)
    });
    progress.finish();
    let mut collected = collected.into_inner().unwrap_or_else(|e| e.into_inner());
    if let Some(report) = collected.failure {
        return Err(report.wrap_err("the record could not be written; the run has stopped"));
    }
    collected.write()?;

    let (rows, _) = collected.finished();
    let words = parameter_words(&parameters);
    let svg = polar_svg(&PolarPlot::from_rows(&input.design, &rows, args.quantity.into(), &words));
    let png = svg_to_png(&svg, 2.0).into_diagnostic().wrap_err("cannot draw the plot")?;
    collected.folder.write_polar(&svg, &png)?;
    let interrupted = cancel.load(Ordering::Relaxed);
    if !args.quiet {
        let solved = rows.iter().filter(|r| r.status != Status::Interrupted).count() - (all.len() - open.len());
        summary(&rows, solved, begun.elapsed(), &out);
        if interrupted {
            eprintln!("interrupted; the same command goes on from here");
        }
    }
    Ok(if interrupted { ExitCode::from(130) } else { ExitCode::SUCCESS })
}

/// The first Ctrl-C ends the run cleanly, the second at once.
fn stop_on_interrupt(cancel: &Arc<AtomicBool>) -> Result<()> {
    let cancel = Arc::clone(cancel);
    ctrlc::set_handler(move || {
        if cancel.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        eprintln!("\nstopping: finished limits are being written (Ctrl-C again ends at once)");
    })
    .into_diagnostic()
    .wrap_err("cannot listen for Ctrl-C")
}

/// Least and largest limit of each l2, what has no limit, and where the files are.
fn summary(rows: &[LimitRow], solved: usize, took: Duration, out: &std::path::Path) {
    let mut l2: Vec<f64> = rows.iter().map(|r| r.l2).collect();
    l2.sort_by(f64::total_cmp);
    l2.dedup();
    println!("{:>8}  {:>20}  {:>20}  {:>7}", "l2", "least l1", "largest l1", "limits");
    for l2 in l2 {
        let of: Vec<&LimitRow> = rows.iter().filter(|r| r.l2 == l2).collect();
        let mut found: Vec<(f64, f64)> = of.iter().filter_map(|r| Some((r.l1?, r.direction_deg))).collect();
        // Rounding decides nothing: of equal limits the first direction is named.
        found.sort_by(|a, b| (a.0 * 1e9).round().total_cmp(&(b.0 * 1e9).round()));
        let show = |x: Option<&(f64, f64)>| x.map_or("-".into(), |(l1, at)| format!("{l1:.4} at {at}°"));
        println!(
            "{l2:>8}  {:>20}  {:>20}  {:>3}/{:<3}",
            show(found.first()),
            show(found.iter().rev().take_while(|x| (x.0 - found[found.len() - 1].0).abs() < 1e-9).last()),
            found.len(),
            of.len()
        );
    }
    for status in Status::ALL {
        let count = rows.iter().filter(|r| r.status == status).count();
        if count > 0 {
            println!("{count} {}", status.name());
        }
    }
    println!(
        "{solved} limits in {:.1} s; {}, states.jsonl, run.json, polar.svg",
        took.as_secs_f64(),
        out.join("limits.csv").display()
    );
    println!("look at {}", out.join("polar.png").display());
}
