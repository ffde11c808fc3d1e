//! The derivatives of what a design's targets measure, by the shares of its free numbers.
//!
//! Those of a limit follow from its forces. The width of a limit is an unknown of it, and the forces do not tell how that changes with the
//! design. So for a Poisson ratio each number is moved a little to both sides, and the limit is solved again from its own state.

use super::{
    search::{Measured, Point, Search, Solved},
    target::{Measure, Target, poisson_ratio},
};
use crate::{
    answer::Answer,
    error::InvalidInput,
    sensitivity::{self, DesignVector},
    sheet::Sheet,
};
use nalgebra::DMatrix;

/// How far a number is moved for a Poisson ratio, as a share of its range.
const STEP: f64 = 1e-3;

impl Search<'_> {
    /// The point with the derivatives of its deviations by the shares.
    ///
    /// # Errors
    /// Where the design or an answer has none.
    pub fn with_slopes(&self, point: Point) -> Result<Solved, InvalidInput> {
        let rates = self.family.rates(&self.values(&point.shares))?;
        let mut slopes = DMatrix::zeros(point.values.len(), rates.len());
        for (k, target) in self.targets.iter().enumerate() {
            let along = match &point.measured {
                Measured::Limits { answers, .. } if matches!(target.measure, Measure::PoissonRatio { .. }) => {
                    self.slopes_of_poisson_ratio(target, &point, &answers[k])?
                }
                Measured::Limits { sheet, answers } => self.slopes_of_limit(target, sheet, &answers[k], &rates)?,
                Measured::Bounds(slopes) => rates.iter().map(|rate| slopes[k].dot(rate)).collect(),
            };
            slopes.row_mut(k).copy_from_slice(&along);
        }
        let slopes = self.targets.deviation_slopes(&point.values, &slopes);
        Ok(Solved { point, slopes })
    }

    fn slopes_of_limit(
        &self,
        target: &Target,
        sheet: &Sheet,
        answer: &Answer,
        rates: &[DesignVector],
    ) -> Result<Vec<f64>, InvalidInput> {
        let model = sheet.model_of(answer);
        let mut along = sensitivity::gradient(&model, &self.question(target), answer, rates)?;
        // The derivative of a clearance is one of a length in the design's unit.
        if target.measure == Measure::Clearance {
            along.iter_mut().for_each(|x| *x /= model.unit);
        }
        Ok(along)
    }

    /// A side beyond the range counts, too: it is only solved, never taken.
    fn slopes_of_poisson_ratio(
        &self,
        target: &Target,
        point: &Point,
        answer: &Answer,
    ) -> Result<Vec<f64>, InvalidInput> {
        let question = self.question(target);
        let none = || {
            let problem =
                "a limit beside a design was not found from its state, so its Poisson ratio has no derivative";
            InvalidInput::new("targets", problem, "begin with another design, or leave the Poisson ratio out")
        };
        let beside = |number: usize, step: f64| {
            let mut shares = point.shares.clone();
            shares[number] += step;
            let design = self.design(&shares).ok()?;
            let sheet = Sheet::in_cells(&design, self.options.cells.clone()).ok()?;
            sheet.strains_near(&question, answer, self.cancel).map(poisson_ratio)
        };
        let slope = |number: usize| Some((beside(number, STEP)? - beside(number, -STEP)?) / (2.0 * STEP));
        (0..point.shares.len()).map(|number| slope(number).ok_or_else(none)).collect()
    }
}
