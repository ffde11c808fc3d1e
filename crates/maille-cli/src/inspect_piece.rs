//! `maille inspect --size`: a piece of whole cells, with its rings, wire and weight, in the written state and in others.

use crate::{
    effort::SearchArgs,
    extreme::{self, Lattice},
    input::Input,
    interrupt,
    map::pool,
    piece,
};
use maille::{lattice::Cell, model::Model, question::Question, record::Status, search::extreme::Extreme, state::State};
use miette::Result;
use serde::Serialize;

/// Rings, wire and weight of one cell.
#[derive(Clone, Copy)]
pub struct OfCell {
    pub rings: usize,
    pub wire_metres: f64,
    pub kilograms: Option<f64>,
}

/// The whole cells nearest to a size that is asked for: `cells[0]` along a1, `cells[1]` along a2. Lengths in millimetres.
#[derive(Serialize)]
pub struct Piece {
    /// Which state of the sheet.
    state: &'static str,
    /// How sure that state is; none for the written one.
    status: Option<Status>,
    cells: [u32; 2],
    /// Along a1, and across it, with the wire.
    size_mm: [f64; 2],
    rings: u64,
    wire_metres: f64,
    kilograms: Option<f64>,
}

impl Piece {
    /// The piece nearest to `size`, in a sheet in `state`; `mm` is that of one unit of the file.
    pub fn new(model: &Model, state: &State, mm: f64, size: [f64; 2], cell: OfCell) -> Piece {
        let tile = piece::nearest(model, state, mm, size);
        let count = u64::from(tile.0[0]) * u64::from(tile.0[1]);
        Piece {
            state: "written",
            status: None,
            cells: tile.0,
            size_mm: piece::size_mm(tile, model, state, mm),
            rings: count * cell.rings as u64,
            wire_metres: count as f64 * cell.wire_metres,
            kilograms: cell.kilograms.map(|kilograms| count as f64 * kilograms),
        }
    }

    /// One line for people.
    pub fn words(&self) -> String {
        let Piece { state, status, cells: [n, m], size_mm: [width, height], rings, wire_metres, kilograms } = self;
        let weight = kilograms.map_or(String::new(), |weight| format!(", {weight:.3} kg"));
        let status = status.map_or(String::new(), |status| format!(" ({})", status.name()));
        format!(
            "piece, {state}{status}: {n}x{m} cells, {width:.1} x {height:.1} mm with the wire: {rings} rings, {wire_metres:.1} m of wire{weight}"
        )
    }
}

/// The piece in the state with the widest gaps, its lattice free, and in that locked across the rows with its width kept; a state
/// that was not found is left out.
pub fn other_states(input: &Input, mm: f64, size: [f64; 2], cell: OfCell) -> Result<Vec<Piece>> {
    let roomiest = extreme::search(input, Extreme::LargestClearance, Some(Lattice::Free), SearchArgs::USUAL, None)?;
    let sheet = input.sheet(Cell::PRIMITIVE.into())?;
    let a1 = sheet.model().start.a1;
    let across = Question::stretch_along(a1.y.atan2(a1.x).to_degrees() + 90.0);
    let cancel = interrupt::flag(false)?;
    let locked = pool(None)?.install(|| sheet.answer_until(&across, &cancel)).map_err(|e| crate::exit::refused(&e))?;
    let found = [("roomiest", &roomiest.found, roomiest.model()), ("locked across the rows", &locked, sheet.model())];
    let pieces = found.into_iter().filter(|(_, answer, _)| answer.value.is_some()).map(|(state, answer, model)| {
        Piece { state, status: Some(answer.status), ..Piece::new(model, &answer.state, mm, size, cell) }
    });
    Ok(pieces.collect())
}
