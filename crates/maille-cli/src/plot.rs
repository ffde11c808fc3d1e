//! `maille plot`: records compared in a figure.

use crate::{
    boundary::surface_svg,
    exit::{self, wrong},
    figure::FigureArgs,
    fit_record,
    input::file_name,
    records, table,
};
use maille_io::{
    Quantity,
    plot::{
        Cost, Layout, NamedSimulation, OfStep, PolarPlot, Tolerance, cost_svg, difference_svg, force_svg,
        parameter_words, poisson_svg, polar_svg, radius_svg, roll_svg, run_svg,
    },
    record::{NamedRecord, Record, Reference, ReferenceCell, SIMULATION, SensitivityRow, open_simulation},
    roll::Kind as RollKind,
};
use miette::Result;
use std::path::{Path, PathBuf};

/// Records in one figure: limits against direction, their spread, what they cost; force against stretch of simulations
///
/// Reads records and solves nothing. With several records colour and line tell them apart, as the legend says; markers
/// tell their l2.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille plot 1.1                                      maille-out/polar-1.1.svg and .png
  maille plot 1.1 1.2 --where l2=0                     two records of maille-out in one
  maille plot exact-3.1 energy-3.1 --kind steps -o steps.png
  maille plot 1.1 --tolerance minor_radius=0.05        of `maille characterize 1.1 --sensitivities`
  maille plot 1.1 -o small.png --scale 0.75 --palette   645 pixels wide, in few bytes
  maille plot 1.1 --style paper -o fig1.pdf             one column of a journal, 89 mm wide, letters of 7 points
  maille plot 1.1 --style paper --width 183mm --font-size 8 -o fig2.pdf    two columns
  maille plot r-0.05 r-0.1 r-0.2 --kind difference --quantity l1 -o spread.svg -o spread.png
  maille plot 1.1-free --kind poisson                  of `maille characterize 1.1 --lateral free --out maille-out/1.1-free`
  maille plot r-0.05 r-0.1 r-0.2 --kind radius --where 'direction=0|45,l2=0'    limits against the minor radius
  maille plot maille-out/1.1 --kind times --where 'direction<=90'
  maille plot 1.1-fit                                  of `maille fit`: before, after, and what was wanted
  maille plot 1.1 3.1 --reference largest-cell --where l2=0    each from its largest cell: comparable, whatever their files start from
  maille plot european-4-in-1-roll                     of `maille roll`: how tightly it rolls, both ways
  maille plot 1.1-simulate --kind force                of `maille simulate 1.1 --fix left --pull right=8,0,0 --steps 40`

Kinds: polar shows limits against the direction of the pull, 0\u{b0} right, counter-clockwise; difference the largest \
less the smallest limit of all directions, against l2; radius \
limits against the minor radius, a curve for each design, direction and l2; poisson the ratio of width to length where the width was free; steps and times the solver's iterations and the wall time of \
each limit; force how hard a finite sheet of `maille simulate` is pulled, against its stretch. --where takes the conditions of `maille table`.")]
pub struct Args {
    /// Folders of records, for force those of simulations, or the folder of one surface or roll; NAME stands for maille-out/NAME
    #[arg(required = true, value_name = "RECORD")]
    records: Vec<PathBuf>,
    /// What is shown
    #[arg(long, value_enum, default_value_t = Kind::Polar)]
    kind: Kind,
    /// Of a limit: 1 + l1, l1, or lambda1 - 1 [default: stretch; lambda1 for differences, as in the thesis]
    #[arg(long, value_enum)]
    quantity: Option<Shown>,
    /// The cell that stretches are measured from: of the design file, or of greatest or least area among the start and
    /// all limits of the record. A line of rings along D at a limit with lattice A is stretched by 1/|A_ref A^-1 D|
    #[arg(long, value_enum, default_value_t = MeasuredFrom::Start, value_name = "CELL")]
    reference: MeasuredFrom,
    /// Only rows that meet these conditions, as l2=0; may be given several times
    #[arg(long = "where", value_name = "CONDITIONS", value_parser = table::conditions, allow_hyphen_values = true)]
    conditions: Vec<table::Conditions>,
    /// Shade what a number that is off to both sides does to the limits, as minor_radius=0.05: a number of sensitivities.csv, and how
    /// far it is off in its unit (polar plots of one record with --sensitivities)
    #[arg(long, value_name = "NUMBER=AMOUNT", value_parser = tolerance)]
    tolerance: Option<Tolerance>,
    #[command(flatten)]
    figure: FigureArgs,
}

/// `minor_radius=0.05`.
fn tolerance(text: &str) -> Result<Tolerance, String> {
    let parts = text.split_once('=').map(|(number, amount)| (number.trim(), amount.trim().parse::<f64>()));
    match parts {
        Some((number, Ok(amount))) if !number.is_empty() && amount.is_finite() && amount > 0.0 => {
            Ok(Tolerance { number: number.into(), amount })
        }
        _ => Err(format!("\"{text}\" is no number of the design with an amount above 0, as minor_radius=0.05")),
    }
}

/// The derivatives by the tolerance's number in the folder of the record.
fn derivatives(args: &Args, tolerance: &Tolerance) -> Result<Vec<SensitivityRow>> {
    let usual = matches!(args.quantity, None | Some(Shown::Stretch | Shown::L1));
    if args.kind != Kind::Polar || args.records.len() != 1 || !usual || args.reference != MeasuredFrom::Start {
        let help = "name one record, with --kind polar and --quantity stretch or l1, without --reference";
        return Err(wrong(exit::USAGE, "--tolerance is for polar plots of the limits of one record", help));
    }
    let folder = records::folder(&args.records[0]);
    let found = Record::read_sensitivities(&folder)?.ok_or_else(|| {
        let problem = format!("the record {} has no sensitivities.csv", folder.display());
        let help = "give its `maille characterize` again with --sensitivities: it writes them, and solves nothing that is there";
        wrong(exit::RECORD, problem, help)
    })?;
    let mut numbers: Vec<&str> = found.iter().map(|row| row.number.as_str()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    if !numbers.contains(&tolerance.number.as_str()) {
        let problem = format!("the record has no derivatives by \"{}\"", tolerance.number);
        return Err(wrong(exit::USAGE, problem, format!("there are those by {}", numbers.join(", "))));
    }
    Ok(found)
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    /// Limits against the direction of the pull
    Polar,
    /// Largest less smallest limit of all directions, against l2
    Difference,
    /// Limits against the minor radius of the rings
    Radius,
    /// Kinematic Poisson ratio -ln(1+l2)/ln(1+l1) where the width was free
    Poisson,
    /// Iterations of the solver
    Steps,
    /// Wall time
    Times,
    /// Wall time of each step of one run (records of --steps)
    StepTimes,
    /// Size of each step of one run (records of --steps)
    StepSizes,
    /// Force against stretch of simulated sheets
    Force,
}

/// What a plot shows of a limit.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum Shown {
    /// 1 + l1
    Stretch,
    /// l1
    L1,
    /// lambda1 - 1, as in the thesis
    Lambda1,
}

impl From<Shown> for Quantity {
    fn from(shown: Shown) -> Self {
        match shown {
            Shown::Stretch => Quantity::Stretch,
            Shown::L1 => Quantity::L1,
            Shown::Lambda1 => Quantity::Lambda1,
        }
    }
}

/// `--reference`.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum MeasuredFrom {
    /// That of the design file
    Start,
    /// Of greatest area
    #[value(alias = "widest")]
    LargestCell,
    /// Of least area
    #[value(alias = "tightest")]
    SmallestCell,
}

impl From<MeasuredFrom> for Reference {
    fn from(cell: MeasuredFrom) -> Self {
        match cell {
            MeasuredFrom::Start => Reference::Start,
            MeasuredFrom::LargestCell => Reference::LargestCell,
            MeasuredFrom::SmallestCell => Reference::SmallestCell,
        }
    }
}

/// More curves than this are hard to tell apart.
const MANY: usize = 12;

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    if args.quantity.is_some() && !matches!(args.kind, Kind::Polar | Kind::Difference | Kind::Radius) {
        return Err(wrong(
            exit::USAGE,
            "only plots of limits have a --quantity",
            "leave --quantity out, or choose --kind polar, difference or radius",
        ));
    }
    if let Some(tolerance) = &args.tolerance {
        derivatives(args, tolerance)?;
    }
    args.figure.check()?;
    let layout = args.figure.layout()?;
    if args.reference != MeasuredFrom::Start
        && (args.kind != Kind::Polar || matches!(args.quantity, Some(Shown::Lambda1)))
    {
        return Err(wrong(
            exit::USAGE,
            "--reference is for polar plots of the stretch along the pull",
            "leave --reference out, or choose --kind polar with --quantity stretch or l1",
        ));
    }
    if args.kind == Kind::Force {
        let (simulations, svg) = force(args, layout)?;
        let designs = simulations.iter().map(|named| named.record.design.name.as_str());
        return args.figure.write(&svg, &usual(args.kind, designs));
    }
    if let [path] = &args.records[..]
        && let Some((record, surface)) = records::surface(path)?
    {
        alone(args, "the surface of all strains has one kind of plot, of all its rays")?;
        let svg = surface_svg(&record, &surface, layout);
        return args.figure.write(&svg, &format!("maille-out/boundary-{}", file_name(&record.design.name)));
    }
    if let [path] = &args.records[..]
        && let Some((record, rolls)) = records::rolls(path)?
    {
        if record.question.kind() != RollKind::Tightest {
            let problem = format!("{} holds tubes or sheets of given curvature, which have no plot", path.display());
            let at = rolls.first().map_or(String::new(), |roll| roll.key().place());
            return Err(wrong(exit::USAGE, problem, format!("render one, as: maille render --from FOLDER --at {at}")));
        }
        alone(args, "rolls have one kind of plot, of all directions and both sides")?;
        let svg = roll_svg(&record.design, &rolls, layout);
        return args.figure.write(&svg, &format!("maille-out/roll-{}", file_name(&record.design.name)));
    }
    if let [path] = &args.records[..]
        && let Some((design, svg)) = fit_record::svg_of(&records::folder(path), layout)?
    {
        alone(args, "a fit has one kind of plot, of both designs and the targets")?;
        return args.figure.write(&svg, &format!("maille-out/fit-{}", file_name(&design)));
    }
    let mut records = records::read(&args.records).map_err(|report| of_simulation(args, report))?;
    table::known(&args.conditions, &records)?;
    // Of all rows, not only of those that are shown.
    let mut cells = reference_cells(args.reference, &records)?;
    for named in &mut records {
        for table::Conditions(conditions) in &args.conditions {
            named.keep(conditions);
        }
    }
    if records.iter().all(|named| named.record.rows.is_empty()) {
        return Err(wrong(exit::USAGE, "no row is left to plot", "`maille table` shows what there is"));
    }
    let mut shown = records.iter().map(|named| !named.record.rows.is_empty());
    cells.retain(|_| shown.next() == Some(true));
    records.retain(|named| {
        let some = !named.record.rows.is_empty();
        if !some {
            eprintln!("note: {} has no such row and is left out", named.name);
        }
        some
    });
    for (named, cell) in records.iter_mut().zip(&cells) {
        named.record.rows.iter_mut().for_each(|row| *row = cell.measured(row));
    }
    let svg = svg(args, &records, &cells, layout)?;
    let designs = records.iter().map(|named| named.record.run.design.name.as_str());
    args.figure.write(&svg, &usual(args.kind, designs))
}

/// Refuses options of plots of limits where the folder has one plot alone.
fn alone(args: &Args, problem: &str) -> Result<()> {
    let plain = args.kind == Kind::Polar
        && args.conditions.is_empty()
        && args.quantity.is_none()
        && args.reference == MeasuredFrom::Start;
    let help = "give the folder alone, with --style and --output";
    if plain { Ok(()) } else { Err(wrong(exit::USAGE, problem, help)) }
}

/// The simulations that are named, and their plot.
fn force(args: &Args, layout: Layout) -> Result<(Vec<NamedSimulation>, String)> {
    if !args.conditions.is_empty() {
        return Err(wrong(exit::USAGE, "a simulation has no rows of limits for --where", "leave --where out"));
    }
    let mut simulations: Vec<NamedSimulation> = Vec::new();
    for path in &args.records {
        let folder: PathBuf = records::folder(path).components().collect();
        let name = folder.display().to_string();
        if simulations.iter().any(|known| known.name == name) {
            return Err(wrong(exit::USAGE, format!("the simulation {name} is given twice"), "name each of them once"));
        }
        if !folder.join(SIMULATION[0]).is_file() {
            let problem = match folder.exists() {
                true => format!("{name} holds no simulation"),
                false => format!("there is no folder {name}"),
            };
            let help =
                "--kind force draws folders that `maille simulate` wrote: they hold simulation.json and forces.csv";
            return Err(wrong(exit::RECORD, problem, help));
        }
        let files = open_simulation(&folder)?;
        let forces = files.forces.ok_or_else(|| {
            let problem = format!("the simulation {name} has no {}", SIMULATION[2]);
            let help =
                "it is a folder of --frames, or older than this table: name the folder of --out, or simulate it again";
            wrong(exit::RECORD, problem, help)
        })?;
        simulations.push(NamedSimulation { name, record: files.record, forces });
    }
    let svg = force_svg(&simulations, layout).ok_or_else(|| {
        let help = "hold an edge and pull the one opposite to it, as --fix left --pull right=8,0,0";
        wrong(exit::USAGE, "no frame of these simulations has a stretch along a pull", help)
    })?;
    Ok((simulations, svg))
}

/// A simulation where records of limits are wanted has a kind of its own.
fn of_simulation(args: &Args, report: miette::Report) -> miette::Report {
    match args.records.iter().find(|path| records::folder(path).join(SIMULATION[0]).is_file()) {
        Some(path) => wrong(
            exit::RECORD,
            format!("{} holds a simulation, and no limits", path.display()),
            "draw it with --kind force",
        ),
        None => report,
    }
}

/// The cell of each record that its stretches are measured from; none where that is the start.
fn reference_cells(from: MeasuredFrom, records: &[NamedRecord]) -> Result<Vec<ReferenceCell>> {
    let cell = |named: &NamedRecord| {
        named.record.reference(from.into()).ok_or_else(|| {
            wrong(
                exit::RECORD,
                format!("the record {} does not say which lattice its limits have", named.name),
                "it is older than the columns a1_x to a2_y: compute it again with --overwrite",
            )
        })
    };
    match from {
        MeasuredFrom::Start => Ok(Vec::new()),
        MeasuredFrom::LargestCell | MeasuredFrom::SmallestCell => records.iter().map(cell).collect(),
    }
}

fn svg(args: &Args, records: &[NamedRecord], cells: &[ReferenceCell], layout: Layout) -> Result<String> {
    let l2 = |named: &NamedRecord| {
        let mut l2: Vec<u64> = named.record.rows.iter().map(|row| row.l2.to_bits()).collect();
        l2.sort_unstable();
        l2.dedup();
        l2.len()
    };
    let curves: usize = records.iter().map(l2).sum();
    if !matches!(args.kind, Kind::Difference | Kind::Radius) && records.len() > 1 && curves > MANY {
        eprintln!("note: {curves} curves are many for one figure; --where l2=0 shows those of one l2");
    }
    let measured = |plot: PolarPlot| match cells {
        [] => plot,
        cells => plot.measured_from(args.reference.into(), cells),
    };
    Ok(match (args.kind, records) {
        (Kind::Polar, [one]) => {
            let (run, rows) = (&one.record.run, &one.record.rows);
            let quantity = args.quantity.map_or_else(Quantity::default, Into::into);
            let mut plot = PolarPlot::from_rows(&run.design, rows, quantity, &parameter_words(run));
            if let Some(tolerance) = &args.tolerance {
                let unit = run.design.unit.as_ref().filter(|_| tolerance.number == "minor_radius");
                let unit = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
                plot = plot.with_tolerance(rows, &derivatives(args, tolerance)?, tolerance, &unit);
            }
            polar_svg(&measured(plot), layout)
        }
        (Kind::Polar, several) => {
            let quantity = args.quantity.map_or_else(Quantity::default, Into::into);
            polar_svg(&measured(PolarPlot::from_records(several, quantity)), layout)
        }
        (Kind::Difference, records) => {
            difference_svg(records, args.quantity.map_or(Quantity::Lambda1, Into::into), layout)
        }
        (Kind::Radius, records) => {
            radius_svg(records, args.quantity.map_or_else(Quantity::default, Into::into), layout).ok_or_else(|| {
                let help = "name records of one design at several --minor-radius, or of the whole of a `maille sweep`";
                wrong(exit::USAGE, "no two of these limits differ in the minor radius alone", help)
            })?
        }
        (Kind::Poisson, records) => poisson_svg(records, layout).ok_or_else(|| {
            let help = "`maille characterize DESIGN --lateral free` leaves the width to the sheet";
            wrong(exit::USAGE, "no limit of these records has a free width", help)
        })?,
        (Kind::Steps, records) => cost_svg(records, Cost::Steps, layout),
        (Kind::Times, records) => cost_svg(records, Cost::WallTime, layout),
        (Kind::StepTimes | Kind::StepSizes, records) => {
            let shown = if args.kind == Kind::StepTimes { OfStep::Time } else { OfStep::Size };
            run_svg(records, shown, layout).ok_or_else(|| {
                let help = "`maille characterize DESIGN --method energy --steps` keeps them";
                wrong(exit::USAGE, "these records have no steps", help)
            })?
        }
        (Kind::Force, _) => unreachable!("drawn from simulations"),
    })
}

/// `maille-out/polar-1.1-3.1`, to which an ending is added.
fn usual<'a>(kind: Kind, designs: impl Iterator<Item = &'a str>) -> String {
    let kind = match kind {
        Kind::Polar => "polar",
        Kind::Difference => "difference",
        Kind::Radius => "radius",
        Kind::Poisson => "poisson",
        Kind::Steps => "steps",
        Kind::Times => "times",
        Kind::StepTimes => "step-times",
        Kind::StepSizes => "step-sizes",
        Kind::Force => "force",
    };
    let mut names: Vec<String> = Vec::new();
    for name in designs.map(file_name) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    Path::new("maille-out").join(format!("{kind}-{}", names.join("-"))).display().to_string()
}
