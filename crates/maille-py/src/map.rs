//! `characterize`, and records.

use crate::{
    design::Design,
    error,
    wait::{Step, wait},
};
use maille::{
    error::InvalidInput,
    lattice::Across,
    question::Effort,
    record::{Entry, Kind, LIMIT_COLUMNS},
    relaxation::limit::EnergyOptions,
    search::ExactOptions,
    survey::{MapQuestion, Method},
};
use maille_io::{
    Quantity,
    numbers::{distinct, parse},
    record::{NamedRecord, SensitivityRow, read_limits, read_run, read_states, write_limits, write_run, write_states},
    run::{Map, save_record, sensitivities},
    table::{Field, Table},
};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict, PyList},
};
use serde_json::Value;
use std::path::PathBuf;

/// Numbers in a list or a range, as on the command line, or in a sequence; each once. `name` is that of the argument.
#[pyfunction]
#[pyo3(signature = (name, text=None, values=None))]
pub fn numbers(name: &str, text: Option<&str>, values: Option<Vec<f64>>) -> PyResult<Vec<f64>> {
    let wrong = |problem: String| error::argument(name, problem, "give numbers, or a range as \"0:180:15\"");
    let list = match (text, values) {
        (Some(text), _) => parse(text).map_err(wrong)?,
        (None, values) => distinct(values.unwrap_or_default()),
    };
    if list.0.is_empty() {
        return Err(wrong("there is none".into()));
    }
    if let Some(k) = list.0.iter().position(|x| !x.is_finite()) {
        return Err(error::element(name, k, &[list.0[k]], "is not finite", "give finite numbers"));
    }
    Ok(list.0)
}

fn quantity(name: &str) -> PyResult<Quantity> {
    match name {
        "stretch" => Ok(Quantity::Stretch),
        "l1" => Ok(Quantity::L1),
        "lambda1" => Ok(Quantity::Lambda1),
        _ => Err(error::argument("quantity", format!("\"{name}\" is none"), "give stretch, l1 or lambda1")),
    }
}

/// The options of the energy method: those that are named, as JSON, and the usual ones.
fn energy_options(named: &str, seed: u64) -> PyResult<EnergyOptions> {
    let usual = EnergyOptions { seed, ..EnergyOptions::default() };
    let wrong = |problem: String, known: &Value| {
        let known: Vec<&String> = known.as_object().into_iter().flat_map(|o| o.keys()).collect();
        error::argument("energy", problem, format!("options are {known:?}"))
    };
    let mut all = serde_json::to_value(&usual).expect("options have no map with odd keys");
    let named: Value = serde_json::from_str(named).map_err(|e| wrong(e.to_string(), &all))?;
    for (key, value) in named.as_object().into_iter().flatten() {
        if all.get(key).is_none() || key == "seed" {
            return Err(wrong(format!("there is no option \"{key}\""), &all));
        }
        all[key] = value.clone();
    }
    serde_json::from_value(all.clone()).map_err(|e| wrong(e.to_string(), &all))
}

/// A question that was refused, with the names of arguments.
pub fn refused(wrong: &InvalidInput) -> PyErr {
    let plain = |text: &str| text.replace('`', "");
    let field = match wrong.field.as_str() {
        "direction_deg" | "directions_deg" => "directions",
        field @ ("extremes" | "method" | "l2" | "effort" | "starts" | "cell") => field,
        _ => "energy",
    };
    error::argument(field, plain(&wrong.problem), plain(&wrong.help))
}

/// An effort as it is written in questions.
#[pyfunction]
pub fn effort(text: &str) -> PyResult<String> {
    text.parse::<Effort>().map(|effort| effort.to_string()).map_err(|e| refused(&e))
}

/// What a map asks, as JSON. `energy` has options of the energy method, as JSON.
#[pyfunction]
#[pyo3(signature = (*, directions, l2, lateral_free, shear_free, compression, extremes, method, cell, effort, starts, seed, energy))]
pub fn map_question(
    directions: Option<Vec<f64>>,
    l2: Option<Vec<f64>>,
    lateral_free: bool,
    shear_free: bool,
    compression: bool,
    extremes: Option<bool>,
    method: &str,
    cell: &str,
    effort: &str,
    starts: Option<usize>,
    seed: u64,
    energy: &str,
) -> PyResult<String> {
    let across = Across { lateral_free, shear_free };
    let method = match method {
        "exact" => {
            effort.parse().map(|effort| Method::Exact(ExactOptions { effort, starts, seed, across, compression }))
        }
        "energy" => Method::energy(energy_options(energy, seed)?, across, compression),
        other => return Err(error::argument("method", format!("\"{other}\" is none"), "give exact or energy")),
    };
    let question = method.and_then(|method| MapQuestion::new(method, cell.parse()?, directions, l2, extremes));
    Ok(write(&question.map_err(|e| refused(&e))?))
}

/// The map of a design, open; `question` is what [`map_question`] gives.
pub fn open(
    design: &Design,
    question: &str,
    quantity_name: &str,
    out: Option<PathBuf>,
    overwrite: bool,
    sensitivities: bool,
) -> PyResult<maille_io::run::OpenMap> {
    let question = serde_json::from_str(question).map_err(|e| error::other(&format!("no question: {e}")))?;
    let map = Map { question, quantity: quantity(quantity_name)?, out, overwrite, sensitivities };
    let models =
        map.cells(&design.design).into_iter().map(|cell| design.compile(cell)).collect::<PyResult<Vec<_>>>()?;
    map.question.suits(&models[0]).map_err(|e| error::invalid(&e))?;
    map.open(&design.design, models).map_err(|e| error::record(&e))
}

/// As JSON.
pub fn write(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("what maille writes has no map with odd keys")
}

/// Finds the limits of a map, as `maille characterize` does.
#[pyfunction]
#[pyo3(signature = (design, question, quantity_name, *, out, overwrite, sensitivities, progress, threads))]
pub fn characterize(
    py: Python<'_>,
    design: &Design,
    question: &str,
    quantity_name: &str,
    out: Option<PathBuf>,
    overwrite: bool,
    sensitivities: bool,
    progress: Option<Bound<'_, PyAny>>,
    threads: Option<usize>,
) -> PyResult<Record> {
    let open = open(design, question, quantity_name, out, overwrite, sensitivities)?;
    let run = wait(py, threads, progress.as_ref(), |cancel, tell| {
        tell(Step::More(open.left()));
        open.run(cancel, &|_, _| (), &|_, _| tell(Step::Done))
    })?;
    let record = run.map_err(|e| error::map(&e))?;
    Ok(Record { name: design.design.name.clone(), record })
}

/// A line of `sensitivities.csv`.
type Slopes = (f64, f64, String, Option<f64>, Option<f64>);

/// The record of a map.
#[pyclass(frozen, module = "maille._native")]
pub struct Record {
    pub name: String,
    pub record: maille_io::record::Record,
}

#[pymethods]
impl Record {
    /// Columns of `limits.csv`: (name, type, unit, meaning, values).
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let (out, rows) = (PyList::empty(py), &self.record.rows);
        let length = self.record.run.design.unit.as_deref();
        for column in &LIMIT_COLUMNS {
            let one = PyDict::new(py);
            one.set_item("name", column.name)?;
            one.set_item("type", column.kind.name())?;
            one.set_item("unit", column.unit.name(length))?;
            one.set_item("meaning", column.meaning)?;
            let cells = rows.iter().map(column.get);
            match column.kind {
                Kind::Text => one.set_item("values", cells.map(Entry::text).collect::<Vec<_>>())?,
                Kind::Number => one.set_item("values", cells.map(Entry::number).collect::<Vec<_>>())?,
                Kind::Count => one.set_item("values", cells.map(Entry::count).collect::<Vec<_>>())?,
                Kind::Flag => one.set_item("values", cells.map(Entry::flag).collect::<Vec<_>>())?,
            }
            out.append(one)?;
        }
        Ok(out)
    }

    /// The table as Parquet, as `maille table` writes it; with `states`, each row with the line of its state.
    fn parquet<'py>(&self, py: Python<'py>, states: bool) -> PyResult<Bound<'py, PyBytes>> {
        let named = [NamedRecord { name: self.name.clone(), record: self.record.clone(), sensitivities: Vec::new() }];
        // With states it is a file of a dataset, all of whose files have the same columns.
        let fields = Field::all(if states { &[] } else { &named }, false);
        let (table, mut out) = (Table::new(&named, fields), Vec::new());
        let done = match states {
            true => table.parquet_with_states(&self.record.states, &mut out),
            false => table.parquet(&mut out),
        };
        done.map_err(|e| error::other(&e.to_string()))?;
        Ok(PyBytes::new(py, &out))
    }

    /// Rows with their states, both as JSON.
    fn limits(&self) -> Vec<(String, String)> {
        self.record.rows.iter().map(write).zip(self.states()).collect()
    }

    /// The states, each a JSON document as in `states.jsonl`.
    fn states(&self) -> Vec<String> {
        self.record.states.iter().map(write).collect()
    }

    /// `run.json`.
    fn run(&self) -> String {
        write_run(&self.record.run)
    }

    /// What [`Record::of_texts`] makes it of again: its name, `run.json`, `limits.csv` and `states.jsonl`.
    fn texts(&self) -> PyResult<(String, String, String, String)> {
        let limits = write_limits(&self.record.rows).map_err(|e| error::record(&e))?;
        let states = write_states(&self.record.states).map_err(|e| error::record(&e))?;
        Ok((self.name.clone(), self.run(), limits, states))
    }

    /// A record that travelled as texts.
    #[staticmethod]
    fn of_texts(name: String, run: &str, limits: &str, states: &str) -> PyResult<Self> {
        let run = read_run("run.json", run).map_err(|e| error::record(&e))?;
        let rows = read_limits("limits.csv", limits).map_err(|e| error::record(&e))?;
        let states = read_states("states.jsonl", states).map_err(|e| error::record(&e))?;
        Ok(Self { name, record: maille_io::record::Record { run, rows, states } })
    }

    /// The design that was computed.
    fn design(&self) -> Design {
        Design::of(self.record.run.design.clone())
    }

    /// The derivatives of the limits, from their states and forces: direction, l2, number, derivative forward and back.
    fn sensitivities(&self, py: Python<'_>) -> PyResult<Vec<Slopes>> {
        let found = py.detach(|| sensitivities(&self.record)).map_err(|e| error::record(&e))?;
        let row = |row: SensitivityRow| (row.direction_deg, row.l2, row.number, row.derivative, row.derivative_back);
        Ok(found.into_iter().map(row).collect())
    }

    fn save(&self, folder: PathBuf, quantity_name: &str, overwrite: bool, sensitivities: bool) -> PyResult<()> {
        let quantity = quantity(quantity_name)?;
        save_record(&self.record, &folder, quantity, overwrite, sensitivities).map_err(|e| error::map(&e))
    }

    fn __len__(&self) -> usize {
        self.record.rows.len()
    }
}

/// Reads the folder of a record.
#[pyfunction]
pub fn read_record(folder: PathBuf) -> PyResult<Record> {
    let record = maille_io::record::Record::read(&folder).map_err(|e| error::record(&e))?;
    Ok(Record { name: folder.display().to_string(), record })
}
