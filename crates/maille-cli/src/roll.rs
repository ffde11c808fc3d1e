//! `maille roll`: how tightly a sheet can be rolled along each direction, both ways, answered on the screen.

use crate::{
    certificate,
    exit::{self, refused},
    input::DesignArgs,
    interrupt,
    map::pool,
    numbers::{Numbers, parse, read},
    output::{self, counted, say},
    progress::Spinner,
};
use maille::{
    Across,
    question::{Effort, Question},
    record::Status,
    survey::CellChoice,
};
use maille_io::answer::RollAnswer;
use miette::Result;
use std::{process::ExitCode, sync::atomic::Ordering, time::Instant};

/// How tightly a sheet can be rolled
///
/// For each direction and both ways: the largest curvature of the sheet along it before its rings lock, with the axis below the sheet and above it.
/// Neighbouring cells are images under turns about one axis, so the state is exact and certified as a limit is. The radius is that of the
/// neutral surface, at the mean distance of the elements from the axis; the stretch along it is left to the sheet. No bound is known: every answer
/// is the best of the starts that were searched. That no other state goes further is not proved.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille roll european-4-in-1
  maille roll shirt.toml --directions 0,45,90 --free width,shear
  maille roll 3.1 --directions 90 --axis below --effort thorough
  maille roll european-4-in-1 --json | jq '.rolls[] | [.direction_deg, .axis, .neutral_radius]'

Exit codes: 0 every roll is certified, 5 some are not, 130 interrupted.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Directions that are rolled, degrees counter-clockwise from x: a list, or first:last:step
    #[arg(long, default_value = "0:150:30", value_parser = parse, allow_hyphen_values = true)]
    directions: Numbers,
    /// Where the axis is
    #[arg(long, value_enum, default_value_t = Axis::Both)]
    axis: Axis,
    /// What is left to the sheet: its width along the axis, its shear, or both, as width,shear; else they are held as written
    #[arg(long, value_enum, value_name = "STRAIN", value_delimiter = ',')]
    free: Vec<Free>,
    /// Cell: 1x1, 2x1, 2x2, …, an integer matrix as "1,0;-1,2", or auto: larger cells where an element presses on its own image
    #[arg(long, default_value = "1x1", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    /// How long to search each roll: low, normal, thorough, or a time such as 10s
    #[arg(long, default_value = "low", value_parser = read::<Effort>)]
    effort: Effort,
    /// Seed of the random starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// No progress
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Axis {
    /// Below the sheet and above it
    Both,
    /// Below: the sheet bends downwards
    Below,
    /// Above: the sheet bends upwards
    Above,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Free {
    Width,
    Shear,
}

impl Args {
    fn questions(&self) -> Vec<Question> {
        let free = |what: Free| self.free.contains(&what);
        let across = Across { lateral_free: free(Free::Width), shear_free: free(Free::Shear) };
        let signs: &[f64] = match self.axis {
            Axis::Both => &[1.0, -1.0],
            Axis::Below => &[1.0],
            Axis::Above => &[-1.0],
        };
        let all =
            self.directions.0.iter().flat_map(|direction_deg| signs.iter().map(move |sign| (*direction_deg, *sign)));
        let of = |(direction_deg, sign)| Question::curvature_along(direction_deg, sign).with_free(across);
        all.map(of).map(|question| Question { effort: self.effort, seed: self.seed, ..question }).collect()
    }

    fn held(&self) -> &'static str {
        match [Free::Width, Free::Shear].map(|what| self.free.contains(&what)) {
            [false, false] => "width and shear held",
            [true, false] => "width free, shear held",
            [false, true] => "width held, shear free",
            [true, true] => "width and shear free",
        }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let questions = args.questions();
    questions.iter().try_for_each(|question| question.check().map_err(|e| refused(&e)))?;
    let input = args.design.read()?;
    let sheet = input.sheet(args.cell.clone())?;
    let (cancel, pool) = (interrupt::flag(args.quiet)?, pool(args.threads)?);
    let begun = Instant::now();
    let progress = Spinner::new(args.quiet);
    let mut answers = Vec::with_capacity(questions.len());
    for question in &questions {
        progress.says(|| format!("{} of {} rolls", answers.len(), questions.len()));
        let found = pool.install(|| sheet.answer_until(question, &cancel)).map_err(|e| refused(&e))?;
        answers.push(found);
        if cancel.load(Ordering::Relaxed) {
            break;
        }
    }
    progress.finish();
    let models: Vec<_> = answers.iter().map(|found| sheet.model_of(found)).collect();
    let rolls = questions.iter().zip(&models).zip(&answers);
    let rolls: Vec<RollAnswer<'_>> =
        rolls.filter_map(|((question, model), found)| RollAnswer::new(&input.design, question, model, found)).collect();
    let wall_s = begun.elapsed().as_secs_f64();
    if args.json {
        output::print_json(&output::timed(RollAnswer::document(&input.design, &rolls), wall_s))?;
    } else {
        print(args, &input.design, &rolls, wall_s);
    }
    let certified = |roll: &RollAnswer<'_>| roll.found.is_limit();
    let stopped = |roll: &RollAnswer<'_>| roll.found.status == Status::Interrupted;
    let interrupted = rolls.len() < questions.len() || rolls.iter().any(stopped);
    Ok(ExitCode::from(match () {
        () if interrupted => exit::INTERRUPTED,
        () if rolls.iter().all(certified) => exit::DONE,
        () => exit::INCOMPLETE,
    }))
}

fn print(args: &Args, design: &maille::Design, rolls: &[RollAnswer<'_>], wall_s: f64) {
    let unit = design.unit.as_deref().map_or("radius".to_owned(), |unit| format!("radius, {unit}"));
    say!("{}: the tightest rolls, {}; {wall_s:.1} s", design.name, args.held());
    say!(
        "  {:>10}  {:<5} {:>12} {:>12} {:>9}  {:<13} cell",
        "direction",
        "axis",
        unit,
        "radius / R",
        "stretch",
        "status"
    );
    for roll in rolls {
        let number = |x: Option<f64>, digits: usize| x.map_or("-".to_owned(), |x| format!("{x:.digits$}"));
        let neutral = roll.neutral();
        let (radius, stretch) = (neutral.map(|n| n.radius), neutral.map(|n| n.stretch));
        say!(
            "  {:>9}\u{b0}  {:<5} {:>12} {:>12} {:>9}  {:<13} {}",
            roll.direction_deg,
            roll.axis(),
            number(radius.map(|r| r * design.reference_radius), 4),
            number(radius, 4),
            number(stretch, 4),
            roll.found.status.name(),
            roll.found.cell
        );
        if let Some(note) = &roll.found.note {
            say!("              {note}");
        }
    }
    say!(
        "radius: of the neutral surface, at the mean distance of the elements from the axis; stretch: of lines along it"
    );
    let local = rolls.iter().filter(|roll| roll.found.status == Status::Local).count();
    if local > 0 {
        say!("{} certified; that no other state bends further is not proved", counted(local, "roll"));
    }
    if let [RollAnswer { found, .. }] = rolls
        && let Some(c) = &found.certificate
    {
        say!("  {}", certificate::search(found));
        say!("  {}", certificate::line(c));
    }
}
