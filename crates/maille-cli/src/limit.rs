//! `maille limit`: one question in the space of in-plane strains, answered on the screen.

use crate::{
    certificate,
    effort::SearchArgs,
    exit::{self, refused, wrong},
    input::DesignArgs,
    interrupt,
    numbers::{finite, one_of, read},
    output::{self, say},
};
use clap::builder::TypedValueParser;
use maille::{
    answer::FreeRanges,
    question::{Goal, Question, Sense, Strain},
    record::Status,
    survey::CellChoice,
};
use maille_io::answer::StrainAnswer;
use miette::Result;
use std::{process::ExitCode, str::FromStr, time::Instant};

/// One strain as large or as small as can be, the others held or free
///
/// Strains are Green strains of the sheet, E = (C - 1)/2 with C = F^T F, relative to the spacing of the design: exx and eyy
/// along its axes, or with --direction along axes turned by an angle; exy is the tensor shear (half the engineering shear). exx = s + s^2/2 where lines along x are stretched by 1 + s.
/// What is named by neither --fix nor --free is held at 0. The largest exx or eyy with no shear, or with width and shear free, is a
/// pull: the limit is that of `characterize` along that direction. With --minimize all cells up to 3x3 are solved and listed with
/// their starts and the distinct limits that these led to; as a still larger cell can fold further, such an answer is the best
/// that was found, and never global.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille limit european-4-in-1 --maximize eyy --free exx,exy
  maille limit 1.1 --maximize exx --fix eyy=0.05 --free exy
  maille limit 1.1 --minimize exx --direction 30 --free eyy,exy      compressed along 30 degrees
  maille limit european-4-in-1 --minimize eyy --free exx,exy --cell 1x5 --starts 64
  maille limit 3.1 --maximize exy --json

Exit codes: 0 certified, or proved that what is held cannot be; 5 no certified state was found, 130 interrupted.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// The strain to make as large as can be
    #[arg(long, value_name = "STRAIN", value_parser = strain(), conflicts_with = "minimize")]
    maximize: Option<Strain>,
    /// The strain to make as small as can be
    #[arg(long, value_name = "STRAIN", value_parser = strain())]
    minimize: Option<Strain>,
    /// Strains that are held, as eyy=0.05,exy=0
    #[arg(long, value_name = "STRAIN=VALUE", value_delimiter = ',', allow_hyphen_values = true)]
    fix: Vec<Held>,
    /// Strains that are left to the sheet, as eyy,exy
    #[arg(long, value_name = "STRAIN", value_parser = strain(), value_delimiter = ',')]
    free: Vec<Strain>,
    /// Direction of the strains' x axis, degrees counter-clockwise from that of the design
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    direction: f64,
    /// Cell: 1x1, 2x1, …, an integer matrix as "1,0;-1,2", or auto: larger cells where an element presses on its own image or a wave
    /// through the sheet is unstable, and all up to 3x3 with --minimize
    #[arg(long, default_value = "auto", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    #[command(flatten)]
    search: SearchArgs,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
}

/// A strain with the value at which it is held.
#[derive(Clone, Copy, Debug)]
struct Held {
    strain: Strain,
    value: f64,
}

impl FromStr for Held {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("\"{text}\" is not a strain with a value; write eyy=0.05");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let strain = Strain::ALL.into_iter().find(|strain| strain.name() == name.trim()).ok_or_else(wrong)?;
        let value = value.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong)?;
        Ok(Held { strain, value })
    }
}

/// One of the names of strains.
fn strain() -> impl TypedValueParser<Value = Strain> {
    one_of(Strain::ALL.map(Strain::name))
}

fn question(args: &Args) -> Result<Question> {
    let Some((component, sense)) =
        args.maximize.map(|s| (s, Sense::Largest)).or(args.minimize.map(|s| (s, Sense::Least)))
    else {
        return Err(wrong(exit::USAGE, "no strain is named", "give --maximize exx, or --minimize exx"));
    };
    let goal = Goal::Strain {
        component,
        direction_deg: args.direction,
        fix: args.fix.iter().map(|held| (held.strain, held.value)).collect(),
        free: args.free.clone(),
    };
    Ok(args.search.of(Question::new(goal, sense)))
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let question = question(args)?;
    question.check().map_err(|e| refused(&e))?;
    let input = args.design.read()?;
    let sheet = input.sheet(args.cell.clone())?;
    let cancel = interrupt::flag(false)?;
    let begun = Instant::now();
    let found = sheet.answer_until(&question, &cancel).map_err(|e| refused(&e))?;
    let model = sheet.model_of(&found);
    let Some(answer) = StrainAnswer::new(&input.design.name, &question, &model, &found) else {
        unreachable!("a strain is asked for")
    };
    let wall_s = begun.elapsed().as_secs_f64();
    match args.json {
        true => output::print_json(&output::timed(answer.json(), wall_s))?,
        false => print(&answer, wall_s),
    }
    Ok(exit::of_answer(found.status))
}

fn print(answer: &StrainAnswer<'_>, wall_s: f64) {
    let found = answer.found;
    let most = answer.question.sense.name();
    let turned = match answer.direction.degrees() {
        0.0 => String::new(),
        angle => format!(" with x along {angle}\u{b0}"),
    };
    say!("{}, {most} {}{turned}: {}", answer.design, answer.goal.name(), answer.status());
    match found.status {
        Status::L2Unreachable => return say!("  proved: no state of the sheet has the strains that are held"),
        Status::Unbounded => return say!("  nothing holds the sheet along this direction: it comes apart"),
        Status::InfeasibleStart => return say!("  the rings of the design overlap, and could not be freed of that"),
        Status::L2NotReached => {
            let starts = output::counted(found.n_starts.unwrap_or(0) as usize, "start");
            return say!("  {starts} did not reach the strains that are held; nothing is proved");
        }
        Status::Uncertified if found.value.is_none() => {
            return say!("  no chain of links and no contact held it where the search was stopped; nothing is proved");
        }
        _ if found.value.is_none() => return,
        _ => {}
    }
    for strain in Strain::ALL {
        // Rounding shows no sign of a 0.
        let round = |x: f64, digits: f64| (x * digits).round() / digits + 0.0;
        let value = round(answer.strain(strain), 1e9);
        match answer.range(strain).map(|range| range.map(|x| round(x, 1e6))) {
            // One of many states, which says nothing of the others.
            Some([least, largest]) if largest - least > FreeRanges::ONE_VALUE => {
                say!("  {}   {:>15}  free: {least:.6} to {largest:.6}", strain.name(), "");
            }
            _ => say!("  {}   {value:>15.9}  {}", strain.name(), answer.role(strain)),
        }
    }
    if let Some(l1) = answer.stretch() {
        say!("  l1    {l1:>15.9}  of lines along {}", answer.goal.name());
    }
    if let Some(bound) = found.bound {
        say!("  bound {:>15.9}  proved by the chains of links", bound);
    }
    say!("  cell {}; {}; {wall_s:.2} s", answer.model.cell, certificate::search(found));
    if found.by_cell.len() > 1 || answer.question.sense == Sense::Least {
        for cell in &found.by_cell {
            say!("    {}", cell.label());
        }
    }
    if let Some(c) = &found.certificate {
        say!("  {}", certificate::line(c));
    }
}
