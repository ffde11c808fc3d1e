//! `maille export`: meshes of a sheet, to print, to show and to analyse.

use crate::{
    at::{At, parse_at},
    input::{Input, file_name},
    numbers::positive,
};
use maille::{
    design::Design,
    error::InvalidInput,
    lattice::Cell,
    model::Model,
    record::{LimitRow, StateRecord, Status},
    state::State,
    topology,
};
use maille_io::{
    mesh::{self, Colours, Fineness, Format, MeshError, MeshFile, Objects, Scene, Tile, WriteOptions},
    record::Record,
};
use miette::{IntoDiagnostic, Report, Result, WrapErr, miette};
use std::{
    fs,
    io::BufWriter,
    path::{Path, PathBuf},
};

/// Meshes of a sheet: to print, to show and to analyse
///
/// Exports a tile of the starting state, of a locked state from a record, or frames from the one to the other. Lengths
/// come out in millimetres (GLB: metres); rings are closed meshes that face outward.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille export 1.1 --tile 8x8                                    maille-out/1.1-export/1.1.3mf
  maille export 1.1 --tile 8x8 --format stl,glb --scale 5         R = 1 becomes 5 mm
  maille export my-weave.toml --out prints/ --min-clearance 0.3   refuses if rings would fuse
  maille export 1.1 --at direction=30,l2=-0.25 --out locked.glb   a limit of maille-out/1.1
  maille export --from results/weave --at direction=0,l2=0 --format vtk --frames 20

Formats:
  3mf  for printing: real units, each ring stored once; see --objects
  stl  binary; obj; ply (binary, coloured): every ring with its own triangles
  glb  glTF for viewers: each ring stored once, coloured; see --color-by
  vtk  for ParaView: NAME.vtp (rings), NAME-poses.vtp, NAME-contacts.vtp; NAME.pvd for frames

Elements of several rings are several closed bodies that overlap where they are joined. Slicers unite the \
overlapping bodies of one object, so print such designs as 3mf with --objects element (the default) or sheet.

Frames are interpolated: lattice and positions on straight lines, rotations at constant rate. That is a picture of \
the change, no motion that the rings could make: they may overlap in between.")]
pub struct Args {
    /// A built-in design (see `maille designs`) or a TOML file; may be left out with --from
    #[arg(required_unless_present = "from")]
    design: Option<String>,
    /// Cells along a1 and a2
    #[arg(long, default_value = "4x4")]
    tile: Tile,
    /// One or several, as stl,3mf [default: by the name of --out, or 3mf]
    #[arg(long, value_enum, value_delimiter = ',')]
    format: Vec<FormatArg>,
    /// Folder of a record: export one of its states [default with --at: maille-out/DESIGN]
    #[arg(long, value_name = "RECORD")]
    from: Option<PathBuf>,
    /// Which state of the record, as direction=30,l2=-0.125; what only one state fits may be left out
    #[arg(long, value_parser = parse_at, allow_hyphen_values = true)]
    at: Option<At>,
    /// Export N frames from the starting state to the record's state
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    frames: Option<u32>,
    /// A file, a folder (with a / at its end), or how the files' names begin [default: maille-out/DESIGN-export/DESIGN]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive, conflicts_with = "from")]
    minor_radius: Option<f64>,
    /// Most distance between mesh and torus, in the file's unit [default: a hundredth of the reference radius]
    #[arg(long, value_parser = positive, conflicts_with = "segments")]
    tolerance: Option<f64>,
    /// Segments around a ring, or around a ring and across its wire, as 48 or 48x16
    #[arg(long, value_parser = parse_segments)]
    segments: Option<Fineness>,
    /// Millimetres for one unit of the file [default: by the file's `unit`, or 1]
    #[arg(long, value_parser = positive, value_name = "MM")]
    scale: Option<f64>,
    /// 3mf: what is one object
    #[arg(long, value_enum, default_value_t = ObjectsArg::Element)]
    objects: ObjectsArg,
    /// glb, ply: what colours show [default: load where the state has contact forces, kind elsewhere]
    #[arg(long, value_enum)]
    color_by: Option<ColorArg>,
    /// glb: instances by EXT_mesh_gpu_instancing; smaller and faster, but only for viewers that know it
    #[arg(long)]
    gpu_instancing: bool,
    /// Refuse if rings of different elements come closer than this many millimetres
    #[arg(long, value_parser = positive, value_name = "MM", conflicts_with = "frames")]
    min_clearance: Option<f64>,
    /// Only warn of rings closer than --min-clearance
    #[arg(long, requires = "min_clearance")]
    warn: bool,
    /// No list of files and no notes
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum FormatArg {
    #[value(name = "3mf")]
    ThreeMf,
    Stl,
    Obj,
    Glb,
    Vtk,
    Ply,
}

impl FormatArg {
    fn format(self) -> Format {
        match self {
            FormatArg::ThreeMf => Format::ThreeMf,
            FormatArg::Stl => Format::Stl,
            FormatArg::Obj => Format::Obj,
            FormatArg::Glb => Format::Glb,
            FormatArg::Vtk => Format::Vtk,
            FormatArg::Ply => Format::Ply,
        }
    }

    /// Whether rings share their mesh.
    fn instanced(self) -> bool {
        matches!(self, FormatArg::ThreeMf | FormatArg::Glb)
    }

    /// The format whose files end so.
    fn of_extension(path: &Path) -> Option<FormatArg> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "3mf" => Some(FormatArg::ThreeMf),
            "stl" => Some(FormatArg::Stl),
            "obj" => Some(FormatArg::Obj),
            "glb" => Some(FormatArg::Glb),
            "vtp" => Some(FormatArg::Vtk),
            "ply" => Some(FormatArg::Ply),
            _ => None,
        }
    }
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ObjectsArg {
    /// Each element, its rings as components
    Element,
    /// Each ring
    Ring,
    /// The whole tile, its rings as components: a slicer keeps their places
    Sheet,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ColorArg {
    /// The element of the design
    Kind,
    /// The sum of the contact forces on the element
    Load,
}

fn parse_segments(text: &str) -> Result<Fineness, String> {
    let count = |t: &str| match t.parse::<usize>() {
        Ok(n) if n >= 3 => Ok(n),
        _ => Err(format!("\"{t}\" is no number of segments; give 3 or more, as 48 or 48x16")),
    };
    Ok(match text.split_once('x') {
        None => Fineness::Segments(count(text)?, None),
        Some((around, across)) => Fineness::Segments(count(around)?, Some(count(across)?)),
    })
}

/// What is exported: a design, compiled, and perhaps a state of a record.
struct Source {
    design: Design,
    model: Model,
    locked: Option<(StateRecord, State)>,
}

/// Triangles that make large files where every ring has its own.
const MANY: usize = 5_000_000;

/// One state to write.
struct Frame {
    state: State,
    /// Added to the names of the files.
    suffix: String,
    /// Part of the way to the locked state.
    time: f64,
    description: String,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let source = source(args)?;
    let Source { design, model, locked } = &source;
    let note = |text: String| {
        if !args.quiet {
            eprintln!("note: {text}");
        }
    };
    let mm = match (args.scale, design.unit.as_deref()) {
        (Some(mm), _) => mm,
        (None, None) => {
            note("the design names no unit: one unit of the file becomes 1 mm (change it with --scale)".into());
            1.0
        }
        (None, Some(unit)) => millimetres(unit).unwrap_or_else(|| {
            note(format!("the unit \"{unit}\" is not known: one becomes 1 mm (change it with --scale)"));
            1.0
        }),
    };
    if let Some((record, _)) = locked
        && !matches!(record.status, Status::Global | Status::Local | Status::ThresholdReached)
    {
        note(format!("the state is \"{}\": the last of its search, no limit", record.status.name()));
    }
    let tolerance = args.tolerance.unwrap_or(0.01 * design.reference_radius);
    let fineness = args.segments.unwrap_or(Fineness::Tolerance(tolerance));
    let (prefix, formats) = destination(args, &source)?;
    let options = WriteOptions {
        objects: match args.objects {
            ObjectsArg::Element => Objects::Element,
            ObjectsArg::Ring => Objects::Ring,
            ObjectsArg::Sheet => Objects::Sheet,
        },
        colours: match args.color_by {
            Some(ColorArg::Kind) => Colours::Kind,
            Some(ColorArg::Load) => Colours::Load,
            None if args.frames.is_some() => Colours::Kind,
            None => Colours::Load,
        },
        gpu_instancing: args.gpu_instancing,
    };
    if matches!(args.color_by, Some(ColorArg::Load)) && locked.as_ref().is_none_or(|(r, _)| r.contacts.is_empty()) {
        note("there are no contact forces in this state: colours show the kind of element".into());
    }

    let frames = frames(args, &source)?;
    if let Some(clearance) = args.min_clearance
        && let Some(close) = mesh::too_close(model, &frames[0].state, args.tile, clearance, mm)
    {
        let problem = fuse(&close, clearance, mm, design, locked.is_some());
        match args.warn {
            false => return Err(problem),
            true => eprintln!("{:?}", problem.wrap_err("warning: written all the same (--warn)")),
        }
    }
    if args.frames.is_some() {
        let gaps =
            frames.iter().filter_map(|f| Some((topology::smallest_gap(model, &f.state)?.0 * model.unit * mm, f.time)));
        if let Some((gap, time)) = gaps.min_by(|a, b| a.0.total_cmp(&b.0))
            && gap < -1e-6 * model.unit * mm
        {
            note(format!("interpolated frames overlap, most by {:.3} mm at {:.0} % of the way", -gap, 100.0 * time));
        }
    }

    let mut series: Vec<(MeshFile, f64, PathBuf)> = Vec::new();
    for frame in &frames {
        let mut scene = Scene::new(model, &frame.state, args.tile, fineness, mm)?;
        scene.description = format!("{}; {} cells; 1 file unit = {mm} mm", frame.description, args.tile);
        if let Some((record, _)) = locked {
            match frame.time < 1.0 {
                true => scene.add_loads(model, &record.contacts),
                false => scene.add_contacts(model, &frame.state, args.tile, &record.contacts),
            }
        }
        let triangles = scene.triangle_count();
        if triangles > MANY && frame.time == frames[0].time && formats.iter().any(|f| !f.instanced()) {
            note(format!("{triangles} triangles will be written; 3mf and glb store each ring once"));
        }
        for file in formats.iter().flat_map(|f| f.format().files(&scene)) {
            let path = with_ending(&prefix, &format!("{}{}", frame.suffix, file.ending()));
            let bytes = write(&path, &scene, file, options)?;
            if !args.quiet {
                println!("{}  {}", path.display(), size(bytes));
            }
            series.push((file, frame.time, path));
        }
        if !args.quiet && frame.time == frames[frames.len() - 1].time {
            summary(&scene);
        }
    }
    if args.frames.is_some() && formats.contains(&FormatArg::Vtk) {
        for (file, ending) in [(MeshFile::VtkRings, ".pvd"), (MeshFile::VtkPoses, "-poses.pvd")] {
            let of = |wanted: MeshFile, part: usize| {
                series.iter().filter(move |(f, ..)| *f == wanted).map(move |(_, time, path)| {
                    (*time, part, path.file_name().unwrap_or_default().to_string_lossy().into_owned())
                })
            };
            let files: Vec<_> = of(file, 0).chain(of(MeshFile::VtkContacts, 1)).collect();
            let path = with_ending(&prefix, ending);
            replace(&path, |out| Ok(std::io::Write::write_all(out, mesh::write_pvd(&files).as_bytes())?))?;
            if !args.quiet {
                println!("{}  {} frames", path.display(), frames.len());
            }
        }
    }
    Ok(())
}

/// The design and its state: from the record where one is asked for.
fn source(args: &Args) -> Result<Source> {
    let input = args.design.as_deref().map(|name| Input::read(name, args.minor_radius)).transpose()?;
    let folder = match (&args.from, &input) {
        (Some(folder), _) => folder.clone(),
        (None, Some(input)) if args.at.is_some() || args.frames.is_some() => usual_folder(&input.design),
        (None, Some(input)) => {
            let model = input.compile(&input.design, Cell::PRIMITIVE)?;
            return Ok(Source { design: input.design.clone(), model, locked: None });
        }
        (None, None) => return Err(miette!("there is neither a design nor a record")),
    };
    let at = args.at.unwrap_or_default();
    let record = Record::read(&folder).map_err(|e| {
        let missing = args.from.is_none() || !folder.exists();
        match (&input, missing) {
            (Some(input), true) => {
                let line = characterize_line(args, &input.design, None, at, &folder);
                miette!(
                    help = format!("compute it with\n  {line}"),
                    "{} holds no record to take a state from",
                    folder.display()
                )
            }
            (None, true) => miette!(
                help = "give the folder that `maille characterize` wrote: it holds run.json and states.jsonl",
                "there is no folder {}",
                folder.display()
            ),
            _ => Report::new(e),
        }
    })?;
    let design = &record.run.design;
    if let Some(input) = &input
        && input.design != *design
    {
        let r = |d: &Design| d.minor_radius.map_or(String::new(), |r| format!(" with r = {r}"));
        return Err(miette!(
            help = format!(
                "leave the design out to export what the record holds, or compute this one with\n  {}",
                characterize_line(args, &input.design, Some(&record), at, &usual_folder(&input.design))
            ),
            "the record {} is of another design: \"{}\"{}, not \"{}\"{} as in the file",
            folder.display(),
            design.name,
            r(design),
            input.design.name,
            r(&input.design),
        ));
    }
    let state = pick(args, &record, at, &folder)?;
    // The cell is that of the row: a run may solve several.
    let of_state = |r: &&LimitRow| (r.direction_deg, r.l2, r.status) == (state.direction_deg, state.l2, state.status);
    let row = record.rows.iter().find(of_state);
    let unusable = |problems: Vec<InvalidInput>| {
        let list: Vec<String> = problems.iter().map(|p| format!("  {}: {}", p.field, p.problem)).collect();
        miette!("the design of the record {} cannot be used:\n{}", folder.display(), list.join("\n"))
    };
    let cell: Cell = row.map_or("1x1", |r| &r.cell).parse().map_err(|problem| unusable(vec![problem]))?;
    let model = Model::compile(design, cell).map_err(unusable)?;
    let locked = mesh::state_of(&model, state)?;
    Ok(Source { design: design.clone(), locked: Some((state.clone(), locked)), model })
}

/// The only state that fits.
fn pick<'a>(args: &Args, record: &'a Record, at: At, folder: &Path) -> Result<&'a StateRecord> {
    let fits = |s: &&StateRecord| at.fits(s.direction_deg, s.l2) && !s.poses.is_empty();
    let found: Vec<&StateRecord> = record.states.iter().filter(fits).collect();
    let list = |states: &[&StateRecord]| {
        let some: Vec<String> =
            states.iter().take(6).map(|s| format!("  --at direction={},l2={}", s.direction_deg, s.l2)).collect();
        let more = states.len().saturating_sub(6);
        some.join("\n") + &if more > 0 { format!("\n  … and {more} more") } else { String::new() }
    };
    match found[..] {
        [state] => Ok(state),
        [] => {
            let line = characterize_line(args, &record.run.design, Some(record), at, &another(folder, at));
            let mut all: Vec<&StateRecord> = record.states.iter().filter(|s| !s.poses.is_empty()).collect();
            // The nearest first: a degree weighs as much as 0.01 of l2.
            let far = |s: &StateRecord| {
                at.direction.map_or(0.0, |d| (d - s.direction_deg).abs())
                    + at.l2.map_or(0.0, |l| 100.0 * (l - s.l2).abs())
            };
            all.sort_by(|a, b| far(a).total_cmp(&far(b)));
            Err(miette!(
                help = format!(
                    "it has, the nearest first:\n{}\ncompute the one asked for with\n  {line}\nand then give its folder with --from",
                    list(&all)
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

/// The command that computes the state asked for.
fn characterize_line(args: &Args, design: &Design, record: Option<&Record>, at: At, folder: &Path) -> String {
    let quoted = |text: &str| match text.contains([' ', ';']) {
        true => format!("\"{text}\""),
        false => text.to_owned(),
    };
    let mut line = format!("maille characterize {}", quoted(args.design.as_deref().unwrap_or(&design.name)));
    if let Some(direction) = at.direction {
        line += &format!(" --directions {direction}");
    }
    if let Some(l2) = at.l2 {
        line += &format!(" --l2 {l2}");
    }
    if let Some(r) =
        args.minor_radius.or(record.and_then(|r| r.run.design.minor_radius).filter(|_| args.design.is_none()))
    {
        line += &format!(" --minor-radius {r}");
    }
    let parameter = |name: &str| record.and_then(|r| r.run.parameters.get(name));
    if let Some(method) = parameter("method").and_then(|v| v.as_str()) {
        line += &format!(" --method {method}");
    }
    // Several cells are those of the default, auto.
    if let Some([cell]) = parameter("cells").and_then(|v| v.as_array()).map(Vec::as_slice) {
        line += &format!(" --cell {}", quoted(cell.as_str().unwrap_or("1x1")));
    }
    line + &format!(" --out {}", quoted(&folder.display().to_string()))
}

/// Where `characterize` writes if it is not told.
fn usual_folder(design: &Design) -> PathBuf {
    PathBuf::from("maille-out").join(file_name(&design.name))
}

/// A folder for a record of other directions than those of `folder`.
fn another(folder: &Path, at: At) -> PathBuf {
    with_ending(folder, &place(at.direction, at.l2))
}

fn place(direction: Option<f64>, l2: Option<f64>) -> String {
    direction.map_or(String::new(), |d| format!("_dir{d}")) + &l2.map_or(String::new(), |l2| format!("_l2_{l2}"))
}

/// The states to write: one, or the frames to the locked one.
fn frames(args: &Args, source: &Source) -> Result<Vec<Frame>> {
    let Source { design, model, locked } = source;
    let title = format!("{} {}", design.name, design.title);
    let start =
        |description: String| Frame { state: model.start.clone(), suffix: String::new(), time: 0.0, description };
    let Some((record, state)) = locked else {
        return Ok(vec![start(format!("{title}; starting state"))]);
    };
    let place = format!("direction {}°, l2 {}, {}", record.direction_deg, record.l2, record.status.name());
    let Some(count) = args.frames else {
        return Ok(vec![Frame { state: state.clone(), time: 1.0, ..start(format!("{title}; {place}")) }]);
    };
    let digits = (count - 1).to_string().len();
    Ok((0..count)
        .map(|k| {
            let time = f64::from(k) / f64::from(count - 1);
            Frame {
                state: mesh::between(&model.start, state, time),
                suffix: format!("_f{k:0digits$}"),
                time,
                description: format!(
                    "{title}; frame {} of {count} from the starting state to {place}; interpolated, may overlap",
                    k + 1
                ),
            }
        })
        .collect())
}

/// How the names of the files begin, and the formats.
fn destination(args: &Args, source: &Source) -> Result<(PathBuf, Vec<FormatArg>)> {
    let name = file_name(&source.design.name);
    let stem = match &source.locked {
        Some((record, _)) => format!("{name}{}", place(Some(record.direction_deg), Some(record.l2))),
        None => name.clone(),
    };
    let mut formats: Vec<FormatArg> = Vec::new();
    for format in &args.format {
        if !formats.contains(format) {
            formats.push(*format);
        }
    }
    let Some(out) = &args.out else {
        formats.extend(formats.is_empty().then_some(FormatArg::ThreeMf));
        return Ok((PathBuf::from("maille-out").join(format!("{name}-export")).join(stem), formats));
    };
    if out.as_os_str().to_string_lossy().ends_with(std::path::is_separator) || out.is_dir() {
        formats.extend(formats.is_empty().then_some(FormatArg::ThreeMf));
        return Ok((out.join(stem), formats));
    }
    match FormatArg::of_extension(out) {
        None => {
            formats.extend(formats.is_empty().then_some(FormatArg::ThreeMf));
            Ok((out.clone(), formats))
        }
        Some(named) if formats.is_empty() || formats.contains(&named) => {
            formats.extend(formats.is_empty().then_some(named));
            Ok((out.with_extension(""), formats))
        }
        Some(_) => Err(miette!(
            help = "leave --format out, or give a name without an ending",
            "{} ends otherwise than the files of --format",
            out.display()
        )),
    }
}

fn with_ending(prefix: &Path, ending: &str) -> PathBuf {
    let mut path = prefix.as_os_str().to_owned();
    path.push(ending);
    path.into()
}

/// Millimetres of a unit that people write in a design.
fn millimetres(unit: &str) -> Option<f64> {
    Some(match unit.trim().to_lowercase().as_str() {
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => 1.0,
        "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => 10.0,
        "m" | "metre" | "metres" | "meter" | "meters" => 1000.0,
        "um" | "µm" | "μm" | "micron" | "microns" | "micrometre" | "micrometer" => 0.001,
        "in" | "inch" | "inches" | "\"" => 25.4,
        "ft" | "foot" | "feet" => 304.8,
        _ => return None,
    })
}

/// What would fuse, and what would help.
fn fuse(close: &mesh::TooClose, clearance: f64, mm: f64, design: &Design, locked: bool) -> Report {
    let [a, b] = &close.rings;
    let [x, y, z] = [close.place.x, close.place.y, close.place.z].map(|x| (x * 1e3).round() / 1e3 + 0.0);
    let how = match close.gap < 0.0 {
        true => format!("overlap by {:.3} mm", -close.gap),
        false => format!("are {:.3} mm apart", close.gap),
    };
    let more = match close.pairs {
        1 => "no other pair of the cell is".to_owned(),
        n => format!("{n} pairs of the cell are"),
    };
    let thinner = match (close.minor_radius_factor, design.minor_radius) {
        (None, _) => "no minor radius would leave it in this state".to_owned(),
        (Some(f), Some(r)) if design.elements.iter().flat_map(|e| &e.rings).all(|ring| ring.minor_radius.is_none()) => {
            format!("minor_radius = {} would leave it (now {r})", down(f * r))
        }
        (Some(f), _) => format!("{} times every minor_radius would leave it", down(f)),
    };
    let larger = match close.scale_factor {
        Some(f) => format!("--scale {} would leave it (now {mm})", up(f * mm)),
        None => "rings touch, so no --scale would leave it".to_owned(),
    };
    let state = if locked { "\nin a locked state rings touch: print the starting state" } else { "" };
    let help = format!("{thinner}\n{larger}\n--warn writes all the same{state}");
    miette!(
        help = help,
        "rings would fuse: {a} and {b} {how} at ({x}, {y}, {z}) mm, less than --min-clearance {clearance}; {more} too close"
    )
}

/// Four digits, rounded so that the clearance stays.
fn down(x: f64) -> f64 {
    let unit = 10_f64.powf(x.log10().floor() - 3.0);
    let digits = (x / unit + 1e-9).floor() * unit;
    format!("{digits:.12}").parse().unwrap_or(digits)
}

fn up(x: f64) -> f64 {
    let unit = 10_f64.powf(x.log10().floor() - 3.0);
    let digits = (x / unit - 1e-9).ceil() * unit;
    format!("{digits:.12}").parse().unwrap_or(digits)
}

/// Writes one file of `scene`; gives its size.
fn write(path: &Path, scene: &Scene, file: MeshFile, options: WriteOptions) -> Result<u64> {
    replace(path, |out| file.write(scene, options, out))?;
    Ok(fs::metadata(path).map(|m| m.len()).unwrap_or(0))
}

/// Writes under a temporary name in the same folder and renames: whatever happens, a file of this name is whole.
fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<&mut fs::File>) -> Result<(), MeshError>) -> Result<()> {
    let context = || format!("cannot write {}", path.display());
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder).into_diagnostic().wrap_err_with(|| format!("cannot create {}", folder.display()))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".maille-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // the umask applies, as to any new file
    let mut file = builder.tempfile_in(folder).into_diagnostic().wrap_err_with(context)?;
    let mut out = BufWriter::with_capacity(1 << 18, file.as_file_mut());
    write(&mut out).map_err(Report::from).wrap_err_with(context)?;
    std::io::Write::flush(&mut out).into_diagnostic().wrap_err_with(context)?;
    drop(out);
    file.persist(path).into_diagnostic().wrap_err_with(context)?;
    Ok(())
}

fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.2} GB", bytes as f64 / 1e9),
    }
}

fn summary(scene: &Scene) {
    let [least, largest] = scene.bounds();
    let extent = largest - least;
    println!(
        "{} rings, {} triangles (meshes within {:.3} mm of the tori); {:.1} × {:.1} × {:.1} mm",
        scene.ring_count(),
        scene.triangle_count(),
        scene.chordal_error(),
        extent.x,
        extent.y,
        extent.z
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_segments_are_read() {
        assert_eq!(parse_at("direction=30,l2=-0.125").unwrap(), At { direction: Some(30.0), l2: Some(-0.125) });
        assert_eq!(parse_at("l2=0").unwrap(), At { direction: None, l2: Some(0.0) });
        for wrong in ["", "30", "direction=a", "angle=3", "l2=nan", "l2=0,l2=1"] {
            assert!(parse_at(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_segments("48x16").unwrap(), Fineness::Segments(48, Some(16)));
        for wrong in ["", "2", "x", "48x", "48x2", "-3"] {
            assert!(parse_segments(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn advice_keeps_the_clearance() {
        for x in [0.083_333_3, 0.1, 1.0, 12.3456, 9999.5] {
            assert!(down(x) <= x * (1.0 + 1e-8) && down(x) > x * 0.998);
            assert!(up(x) >= x * (1.0 - 1e-8) && up(x) < x * 1.002);
        }
        assert_eq!(down(0.1), 0.1);
    }
}
