//! Rolls of a sheet as the page shows them: a piece of it in each state, one after the other.

use crate::{
    api::{Frame, ShownSimulation},
    refusal::Refusal,
    sheet::{sheet, tolerant},
};
use maille::{error::InvalidInput, lattice::Cell, model::Model, record::pose_records, relaxation::simulate::End};
use maille_io::roll::{Roll, RollRecordFile};

/// Cells of a piece along a1 and a2, and of a chain.
const PIECE: [i32; 2] = [4, 4];
const PIECE_OF_CHAIN: [i32; 2] = [8, 1];
/// Rows of a tube, and cells round it at most.
const ROWS: i32 = 6;
const MOST_ROUND: i32 = 200;

/// The rolls that have a state, in the order of the table.
pub fn shown(source: String, record: &RollRecordFile, rolls: &[Roll]) -> Result<ShownSimulation, Refusal> {
    let unusable =
        |problem: String| Refusal::wrong(format!("the rolls {source} cannot be used: {problem}"), "compute them again");
    let problems = |problems: Vec<InvalidInput>| {
        unusable(problems.iter().map(|p| p.problem.clone()).collect::<Vec<_>>().join("; "))
    };
    let design = tolerant(&record.design);
    let (round, [m, n]) = piece(record, rolls);
    let tile = Cell::new([[m, 0], [0, n]]).map_err(|e| unusable(e.problem))?;
    let piece = Model::compile_sheet(&design, tile).map_err(problems)?;
    let mut frames = Vec::new();
    for roll in rolls {
        // Tubes of fewer cells would lie on themselves.
        let Some(state) = roll.state().filter(|_| roll.wrap == round) else { continue };
        let cell: Cell = roll.cell.parse().map_err(|e: InvalidInput| unusable(e.problem))?;
        let model = Model::compile(&design, cell).map_err(problems)?;
        let state = maille_mesh::state_of(&model, &state).map_err(|e| unusable(e.to_string()))?;
        frames.push(Frame {
            number: frames.len(),
            share: 0.0,
            energy: 0.0,
            stretch: roll.neutral_stretch,
            mean_force: None,
            roll: Some(words(roll, record.design.unit.as_deref())),
            poses: pose_records(&piece, &state.of_piece(&model, &piece)),
        });
    }
    if frames.is_empty() {
        return Err(unusable("none of them has a state".into()));
    }
    let total = frames.len();
    let note = round.map(|cells| format!("tubes of {cells} cells; export and render show the others"));
    for (k, frame) in frames.iter_mut().enumerate() {
        frame.share = k as f64 / (total - 1).max(1) as f64;
    }
    Ok(ShownSimulation { sheet: sheet(&piece, &record.design), frames, total, end: End::Reached, note, source })
}

/// How many cells are shown: of tubes all that go round the first one, and only tubes with as many.
fn piece(record: &RollRecordFile, rolls: &[Roll]) -> (Option<u32>, [i32; 2]) {
    let first = rolls.iter().find(|roll| roll.wrap.is_some() && roll.roll.is_some());
    let round = first.and_then(|roll| roll.wrap);
    let turns = first.and_then(|roll| roll.roll).map(|roll| roll.turn_rad);
    let aside = if record.design.lattice.single { 1 } else { ROWS };
    let cells = round.map_or(1, |cells| i32::try_from(cells).unwrap_or(MOST_ROUND).min(MOST_ROUND));
    let piece = match turns {
        Some([a, b]) if a.abs() > b.abs() => [cells, aside],
        Some(_) => [aside, cells],
        None if record.design.lattice.single => PIECE_OF_CHAIN,
        None => PIECE,
    };
    (round, piece)
}

/// Which roll it is, its radius and its status.
fn words(roll: &Roll, unit: Option<&str>) -> String {
    let turn = match (roll.wrap, roll.at_curvature) {
        (Some(cells), _) => format!(", {cells} cells round, {}", roll.sought.name()),
        (_, Some(curvature)) => format!(", curvature {curvature}, {}", roll.sought.name()),
        _ => String::new(),
    };
    let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
    let radius = roll.neutral_radius.map_or(String::new(), |radius| format!(", radius {radius:.4}{unit}"));
    format!("along {}\u{b0}, axis {}{turn}{radius}: {}", roll.direction_deg, roll.axis.name(), roll.status.name())
}
