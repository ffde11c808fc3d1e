//! Single questions: one strain as large or small as can be, the thickest wire, the widest gap.

use crate::{design::Design, error, wait::wait};
use maille::{
    answer::Answer,
    lattice::Cell,
    question::{Goal, Question, Sense, Strain},
    search::extreme::Extreme,
    sheet::Sheet,
};
use maille_io::answer::{self, StrainAnswer};
use pyo3::prelude::*;

/// Puts the question on threads of their own.
fn ask(py: Python<'_>, sheet: &Sheet, question: &Question, threads: Option<usize>) -> PyResult<Answer> {
    wait(py, threads, None, |cancel, _| sheet.answer_until(question, cancel))?.map_err(|e| error::invalid(&e))
}

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
    let sense = if sign > 0.0 { Sense::Largest } else { Sense::Least };
    let goal = Goal::Strain { component: goal, direction_deg, fix, free };
    let question = Question { starts, seed, ..Question::new(goal, sense) };
    question.check().map_err(|e| error::invalid(&e))?;
    let sheet = design.sheet(cell.parse().map_err(|e| error::invalid(&e))?)?;
    let found = ask(py, &sheet, &question, Some(1))?;
    let model = sheet.model_of(&found);
    let Some(answer) = StrainAnswer::new(&design.design.name, &question, &model, &found) else {
        unreachable!("a strain is asked for")
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
    let sheet = design.sheet(Cell::PRIMITIVE.into())?;
    let model = sheet.model();
    if model.links.is_empty() {
        let remedy = "rings that hold each other bound the wire, and nothing else does";
        return Err(error::argument("design", "no rings of this design are linked", remedy));
    }
    let (what, goal) = match thickest {
        true => (Extreme::ThickestWire, Goal::Wire { lattice_free }),
        false => (Extreme::LargestClearance, Goal::Clearance { lattice_free }),
    };
    let question = Question { starts: Some(starts), seed, ..Question::new(goal, Sense::Largest) };
    let found = ask(py, &sheet, &question, threads)?;
    let document = answer::extreme(&design.design, model, what, lattice_free, &found);
    let state = found.value.map(|_| Design::of(what.design(&found, &design.design, model)));
    Ok((document.to_string(), state))
}
