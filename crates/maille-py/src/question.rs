//! Single questions: one strain as large or small as can be, the thickest wire, the widest gap.

use crate::{design::Design, error, map::cell_choice, wait::wait};
use maille::{
    characterize::{Method, strain::StrainQuestion},
    lattice::Cell,
    limit::{
        exact::ExactOptions,
        extreme::{Extreme, ExtremeOptions},
        strain::Strain,
    },
    model::Model,
};
use maille_io::answer::{self, StrainAnswer};
use pyo3::prelude::*;

fn strain(argument: &str, name: &str) -> PyResult<Strain> {
    let known = Strain::ALL.into_iter().find(|strain| strain.name() == name);
    known.ok_or_else(|| error::argument(argument, format!("\"{name}\" is no strain"), "give exx, eyy or exy"))
}

/// The largest (`sign` 1) or least (−1) value of a strain, as `maille limit` finds it; a JSON document.
#[pyfunction]
#[pyo3(signature = (design, goal, sign, *, fix, free, direction_deg, cell, starts, seed))]
pub fn limit(
    py: Python<'_>,
    design: &Design,
    goal: &str,
    sign: f64,
    fix: Vec<(String, f64)>,
    free: Vec<String>,
    direction_deg: f64,
    cell: &str,
    starts: Option<usize>,
    seed: u64,
) -> PyResult<String> {
    let goal = strain(if sign > 0.0 { "maximize" } else { "minimize" }, goal)?;
    let fix: Vec<_> = fix.iter().map(|(name, x)| Ok((strain("fix", name)?, *x))).collect::<PyResult<_>>()?;
    let free: Vec<_> = free.iter().map(|name| strain("free", name)).collect::<PyResult<_>>()?;
    let question = StrainQuestion { goal, sign, fix, free, direction_deg, starts: starts.map(|n| n.max(1)), seed };
    question.query().map_err(|e| error::invalid(&e))?;
    let exact = Method::Exact(ExactOptions::default());
    let cells = cell_choice(cell)?.cells(&exact, design.design.elements.len());
    let models: Vec<Model> = cells.iter().map(|cell| design.compile(*cell)).collect::<PyResult<_>>()?;
    let found = wait(py, Some(1), None, |cancel, _| question.answer(&models, cancel))?;
    let found = found.map_err(|e| error::invalid(&e))?;
    let answer = StrainAnswer {
        design: &design.design.name,
        goal,
        sign,
        free: &question.free,
        direction_deg,
        cells: &cells,
        model: &models[found.cell],
        found: &found,
    };
    Ok(answer.json().to_string())
}

/// The thickest wire or the widest gap, as `maille tightest` and `maille roomiest` find them: a JSON document, and the state
/// as a design.
#[pyfunction]
#[pyo3(signature = (design, *, thickest, lattice_free, starts, seed, threads))]
pub fn extreme(
    py: Python<'_>,
    design: &Design,
    thickest: bool,
    lattice_free: bool,
    starts: usize,
    seed: u64,
    threads: Option<usize>,
) -> PyResult<(String, Option<Design>)> {
    let model = design.compile(Cell::PRIMITIVE)?;
    if model.links.is_empty() {
        let remedy = "rings that hold each other bound the wire, and nothing else does";
        return Err(error::argument("design", "no rings of this design are linked", remedy));
    }
    let what = if thickest { Extreme::ThickestWire } else { Extreme::WidestGap };
    let options = ExtremeOptions { lattice_free, starts: starts.max(1), seed };
    let found = wait(py, threads, None, |cancel, _| maille::limit::extreme::extreme(&model, what, &options, cancel))?;
    let document = answer::extreme(&design.design, &model, lattice_free, &found);
    let state = found.value.map(|_| Design::of(found.design(&design.design, &model)));
    Ok((document.to_string(), state))
}
