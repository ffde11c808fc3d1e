//! What is asked of a sheet that is rolled, and which rolls that are.

use maille::{
    design::Design,
    error::InvalidInput,
    lattice::Across,
    question::{Effort, Goal, OfTube, Question, Sense},
    survey::CellChoice,
};
use serde::{Deserialize, Serialize};

/// Where the axis of a roll is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Below the sheet, which bends downwards: κ > 0.
    Below,
    /// Above the sheet, which bends upwards: κ < 0.
    Above,
}

impl Axis {
    /// Both, in the order of tables.
    pub const BOTH: [Axis; 2] = [Axis::Below, Axis::Above];

    /// The end of the curvatures that has it.
    pub(super) fn sense(self) -> Sense {
        if self == Axis::Below { Sense::Largest } else { Sense::Least }
    }

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Axis::Below => "below",
            Axis::Above => "above",
        }
    }
}

/// What is asked of a sheet that is rolled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollQuestion {
    /// Directions that are rolled, degrees counter-clockwise from x.
    pub directions_deg: Vec<f64>,
    /// On which side the axis is.
    pub axes: Vec<Axis>,
    /// What is left to the sheet.
    pub free: Across,
    /// The cells that may be solved.
    pub cells: CellChoice,
    /// How long each roll is searched.
    pub effort: Effort,
    /// Seed of the starts that are drawn.
    pub seed: u64,
    /// Of tubes: how many cells go round, for each of them. None: the tightest rolls of the sheet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wrap: Vec<u32>,
}

/// What is sought of a roll: the first of a sheet, the others of a closed tube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sought {
    /// The largest curvature.
    #[default]
    Tightest,
    /// The tube with the widest gaps.
    Roomiest,
    /// The tube of the least radius.
    Narrowest,
    /// The tube of the largest radius.
    Widest,
    /// The shortest tube.
    Shortest,
    /// The longest tube.
    Longest,
}

impl Sought {
    /// What is sought of each tube.
    pub const OF_TUBES: [Sought; 5] =
        [Sought::Roomiest, Sought::Narrowest, Sought::Widest, Sought::Shortest, Sought::Longest];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        ["tightest", "roomiest", "narrowest", "widest", "shortest", "longest"][self as usize]
    }

    /// The one with this name.
    pub fn named(name: &str) -> Option<Self> {
        std::iter::once(Sought::Tightest).chain(Self::OF_TUBES).find(|sought| sought.name() == name)
    }

    /// Whether it is that of a sheet, which its record does not say.
    pub(super) fn is_of_sheet(&self) -> bool {
        *self == Sought::Tightest
    }

    fn of_tube(self) -> (OfTube, Sense) {
        match self {
            Sought::Tightest | Sought::Roomiest => (OfTube::Gap, Sense::Largest),
            Sought::Narrowest => (OfTube::Radius, Sense::Least),
            Sought::Widest => (OfTube::Radius, Sense::Largest),
            Sought::Shortest => (OfTube::Length, Sense::Least),
            Sought::Longest => (OfTube::Length, Sense::Largest),
        }
    }

    pub(super) fn of(sought: OfTube, sense: Sense) -> Self {
        Self::OF_TUBES.into_iter().find(|of| of.of_tube() == (sought, sense)).unwrap_or(Sought::Roomiest)
    }
}

/// What tells a roll from the others of its folder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollKey {
    /// Direction that is rolled.
    pub direction_deg: f64,
    /// Where the axis is.
    pub axis: Axis,
    /// Cells of a tube that go round.
    pub wrap: Option<u32>,
    /// What is sought.
    pub sought: Sought,
}

impl RollQuestion {
    /// The directions that are rolled where none is named: every 30°; of tubes that of a1.
    pub fn usual_directions(design: &Design, tubes: bool) -> Vec<f64> {
        let [x, y, _] = design.lattice.a1;
        if tubes { vec![y.atan2(x).to_degrees()] } else { (0..6).map(|k| 30.0 * f64::from(k)).collect() }
    }

    /// Its rolls, in the order of the table.
    pub fn rolls(&self) -> Vec<RollKey> {
        let tubes = |wrap: &u32| Sought::OF_TUBES.map(|sought| (Some(*wrap), sought));
        let sought: Vec<(Option<u32>, Sought)> = match self.wrap.is_empty() {
            true => vec![(None, Sought::Tightest)],
            false => self.wrap.iter().flat_map(tubes).collect(),
        };
        let along = |direction_deg: &f64| {
            let of_axis = |axis: &Axis| {
                let key = |&(wrap, sought): &(Option<u32>, Sought)| RollKey {
                    direction_deg: *direction_deg,
                    axis: *axis,
                    wrap,
                    sought,
                };
                sought.iter().map(key).collect::<Vec<_>>()
            };
            self.axes.iter().flat_map(of_axis).collect::<Vec<_>>()
        };
        self.directions_deg.iter().flat_map(along).collect()
    }

    /// One of them as a question by itself.
    pub fn question(&self, key: RollKey) -> Question {
        let RollKey { direction_deg, axis, wrap, sought } = key;
        let question = match wrap {
            None => Question::curvature_along(direction_deg, axis.sense().sign()).with_free(self.free),
            Some(cells) => {
                let (sought, sense) = sought.of_tube();
                let above = axis == Axis::Above;
                Question::new(Goal::Tube { direction_deg, above, cells, sought }, sense)
            }
        };
        Question { effort: self.effort, seed: self.seed, ..question }
    }

    /// What is left to the sheet. Lengths of a tube are free, and its shear is held.
    pub fn free(&self) -> Across {
        if self.wrap.is_empty() { self.free } else { Across { lateral_free: true, shear_free: false } }
    }

    /// Whether all can be asked.
    ///
    /// # Errors
    /// Without directions, and what [`Question::check`] refuses.
    pub fn check(&self) -> Result<(), InvalidInput> {
        if self.directions_deg.is_empty() {
            return Err(InvalidInput::new("directions", "there is none", "give one or more"));
        }
        self.rolls().into_iter().try_for_each(|roll| self.question(roll).check())
    }
}
