//! How a fit searches.

use crate::{question::Effort, survey::CellChoice};

/// How a fit searches.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// Starts, the first of them the given design.
    pub starts: usize,
    /// Seed of the starts that are drawn, and of the search of each limit.
    pub seed: u64,
    /// Every miss at most this, in units of l1, ends the fit.
    pub tolerance: f64,
    /// Designs that are solved from one start, at most.
    pub designs: usize,
    /// The cells of each limit.
    pub cells: CellChoice,
    /// How long each limit is searched.
    pub effort: Effort,
}

impl Default for FitOptions {
    fn default() -> Self {
        let (cells, effort) = (CellChoice::Auto, Effort::Normal);
        FitOptions { starts: 8, seed: 1, tolerance: 1e-6, designs: 60, cells, effort }
    }
}
