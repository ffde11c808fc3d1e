//! How a fit searches.

use crate::{question::Effort, survey::CellChoice};
use maille_design::InvalidInput;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// What of the misses is made small.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Norm {
    /// The sum of the squares of weight × miss.
    #[default]
    LeastSquares,
    /// The largest weight × |miss|.
    Minimax,
}

impl Norm {
    /// Of the weighted misses.
    pub(super) fn of(self, misses: &DVector<f64>) -> f64 {
        match self {
            Norm::LeastSquares => misses.norm_squared(),
            Norm::Minimax => misses.amax(),
        }
    }
}

/// How a fit searches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitOptions {
    /// What is made small.
    pub norm: Norm,
    /// Starts, the first of them the given design.
    pub starts: usize,
    /// Seed of the starts that are drawn, and of the search of each limit.
    pub seed: u64,
    /// Every miss at most this ends the fit.
    pub tolerance: f64,
    /// Designs that are solved from one start, at most.
    pub designs: usize,
    /// The cells of each limit.
    pub cells: CellChoice,
    /// How long each limit is searched on the way.
    pub effort: Effort,
}

impl Default for FitOptions {
    fn default() -> Self {
        let (cells, effort) = (CellChoice::Auto, Effort::Low);
        FitOptions { norm: Norm::default(), starts: 8, seed: 1, tolerance: 1e-6, designs: 60, cells, effort }
    }
}

impl FitOptions {
    /// How long the limits of the given design and of the result are searched in the end: at least with normal effort.
    pub fn final_effort(&self) -> Effort {
        if self.effort == Effort::Low { Effort::Normal } else { self.effort }
    }

    /// Whether a fit can search so.
    pub(super) fn check(&self) -> Result<(), InvalidInput> {
        if self.starts == 0 || self.designs == 0 {
            return Err(InvalidInput::new("starts", "without starts or designs nothing is found", "give 1 or more"));
        }
        if !(self.tolerance.is_finite() && self.tolerance > 0.0) {
            let problem = format!("{} is no tolerance", self.tolerance);
            return Err(InvalidInput::new("tolerance", problem, "give a number above 0"));
        }
        Ok(())
    }
}
