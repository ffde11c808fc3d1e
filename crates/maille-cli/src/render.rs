//! `maille render`: a picture of a sheet.

use crate::{
    exit::{self, wrong},
    map::pool,
    numbers::positive,
    output,
    piece::{self, known_millimetres},
    progress::Spinner,
    source::{Source, SourceArgs, Wanted},
    units,
};
use maille::lattice::Direction;
use maille_io::Tile;
use maille_render::{
    Background, Caption, ColorBy, Extent, Forces, Picture, RenderError, RenderOptions, Subject, View, film, members,
    render_frames,
};
use maille_svg::with_palette;
use miette::{IntoDiagnostic, Report, Result};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// A picture of a sheet, as PNG, or a film, as GIF
///
/// Draws a patch of the starting state, or of a locked state from a record with its contact forces. The rings are exact
/// tori, drawn without a graphics card; the same command gives the same picture on any number of threads.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille render 1.1                                               maille-out/1.1.png
  maille render 3.1 --view top --cell                             from above, with the unit cell
  maille render shirt.toml --size 100x100mm --size 800x600        a piece of sheet, and the picture's pixels
  maille render my-weave.toml --tile 6x4 --perspective --background dark --out slide.png
  maille render 1.1 --at direction=30,l2=-0.125                   a limit of maille-out/1.1, with its forces
  maille render 1.1 --at roomiest                                 the state with the widest gaps
  maille render --from results/weave --at direction=0,l2=0 --color load --forces none
  maille render --from maille-out/1.1-simulate --at frame=3       a state of a simulated sheet
  maille render --from maille-out/1.1-simulate --frames 40        maille-out/1.1-simulate.gif
  maille render 1.1 --at direction=30 --frames 30                 from the starting state to the limit, interpolated
  maille render 1.1 --size 300x225 --no-scale-bar --out -         to standard output

Colours: elements that differ by a translation alone share one. With --color load, from yellow to violet by the sum of
the contact forces on an element; grey carries none.

Arrows: at each contact, the force on either ring, from where the wires touch, seen through the rings. Where there are
many, those of one cell; --forces all shows them in the whole patch. The arrow D above is along the pull.")]
pub struct Args {
    #[command(flatten)]
    source: SourceArgs,
    /// Show this many cells along a1 and a2
    #[arg(long, value_name = "MxN", conflicts_with = "patch")]
    tile: Option<Tile>,
    /// Pixels across and down, as 800x600 [default: 1600x1200, or 1600x600 along the sheet]; or, with a unit, the piece of sheet, as
    /// 100x100mm: the whole cells that come nearest, measured with the wire. May be given once for each
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Vec<SizeArg>,
    /// Show the elements in a rectangle of this size in the file's unit, without loose ends [default: as fills the picture]
    #[arg(long, value_name = "WxH", value_parser = parse_patch)]
    patch: Option<[f64; 2]>,
    /// Direction of view: top, tilted, side, or azimuth,elevation in degrees (0,0 looks along y, 0,90 down)
    #[arg(long, value_name = "VIEW", default_value = "tilted", allow_hyphen_values = true)]
    view: View,
    /// Near rings larger than far ones
    #[arg(long)]
    perspective: bool,
    /// What is behind the sheet
    #[arg(long, value_enum, default_value_t = BackgroundArg::White)]
    background: BackgroundArg,
    /// What colours mean
    #[arg(long, value_enum, default_value_t = ColorArg::Element)]
    color: ColorArg,
    /// Contact forces of a locked state [default: arrows where the state has forces]
    #[arg(long, value_enum)]
    forces: Option<ForcesArg>,
    /// Nothing above the sheet [default: what limit it is, with an arrow D along the pull]
    #[arg(long)]
    no_caption: bool,
    /// Outline one cell, with a1 and a2
    #[arg(long)]
    cell: bool,
    /// No scale bar
    #[arg(long)]
    no_scale_bar: bool,
    /// No shadow on the ground below the sheet
    #[arg(long)]
    no_shadow: bool,
    /// 256 colours, chosen for the picture: a third of the bytes, for web pages
    #[arg(long)]
    palette: bool,
    /// A film of N frames, as GIF: the states of a simulation, or from the starting state to the record's, interpolated
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=2_000), conflicts_with = "palette")]
    frames: Option<u32>,
    /// The file, or - for standard output [default: maille-out/DESIGN.png (.gif), with the state in its name]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    replace: output::Replace,
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
    /// As arrows; on a dense weave those of one cell
    Arrows,
    /// As arrows in the whole patch
    All,
    None,
}

/// What `--size` gives: that of the picture, or of the sheet.
#[derive(Clone, Copy)]
enum SizeArg {
    Pixels([u32; 2]),
    Millimetres([f64; 2]),
}

fn parse_size(text: &str) -> Result<SizeArg, String> {
    let side = |t: &str| t.parse::<u32>().ok();
    if let Some((Some(w), Some(h))) = text.split_once('x').map(|(w, h)| (side(w), side(h))) {
        return Ok(SizeArg::Pixels([w, h]));
    }
    units::parse_size(text).map(SizeArg::Millimetres).map_err(|_| {
        format!("\"{text}\" is not a size; give pixels across and down, as 1600x1200, or a piece of sheet with its unit, as 100x100mm")
    })
}

/// The pixels, and the piece of sheet.
fn sizes(args: &Args) -> Result<([u32; 2], Option<[f64; 2]>)> {
    let (mut pixels, mut piece) = (None, None);
    for size in &args.size {
        let twice = match size {
            SizeArg::Pixels(size) => pixels.replace(*size).is_some(),
            SizeArg::Millimetres(size) => piece.replace(*size).is_some(),
        };
        if twice {
            let help = "give --size once in pixels and once with a unit";
            return Err(wrong(exit::USAGE, "--size is given twice for the same", help));
        }
    }
    if piece.is_some() && (args.tile.is_some() || args.patch.is_some()) {
        let help = "leave out --tile and --patch, or --size";
        return Err(wrong(exit::USAGE, "--size says already how much of the sheet is shown", help));
    }
    Ok((pixels.unwrap_or(if args.view.is_low() { [1600, 600] } else { [1600, 1200] }), piece))
}

/// Which part of the sheet is shown.
fn extent(args: &Args, source: &Source, pixels: [u32; 2], piece: Option<[f64; 2]>) -> Result<Extent> {
    let Source { design, model, locked, .. } = source;
    if !model.periodic {
        if piece.is_some() {
            let help = "leave --size out, or simulate a sheet of that size";
            return Err(wrong(exit::USAGE, "a simulated sheet is shown as a whole", help));
        }
        return Ok(Extent::Cells([1, 1]));
    }
    Ok(match (piece, args.tile, args.patch) {
        (Some(size), ..) => {
            let mm = known_millimetres(design.unit.as_deref(), "a size", "--size")?;
            let state = locked.as_ref().map_or(&model.start, |(_, state)| state);
            let tile = piece::nearest(model, state, mm, size);
            if !args.quiet {
                eprintln!("note: {}", piece::words(tile, model, state, mm));
            }
            Extent::Cells(tile.0)
        }
        (None, Some(tile), _) => Extent::Cells(tile.0),
        (None, None, Some(patch)) => Extent::Patch(patch),
        (None, None, None) => match source.tube_tile() {
            Some(tube) => Extent::Cells(tube.0),
            None => Extent::filling(pixels, args.view, design.reference_radius),
        },
    })
}

fn parse_patch(text: &str) -> Result<[f64; 2], String> {
    match text.split_once('x').map(|(w, h)| (positive(w), positive(h))) {
        Some((Ok(w), Ok(h))) => Ok([w, h]),
        _ => Err(format!("\"{text}\" is not a patch; give width and height in the file's unit, as 12x9")),
    }
}

/// How long a film lasts at least, before its last frame, and a frame of it, in hundredths of a second.
const LEAST_CENTISECONDS: [usize; 2] = [250, 8];

fn frame_centiseconds(frames: usize) -> u16 {
    let [film, frame] = LEAST_CENTISECONDS;
    (film / frames.max(1)).max(frame) as u16
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let (size, piece) = sizes(args)?;
    let source = args.source.read(Wanted { locked: args.frames.is_some(), overlaps: true, threads: args.threads })?;
    let kind = if args.frames.is_some() { "gif" } else { "png" };
    let out = destination(args.out.as_deref(), &source, kind)?;
    args.replace.check(&out)?;
    let contacts = source.contacts();
    if let Some(caution) = source.caution().filter(|_| !args.quiet) {
        eprintln!("note: {caution}");
    }
    let options = RenderOptions {
        caption: caption(&source).filter(|_| !args.no_caption && args.frames.is_none()),
        ..options(args, size, extent(args, &source, size, piece)?, !contacts.is_empty())
    };
    let frames = source.frames(args.frames);
    if let Some(asked) = args.frames.filter(|asked| (frames.len() as u32) < *asked && !args.quiet) {
        eprintln!("note: {asked} frames were asked; the simulation has recorded {} states", frames.len());
    }
    let unit = source.design.unit.as_deref();
    let subjects: Vec<Subject<'_>> =
        frames.iter().map(|frame| Subject { model: &source.model, state: &frame.state, contacts, unit }).collect();
    if let ([frame], false) = (&frames[..], args.quiet)
        && let Ok((shown, _)) = members(&source.model, &frame.state, options.extent)
        && let Some(overlap) = source.overlap_of(&frame.state, &shown)
    {
        eprintln!("note: {overlap}");
    }
    let begun = Instant::now();
    let pictures = draw(args, &subjects, &options)?.map_err(|e| match e {
        RenderError::NoForces => args.source.no_forces(&source),
        e => Report::new(e),
    })?;
    let bytes = match (&pictures[..], args.frames, args.palette) {
        (pictures, Some(_), _) => film(pictures, frame_centiseconds(pictures.len())).into_diagnostic()?,
        ([picture], None, true) => with_palette(&picture.to_png()?).into_diagnostic()?,
        (pictures, None, _) => pictures.first().map_or(Ok(Vec::new()), Picture::to_png)?,
    };
    output::write(&out, &bytes)?;
    if !args.quiet && !output::is_standard(&out) {
        let ([w, h], rings) = (size, pictures.first().map_or(0, |picture| picture.rings));
        let frames = args.frames.map_or(String::new(), |_| format!("{} frames, ", pictures.len()));
        output::say!(
            "{}  {frames}{w} × {h}, {}, {:.1} s",
            out.display(),
            output::counted(rings, "ring"),
            begun.elapsed().as_secs_f64()
        );
    }
    Ok(())
}

fn options(args: &Args, size: [u32; 2], extent: Extent, forces: bool) -> RenderOptions {
    RenderOptions {
        size,
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
            Some(ForcesArg::All) => Forces::AllArrows,
            None if forces && args.frames.is_none() => Forces::Arrows,
            Some(ForcesArg::None) | None => Forces::None,
        },
        cell: args.cell,
        scale_bar: !args.no_scale_bar,
        shadow: !args.no_shadow,
        ..RenderOptions::new(extent)
    }
}

/// The pictures of all frames; says how far they are.
fn draw(args: &Args, subjects: &[Subject<'_>], options: &RenderOptions) -> Result<Result<Vec<Picture>, RenderError>> {
    let pool = pool(args.threads)?;
    let progress = Spinner::new(args.quiet);
    let of_frames = |frame: usize| match subjects.len() {
        1 => String::new(),
        count => format!("frame {} of {count}, ", frame + 1),
    };
    let told = |frame: usize, part: f64| progress.says(|| format!("{}{:.0} % drawn", of_frames(frame), 100.0 * part));
    let mut pictures = Vec::with_capacity(subjects.len());
    let all = pool.install(|| render_frames(subjects, options, told, |picture| pictures.push(picture)));
    progress.finish();
    Ok(all.map(|()| pictures))
}

/// What limit a picture shows.
fn caption(source: &Source) -> Option<Caption> {
    let (state, _) = source.locked.as_ref()?;
    if let Some(roll) = &source.rolled {
        let unit = source.design.unit.as_deref().map_or(String::new(), |unit| format!(" {unit}"));
        let radius = roll.neutral_radius.map_or(String::new(), |radius| format!(", radius {radius:.4}{unit}"));
        let (name, axis) = (&source.design.name, roll.axis.name());
        let along = roll.direction_deg;
        let text = match (roll.wrap, roll.at_curvature) {
            (Some(cells), _) => format!("{name}, {cells} cells round along {along}°, {}{radius}", roll.sought.name()),
            (_, Some(_)) => format!("{name}, rolled along {along}°, axis {axis}, {}{radius}", roll.sought.name()),
            _ => format!("{name}, rolled along {along}°, axis {axis}{radius}"),
        };
        return Some(Caption { text, pull_deg: None });
    }
    let [l1, l2] = Direction::of_degrees(state.direction_deg).stretches(&state.deformation_gradient);
    let text = format!("{}, pulled along {}°, l₂ = {l2:.4}, l₁ = {l1:.4}", source.design.name, state.direction_deg);
    Some(Caption { text: text.replace("= -", "= −"), pull_deg: Some(state.direction_deg) })
}

/// The file to write, or `-`.
fn destination(out: Option<&Path>, source: &Source, kind: &str) -> Result<PathBuf> {
    let Some(out) = out else {
        return Ok(PathBuf::from("maille-out").join(format!("{}.{kind}", source.stem(kind == "gif"))));
    };
    let right = out.extension().is_some_and(|e| e.eq_ignore_ascii_case(kind));
    match right || output::is_standard(out) {
        true => Ok(out.to_owned()),
        false => Err(wrong(
            exit::USAGE,
            format!("{} is not a name for a {}", out.display(), kind.to_uppercase()),
            format!("give a name that ends in .{kind}, or - for standard output"),
        )),
    }
}
