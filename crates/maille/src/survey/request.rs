//! What a map asks, and what comes back of each limit.

use crate::{
    lattice::{Across, Cell},
    record::{LimitRow, StateRecord},
    relaxation::limit::EnergyOptions,
    search::ExactOptions,
};
use serde::{Deserialize, Serialize};

/// How limits are found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", content = "options", rename_all = "kebab-case")]
pub enum Method {
    /// The thesis's energy method.
    Energy(EnergyOptions),
    /// The exact method, with certificates.
    Exact(ExactOptions),
}

impl Method {
    /// What is left to the sheet.
    pub fn across(&self) -> Across {
        match self {
            Method::Energy(_) => Across::HELD,
            Method::Exact(options) => options.across,
        }
    }

    /// Whether l1 is made as small as can be.
    pub fn compression(&self) -> bool {
        matches!(self, Method::Exact(ExactOptions { compression: true, .. }))
    }

    /// The name in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Method::Energy(_) => "energy",
            Method::Exact(_) => "exact",
        }
    }
}

/// Which cells are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellChoice {
    /// The design's own, and larger ones where the exact method asks for them.
    Auto,
    /// This one.
    One(Cell),
}

/// Cells that `auto` may go on to, in this order.
const LARGER: [&str; 4] = ["2x1", "1x2", "2x2", "3x3"];
/// Elements in a cell that `auto` goes on to, at most.
const MOST_ELEMENTS: usize = 40;

impl CellChoice {
    /// The cells to compile: for the energy method `auto` is the design's own.
    pub fn cells(self, method: &Method, elements: usize) -> Vec<Cell> {
        match (self, method) {
            (CellChoice::One(cell), _) => vec![cell],
            (CellChoice::Auto, Method::Energy(_)) => vec![Cell::PRIMITIVE],
            (CellChoice::Auto, Method::Exact(_)) => {
                let larger = LARGER.iter().filter_map(|text| text.parse::<Cell>().ok());
                let larger = larger.filter(|cell| cell.copies() * elements <= MOST_ELEMENTS);
                std::iter::once(Cell::PRIMITIVE).chain(larger).collect()
            }
        }
    }
}

/// What a map asks: the limit along every direction with every l2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapQuestion {
    /// How limits are found.
    #[serde(flatten)]
    pub method: Method,
    /// The cells that may be solved, the first one always.
    pub cells: Vec<Cell>,
    /// Directions of the pull, degrees counter-clockwise from x.
    pub directions_deg: Vec<f64>,
    /// Stretch − 1 held across it.
    pub l2: Vec<f64>,
}

/// One limit to find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Direction of the pull, degrees counter-clockwise from x.
    pub direction_deg: f64,
    /// Stretch − 1 held across it.
    pub l2: f64,
}

/// A finished row with its state.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The row of the table.
    pub row: LimitRow,
    /// The state at the limit.
    pub state: StateRecord,
}

/// The tasks of a map: every l2 with every direction, in the order of the table.
pub fn tasks(directions_deg: &[f64], l2: &[f64]) -> Vec<Task> {
    l2.iter().flat_map(|&l2| directions_deg.iter().map(move |&direction_deg| Task { direction_deg, l2 })).collect()
}
