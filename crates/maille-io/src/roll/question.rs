//! What is asked of a sheet that is rolled, and which rolls that are.

use maille::{
    Sheet,
    design::Design,
    error::InvalidInput,
    lattice::Across,
    question::{Effort, Goal, OfRolled, Question, RollStrains, Sense, Turn},
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
    /// What is left to the sheet. Of tubes the length is, and the shear is held; of a chain that closes, neither is.
    pub free: Across,
    /// Stretch along the axis minus 1 where it is held.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub l2: f64,
    /// γ, how far lines along the direction lean along the axis, where it is held.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub gamma: f64,
    /// The cells that may be solved.
    pub cells: CellChoice,
    /// How long each roll is searched.
    pub effort: Effort,
    /// Seed of the starts that are drawn.
    pub seed: u64,
    /// Of tubes: how many cells go round, for each of them. None: the tightest rolls of the sheet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wrap: Vec<u32>,
    /// Curvatures that are given, in 1/unit, without the sign of the axis. None, and no tubes: the tightest rolls of the sheet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curvatures: Vec<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// What rolls are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The tightest rolls.
    Tightest,
    /// Closed tubes.
    Tubes,
    /// Sheets of given curvature.
    AtCurvature,
}

/// What is sought of a roll: the first where it is free how far it is rolled, the others of a closed tube or at a given curvature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sought {
    /// The largest curvature.
    #[default]
    Tightest,
    /// The widest gaps.
    Roomiest,
    /// The least radius.
    Narrowest,
    /// The largest radius.
    Widest,
    /// The least length along the axis.
    Shortest,
    /// The largest length along the axis.
    Longest,
}

impl Sought {
    /// What is sought where the turn is given; the last two, where the length along the axis is free.
    pub const AT_TURN: [Sought; 5] =
        [Sought::Roomiest, Sought::Narrowest, Sought::Widest, Sought::Shortest, Sought::Longest];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        ["tightest", "roomiest", "narrowest", "widest", "shortest", "longest"][self as usize]
    }

    /// The one with this name.
    pub fn named(name: &str) -> Option<Self> {
        std::iter::once(Sought::Tightest).chain(Self::AT_TURN).find(|sought| sought.name() == name)
    }

    /// Whether it is the largest curvature, which a record does not say.
    pub(super) fn is_tightest(&self) -> bool {
        *self == Sought::Tightest
    }

    fn at_turn(self) -> (OfRolled, Sense) {
        match self {
            Sought::Tightest | Sought::Roomiest => (OfRolled::Gap, Sense::Largest),
            Sought::Narrowest => (OfRolled::Radius, Sense::Least),
            Sought::Widest => (OfRolled::Radius, Sense::Largest),
            Sought::Shortest => (OfRolled::Length, Sense::Least),
            Sought::Longest => (OfRolled::Length, Sense::Largest),
        }
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
    /// The curvature where it is given, in 1/unit, without the sign of the axis.
    pub at_curvature: Option<f64>,
    /// What is sought.
    pub sought: Sought,
}

impl RollKey {
    /// Its place as `--at` names it.
    pub fn place(&self) -> String {
        let wrap = self.wrap.map(|cells| format!(",wrap={cells}"));
        let curvature = self.at_curvature.map(|curvature| format!(",curvature={curvature}"));
        let sought = (self.sought != Sought::Tightest).then(|| format!(",sought={}", self.sought.name()));
        let rest: String = [wrap, curvature, sought].into_iter().flatten().collect();
        format!("direction={},axis={}{rest}", self.direction_deg, self.axis.name())
    }
}

impl RollQuestion {
    /// The directions that are rolled where none is named: every 30°; of tubes and of a chain that of a1.
    pub fn usual_directions(design: &Design, tubes: bool) -> Vec<f64> {
        match tubes || design.lattice.single {
            true => vec![design.lattice.direction_deg()],
            false => (0..6).map(|k| 30.0 * f64::from(k)).collect(),
        }
    }

    /// What rolls it asks for.
    pub fn kind(&self) -> Kind {
        match () {
            () if !self.wrap.is_empty() => Kind::Tubes,
            () if !self.curvatures.is_empty() => Kind::AtCurvature,
            () => Kind::Tightest,
        }
    }

    /// What is held of the strains along the axis.
    pub fn strains(&self) -> RollStrains {
        match self.kind() {
            Kind::Tubes => RollStrains::free(self.free),
            _ => RollStrains { free: self.free, l2: self.l2, shear: self.gamma },
        }
    }

    /// Its rolls, in the order of the table.
    pub fn rolls(&self) -> Vec<RollKey> {
        let ends = if self.strains().free.lateral_free { &Sought::AT_TURN[..] } else { &Sought::AT_TURN[..3] };
        let turns: Vec<(Option<u32>, Option<f64>)> = match self.kind() {
            Kind::Tightest => vec![(None, None)],
            Kind::Tubes => self.wrap.iter().map(|cells| (Some(*cells), None)).collect(),
            Kind::AtCurvature => self.curvatures.iter().map(|curvature| (None, Some(*curvature))).collect(),
        };
        let sought = if self.kind() == Kind::Tightest { &[Sought::Tightest] } else { ends };
        let mut out = Vec::new();
        for &direction_deg in &self.directions_deg {
            for &axis in &self.axes {
                for &(wrap, at_curvature) in &turns {
                    let key = |&sought: &Sought| RollKey { direction_deg, axis, wrap, at_curvature, sought };
                    out.extend(sought.iter().map(key));
                }
            }
        }
        out
    }

    /// One of them as a question by itself, of a design with this reference radius.
    pub fn question(&self, key: RollKey, unit: f64) -> Question {
        let RollKey { direction_deg, axis, wrap, at_curvature, sought } = key;
        let (strains, above) = (self.strains(), axis == Axis::Above);
        let turn = wrap.map(Turn::Cells).or(at_curvature.map(|curvature| Turn::Curvature(curvature * unit)));
        let question = match turn {
            None => Question::curvature_along(direction_deg, if above { -1.0 } else { 1.0 }).with_strains(strains),
            Some(turn) => {
                let (sought, sense) = sought.at_turn();
                Question::new(Goal::Rolled { direction_deg, above, turn, strains, sought }, sense)
            }
        };
        Question { effort: self.effort, seed: self.seed, ..question }
    }

    /// Its rolls as questions of this sheet, each checked.
    ///
    /// # Errors
    /// Without directions, and what [`Sheet::check`] refuses.
    pub fn check(&self, sheet: &Sheet) -> Result<(), InvalidInput> {
        if self.directions_deg.is_empty() {
            return Err(InvalidInput::new("directions", "there is none", "give one or more"));
        }
        let model = sheet.model();
        let of_tube = Across { lateral_free: !model.single, shear_free: false };
        if self.kind() == Kind::Tubes
            && (!self.curvatures.is_empty() || self.free != of_tube || (self.l2, self.gamma) != (0.0, 0.0))
        {
            let problem = "a tube has its own curvature and shear, and its length is free";
            return Err(InvalidInput::new("wrap", problem, "leave out what is held or free, and the curvature"));
        }
        let unit = model.unit;
        self.rolls().into_iter().try_for_each(|roll| sheet.check(&self.question(roll, unit)))
    }
}
