//! Single questions: one strain as large or small as can be, the thickest wire, the widest gap, the closest cell.

use crate::{design::Design, error, wait::wait};
use maille::{
    question::{Goal, Question},
    search::extreme::Extreme,
    sensitivity::Sensitivity,
};
use maille_io::{
    answer::{StrainAnswer, extreme as document_of_extreme},
    sensitivity::{document, ranked},
};
use pyo3::prelude::*;

/// The answer to a question on a strain, a wire, a clearance or an area, which is given as JSON: the document that the program prints,
/// and of all but a strain the state as a design.
#[pyfunction]
#[pyo3(signature = (design, question, *, cell, threads))]
pub fn answer(
    py: Python<'_>,
    design: &Design,
    question: &str,
    cell: &str,
    threads: Option<usize>,
) -> PyResult<(String, Option<Design>)> {
    let question: Question = serde_json::from_str(question).map_err(|e| error::other(&format!("no question: {e}")))?;
    question.check().map_err(|e| error::invalid(&e))?;
    let extreme = match question.goal {
        Goal::Wire { lattice_free } => Some((Extreme::ThickestWire, lattice_free)),
        Goal::Clearance { lattice_free } => Some((Extreme::LargestClearance, lattice_free)),
        Goal::Area { min_gap } => Some((Extreme::ClosestCell { gap: min_gap / design.design.reference_radius }, true)),
        Goal::Stretch { .. }
        | Goal::Strain { .. }
        | Goal::Ray { .. }
        | Goal::Curvature { .. }
        | Goal::Rolled { .. } => None,
    };
    let sheet = design.sheet(cell.parse().map_err(|e| error::invalid(&e))?)?;
    if extreme.is_some() && sheet.model().links.is_empty() {
        let remedy = "rings that hold each other bound the wire, and nothing else does";
        return Err(error::argument("design", "no rings of this design are linked", remedy));
    }
    let found = wait(py, threads, None, |cancel, _| sheet.answer_until(&question, cancel))?;
    let found = found.map_err(|e| error::invalid(&e))?;
    let (design, model) = (&design.design, sheet.model_of(&found));
    if let Some((what, lattice_free)) = extreme {
        let state = found.value.map(|_| Design::of(what.design(&found, design, &model)));
        return Ok((document_of_extreme(design, &model, what, lattice_free, &found).to_string(), state));
    }
    match StrainAnswer::new(&design.name, &question, &model, &found) {
        Some(answer) => Ok((answer.json().to_string(), None)),
        None => Err(error::other("a strain, a wire, a clearance or an area can be asked for")),
    }
}

/// How the limit of a stretch changes with the numbers of its design: the document that `maille sensitivity` prints. `question` is
/// JSON, and `l2` what it holds across. Without `step`, lengths change by 0.1 mm, or by 1 % of the reference radius.
#[pyfunction]
#[pyo3(signature = (design, question, *, cell, step, threads))]
pub fn sensitivity(
    py: Python<'_>,
    design: &Design,
    question: &str,
    cell: &str,
    step: Option<f64>,
    threads: Option<usize>,
) -> PyResult<String> {
    let question: Question = serde_json::from_str(question).map_err(|e| error::other(&format!("no question: {e}")))?;
    question.check().map_err(|e| error::invalid(&e))?;
    let Goal::Stretch { direction_deg, l2, .. } = question.goal else {
        return Err(error::other("the limit of a stretch can be asked for"));
    };
    let sheet = design.sheet(cell.parse().map_err(|e| error::invalid(&e))?)?;
    let answer = wait(py, threads, None, |cancel, _| sheet.answer_until(&question, cancel))?;
    let answer = answer.map_err(|e| error::invalid(&e))?;
    let found = Sensitivity::of(&sheet.model_of(&answer), &question, &answer).map_err(|e| error::invalid(&e))?;
    let numbers = ranked(&design.design, &found, step);
    Ok(document(&design.design, (direction_deg, l2), &answer, &found, &numbers).to_string())
}
