//! Designs for wanted limits.

use crate::{
    design::Design,
    error,
    wait::{Step, wait},
};
use maille::fit::FitOptions;
use maille_io::fit::{FitRecord, FitRequest, FreeSpec, document, fitted_design, read_targets};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What is asked of a fit, as JSON: targets are the text of a CSV file that errors call `name`; options are those of the library as JSON.
#[pyfunction]
#[pyo3(signature = (design, name, targets, *, shape, free, free_each, min_gap, supercell, cell, options))]
pub fn fit_request(
    design: &Design,
    name: &str,
    targets: &str,
    shape: bool,
    free: Vec<String>,
    free_each: Vec<String>,
    min_gap: Option<f64>,
    supercell: [usize; 2],
    cell: &str,
    options: &str,
) -> PyResult<String> {
    let options: FitOptions = serde_json::from_str(options).map_err(|e| error::other(&format!("no options: {e}")))?;
    let options = FitOptions { cells: cell.parse().map_err(|e| error::invalid(&e))?, ..options };
    let targets =
        read_targets(name, targets).map_err(|e| error::argument("targets", e.to_string(), e.help_text().to_owned()))?;
    let specs = |texts: &[String]| {
        texts.iter().map(|text| text.parse()).collect::<Result<Vec<FreeSpec>, _>>().map_err(|e| error::invalid(&e))
    };
    let (free, each) = (specs(&free)?, specs(&free_each)?);
    let request = FitRequest::new(&design.design, supercell, (&free, &each), (targets, shape), min_gap, options);
    let request = request.map_err(|e| error::invalid(&e))?;
    Ok(serde_json::to_string(&request).expect("no map with odd keys"))
}

/// The fit of a request, begun with these numbers in place of the given design's: the document that `maille fit --json` prints, and the fitted
/// design.
#[pyfunction]
#[pyo3(signature = (request, *, begin, threads, progress))]
pub fn fit(
    py: Python<'_>,
    request: &str,
    begin: Option<Vec<f64>>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Design)> {
    let request: FitRequest = serde_json::from_str(request).map_err(|e| error::other(&format!("no request: {e}")))?;
    let solved = AtomicUsize::new(0);
    let found = wait(py, threads, progress, |cancel, tell| {
        let now = |now: maille::fit::FitProgress| {
            let before = solved.swap(now.designs, Ordering::Relaxed);
            tell(Step::More(now.designs.saturating_sub(before)));
            (before..now.designs).for_each(|_| tell(Step::Done));
        };
        let found = request.solve(begin.as_deref().map(|numbers| (numbers, 0)), &now, cancel)?;
        let design = fitted_design(&request, &found.numbers, cancel)?;
        Ok((FitRecord::finished(&request, &found)?, design))
    })?;
    let (record, design) = found.map_err(|e: maille::InvalidInput| error::invalid(&e))?;
    Ok((document(&record).to_string(), Design::of(design)))
}
