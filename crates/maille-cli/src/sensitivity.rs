//! `maille sensitivity`: how a limit changes with the numbers of its design.

use crate::{
    effort::SearchArgs,
    exit::{self, refused, wrong},
    input::DesignArgs,
    interrupt,
    numbers::{finite, positive, read},
    output::{self, say},
};
use maille::{Sheet, design::Design, question::Question, record::Status, sensitivity::Sensitivity, survey::CellChoice};
use maille_io::sensitivity::{NO_CHANGE, NumberChange, SolvedChange, document, ranked};
use miette::Result;
use std::{process::ExitCode, sync::atomic::AtomicBool, time::Instant};

/// How a limit changes with the numbers of its design
///
/// The forces of a certified limit give its derivative by every number: the wire, each ring's radii, offset and tilt, the spacing,
/// the lattice vectors, and the parameters of the file. Nothing is solved anew, so the changes are those of first order. The numbers are listed by how much they
/// matter, with the pairs of rings through which they act. Where the forces are not unique, or states that symmetries of the design make
/// of each other tie, a number can act differently to both sides: then both changes are given. Centres of elements change nothing, as a
/// limit is sought over all positions. How far the first order reaches is not known without a solve: --solve N shows it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille sensitivity 1.1 --direction 30
  maille sensitivity european-4-in-1 --direction 90 --l2 -0.05 --step 0.05
  maille sensitivity kings-mail --solve 3
  maille sensitivity my-weave.toml --json

Exit codes: 0 done, 5 no certified limit was found, 130 interrupted.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Direction of the pull, degrees counter-clockwise from x
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    direction: f64,
    /// Lateral strain that is held
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    l2: f64,
    /// Change of a length, in the file's unit [default: 0.1 mm; of a design without unit, 1 % of its reference radius]
    #[arg(long, value_parser = positive)]
    step: Option<f64>,
    /// Solve the limits of the designs with each of the first N numbers changed by its step, and print these changes, too
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    solve: usize,
    /// Cell: 1x1, 2x1, …, an integer matrix as "1,0;-1,2", or auto
    #[arg(long, default_value = "auto", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    #[command(flatten)]
    search: SearchArgs,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let question = args.search.of(Question::stretch_along(args.direction).with_lateral(args.l2));
    question.check().map_err(|e| refused(&e))?;
    let input = args.design.read()?;
    let sheet = input.sheet(args.cell.clone())?;
    let cancel = interrupt::flag(false)?;
    let begun = Instant::now();
    let answer = sheet.answer_until(&question, &cancel).map_err(|e| refused(&e))?;
    let Some(value) = answer.limit() else {
        let problem = format!(
            "{}: the limit is {}; only a certified one has derivatives",
            input.design.name,
            answer.status.name()
        );
        let code = if answer.status == maille::Status::Interrupted { exit::INTERRUPTED } else { exit::INCOMPLETE };
        return Err(wrong(code, problem, "try --effort thorough, another --l2 or another --direction"));
    };
    let model = sheet.model_of(&answer);
    let found = Sensitivity::of(&model, &question, &answer).map_err(|e| refused(&e))?;
    let mut lines = ranked(&input.design, &found, args.step);
    solve(args, &mut lines, &input.design, (&question, value), &cancel)?;
    if args.json {
        let document = document(&input.design, (args.direction, args.l2), &answer, &found, &lines);
        output::print_json(&output::timed(document, begun.elapsed().as_secs_f64()))?;
        return Ok(exit::of_answer(answer.status));
    }
    let name = &input.design.name;
    say!(
        "{name} along {}\u{b0} at l2 {}: l1 {value:.9}, {}, cell {}",
        args.direction,
        args.l2,
        answer.status.name(),
        model.cell
    );
    let (mut still, mut printed) = (Vec::new(), 0);
    for line in &lines {
        if line.largest() <= NO_CHANGE {
            still.push(line.number.as_str());
            continue;
        }
        print(line, printed == 0, args.solve > 0);
        printed += 1;
    }
    if !still.is_empty() {
        say!("  no change: {}", still.join(", "));
    }
    if !found.forces_are_unique() {
        say!(
            "  several choices of forces hold this state; changes to both sides are by the least and the largest of them"
        );
    }
    if found.forces_are_unique() && lines.iter().any(|line| !line.images_tie && line.slope.is_kink()) {
        say!("  another chain of links is taut without force; it bounds changes to one side");
    }
    if lines.iter().any(|line| line.images_tie) {
        say!(
            "  states that symmetries of the design make of each other tie; a change that breaks the symmetry has the best of them"
        );
    }
    if printed > 0 && args.solve == 0 {
        say!("  changes are of first order, and may hold over a part of the step only; --solve N solves the first N");
    }
    if found.loose_motions() > 0 {
        say!("  {} motions of loose rings change nothing here", found.loose_motions());
    }
    Ok(exit::of_answer(answer.status))
}

/// Solves the limits of the changed designs for the first numbers that matter, to both sides at a kink.
fn solve(
    args: &Args,
    lines: &mut [NumberChange],
    design: &Design,
    (question, value): (&Question, f64),
    cancel: &AtomicBool,
) -> Result<()> {
    for line in lines.iter_mut().filter(|line| line.largest() > NO_CHANGE).take(args.solve) {
        for side in [1, 0].into_iter().take(if line.slope.is_kink() { 2 } else { 1 }) {
            let changed = line.changed(design, side == 1);
            let sheet = changed.and_then(|design| Sheet::in_cells(&design, args.cell.clone()).ok());
            let Some(sheet) = sheet else {
                line.solved[side] = Some(SolvedChange { status: None, change: None });
                continue;
            };
            let answer = sheet.answer_until(question, cancel).map_err(|e| refused(&e))?;
            if answer.status == Status::Interrupted {
                let problem = format!("interrupted while {} was changed", line.number);
                return Err(wrong(exit::INTERRUPTED, problem, "give a smaller --solve"));
            }
            let change = answer.limit().map(|limit| limit - value);
            line.solved[side] = Some(SolvedChange { status: Some(answer.status), change });
        }
    }
    Ok(())
}

fn print(line: &NumberChange, first: bool, with_solved: bool) {
    let column = |words: &str| if with_solved { format!("  {words:>14}") } else { String::new() };
    if first {
        let (number, step, change, solved) = ("number", "step", "change of l1", column("solved anew"));
        say!("  {number:<34} {step:>12}  {change:>13}{solved}  through");
    }
    let number = |x: f64| match (x * 1e6).round() {
        0.0 => "0".to_owned(),
        _ => format!("{x:+.6}"),
    };
    let change = |x: Option<f64>| x.map_or("no state".to_owned(), number);
    let solved = |side: usize| {
        column(&line.solved[side].map_or(String::new(), |solved| match (solved.change, solved.status) {
            (Some(change), _) => number(change),
            (None, status) => status.map_or("no design", Status::name).to_owned(),
        }))
    };
    let [back, forward] = line.changes();
    let through: Vec<String> =
        line.through.iter().map(|(pair, share)| format!("{pair} {:.0} %", share * 100.0)).collect();
    let (words, through) = (&line.step_words, through.join(", "));
    say!("  {:<34} {words:>12}  {:>13}{}  {through}", line.number, change(forward), solved(1));
    if line.slope.is_kink() {
        say!("  {:<34} {:>12}  {:>13}{}", "", format!("-{words}"), change(back), solved(0));
    }
}
