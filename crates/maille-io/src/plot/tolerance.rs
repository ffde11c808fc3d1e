//! What tolerances of a design's numbers do to a curve of limits, to first order: a band about it.

use super::curve::{Curve, CurveKind};
use crate::record::SensitivityRow;
use maille::record::LimitRow;

/// A number of the design that may be off by `amount` to both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// As in `sensitivities.csv`.
    pub number: String,
    /// In the number's unit.
    pub amount: f64,
}

/// The least and the largest value of a curve where a number is off.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// l2 of the curve.
    pub l2: f64,
    /// The inner edge.
    pub low: Curve,
    /// The outer edge.
    pub high: Curve,
}

impl Tolerance {
    /// Least and largest change of a limit: the tolerance to both sides, and none.
    fn changes(&self, row: &SensitivityRow) -> Option<[f64; 2]> {
        let changes = [row.derivative? * self.amount, -row.derivative_back? * self.amount];
        Some([changes.iter().copied().fold(0.0, f64::min), changes.iter().copied().fold(0.0, f64::max)])
    }

    /// The band of the rows of one l2, whose limits stand at `value`.
    pub(super) fn band(
        &self,
        rows: &[LimitRow],
        derivatives: &[SensitivityRow],
        l2: f64,
        value: impl Fn(&LimitRow) -> Option<f64>,
    ) -> Band {
        let edge = |k: usize| {
            let of = |row: &LimitRow| {
                let own = |s: &&SensitivityRow| {
                    (s.direction_deg, s.l2) == (row.direction_deg, row.l2) && s.number == self.number
                };
                let changes = derivatives.iter().find(own).and_then(|s| self.changes(s));
                (row.direction_deg, value(row).zip(changes).map(|(value, changes)| value + changes[k]), row.status)
            };
            let points: Vec<_> = rows.iter().filter(|row| row.l2 == l2).map(of).collect();
            Curve::new(0, l2, CurveKind::Limits, &points)
        };
        Band { l2, low: edge(0), high: edge(1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wire that costs 2 when thicker and gains 1 when thinner; a number that gains to both sides.
    #[test]
    fn a_band_has_the_worst_and_the_best_of_both_sides() {
        let tolerance = Tolerance { number: "minor_radius".into(), amount: 0.1 };
        let row = |derivative, back| SensitivityRow {
            direction_deg: 0.0,
            l2: 0.0,
            number: "minor_radius".into(),
            derivative: Some(derivative),
            derivative_back: back,
        };
        assert_eq!(tolerance.changes(&row(-2.0, Some(-1.0))), Some([-0.2, 0.1]));
        assert_eq!(tolerance.changes(&row(3.0, Some(-1.0))).map(|[low, _]| low), Some(0.0));
        assert_eq!(tolerance.changes(&row(-2.0, None)), None);
        let limit = LimitRow { l1: Some(0.5), ..LimitRow::default() };
        let band = tolerance.band(&[limit], &[row(-2.0, Some(-1.0))], 0.0, |row| row.l1);
        assert_eq!((band.low.values().next(), band.high.values().next()), (Some(0.3), Some(0.6)));
    }
}
