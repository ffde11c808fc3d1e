//! `maille characterize`: limits over directions and lateral strains, written as a record.

use crate::{
    exit::{self, wrong},
    input::{Input, file_name},
    interrupt,
    map::{self, RunArgs, Tally, pool, unanswered},
    numbers::{Numbers, parse, parse_cell, parse_l2, positive},
    output,
    plot::Shown,
    progress::Progress,
    summary::Summary,
    watch::watch,
};
use maille::{
    lattice::Across,
    record::LimitRow,
    relaxation::{
        HessianMethod, MinimaMethod,
        barrier::ContactLaw,
        limit::{EnergyOptions, Minimiser},
        target::Protocol,
    },
    search::ExactOptions,
    survey::{CellChoice, Method},
};
use maille_io::{
    numbers::{USUAL_DIRECTIONS, USUAL_L2},
    run::Map,
};
use miette::{Result, miette};
use std::{ops::RangeInclusive, path::PathBuf, process::ExitCode, time::Instant};

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
  maille characterize 1.1 --lateral free --out maille-out/1.1-free
  maille characterize 1.1 --lateral free --compression --directions 0:180:15
  maille characterize my-weave.toml --directions 0,45,90 --l2 0 --watch
  maille characterize 1.1 --json | jq '.limits[] | .largest.l1'

Exit codes: 0 every limit was found or proved not to be there, 5 the record is written but some were not found, \
130 interrupted.")]
pub struct Args {
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input
    design: String,
    /// Directions of the pull, degrees counter-clockwise from x: a list, or first:last:step
    #[arg(long, default_value = USUAL_DIRECTIONS, value_parser = parse, allow_hyphen_values = true)]
    directions: Numbers,
    /// Stretch - 1 held across the pull: a list, or first:last:step [default: -0.25:0.25:0.125; none with --lateral free]
    #[arg(long, value_parser = parse_l2, allow_hyphen_values = true)]
    l2: Option<Numbers>,
    /// The width across the pull: held at each --l2, or left to the sheet as in a pull test (exact method)
    #[arg(long, value_enum, default_value_t = Held::Fixed)]
    lateral: Held,
    /// The shear: held at 0, or left to the sheet (exact method)
    #[arg(long, value_enum, default_value_t = Held::Fixed)]
    shear: Held,
    /// The least l1 in place of the largest: how far the sheet can be pushed together. All cells up to 3x3 are solved, and no
    /// limit is global, as a larger cell can fold further (exact method)
    #[arg(long)]
    compression: bool,
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
    #[command(flatten)]
    run: RunArgs,
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
    /// Exact method: starts of a limit whose bound is not attained; with --compression starts of each cell
    #[arg(long, default_value_t = ExactOptions::default().starts, value_parser = |t: &str| small(t, 1..=10_000))]
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
    #[arg(long, default_value_t = EnergyOptions::default().samples, value_parser = |t: &str| small(t, 0..=50))]
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
    /// How the energy is minimised
    #[arg(long, value_enum, default_value_t = MinimiserArg::Newton)]
    minimiser: MinimiserArg,
    /// Keep every step of every run, with its size and time, in states.jsonl; `maille plot --kind step-times` draws them
    #[arg(long)]
    steps: bool,
    /// A run is at rest where |gradient| is below this, in beta R
    #[arg(long, default_value_t = EnergyOptions::default().gradient_tolerance, value_parser = positive)]
    gradient_tolerance: f64,
    /// Weight of the fourth corner, k_b/beta (--protocol corners)
    #[arg(long, default_value_t = EnergyOptions::default().corner_weight, value_parser = positive)]
    corner_weight: f64,
    /// Points on each circle of rings that touch along nearly the whole circle; 0: isolated minima alone, as in the thesis
    #[arg(long, default_value_t = EnergyOptions::default().flat_points, value_parser = flat_points)]
    flat_points: usize,
    /// Refuse steps that flip a side sign of an element of several rings, as the thesis does
    #[arg(long)]
    side_signs: bool,
    /// Iterations of one minimisation at most
    #[arg(long, default_value_t = EnergyOptions::default().max_iterations, value_parser = |t: &str| small(t, 0..=10_000_000))]
    max_iterations: usize,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ContactLawArg {
    Barrier,
    Quadratic,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum MinimiserArg {
    /// Newton's method with floored eigenvalues
    Newton,
    /// Newton's method with growing shifts of the Hessian (the thesis's Algorithm 4.3.2)
    NewtonShifted,
    /// Algorithm 4.3.2 to the letter: trial steps add up
    NewtonPrinted,
    /// Gradient descent, which the thesis rejects
    GradientDescent,
}

/// 0, or as many points as can follow a circle.
fn flat_points(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if EnergyOptions::FLAT_POINTS.contains(&n) || n == 0 => Ok(n),
        _ => {
            let range = EnergyOptions::FLAT_POINTS;
            Err(format!("\"{text}\" is neither 0 nor a whole number from {} to {}", range.start(), range.end()))
        }
    }
}

/// `auto`, or one cell.
fn cell_choice(text: &str) -> Result<CellChoice, String> {
    match text {
        "auto" => Ok(CellChoice::Auto),
        _ => parse_cell(text).map(CellChoice::One),
    }
}

fn small(text: &str, allowed: RangeInclusive<usize>) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if allowed.contains(&n) => Ok(n),
        _ => Err(format!("\"{text}\" is not a whole number from {} to {}", allowed.start(), allowed.end())),
    }
}

/// Whether a strain is held.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Held {
    Fixed,
    Free,
}

/// What is left to the sheet, and the lateral strains that are held.
fn held(args: &Args) -> Result<(Across, Vec<f64>)> {
    let across = Across { lateral_free: args.lateral == Held::Free, shear_free: args.shear == Held::Free };
    if args.compression && matches!(args.method, MethodArg::Energy) {
        let help = "leave out --compression, or --method energy";
        return Err(wrong(exit::USAGE, "the energy method finds largest limits alone", help));
    }
    if across.any() && matches!(args.method, MethodArg::Energy) {
        let help = "leave out --lateral and --shear, or --method energy";
        return Err(wrong(exit::USAGE, "the energy method holds width and shear", help));
    }
    match (&args.l2, across.lateral_free) {
        (Some(_), true) => Err(wrong(
            exit::USAGE,
            "--l2 holds the width that --lateral free leaves to the sheet",
            "leave one of them out",
        )),
        (None, true) => Ok((across, vec![0.0])),
        (Some(l2), false) => Ok((across, l2.0.clone())),
        (None, false) => Ok((across, parse_l2(USUAL_L2).map_err(|e| miette!(e))?.0)),
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
            steps: self.steps,
            minimiser: match self.minimiser {
                MinimiserArg::Newton => Minimiser::Newton,
                MinimiserArg::NewtonShifted => Minimiser::NewtonShifted,
                MinimiserArg::NewtonPrinted => Minimiser::NewtonPrinted,
                MinimiserArg::GradientDescent => Minimiser::GradientDescent,
            },
            side_signs: self.side_signs,
            max_iterations: self.max_iterations,
            gradient_tolerance: self.gradient_tolerance,
            corner_weight: self.corner_weight,
            flat_points: self.flat_points,
            seed,
        }
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
    let (across, l2) = held(args)?;
    let input = Input::read(&args.design, args.minor_radius)?;
    let folder = file_name(&input.design.name) + if args.compression { "-compression" } else { "" };
    let out = args.run.out.clone().unwrap_or_else(|| PathBuf::from("maille-out").join(folder));
    let map = Map {
        method: match args.method {
            MethodArg::Exact => Method::Exact(ExactOptions {
                starts: args.starts,
                seed: args.seed,
                across,
                compression: args.compression,
            }),
            MethodArg::Energy => Method::Energy(args.energy.options(args.seed)),
        },
        cell: args.cell,
        directions_deg: args.directions.0.clone(),
        l2,
        quantity: args.quantity.into(),
        out: Some(out.clone()),
        overwrite: args.run.overwrite || args.watch,
    };
    let begun = Instant::now();
    let open = map::open(&map, &input)?;
    if !args.quiet {
        if open.is_unlinked() {
            eprintln!("warning: no chain of links joins the cells of this design; no pull has a bound");
        }
        if open.left() < open.total() {
            eprintln!("{} of {} limits are in {} already", open.total() - open.left(), open.total(), out.display());
        }
    }
    let cancel = interrupt::flag()?;
    let pool = pool(args.run.threads)?;
    let (left, total) = (open.left(), open.total());
    let progress = Progress::new(left as u64, args.quiet);
    let found = |row: &LimitRow| {
        let width = if across.lateral_free { "width free".into() } else { format!("l2 = {}", row.l2) };
        progress.step(format!("{}°, {width}", row.direction_deg));
    };
    let rows = pool.install(|| map::run(open, &cancel, &found));
    progress.finish();
    let rows = rows?;

    let interrupted = cancel.load(std::sync::atomic::Ordering::Relaxed);
    let tally = Tally::of(&rows, total - left);
    let summary = Summary::new(&input.design.name, &rows, tally.now, begun.elapsed(), interrupted, &out);
    if args.json {
        output::print_json(&summary)?;
    } else if !args.quiet {
        summary.print();
    }
    if interrupted && !args.quiet {
        eprintln!("interrupted; the same command goes on from here");
    }
    Ok(ExitCode::from(match () {
        () if interrupted => exit::INTERRUPTED,
        () if rows.iter().any(unanswered) => exit::INCOMPLETE,
        () => exit::DONE,
    }))
}
