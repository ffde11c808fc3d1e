//! `maille characterize`: limits over directions and lateral strains, written as a record.

use crate::{
    effort::SearchArgs,
    exit::{self, refused, wrong},
    help::ENERGY,
    input::{self, DesignArgs, file_name},
    map::{self, RunArgs, Solved, unanswered},
    numbers::{Numbers, one_of, parse, parse_l2, positive, read},
    output,
    plot::Shown,
    summary::Summary,
    watch::watch,
};
use clap::builder::PossibleValue;
use maille::{
    design::Design,
    error::InvalidInput,
    lattice::{Across, Cell},
    record::{LimitRow, Status},
    relaxation::{
        HessianMethod, MinimaMethod,
        barrier::ContactLaw,
        limit::{EnergyOptions, Minimiser},
        target::Protocol,
    },
    search::ExactOptions,
    survey::{CellChoice, MapQuestion, Method},
};
use maille_io::run::Map;
use miette::Result;
use std::{ops::RangeInclusive, path::PathBuf, process::ExitCode, time::Instant};

/// How far a sheet stretches in each direction before it locks
///
/// Writes a record, which is a folder with limits.csv (one row for each limit), states.jsonl (the poses at each limit), polar.svg and
/// polar.png (stretch against direction) and run.json (all that is needed to repeat the run). If it is interrupted, the
/// same command continues it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille characterize 1.1
  maille characterize 3.1 --directions 0:180:5 --l2 -0.25,-0.125,0
  maille characterize 1.2 --minor-radius 0.05 --quantity lambda1
  maille characterize my-weave.toml --out results/my-weave
  maille characterize 1.1 --lateral free --out maille-out/1.1-free
  maille characterize 1.1 --lateral free --compression --directions 0:180:15
  maille characterize my-weave.toml --directions 0,45,90 --l2 0 --watch
  maille characterize 1.1 --sensitivities
  maille characterize 1.1 --json | jq '.limits[] | .largest.l1'

The energy method of the thesis has options of its own:
  maille characterize --method energy --help

Exit codes: 0 every limit was found, or it was proved that there is none; 5 the record is written, but some limits were \
not found (0 with --allow-incomplete; 0 where only some of the usual l2 are not reached and --l2 names none); 130 interrupted.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Directions of the pull, degrees counter-clockwise from x: a list, or first:last:step [default: 0:180:5; of a chain that of a1]
    #[arg(long, value_parser = parse, allow_hyphen_values = true)]
    directions: Option<Numbers>,
    /// Stretch - 1 held across the pull: a list, or first:last:step [default: -0.25:0.25:0.125; none with --lateral free; 0 of a chain]
    #[arg(long, value_parser = parse_l2, allow_hyphen_values = true)]
    l2: Option<Numbers>,
    /// The width across the pull: held at each --l2, or left to the sheet as in a pull test (exact method)
    #[arg(long, value_enum, default_value_t = Held::Fixed)]
    lateral: Held,
    /// The shear: held at 0, or left to the sheet (exact method)
    #[arg(long, value_enum, default_value_t = Held::Fixed)]
    shear: Held,
    /// Whether the largest and the smallest l1 of each l2 are sought between the directions, too, as rows of their own (exact method)
    /// [default: yes without --directions and --compression]
    #[arg(long, value_enum)]
    extremes: Option<YesNo>,
    /// The smallest l1 instead of the largest: how far the sheet can be compressed. All cells up to 3x3 are solved, and no
    /// limit is global, because a larger cell can fold further (exact method)
    #[arg(long)]
    compression: bool,
    /// How a limit is found
    #[arg(long, value_enum, default_value_t = MethodArg::Exact)]
    method: MethodArg,
    /// Cell: 1x1, 2x1, 2x2, …, an integer matrix as "1,0;-1,2", or auto: 1x1, and larger cells where an element
    /// presses on its own image or a wave through the sheet is unstable (exact method)
    #[arg(long, default_value = "auto", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    /// What polar.svg and polar.png show
    #[arg(long, value_enum, default_value_t = Shown::Stretch)]
    quantity: Shown,
    /// Write sensitivities.csv, too: the derivatives of each certified limit by the wire, the spacing and the parameters of the file.
    /// They follow from the forces: a finished record is not solved again (exact method)
    #[arg(long)]
    sensitivities: bool,
    /// Folder that is written [default: maille-out/NAME, or maille-out/NAME-compression with --compression]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    run: RunArgs,
    #[command(flatten)]
    search: SearchArgs,
    /// Print the summary as one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// Compute again whenever the design file is saved; implies --overwrite
    #[arg(long)]
    watch: bool,
    /// No progress and no summary
    #[arg(long, short, conflicts_with = "json")]
    quiet: bool,
    #[command(flatten, next_help_heading = ENERGY)]
    energy: EnergyArgs,
}

#[derive(clap::Args)]
struct EnergyArgs {
    /// How the deformation is imposed: on F itself, or on the cell's corners as in the thesis (biased in sheared cells)
    #[arg(long, default_value = "strain", value_parser = one_of::<Protocol>(["strain", "corners"]))]
    protocol: Protocol,
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
    #[arg(long, default_value = "analytic", value_parser = one_of::<HessianMethod>(["analytic", "finite-difference"]))]
    hessian: HessianMethod,
    /// Minima of the circle-circle distance: complete enumeration, or the thesis's polynomial
    #[arg(long, default_value = "enumeration", value_parser = one_of::<MinimaMethod>(["enumeration", "polynomial"]))]
    minima: MinimaMethod,
    /// What an overlap costs: the barrier, or the square that the thesis rejects
    #[arg(long, default_value = "barrier", value_parser = one_of::<ContactLaw>(["barrier", "quadratic"]))]
    contact_law: ContactLaw,
    /// How the energy is minimised
    #[arg(long, default_value = "newton", value_parser = one_of::<Minimiser>(minimisers()))]
    minimiser: Minimiser,
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

/// Ways to minimise, and what they are.
fn minimisers() -> [PossibleValue; 4] {
    [
        ("newton", "Newton's method with floored eigenvalues"),
        ("newton-shifted", "Newton's method with growing shifts of the Hessian (the thesis's Algorithm 4.3.2)"),
        ("newton-printed", "Algorithm 4.3.2 to the letter: trial steps add up"),
        ("gradient-descent", "Gradient descent, which the thesis rejects"),
    ]
    .map(|(name, words)| PossibleValue::new(name).help(words))
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

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum YesNo {
    Yes,
    No,
}

/// What is asked.
fn question(args: &Args, design: &Design) -> Result<MapQuestion, InvalidInput> {
    let across = Across { lateral_free: args.lateral == Held::Free, shear_free: args.shear == Held::Free };
    let Args { compression, search, .. } = *args;
    let SearchArgs { effort, seed, .. } = search;
    let method = match args.method {
        MethodArg::Exact => Method::Exact(ExactOptions { effort, starts: search.starts(), seed, across, compression }),
        MethodArg::Energy => Method::energy(args.energy.options(seed), across, compression)?,
    };
    let given = |numbers: &Option<Numbers>| numbers.clone().map(|numbers| numbers.0);
    let single = |of_chain: f64| design.lattice.single.then(|| vec![of_chain]);
    let directions_deg = given(&args.directions).or_else(|| single(design.lattice.direction_deg()));
    let l2 = given(&args.l2).or_else(|| single(0.0).filter(|_| !across.lateral_free));
    let extremes = args.extremes.map(|given| given == YesNo::Yes);
    MapQuestion::new(method, args.cell.clone(), directions_deg, l2, extremes)
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum MethodArg {
    /// Maximises l1 under all gaps, with a certificate and a proven bound
    Exact,
    /// The method of the thesis: an energy of contacts and targets, minimised
    Energy,
}

impl EnergyArgs {
    fn options(&self, seed: u64) -> EnergyOptions {
        EnergyOptions {
            protocol: self.protocol,
            alpha: self.alpha,
            tau: self.tau,
            l1_step: self.l1_step,
            l1_resolution: self.l1_resolution,
            samples: self.samples,
            sample_spacing_rad: self.sample_spacing,
            hessian: self.hessian,
            minima: self.minima,
            contact_law: self.contact_law,
            steps: self.steps,
            minimiser: self.minimiser,
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
        true => watch(std::slice::from_ref(&args.design.design), || once(args)),
        false => once(args),
    }
}

fn once(args: &Args) -> Result<ExitCode> {
    if args.sensitivities && matches!(args.method, MethodArg::Energy) {
        let help = "leave --sensitivities out, or --method energy";
        return Err(wrong(exit::USAGE, "limits of the energy method have no forces, and so no derivatives", help));
    }
    let input = args.design.read()?;
    let question = question(args, &input.design).map_err(|e| refused(&e))?;
    let folder = file_name(&input.design.name) + if args.compression { "-compression" } else { "" };
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("maille-out").join(folder));
    let overwrite = args.run.overwrite || args.watch;
    let map = Map {
        question,
        quantity: args.quantity.into(),
        out: Some(out.clone()),
        overwrite,
        sensitivities: args.sensitivities,
    };
    let begun = Instant::now();
    let open = map::open(&map, &input)?;
    if !args.quiet {
        input::warn(&input.compile(&input.design, Cell::PRIMITIVE)?);
    }
    let Solved { records, tally, interrupted, .. } = map::solve(vec![("", open)], &out, args.run.threads, args.quiet)?;
    let rows = &records[0].rows;
    let summary = Summary::new(&input.design.name, rows, tally.now, begun.elapsed(), interrupted, &out);
    if args.json {
        output::print_json(&summary)?;
    } else if !args.quiet {
        summary.print();
    }
    // The usual l2 suit no sheet in particular: that one of them is out of reach is a result. A free width has none.
    let usual = |row: &LimitRow| args.l2.is_none() && row.lateral.as_deref() != Some("free");
    let counts = |row: &LimitRow| unanswered(row) && !(usual(row) && row.status == Status::L2NotReached);
    Ok(exit::ended(interrupted, args.run.code(rows.iter().any(counts)), args.quiet))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The help names what a map takes where nothing is named.
    #[test]
    fn usual_directions_and_l2_are_those_of_the_library() {
        let usual =
            MapQuestion::new(Method::Exact(ExactOptions::default()), CellChoice::Auto, None, None, None).unwrap();
        assert_eq!(parse("0:180:5").unwrap().0, usual.directions_deg);
        assert_eq!(parse_l2("-0.25:0.25:0.125").unwrap().0, usual.l2);
    }
}
