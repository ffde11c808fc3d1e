//! What a fit is to reach: limits along directions.

use crate::{error::InvalidInput, question::Question};
use nalgebra::{DMatrix, DVector};

/// One limit that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Direction of the pull, degrees counter-clockwise from x.
    pub direction_deg: f64,
    /// Stretch − 1 that is held across it.
    pub l2: f64,
    /// What l1 is to be.
    pub wanted: Wanted,
    /// How much it counts beside the others; positive.
    pub weight: f64,
}

/// What l1 is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// This value.
    Value(f64),
    /// This value or more.
    AtLeast(f64),
    /// This value or less.
    AtMost(f64),
}

impl Target {
    /// The limit that it speaks of, with the usual search.
    pub fn question(&self) -> Question {
        Question::stretch_along(self.direction_deg).with_lateral(self.l2)
    }

    /// How far l1 is from what is wanted: 0 where it is reached, above 0 where l1 is too large.
    pub fn miss(&self, l1: f64) -> f64 {
        match self.wanted {
            Wanted::Value(value) => l1 - value,
            Wanted::AtLeast(value) => (l1 - value).min(0.0),
            Wanted::AtMost(value) => (l1 - value).max(0.0),
        }
    }

    /// The number of what is wanted.
    pub fn value(&self) -> f64 {
        let (Wanted::Value(value) | Wanted::AtLeast(value) | Wanted::AtMost(value)) = self.wanted;
        value
    }
}

/// The targets of a fit, at least one.
#[derive(Clone, Debug)]
pub struct Targets {
    all: Vec<Target>,
    shape: bool,
}

impl Targets {
    /// Targets for the limits themselves. With `shape`, only their proportions count: the values may be multiplied by a common
    /// factor s > 0, which is fitted, too.
    ///
    /// # Errors
    /// Where there is none, a number is not finite or out of range, a weight is not positive, or a shape is wanted of least or largest values,
    /// of values below 0, or of zeros alone.
    pub fn new(all: Vec<Target>, shape: bool) -> Result<Self, InvalidInput> {
        if all.is_empty() {
            return Err(InvalidInput::new("targets", "there is none", "give one or more limits"));
        }
        for target in &all {
            target.question().check()?;
            if !target.value().is_finite() {
                let problem = format!("{} is not a number", target.value());
                return Err(InvalidInput::new("targets", problem, "give a finite number"));
            }
            if !(target.weight.is_finite() && target.weight > 0.0) {
                let problem = format!("{} is not a weight", target.weight);
                return Err(InvalidInput::new("weight", problem, "give a number above 0"));
            }
            if shape && !matches!(target.wanted, Wanted::Value(value) if value >= 0.0) {
                let problem = "a shape has no least or largest limits, and none below 0";
                return Err(InvalidInput::new("targets", problem, "give values of 0 or more, or leave the shape out"));
            }
        }
        if shape && all.iter().all(|target| target.value() == 0.0) {
            return Err(InvalidInput::new("targets", "a shape of zeros alone", "give values above 0"));
        }
        Ok(Targets { all, shape })
    }

    /// Each of them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Target> {
        self.all.iter()
    }

    /// The common factor s of the values: 1, or for a shape the best one, s = Σ w² v l / Σ w² v².
    pub fn factor(&self, l1: &[f64]) -> f64 {
        if !self.shape {
            return 1.0;
        }
        let products = self.all.iter().zip(l1).map(|(t, l)| t.weight.powi(2) * t.value() * l).sum::<f64>();
        products / self.squares()
    }

    /// Σ w² v².
    fn squares(&self) -> f64 {
        self.all.iter().map(|t| (t.weight * t.value()).powi(2)).sum()
    }

    /// How far each limit is from what is wanted, in units of l1; of a shape, l1/s − v. `None` where a shape has no factor above 0.
    pub fn misses(&self, l1: &[f64]) -> Option<Vec<f64>> {
        let s = self.factor(l1);
        (s > 0.0).then(|| self.all.iter().zip(l1).map(|(target, l)| target.miss(l / s)).collect())
    }

    /// The misses times their weights: the residuals of the least squares.
    pub(super) fn residuals(&self, misses: &[f64]) -> DVector<f64> {
        DVector::from_iterator(misses.len(), self.all.iter().zip(misses).map(|(target, miss)| target.weight * miss))
    }

    /// Derivatives of the residuals from those of the limits, which are `slopes` (a row for each limit).
    pub(super) fn residual_slopes(&self, l1: &[f64], slopes: &DMatrix<f64>) -> DMatrix<f64> {
        let s = self.factor(l1);
        let mut out = slopes / s;
        if self.shape {
            let weights = self.all.iter().map(|t| t.weight.powi(2) * t.value() / self.squares());
            let of_factor = DVector::from_iterator(l1.len(), weights).transpose() * slopes;
            for (mut row, l) in out.row_iter_mut().zip(l1) {
                row -= &of_factor * (l / (s * s));
            }
        }
        for ((mut row, target), l) in out.row_iter_mut().zip(&self.all).zip(l1) {
            // A wanted least or largest limit that is kept pulls nothing.
            let counts = matches!(target.wanted, Wanted::Value(_)) || target.miss(*l) != 0.0;
            row *= if counts { target.weight } else { 0.0 };
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(shape: bool) -> Targets {
        let of =
            |(direction_deg, value, weight)| Target { direction_deg, l2: 0.0, wanted: Wanted::Value(value), weight };
        Targets::new([(0.0, 1.0, 1.0), (90.0, 3.0, 2.0), (45.0, 0.5, 0.5)].map(of).to_vec(), shape).unwrap()
    }

    #[test]
    fn slopes_of_residuals_are_their_derivatives() {
        let slopes = DMatrix::from_row_slice(3, 2, &[0.3, -0.2, 0.7, 0.1, -0.4, 0.9]);
        let l1 = [0.4, 0.9, 0.3];
        for shape in [false, true] {
            let targets = targets(shape);
            let at = |x: [f64; 2]| {
                let moved = DVector::from_row_slice(&l1) + &slopes * DVector::from_row_slice(&x);
                targets.residuals(&targets.misses(moved.as_slice()).unwrap())
            };
            let exact = targets.residual_slopes(&l1, &slopes);
            for k in 0..2 {
                let step = |h: f64| std::array::from_fn(|j| if j == k { h } else { 0.0 });
                let numeric = (at(step(1e-6)) - at(step(-1e-6))) / 2e-6;
                assert!((exact.column(k) - numeric).norm() < 1e-8, "shape {shape}, number {k}");
            }
        }
    }

    #[test]
    fn a_shape_fits_every_multiple_of_itself() {
        let targets = targets(true);
        let worst = |l1: [f64; 3]| targets.misses(&l1).map(|all| all.into_iter().map(f64::abs).fold(0.0, f64::max));
        assert!(worst([0.2, 0.6, 0.1]).unwrap() < 1e-15);
        assert!(worst([0.2, 0.6, 0.2]).unwrap() > 0.1);
        assert!(worst([0.0, -0.1, 0.0]).is_none());
    }

    #[test]
    fn kept_sides_pull_nothing() {
        let target = |wanted| Target { direction_deg: 0.0, l2: 0.0, wanted, weight: 1.0 };
        assert_eq!(target(Wanted::AtLeast(0.2)).miss(0.3), 0.0);
        assert!((target(Wanted::AtLeast(0.2)).miss(0.1) + 0.1).abs() < 1e-15);
        assert_eq!(target(Wanted::AtMost(0.2)).miss(0.1), 0.0);
        let slopes = DMatrix::from_element(1, 1, 2.0);
        let kept = Targets::new(vec![target(Wanted::AtMost(0.2))], false).unwrap();
        assert_eq!(kept.residual_slopes(&[0.1], &slopes)[(0, 0)], 0.0);
        assert_eq!(kept.residual_slopes(&[0.3], &slopes)[(0, 0)], 2.0);
    }

    #[test]
    fn wrong_targets_are_refused() {
        let target = Target { direction_deg: 0.0, l2: 0.0, wanted: Wanted::Value(0.1), weight: 1.0 };
        assert!(Targets::new(Vec::new(), false).is_err());
        for wrong in [
            Target { weight: 0.0, ..target },
            Target { l2: -1.0, ..target },
            Target { direction_deg: f64::NAN, ..target },
            Target { wanted: Wanted::Value(f64::INFINITY), ..target },
        ] {
            assert!(Targets::new(vec![wrong], false).is_err(), "{wrong:?}");
        }
        assert!(Targets::new(vec![Target { wanted: Wanted::AtLeast(0.1), ..target }], true).is_err());
        assert!(Targets::new(vec![Target { wanted: Wanted::Value(0.0), ..target }], true).is_err());
    }
}
