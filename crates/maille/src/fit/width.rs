//! Derivatives of Poisson ratios.
//!
//! The width of a limit is an unknown of it, and the forces do not tell how that changes with the design. So each number is moved a little to
//! both sides, and the limit is solved again from its own state.

use super::{
    search::{Point, Search},
    target::{Target, poisson_ratio},
};
use crate::{answer::Answer, error::InvalidInput, sheet::Sheet};

/// How far each number is moved, as a share of its range.
const STEP: f64 = 1e-3;

/// By the share of each free number. A side beyond the range counts, too: it is only solved, never taken.
///
/// # Errors
/// Where a limit beside the point is not found from its state.
pub(super) fn slopes_of_poisson_ratio(
    search: &Search<'_>,
    point: &Point,
    answer: &Answer,
    target: &Target,
) -> Result<Vec<f64>, InvalidInput> {
    let question = search.question(target);
    let none = || {
        let problem = "a limit beside a design was not found from its state, so its Poisson ratio has no derivative";
        InvalidInput::new("targets", problem, "begin with another design, or leave the Poisson ratio out")
    };
    let beside = |number: usize, step: f64| {
        let mut shares = point.shares.clone();
        shares[number] += step;
        let design = search.design(&shares).ok()?;
        let sheet = Sheet::in_cells(&design, search.options.cells.clone()).ok()?;
        sheet.strains_near(&question, answer, search.cancel).map(poisson_ratio)
    };
    let slope = |number: usize| Some((beside(number, STEP)? - beside(number, -STEP)?) / (2.0 * STEP));
    (0..point.shares.len()).map(|number| slope(number).ok_or_else(none)).collect()
}
