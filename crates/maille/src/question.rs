//! What can be asked of a sheet.

mod number;
mod rolled;

pub use rolled::{OfRolled, RollStrains, Turn};

use self::number::{MOST, finite, width, within};
use crate::{
    lattice::{Across, Direction},
    model::Model,
    program::metric::factor,
};
use maille_design::InvalidInput;
use nalgebra::Matrix2;
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// One question: something of a sheet as large or as small as it can be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// What is sought, and what is held meanwhile.
    pub goal: Goal,
    /// Its largest or its least value.
    #[serde(default)]
    pub sense: Sense,
    /// How long the search goes on.
    #[serde(default)]
    pub effort: Effort,
    /// So many starts in place of an effort.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    #[serde(default = "usual_seed")]
    pub seed: u64,
}

/// How long a search goes on where no proven bound is attained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Effort {
    /// 4 to 8 starts.
    Low,
    /// 8 to 64 starts, until the chance that another one finds more is estimated at 2 % or less.
    #[default]
    Normal,
    /// 32 to 400 starts, until that chance is estimated at 0.5 % or less.
    Thorough,
    /// As many starts as this time in seconds allows, for each cell of each question. What is found depends on the machine.
    Seconds(f64),
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Effort::Low => f.write_str("low"),
            Effort::Normal => f.write_str("normal"),
            Effort::Thorough => f.write_str("thorough"),
            Effort::Seconds(seconds) => write!(f, "{seconds}s"),
        }
    }
}

impl FromStr for Effort {
    type Err = InvalidInput;

    fn from_str(text: &str) -> Result<Self, InvalidInput> {
        let seconds = || text.strip_suffix('s').and_then(|number| number.trim().parse::<f64>().ok());
        match text {
            "low" => Ok(Effort::Low),
            "normal" => Ok(Effort::Normal),
            "thorough" => Ok(Effort::Thorough),
            _ => match seconds() {
                Some(seconds) if (1e-3..=1e6).contains(&seconds) => Ok(Effort::Seconds(seconds)),
                Some(_) => {
                    Err(InvalidInput::new("effort", format!("{text} is out of range"), "give 0.001s to 1000000s"))
                }
                None => {
                    let right = "give low, normal, thorough, or a time in seconds, as 30s";
                    Err(InvalidInput::new("effort", format!("`{text}` is not an effort"), right))
                }
            },
        }
    }
}

impl TryFrom<String> for Effort {
    type Error = InvalidInput;

    fn try_from(text: String) -> Result<Self, InvalidInput> {
        text.parse()
    }
}

impl From<Effort> for String {
    fn from(effort: Effort) -> Self {
        effort.to_string()
    }
}

/// What is sought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Goal {
    /// l1: lines along the direction are stretched by 1 + l1.
    Stretch {
        /// Direction of the pull, degrees counter-clockwise from x.
        direction_deg: f64,
        /// Stretch − 1 across it, where it is held.
        l2: f64,
        /// Whether width and shear are held or left to the sheet.
        #[serde(default)]
        across: Across,
    },
    /// One Green strain.
    Strain {
        /// Which.
        component: Strain,
        /// Direction of the strains' x axis, in degrees.
        direction_deg: f64,
        /// Strains that are held.
        fix: Vec<(Strain, f64)>,
        /// Strains that are left to the sheet; those that are neither are held at 0.
        free: Vec<Strain>,
    },
    /// The distance from the written lattice along a ray in the space of Green strains.
    Ray {
        /// Unit vector (E_xx, E_yy, E_xy).
        direction: [f64; 3],
    },
    /// All minor radii, in the proportions of the design: the thickest wire with which the weave exists.
    Wire {
        /// Whether the lattice may change.
        lattice_free: bool,
    },
    /// The smallest gap between the tori of two rings.
    Clearance {
        /// Whether the lattice may change.
        lattice_free: bool,
    },
    /// The area of the cell, as a share of the written one, with every gap between rings of different elements at least `min_gap`; the
    /// lattice is free. Only its least value can be asked for.
    Area {
        /// The gap, in the design's unit.
        min_gap: f64,
    },
    /// κ of a sheet that is rolled about an axis across the direction: its turn for each unit of the written length along it, in
    /// 1/R. The largest is that with the axis below the sheet, at negative z; the least, which is negative, has it above. The length along
    /// the direction is free in any case: see `docs/theory/roll.md`.
    Curvature {
        /// Direction that is rolled, in degrees.
        direction_deg: f64,
        /// What is held of the strains along the axis.
        #[serde(default)]
        strains: RollStrains,
    },
    /// Something of a sheet whose turn is given: a closed tube, or a sheet of given curvature. The length along the direction is free. See
    /// `docs/theory/roll.md`.
    Rolled {
        /// Direction that is rolled, in degrees.
        direction_deg: f64,
        /// Whether the axis lies above the written sheet, not below.
        above: bool,
        /// How far it is rolled.
        turn: Turn,
        /// What is held of the strains along the axis. Of a closed tube the shear is 0.
        #[serde(default)]
        strains: RollStrains,
        /// What is sought.
        sought: OfRolled,
    },
}

/// Which end of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sense {
    /// As large as can be.
    #[default]
    Largest,
    /// As small as can be.
    Least,
}

impl Sense {
    /// 1 for the largest value, −1 for the least.
    pub fn sign(self) -> f64 {
        if self == Sense::Largest { 1.0 } else { -1.0 }
    }

    /// `largest` or `least`.
    pub fn name(self) -> &'static str {
        if self == Sense::Largest { "largest" } else { "least" }
    }
}

fn usual_seed() -> u64 {
    1
}

impl Question {
    /// A question with the usual search.
    pub fn new(goal: Goal, sense: Sense) -> Self {
        Question { goal, sense, effort: Effort::Normal, starts: None, seed: usual_seed() }
    }

    /// How far the sheet stretches along a direction, in degrees, with its width held and no shear.
    pub fn stretch_along(direction_deg: f64) -> Self {
        Question::new(Goal::Stretch { direction_deg, l2: 0.0, across: Across::HELD }, Sense::Largest)
    }

    /// The thickest wire with which the weave exists, its lattice free.
    pub fn thickest_wire() -> Self {
        Question::new(Goal::Wire { lattice_free: true }, Sense::Largest)
    }

    /// The state in which the smallest gap is largest, its lattice held.
    pub fn largest_clearance() -> Self {
        Question::new(Goal::Clearance { lattice_free: false }, Sense::Largest)
    }

    /// The closest cell: the least area in which every gap is at least `min_gap`, in the design's unit.
    pub fn closest_cell(min_gap: f64) -> Self {
        Question::new(Goal::Area { min_gap }, Sense::Least)
    }

    /// How tightly the sheet can be rolled along a direction, in degrees, with its width held and no shear: with the axis below it,
    /// or above it where the sign is negative.
    pub fn curvature_along(direction_deg: f64, sign: f64) -> Self {
        let sense = if sign < 0.0 { Sense::Least } else { Sense::Largest };
        Question::new(Goal::Curvature { direction_deg, strains: RollStrains::default() }, sense)
    }

    /// The same stretch with the width held at 1 + l2 times the written one. Other goals stay as they are.
    pub fn with_lateral(mut self, lateral: f64) -> Self {
        if let Goal::Stretch { l2, across, .. } = &mut self.goal {
            (*l2, across.lateral_free) = (lateral, false);
        }
        self
    }

    /// The same roll with what is held of the strains along the axis. Other goals stay as they are.
    pub fn with_strains(mut self, strains: RollStrains) -> Self {
        if let Goal::Curvature { strains: known, .. } | Goal::Rolled { strains: known, .. } = &mut self.goal {
            *known = strains;
        }
        self
    }

    /// The same stretch or roll with the width, or the shear, or both left to the sheet, and held as written where not. Other goals stay as
    /// they are.
    pub fn with_free(mut self, free: Across) -> Self {
        if let Goal::Curvature { strains, .. } | Goal::Rolled { strains, .. } = &mut self.goal {
            *strains = RollStrains::free(free);
        }
        if let Goal::Stretch { l2, across, .. } = &mut self.goal {
            *l2 = if free.lateral_free { 0.0 } else { *l2 };
            *across = free;
        }
        self
    }

    /// The same with the least value in place of the largest.
    pub fn least(self) -> Self {
        Question { sense: Sense::Least, ..self }
    }

    /// Whether it can be asked.
    ///
    /// # Errors
    /// Without starts; for a number that is not finite, a direction or l2 beyond a million, an l2 of −1 or less, a strain that is named twice,
    /// strains that no lattice has, a roll whose turn or strains cannot be, a ray whose direction is no unit vector, for the least wire or
    /// clearance, which nothing bounds, for the largest area, and for a gap below 0.
    pub fn check(&self) -> Result<(), InvalidInput> {
        if self.starts == Some(0) {
            return Err(InvalidInput::new("starts", "0 starts find nothing", "give 1 or more"));
        }
        match &self.goal {
            Goal::Stretch { direction_deg, l2, .. } => {
                within("direction_deg", "direction", *direction_deg)?;
                width(*l2)?;
            }
            Goal::Strain { direction_deg, fix, .. } => {
                within("direction_deg", "direction", *direction_deg)?;
                fix.iter().try_for_each(|(_, value)| finite("fix", *value))?;
            }
            Goal::Ray { direction } => {
                direction.iter().try_for_each(|x| finite("direction", *x))?;
                let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
                if (length - 1.0).abs() > 1e-9 {
                    let problem = format!("a direction of length {length}");
                    return Err(InvalidInput::new("direction", problem, "give a unit vector"));
                }
            }
            Goal::Curvature { direction_deg, strains } => {
                within("direction_deg", "direction", *direction_deg)?;
                strains.check()?;
            }
            Goal::Rolled { direction_deg, turn, strains, sought, .. } => {
                within("direction_deg", "direction", *direction_deg)?;
                strains.check()?;
                turn.check(strains)?;
                if *sought == OfRolled::Length && !strains.free.lateral_free {
                    let problem = "the length along the axis is held, so it has no range";
                    return Err(InvalidInput::new("sought", problem, "leave the width free"));
                }
            }
            Goal::Wire { .. } | Goal::Clearance { .. } if self.sense == Sense::Least => {
                return Err(InvalidInput::new("sense", "nothing bounds it from below", "ask for the largest"));
            }
            Goal::Wire { .. } | Goal::Clearance { .. } => {}
            Goal::Area { min_gap } => {
                finite("min_gap", *min_gap)?;
                if *min_gap < 0.0 {
                    let problem = format!("a gap of {min_gap} is an overlap");
                    return Err(InvalidInput::new("min_gap", problem, "give 0 or more"));
                }
                if self.sense == Sense::Largest {
                    let help = "ask for the least";
                    return Err(InvalidInput::new("sense", "the largest area is not sought", help));
                }
            }
        }
        self.strain_query().map(drop)
    }

    /// Whether it has a meaning for the sheet of `model`: of a chain only its length and bending along it can be asked.
    ///
    /// # Errors
    /// For a chain: another direction, a width or a shear that is not 0 or that is left free, and the area.
    pub fn suits(&self, model: &Model) -> Result<(), InvalidInput> {
        if !model.single {
            return Ok(());
        }
        let along = model.cell.primitive(model.start.a1, model.start.a2)[0].xy().normalize();
        let is_along = |direction_deg: f64| Direction::of_degrees(direction_deg).along().perp(&along).abs() < 1e-9;
        let right = match &self.goal {
            Goal::Stretch { direction_deg, l2, across } => {
                is_along(*direction_deg) && *l2 == 0.0 && *across == Across::HELD
            }
            Goal::Curvature { direction_deg, strains } | Goal::Rolled { direction_deg, strains, .. } => {
                is_along(*direction_deg) && *strains == RollStrains::default()
            }
            Goal::Strain { component, direction_deg, fix, free } => {
                let turn_deg = match component {
                    Strain::Exx => 0.0,
                    Strain::Eyy => 90.0,
                    Strain::Exy => f64::NAN,
                };
                is_along(direction_deg + turn_deg) && free.is_empty() && fix.iter().all(|(_, value)| *value == 0.0)
            }
            Goal::Ray { .. } | Goal::Area { .. } => false,
            Goal::Wire { .. } | Goal::Clearance { .. } => true,
        };
        match right {
            true => Ok(()),
            false => {
                let direction_deg = along.y.atan2(along.x).to_degrees();
                let problem = format!("{} is a chain: it has no width and no shear", model.name);
                let help = format!("ask along {direction_deg}\u{b0}, with nothing free and nothing held but at 0");
                Err(InvalidInput::new("direction_deg", problem, help))
            }
        }
    }

    /// The question in the space of Green strains; `None` for goals that are no strains.
    ///
    /// # Errors
    /// Where a strain is named twice, or no lattice has the strains that are held.
    #[doc(hidden)]
    pub fn strain_query(&self) -> Result<Option<StrainQuery>, InvalidInput> {
        match &self.goal {
            Goal::Strain { component, direction_deg, fix, free } => {
                let x = Direction::of_degrees(*direction_deg);
                StrainQuery::of(*component, self.sense.sign(), fix, free, x).map(Some)
            }
            Goal::Ray { direction: [xx, yy, xy] } => {
                let along = Matrix2::new(*xx, *xy, *xy, *yy) * self.sense.sign();
                Ok(Some(StrainQuery { held: Matrix2::zeros(), free: vec![along] }))
            }
            Goal::Stretch { .. }
            | Goal::Wire { .. }
            | Goal::Clearance { .. }
            | Goal::Area { .. }
            | Goal::Curvature { .. }
            | Goal::Rolled { .. } => Ok(None),
        }
    }

    /// The stretch that asks the same as a question on a normal strain, if one does: with the other normal strain held and no
    /// shear, or with the width free, with or without the shear. E_DD = l1 + l1²/2 grows with l1, so their extremes are the same.
    /// With the width held and the shear free a stretch holds the distance across the direction, and not a strain.
    #[doc(hidden)]
    pub fn as_stretch(&self) -> Option<Question> {
        let Goal::Strain { component, direction_deg, fix, free } = &self.goal else { return None };
        let (side, turn_deg) = match component {
            Strain::Exx => (Strain::Eyy, 0.0),
            Strain::Eyy => (Strain::Exx, 90.0),
            Strain::Exy => return None,
        };
        let held = |strain: Strain| fix.iter().find(|(named, _)| *named == strain).map_or(0.0, |(_, value)| *value);
        let across = Across { lateral_free: free.contains(&side), shear_free: free.contains(&Strain::Exy) };
        if held(Strain::Exy) != 0.0 || !across.lateral_free && across.shear_free {
            return None;
        }
        let l2 = if across.lateral_free { 0.0 } else { (1.0 + 2.0 * held(side)).sqrt() - 1.0 };
        if l2 > MOST {
            return None;
        }
        let goal = Goal::Stretch { direction_deg: (direction_deg + turn_deg).rem_euclid(360.0), l2, across };
        Some(Question { goal, ..self.clone() })
    }
}

/// A line or a plane or all of the space of strains, and the end of it that is sought.
#[doc(hidden)]
#[derive(Clone, Debug, PartialEq)]
pub struct StrainQuery {
    /// What is held: E where all parameters are 0.
    pub held: Matrix2<f64>,
    /// Rates of E with the parameters, orthogonal to each other; the first parameter is maximised.
    pub free: Vec<Matrix2<f64>>,
}

/// A component of E.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Strain {
    /// Along x.
    Exx,
    /// Along y.
    Eyy,
    /// The tensor shear.
    Exy,
}

impl Strain {
    /// All of them.
    pub const ALL: [Strain; 3] = [Strain::Exx, Strain::Eyy, Strain::Exy];

    /// `exx`, `eyy` or `exy`.
    pub fn name(self) -> &'static str {
        ["exx", "eyy", "exy"][self as usize]
    }

    /// E where this component is 1 and the others are 0, with x along a direction.
    #[doc(hidden)]
    pub fn unit(self, direction: Direction) -> Matrix2<f64> {
        let (x, y) = (direction.along(), direction.across());
        match self {
            Strain::Exx => x * x.transpose(),
            Strain::Eyy => y * y.transpose(),
            Strain::Exy => x * y.transpose() + y * x.transpose(),
        }
    }

    /// This component of E, with x along a direction.
    pub fn of(self, e: &Matrix2<f64>, direction: Direction) -> f64 {
        let (x, y) = (direction.along(), direction.across());
        let (a, b) = [(x, x), (y, y), (x, y)][self as usize];
        a.dot(&(e * b))
    }
}

impl StrainQuery {
    /// The largest (`sign` 1) or least (−1) value of `goal`, with the strains of `fix` held, those of `free` left to the sheet,
    /// and the others held at 0, x along `direction`. Refused where a strain is named twice or no lattice has what is held.
    pub fn of(
        goal: Strain,
        sign: f64,
        fix: &[(Strain, f64)],
        free: &[Strain],
        direction: Direction,
    ) -> Result<Self, InvalidInput> {
        let mut named = vec![goal];
        for strain in fix.iter().map(|(strain, _)| *strain).chain(free.iter().copied()) {
            if named.contains(&strain) {
                let problem = format!("{} is named twice", strain.name());
                let help = "a strain is sought, held, or left to the sheet: name it once";
                return Err(InvalidInput::new("fix", problem, help));
            }
            named.push(strain);
        }
        let held = fix.iter().map(|(strain, value)| strain.unit(direction) * *value).sum::<Matrix2<f64>>();
        if factor(&(Matrix2::identity() + held * 2.0)).is_none() {
            let help = "a strain of -0.5 is a length of 0; take larger values, or a smaller exy";
            return Err(InvalidInput::new("fix", "no lattice has the strains that are held", help));
        }
        let rest = free.iter().map(|strain| strain.unit(direction));
        Ok(StrainQuery { held, free: std::iter::once(goal.unit(direction) * sign).chain(rest).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn efforts_read_back() {
        for text in ["low", "normal", "thorough", "30s", "0.5s"] {
            assert_eq!(text.parse::<Effort>().unwrap().to_string(), text);
        }
        for text in ["", "high", "30", "0s", "-1s", "NaNs", "infs", "1e9s"] {
            assert!(text.parse::<Effort>().is_err(), "{text}");
        }
    }
}
