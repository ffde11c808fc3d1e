//! `maille simulate`: a finite sheet, held at edges, pulled, under weight.

use crate::{
    exit::{self, wrong},
    input::{DesignArgs, Input, file_name},
    interrupt,
    numbers::positive,
    output::{self, counted},
    piece::{PieceArgs, known_millimetres},
    progress::Spinner,
};
use maille::{
    error::InvalidInput,
    lattice::Cell,
    model::Model,
    record::{FrameRecord, pose_records},
    relaxation::{
        limit::EnergyOptions,
        simulate::{Accepted, End, Simulation, Step, TAU, along, simulate_from},
    },
};
use maille_geometry::Vec3;
use maille_io::{
    Tile,
    record::{
        ForceTable, KeptStep, LoadedPlace, PulledPlace, RecordError, SIMULATION, SheetPlan, SimulationFolder,
        SimulationRecord,
    },
};
use miette::{Report, Result};
use serde_json::json;
use std::{
    cell::RefCell,
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::Ordering,
    time::Instant,
};

/// A finite sheet: held at edges, pulled in steps, under weight
///
/// The sheet has no images: its edges are free but for what is fixed or pulled. Rings come to rest by the energy method,
/// then the pull grows in equal steps until it is done or the sheet locks. Writes simulation.json (what was done, what
/// came out), frames.jsonl (the sheet at rest after each step) and forces.csv (the force of each held place, stretch,
/// deformation gradient and energy after each step). A run that was stopped or killed goes on by the same command.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille simulate 1.1 --tile 4x4 --fix left --pull right=5,0,0      locks on the way
  maille simulate 1.1 --tile 1x6 --fix top --gravity 0,-1,0         a strip that hangs
  maille simulate shirt.toml --size 100x150mm --fix top --gravity 0,-1,0    a piece of this size
  maille simulate 1.1 --tile 4x4 --gravity 0,0,-1 --floor -3        a sheet that falls on a floor
  maille simulate european-4-in-1 --tile 8x14 --bend 0.01,0.01    onto a sphere
  maille simulate 1.1 --tile 1x6 --fix top --force flat@0,0=0,-5,0  a strip with a load on one ring
  maille simulate 1.1 --tile 8x2 --fix left --pull right=-6,0,0/0,0,0 --gravity 0,0,-1 --floor -3   folded and unfolded
  maille simulate 2 --tile 10x10 --fix left --pull right=0.5,0,0 --frames all-frames
  maille simulate 1.1 --tile 4x4 --fix left --pull right=8,0,0 --steps 40   then
  maille plot 1.1-simulate --kind force                             free at first, then a hard stop
  maille export --from maille-out/1.1-simulate --format vtk --frames 50
  maille render --from maille-out/1.1-simulate

Places: left and right are the first and last elements along a1, bottom and top those along a2. Or an element: by its \
name, in all cells (flat), or with its cell (flat@0,2). Fixed and pulled elements may turn.

Exit codes: 0 the pull was done, or the sheet locked; 5 a step did not converge; 130 interrupted, and the same \
command continues.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    #[command(flatten)]
    piece: PieceArgs,
    /// Where elements are held: left, right, top, bottom or elements, as left,flat@0,2
    #[arg(long, value_name = "PLACE,…", value_parser = parse_places)]
    fix: Option<Places>,
    /// Pull a place by a vector, in the file's unit, or along several, all from the start; may be given for several places
    #[arg(long, value_name = "PLACE=DX,DY,DZ[/…]", value_parser = parse_pull, allow_hyphen_values = true)]
    pull: Vec<PulledPlace>,
    /// Weight of every element; 1 is a thousandth of the stiffness of a pull at R
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    gravity: Option<[f64; 3]>,
    /// Constant force on a place besides, in the unit of --gravity; may be given for several places
    #[arg(long, value_name = "PLACE=X,Y,Z", value_parser = parse_force, allow_hyphen_values = true)]
    force: Vec<LoadedPlace>,
    /// Bend the sheet onto z = -(KX x² + KY y²)/2 about its middle: curvatures in 1/unit, as 0.02,0.02 for a sphere of radius 50 and
    /// 0.02,-0.02 for a saddle. All that is not held is drawn there, in equal steps, until the sheet locks
    #[arg(long, value_name = "KX,KY", value_parser = parse_bend, allow_hyphen_values = true)]
    bend: Option<[f64; 2]>,
    /// A floor at this height, in the file's unit
    #[arg(long, value_name = "Z", allow_hyphen_values = true, value_parser = parse_number)]
    floor: Option<f64>,
    /// Slow the sheet, which then need not come to rest in each step: under weight 1 a free ring sinks by 1/DRAG in a step
    #[arg(long, value_parser = positive)]
    drag: Option<f64>,
    /// Steps of the pull; with --drag, of the whole motion
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// Folder of the result [default: maille-out/DESIGN-simulate]
    #[arg(long, short)]
    out: Option<PathBuf>,
    #[command(flatten)]
    replace: output::Replace,
    /// Another folder with every state that the minimisation accepted as a frame, and no forces.csv
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Weight of the contacts against the pulls, alpha/beta
    #[arg(long, default_value_t = EnergyOptions::default().alpha, value_parser = positive)]
    alpha: f64,
    /// A pulled element that misses its place by more than this, in reference radii, means that the sheet has locked
    #[arg(long, default_value_t = TAU, value_parser = positive)]
    tau: f64,
    /// Newton iterations of one step at most
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    max_iterations: u32,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the outcome as one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// No summary
    #[arg(long, short, conflicts_with = "json")]
    quiet: bool,
}

/// Places whose forces are named in the summary; all are in forces.csv.
const MOST_PLACES: usize = 6;

/// Names of places.
#[derive(Clone, Debug, PartialEq)]
struct Places(Vec<String>);

fn parse_number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("\"{}\" is not a number", text.trim())),
    }
}

fn parse_vector(text: &str) -> Result<[f64; 3], String> {
    let parts = text.split(',').map(parse_number).collect::<Result<Vec<f64>, String>>();
    match parts.as_deref() {
        Ok(&[x, y, z]) => Ok([x, y, z]),
        _ => Err(format!("\"{text}\" is not a vector; give three numbers, as 0,0,-1")),
    }
}

/// `0.02,-0.02`.
fn parse_bend(text: &str) -> Result<[f64; 2], String> {
    let parts = text.split(',').map(parse_number).collect::<Result<Vec<f64>, String>>();
    match parts.as_deref() {
        Ok(&[x, y]) if [x, y] != [0.0; 2] => Ok([x, y]),
        _ => Err(format!("\"{text}\" is no bend; give two curvatures that are not both 0, as 0.02,0.02")),
    }
}

/// `right=0.5,0,0`, or `right=-3,0,0/0.5,0,0`.
fn parse_pull(text: &str) -> Result<PulledPlace, String> {
    let (place, way) = at_place(text, "pull")?;
    if way.iter().all(|by| *by == [0.0; 3]) {
        return Err(format!("\"{text}\" pulls nowhere; hold the place with --fix instead"));
    }
    Ok(PulledPlace { place, way })
}

/// `flat@0,2=0,0,-1`.
fn parse_force(text: &str) -> Result<LoadedPlace, String> {
    let (place, forces) = at_place(text, "force")?;
    match forces[..] {
        [force] if force != [0.0; 3] => Ok(LoadedPlace { place, force }),
        [_] => Err(format!("\"{text}\" is not a force; leave it out")),
        _ => Err(format!("\"{text}\" has {} forces; give one vector, as right=0.5,0,0", forces.len())),
    }
}

fn at_place(text: &str, what: &str) -> Result<(String, Vec<[f64; 3]>), String> {
    let wrong = || format!("\"{text}\" is not a {what}; give a place and a vector, as right=0.5,0,0");
    let (place, vectors) = text.split_once('=').ok_or_else(wrong)?;
    let vectors = vectors.split('/').map(parse_vector).collect::<Result<_, _>>().map_err(|_| wrong())?;
    match place.trim() {
        "" => Err(wrong()),
        place => Ok((place.into(), vectors)),
    }
}

/// `left,flat@0,2`: a number after a comma belongs to the cell before it.
fn parse_places(text: &str) -> Result<Places, String> {
    let mut out: Vec<String> = Vec::new();
    for part in text.split(',').map(str::trim) {
        match out.last_mut() {
            Some(last) if last.contains('@') && !last.contains(',') => *last += &format!(",{part}"),
            _ if part.is_empty() => return Err(format!("\"{text}\" has an empty place; give a list, as left,right")),
            _ => out.push(part.into()),
        }
    }
    Ok(Places(out))
}

fn refused(problem: InvalidInput) -> Report {
    wrong(exit::USAGE, format!("--{}: {}", problem.field, problem.problem), problem.help)
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let input = args.design.read()?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("maille-out").join(file_name(&input.design.name) + "-simulate"));
    let tile = tile(args, &input)?;
    let [m, n] = tile.0.map(|k| i32::try_from(k).unwrap_or(i32::MAX));
    let cells = Cell::new([[m, 0], [0, n]]).map_err(|e| refused(InvalidInput { field: "tile".into(), ..e }))?;
    let model = input.compile_sheet(&input.design, cells)?;
    let plan = plan(args)?;
    let setup = plan.setup(&model).map_err(refused)?;
    if args.frames.as_ref() == Some(&out) {
        let problem = format!("--frames and --out name the same folder, {}", out.display());
        return Err(wrong(exit::USAGE, problem, "name another folder for all states"));
    }
    let folder = SimulationFolder::open(&out)?;
    let frames = args.frames.as_ref().map(|folder| SimulationFolder::open(folder)).transpose()?;
    // What is there of a run that was not done is this one's.
    if !folder.has_steps() {
        for folder in [Some(&out), args.frames.as_ref()].into_iter().flatten() {
            args.replace.check(&folder.join(SIMULATION[0]))?;
        }
    }
    let (all_frames, overwrite) = (args.frames.is_some(), args.replace.overwrite);
    let (mut steps, known) = folder.steps(&input.design, tile, &plan, all_frames, overwrite)?;
    if !known.is_empty() && !args.quiet {
        eprintln!("goes on after {}", counted(known.len(), "step"));
    }
    let begun = Instant::now();
    // The states of all steps, and those of the one that is not done.
    let (mut all, since) = (Vec::new(), RefCell::new(Vec::new()));
    let mut done = Vec::new();
    for KeptStep { step, frames } in known {
        all.extend(frames);
        done.push(step);
    }
    let progress = Spinner::new(args.quiet);
    let mut watch = |x: &Accepted<'_>| {
        progress.says(|| {
            let percent = 100.0 * x.share;
            format!(
                "pull {percent:.1} %, minimisation {}, state {}, energy {:.6}",
                x.run + 1,
                x.state_of_run + 1,
                x.energy
            )
        });
        if args.frames.is_some() {
            let poses = pose_records(&model, x.state);
            since.borrow_mut().push(FrameRecord { run: x.run, share: x.share, energy: x.energy, poses });
        }
    };
    let cancel = interrupt::flag(args.quiet)?;
    let mut failure = None::<RecordError>;
    let mut keep = |step: &Step| {
        let kept = KeptStep { step: step.clone(), frames: since.take() };
        if let Err(error) = steps.keep(&kept) {
            failure.get_or_insert(error);
            cancel.store(true, Ordering::Relaxed);
        }
        all.extend(kept.frames);
    };
    let end = simulate_from(&model, &setup, done, &cancel, &mut watch, &mut keep);
    progress.finish();
    drop(steps);
    let end = match end {
        Ok(end) => end,
        Err(problem) => {
            folder.forget_steps()?;
            return Err(refused(problem));
        }
    };
    failure.map_or(Ok(()), Err)?;
    all.extend(since.take());
    let forces = ForceTable::new(&plan, &model, &setup, &end).map_err(refused)?;
    let record = SimulationRecord::new(&input.design, tile, plan, &model, &end);
    // A run that failed at once has reached nothing: its last state is shown.
    let last = || FrameRecord { run: 0, share: end.share, energy: end.energy, poses: pose_records(&model, &end.state) };
    let rests = if end.path.is_empty() { vec![last()] } else { end.path.clone() };
    folder.save(record.clone(), &rests, Some(&forces))?;
    if let Some(folder) = frames {
        folder.save(record.clone(), &all, None)?;
    }
    if end.end != End::Interrupted {
        folder.forget_steps()?;
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let last = forces.rows.last();
    if args.json {
        output::print_json(&json!({
            "design": input.design.name,
            "tile": record.tile,
            "elements": model.elements.len(),
            "outcome": record.outcome,
            "out": out.display().to_string(),
            "frames": rests.len(),
            "stretch": last.and_then(|row| row.stretch),
            "mean_force": last.and_then(|row| row.mean_force),
            "bend_force": last.and_then(|row| row.bend_force),
            "reactions": last.map(|row| forces.places.iter().zip(&row.forces).collect::<BTreeMap<_, _>>()),
            "wall_s": wall_s,
        }))?;
    } else if !args.quiet {
        summary(args, tile, &model, &end, &forces, &out, rests.len(), wall_s);
    }
    Ok(ExitCode::from(match end.end {
        End::Reached | End::Locked => exit::DONE,
        End::NotConverged => exit::INCOMPLETE,
        End::Interrupted => exit::INTERRUPTED,
    }))
}

/// The cells of the sheet; says which, if a size was asked for.
fn tile(args: &Args, input: &Input) -> Result<Tile> {
    let mm = match args.piece.is_size() {
        true => known_millimetres(input.design.unit.as_deref(), "a size", "--size")?,
        false => 1.0,
    };
    let cell = input.compile(&input.design, Cell::PRIMITIVE)?;
    let (tile, words) = args.piece.tile(&cell, &cell.start, None, mm);
    if let Some(words) = words.filter(|_| !args.quiet) {
        eprintln!("note: {words}");
    }
    Ok(tile)
}

fn plan(args: &Args) -> Result<SheetPlan> {
    let plan = SheetPlan {
        fix: args.fix.as_ref().map_or_else(Vec::new, |places| places.0.clone()),
        pull: args.pull.clone(),
        gravity: args.gravity,
        force: args.force.clone(),
        floor: args.floor,
        bend: args.bend,
        steps: args.steps,
        drag: args.drag,
        alpha: args.alpha,
        tau: args.tau,
        max_iterations: args.max_iterations,
        seed: args.seed,
    };
    if plan.is_still() {
        return Err(wrong(
            exit::USAGE,
            "nothing moves this sheet",
            "pull an edge, as --fix left --pull right=0.5,0,0, or give a weight, as --fix top --gravity 0,-1,0",
        ));
    }
    Ok(plan)
}

fn summary(
    args: &Args,
    tile: Tile,
    model: &Model,
    end: &Simulation,
    forces: &ForceTable,
    out: &Path,
    frames: usize,
    wall_s: f64,
) {
    let percent = 100.0 * end.share;
    let way = if args.bend.is_some() && args.pull.is_empty() { "bend" } else { "pull" };
    let what = match end.end {
        End::Reached if args.bend.is_some() => "bent all the way".into(),
        End::Reached if args.pull.is_empty() => "at rest".into(),
        End::Reached => "the whole pull was done".into(),
        End::Locked => format!("locked at {percent:.1} % of the {way}"),
        End::NotConverged => format!("a step after {percent:.1} % of the {way} did not converge"),
        End::Interrupted => format!("interrupted after {percent:.1} % of the {way}"),
    };
    output::say!("{}, {tile} cells, {}: {what}", model.name, counted(model.elements.len(), "element"));
    if let Some(bend) = args.bend {
        let [x, y] = bend.map(|curvature| curvature * end.share);
        output::say!("  bent to the curvatures {x:.6} and {y:.6} along x and y");
        if let Some(force) = forces.rows.last().and_then(|row| row.bend_force) {
            output::say!("  force of the surface {force:.2} in all, in the unit of --force");
        }
    }
    for pull in &args.pull {
        let way: Vec<Vec3> = pull.way.iter().map(|by| Vec3::from(*by)).collect();
        let by = along(&way, end.share);
        output::say!("  {} moved by {:.4}, {:.4}, {:.4}", pull.place, by.x, by.y, by.z);
    }
    if let Some(row) = forces.rows.last() {
        let stretch = row.stretch.map(|stretch| format!("stretch {stretch:.4}"));
        let force = row.mean_force.map(|force| format!("force along the pull {force:.2} on each pulled element"));
        let words: Vec<String> = stretch.into_iter().chain(force).collect();
        if !words.is_empty() {
            output::say!("  {} (forces in the unit of --force)", words.join(", "));
        }
        for (place, [x, y, z]) in forces.places.iter().zip(&row.forces).take(MOST_PLACES) {
            // + 0.0 makes −0 equal to 0
            let [x, y, z] = [x, y, z].map(|f| (100.0 * f).round() / 100.0 + 0.0);
            output::say!("  {place} holds with {x:.2}, {y:.2}, {z:.2}");
        }
    }
    if let Some(gap) = end.smallest_gap {
        output::say!("  smallest gap {:.2e}; links {}", gap * model.unit, if end.links_ok { "kept" } else { "LOST" });
    }
    if end.unbalanced > 0 {
        let steps = counted(end.unbalanced, "step");
        output::say!("  {steps} ended without a balance of forces; the next ones made up for it");
    }
    if let Some(note) = &end.note {
        output::say!("  {note}");
    }
    let [frames, iterations] = [counted(frames, "frame"), counted(end.iterations, "iteration")];
    output::say!("{}  {frames}, {iterations}, {wall_s:.1} s", out.display());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_pulls_are_read() {
        let places = |text: &str| parse_places(text).map(|p| p.0);
        assert_eq!(places("left,flat@0,2,top").unwrap(), ["left", "flat@0,2", "top"]);
        assert!(places("left,,top").is_err() && places("").is_err());
        assert_eq!(parse_pull("right=0.5,0,-1").unwrap().way, [[0.5, 0.0, -1.0]]);
        assert_eq!(parse_pull("right=-3,0,0/0,0,0").unwrap().way, [[-3.0, 0.0, 0.0], [0.0; 3]]);
        assert!(parse_force("right=-3,0,0/0,0,0").is_err() && parse_pull("right=1,0,0/").is_err());
        for wrong in ["right", "right=1,2", "=1,0,0", "right=0,0,0", "right=a,0,0", "right=1,2,3,4"] {
            assert!(parse_pull(wrong).is_err() && parse_force(wrong).is_err(), "{wrong}");
        }
    }
}
