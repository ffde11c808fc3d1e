//! The derivatives of what a design's targets measure, by the shares of its free numbers.
//!
//! Those of a limit follow from its forces. The width of a limit is an unknown of it, and the forces do not tell how that changes with the
//! design. So for a Poisson ratio each number is moved a little to both sides, and the limit is solved again from its own state.

use super::{
    search::{Measured, Point, Search, Solved},
    target::{Measure, Target, poisson_ratio, strains},
};
use crate::{
    answer::Answer,
    sensitivity::{self, DesignVector},
    sheet::Sheet,
};
use maille_design::InvalidInput;
use nalgebra::DMatrix;

/// How far a number is moved for a Poisson ratio, as a share of its range.
const STEP: f64 = 1e-3;
/// A strain that differs by more over this step is that of another state.
const JUMP: f64 = 0.02;

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

    /// By the limits a little to both sides within the range; to one side where the other has no limit near that of the point.
    fn slopes_of_poisson_ratio(
        &self,
        target: &Target,
        point: &Point,
        answer: &Answer,
    ) -> Result<Vec<f64>, InvalidInput> {
        let question = self.question(target);
        let here = match target.measure {
            Measure::PoissonRatio { direction_deg } => strains(direction_deg, answer),
            Measure::Stretch { .. } | Measure::Clearance => unreachable!("a Poisson ratio"),
        };
        let beside = |number: usize, step: f64| -> Option<[f64; 2]> {
            let mut shares = point.shares.clone();
            shares[number] = (shares[number] + step).clamp(0.0, 1.0);
            let moved = shares[number] - point.shares[number];
            let design = self.design(&shares).ok().filter(|_| moved != 0.0)?;
            let sheet = Sheet::in_cells(&design, self.options.cells.clone()).ok()?;
            let there = sheet.strains_near(&question, answer, self.cancel)?;
            let near = there.iter().zip(here).all(|(there, here)| (there - here).abs() < JUMP);
            near.then(|| [moved, poisson_ratio(there)])
        };
        let none = || {
            let problem =
                "a limit beside a design was not found from its state, so its Poisson ratio has no derivative";
            InvalidInput::new("targets", problem, "begin with another design, or leave the Poisson ratio out")
        };
        let slope = |number: usize| {
            let own = [0.0, poisson_ratio(here)];
            let [back, ahead] = [-STEP, STEP].map(|step| beside(number, step));
            let ends = [back.unwrap_or(own), ahead.unwrap_or(own)];
            let apart = ends[1][0] - ends[0][0];
            (apart > 0.0).then(|| (ends[1][1] - ends[0][1]) / apart).ok_or_else(none)
        };
        (0..point.shares.len()).map(slope).collect()
    }
}
