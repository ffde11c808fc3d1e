//! Errors of the crates as the classes of `maille.errors`, with their fields.

use maille::error::InvalidInput;
use maille_io::{DesignError, TextError, record::RecordError, run::MapError};
use pyo3::{
    prelude::*,
    types::{PyDict, PyList},
};

/// An exception of the class `name`, made with these keyword arguments.
fn exception(name: &str, fields: impl FnOnce(Python<'_>, &Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    Python::attach(|py| {
        let make = || -> PyResult<PyErr> {
            let keywords = PyDict::new(py);
            fields(py, &keywords)?;
            let class = py.import("maille.errors")?.getattr(name)?;
            Ok(PyErr::from_value(class.call((), Some(&keywords))?))
        };
        make().unwrap_or_else(|error| error)
    })
}

/// A value of an argument that cannot be.
pub fn argument(name: &str, problem: impl Into<String>, remedy: impl Into<String>) -> PyErr {
    let (problem, remedy) = (problem.into(), remedy.into());
    exception("ArgumentError", |_, to| {
        to.set_item("argument", name)?;
        to.set_item("problem", problem)?;
        to.set_item("remedy", remedy)
    })
}

/// The same of one place in an array, with the value there.
pub fn element(name: &str, index: usize, value: &[f64], problem: &str, remedy: &str) -> PyErr {
    exception("ArgumentError", |py, to| {
        to.set_item("argument", name)?;
        to.set_item("index", index)?;
        match value {
            [one] => to.set_item("value", *one)?,
            _ => to.set_item("value", pyo3::types::PyTuple::new(py, value)?)?,
        }
        to.set_item("problem", problem)?;
        to.set_item("remedy", remedy)
    })
}

/// A wrong option of the crates.
pub fn invalid(input: &InvalidInput) -> PyErr {
    argument(&input.field, input.problem.clone(), input.help.clone())
}

/// One line of the list of a design's problems.
struct Problem<'a> {
    field: &'a str,
    problem: String,
    remedy: &'a str,
    place: Option<(usize, usize)>,
}

fn design_error(file: Option<&str>, problems: &[Problem<'_>]) -> PyErr {
    exception("DesignError", |py, to| {
        let list = PyList::empty(py);
        for Problem { field, problem, remedy, place } in problems {
            let one = PyDict::new(py);
            one.set_item("field", field)?;
            one.set_item("problem", problem)?;
            one.set_item("remedy", remedy)?;
            one.set_item("line", place.map(|place| place.0))?;
            one.set_item("column", place.map(|place| place.1))?;
            list.append(one)?;
        }
        to.set_item("file", file)?;
        to.set_item("problems", list)
    })
}

/// What is wrong with a design file; `file` is its name.
pub fn design_file(file: &str, error: &DesignError) -> PyErr {
    let texts: Vec<String> = error.problems().iter().map(ToString::to_string).collect();
    let problem = |(p, text): (&'_ maille_io::DesignProblem, &String)| {
        text.strip_prefix(&format!("{}: ", p.field())).unwrap_or(text).to_owned()
    };
    let problems: Vec<Problem<'_>> = error
        .problems()
        .iter()
        .zip(&texts)
        .map(|(p, text)| Problem {
            field: p.field(),
            problem: problem((p, text)),
            remedy: p.help_text(),
            place: error.line_column(p),
        })
        .collect();
    design_error(Some(file), &problems)
}

/// What is wrong with a design that is no file.
pub fn design(problems: &[InvalidInput]) -> PyErr {
    let mut list = Vec::new();
    for InvalidInput { field, problem, help } in problems {
        list.push(Problem { field, problem: problem.clone(), remedy: help, place: None });
    }
    design_error(None, &list)
}

/// What is wrong with a study; `file` is its name.
pub fn study(file: &str, error: &TextError) -> PyErr {
    exception("StudyError", |_, to| {
        let (line, column) = error.line_column();
        to.set_item("problem", error.to_string())?;
        to.set_item("remedy", error.help_text())?;
        to.set_item("file", file)?;
        to.set_item("line", line)?;
        to.set_item("column", column)
    })
}

/// What is wrong with a record.
pub fn record(error: &RecordError) -> PyErr {
    let name = match error {
        RecordError::Io { .. } => "RecordIOError",
        RecordError::Malformed { .. } => "MalformedRecordError",
        RecordError::Edited { .. } => "EditedRecordError",
        RecordError::OtherInputs { .. } => "OtherInputsError",
        RecordError::NotARecord { .. } => "NotARecordError",
        RecordError::InUse { .. } => "RecordInUseError",
        RecordError::NotFinite { .. } => "NotFiniteError",
    };
    exception(name, |_, to| {
        to.set_item("problem", error.to_string())?;
        match error {
            RecordError::Io { action, path, source } => {
                to.set_item("problem", format!("{error}: {source}"))?;
                to.set_item("action", action)?;
                to.set_item("path", path)
            }
            RecordError::Malformed { file, line, .. } => {
                to.set_item("file", file)?;
                to.set_item("line", line)
            }
            RecordError::Edited { file, found, expected, .. } => {
                to.set_item("file", file)?;
                to.set_item("found", found)?;
                to.set_item("expected", expected)
            }
            RecordError::OtherInputs { folder, difference } => {
                to.set_item("folder", folder)?;
                to.set_item("difference", difference)
            }
            RecordError::NotARecord { folder, found } => {
                to.set_item("folder", folder)?;
                to.set_item("found", found)
            }
            RecordError::InUse { folder } => to.set_item("folder", folder),
            RecordError::NotFinite { direction_deg, l2, field, value } => {
                to.set_item("direction_deg", direction_deg)?;
                to.set_item("l2", l2)?;
                to.set_item("field", field)?;
                to.set_item("value", value)
            }
        }
    })
}

/// A map that could not be kept.
pub fn map(error: &MapError) -> PyErr {
    match error {
        MapError::Record(error) => record(error),
        MapError::Plot(error) => other(&format!("the plot cannot be drawn: {error}")),
    }
}

/// Anything else: maille is at fault.
pub fn other(problem: &str) -> PyErr {
    exception("MailleError", |_, to| to.set_item("problem", problem))
}
