//! The tightest rolls of a sheet, closed tubes, and sheets of given curvature.

use crate::{
    design::Design,
    error,
    map::{refused, write},
    wait::{Step, wait},
};
use maille::lattice::Across;
use maille_io::roll::{Axis, RollError, RollQuestion, find_rolls};
use pyo3::prelude::*;

/// The rolls that `maille roll` finds, each as JSON. Without directions they are those of the program.
#[pyfunction]
#[pyo3(signature = (design, *, directions, axis, wrap, curvature, width_free, shear_free, l2, gamma, cell, effort, seed, progress, threads))]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub fn rolls(
    py: Python<'_>,
    design: &Design,
    directions: Option<Vec<f64>>,
    axis: &str,
    wrap: Vec<u32>,
    curvature: Vec<f64>,
    width_free: bool,
    shear_free: bool,
    l2: f64,
    gamma: f64,
    cell: &str,
    effort: &str,
    seed: u64,
    progress: Option<Bound<'_, PyAny>>,
    threads: Option<usize>,
) -> PyResult<Vec<String>> {
    let axes: Vec<Axis> = Axis::BOTH.into_iter().filter(|of| axis == "both" || of.name() == axis).collect();
    if axes.is_empty() {
        return Err(error::argument("axis", format!("{axis:?} is no side of the sheet"), "give below, above or both"));
    }
    let question = RollQuestion {
        directions_deg: directions.unwrap_or_else(|| RollQuestion::usual_directions(&design.design, !wrap.is_empty())),
        axes,
        free: Across { lateral_free: width_free || !wrap.is_empty() && !design.design.lattice.single, shear_free },
        cells: cell.parse().map_err(|e| error::invalid(&e))?,
        effort: effort.parse().map_err(|e| refused(&e))?,
        seed,
        wrap,
        l2,
        gamma,
        curvatures: curvature,
    };
    let sheet = design.sheet(question.cells.clone())?;
    question.check(&sheet).map_err(|e| error::invalid(&e))?;
    let found = wait(py, threads, progress.as_ref(), |cancel, tell| {
        tell(Step::More(question.rolls().len()));
        let mut seen = Vec::new();
        let mut keep = |roll: &maille_io::roll::Roll| {
            // Those that come again went further.
            if !seen.contains(&roll.key()) {
                seen.push(roll.key());
                tell(Step::Done);
            }
            Ok(())
        };
        find_rolls(&sheet, &question, Vec::new(), cancel, &mut keep)
    })?;
    match found {
        Ok(rolls) => Ok(rolls.iter().map(write).collect()),
        Err(RollError::Asked(e)) => Err(error::invalid(&e)),
        Err(RollError::Record(e)) => Err(error::record(&e)),
    }
}
