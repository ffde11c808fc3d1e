//! Simulated sheets as the page shows them, and the pairs of rings of one state.

use crate::{
    api::{Frame, Measure, Pair, ShownSimulation},
    refusal::Refusal,
    sheet::{pairs, sheet, tolerant},
};
use maille::{
    error::InvalidInput,
    lattice::Cell,
    model::Model,
    record::{ForceRow, StateRecord},
};
use maille_io::record::SimulationFiles;

/// Poses of all frames that are sent, at most.
const MOST_POSES: usize = 200_000;

/// A simulation as the page shows it; of very many states, some that are spread evenly.
pub fn shown(source: String, files: &SimulationFiles) -> Result<ShownSimulation, Refusal> {
    let SimulationFiles { record, frames, forces } = files;
    let unusable = |problem: String| {
        Refusal::wrong(format!("the simulation {source} cannot be used: {problem}"), "simulate it again")
    };
    let tile: Cell = record.tile.parse().map_err(|e: InvalidInput| unusable(e.problem))?;
    let model = Model::compile_sheet(&tolerant(&record.design), tile)
        .map_err(|problems| unusable(problems.iter().map(|p| p.problem.clone()).collect::<Vec<_>>().join("; ")))?;
    let elements = model.elements.len();
    if let Some(frame) = frames.iter().position(|frame| frame.poses.len() != elements) {
        return Err(unusable(format!("frame {frame} has not the {elements} elements of the sheet")));
    }
    let last = frames.len().checked_sub(1).ok_or_else(|| unusable("it has no frames".into()))?;
    let count = frames.len().min((MOST_POSES / elements).max(2));
    // One row a frame; a table of the last state alone belongs to none of several.
    let rows = forces.as_ref().map_or(&[][..], |table| &table.rows);
    let row = |number: usize| (rows.len() == frames.len()).then(|| &rows[number]);
    let frame = |number: usize| {
        let of_row = |value: fn(&ForceRow) -> Option<f64>| row(number).and_then(value);
        Frame {
            number,
            share: frames[number].share,
            energy: frames[number].energy,
            stretch: of_row(|row| row.stretch),
            mean_force: of_row(|row| row.mean_force),
            roll: None,
            poses: frames[number].poses.clone(),
        }
    };
    Ok(ShownSimulation {
        sheet: sheet(&model, &record.design),
        frames: (0..count).map(|k| frame(k * last / (count - 1).max(1))).collect(),
        total: frames.len(),
        end: record.outcome.end,
        note: record.outcome.note.clone(),
        source,
    })
}

/// The pairs of rings that are linked or near each other in a state.
pub fn measure(request: &Measure) -> Result<Vec<Pair>, Refusal> {
    let unusable = |problem: String| Refusal::wrong(problem, "open the record again");
    let read = request.subject.read()?;
    let cell: Cell = request.cell.parse().map_err(|e: InvalidInput| unusable(e.problem))?;
    let model = read.compile_for(&tolerant(&read.design), cell, request.finite)?;
    let Measure { a1, a2, .. } = *request;
    let record = StateRecord { a1, a2, poses: request.poses.clone(), ..StateRecord::default() };
    let state = maille_mesh::state_of(&model, &record).map_err(|e| unusable(e.to_string()))?;
    Ok(pairs(&model, &state))
}
