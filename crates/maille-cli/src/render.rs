//! `maille render`: a picture of a sheet.

use crate::{
    at::{At, parse_at},
    input::{Input, file_name},
    numbers::positive,
};
use maille::{
    design::Design,
    lattice::Cell,
    model::Model,
    record::{StateRecord, Status},
    state::State,
};
use maille_io::{
    mesh::{self, Tile},
    record::Record,
    render::{Background, ColorBy, Extent, Forces, RenderError, RenderOptions, Subject, View, render},
};
use miette::{IntoDiagnostic, Report, Result, WrapErr, miette};
use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    time::Instant,
};

/// A picture of a sheet, as PNG
///
/// Draws a patch of the starting state, or of a locked state from a record with its contact forces. The rings are exact
/// tori, drawn without a graphics card; the same command gives the same picture on any number of threads.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille render 1.1                                               maille-out/1.1.png
  maille render 3.1 --view top --cell                             from above, with the unit cell
  maille render my-weave.toml --tile 6x4 --perspective --background dark --out slide.png
  maille render 1.1 --at direction=30,l2=-0.125                   a limit of maille-out/1.1, with its forces
  maille render --from results/weave --at direction=0,l2=0 --color load --forces none
  maille render 1.1 --size 300x225 --no-scale-bar --out -         to standard output

Colours: elements that differ by a translation alone share one. With --color load, from yellow to violet by the sum of
the contact forces on an element; grey carries none.

Arrows: at each contact, the force on either ring, from where the wires touch, seen through the rings.")]
pub struct Args {
    /// A built-in design (see `maille designs`) or a TOML file; may be left out with --from
    #[arg(required_unless_present = "from")]
    design: Option<String>,
    /// Show this many cells along a1 and a2
    #[arg(long, value_name = "MxN", conflicts_with = "patch")]
    tile: Option<Tile>,
    /// Show the elements in a rectangle of this size in the file's unit, without loose ends [default: as fills the picture]
    #[arg(long, value_name = "WxH", value_parser = parse_patch)]
    patch: Option<[f64; 2]>,
    /// Folder of a record: show one of its states [default with --at: maille-out/DESIGN]
    #[arg(long, value_name = "RECORD")]
    from: Option<PathBuf>,
    /// Which state of the record, as direction=30,l2=-0.125; what only one state fits may be left out
    #[arg(long, value_parser = parse_at, allow_hyphen_values = true)]
    at: Option<At>,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive, conflicts_with = "from")]
    minor_radius: Option<f64>,
    /// Direction of view: top, tilted, side, or azimuth,elevation in degrees (0,0 looks along y, 0,90 down)
    #[arg(long, value_name = "VIEW", default_value = "tilted", allow_hyphen_values = true)]
    view: View,
    /// Near rings larger than far ones
    #[arg(long)]
    perspective: bool,
    /// Pixels across and down
    #[arg(long, value_name = "WxH", default_value = "1600x1200", value_parser = parse_size)]
    size: [u32; 2],
    /// What is behind the sheet
    #[arg(long, value_enum, default_value_t = BackgroundArg::White)]
    background: BackgroundArg,
    /// What colours mean
    #[arg(long, value_enum, default_value_t = ColorArg::Element)]
    color: ColorArg,
    /// Contact forces of a locked state [default: arrows where the state has forces]
    #[arg(long, value_enum)]
    forces: Option<ForcesArg>,
    /// Outline one cell, with a1 and a2
    #[arg(long)]
    cell: bool,
    /// No scale bar
    #[arg(long)]
    no_scale_bar: bool,
    /// No shadow on the ground below the sheet
    #[arg(long)]
    no_shadow: bool,
    /// The file, or - for standard output [default: maille-out/DESIGN.png, with the state in its name]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Threads [default: all cores]; the picture does not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No notes
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum BackgroundArg {
    White,
    Transparent,
    Dark,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ColorArg {
    /// The kind of element
    Element,
    /// The sum of the contact forces on the element
    Load,
    /// All alike
    None,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ForcesArg {
    Arrows,
    None,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |t: &str| t.parse::<u32>().ok();
    match text.split_once('x').map(|(w, h)| (side(w), side(h))) {
        Some((Some(w), Some(h))) => Ok([w, h]),
        _ => Err(format!("\"{text}\" is no size; give pixels across and down, as 1600x1200")),
    }
}

fn parse_patch(text: &str) -> Result<[f64; 2], String> {
    match text.split_once('x').map(|(w, h)| (positive(w), positive(h))) {
        Some((Ok(w), Ok(h))) => Ok([w, h]),
        _ => Err(format!("\"{text}\" is no patch; give width and height in the file's unit, as 12x9")),
    }
}

/// What is shown: a design, compiled, and perhaps a state of a record.
struct Source {
    design: Design,
    model: Model,
    locked: Option<(StateRecord, State)>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let Source { design, model, locked } = source(args)?;
    let (state, contacts) = match &locked {
        Some((record, state)) => (state, record.contacts.as_slice()),
        None => (&model.start, &[][..]),
    };
    if let Some((record, _)) = &locked
        && !matches!(record.status, Status::Global | Status::Local | Status::ThresholdReached)
        && !args.quiet
    {
        eprintln!("note: the state is \"{}\": the last of its search, no limit", record.status.name());
    }
    let extent = match (args.tile, args.patch) {
        (Some(tile), _) => Extent::Cells(tile.0),
        (None, Some(patch)) => Extent::Patch(patch),
        (None, None) => Extent::filling(args.size, args.view, design.reference_radius),
    };
    let options = RenderOptions {
        size: args.size,
        view: args.view,
        perspective: args.perspective,
        background: match args.background {
            BackgroundArg::White => Background::White,
            BackgroundArg::Transparent => Background::Transparent,
            BackgroundArg::Dark => Background::Dark,
        },
        color: match args.color {
            ColorArg::Element => ColorBy::Element,
            ColorArg::Load => ColorBy::Load,
            ColorArg::None => ColorBy::None,
        },
        forces: match args.forces {
            Some(ForcesArg::Arrows) => Forces::Arrows,
            None if !contacts.is_empty() => Forces::Arrows,
            Some(ForcesArg::None) | None => Forces::None,
        },
        cell: args.cell,
        scale_bar: !args.no_scale_bar,
        shadow: !args.no_shadow,
        ..RenderOptions::new(extent)
    };
    let out = destination(args, &design, locked.as_ref().map(|l| &l.0))?;
    let subject = Subject { model: &model, state, contacts, unit: design.unit.as_deref() };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.map_or(0, usize::from))
        .build()
        .into_diagnostic()
        .wrap_err("cannot start the threads")?;
    let begun = Instant::now();
    let picture = pool.install(|| render(&subject, &options)).map_err(|e| match e {
        RenderError::NoForces => no_forces(args, &design, locked.as_ref().map(|l| &l.0)),
        e => Report::new(e),
    })?;
    let png = picture.to_png()?;
    let Some(path) = out else {
        return std::io::stdout().write_all(&png).into_diagnostic().wrap_err("cannot write the picture");
    };
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        fs::create_dir_all(folder).into_diagnostic().wrap_err_with(|| format!("cannot create {}", folder.display()))?;
    }
    fs::write(&path, png).into_diagnostic().wrap_err_with(|| format!("cannot write {}", path.display()))?;
    if !args.quiet {
        let ([w, h], rings) = (args.size, picture.rings);
        println!("{}  {w} × {h}, {rings} rings, {:.1} s", path.display(), begun.elapsed().as_secs_f64());
    }
    Ok(())
}

/// The file to write; none for standard output.
fn destination(args: &Args, design: &Design, locked: Option<&StateRecord>) -> Result<Option<PathBuf>> {
    let Some(out) = &args.out else {
        let place = locked.map_or(String::new(), |s| format!("_dir{}_l2{:+}", s.direction_deg, s.l2));
        return Ok(Some(PathBuf::from("maille-out").join(format!("{}{place}.png", file_name(&design.name)))));
    };
    if out.as_os_str() == "-" {
        return Ok(None);
    }
    match out.extension().and_then(|e| e.to_str()) {
        Some(e) if e.eq_ignore_ascii_case("png") => Ok(Some(out.clone())),
        _ => Err(miette!(
            help = "give a name that ends in .png, or - for standard output",
            "{} is no name of a PNG",
            out.display()
        )),
    }
}

/// The design and its state: from the record where one is asked for.
fn source(args: &Args) -> Result<Source> {
    let input = args.design.as_deref().map(|name| Input::read(name, args.minor_radius)).transpose()?;
    let folder = match (&args.from, &input) {
        (Some(folder), _) => folder.clone(),
        (None, Some(input)) if args.at.is_some() => PathBuf::from("maille-out").join(file_name(&input.design.name)),
        (None, Some(input)) => {
            // As in `inspect`, overlaps are shown, not refused.
            let tolerant = Design { allow_initial_overlap: true, ..input.design.clone() };
            let model = input.compile(&tolerant, Cell::PRIMITIVE)?;
            return Ok(Source { design: input.design.clone(), model, locked: None });
        }
        (None, None) => return Err(miette!("there is neither a design nor a record")),
    };
    let at = args.at.unwrap_or_default();
    let record = Record::read(&folder).map_err(|e| match &input {
        Some(input) if args.from.is_none() || !folder.exists() => miette!(
            help = format!("compute it with\n  {}", characterize_line(args, &input.design, None, at, &folder)),
            "{} holds no record to take a state from",
            folder.display()
        ),
        _ => Report::new(e),
    })?;
    let design = record.run.design.clone();
    if let Some(input) = input.filter(|input| input.design != design) {
        let line = characterize_line(args, &input.design, Some(&record), at, &another(&folder, at));
        return Err(miette!(
            help = format!("leave the design out to show what the record holds, or compute this one with\n  {line}"),
            "the record {} is of another design: \"{}\"{}, not \"{}\"{} as in the file",
            folder.display(),
            design.name,
            radius(&design),
            input.design.name,
            radius(&input.design),
        ));
    }
    let state = pick(args, &record, at, &folder)?.clone();
    // The cell is that of the row: a run may solve several.
    let row =
        record.rows.iter().find(|r| (r.direction_deg, r.l2, r.status) == (state.direction_deg, state.l2, state.status));
    let unusable = |problem: String| miette!("the record {} cannot be used: {problem}", folder.display());
    let cell: Cell =
        row.map_or("1x1", |r| &r.cell).parse().map_err(|e: maille::error::InvalidInput| unusable(e.problem))?;
    let tolerant = Design { allow_initial_overlap: true, ..design.clone() };
    let model = Model::compile(&tolerant, cell).map_err(|problems| {
        unusable(problems.iter().map(|p| format!("{}: {}", p.field, p.problem)).collect::<Vec<_>>().join("; "))
    })?;
    let locked = mesh::state_of(&model, &state)?;
    Ok(Source { design, model, locked: Some((state, locked)) })
}

fn radius(design: &Design) -> String {
    design.minor_radius.map_or(String::new(), |r| format!(" with r = {r}"))
}

/// The only state that fits.
fn pick<'a>(args: &Args, record: &'a Record, at: At, folder: &Path) -> Result<&'a StateRecord> {
    let all: Vec<&StateRecord> = record.states.iter().filter(|s| !s.poses.is_empty()).collect();
    let found: Vec<&StateRecord> = all.iter().copied().filter(|s| at.fits(s.direction_deg, s.l2)).collect();
    let list = |states: &[&StateRecord]| {
        let some = states.iter().take(6).map(|s| format!("  --at direction={},l2={}", s.direction_deg, s.l2));
        let more = states.len().saturating_sub(6);
        let more = (more > 0).then(|| format!("  … and {more} more"));
        some.chain(more).collect::<Vec<_>>().join("\n")
    };
    match found[..] {
        [state] => Ok(state),
        [] => {
            let line = characterize_line(args, &record.run.design, Some(record), at, &another(folder, at));
            // The nearest first: a degree weighs as much as 0.01 of l2.
            let far = |s: &StateRecord| {
                let of = |wanted: Option<f64>, x: f64| wanted.map_or(0.0, |w| (w - x).abs());
                of(at.direction, s.direction_deg) + 100.0 * of(at.l2, s.l2)
            };
            let mut nearest = all;
            nearest.sort_by(|a, b| far(a).total_cmp(&far(b)));
            Err(miette!(
                help = format!(
                    "it has, the nearest first:\n{}\ncompute the one asked for with\n  {line}\nand then give its folder with --from",
                    list(&nearest)
                ),
                "the record {} has no state at {at}",
                folder.display()
            ))
        }
        _ => Err(miette!(
            help = format!("name one:\n{}", list(&found)),
            "{} states of the record {} fit",
            found.len(),
            folder.display()
        )),
    }
}

/// A folder for a record of other directions than those of `folder`.
fn another(folder: &Path, at: At) -> PathBuf {
    let mut name = folder.as_os_str().to_owned();
    name.push(at.direction.map_or(String::new(), |d| format!("_dir{d}")));
    name.push(at.l2.map_or(String::new(), |l2| format!("_l2{l2:+}")));
    PathBuf::from(name)
}

/// The command that computes the state asked for.
fn characterize_line(args: &Args, design: &Design, record: Option<&Record>, at: At, folder: &Path) -> String {
    let quoted = |text: &str| if text.contains([' ', ';']) { format!("\"{text}\"") } else { text.to_owned() };
    let mut line = format!("maille characterize {}", quoted(args.design.as_deref().unwrap_or(&design.name)));
    line += &at.direction.map_or(String::new(), |d| format!(" --directions {d}"));
    line += &at.l2.map_or(String::new(), |l2| format!(" --l2 {l2}"));
    let of_record = record.and_then(|r| r.run.design.minor_radius).filter(|_| args.design.is_none());
    line += &args.minor_radius.or(of_record).map_or(String::new(), |r| format!(" --minor-radius {r}"));
    for name in ["method", "cell"] {
        let value = record.and_then(|r| r.run.parameters.get(name)).and_then(|v| v.as_str());
        line += &value.map_or(String::new(), |value| format!(" --{name} {}", quoted(value)));
    }
    line + &format!(" --out {}", quoted(&folder.display().to_string()))
}

/// Forces are asked for, and the state has none: how to get one that has.
fn no_forces(args: &Args, design: &Design, locked: Option<&StateRecord>) -> Report {
    let name = args.design.as_deref().unwrap_or(&design.name);
    let (what, place) = match locked {
        Some(s) => (
            format!("the state at direction {}°, l2 {} has no contact forces", s.direction_deg, s.l2),
            At { direction: Some(s.direction_deg), l2: Some(s.l2) },
        ),
        None => ("the starting state has no contact forces".into(), At { direction: Some(0.0), l2: Some(0.0) }),
    };
    let (direction, l2) = (place.direction.unwrap_or(0.0), place.l2.unwrap_or(0.0));
    let folder = format!("maille-out/{}-exact", file_name(&design.name));
    miette!(
        help = format!(
            "limits of the exact method have them:\n  maille characterize {name} --method exact --directions {direction} \
             --l2 {l2} --out {folder}\n  maille render --from {folder} --at {place}"
        ),
        "{what}"
    )
}
