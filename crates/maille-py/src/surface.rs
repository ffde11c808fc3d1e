//! The surface of attainable strains.

use crate::{
    design::Design,
    error,
    map::write,
    wait::{Step, wait},
};
use maille::{
    lattice::Cell,
    survey::surface::{BoundaryOptions, BoundaryVertex, Ray, RaySolver, boundary_by as boundary_by_rays},
};
use maille_io::boundary::BoundaryHead;
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

fn options(tolerance: f64, vertices: usize, starts: usize, seed: u64) -> PyResult<BoundaryOptions> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(error::argument("tolerance", format!("{tolerance} is not positive"), "give a strain, as 0.001"));
    }
    Ok(BoundaryOptions { tolerance, most: vertices, starts, seed })
}

fn cell_of(text: &str) -> PyResult<Cell> {
    text.parse().map_err(|e| error::invalid(&e))
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
#[pyo3(signature = (design, *, tolerance, vertices, starts, cell, seed, progress, threads))]
pub fn boundary(
    py: Python<'_>,
    design: &Design,
    tolerance: f64,
    vertices: usize,
    starts: usize,
    cell: &str,
    seed: u64,
    progress: Option<Bound<'_, PyAny>>,
    threads: Option<usize>,
) -> PyResult<Surface> {
    let options = options(tolerance, vertices, starts, seed)?;
    let model = design.compile(cell_of(cell)?)?;
    let found = wait(py, threads, progress.as_ref(), |cancel, tell| {
        let mut planned = |rays| tell(Step::More(rays));
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
    fn open(
        design: &Design,
        starts: usize,
        cell: &str,
        seed: u64,
        folder: PathBuf,
        overwrite: bool,
    ) -> PyResult<(Self, Vec<String>)> {
        let options = BoundaryOptions { starts, seed, ..BoundaryOptions::default() };
        let head = BoundaryHead::new(&design.design, cell_of(cell)?, &options);
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
pub fn solve_rays(
    py: Python<'_>,
    design: &Design,
    rays: Vec<String>,
    starts: usize,
    cell: &str,
    seed: u64,
) -> PyResult<Vec<String>> {
    let options = BoundaryOptions { starts, seed, ..BoundaryOptions::default() };
    let (model, rays) = (design.compile(cell_of(cell)?)?, read::<Ray>(&rays)?);
    let ends = wait(py, Some(1), None, |cancel, _| {
        let solver = RaySolver::new(&model, &options);
        rays.iter().map_while(|ray| solver.solve(ray, cancel)).collect::<Vec<_>>()
    })?;
    Ok(ends.iter().map(write).collect())
}

/// The surface with rays solved by `solve`: it gets the rays of a pass, and whether they are new, and gives their ends. `known` are
/// vertices of an earlier run.
#[pyfunction]
pub fn boundary_by(
    design: &Design,
    tolerance: f64,
    vertices: usize,
    starts: usize,
    cell: &str,
    seed: u64,
    known: Vec<String>,
    solve: &Bound<'_, PyAny>,
) -> PyResult<Surface> {
    let options = options(tolerance, vertices, starts, seed)?;
    design.compile(cell_of(cell)?)?;
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
