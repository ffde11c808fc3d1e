//! What a map asks, and what comes back of each limit.

use crate::{
    lattice::{Across, Cell},
    model::Model,
    question::{Goal, Question, Sense},
    record::{LimitRow, StateRecord},
    relaxation::limit::EnergyOptions,
    search::ExactOptions,
};
use maille_design::InvalidInput;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

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
    /// The energy method, which holds width and shear and finds largest limits alone.
    ///
    /// # Errors
    /// Where something else is asked of it.
    pub fn energy(options: EnergyOptions, across: Across, compression: bool) -> Result<Self, InvalidInput> {
        let refused = |problem: &str, help| Err(InvalidInput::new("method", problem, help));
        match (compression, across.any()) {
            (true, _) => {
                refused("the energy method finds largest limits alone", "leave out `compression`, or `method` energy")
            }
            (_, true) => refused(
                "the energy method holds width and shear",
                "leave out `lateral` and `shear`, or `method` energy",
            ),
            (false, false) => Ok(Method::Energy(options)),
        }
    }

    /// What is left to the sheet.
    pub(crate) fn across(&self) -> Across {
        match self {
            Method::Energy(_) => Across::HELD,
            Method::Exact(options) => options.across,
        }
    }

    /// Whether l1 is made as small as can be.
    pub(crate) fn compression(&self) -> bool {
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
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CellChoice {
    /// The design's own, and larger ones where the exact method asks for them.
    #[default]
    Auto,
    /// These: the first one always, the others where the exact method asks for them.
    #[serde(untagged)]
    These(Vec<Cell>),
}

impl From<Cell> for CellChoice {
    fn from(cell: Cell) -> Self {
        CellChoice::These(vec![cell])
    }
}

impl FromStr for CellChoice {
    type Err = InvalidInput;

    /// `auto`, or one cell.
    fn from_str(text: &str) -> Result<Self, InvalidInput> {
        if text == "auto" { Ok(CellChoice::Auto) } else { text.parse::<Cell>().map(CellChoice::from) }
    }
}

/// Cells that `auto` may go on to, in this order.
const LARGER: [&str; 4] = ["2x1", "1x2", "2x2", "3x3"];
/// Elements in a cell that `auto` goes on to, at most.
const MOST_ELEMENTS: usize = 40;

impl CellChoice {
    /// Whether it names a cell.
    pub(crate) fn check(&self) -> Result<(), InvalidInput> {
        match self {
            CellChoice::These(cells) if cells.is_empty() => {
                Err(InvalidInput::new("cells", "there is none", "give one or more"))
            }
            _ => Ok(()),
        }
    }

    /// The cells to compile: for the energy method `auto` is the design's own.
    #[doc(hidden)]
    pub fn cells(&self, method: &Method, elements: usize) -> Vec<Cell> {
        match (self, method) {
            (CellChoice::These(cells), _) => cells.clone(),
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
    /// The cells that may be solved.
    pub cells: CellChoice,
    /// Directions of the pull, degrees counter-clockwise from x.
    pub directions_deg: Vec<f64>,
    /// Stretch − 1 held across it.
    pub l2: Vec<f64>,
    /// Whether the largest and the smallest l1 of each l2 are sought between the directions, too, see [`extremes`](super::extremes()).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub extremes: bool,
}

/// Lateral strains that are held where none are named.
const USUAL_L2: [f64; 5] = [-0.25, -0.125, 0.0, 0.125, 0.25];

impl MapQuestion {
    /// A map that can be asked. Without directions it has every fifth degree to 180, without l2 the usual ones, or only 0
    /// where the width is left to the sheet; extremes between the directions are sought where the exact method finds largest limits along the usual ones,
    /// unless `extremes` says otherwise. In messages, options stand in backticks.
    ///
    /// # Errors
    /// Where l2 is given and the width is free, and what [`Self::check`] refuses.
    pub fn new(
        method: Method,
        cells: CellChoice,
        directions_deg: Option<Vec<f64>>,
        l2: Option<Vec<f64>>,
        extremes: Option<bool>,
    ) -> Result<Self, InvalidInput> {
        let l2 = match (l2, method.across().lateral_free) {
            (Some(_), true) => {
                let problem = "`l2` holds the width that `lateral` free leaves to the sheet";
                return Err(InvalidInput::new("l2", problem, "leave one of them out"));
            }
            (None, true) => vec![0.0],
            (l2, false) => l2.unwrap_or(USUAL_L2.to_vec()),
        };
        let usual = directions_deg.is_none() && !method.compression() && matches!(method, Method::Exact(_));
        let extremes = extremes.unwrap_or(usual);
        let directions_deg = directions_deg.unwrap_or_else(|| (0..=36).map(|k| 5.0 * f64::from(k)).collect());
        let question = MapQuestion { method, cells, directions_deg, l2, extremes };
        question.check().map(|()| question)
    }

    /// Whether it can be asked.
    ///
    /// # Errors
    /// Without directions, l2 or cells, for options of the energy method out of range, and where one of its limits is refused by
    /// [`Question::check`].
    #[doc(hidden)]
    pub fn check(&self) -> Result<(), InvalidInput> {
        for (field, list) in [("directions_deg", &self.directions_deg), ("l2", &self.l2)] {
            if list.is_empty() {
                return Err(InvalidInput::new(field, "there is none", "give one or more"));
            }
        }
        self.cells.check()?;
        let refused = |problem: &str, help| Err(InvalidInput::new("extremes", problem, help));
        if let Method::Energy(options) = &self.method {
            options.check()?;
            if self.extremes {
                return refused(
                    "the energy method has no derivatives to seek them by",
                    "leave out `extremes`, or `method` energy",
                );
            }
        }
        if self.extremes && self.directions_deg.len() < 2 {
            return refused(
                "they are sought between directions, and there is one",
                "give two or more, or leave out `extremes`",
            );
        }
        let (first_deg, first_l2) = (self.directions_deg[0], self.l2[0]);
        self.directions_deg.iter().try_for_each(|direction_deg| self.limit(*direction_deg, first_l2).check())?;
        self.l2.iter().try_for_each(|l2| self.limit(first_deg, *l2).check())
    }

    /// Whether its limits have a meaning for the sheet of `model`: see [`Question::suits`].
    ///
    /// # Errors
    /// Where one of them has none.
    pub fn suits(&self, model: &Model) -> Result<(), InvalidInput> {
        self.tasks().into_iter().try_for_each(|task| self.limit(task.direction_deg, task.l2).suits(model))
    }

    /// One of its limits as a question by itself.
    fn limit(&self, direction_deg: f64, l2: f64) -> Question {
        let sense = if self.method.compression() { Sense::Least } else { Sense::Largest };
        let question = Question::new(Goal::Stretch { direction_deg, l2, across: self.method.across() }, sense);
        match &self.method {
            Method::Energy(_) => question,
            Method::Exact(ExactOptions { effort, starts, seed, .. }) => {
                Question { effort: *effort, starts: *starts, seed: *seed, ..question }
            }
        }
    }

    /// Its limits: every l2 with every direction, in the order of the table.
    #[doc(hidden)]
    pub fn tasks(&self) -> Vec<Task> {
        let along = |&l2: &f64| self.directions_deg.iter().map(move |&direction_deg| Task { direction_deg, l2 });
        self.l2.iter().flat_map(along).collect()
    }
}

/// One limit to find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Direction of the pull, degrees counter-clockwise from x.
    pub direction_deg: f64,
    /// Stretch − 1 held across it.
    pub l2: f64,
}

/// What happens to a limit on a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// It is begun.
    Begins,
    /// It is ended.
    Ends,
}

/// A finished row with its state.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The row of the table.
    pub row: LimitRow,
    /// The state at the limit.
    pub state: StateRecord,
}
