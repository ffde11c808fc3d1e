//! `maille fit`: a design for wanted limits.

use crate::{
    exit::{self, refused, wrong},
    extreme::in_unit,
    fit_over,
    fit_record::{self, Files},
    input::{Input, Setting, file_name},
    interrupt,
    map::pool,
    numbers::{positive, read},
    output::{self, counted},
    progress::Spinner,
    units::{Length, parse_length},
};
use maille::{
    design::Design,
    error::InvalidInput,
    fit::{Ended, FitOptions, FitProgress, Norm, Target},
    question::Effort,
    survey::CellChoice,
};
use maille_io::{
    Tile,
    fit::{self, FIT, FitRecord, FitRequest, FreeSpec, fitted_design, read_targets},
    record::{FolderLock, Mark, RecordError},
};
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

/// A design whose limits are those that are wanted
///
/// Moves numbers of a design between their bounds until its limits are the targets, as nearly as can be found: by least squares, or so that
/// the largest miss is smallest. Every design on the way is solved, and its certified limits give their derivatives. Several starts are searched. That no other design does better is not proved, but where a target is proved to be out of reach, the
/// summary says so.
///
/// Writes a folder: fitted.toml, the design, which every command takes; fit.json, what was asked and found; given/ and fitted/,
/// the limits of both designs as records, which `maille verify` checks; fit.svg and fit.png, before, after and targets in one plot. If it is
/// interrupted, the same command continues it.
#[derive(clap::Args)]
#[command(after_help = "\
Targets are a CSV file with a line for each limit:
  direction_deg,l2,l1,at_least,at_most,weight
  0,0,0.45,,,            l1 is to be 0.45
  45,0,,0.7,,            l1 is to be 0.7 or more
  90,-0.1,,,0.6,2        l1 is to be 0.6 or less, and counts twice
Columns that are not needed may be left out. A column poisson_ratio wants -ln(1+l2)/ln(1+l1) at the limit, the width left to the sheet
(also poisson_at_least, poisson_at_most), in place of l1. The limits.csv of a record is such a file, too.

Examples:
  maille fit 1.1 --target profile.csv --free minor_radius=0.05:0.15 --free 'elements.standing-*.rings.major_radius=30%'
  maille fit examples/parameters/square.toml --target profile.csv      its parameters with bounds are free
  maille fit 3.1 --supercell 2x2 --target profile.csv --shape --free-each 'elements.*.rings.major_radius=30%'
  maille fit shirt.toml --target maille-out/other/limits.csv --free spacing=0.8:1.2 --min-gap 0.3mm

  maille fit --over designs --target profile.csv --shape     which weave comes nearest?

Exit codes: 0 every target is reached (with --over: by one of the designs), 5 some are not, 6 with --over: some designs could not be used, 130 interrupted.")]
pub struct Args {
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input
    #[arg(required_unless_present = "over")]
    design: Option<String>,
    /// Fit each of these designs, and rank them: names, files, or folders of files. Without --free the wire and the spacing are free
    #[arg(long, value_name = "DESIGN", num_args = 1.., conflicts_with_all = ["design", "json"])]
    over: Vec<String>,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive)]
    minor_radius: Option<f64>,
    /// A value for a parameter of the design's file, as radius=5.0; several with commas
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    set: Vec<Setting>,
    /// The wanted limits and Poisson ratios, a CSV file
    #[arg(long, value_name = "FILE")]
    target: PathBuf,
    /// Only the proportions of the wanted limits count, not their size
    #[arg(long)]
    shape: bool,
    /// A number that may move, with its least and largest value or with a share of its value, as minor_radius=0.05:0.15 or minor_radius=30%; a
    /// number of an element as in studies (`maille sweep --help`), spacing, or a parameter of the file; one number where * names several
    /// [default: the parameters of the file that have bounds]
    #[arg(long, value_name = "NUMBER=BOUNDS", value_parser = read::<FreeSpec>, value_delimiter = ',')]
    free: Vec<FreeSpec>,
    /// The same, with a number of its own for each element and ring that is named
    #[arg(long, value_name = "NUMBER=BOUNDS", value_parser = read::<FreeSpec>, value_delimiter = ',')]
    free_each: Vec<FreeSpec>,
    /// Take so many cells along a1 and a2 as one, so that each copy of an element can have numbers of its own
    #[arg(long, value_name = "NxM")]
    supercell: Option<Tile>,
    /// The gap that the rings must have where they are laid out with the widest gaps, as 0.3mm
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    min_gap: Option<Length>,
    /// What is made small
    #[arg(long, value_enum, default_value_t = NormArg::LeastSquares)]
    norm: NormArg,
    /// Misses of at most this are none
    #[arg(long, default_value_t = FitOptions::default().tolerance, value_parser = positive)]
    tolerance: f64,
    /// Designs from which the search starts: the given one, then drawn ones, far from the best yet and near to it by turns
    #[arg(long, default_value_t = FitOptions::default().starts, value_parser = at_least_one)]
    restarts: usize,
    /// Designs that are solved from each of them at most
    #[arg(long, default_value_t = FitOptions::default().designs, value_parser = at_least_one)]
    designs: usize,
    /// Cell of the limits: 1x1 is that of the design; auto goes on to larger ones for each design, which takes long
    #[arg(long, default_value = "1x1", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    /// How long to search each limit on the way: low, normal, thorough, or a time such as 1s. The limits of the given design
    /// and of the result are searched with normal effort at least
    #[arg(long, default_value = "low", value_parser = read::<Effort>)]
    effort: Effort,
    /// Seed of what is drawn
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder that is written [default: maille-out/NAME-fit]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace a fit of other inputs in the folder
    #[arg(long)]
    overwrite: bool,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print the fit as one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// No progress and no summary
    #[arg(long, short, conflicts_with = "json")]
    quiet: bool,
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if (1..=100_000).contains(&n) => Ok(n),
        _ => Err(format!("\"{text}\" is not a whole number from 1 to 100000")),
    }
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum NormArg {
    /// The sum of the squares of the misses, each times its weight
    LeastSquares,
    /// The largest miss times its weight
    Minimax,
}

impl From<NormArg> for Norm {
    fn from(norm: NormArg) -> Self {
        match norm {
            NormArg::LeastSquares => Norm::LeastSquares,
            NormArg::Minimax => Norm::Minimax,
        }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let targets = targets(&args.target)?;
    let cancel = interrupt::flag(args.quiet)?;
    let Some(name) = &args.design else {
        return over(args, &targets, &cancel);
    };
    let begun = Instant::now();
    let input = Input::read_with(name, &args.set, args.minor_radius)?;
    let out = args.out.clone().unwrap_or_else(|| usual_folder(&input.design.name));
    let (record, interrupted) = one(args, &input, &args.free, &targets, &out, &cancel)?;
    if args.json {
        let mut document = fit::document(&record);
        document["out"] = out.display().to_string().into();
        output::print_json(&output::timed(document, begun.elapsed().as_secs_f64()))?;
    } else if !args.quiet {
        fit_record::print(&record, &out, begun.elapsed());
    }
    let code = if record.outcome.ended == Ended::Reached { exit::DONE } else { exit::INCOMPLETE };
    Ok(exit::ended(interrupted, code, args.quiet))
}

fn usual_folder(name: &str) -> PathBuf {
    Path::new("maille-out").join(file_name(name) + "-fit")
}

/// The fit of one design, in the folder `out`, and whether it was interrupted.
fn one(
    args: &Args,
    input: &Input,
    free: &[FreeSpec],
    targets: &[Target],
    out: &Path,
    cancel: &AtomicBool,
) -> Result<(FitRecord, bool)> {
    let request = request(args, input, free, targets)?;
    output::folder(out, "a fit is a folder")?;
    let lock = FolderLock::take(out, &[Mark::File(FIT, &["schema", "request", "outcome"])])?;
    let earlier = fit_record::earlier(out, &request, args.overwrite)?;
    let record = match earlier {
        Some(record) if record.is_final(&request) => record,
        earlier => match search(args, &request, earlier.as_ref(), out, cancel) {
            Ok(record) => record,
            Err(report) => {
                lock.give_up(out);
                return Err(report);
            }
        },
    };
    record.save(out)?;
    if record.outcome.ended == Ended::Interrupted {
        return Ok((record, true));
    }
    let pool = pool(args.threads)?;
    let fitted = pool.install(|| fitted_design(&request, &record.outcome.numbers, cancel)).map_err(|e| refused(&e))?;
    let files = Files { out, request: &request, record: &record, fitted: &fitted };
    let interrupted = files.write(args.threads, args.quiet || args.json)?;
    Ok((record, interrupted))
}

/// What is asked.
fn request(args: &Args, input: &Input, free: &[FreeSpec], targets: &[Target]) -> Result<FitRequest> {
    // What is wrong with the design itself is told before anything else.
    input.compile(&Design { allow_initial_overlap: true, ..input.design.clone() }, maille::Cell::PRIMITIVE)?;
    let Tile([n, m]) = args.supercell.unwrap_or(Tile([1, 1]));
    let min_gap = args.min_gap.map(|gap| in_unit(&input.design, gap));
    let options = FitOptions {
        norm: args.norm.into(),
        starts: args.restarts,
        seed: args.seed,
        tolerance: args.tolerance,
        designs: args.designs,
        cells: args.cell.clone(),
        effort: args.effort,
    };
    let (free, targets) = ((free, &args.free_each[..]), (targets.to_vec(), args.shape));
    let supercell = [n as usize, m as usize];
    FitRequest::new(&input.design, supercell, free, targets, min_gap, options).map_err(|e| refused(&e))
}

/// What is free of each design where nothing is named.
const USUAL: [&str; 2] = ["minor_radius=50%", "spacing=0.7:1.3"];

/// Fits each design, and ranks them.
fn over(args: &Args, targets: &[Target], cancel: &AtomicBool) -> Result<ExitCode> {
    let usual = || USUAL.iter().filter_map(|text| text.parse().ok()).collect();
    let none_named = args.free.is_empty() && args.free_each.is_empty();
    let free: Vec<FreeSpec> = if none_named { usual() } else { args.free.clone() };
    let out = args.out.clone().unwrap_or_else(|| Path::new("maille-out").join("fits"));
    let (mut ranked, mut unused) = (Vec::new(), Vec::new());
    for name in fit_over::designs(&args.over)? {
        if cancel.load(Ordering::Relaxed) {
            break;
        }
        if !args.quiet {
            eprintln!("{name}");
        }
        let input = Input::read_with(&name, &args.set, args.minor_radius);
        let found = input.and_then(|input| {
            let folder = out.join(file_name(&input.design.name));
            let (record, _) = one(args, &input, &free, targets, &folder, cancel)?;
            Ok((input.design.name, record))
        });
        match found {
            Ok(one) => ranked.push(one),
            Err(report) => unused.push((name, report)),
        }
    }
    fit_over::rank(&mut ranked);
    if !ranked.is_empty() {
        output::write(&out.join("ranking.csv"), fit_over::csv(&ranked).as_bytes())?;
    }
    if !args.quiet {
        fit_over::print(&ranked, &out);
    }
    let reached = ranked.iter().any(|(_, record)| record.outcome.ended == Ended::Reached);
    let code = match (unused.is_empty(), reached) {
        (false, _) => exit::LEFT_OUT,
        (true, true) => exit::DONE,
        (true, false) => exit::INCOMPLETE,
    };
    crate::sweep::tell(unused);
    Ok(exit::ended(cancel.load(Ordering::Relaxed), code, args.quiet))
}

fn targets(file: &Path) -> Result<Vec<Target>> {
    let text = match std::fs::read_to_string(file) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            let help = "it is a CSV file with the columns direction_deg and l1, or the limits.csv of a record";
            return Err(wrong(exit::USAGE, format!("there is no file of targets {}", file.display()), help));
        }
        Err(e) => return Err(e).into_diagnostic().wrap_err_with(|| format!("cannot read {}", file.display())),
    };
    Ok(read_targets(&file.display().to_string(), &text)?)
}

/// Searches; the best design yet is in fit.json meanwhile.
fn search(
    args: &Args,
    request: &FitRequest,
    earlier: Option<&FitRecord>,
    out: &Path,
    cancel: &AtomicBool,
) -> Result<FitRecord> {
    let resumed = earlier.map(|record| (record.outcome.numbers.as_slice(), record.outcome.starts.saturating_sub(1)));
    if resumed.is_some() && !args.quiet {
        eprintln!("going on from the best design in {}", out.display());
    }
    let progress = Spinner::new(args.quiet);
    // The smallest miss that is saved, and why saving failed.
    let saved: Mutex<(f64, Option<RecordError>)> = Mutex::new((f64::INFINITY, None));
    let lock = || saved.lock().unwrap_or_else(|e| e.into_inner());
    let tell = |now: FitProgress| {
        let FitProgress { start, designs, worst_miss, numbers, by_bounds } = now;
        progress.says(|| {
            let of = request.options.starts;
            let sought = by_bounds.map_or(String::new(), |[done, all]| format!(" (sought by bounds, {done} of {all})"));
            format!("{}, start {start} of {of}{sought}, largest miss {worst_miss:.2e}", counted(designs, "design"))
        });
        let mut saved = lock();
        if worst_miss < saved.0 {
            saved.0 = worst_miss;
            if let Err(error) = FitRecord::begun(request, numbers, start, designs).save(out) {
                saved.1 = Some(error);
                cancel.store(true, Ordering::Relaxed);
            }
        }
    };
    let pool = pool(args.threads)?;
    let found = pool.install(|| request.solve(resumed, &tell, cancel));
    progress.finish();
    if let Some(error) = lock().1.take() {
        return Err(error.into());
    }
    let found = found.map_err(|e| cannot_begin(&e))?;
    FitRecord::finished(request, &found).map_err(|e| refused(&e))
}

fn cannot_begin(problem: &InvalidInput) -> Report {
    if problem.problem.contains("interrupted") {
        return wrong(exit::INTERRUPTED, problem.problem.clone(), problem.help.clone());
    }
    wrong(exit::INCOMPLETE, format!("the fit cannot begin: {}", problem.problem), problem.help.clone())
}
