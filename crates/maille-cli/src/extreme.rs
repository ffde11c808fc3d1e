//! `maille tightest` and `maille roomiest`: the thickest wire of a weave, its state with the most room, and its closest cell with a
//! gap; the search of `--at roomiest` and `--min-gap` too.

use crate::{
    certificate,
    effort::SearchArgs,
    exit::{self, refused, wrong},
    input::{DesignArgs, Input},
    interrupt,
    map::pool,
    output::{self, Replace, say},
    units::{Length, parse_length},
};
use maille::{
    answer::Answer,
    design::Design,
    lattice::Cell,
    model::Model,
    question::{Goal, Question, Sense},
    record::Status,
    search::extreme::{Extreme, Size},
    sheet::Sheet,
};
use maille_io::{answer, millimetres, write_design};
use miette::{Report, Result};
use std::{path::PathBuf, process::ExitCode, time::Instant};

/// The thickest wire with which a weave exists
///
/// All minor radii are made as large as can be, over all poses and the lattice. The locked state is certified as a limit is:
/// no small motion allows a thicker wire. That no distant state does is not proved; `--effort thorough` searches further.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille tightest european-4-in-1
  maille tightest 1.1 --lattice fixed          with the spacing of the design
  maille tightest 2 --effort thorough --save tight-2.toml
  maille render tight-2.toml --tile 6x6

Exit codes: 0 certified, 5 no certified state was found, 130 interrupted.")]
pub struct TightestArgs {
    #[command(flatten)]
    common: Common,
}

/// The state of a weave with the widest gaps
///
/// The smallest gap between any two rings is made as large as can be, over all poses: how to print a sheet in place so
/// that its rings do not fuse. With --min-gap it is the other way round: the gap is given, and the cell is made as small
/// as can be.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille roomiest european-4-in-1
  maille roomiest 3.1 --lattice free --save roomy.toml
  maille export 3.1 --at roomiest --tile 8x8          the same state as a mesh, to print
  maille roomiest shirt.toml --min-gap 0.3mm --save close.toml

Exit codes: 0 certified, 5 no certified state was found, 130 interrupted.")]
pub struct RoomiestArgs {
    #[command(flatten)]
    common: Common,
    /// Find the closest cell instead: the smallest area with every gap at least this, as 0.3mm; the lattice is free. Where
    /// the file has no unit of length, one unit is 1 mm
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, conflicts_with = "lattice")]
    min_gap: Option<Length>,
}

#[derive(clap::Args)]
struct Common {
    #[command(flatten)]
    design: DesignArgs,
    /// Whether the lattice may change [default: free for tightest, fixed for roomiest]
    #[arg(long, value_enum)]
    lattice: Option<Lattice>,
    #[command(flatten)]
    search: SearchArgs,
    /// Write the state as a design file
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    #[command(flatten)]
    replace: Replace,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
}

/// Whether the lattice may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Lattice {
    Free,
    Fixed,
}

/// Runs `tightest`.
pub fn tightest(args: &TightestArgs) -> Result<ExitCode> {
    run(&args.common, |_| Extreme::ThickestWire)
}

/// Runs `roomiest`.
pub fn roomiest(args: &RoomiestArgs) -> Result<ExitCode> {
    run(&args.common, |design| match args.min_gap {
        Some(gap) => closest(design, in_unit(design, gap)),
        None => Extreme::LargestClearance,
    })
}

/// A length in the unit of the design's file; without one its unit is taken as a millimetre, with a note.
pub fn in_unit(design: &Design, length: Length) -> f64 {
    let mm = design.unit.as_deref().and_then(millimetres).unwrap_or_else(|| {
        eprintln!("note: the design has no unit of length: one unit of the file is taken as 1 mm");
        1.0
    });
    length.mm / mm
}

/// The closest cell with this gap, in the file's unit.
pub fn closest(design: &Design, gap: f64) -> Extreme {
    Extreme::ClosestCell { gap: gap / design.reference_radius }
}

fn run(args: &Common, what: impl FnOnce(&Design) -> Extreme) -> Result<ExitCode> {
    args.save.iter().try_for_each(|file| args.replace.check(file))?;
    let input = args.design.read()?;
    let what = what(&input.design);
    let begun = Instant::now();
    let answer = search(&input, what, args.lattice, args.search, args.threads)?;
    let found = &answer.found;
    if args.json {
        let document = answer::extreme(&input.design, answer.model(), what, answer.lattice_free, found);
        output::print_json(&output::timed(document, begun.elapsed().as_secs_f64()))?;
    } else if let Some(problem) = answer.impossible() {
        return Err(problem);
    } else {
        answer.print(begun.elapsed().as_secs_f64());
    }
    if let Some(problem) = answer.too_thick() {
        eprintln!("note: the gaps between elements allow so thick a wire, but a curve cannot have it: {problem}");
    }
    if let (Some(file), Some(_)) = (&args.save, found.value) {
        output::write(file, write_design(&what.design(found, &input.design, answer.model())).as_bytes())?;
        eprintln!("{}", file.display());
    }
    Ok(exit::of_answer(found.status))
}

/// The extreme state, searched for.
pub fn search<'a>(
    input: &'a Input,
    what: Extreme,
    lattice: Option<Lattice>,
    search: SearchArgs,
    threads: Option<u16>,
) -> Result<Found<'a>> {
    let sheet = input.sheet(Cell::PRIMITIVE.into())?;
    if sheet.model().links.is_empty() {
        let help = "`maille inspect` shows links; rings that hold each other bound the wire, and nothing else does";
        return Err(wrong(exit::DESIGN, "no rings of this design are linked", help));
    }
    let lattice_free = lattice.map_or(what != Extreme::LargestClearance, |lattice| lattice == Lattice::Free);
    let question = search.of(match what {
        Extreme::ThickestWire => Question::new(Goal::Wire { lattice_free }, Sense::Largest),
        Extreme::LargestClearance => Question::new(Goal::Clearance { lattice_free }, Sense::Largest),
        Extreme::ClosestCell { gap } => Question::closest_cell(gap * sheet.model().unit),
    });
    let cancel = interrupt::flag(false)?;
    let found = pool(threads)?.install(|| sheet.answer_until(&question, &cancel)).map_err(|e| refused(&e))?;
    Ok(Found { input, sheet, what, lattice_free, found })
}

/// The extreme state as a design, and a line on what it is. Fails where no state was found, or Ctrl-C stopped the search.
pub fn as_design(
    input: &Input,
    what: Extreme,
    lattice: Option<Lattice>,
    threads: Option<u16>,
) -> Result<(Design, String)> {
    let answer = search(input, what, lattice, SearchArgs::USUAL, threads)?;
    if let Some(problem) = answer.impossible() {
        return Err(problem);
    }
    let name = &input.design.name;
    match (answer.found.status, answer.found.value) {
        (Status::Interrupted, _) => Err(wrong(exit::INTERRUPTED, "interrupted", "nothing was written")),
        (_, None) => {
            let problem = format!("no start led to a state of {name} without overlap");
            Err(wrong(exit::INCOMPLETE, problem, "--lattice free, or a smaller --minor-radius"))
        }
        (status, Some(_)) => {
            let unit = unit(&input.design);
            // The gap of the roomiest state is said where it is known in millimetres.
            let size = match what {
                Extreme::LargestClearance | Extreme::ClosestCell { .. } => String::new(),
                Extreme::ThickestWire => {
                    format!(": minor radius {:.9}{unit}", what.sizes(&answer.found, answer.model())[0].minor_radius)
                }
            };
            Ok((
                answer.what.design(&answer.found, &input.design, answer.model()),
                format!("{}, {}{size}", answer.title(), status.name()),
            ))
        }
    }
}

/// What `--at` calls it.
pub fn word(what: Extreme) -> &'static str {
    match what {
        Extreme::ThickestWire => "tightest",
        Extreme::LargestClearance => "roomiest",
        Extreme::ClosestCell { .. } => "closest",
    }
}

/// The file's unit, with a space before it.
fn unit(design: &Design) -> String {
    design.unit.as_deref().map(|unit| format!(" {unit}")).unwrap_or_default()
}

/// What was asked, and what was found.
pub struct Found<'a> {
    input: &'a Input,
    sheet: Sheet,
    what: Extreme,
    lattice_free: bool,
    pub found: Answer,
}

impl Found<'_> {
    /// The model of the state.
    pub fn model(&self) -> &Model {
        self.sheet.model()
    }

    fn title(&self) -> String {
        let lattice = if self.lattice_free { "free" } else { "fixed" };
        let words = match self.what {
            Extreme::ThickestWire => "thickest wire".to_owned(),
            Extreme::LargestClearance => "widest gaps".to_owned(),
            Extreme::ClosestCell { gap } => format!("closest cell with gaps of {}", self.length(gap)),
        };
        format!("{}, {words}, lattice {lattice}", self.input.design.name)
    }

    /// A length in reference radii, in the file's unit, with up to six digits.
    fn length(&self, radii: f64) -> String {
        let length = radii * self.model().unit;
        let decimals = (5.0 - length.abs().log10().floor()).clamp(0.0, 300.0) as usize;
        let digits: f64 = format!("{length:.decimals$}").parse().unwrap_or(length);
        format!("{digits}{}", unit(&self.input.design))
    }

    /// The error where no cell has the gap that was asked for: it names the widest that was found.
    fn impossible(&self) -> Option<Report> {
        let (Extreme::ClosestCell { gap }, model) = (self.what, self.model()) else { return None };
        let widest = self.what.widest_instead(&self.found, model)?;
        let problem = format!(
            "no cell of {} with gaps of {} was found: the widest gap is {}",
            self.input.design.name,
            self.length(gap),
            self.length(widest / model.unit)
        );
        Some(wrong(
            exit::INCOMPLETE,
            problem,
            "give a smaller --min-gap, or take thinner wire or a larger inner diameter",
        ))
    }

    /// Why a curve cannot have the wire that was found: its bends are too tight, or it runs into itself. No pair of elements says so.
    fn too_thick(&self) -> Option<String> {
        self.found.value.filter(|_| self.what == Extreme::ThickestWire)?;
        let problems = self.what.design(&self.found, &self.input.design, self.model()).problems();
        let of_curve = problems.iter().find(|problem| problem.field.contains(".curves["));
        of_curve.map(|problem| format!("{}: {}", problem.field, problem.problem))
    }

    fn print(&self, wall_s: f64) {
        let found = &self.found;
        let unit = unit(&self.input.design);
        say!("{}: {}", self.title(), found.status.name());
        if found.value.is_none() {
            say!("  no start led to a state without overlap; try --effort thorough, or --lattice free");
            return;
        }
        if let Some(share) = self.what.area_share(found) {
            say!("  area            {share:.9} of the written cell's");
        }
        if let Some(gap) = self.what.clearance(found, self.model()) {
            let mm = self.input.design.unit.as_deref().and_then(millimetres).filter(|mm| *mm != 1.0);
            say!("  smallest gap    {gap:.9}{unit}{}", mm.map_or(String::new(), |mm| format!(" ({:.6} mm)", gap * mm)));
        }
        if self.what.clearance(found, self.model()).is_some_and(|gap| gap < 0.0) {
            say!("  the rings overlap: no start led to a state without overlap, which proves nothing");
            say!("  try --effort thorough, --lattice free, thinner wire or a larger inner diameter");
        }
        for size in self.what.sizes(found, self.model()) {
            let Size { major_radius, minor_radius } = size;
            say!(
                "  minor radius    {minor_radius:.9}{unit} at major radius {}{unit}",
                maille_io::numbers::nine_digits(major_radius)
            );
            say!("  aspect ratio    {:.6} = inner diameter / wire diameter", size.aspect_ratio());
        }
        for (name, a) in [("a1", found.state.a1), ("a2", found.state.a2)].map(|(n, a)| (n, a * self.model().unit)) {
            // + 0.0 makes −0 equal to 0
            let [x, y] = [a.x, a.y].map(|x| (x * 1e6).round() / 1e6 + 0.0);
            say!("  {name}              {x:.6}, {y:.6}{unit}");
        }
        say!("  {}; {wall_s:.1} s", certificate::search(found));
        if let Some(c) = &found.certificate {
            say!("  {}", certificate::line(c));
        }
    }
}
