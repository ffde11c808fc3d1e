//! What a fit is to reach: limits along directions, Poisson ratios, and the widest gap.

use crate::{
    answer::Answer,
    lattice::{Across, Direction},
    question::{Goal, Question, Sense},
};
use maille_design::InvalidInput;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// One value that is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// What is measured.
    pub measure: Measure,
    /// What it is to be.
    pub wanted: Wanted,
    /// How much it counts beside the others; positive.
    pub weight: f64,
}

/// What is measured of a design.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Measure {
    /// l1: the limit of the stretch along a direction, minus 1.
    Stretch {
        /// Direction of the pull, degrees counter-clockwise from x.
        direction_deg: f64,
        /// Stretch − 1 that is held across it.
        l2: f64,
    },
    /// ν = −ln(1 + l2)/ln(1 + l1) in the state of the limit along a direction with the width left to the sheet. Where the limit allows more
    /// than one width, or no stretch, there is none.
    PoissonRatio {
        /// Direction of the pull, degrees counter-clockwise from x.
        direction_deg: f64,
    },
    /// The smallest gap between the rings of different elements, in reference radii, where it is as wide as the lattice of the design
    /// allows: the roomiest state.
    Clearance,
}

/// Widths of a limit, as l2, that differ by less are one. Some 1e-3 of it is what a range of l2 is wider by than the widths of the limit itself.
const ONE_WIDTH: f64 = 0.01;
/// Below this l1 the ratio of the logarithms says nothing.
const LEAST_L1: f64 = 1e-4;

impl Measure {
    /// Its value, as far as the answer has one.
    pub fn value(self, answer: &Answer) -> Option<f64> {
        let limit = answer.limit();
        let Measure::PoissonRatio { direction_deg } = self else { return limit };
        let [least, most] = answer.free?.l2;
        let strains = strains(direction_deg, answer);
        limit
            .filter(|l1| *l1 > LEAST_L1 && strains[1] > -1.0 && most - least < ONE_WIDTH)
            .map(|_| poisson_ratio(strains))
    }
}

/// l1 and l2 in the state of an answer.
pub(super) fn strains(direction_deg: f64, answer: &Answer) -> [f64; 2] {
    let direction = Direction::of_degrees(direction_deg);
    [direction.along(), direction.across()].map(|line| line.dot(&(answer.gradient * line)) - 1.0)
}

/// Of the strains along and across a pull.
pub(super) fn poisson_ratio([l1, l2]: [f64; 2]) -> f64 {
    -l2.ln_1p() / l1.ln_1p()
}

/// What a value is to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wanted {
    /// This value.
    Value(f64),
    /// This value or more.
    AtLeast(f64),
    /// This value or less.
    AtMost(f64),
}

impl Wanted {
    /// Whether values below, and values above, are misses.
    pub(super) fn misses_sides(self) -> [bool; 2] {
        [!matches!(self, Wanted::AtMost(_)), !matches!(self, Wanted::AtLeast(_))]
    }

    /// The part of a deviation that is a miss: 0 where what is wanted is reached.
    pub(super) fn miss(self, deviation: f64) -> f64 {
        let [below, above] = self.misses_sides();
        if (deviation < 0.0 && below) || (deviation > 0.0 && above) { deviation } else { 0.0 }
    }

    /// The number of what is wanted.
    pub fn value(self) -> f64 {
        let (Wanted::Value(value) | Wanted::AtLeast(value) | Wanted::AtMost(value)) = self;
        value
    }
}

impl Target {
    /// The question whose answer is measured, with the usual search.
    pub fn question(&self) -> Question {
        match self.measure {
            Measure::Stretch { direction_deg, l2 } => Question::stretch_along(direction_deg).with_lateral(l2),
            Measure::PoissonRatio { direction_deg } => {
                Question::stretch_along(direction_deg).with_free(Across { lateral_free: true, shear_free: false })
            }
            Measure::Clearance => Question::new(Goal::Clearance { lattice_free: false }, Sense::Largest),
        }
    }

    /// What is measured, in words for errors.
    pub(super) fn words(&self) -> String {
        match self.measure {
            Measure::Stretch { direction_deg, l2 } => format!("the limit along {direction_deg}\u{b0} at l2 {l2}"),
            Measure::PoissonRatio { direction_deg } => format!("the Poisson ratio along {direction_deg}\u{b0}"),
            Measure::Clearance => "the widest gap".into(),
        }
    }

    /// Of a shape only limits have proportions.
    fn is_of_shape(&self) -> bool {
        matches!(self.measure, Measure::Stretch { .. })
    }

    fn check(&self, shape: bool) -> Result<(), InvalidInput> {
        self.question().check()?;
        let wrong = |field: &str, problem: String, help: &str| Err(InvalidInput::new(field, problem, help));
        if !self.wanted.value().is_finite() {
            return wrong("targets", format!("{} is not a number", self.wanted.value()), "give a finite number");
        }
        if !(self.weight.is_finite() && self.weight > 0.0) {
            return wrong("weight", format!("{} is not a weight", self.weight), "give a number above 0");
        }
        if shape && self.is_of_shape() && !matches!(self.wanted, Wanted::Value(value) if value >= 0.0) {
            let problem = "a shape has no least or largest limits, and none below 0".into();
            return wrong("targets", problem, "give values of 0 or more, or leave the shape out");
        }
        Ok(())
    }
}

/// The targets of a fit, at least one.
#[derive(Clone, Debug)]
pub struct Targets {
    all: Vec<Target>,
    shape: bool,
}

impl Targets {
    /// Targets for the values themselves. With `shape`, only the proportions of the limits count: the wanted limits may be multiplied
    /// by a common factor s > 0, which is fitted, too.
    ///
    /// # Errors
    /// Where there is none, a number is not finite or out of range, a weight is not positive, or a shape is wanted of least or largest
    /// limits, of limits below 0, or of zeros alone.
    pub fn new(all: Vec<Target>, shape: bool) -> Result<Self, InvalidInput> {
        if all.is_empty() {
            return Err(InvalidInput::new("targets", "there is none", "give one or more limits"));
        }
        all.iter().try_for_each(|target| target.check(shape))?;
        let out = Targets { all, shape };
        if shape && out.squares() == 0.0 {
            return Err(InvalidInput::new("targets", "a shape of zeros alone", "give limits above 0"));
        }
        Ok(out)
    }

    /// Each of them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Target> {
        self.all.iter()
    }

    /// Whether only the proportions of the limits count.
    pub fn is_shape(&self) -> bool {
        self.shape
    }

    /// The common factor s of the wanted limits: 1, or for a shape the best one, s = Σ w² v l / Σ w² v².
    pub fn factor(&self, values: &[f64]) -> f64 {
        if !self.shape {
            return 1.0;
        }
        let of_shape = self.all.iter().zip(values).filter(|(target, _)| target.is_of_shape());
        of_shape.map(|(t, l)| t.weight.powi(2) * t.wanted.value() * l).sum::<f64>() / self.squares()
    }

    /// Σ w² v² of the limits.
    fn squares(&self) -> f64 {
        let of_shape = self.all.iter().filter(|target| target.is_of_shape());
        of_shape.map(|t| (t.weight * t.wanted.value()).powi(2)).sum()
    }

    /// How far each value is from what is wanted, below 0 where it is smaller, also on the side that is allowed; of a shape l/s − v.
    /// `None` where a shape has no factor above 0.
    pub(super) fn deviations(&self, values: &[f64]) -> Option<Vec<f64>> {
        let s = self.factor(values);
        let by = |target: &Target| if target.is_of_shape() { s } else { 1.0 };
        (s > 0.0).then(|| self.all.iter().zip(values).map(|(t, l)| l / by(t) - t.wanted.value()).collect())
    }

    /// How far each value is from what is wanted: 0 where that is reached.
    pub fn misses(&self, values: &[f64]) -> Option<Vec<f64>> {
        let deviations = self.deviations(values)?;
        Some(self.all.iter().zip(deviations).map(|(target, deviation)| target.wanted.miss(deviation)).collect())
    }

    /// Derivatives of the deviations from those of the values, which are `slopes` (a row for each value).
    pub(super) fn deviation_slopes(&self, values: &[f64], slopes: &DMatrix<f64>) -> DMatrix<f64> {
        if !self.shape {
            return slopes.clone();
        }
        let s = self.factor(values);
        let weights = self.all.iter().map(|t| match t.is_of_shape() {
            true => t.weight.powi(2) * t.wanted.value() / self.squares(),
            false => 0.0,
        });
        let of_factor = DVector::from_iterator(values.len(), weights).transpose() * slopes;
        let mut out = slopes.clone();
        for ((mut row, l), target) in out.row_iter_mut().zip(values).zip(&self.all) {
            if target.is_of_shape() {
                row /= s;
                row -= &of_factor * (l / (s * s));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(direction_deg: f64, wanted: Wanted, weight: f64) -> Target {
        Target { measure: Measure::Stretch { direction_deg, l2: 0.0 }, wanted, weight }
    }

    fn targets(shape: bool) -> Targets {
        let of = |(direction, value, weight)| along(direction, Wanted::Value(value), weight);
        let mut all = [(0.0, 1.0, 1.0), (90.0, 3.0, 2.0), (45.0, 0.5, 0.5)].map(of).to_vec();
        all.push(Target { measure: Measure::Clearance, wanted: Wanted::AtLeast(0.1), weight: 2.0 });
        Targets::new(all, shape).unwrap()
    }

    #[test]
    fn slopes_of_deviations_are_their_derivatives() {
        let slopes = DMatrix::from_row_slice(4, 2, &[0.3, -0.2, 0.7, 0.1, -0.4, 0.9, 0.2, 0.5]);
        let values = [0.4, 0.9, 0.3, 0.05];
        for shape in [false, true] {
            let targets = targets(shape);
            let at = |x: [f64; 2]| {
                let moved = DVector::from_row_slice(&values) + &slopes * DVector::from_row_slice(&x);
                DVector::from_vec(targets.deviations(moved.as_slice()).unwrap())
            };
            let exact = targets.deviation_slopes(&values, &slopes);
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
        let worst = |l: [f64; 4]| targets.misses(&l).map(|all| all.into_iter().map(f64::abs).fold(0.0, f64::max));
        assert!(worst([0.2, 0.6, 0.1, 0.1]).unwrap() < 1e-15);
        assert!(worst([0.2, 0.6, 0.2, 0.1]).unwrap() > 0.1);
        // The gap is wanted itself, at any size of the shape.
        assert!((worst([0.2, 0.6, 0.1, 0.04]).unwrap() - 0.06).abs() < 1e-15);
        assert!(worst([0.0, -0.1, 0.0, 0.1]).is_none());
    }

    #[test]
    fn allowed_sides_are_no_misses() {
        assert_eq!(Wanted::AtLeast(0.2).miss(0.1), 0.0);
        assert_eq!(Wanted::AtLeast(0.2).miss(-0.1), -0.1);
        assert_eq!(Wanted::AtMost(0.2).miss(-0.1), 0.0);
        assert_eq!(Wanted::AtMost(0.2).miss(0.1), 0.1);
        assert_eq!([Wanted::Value(0.2).miss(-0.1), Wanted::Value(0.2).miss(0.1)], [-0.1, 0.1]);
    }

    #[test]
    fn wrong_targets_are_refused() {
        let target = along(0.0, Wanted::Value(0.1), 1.0);
        let stretch = |direction_deg, l2| Measure::Stretch { direction_deg, l2 };
        assert!(Targets::new(Vec::new(), false).is_err());
        for wrong in [
            Target { weight: 0.0, ..target },
            Target { measure: stretch(0.0, -1.0), ..target },
            Target { measure: stretch(f64::NAN, 0.0), ..target },
            Target { wanted: Wanted::Value(f64::INFINITY), ..target },
        ] {
            assert!(Targets::new(vec![wrong], false).is_err(), "{wrong:?}");
        }
        assert!(Targets::new(vec![Target { wanted: Wanted::AtLeast(0.1), ..target }], true).is_err());
        assert!(Targets::new(vec![Target { wanted: Wanted::Value(0.0), ..target }], true).is_err());
    }
}
