//! Maps whose limits are found elsewhere, chain by chain: what `maille.dask` keeps while workers solve.

use crate::{
    design::Design,
    error,
    map::{self, Record},
};
use maille::record::{LimitRow, StateRecord};
use maille_io::{
    record::{NamedRecord, RecordError},
    table::{Field, Table},
};
use pyo3::prelude::*;
use std::{
    path::PathBuf,
    sync::{Mutex, MutexGuard},
};

/// An open map. After [`Self::finish`] it is closed.
#[pyclass(frozen, module = "maille._native")]
pub struct OpenMap {
    name: String,
    open: Mutex<Option<maille_io::run::OpenMap>>,
    /// What [`Self::finish`] has given: an interrupt can hide that it has.
    finished: Mutex<Option<maille_io::record::Record>>,
}

impl OpenMap {
    fn lock(&self) -> MutexGuard<'_, Option<maille_io::run::OpenMap>> {
        self.open.lock().unwrap_or_else(|e| e.into_inner())
    }
}

fn closed() -> PyErr {
    error::other("the map is finished")
}

#[pymethods]
impl OpenMap {
    /// Opens the record in `out`, with what an earlier run has left there.
    #[new]
    fn new(
        design: &Design,
        question: &str,
        quantity_name: &str,
        out: Option<PathBuf>,
        overwrite: bool,
        sensitivities: bool,
    ) -> PyResult<Self> {
        let open = map::open(design, question, quantity_name, out, overwrite, sensitivities)?;
        Ok(Self { name: design.design.name.clone(), open: Mutex::new(Some(open)), finished: Mutex::new(None) })
    }

    /// Limits of the map, and those that are not in the record yet.
    fn count(&self) -> PyResult<(usize, usize)> {
        self.lock().as_ref().map(|open| (open.total(), open.left())).ok_or_else(closed)
    }

    /// Each chain: directions, limits that are left, hash.
    fn chains(&self) -> PyResult<Vec<(Vec<f64>, usize, String)>> {
        let open = self.lock();
        let chains = open.as_ref().ok_or_else(closed)?.chains();
        Ok(chains.map(|chain| (chain.directions_deg, chain.left, chain.hash)).collect())
    }

    /// What the record has of a chain.
    fn chain(&self, directions_deg: Vec<f64>) -> PyResult<Record> {
        let open = self.lock();
        let record = open.as_ref().ok_or_else(closed)?.chain(&directions_deg);
        Ok(Record { name: self.name.clone(), record })
    }

    /// Takes limits that were found elsewhere, each a row and a state as JSON; says how many of them were left. `file` is
    /// what errors show.
    fn keep(&self, py: Python<'_>, file: &str, limits: Vec<(String, String)>) -> PyResult<usize> {
        let wrong = |line: usize, e: serde_json::Error| RecordError::Malformed {
            file: file.into(),
            line: line as u64 + 1,
            problem: e.to_string(),
        };
        let keep = || -> Result<Option<usize>, RecordError> {
            let mut kept = 0;
            let mut open = self.lock();
            let Some(open) = open.as_mut() else { return Ok(None) };
            for (line, (row, state)) in limits.iter().enumerate() {
                let row: LimitRow = serde_json::from_str(row).map_err(|e| wrong(line, e))?;
                let state: StateRecord = serde_json::from_str(state).map_err(|e| wrong(line, e))?;
                kept += usize::from(open.keep(row, state)?);
            }
            Ok(Some(kept))
        };
        py.detach(keep).map_err(|e| error::record(&e))?.ok_or_else(closed)
    }

    /// Gives the folder back and writes nothing.
    fn close(&self) {
        self.lock().take();
    }

    /// Writes the record with what was found; once more, it is the same record.
    fn finish(&self, py: Python<'_>) -> PyResult<Record> {
        let mut finished = self.finished.lock().unwrap_or_else(|e| e.into_inner());
        if let Some(record) = &*finished {
            return Ok(Record { name: self.name.clone(), record: record.clone() });
        }
        let open = self.lock().take().ok_or_else(closed)?;
        let record = py.detach(|| open.finish()).map_err(|e| error::map(&e))?;
        *finished = Some(record.clone());
        Ok(Record { name: self.name.clone(), record })
    }
}

/// The joint table of several records as CSV, as `maille sweep` writes it; `names` are their folders.
#[pyfunction]
pub fn joint_csv(names: Vec<String>, records: Vec<PyRef<'_, Record>>) -> String {
    let named = names.into_iter().zip(&records);
    let named: Vec<NamedRecord> = named
        .map(|(name, record)| NamedRecord { name, record: record.record.clone(), sensitivities: Vec::new() })
        .collect();
    Table::new(&named, Field::all(&named, true)).csv()
}
