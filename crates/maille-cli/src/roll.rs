//! `maille roll`: how tightly a sheet can be rolled along each direction, both ways, as a record.

use crate::{
    exit::{self, refused, wrong},
    input::{DesignArgs, Input, file_name},
    interrupt,
    map::{RunArgs, pool},
    numbers::{Numbers, parse, read},
    output::{self, counted, say},
    progress::Progress,
    records::holds_record,
};
use maille::{
    Across, Design,
    question::{Effort, RollStrains},
    record::Status,
    survey::CellChoice,
};
use maille_io::{
    boundary::SURFACE,
    plot::{Layout, roll_svg},
    roll::{Axis, Kind, ROLL, Roll, RollError, RollFolder, RollKey, RollQuestion, Sought, find_rolls, rolls_json},
};
use maille_svg::svg_to_png;
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// How tightly a sheet can be rolled
///
/// For each direction and both ways: the largest curvature of the sheet along it before its rings lock, with the axis below the sheet and above it.
/// Neighbouring cells are images under turns about one axis, so the state is exact and certified as a limit is. The radius is that of the
/// neutral surface, at the mean distance of the elements from the axis; the stretch along it is left to the sheet. No bound is known: every answer
/// is the best of the starts that were searched. That no other state goes further is not proved. Writes a folder with rolls.csv (a row for each roll),
/// rolls.jsonl (the same with every state, from which an interrupted run continues), roll.json (what it is of), roll.svg and roll.png
/// (R by the radius, along each direction). The same command continues it, with more directions, too. With --wrap it asks for closed tubes: the state
/// with the widest gaps, and the least and largest radius and length. With --curvature it asks the same of a sheet that is bent so far: how much
/// it can still be stretched.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille roll european-4-in-1
  maille roll shirt.toml --directions 0,45,90 --free width,shear
  maille roll 3.1 --directions 90 --axis below --effort thorough
  maille roll european-4-in-1 --wrap 5:12:1                tubes of 5 to 12 cells round
  maille export --from maille-out/european-4-in-1-tubes --at wrap=8,axis=below    one of them, to print
  maille roll european-4-in-1 --directions 30 --curvature 0.02,0.05 --free width      how far it stretches when bent
  maille roll european-4-in-1 --l2 -0.02 --shear 0.03      rolled while pressed and sheared
  maille roll european-4-in-1 --json | jq '.rolls[] | [.direction_deg, .axis, .neutral_radius]'
  maille plot european-4-in-1-roll --style paper -o fig.pdf   its figure, for print
  maille verify european-4-in-1-roll   its states derived anew

Exit codes: 0 every roll is certified, 5 some are not (0 with --allow-incomplete), 130 interrupted.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Directions that are rolled, degrees counter-clockwise from x: a list, or first:last:step [default: 0:150:30; of tubes and of a chain that of a1]
    #[arg(long, value_parser = parse, allow_hyphen_values = true)]
    directions: Option<Numbers>,
    /// Closed tubes in place of the tightest rolls: so many cells along the direction go once round. A list, or first:last:step
    #[arg(long, value_name = "CELLS", value_parser = parse, conflicts_with_all = ["free", "l2", "shear"])]
    wrap: Option<Numbers>,
    /// Sheets of given curvature in place of the tightest rolls: the turn in radians for each unit of the written length. A list, or
    /// first:last:step
    #[arg(long, value_name = "CURVATURE", value_parser = parse, conflicts_with = "wrap")]
    curvature: Option<Numbers>,
    /// Where the axis is
    #[arg(long, value_enum, default_value_t = Side::Both)]
    axis: Side,
    /// What is left to the sheet: its width along the axis, its shear, or both, as width,shear; else they are held as written
    #[arg(long, value_enum, value_name = "STRAIN", value_delimiter = ',')]
    free: Vec<Free>,
    /// Stretch along the axis minus 1, where it is held
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    l2: f64,
    /// Shear, where it is held: how far lines along the direction lean along the axis
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    shear: f64,
    /// Cell: 1x1, 2x1, 2x2, …, an integer matrix as "1,0;-1,2", or auto: larger cells where an element presses on its own image
    #[arg(long, default_value = "1x1", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    /// How long to search each roll: low, normal, thorough, or a time such as 10s
    #[arg(long, default_value = "low", value_parser = read::<Effort>)]
    effort: Effort,
    /// Seed of the random starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder that is written [default: maille-out/NAME-roll]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    run: RunArgs,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// No progress and no summary
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Side {
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
    fn question(&self, design: &Design) -> Result<RollQuestion> {
        let free = |what: Free| self.free.contains(&what);
        let axes = match self.axis {
            Side::Both => Axis::BOTH.to_vec(),
            Side::Below => vec![Axis::Below],
            Side::Above => vec![Axis::Above],
        };
        let count = |cells: &f64| match *cells {
            cells if cells.fract() == 0.0 && (2.0..=1e6).contains(&cells) => Ok(cells as u32),
            cells => {
                Err(wrong(exit::USAGE, format!("--wrap {cells} is no number of cells"), "give whole numbers from 2"))
            }
        };
        let wrap: Vec<u32> = self.wrap.iter().flat_map(|wrap| &wrap.0).map(count).collect::<Result<_>>()?;
        let usual = || RollQuestion::usual_directions(design, !wrap.is_empty());
        Ok(RollQuestion {
            directions_deg: self.directions.as_ref().map_or_else(usual, |directions| directions.0.clone()),
            axes,
            free: Across {
                lateral_free: free(Free::Width) || !wrap.is_empty() && !design.lattice.single,
                shear_free: free(Free::Shear),
            },
            cells: self.cell.clone(),
            effort: self.effort,
            seed: self.seed,
            wrap,
            l2: self.l2,
            gamma: self.shear,
            curvatures: self.curvature.as_ref().map_or_else(Vec::new, |given| given.0.clone()),
        })
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let input = args.design.read()?;
    let question = args.question(&input.design)?;
    let sheet = input.sheet(args.cell.clone())?;
    question.check(&sheet).map_err(|e| refused(&e))?;
    let name = match question.kind() {
        Kind::Tightest => "roll",
        Kind::Tubes => "tubes",
        Kind::AtCurvature => "rolled",
    };
    let usual = || PathBuf::from("maille-out").join(format!("{}-{name}", file_name(&input.design.name)));
    let out = args.out.clone().unwrap_or_else(usual);
    output::folder(&out, "the rolls are a folder")?;
    if holds_record(&out) || out.join(SURFACE).is_file() {
        let problem = format!("{} holds a record of another kind", out.display());
        return Err(wrong(exit::RECORD, problem, "name another folder with --out"));
    }
    let (mut folder, rolls) = RollFolder::open(&out, &input.design, &question, args.run.overwrite)?;
    // Until all files are of this run, there is nothing to read.
    match fs::remove_file(out.join(ROLL)) {
        Err(e) if e.kind() != ErrorKind::NotFound => {
            return Err(Report::msg(e).wrap_err(format!("cannot replace {}", out.join(ROLL).display())));
        }
        _ => {}
    }
    let asked = question.rolls();
    let is_known = |asked: &RollKey| rolls.iter().any(|roll| roll.key() == *asked);
    let known = asked.iter().filter(|asked| is_known(asked)).count();
    let (cancel, pool) = (interrupt::flag(args.quiet)?, pool(args.run.threads)?);
    let begun = Instant::now();
    let progress = Progress::new("rolls", known, asked.len(), args.quiet);
    let mut done = known;
    let mut keep = |roll: &Roll| {
        // Those that come again went further.
        if done < asked.len() {
            done += 1;
            progress.step();
        }
        folder.keep(roll)
    };
    let rolls = pool.install(|| find_rolls(&sheet, &question, rolls, &cancel, &mut keep));
    let rolls = rolls.map_err(|e| match e {
        RollError::Asked(e) => refused(&e),
        RollError::Record(e) => e.into(),
    })?;
    progress.finish();
    write(&out, &folder, &input, &question, &rolls)?;
    let wall_s = begun.elapsed().as_secs_f64();
    let interrupted = stopped(&cancel);
    let shown: Vec<Roll> = rolls.into_iter().filter(|roll| asked.contains(&roll.key())).collect();
    if args.json {
        output::print_json(&output::timed(rolls_json(&input.design, &shown), wall_s))?;
    } else if !args.quiet {
        if question.kind() == Kind::Tightest {
            print(&question, &input.design, &shown, known, wall_s);
            say!("look at {}", out.join("roll.png").display());
        } else {
            print_at_turn(&question, &input.design, &shown, known, wall_s);
            if let Some(first) = shown.iter().find(|roll| roll.is_certified()) {
                say!("to print one: maille export --from {} --at {}", out.display(), first.key().place());
            }
        }
    }
    let incomplete = !shown.iter().all(Roll::is_certified);
    Ok(exit::ended(interrupted, args.run.code(incomplete), args.quiet))
}

fn stopped(cancel: &AtomicBool) -> bool {
    cancel.load(Ordering::Relaxed)
}

/// Writes the table, the figure, and what the rolls are of.
fn write(out: &Path, folder: &RollFolder<'_>, input: &Input, question: &RollQuestion, rolls: &[Roll]) -> Result<()> {
    if question.kind() == Kind::Tightest {
        let svg = roll_svg(&input.design, rolls, Layout::Beside);
        let png = svg_to_png(&svg, 2.0).into_diagnostic().wrap_err("cannot draw the figure")?;
        output::write(&out.join("roll.svg"), svg.as_bytes())?;
        output::write(&out.join("roll.png"), &png)?;
    }
    Ok(folder.finish(&input.design, question, rolls)?)
}

/// What of the sheet is held.
fn held(strains: &RollStrains) -> String {
    let Across { lateral_free, shear_free } = strains.free;
    let word = |name: &str, free: bool, value: f64| match (free, value) {
        (true, _) => format!("{name} free"),
        (false, 0.0) => format!("{name} held"),
        (false, value) => format!("{name} held at {value}"),
    };
    let [width, shear] = [word("l2", lateral_free, strains.l2), word("shear", shear_free, strains.shear)];
    format!("{width}, {shear}")
}

fn print(question: &RollQuestion, design: &Design, rolls: &[Roll], known: usize, wall_s: f64) {
    let unit = design.unit.as_deref().map_or("radius".to_owned(), |unit| format!("radius, {unit}"));
    let before = if known > 0 { format!(", {known} of them there before") } else { String::new() };
    say!("{}: the tightest rolls, {}{before}; {wall_s:.1} s", design.name, held(&question.strains()));
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
        let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4}"));
        say!(
            "  {:>9}\u{b0}  {:<5} {:>12} {:>12} {:>9}  {:<13} {}",
            roll.direction_deg,
            roll.axis.name(),
            number(roll.neutral_radius),
            number(roll.neutral_radius.map(|radius| radius / design.reference_radius)),
            number(roll.neutral_stretch),
            roll.status.name(),
            roll.cell
        );
        if let Some(note) = &roll.note {
            say!("              {note}");
        }
    }
    say!(
        "radius: of the neutral surface, at the mean distance of the elements from the axis; stretch: of lines along it"
    );
    let local = rolls.iter().filter(|roll| roll.status == Status::Local).count();
    if local > 0 {
        say!("{} certified; that no other state bends further is not proved", counted(local, "roll"));
    }
    let chances = rolls.iter().filter_map(|roll| roll.better_chance);
    if let Some(most) = chances.max_by(f64::total_cmp) {
        say!("estimated chance that another start of the same kinds bends further: {:.1} % at most", 100.0 * most);
    }
}

/// One line for each turn that was given: gaps, and radii or stretches with lengths.
fn print_at_turn(question: &RollQuestion, design: &Design, rolls: &[Roll], known: usize, wall_s: f64) {
    let tubes = question.kind() == Kind::Tubes;
    let unit = design.unit.as_deref().map_or(String::new(), |unit| format!(", {unit}"));
    let before = if known > 0 { format!(", {known} of {} states there before", rolls.len()) } else { String::new() };
    let what =
        if tubes { "closed tubes".to_owned() } else { format!("at given curvature, {}", held(&question.strains())) };
    say!("{}: {what}{before}; {wall_s:.1} s", design.name);
    let head = match tubes {
        true => ["cells".to_owned(), format!("radius{unit}")],
        false => ["curvature".to_owned(), "stretch".to_owned()],
    };
    let gap = format!("widest gap{unit}");
    say!(
        "  {:>10}  {:<5} {:>9}  {gap:>16}  {:>20}  {:>24}  status",
        "direction",
        "axis",
        head[0],
        head[1],
        "length, by that written",
    );
    let turn = |roll: &Roll| (roll.direction_deg, roll.axis, roll.wrap, roll.at_curvature);
    for states in rolls.chunk_by(|a, b| turn(a) == turn(b)) {
        let (first, mut statuses) = (&states[0], states.iter().map(|roll| roll.status.name()).collect::<Vec<_>>());
        statuses.sort_unstable();
        statuses.dedup();
        let of = |sought: Sought, value: fn(&Roll) -> Option<f64>| {
            states.iter().find(|roll| roll.sought == sought).and_then(value)
        };
        let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4}"));
        let range = |ends: [Sought; 2], value: fn(&Roll) -> Option<f64>| {
            let [least, most] = ends.map(|sought| number(of(sought, value)));
            format!("{least} to {most}")
        };
        let around: fn(&Roll) -> Option<f64> =
            if tubes { |roll| roll.neutral_radius } else { |roll| roll.neutral_stretch };
        let length: fn(&Roll) -> Option<f64> = |roll| roll.l2.map(|l2| 1.0 + l2);
        let lengths = match question.strains().free.lateral_free {
            true => range([Sought::Shortest, Sought::Longest], length),
            false => number(length(first)),
        };
        let given = first.wrap.map(|cells| cells.to_string());
        let given = given.or(first.at_curvature.map(|curvature| curvature.to_string()));
        say!(
            "  {:>9}\u{b0}  {:<5} {:>9}  {:>16}  {:>20}  {lengths:>24}  {}",
            first.direction_deg,
            first.axis.name(),
            given.unwrap_or_default(),
            number(of(Sought::Roomiest, |roll| roll.min_gap)),
            range([Sought::Narrowest, Sought::Widest], around),
            statuses.join(", ")
        );
        states.iter().find_map(|roll| roll.note.as_deref()).into_iter().for_each(|note| say!("              {note}"));
    }
    say!(
        "{}: at the mean distance of the elements from the axis; of the starts that were searched, the best",
        head[1].split(',').next().unwrap_or_default()
    );
}
