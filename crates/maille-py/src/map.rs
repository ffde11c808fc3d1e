//! `characterize`, and records.

use crate::{
    design::Design,
    error,
    wait::{Step, wait},
};
use maille::{
    lattice::Across,
    relaxation::limit::EnergyOptions,
    search::ExactOptions,
    survey::{CellChoice, Method},
};
use maille_io::{
    Quantity,
    numbers::{USUAL_DIRECTIONS, USUAL_L2, distinct, parse, parse_l2},
    record::{LIMIT_COLUMNS, NamedRecord, Values},
    run::{Map, save_record},
    table::{Field, Table},
};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict, PyList},
};
use serde_json::Value;
use std::path::PathBuf;

/// Directions and lateral strains of a map where none are named, as lists in text.
#[pyfunction]
pub fn usual() -> (&'static str, &'static str) {
    (USUAL_DIRECTIONS, USUAL_L2)
}

/// Numbers in a list or a range, as on the command line, or in a sequence; each once. `name` is that of the argument:
/// values of l2 must be above −1.
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
    if name == "l2" {
        let text: Vec<String> = list.0.iter().map(|x| format!("{x:?}")).collect();
        return Ok(parse_l2(&text.join(",")).map_err(wrong)?.0);
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

/// `auto`, or a cell.
pub fn cell_choice(text: &str) -> PyResult<CellChoice> {
    match text {
        "auto" => Ok(CellChoice::Auto),
        _ => text.parse().map(CellChoice::One).map_err(|e| error::invalid(&e)),
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
    let options: EnergyOptions = serde_json::from_value(all.clone()).map_err(|e| wrong(e.to_string(), &all))?;
    let positive = [
        ("alpha", options.alpha),
        ("corner_weight", options.corner_weight),
        ("gradient_tolerance", options.gradient_tolerance),
        ("tau", options.tau),
        ("l1_step", options.l1_step),
        ("l1_resolution", options.l1_resolution),
        ("sample_spacing_rad", options.sample_spacing_rad.unwrap_or(1.0)),
    ];
    if options.flat_points != 0 && !EnergyOptions::FLAT_POINTS.contains(&options.flat_points) {
        let range = EnergyOptions::FLAT_POINTS;
        let problem = format!("flat_points = {} is out of range", options.flat_points);
        let remedy = format!("give 0, or a whole number from {} to {}", range.start(), range.end());
        return Err(error::argument("energy", problem, remedy));
    }
    match positive.into_iter().find(|(_, x)| !(x.is_finite() && *x > 0.0)) {
        Some((name, x)) => {
            Err(error::argument("energy", format!("{name} = {x} is not positive"), "give a positive number"))
        }
        None => Ok(options),
    }
}

/// What a map is asked for, a dictionary in Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Asked {
    directions: Vec<f64>,
    l2: Vec<f64>,
    lateral_free: bool,
    shear_free: bool,
    compression: bool,
    method: String,
    cell: String,
    starts: usize,
    seed: u64,
    energy: String,
    quantity_name: String,
}

impl Asked {
    /// The map of a design, open.
    pub fn open(self, design: &Design, out: Option<PathBuf>, overwrite: bool) -> PyResult<maille_io::run::OpenMap> {
        let across = Across { lateral_free: self.lateral_free, shear_free: self.shear_free };
        let (starts, seed) = (self.starts, self.seed);
        let method = match self.method.as_str() {
            "exact" => Method::Exact(ExactOptions { starts, seed, across, compression: self.compression }),
            "energy" if self.compression => {
                let remedy = "leave compression out, or take method=\"exact\"";
                return Err(error::argument("method", "the energy method has no limits in compression", remedy));
            }
            "energy" if across.any() => {
                let remedy = "leave lateral and shear fixed, or take method=\"exact\"";
                return Err(error::argument("method", "the energy method holds width and shear", remedy));
            }
            "energy" => Method::Energy(energy_options(&self.energy, seed)?),
            other => return Err(error::argument("method", format!("\"{other}\" is none"), "give exact or energy")),
        };
        let quantity = quantity(&self.quantity_name)?;
        let (cell, directions_deg, l2) = (cell_choice(&self.cell)?, self.directions, self.l2);
        let map = Map { method, cell, directions_deg, l2, quantity, out, overwrite };
        let models = map.cells(&design.design).into_iter().map(|cell| design.compile(cell)).collect::<PyResult<_>>()?;
        map.open(&design.design, models).map_err(|e| error::record(&e))
    }
}

/// Finds the limits of a map, as `maille characterize` does.
#[pyfunction]
#[pyo3(signature = (design, asked, *, out, overwrite, progress, threads))]
pub fn characterize(
    py: Python<'_>,
    design: &Design,
    asked: Asked,
    out: Option<PathBuf>,
    overwrite: bool,
    progress: Option<Bound<'_, PyAny>>,
    threads: Option<usize>,
) -> PyResult<Record> {
    let open = asked.open(design, out, overwrite)?;
    let run = wait(py, threads, progress.as_ref(), |cancel, tell| {
        tell(Step::More(open.left()));
        open.run(cancel, &|_, _| tell(Step::Done))
    })?;
    let record = run.map_err(|e| error::map(&e))?;
    Ok(Record { name: design.design.name.clone(), record })
}

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
            one.set_item("type", column.values.kind())?;
            one.set_item("unit", column.unit.name(length))?;
            one.set_item("meaning", column.meaning)?;
            match column.values {
                Values::Text(of) => one.set_item("values", rows.iter().map(of).collect::<Vec<_>>())?,
                Values::Number(of) => one.set_item("values", rows.iter().map(of).collect::<Vec<_>>())?,
                Values::Count(of) => one.set_item("values", rows.iter().map(of).collect::<Vec<_>>())?,
                Values::Flag(of) => one.set_item("values", rows.iter().map(of).collect::<Vec<_>>())?,
            }
            out.append(one)?;
        }
        Ok(out)
    }

    /// The table as Parquet, as `maille table` writes it; with `states`, each row with the line of its state.
    fn parquet<'py>(&self, py: Python<'py>, states: bool) -> PyResult<Bound<'py, PyBytes>> {
        let named = [NamedRecord { name: self.name.clone(), record: self.record.clone() }];
        let (table, mut out) = (Table::new(&named, Field::all(false)), Vec::new());
        let done = match states {
            true => table.parquet_with_states(&self.record.states, &mut out),
            false => table.parquet(&mut out),
        };
        done.map_err(|e| error::other(&e.to_string()))?;
        Ok(PyBytes::new(py, &out))
    }

    /// Rows with their states, both as JSON.
    fn limits(&self) -> Vec<(String, String)> {
        let row = |row| serde_json::to_string(row).expect("a row has no map with odd keys");
        self.record.rows.iter().map(row).zip(self.states()).collect()
    }

    /// The states, each a JSON document as in `states.jsonl`.
    fn states(&self) -> Vec<String> {
        let json = |state| serde_json::to_string(state).expect("a state has no map with odd keys");
        self.record.states.iter().map(json).collect()
    }

    /// `run.json`.
    fn run(&self) -> String {
        maille_io::record::write_run(&self.record.run)
    }

    /// The design that was computed.
    fn design(&self) -> Design {
        Design::of(self.record.run.design.clone())
    }

    fn save(&self, folder: PathBuf, quantity_name: &str, overwrite: bool) -> PyResult<()> {
        let quantity = quantity(quantity_name)?;
        save_record(&self.record, &folder, quantity, overwrite).map_err(|e| error::map(&e))
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
