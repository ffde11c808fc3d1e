//! How much of a sheet: cells, or the size of a piece.

use crate::{
    exit::{USAGE, wrong},
    units::parse_size,
};
use maille::{model::Model, state::State};
use maille_io::{Tile, millimetres};
use miette::Result;

/// Cells that are exported and simulated where nothing is said.
const USUAL: Tile = Tile([4, 4]);
/// The same of a chain.
const USUAL_OF_CHAIN: Tile = Tile([8, 1]);

/// Cells, or a size.
#[derive(clap::Args)]
pub struct PieceArgs {
    /// Cells along a1 and a2 [default: 4x4; of a chain 8x1; of a tube all that go round]
    #[arg(long, value_name = "MxN")]
    tile: Option<Tile>,
    /// In place of --tile, width along a1 and height across it, as 100x100mm, 10x10cm or 4x4in: the whole cells that come nearest,
    /// measured with the wire
    #[arg(long, value_name = "WxH", value_parser = parse_size, conflicts_with = "tile")]
    size: Option<[f64; 2]>,
}

impl PieceArgs {
    /// Whether a size is asked for.
    pub fn is_size(&self) -> bool {
        self.size.is_some()
    }

    /// The cells, in words where a size was asked for; `tube` are those of a tube, and `mm` is that of one unit of the file.
    pub fn tile(&self, model: &Model, state: &State, tube: Option<Tile>, mm: f64) -> (Tile, Option<String>) {
        match self.size {
            None => {
                let usual = if model.single { USUAL_OF_CHAIN } else { USUAL };
                (self.tile.or(tube).unwrap_or(usual), None)
            }
            Some(size) => {
                let tile = nearest(model, state, mm, size);
                (tile, Some(words(tile, model, state, mm)))
            }
        }
    }
}

/// The tile whose size is nearest to this one, in millimetres.
pub fn nearest(model: &Model, state: &State, mm: f64, size: [f64; 2]) -> Tile {
    Tile::nearest(model, state, size.map(|length| length / (model.unit * mm)))
}

/// Its size in millimetres: width along a1 and height across it, with the wire.
pub fn size_mm(tile: Tile, model: &Model, state: &State, mm: f64) -> [f64; 2] {
    tile.size(model, state).map(|length| length * model.unit * mm)
}

/// `8x16 cells, 100.9 x 101.9 mm with the wire`.
pub fn words(tile: Tile, model: &Model, state: &State, mm: f64) -> String {
    let [width, height] = size_mm(tile, model, state, mm);
    // How far a row stands beside the one below it.
    let lean = (state.a1.dot(&state.a2) / state.a1.norm()).abs() * model.unit * mm;
    let beside = lean * f64::from(tile.0[1] - 1);
    let rows = match beside >= 0.05 {
        true => format!(
            "; each row stands {lean:.2} mm beside the one below it, so that the piece is {:.1} mm wide in all",
            width + beside
        ),
        false => String::new(),
    };
    format!("{tile} cells, {width:.1} x {height:.1} mm with the wire{rows}")
}

/// Millimetres of one unit of the file; `what` needs them because `option` was given.
pub fn known_millimetres(unit: Option<&str>, what: &str, option: &str) -> Result<f64> {
    if let Some(mm) = unit.and_then(millimetres) {
        return Ok(mm);
    }
    let problem = match unit {
        None => format!("{what} needs the design's unit of length, and the file names none"),
        Some(unit) => format!("{what} needs a unit of length, and \"{unit}\" is not known"),
    };
    let help = format!("write unit = \"mm\" at the top of the file, or leave {option} out");
    Err(wrong(USAGE, problem, help))
}
