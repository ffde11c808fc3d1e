//! `maille characterize`: limits over directions and lateral strains, written as a record.

use crate::{
    exit::{self, wrong},
    input::{Input, file_name},
    interrupt,
    numbers::{Numbers, parse, parse_cell, parse_l2, positive},
    output,
    plot::Shown,
    progress::Progress,
    summary::Summary,
    watch::watch,
};
use maille::{
    characterize::{Finished, Method, Task, characterize, tasks},
    energy::{HessianMethod, MinimaMethod, barrier::ContactLaw, target::Protocol},
    lattice::Cell,
    limit::{
        energy::{EnergyOptions, Minimiser},
        exact::ExactOptions,
    },
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
        Mutex,
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
  maille characterize my-weave.toml --out results/my-weave
  maille characterize my-weave.toml --directions 0,45,90 --l2 0 --watch
  maille characterize 1.1 --json | jq '.limits[] | .largest.l1'

Exit codes: 0 every limit was found or proved not to be there, 5 the record is written but some were not found, \
130 interrupted.")]
pub struct Args {
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input
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
    /// Print the summary as one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// Compute again whenever the design file is saved; implies --overwrite
    #[arg(long)]
    watch: bool,
    /// No progress and no summary
    #[arg(long, short, conflicts_with = "json")]
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
    /// What an overlap costs: the barrier, or the square that the thesis rejects
    #[arg(long, value_enum, default_value_t = ContactLawArg::Barrier)]
    contact_law: ContactLawArg,
    /// Newton, or gradient descent, which the thesis rejects
    #[arg(long, value_enum, default_value_t = MinimiserArg::Newton)]
    minimiser: MinimiserArg,
    /// Refuse steps that flip a side sign of an element of several rings, as the thesis does
    #[arg(long)]
    side_signs: bool,
    /// Iterations of one minimisation at most
    #[arg(long, default_value_t = EnergyOptions::default().max_iterations, value_parser = |t: &str| small(t, 10_000_000))]
    max_iterations: usize,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ContactLawArg {
    Barrier,
    Quadratic,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum MinimiserArg {
    Newton,
    GradientDescent,
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
        _ => parse_cell(text).map(CellChoice::One),
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
            contact_law: match self.contact_law {
                ContactLawArg::Barrier => ContactLaw::Barrier,
                ContactLawArg::Quadratic => ContactLaw::Quadratic,
            },
            minimiser: match self.minimiser {
                MinimiserArg::Newton => Minimiser::Newton,
                MinimiserArg::GradientDescent => Minimiser::GradientDescent,
            },
            side_signs: self.side_signs,
            max_iterations: self.max_iterations,
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
    match args.watch {
        true => watch(std::slice::from_ref(&args.design), || once(args)),
        false => once(args),
    }
}

fn once(args: &Args) -> Result<ExitCode> {
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
    if out.is_file() {
        let help = "name another folder with --out";
        return Err(wrong(exit::USAGE, format!("{} is a file; a record is a folder", out.display()), help));
    }
    let version = env!("CARGO_PKG_VERSION");
    let (folder, old_rows, old_states) =
        RecordFolder::open(&out, &input.design, &parameters, version, args.overwrite || args.watch)?;

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

    let cancel = interrupt::flag()?;
    let cancel: &AtomicBool = &cancel;
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
        characterize(&models, input.design.minor_radius, &method, directions, l2, &wanted, cancel, &receive)
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
    let solved = rows.iter().filter(|r| r.status != Status::Interrupted).count() - (all.len() - open.len());
    let summary = Summary::new(&input.design.name, &rows, solved, begun.elapsed(), interrupted, &out);
    if args.json {
        output::print_json(&summary)?;
    } else if !args.quiet {
        summary.print();
    }
    if interrupted && !args.quiet {
        eprintln!("interrupted; the same command goes on from here");
    }
    // A proof that there is no limit is an answer.
    let unanswered = |r: &LimitRow| match r.status {
        Status::Global | Status::Local | Status::ThresholdReached | Status::L2Unreachable | Status::Unbounded => false,
        Status::Uncertified
        | Status::L2NotReached
        | Status::NotConverged
        | Status::InfeasibleStart
        | Status::Interrupted => true,
    };
    Ok(ExitCode::from(match () {
        () if interrupted => exit::INTERRUPTED,
        () if rows.iter().any(unanswered) => exit::INCOMPLETE,
        () => exit::DONE,
    }))
}
