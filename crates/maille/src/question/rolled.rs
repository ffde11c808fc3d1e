//! What is asked of a sheet that is rolled.

use super::number::{width, within};
use crate::lattice::Across;
use maille_design::InvalidInput;
use serde::{Deserialize, Serialize};

/// How far a sheet is rolled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Turn {
    /// So many of the shortest lattice vectors along the direction go once round.
    Cells(u32),
    /// |κ|, the turn for each unit of the written length along the direction, in 1/R.
    Curvature(f64),
}

/// |κ| R is from this to that: below, a sheet is flat to rounding.
const LEAST: f64 = 1e-6;
const MOST: f64 = 1e3;

impl Turn {
    pub(super) fn check(&self, strains: &RollStrains) -> Result<(), InvalidInput> {
        match *self {
            Turn::Cells(cells) if cells < 2 => {
                let help = "give 2 or more cells";
                Err(InvalidInput::new("cells", format!("{cells} cells do not go round"), help))
            }
            Turn::Cells(_) if strains.free.shear_free || strains.shear != 0.0 => {
                let problem = "a tube's shear is 0, or it would not close";
                Err(InvalidInput::new("strains", problem, "take a curvature in place of cells"))
            }
            Turn::Curvature(curvature) if !(LEAST..=MOST).contains(&curvature) => {
                let problem = format!("the curvature times R is {curvature:e}");
                let help = format!(
                    "give a curvature with which it is {LEAST} to {MOST}; the side of the axis is asked apart from it"
                );
                Err(InvalidInput::new("curvature", problem, help))
            }
            _ => Ok(()),
        }
    }
}

/// What is sought of a sheet whose turn is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OfRolled {
    /// The smallest gap between the tori of two rings. Only its largest value can be asked for.
    Gap,
    /// The length along the axis, as l2, where it is free.
    Length,
    /// The radius of the neutral surface, at the mean distance of the elements from the axis. With κ it gives the stretch around the axis.
    Radius,
}

/// Strains of a rolled sheet along its axis: F = (1 + l1) u uᵀ + (1 + l2) w wᵀ + γ w uᵀ, u along the direction that is rolled and w along
/// the axis. l1 is free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RollStrains {
    /// Which of them are left to the sheet.
    pub free: Across,
    /// l2 where it is held.
    #[serde(skip_serializing_if = "is_zero")]
    pub l2: f64,
    /// γ where it is held.
    #[serde(skip_serializing_if = "is_zero")]
    pub shear: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

impl RollStrains {
    /// Those of a closed tube: its length is free.
    pub const OF_TUBE: Self =
        RollStrains { free: Across { lateral_free: true, shear_free: false }, l2: 0.0, shear: 0.0 };

    /// What is left to the sheet, and nothing held but at 0.
    pub fn free(free: Across) -> Self {
        RollStrains { free, ..Self::default() }
    }

    /// Whether they can be asked.
    pub(super) fn check(&self) -> Result<(), InvalidInput> {
        width(self.l2)?;
        within("shear", "shear", self.shear)?;
        let Across { lateral_free, shear_free } = self.free;
        for (field, what, value, free) in
            [("l2", "width", self.l2, lateral_free), ("shear", "shear", self.shear, shear_free)]
        {
            if free && value != 0.0 {
                let problem = format!("{field} = {value} is given, and the {what} is left to the sheet");
                return Err(InvalidInput::new(field, problem, "leave one of them out"));
            }
        }
        Ok(())
    }
}
