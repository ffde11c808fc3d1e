//! `maille sensitivity`: how a limit changes with the numbers of its design.

use crate::{
    effort::SearchArgs,
    exit::{self, refused, wrong},
    input::DesignArgs,
    interrupt,
    numbers::{finite, positive, read},
    output::{self, say},
};
use maille::{question::Question, sensitivity::Sensitivity, survey::CellChoice};
use maille_io::sensitivity::{NO_CHANGE, NumberChange, document, ranked};
use miette::Result;
use std::{process::ExitCode, time::Instant};

/// How a limit changes with the numbers of its design
///
/// The forces of a certified limit give its derivative by every number: the wire, each ring's radii, offset and tilt, the spacing,
/// the lattice vectors, and the parameters of the file. Nothing is solved anew, so the changes are those of first order. The numbers are listed by how much they
/// matter, with the pairs of rings through which they act. Where the forces are not unique, a number can act differently to both sides:
/// then both changes are given. Centres of elements change nothing, as a limit is sought over all positions.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille sensitivity 1.1 --direction 30
  maille sensitivity european-4-in-1 --direction 90 --l2 -0.05 --step 0.05
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
    let lines = ranked(&input.design, &found, args.step);
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
        print(line, printed == 0);
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
    if found.loose_motions() > 0 {
        say!("  {} motions of loose rings change nothing here", found.loose_motions());
    }
    Ok(exit::of_answer(answer.status))
}

fn print(line: &NumberChange, first: bool) {
    if first {
        say!("  {:<34} {:>12}  {:>13}  through", "number", "step", "change of l1");
    }
    let change = |x: Option<f64>| {
        x.map_or("no state".to_owned(), |x| match (x * 1e6).round() {
            0.0 => "0".to_owned(),
            _ => format!("{x:+.6}"),
        })
    };
    let [back, forward] = line.changes();
    let through: Vec<String> =
        line.through.iter().map(|(pair, share)| format!("{pair} {:.0} %", share * 100.0)).collect();
    say!("  {:<34} {:>12}  {:>13}  {}", line.number, line.step_words, change(forward), through.join(", "));
    if line.slope.is_kink() {
        say!("  {:<34} {:>12}  {:>13}", "", format!("-{}", line.step_words), change(back));
    }
}
