//! Curves over the direction of the pull.

use maille::record::Status;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// Limits of a record: a line with markers.
    Limits,
    /// A bound: dashed, without markers.
    Bound,
    /// Limits of another record of the same sheet: markers without a line.
    Check,
}

/// One value a direction, of one record and one l2: these give line, colour and marker.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Which of the plot's records.
    pub record: usize,
    /// Stretch − 1 held across the pull.
    pub l2: f64,
    /// How it is drawn.
    pub kind: CurveKind,
    points: Vec<CurvePoint>,
}

/// Degrees, value, and what came of the search.
pub(super) type CurvePoint = (f64, Option<f64>, Status);

impl Curve {
    /// Directions in degrees, any order; `None` where no value was earned. A direction and its opposite are the same pull:
    /// of two values for one, the first that is there counts.
    pub fn new(record: usize, l2: f64, kind: CurveKind, points: &[(f64, Option<f64>, Status)]) -> Self {
        let mut half: Vec<_> =
            points.iter().map(|&(degrees, value, status)| (half_turn(degrees), value, status)).collect();
        half.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.is_some().cmp(&a.1.is_some())));
        half.dedup_by(|later, kept| later.0 == kept.0);
        Self { record, l2, kind, points: half }
    }

    /// The values that are there.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.points.iter().filter_map(|p| p.1)
    }

    /// Directions and values over the whole turn.
    pub(super) fn turn(&self) -> Vec<CurvePoint> {
        let opposite = self.points.iter().map(|&(degrees, value, status)| (degrees + 180.0, value, status));
        self.points.iter().copied().chain(opposite).collect()
    }

    /// Runs of neighbouring directions that all have a value; `true` with the run that closes upon itself.
    ///
    /// The last direction before a half turn and the first after it are neighbours only if they are no further apart than
    /// two others: a record of 0° to 90° leaves the other quarter empty.
    pub(super) fn runs(&self) -> (Vec<Vec<(f64, f64)>>, bool) {
        let turn = self.turn();
        let n = turn.len();
        if n == 0 {
            return (Vec::new(), false);
        }
        let half = n / 2;
        let gaps = self.points.windows(2).map(|w| w[1].0 - w[0].0);
        let widest = gaps.fold(0.0, f64::max);
        let gap = |i: usize| if (i + 1).is_multiple_of(half) { turn[0].0 + 180.0 - turn[half - 1].0 } else { 0.0 };
        let joined = |i: usize| turn[i].1.is_some() && turn[(i + 1) % n].1.is_some() && gap(i) <= widest + 1e-9;
        let Some(end) = (0..n).find(|&i| !joined(i)) else {
            let closed = turn.into_iter().filter_map(|(degrees, value, _)| Some((degrees, value?))).collect();
            return (vec![closed], true);
        };
        let mut runs = Vec::new();
        let mut run = Vec::new();
        for k in 1..=n {
            let i = (end + k) % n;
            let degrees = turn[i].0 + if end + k >= n { 360.0 } else { 0.0 };
            run.extend(turn[i].1.map(|value| (degrees, value)));
            if !joined(i) && !run.is_empty() {
                runs.push(std::mem::take(&mut run));
            }
        }
        (runs, false)
    }
}

fn half_turn(degrees: f64) -> f64 {
    let rest = degrees.rem_euclid(180.0);
    if 180.0 - rest < 1e-9 { 0.0 } else { rest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, Option<f64>)]) -> Curve {
        let points: Vec<_> = points.iter().map(|&(degrees, value)| (degrees, value, Status::Local)).collect();
        Curve::new(0, 0.0, CurveKind::Limits, &points)
    }

    fn lengths(points: &[(f64, Option<f64>)]) -> (Vec<usize>, bool) {
        let (runs, closed) = curve(points).runs();
        (runs.iter().map(Vec::len).collect(), closed)
    }

    #[test]
    fn half_a_turn_closes() {
        let all: Vec<_> = (0..=12).map(|i| (15.0 * f64::from(i), Some(1.0))).collect();
        assert_eq!(lengths(&all), (vec![24], true));
        assert_eq!(lengths(&all[..12]), (vec![24], true));
    }

    #[test]
    fn a_missing_value_is_never_bridged() {
        let mut some: Vec<_> = (0..12).map(|i| (15.0 * f64::from(i), Some(1.0))).collect();
        some[3].1 = None;
        assert_eq!(lengths(&some), (vec![11, 11], false));
        some[0].1 = None;
        assert_eq!(lengths(&some), (vec![2, 8, 2, 8], false));
        some.iter_mut().for_each(|p| p.1 = None);
        assert_eq!(lengths(&some), (vec![], false));
    }

    #[test]
    fn a_quarter_stays_a_quarter() {
        let quarter: Vec<_> = (0..=6).map(|i| (15.0 * f64::from(i), Some(1.0))).collect();
        assert_eq!(lengths(&quarter), (vec![7, 7], false));
        assert_eq!(lengths(&[(30.0, Some(1.0))]), (vec![1, 1], false));
        assert_eq!(lengths(&[]), (vec![], false));
    }

    #[test]
    fn opposite_directions_are_one_pull() {
        let turn = curve(&[(0.0, None), (180.0, Some(2.0)), (-90.0, Some(3.0))]).turn();
        let values: Vec<_> = turn.into_iter().map(|(degrees, value, _)| (degrees, value)).collect();
        assert_eq!(values, [(0.0, Some(2.0)), (90.0, Some(3.0)), (180.0, Some(2.0)), (270.0, Some(3.0))]);
    }
}
