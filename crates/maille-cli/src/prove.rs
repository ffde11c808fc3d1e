//! `maille prove`: a computer proof that a cell of two rings stretches no further.

use crate::{
    effort::SearchArgs,
    exit::{self, refused, wrong},
    input::{DesignArgs, Input, file_name},
    interrupt,
    map::pool,
    numbers::{finite, positive},
    output::{self, say},
    progress::Spinner,
};
use maille::{answer::Answer, lattice::Cell, question::Question, record::Status};
use maille_prove::{Options, Outcome, search};
use maille_verify::proof::{Claim, write};
use miette::{IntoDiagnostic, Result, WrapErr};
use serde_json::json;
use std::{
    path::PathBuf,
    process::ExitCode,
    sync::atomic::AtomicBool,
    time::{Duration, Instant},
};

/// Prove that no state of the cell 1x1 of two rings stretches beyond a value
///
/// Finds the limit as `characterize --cell 1x1` does, and then searches for a proof that no state of this cell, with these links and
/// without overlap, has an l1 above it by more than --within: all poses of the two rings are divided into boxes, and each box is shown
/// to hold no state, with outward rounding. The proof is a file, and `maille verify` checks it anew. It says nothing of larger cells.
/// For designs of two elements of one ring each that are linked, as European 4-in-1.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille prove 2 --direction 0
  maille prove 2 --direction 30 --l2=-0.05 --minor-radius 0.05 --within 1e-4
  maille prove european-4-in-1 --direction 90 --time 60
  maille prove 2 --direction 0 --at-most 0.2             a value of your own, nothing is searched
  maille verify maille-out/2-0deg.proof                  check it anew

Where the search for a proof ends early, the file proves what was reached: a larger value.

Exit codes: 0 proved; 5 something is left open: a larger value is proved, or none; 130 interrupted, likewise.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Direction of the pull, degrees counter-clockwise from x
    #[arg(long, value_parser = finite, allow_hyphen_values = true)]
    direction: f64,
    /// Stretch - 1 across the direction
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    l2: f64,
    /// How far above the limit that is found the proved value may be
    #[arg(long, default_value_t = 1e-3, value_parser = positive, value_name = "L1")]
    within: f64,
    /// The value to prove, in place of the limit that is found and --within
    #[arg(long, value_parser = finite, allow_hyphen_values = true, value_name = "L1", conflicts_with_all = ["within", "effort", "starts", "seed"])]
    at_most: Option<f64>,
    #[command(flatten)]
    search: SearchArgs,
    /// Seconds after which the search for a proof ends
    #[arg(long, default_value_t = 600.0, value_parser = positive)]
    time: f64,
    /// Boxes after which the search for a proof ends; unlike the time they end it at the same place on every machine
    #[arg(long, default_value_t = 10_000_000)]
    boxes: usize,
    /// File of the proof [default: maille-out/NAME-DIRECTIONdeg.proof, with l2 where it is not 0]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    replace: output::Replace,
    /// Threads [default: all cores]; the proof does not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// No progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let input = args.design.read()?;
    let file = args.out.clone().unwrap_or_else(|| usual_file(args, &input));
    args.replace.check(&file)?;
    input.compile(&input.design, Cell::PRIMITIVE)?;
    let design = serde_json::to_value(&input.design).into_diagnostic().wrap_err("cannot write the design")?;
    // What cannot be proved is refused before anything is solved.
    let asked = |l1: f64| Claim::new(design.clone(), args.direction, args.l2, l1);
    let unusable = |problem: String| {
        let help =
            "a proof is for designs of two elements of one ring each, linked along the pull, as 2 or european-4-in-1";
        wrong(exit::DESIGN, format!("nothing can be proved of {}: {problem}", input.design.name), help)
    };
    let question = args.search.of(Question::stretch_along(args.direction).with_lateral(args.l2));
    question.check().map_err(|e| refused(&e))?;
    asked(args.at_most.unwrap_or(0.0)).cell().map_err(&unusable)?;
    let (cancel, pool) = (interrupt::flag(args.quiet)?, pool(args.threads)?);
    let found = match args.at_most {
        Some(_) => None,
        None => Some(pool.install(|| limit(&input, &question, &cancel))?),
    };
    let l1 = match (args.at_most, &found) {
        (Some(l1), _) => l1,
        (None, Some((_, l1))) => l1 + args.within,
        (None, None) => unreachable!("a value is given or found"),
    };
    let claim = Claim { l1_found: found.as_ref().map(|(_, l1)| *l1), ..asked(l1) };
    let cell = claim.cell().map_err(&unusable)?;
    let begun = Instant::now();
    let spinner = Spinner::new(args.quiet);
    let options = Options { boxes: args.boxes, time: Duration::from_secs_f64(args.time.min(1e9)) };
    let told = |p: &maille_prove::Progress| {
        spinner
            .says(|| format!("l1 <= {:.6} proved, {l1:.6} wanted; {} boxes, {} left", p.l1_at_most, p.boxes, p.open));
    };
    let outcome = pool.install(|| search(&cell, options, &cancel, told));
    spinner.finish();
    let claim = outcome.claim(claim);
    output::write(&file, write(&claim, outcome.nodes()).as_bytes())?;
    let told = Told { claim: &claim, outcome: &outcome, found: found.as_ref().map(|(answer, _)| answer), wanted: l1 };
    let seconds = begun.elapsed().as_secs_f64();
    match args.json {
        true => output::print_json(&output::timed(told.json(&input, &file), seconds))?,
        false => told.print(&input, &file, seconds),
    }
    Ok(ExitCode::from(match (outcome.closed(), outcome.interrupted) {
        (true, _) => exit::DONE,
        (false, true) => exit::INTERRUPTED,
        (false, false) => exit::INCOMPLETE,
    }))
}

/// The limit of the cell 1x1 that the search finds.
fn limit(input: &Input, question: &Question, cancel: &AtomicBool) -> Result<(Answer, f64)> {
    let sheet = input.sheet(Cell::PRIMITIVE.into())?;
    let found = sheet.answer_until(question, cancel).map_err(|e| refused(&e))?;
    match (found.status, found.value) {
        (Status::Interrupted, _) => Err(wrong(exit::INTERRUPTED, "interrupted", "nothing was written")),
        (Status::Global | Status::Local, Some(l1)) => Ok((found, l1)),
        (status, _) => {
            let problem = format!("the search for the limit ended as {}: there is no value to prove", status.name());
            Err(wrong(exit::INCOMPLETE, problem, "name one with --at-most, or take another l2"))
        }
    }
}

fn usual_file(args: &Args, input: &Input) -> PathBuf {
    let l2 = if args.l2 == 0.0 { String::new() } else { format!("-l2_{}", args.l2) };
    PathBuf::from(format!("maille-out/{}-{}deg{l2}.proof", file_name(&input.design.name), args.direction))
}

/// What is said of a proof.
struct Told<'a> {
    claim: &'a Claim,
    outcome: &'a Outcome,
    found: Option<&'a Answer>,
    wanted: f64,
}

impl Told<'_> {
    /// Rounded up: what is said is no more than what is proved.
    fn proved(&self) -> f64 {
        (self.claim.l1_at_most * 1e9).ceil() / 1e9
    }

    fn status(&self) -> &'static str {
        if self.outcome.closed() { "proved" } else { "open" }
    }

    fn json(&self, input: &Input, file: &std::path::Path) -> serde_json::Value {
        json!({
            "design": input.design.name,
            "direction_deg": self.claim.direction_deg,
            "l2": self.claim.l2,
            "cell": self.claim.cell,
            "status": self.status(),
            "l1_found": self.claim.l1_found,
            "l1_wanted": self.wanted,
            "l1_at_most": self.claim.l1_at_most,
            "boxes": self.outcome.boxes,
            "boxes_left": self.outcome.open,
            "narrow": self.outcome.narrow,
            "interrupted": self.outcome.interrupted,
            "file": file,
        })
    }

    fn print(&self, input: &Input, file: &std::path::Path, seconds: f64) {
        let (claim, outcome) = (self.claim, self.outcome);
        say!(
            "{}, {}\u{b0}, l2 = {}: {}",
            input.design.name,
            claim.direction_deg,
            claim.l2,
            match outcome.closed() {
                true => "proved for the cell 1x1",
                false => "left open",
            }
        );
        if let (Some(answer), Some(l1)) = (self.found, claim.l1_found) {
            let starts = output::counted(answer.n_starts.unwrap_or(0) as usize, "start");
            say!("  found   l1  = {l1:.9}, by {starts}");
        }
        say!("  proved  l1 <= {:.9} for the cell 1x1; larger cells may go further", self.proved());
        if !outcome.closed() {
            say!("  wanted  l1 <= {:.9}", self.wanted);
            match outcome.narrow {
                true => say!(
                    "  a box too narrow to be split is left: there may be a state with this l1 that was not found; try --effort thorough"
                ),
                false => say!("  {} boxes are left: more --time or --boxes may close them", outcome.open),
            }
        }
        say!("  {} boxes, {seconds:.1} s", outcome.boxes);
        if !output::is_standard(file) {
            say!("  {}: check it with `maille verify`", file.display());
        }
    }
}
