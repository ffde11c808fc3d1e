//! Finite sheets.

use crate::{
    design::Design,
    error,
    wait::{Step, wait},
};
use maille::{
    lattice::Cell,
    record::{FrameRecord, pose_records},
    relaxation::simulate::simulate as run,
};
use maille_io::{
    Tile,
    record::{
        FolderLock, ForceTable, Mark, SIMULATION, SheetPlan, SimulationFolder, SimulationRecord, read_forces,
        read_frames, read_simulation, write_forces, write_frames, write_simulation,
    },
};
use pyo3::prelude::*;
use std::path::PathBuf;

/// `simulation.json`, `frames.jsonl` and, where there is one, `forces.csv`.
type Texts = (String, String, Option<String>);

/// What `maille simulate` writes: its three files. `plan` is a document with the fields of
/// [`SheetPlan`].
#[pyfunction]
#[pyo3(signature = (design, tile, plan, progress))]
pub fn simulate(
    py: Python<'_>,
    design: &Design,
    tile: [u32; 2],
    plan: &str,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Texts> {
    let plan: SheetPlan = serde_json::from_str(plan)
        .map_err(|e| error::argument("pull", e.to_string(), "give vectors of three numbers"))?;
    if plan.is_still() {
        return Err(error::argument("pull", "nothing moves this sheet", "give a pull, a force or gravity"));
    }
    let [m, n] = tile.map(|k| i32::try_from(k).unwrap_or(i32::MAX));
    let cell = Cell::new([[m, 0], [0, n]]).map_err(|e| error::argument("tile", e.problem, e.help))?;
    let model = design.compile_sheet(cell)?;
    let setup = plan.setup(&model).map_err(|e| error::invalid(&e))?;
    let steps = f64::from(plan.steps);
    let end = wait(py, None, progress.as_ref(), |cancel, tell| {
        tell(Step::More(plan.steps as usize));
        let mut told = 0;
        // The step that is worked on is not done yet.
        run(&model, &setup, cancel, &mut |accepted| {
            let done = (accepted.share * steps).ceil() as usize;
            for _ in told..done.saturating_sub(1) {
                tell(Step::Done);
            }
            told = told.max(done.saturating_sub(1));
        })
    })?;
    let end = end.map_err(|e| error::invalid(&e))?;
    let last = || FrameRecord { run: 0, share: end.share, energy: end.energy, poses: pose_records(&model, &end.state) };
    let frames = if end.path.is_empty() { vec![last()] } else { end.path.clone() };
    let forces = ForceTable::new(&plan, &model, &setup, &end).map_err(|e| error::invalid(&e))?;
    let record = SimulationRecord::new(&design.design, Tile(tile), plan, &model, &end).sealed(&frames, Some(&forces));
    Ok((write_simulation(&record), write_frames(&frames), Some(write_forces(&forces))))
}

/// Reads the folder of `maille simulate`: its files as they would be written now.
#[pyfunction]
pub fn open_simulation(folder: PathBuf) -> PyResult<Texts> {
    let files = maille_io::record::open_simulation(&folder).map_err(|e| error::record(&e))?;
    Ok((write_simulation(&files.record), write_frames(&files.frames), files.forces.as_ref().map(write_forces)))
}

/// Writes that folder.
#[pyfunction]
#[pyo3(signature = (folder, record, frames, forces))]
pub fn save_simulation(folder: PathBuf, record: &str, frames: &str, forces: Option<&str>) -> PyResult<()> {
    let record = read_simulation(SIMULATION[0], record).map_err(|e| error::record(&e))?;
    let frames = read_frames(SIMULATION[1], frames).map_err(|e| error::record(&e))?;
    let forces = forces.map(|text| read_forces(SIMULATION[2], text)).transpose().map_err(|e| error::record(&e))?;
    let folder = SimulationFolder::open(&folder).map_err(|e| error::record(&e))?;
    // Steps of another run would go on over it.
    folder.forget_steps().map_err(|e| error::record(&e))?;
    folder.save(record, &frames, forces.as_ref()).map_err(|e| error::record(&e))
}

/// Refuses a folder that no simulation may be written to, before one is computed.
#[pyfunction]
pub fn check_simulation_folder(folder: PathBuf) -> PyResult<()> {
    SimulationFolder::open(&folder).map(drop).map_err(|e| error::record(&e))
}

/// The same of a folder of many records.
#[pyfunction]
pub fn check_records_folder(folder: PathBuf) -> PyResult<()> {
    FolderLock::take(&folder, &[Mark::Records]).map(drop).map_err(|e| error::record(&e))
}
