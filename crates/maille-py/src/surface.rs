//! The surface of attainable strains.

use crate::{
    design::Design,
    error,
    wait::{Step, wait},
};
use maille::limit::boundary::BoundaryOptions;
use pyo3::prelude::*;

/// Vertices as JSON documents, corners of the triangles, the largest expected distance from them.
type Surface = (Vec<String>, Vec<[usize; 3]>, f64);

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
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(error::argument("tolerance", format!("{tolerance} is not positive"), "give a strain, as 0.001"));
    }
    let model = design.compile(cell.parse().map_err(|e| error::invalid(&e))?)?;
    let options = BoundaryOptions { tolerance, most: vertices, starts: starts.max(1), seed };
    let surface = wait(py, threads, progress.as_ref(), |cancel, tell| {
        let mut planned = |rays| tell(Step::More(rays));
        let found = |_: &_| tell(Step::Done);
        maille::limit::boundary::boundary(&model, &options, &[], cancel, &mut planned, &found)
    })?;
    let json = |vertex| serde_json::to_string(vertex).expect("a vertex has no map with odd keys");
    Ok((surface.vertices.iter().map(json).collect(), surface.triangles, surface.arch))
}
