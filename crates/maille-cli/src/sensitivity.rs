//! `maille sensitivity`: how a limit changes with the numbers of its design.

use crate::{
    effort::SearchArgs,
    exit::{self, refused, wrong},
    input::Input,
    interrupt,
    numbers::{finite, positive, read},
    output::{self, say},
};
use maille::{
    model::{Model, RingPair},
    question::Question,
    sensitivity::{DesignVector, OneSided, Sensitivity, Slope},
    survey::CellChoice,
};
use maille_io::mesh::millimetres;
use miette::Result;
use serde_json::{Value, json};
use std::{process::ExitCode, time::Instant};

/// How a limit changes with the numbers of its design
///
/// The forces of a certified limit give its derivative by every number: the wire, each ring's radii, offset and tilt, the spacing and
/// the lattice vectors. Nothing is solved anew, so the changes are those of first order. The numbers are listed by how much they
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
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input
    design: String,
    /// Direction of the pull, degrees counter-clockwise from x
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    direction: f64,
    /// Lateral strain that is held
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    l2: f64,
    /// Change of a length, in the file's unit [default: 0.1 mm; of a design without unit, 1 % of its reference radius]
    #[arg(long, value_parser = positive)]
    step: Option<f64>,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive)]
    minor_radius: Option<f64>,
    /// Cell: 1x1, 2x1, …, an integer matrix as "1,0;-1,2", or auto
    #[arg(long, default_value = "auto", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    #[command(flatten)]
    search: SearchArgs,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
}

/// One line of the table.
struct Line {
    number: String,
    /// Change of the number: its size, and the size with its unit in words.
    step: f64,
    words: String,
    slope: OneSided,
    through: Vec<(String, f64)>,
}

impl Line {
    /// Changes of l1 for a step back and a step forward, where they are known.
    fn changes(&self) -> [Option<f64>; 2] {
        [self.slope.backward.finite().map(|x| -x * self.step), self.slope.forward.finite().map(|x| x * self.step)]
    }

    fn rank(&self) -> f64 {
        self.changes().into_iter().map(|change| change.map_or(f64::INFINITY, f64::abs)).fold(0.0, f64::max)
    }
}

/// A change below this is 0.
const NOTHING: f64 = 1e-12;
/// Pairs that a line names.
const NAMED: usize = 2;

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let question = args.search.of(Question::stretch_along(args.direction).with_lateral(args.l2));
    question.check().map_err(|e| refused(&e))?;
    let input = Input::read(&args.design, args.minor_radius)?;
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
    let lines = ranked(&input, &model, &found, args.step);
    if args.json {
        let document = json!({
            "design": input.design.name,
            "direction_deg": args.direction,
            "l2": args.l2,
            "cell": model.cell.to_string(),
            "status": answer.status.name(),
            "l1": value,
            "forces_are_unique": found.forces_are_unique(),
            "loose_motions": found.loose_motions(),
            "numbers": lines.iter().map(document).collect::<Vec<_>>(),
        });
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
        if line.rank() <= NOTHING {
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

fn print(line: &Line, first: bool) {
    if first {
        say!("  {:<34} {:>12}  {:>13}  through", "number", "step", "change of l1");
    }
    let change = |x: Option<f64>| x.map_or("no state".to_owned(), |x| format!("{x:+.6}"));
    let [back, forward] = line.changes();
    let through: Vec<String> =
        line.through.iter().map(|(pair, share)| format!("{pair} {:.0} %", share * 100.0)).collect();
    say!("  {:<34} {:>12}  {:>13}  {}", line.number, line.words, change(forward), through.join(", "));
    if line.slope.is_kink() {
        say!("  {:<34} {:>12}  {:>13}", "", format!("-{}", line.words), change(back));
    }
}

fn document(line: &Line) -> Value {
    let slope = |slope: Slope| slope.finite();
    let [back, forward] = line.changes();
    json!({
        "number": line.number,
        "step": line.step,
        "step_words": line.words,
        "change": forward,
        "change_back": back,
        "derivative": slope(line.slope.forward),
        "derivative_back": slope(line.slope.backward),
        "kink": line.slope.is_kink(),
        "through": line.through.iter().map(|(pair, share)| json!({ "pair": pair, "share": share })).collect::<Vec<_>>(),
    })
}

/// All numbers, those that matter most first.
fn ranked(input: &Input, model: &Model, found: &Sensitivity, step: Option<f64>) -> Vec<Line> {
    let design = &input.design;
    let unit = design.unit.as_deref();
    let mm = unit.and_then(millimetres);
    let length = step.unwrap_or_else(|| mm.map_or(design.reference_radius * 0.01, |mm| 0.1 / mm));
    let in_unit = unit.map_or(format!("{length}"), |unit| format!("{length} {unit}"));
    let of = |number: String, change: &DesignVector, step: f64, words: &str| Line {
        number,
        step,
        words: words.to_owned(),
        slope: found.one_sided(change),
        through: through(model, &found.by_pair(change)),
    };
    let mut lines = Vec::new();
    let wire = DesignVector::common_minor_radius(design);
    if wire.rings.iter().any(|ring| ring.minor_radius != 0.0) {
        lines.push(of("minor_radius, the wire".into(), &wire, length, &in_unit));
    }
    lines.push(of("spacing".into(), &DesignVector::spacing(design), 0.01, "1 %"));
    for (k, name) in ["a1.x", "a1.y", "a2.x", "a2.y"].into_iter().enumerate() {
        let mut change = DesignVector::zeros(wire.rings.len());
        change.lattice[k / 2][k % 2] = 1.0;
        lines.push(of(format!("lattice {name}"), &change, length, &in_unit));
    }
    let gradient = found.gradient();
    let mut number = 0;
    for element in &design.elements {
        for ring in 0..element.rings.len() {
            let label = match element.rings.len() {
                1 => format!("\"{}\"", element.name),
                _ => format!("\"{}\" ring {ring}", element.name),
            };
            let unit_change = |set: &dyn Fn(&mut maille::sensitivity::RingVector)| {
                let mut change = DesignVector::zeros(wire.rings.len());
                set(&mut change.rings[number]);
                change
            };
            lines.push(of(format!("{label} major_radius"), &unit_change(&|r| r.major_radius = 1.0), length, &in_unit));
            lines.push(of(format!("{label} minor_radius"), &unit_change(&|r| r.minor_radius = 1.0), length, &in_unit));
            // A ring alone is turned and moved as a whole, which a limit is sought over.
            if element.rings.len() > 1 {
                for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                    let change = unit_change(&|r| r.offset[k] = 1.0);
                    lines.push(of(format!("{label} offset.{axis}"), &change, length, &in_unit));
                }
                let steepest = gradient.rings[number].tilt;
                if steepest.norm() > NOTHING {
                    let axis = steepest.normalize();
                    let [x, y, z] = [axis.x, axis.y, axis.z].map(|x| (x * 100.0).round() / 100.0 + 0.0);
                    let change = unit_change(&|r| r.tilt = axis);
                    let name = format!("{label} tilt about ({x}, {y}, {z})");
                    lines.push(of(name, &change, 1f64.to_radians(), "1\u{b0}"));
                }
            }
            number += 1;
        }
    }
    lines.sort_by(|a, b| b.rank().total_cmp(&a.rank()));
    lines
}

/// The pairs that carry the most of a change, each with its share of all that is carried up or down.
fn through(model: &Model, parts: &[(RingPair, f64)]) -> Vec<(String, f64)> {
    let all: f64 = parts.iter().map(|(_, part)| part.abs()).sum();
    let label = |pair: &RingPair| {
        format!("{} on {}", model.ring_label(pair.ring_a, [0, 0]), model.ring_label(pair.ring_b, pair.shift))
    };
    parts.iter().take(NAMED).map(|(pair, part)| (label(pair), part.abs() / all)).collect()
}
