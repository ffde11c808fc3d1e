//! `maille export`: meshes of a sheet, to print, to show and to analyse.

mod advice;
mod destination;

use crate::{
    exit::{self, wrong},
    extreme::closest,
    frames::Frame,
    input,
    numbers::positive,
    output,
    piece::PieceArgs,
    remedy,
    source::{Source, SourceArgs, Wanted},
    units::{Length, parse_length},
};
use advice::{fuse, gaps, large, possible, size, summary};
use destination::{Destination, FormatArg, destination, with_ending};
use maille::{design::Design, topology};
use maille_io::Tile;
use maille_mesh::{Colours, Fineness, MeshFile, Objects, Scene, TorusMesh, WriteOptions};
use miette::Result;
use std::{
    fs,
    io::Cursor,
    path::{Path, PathBuf},
};

/// Meshes of a sheet: to print, to show and to analyse
///
/// Exports a tile of the starting state, of a locked state from a record, of the roomiest state, or frames from the one to the other. Lengths
/// come out in millimetres (GLB: metres); rings are closed meshes that face outward.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille export 1.1 --tile 8x8                                    maille-out/1.1-export/1.1.3mf
  maille export 1.1 --tile 8x8 --format stl,glb --scale 5         R = 1 becomes 5 mm
  maille export my-weave.toml --size 100x100mm --scale 1.5        as many cells as come nearest to that
  maille export my-weave.toml --out prints/ --min-clearance 0.3   refuses if rings would fuse
  maille export 1.1 --at direction=30,l2=-0.25 --out locked.glb   a limit of maille-out/1.1
  maille export 1.1 --at roomiest --tile 8x8                      the widest gaps, to print in place
  maille export my-weave.toml --min-gap 0.3mm --size 10x10cm      the closest cell that can still be printed
  maille export 1.1 --at roomiest --lattice free                  with the spacing found, too
  maille export --from results/weave --at direction=0,l2=0 --format vtk --frames 20
  maille export --from maille-out/1.1-simulate --format vtk --frames 100    the states of a simulation

Formats:
  3mf  for printing: real units, each ring stored once; see --objects
  stl  binary; obj; ply (binary, coloured): every ring with its own triangles
  glb  glTF for viewers: each ring stored once, coloured; see --color-by
  vtk  for ParaView: NAME.vtp (rings), NAME-poses.vtp, NAME-contacts.vtp; NAME.pvd for frames

Meshes stand on the bed: their smallest x, y and z are 0 (glb: y is up; vtk keeps the coordinates of the state; frames \
keep their places relative to the first).

Elements of several rings are several closed bodies that overlap where they are joined. Slicers unite the \
overlapping bodies of one object, so print such designs as 3mf with --objects element (the default) or sheet.

Frames of a simulation are states that it found. Others are interpolated: lattice and positions on straight lines, rotations at constant rate. That shows the \
change and is not a motion that the rings could make: they may overlap in between.")]
pub struct Args {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    piece: PieceArgs,
    /// One or several, as stl,3mf [default: by the name of --out, or 3mf]
    #[arg(long, value_enum, value_delimiter = ',')]
    format: Vec<FormatArg>,
    /// Export N frames from the starting state to the record's state
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    frames: Option<u32>,
    /// A file, a folder (with a / at its end), how the files' names begin (with --format), or - for standard output [default: maille-out/DESIGN-export/DESIGN]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Maximum distance between mesh and torus, in the file's unit [default: a hundredth of the reference radius]
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
    /// Refuse if the meshes of different elements come closer than this many millimetres, as 0.3 or 0.3mm
    #[arg(long, value_parser = clearance, value_name = "MM", conflicts_with = "frames")]
    min_clearance: Option<f64>,
    /// Export the closest cell in which the meshes of different elements are at least this far apart in the size that is
    /// written, as 0.3mm: the smallest area, over all poses and the lattice; as `maille roomiest --min-gap` finds it
    #[arg(long, value_parser = parse_length, value_name = "LENGTH", conflicts_with_all = ["at", "lattice", "from", "frames"])]
    min_gap: Option<Length>,
    /// Only warn of rings closer than --min-clearance
    #[arg(long, requires = "min_clearance")]
    warn: bool,
    #[command(flatten)]
    replace: output::Replace,
    /// Write files of more than 1 GB in all
    #[arg(long)]
    allow_large: bool,
    /// No list of files and no notes
    #[arg(long, short)]
    quiet: bool,
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
        _ => Err(format!("\"{t}\" is not a number of segments; give 3 or more, as 48 or 48x16")),
    };
    Ok(match text.split_once('x') {
        None => Fineness::Segments(count(text)?, None),
        Some((around, across)) => Fineness::Segments(count(around)?, Some(count(across)?)),
    })
}

/// Millimetres in one unit of the file.
fn millimetres(args: &Args, unit: Option<&str>, note: impl Fn(String)) -> f64 {
    let assumed = |why: String| {
        note(why);
        1.0
    };
    match (args.scale, unit) {
        (Some(mm), _) => mm,
        (None, None) => {
            assumed("the design names no unit: one unit of the file becomes 1 mm (change it with --scale)".into())
        }
        (None, Some(unit)) => maille_io::millimetres(unit).unwrap_or_else(|| {
            assumed(format!("the unit \"{unit}\" is not known: one becomes 1 mm (change it with --scale)"))
        }),
    }
}

fn write_options(args: &Args) -> WriteOptions {
    WriteOptions {
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
    }
}

/// Millimetres, with the unit or without it; also a length in another unit.
fn clearance(text: &str) -> Result<f64, String> {
    positive(text).or_else(|_| parse_length(text).map(|length| length.mm)).map_err(|_| {
        format!("\"{text}\" is not a positive length; give millimetres, such as 0.3, or a length with its unit, such as 0.3mm")
    })
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let source = match args.min_gap {
        Some(gap) => {
            let found = args.source.closest(|design| Ok(closest(design, torus_gap(args, design, gap)?)));
            found.map_err(|report| match remedy::code(&report) {
                exit::INCOMPLETE => report.wrap_err(format!(
                    "no cell in which meshes keep {} mm: their tori need a little more, as meshes stand out of them",
                    gap.mm
                )),
                _ => report,
            })?
        }
        None => args.source.read(Wanted { locked: args.frames.is_some(), overlaps: false, threads: None })?,
    };
    let (destination, formats) = destination(args.out.as_deref(), &args.format, args.frames.is_some(), &source)?;
    let frames = source.frames(args.frames);
    if let Destination::Files(prefix) = &destination {
        refuse_existing(args, prefix, &formats, &frames)?;
    }
    let note = |text: String| {
        if !args.quiet {
            eprintln!("note: {text}");
        }
    };
    let mm = millimetres(args, source.design.unit.as_deref(), note);
    let tile = tile(args, &source, &frames, mm)?;
    source.caution().into_iter().for_each(note);
    if matches!(args.color_by, Some(ColorArg::Load)) && source.contacts().is_empty() {
        note("there are no contact forces in this state: colours show the kind of element".into());
    }
    if args.frames.is_some() && source.simulated.is_none() {
        interpolation_note(&source, &frames, mm).into_iter().for_each(note);
    }
    if !args.quiet {
        input::warn(&source.model);
    }
    let series = write_frames(args, &source, &frames, tile, mm, &destination, &formats)?;
    match &destination {
        Destination::Files(prefix) if args.frames.is_some() && formats.contains(&FormatArg::Vtk) => {
            write_collections(prefix, &series, frames.len(), args.quiet)
        }
        _ => Ok(()),
    }
}

/// The gap of the tori, in the file's unit, that keeps meshes `gap` apart: a mesh can lie outside its torus by its protrusion.
fn torus_gap(args: &Args, design: &Design, gap: Length) -> Result<f64> {
    let mm = millimetres(args, design.unit.as_deref(), drop);
    let mut outside = 0.0_f64;
    for ring in design.elements.iter().flat_map(|element| &element.rings) {
        let (major, minor) = (ring.major_radius, ring.minor_radius.or(design.minor_radius).unwrap_or(0.0));
        let segments = fineness(args, design).segments(major, minor)?;
        outside = outside.max(TorusMesh::new(major, minor, segments).protrusion());
    }
    for curve in design.elements.iter().flat_map(|element| &element.curves) {
        let wire = curve.minor_radius.or(design.minor_radius).unwrap_or(0.0);
        outside = outside.max(fineness(args, design).protrusion(curve.shape.reach() + wire));
    }
    Ok(gap.mm / mm + 2.0 * outside)
}

fn fineness(args: &Args, design: &Design) -> Fineness {
    args.segments.unwrap_or(Fineness::Tolerance(args.tolerance.unwrap_or(0.01 * design.reference_radius)))
}

/// The cells that are exported; says which, if a size was asked for.
fn tile(args: &Args, source: &Source, frames: &[Frame], mm: f64) -> Result<Tile> {
    if !source.model.periodic {
        if args.piece.is_size() {
            let help = "leave --size out, or simulate a sheet of that size";
            return Err(wrong(exit::USAGE, "a simulated sheet is exported as a whole", help));
        }
        return Ok(Tile([1, 1]));
    }
    let (tile, words) = args.piece.tile(&source.model, &frames[frames.len() - 1].state, source.tube_tile(), mm);
    if let Some(words) = words.filter(|_| !args.quiet) {
        eprintln!("note: {words}");
    }
    Ok(tile)
}

/// Files that are there are replaced only with --overwrite; nothing is written if one of them is.
fn refuse_existing(args: &Args, prefix: &Path, formats: &[FormatArg], frames: &[Frame]) -> Result<()> {
    for frame in frames {
        for file in formats.iter().flat_map(|f| f.format().all_files()) {
            args.replace.check(&with_ending(prefix, &format!("{}{}", frame.suffix, file.ending())))?;
        }
    }
    if args.frames.is_some() && formats.iter().any(|f| f.format().all_files().contains(&MeshFile::VtkRings)) {
        COLLECTIONS.iter().try_for_each(|(_, ending)| args.replace.check(&with_ending(prefix, ending)))?;
    }
    Ok(())
}

/// Writes the files of all frames; gives them with their times.
fn write_frames(
    args: &Args,
    source: &Source,
    frames: &[Frame],
    tile: Tile,
    mm: f64,
    destination: &Destination,
    formats: &[FormatArg],
) -> Result<Vec<(MeshFile, f64, PathBuf)>> {
    let Source { design, model, .. } = source;
    let fineness = fineness(args, design);
    let options = write_options(args);
    args.min_clearance.map_or(Ok(()), |clearance| possible(clearance, mm, source))?;
    let (mut series, mut origin) = (Vec::new(), None);
    for (k, frame) in frames.iter().enumerate() {
        let mut scene = scene(source, frame, tile, fineness, mm)?;
        // Frames keep their places to each other.
        scene.origin = *origin.get_or_insert(scene.origin);
        if let Some(wanted) = args.min_clearance
            && let Some(close) = maille_mesh::too_close(&scene, model, &frame.state, tile, fineness, wanted)
        {
            let problem = fuse(&close, wanted, mm, source);
            match args.warn {
                false => return Err(problem),
                true => eprintln!("{:?}", problem.wrap_err("warning: written anyway (--warn)")),
            }
        }
        if k == 0 && !args.allow_large {
            large(&scene, formats, frames.len())?;
        }
        for file in formats.iter().flat_map(|f| f.format().files(&scene)) {
            let Destination::Files(prefix) = destination else {
                let mut bytes = Cursor::new(Vec::new()); // 3MF goes back in its file
                file.write(&scene, options, &mut bytes)?;
                output::print(bytes.get_ref())?;
                return Ok(series);
            };
            let path = with_ending(prefix, &format!("{}{}", frame.suffix, file.ending()));
            let bytes = write(&path, &scene, file, options)?;
            if !args.quiet {
                output::say!("{}  {}", path.display(), size(bytes));
            }
            series.push((file, frame.time, path));
        }
        if !args.quiet && k + 1 == frames.len() {
            summary(&scene);
            if args.frames.is_none() {
                gaps(&scene, source, &frame.state, tile);
            }
        }
    }
    Ok(series)
}

/// The tile in the state of a frame.
fn scene(source: &Source, frame: &Frame, tile: Tile, fineness: Fineness, mm: f64) -> Result<Scene> {
    let Source { model, locked, .. } = source;
    let mut scene = Scene::new(model, &frame.state, tile, fineness, mm)?;
    scene.description = format!(
        "{}; {} cells; 1 file unit = {mm} mm",
        frame.description,
        if model.periodic { tile.to_string() } else { model.cell.to_string() }
    );
    if let Some((record, _)) = locked {
        match frame.time < 1.0 {
            true => scene.add_loads(model, &record.contacts),
            false => scene.add_contacts(model, &frame.state, tile, &record.contacts),
        }
    }
    Ok(scene)
}

fn write_collections(prefix: &Path, series: &[(MeshFile, f64, PathBuf)], frames: usize, quiet: bool) -> Result<()> {
    for (path, text) in collections(prefix, series) {
        output::write(&path, text.as_bytes())?;
        if !quiet {
            output::say!("{}  {}", path.display(), output::counted(frames, "frame"));
        }
    }
    Ok(())
}

/// A word on frames that overlap: they are interpolated.
fn interpolation_note(source: &Source, frames: &[Frame], mm: f64) -> Option<String> {
    let unit = source.model.unit * mm;
    let gaps = frames.iter().filter_map(|f| Some((topology::smallest_gap(&source.model, &f.state)?.0 * unit, f.time)));
    let (gap, time) = gaps.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let overlap = gap < -1e-6 * unit;
    overlap.then(|| format!("interpolated frames overlap, most by {:.3} mm at {:.0} % of the way", -gap, 100.0 * time))
}

/// What a list of VTK frames is of, and the end of its name.
const COLLECTIONS: [(MeshFile, &str); 2] = [(MeshFile::VtkRings, ".pvd"), (MeshFile::VtkPoses, "-poses.pvd")];

/// The files that list a series of VTK frames, with their texts.
fn collections(prefix: &Path, series: &[(MeshFile, f64, PathBuf)]) -> Vec<(PathBuf, String)> {
    let of = |wanted: MeshFile, part: usize| {
        series.iter().filter(move |(f, ..)| *f == wanted).map(move |(_, time, path)| {
            (*time, part, path.file_name().unwrap_or_default().to_string_lossy().into_owned())
        })
    };
    COLLECTIONS
        .map(|(file, ending)| {
            let files: Vec<_> = of(file, 0).chain(of(MeshFile::VtkContacts, 1)).collect();
            (with_ending(prefix, ending), maille_mesh::write_pvd(&files))
        })
        .into()
}

/// Writes one file of `scene`; gives its size.
fn write(path: &Path, scene: &Scene, file: MeshFile, options: WriteOptions) -> Result<u64> {
    output::replace(path, |out| Ok(file.write(scene, options, out)?))?;
    Ok(fs::metadata(path).map(|m| m.len()).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_read() {
        assert_eq!(parse_segments("48x16").unwrap(), Fineness::Segments(48, Some(16)));
        for wrong in ["", "2", "x", "48x", "48x2", "-3"] {
            assert!(parse_segments(wrong).is_err(), "{wrong}");
        }
    }
}
