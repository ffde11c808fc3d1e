//! `maille boundary`: the surface of all in-plane strains of a sheet, as a table, meshes and a figure.

use crate::{
    effort::SearchArgs,
    exit::{self, refused},
    input::{DesignArgs, Input, file_name},
    interrupt,
    map::{RunArgs, pool},
    numbers::{positive, read},
    output::{self, counted, say},
    progress::Progress,
};
use maille::{
    design::Design,
    record::Status,
    survey::{
        CellChoice,
        surface::{Boundary, BoundaryOptions, BoundaryVertex, Pass, boundary, has_surface},
    },
};
use maille_io::{
    boundary::{
        SURFACE, SURFACE_STATES, SurfaceFolder, SurfaceRecord, boundary_csv, boundary_obj, boundary_ply, surface_head,
        surface_states,
    },
    plot::{Layout, boundary_svg},
};
use maille_svg::svg_to_png;
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use std::{
    collections::{BTreeMap, btree_map::Entry},
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{Mutex, atomic::Ordering},
    time::Instant,
};

/// The closed surface of all in-plane strains that a sheet can have
///
/// Rays from the written lattice in the space of Green strains (E_xx, E_yy, E_xy, the tensor shear), each to the farthest
/// certified state, with the proven outer bound; more rays where the surface bends. The first 162 rays are searched as --effort says; later ones
/// begin with their neighbours' states, and draw starts only until two lead to the best. Writes a folder with boundary.csv (one row
/// for each vertex: where the straight way is first stopped, and the farthest state), boundary.obj and boundary.ply (the mesh),
/// boundary.svg and boundary.png (three sections and a view), boundary.jsonl (from which an interrupted run continues),
/// surface.json and surface.jsonl (what it is of, and every state). `maille table`, `maille plot` and `maille verify` read the
/// folder. The same command continues it; with another --tolerance or more --vertices it keeps the rays that are there.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille boundary european-4-in-1
  maille boundary european-4-in-1 --tolerance 3e-4 --vertices 20000   finer, from the rays that are there
  maille boundary 1.1 --tolerance 0.005 --vertices 500 --out results/surface-1.1
  maille boundary european-4-in-1 --cell auto --out folded   with folds in larger cells, takes a minute
  maille plot european-4-in-1-boundary --style paper -o fig.pdf   its figure, for print
  maille verify european-4-in-1-boundary   its states derived anew

Exit codes: 0 every ray has a certified end, 5 some have none (0 with --allow-incomplete), 130 interrupted.")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Rays are added until the surface is expected within this strain of its triangles
    #[arg(long, default_value_t = BoundaryOptions::default().tolerance, value_parser = positive)]
    tolerance: f64,
    /// Vertices at most
    #[arg(long, default_value_t = BoundaryOptions::default().most as u32, value_parser = clap::value_parser!(u32).range(162..=100_000))]
    vertices: u32,
    /// Cell: 1x1, 2x1, …, an integer matrix as "1,0;-1,2", or auto: the larger cells to which
    /// unstable waves through the sheet lead, which can take a hundred times as long
    #[arg(long, default_value = "1x1", value_parser = read::<CellChoice>)]
    cell: CellChoice,
    #[command(flatten)]
    search: SearchArgs,
    /// Folder that is written [default: maille-out/NAME-boundary]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    run: RunArgs,
    /// No progress and no summary
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let input = args.design.read()?;
    let options = BoundaryOptions {
        tolerance: args.tolerance,
        most: args.vertices as usize,
        effort: args.search.effort,
        starts: args.search.starts(),
        seed: args.search.seed,
        cells: args.cell.clone(),
    };
    let model = input.compile(&input.design, options.cell())?;
    has_surface(&model).map_err(|e| refused(&e))?;
    let usual = || PathBuf::from("maille-out").join(format!("{}-boundary", file_name(&input.design.name)));
    let out = args.out.clone().unwrap_or_else(usual);
    let head = surface_head(&input.design, &options);
    output::folder(&out, "the surface is a folder")?;
    let (folder, known) = SurfaceFolder::open(&out, &head, args.run.overwrite)?;
    // Until all files are of this run, there is no surface to read.
    match fs::remove_file(out.join(SURFACE)) {
        Err(e) if e.kind() != ErrorKind::NotFound => {
            return Err(Report::msg(e).wrap_err(format!("cannot replace {}", out.join(SURFACE).display())));
        }
        _ => {}
    }
    if !known.is_empty() && !args.quiet {
        eprintln!("{} already in {}", counted(known.len(), "ray"), out.display());
    }
    let cancel = interrupt::flag(args.quiet)?;
    let begun = Instant::now();
    let progress = Progress::growing("rays", known.len(), args.quiet);
    let kept = Mutex::new((folder, None, 0));
    let found = |vertex: &BoundaryVertex| {
        let mut kept = kept.lock().unwrap_or_else(|e| e.into_inner());
        kept.2 += 1;
        if kept.1.is_none()
            && let Err(error) = kept.0.keep(std::slice::from_ref(vertex))
        {
            kept.1 = Some(error);
            cancel.store(true, Ordering::Relaxed);
        }
        progress.step();
    };
    let pool = pool(args.run.threads)?;
    let mut planned = |pass: Pass| match pass {
        Pass::New(rays) => {
            progress.more(rays);
            progress.only(None);
        }
        Pass::Again(rays) => {
            progress.only(Some(format!("{} once more, from the states of neighbours", counted(rays, "ray"))));
        }
    };
    let surface = pool.install(|| boundary(&model, &options, &known, &cancel, &mut planned, &found));
    progress.finish();
    // The folder is this run's alone until all is written.
    let (_folder, failure, now) = kept.into_inner().unwrap_or_else(|e| e.into_inner());
    if let Some(error) = failure {
        return Err(error.into());
    }
    let record = write(&out, &input, &surface, &options)?;
    if !args.quiet {
        summary(&out, &record, &surface, &options, now, begun.elapsed().as_secs_f64());
    }
    let certified = |v: &BoundaryVertex| matches!(v.status, Status::Global | Status::Local);
    let incomplete = !surface.vertices.iter().all(certified);
    Ok(exit::ended(!surface.complete, args.run.code(incomplete), args.quiet))
}

/// Writes the files; gives what the surface is of.
fn write(out: &Path, input: &Input, surface: &Boundary, options: &BoundaryOptions) -> Result<SurfaceRecord> {
    let title = surface_title(&input.design);
    let table = boundary_csv(surface);
    let states = surface_states(surface);
    let mut cells: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for vertex in &surface.vertices {
        if let Entry::Vacant(entry) = cells.entry(vertex.cell.to_string()) {
            let model = input.compile(&input.design, vertex.cell)?;
            entry.insert(model.elements.iter().map(|element| element.name.clone()).collect());
        }
    }
    let (obj, ply) = (boundary_obj(surface, &title), boundary_ply(surface, &title));
    let files = [("boundary.csv", &table), (SURFACE_STATES, &states), ("boundary.obj", &obj), ("boundary.ply", &ply)];
    let files = files.map(|(name, text)| (name, text.as_bytes()));
    let record = SurfaceRecord::new(&input.design, options, surface, cells, &files);
    let svg = surface_svg(&record, surface, Layout::Beside);
    let png = svg_to_png(&svg, 2.0).into_diagnostic().wrap_err("cannot draw the figure")?;
    let head = serde_json::to_string(&record).into_diagnostic().wrap_err("cannot write JSON")?;
    files.iter().try_for_each(|(name, bytes)| output::write(&out.join(name), bytes))?;
    output::write(&out.join("boundary.svg"), svg.as_bytes())?;
    output::write(&out.join("boundary.png"), &png)?;
    output::write(&out.join(SURFACE), format!("{head}\n").as_bytes())?;
    Ok(record)
}

fn surface_title(design: &Design) -> String {
    format!("Attainable strains of {}", design.name)
}

/// The figure of a surface; also of `maille plot`.
pub fn surface_svg(record: &SurfaceRecord, surface: &Boundary, layout: Layout) -> String {
    let caption = format!(
        "{} rays, {} triangles; {}. Beyond its bound no state of any cell lies on a ray.",
        surface.vertices.len(),
        surface.triangles.len(),
        record.accuracy(),
    );
    boundary_svg(surface, &surface_title(&record.design), vec![caption], layout)
}

fn summary(out: &Path, record: &SurfaceRecord, surface: &Boundary, options: &BoundaryOptions, now: usize, wall_s: f64) {
    let vertices = &surface.vertices;
    let [rays, triangles] =
        [(vertices.len(), "ray"), (surface.triangles.len(), "triangle")].map(|(n, what)| counted(n, what));
    say!("{}: {rays}, {triangles}", record.design.name);
    for (k, name) in ["exx", "eyy", "exy"].into_iter().enumerate() {
        let ends = vertices.iter().filter_map(|v| Some(v.point(v.distance?)[k]));
        let (least, most) = ends.fold((0.0f64, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
        say!("  {name}  {least:>12.6} to {most:.6}");
    }
    for status in Status::ALL {
        let count = vertices.iter().filter(|v| v.status == status).count();
        if count > 0 {
            say!("  {count} {}", status.name().replace("l2-", ""));
        }
    }
    let unstable = vertices.iter().filter(|v| v.wave_curvature.is_some_and(|least| least < 0.0)).count();
    if unstable > 0 && options.cells != CellChoice::Auto {
        say!("  {unstable} rays end where a wave through the sheet is unstable: --cell auto continues in larger cells");
    }
    say!("  {}", record.accuracy());
    if surface.complete && surface.open > 0 {
        say!("  the same command with more --vertices continues from here");
    }
    let holes = vertices.iter().filter(|v| v.distance.is_none()).count();
    if holes > 0 {
        say!("  not reached: {}, holes in the mesh", counted(holes, "ray"));
    }
    say!("{} in {wall_s:.1} s; look at {}", counted(now, "ray"), out.join("boundary.png").display());
}
