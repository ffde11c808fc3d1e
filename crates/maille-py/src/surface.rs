//! The surface of attainable strains.

use crate::{
    design::Design,
    error,
    map::{refused, write},
    wait::{Step, wait},
};
use maille::{
    survey::CellChoice,
    survey::surface::{
        BoundaryOptions, BoundaryVertex, Pass, Ray, RaySolver, boundary_by as boundary_by_rays, has_surface,
    },
};
use maille_io::boundary::surface_head;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use std::{
    cell::RefCell,
    path::PathBuf,
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    },
};

/// Vertices as JSON documents, corners of the triangles, the largest expected distance from them.
type Surface = (Vec<String>, Vec<[usize; 3]>, f64);

/// Options of a surface, as JSON.
#[pyfunction]
#[pyo3(signature = (*, tolerance, vertices, effort, starts, cell, seed))]
pub fn boundary_options(
    tolerance: f64,
    vertices: usize,
    effort: &str,
    starts: Option<usize>,
    cell: &str,
    seed: u64,
) -> PyResult<String> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(error::argument("tolerance", format!("{tolerance} is not positive"), "give a strain, as 0.001"));
    }
    let effort = effort.parse().map_err(|e| refused(&e))?;
    let cells = cell.parse::<CellChoice>().map_err(|e| error::invalid(&e))?;
    Ok(write(&BoundaryOptions { tolerance, most: vertices, effort, starts, seed, cells }))
}

fn options(text: &str) -> PyResult<BoundaryOptions> {
    serde_json::from_str(text).map_err(|e| error::other(&format!("no options of a surface: {e}")))
}

fn read<T: DeserializeOwned>(texts: &[String]) -> PyResult<Vec<T>> {
    let read = |text: &String| serde_json::from_str(text).map_err(|e| error::other(&format!("no ray: {e}")));
    texts.iter().map(read).collect()
}

fn surface(found: maille::survey::surface::Boundary) -> Surface {
    (found.vertices.iter().map(write).collect(), found.triangles, found.arch)
}

/// The surface, as `maille boundary` finds it.
#[pyfunction]
#[pyo3(signature = (design, search, *, progress, threads))]
pub fn boundary(
    py: Python<'_>,
    design: &Design,
    search: &str,
    progress: Option<Bound<'_, PyAny>>,
    threads: Option<usize>,
) -> PyResult<Surface> {
    let options = options(search)?;
    let model = design.compile(options.cell())?;
    has_surface(&model).map_err(|e| error::invalid(&e))?;
    let found = wait(py, threads, progress.as_ref(), |cancel, tell| {
        let mut planned = |pass| {
            if let Pass::New(rays) = pass {
                tell(Step::More(rays));
            }
        };
        let found = |_: &_| tell(Step::Done);
        maille::survey::surface::boundary(&model, &options, &[], cancel, &mut planned, &found)
    })?;
    Ok(surface(found))
}

/// The folder of a surface with its journal, which no other run writes to until it is closed.
#[pyclass(frozen, module = "maille._native")]
pub struct SurfaceFolder {
    open: Mutex<Option<maille_io::boundary::SurfaceFolder>>,
}

#[pymethods]
impl SurfaceFolder {
    /// Opens the folder of `maille boundary`; with the rays of an earlier run as JSON.
    #[staticmethod]
    fn open(design: &Design, search: &str, folder: PathBuf, overwrite: bool) -> PyResult<(Self, Vec<String>)> {
        let head = surface_head(&design.design, &options(search)?);
        let opened = maille_io::boundary::SurfaceFolder::open(&folder, &head, overwrite);
        let (open, known) = opened.map_err(|e| error::record(&e))?;
        Ok((Self { open: Mutex::new(Some(open)) }, known.iter().map(write).collect()))
    }

    /// Keeps the ends of rays, each as JSON.
    fn keep(&self, vertices: Vec<String>) -> PyResult<()> {
        let vertices = read::<BoundaryVertex>(&vertices)?;
        let mut open = self.open.lock().unwrap_or_else(|e| e.into_inner());
        let open = open.as_mut().ok_or_else(|| error::other("the folder is closed"))?;
        open.keep(&vertices).map_err(|e| error::record(&e))
    }

    /// Gives the folder back.
    fn close(&self) {
        self.open.lock().unwrap_or_else(|e| e.into_inner()).take();
    }
}

/// Ends of rays, on this thread: JSON in and out.
#[pyfunction]
pub fn solve_rays(py: Python<'_>, design: &Design, rays: Vec<String>, search: &str) -> PyResult<Vec<String>> {
    let options = options(search)?;
    let (model, rays) = (design.compile(options.cell())?, read::<Ray>(&rays)?);
    let ends = wait(py, Some(1), None, |cancel, _| {
        let solver = RaySolver::new(&model, &options);
        rays.iter().map_while(|ray| solver.solve(ray, cancel)).collect::<Vec<_>>()
    })?;
    Ok(ends.iter().map(write).collect())
}

/// The surface with rays solved by `solve`: it gets the rays of a pass, and whether they are new, and gives their ends. `known` are
/// vertices of an earlier run.
#[pyfunction]
pub fn boundary_by(design: &Design, search: &str, known: Vec<String>, solve: &Bound<'_, PyAny>) -> PyResult<Surface> {
    let options = options(search)?;
    has_surface(&design.compile(options.cell())?).map_err(|e| error::invalid(&e))?;
    let known = read::<BoundaryVertex>(&known)?;
    let (cancel, failure) = (AtomicBool::new(false), RefCell::new(None));
    let mut by_solve = |rays: &[Ray], new: bool| {
        if rays.is_empty() || cancel.load(Ordering::Relaxed) {
            return vec![None; rays.len()];
        }
        let texts: Vec<String> = rays.iter().map(write).collect();
        let ends = solve.call1((texts, new)).and_then(|ends| read::<BoundaryVertex>(&ends.extract::<Vec<String>>()?));
        match ends {
            Ok(ends) => ends.into_iter().map(Some).collect(),
            Err(error) => {
                failure.borrow_mut().get_or_insert(error);
                cancel.store(true, Ordering::Relaxed);
                vec![None; rays.len()]
            }
        }
    };
    let found = boundary_by_rays(&options, &known, &cancel, &mut |_| (), &mut by_solve);
    match failure.into_inner() {
        Some(error) => Err(error),
        None => Ok(surface(found)),
    }
}
