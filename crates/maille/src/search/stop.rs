//! When a search has tried enough starts.
//!
//! n starts led to d distinct values, s of them found once only. By Good and Turing's estimate (s + 1)/(n + 1) is about the chance that
//! another start leads to a value that is not known, with one unseen start counted in so that it is never 0 (Good, *The population frequencies of
//! species and the estimation of population parameters*, 1953). If a new value is as likely to have any rank among the
//! d + 1 as any other, the chance that another start finds more is
//!
//! chance = (s + 1)/((n + 1)(d + 1)).
//!
//! It is an estimate for starts of the kinds that are tried, see [`super::options`]: a state that none of them leads to is not
//! counted. While there are states, but none with a certificate, the search goes on.

use super::options::{CELL_SHARE, CELL_STARTS, FOLD_SHARE};
use crate::question::Effort;

/// When a search of one cell stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StopRule {
    /// Starts at least.
    pub least: u64,
    /// Starts at most.
    pub most: u64,
    /// Between them: until the chance that another start finds more is this or less.
    pub chance: f64,
    /// After this time no start begins.
    pub seconds: f64,
    /// No start is drawn once two starts, given ones among them, lead to the best.
    pub until_found_twice: bool,
}

impl StopRule {
    /// The starts that are given, and no drawn ones.
    pub(super) fn given_only() -> Self {
        Self::exactly(0)
    }

    /// The same, but with no drawn starts once two starts, given ones among them, lead to the best.
    pub(super) fn until_found_twice(self) -> Self {
        StopRule { until_found_twice: true, ..self }
    }

    /// This many starts, those that are given counted; all of these are solved.
    pub(super) fn exactly(starts: u64) -> Self {
        StopRule { least: starts, most: starts, chance: 0.0, seconds: f64::INFINITY, until_found_twice: false }
    }

    /// That of an effort, or of a number of starts.
    pub(super) fn of(effort: Effort, starts: Option<usize>) -> Self {
        let rule = |least, most, chance| StopRule { least, most, chance, ..Self::given_only() };
        match (starts, effort) {
            (Some(starts), _) => Self::exactly(starts as u64),
            (None, Effort::Low) => rule(4, 8, 0.1),
            (None, Effort::Normal) => rule(8, 64, 0.02),
            (None, Effort::Thorough) => rule(32, 400, 0.005),
            (None, Effort::Seconds(seconds)) => StopRule { seconds, ..rule(1, u64::from(u32::MAX), 0.0) },
        }
    }

    /// Starts of a larger cell of its own, fewer as its solves are costly; more where it is to fold.
    pub(super) fn of_larger_cell(&self, folds: bool) -> u64 {
        match (self.least == self.most, folds) {
            (true, true) => self.least,
            (true, false) => self.least.min(CELL_STARTS),
            (false, true) => self.least.div_ceil(FOLD_SHARE),
            (false, false) => self.least.div_ceil(CELL_SHARE),
        }
    }

    /// Starts that may still follow.
    pub(super) fn left(&self, starts: u64, chance: f64, seconds: f64) -> u64 {
        match () {
            () if seconds > self.seconds => 0,
            () if starts < self.least => self.least - starts,
            () if chance <= self.chance => 0,
            () => self.most.saturating_sub(starts),
        }
    }
}

/// The chance that another start finds more, see the formula above; `times` tells how often each distinct value was found.
pub(super) fn better_chance(starts: u64, times: &[u64]) -> f64 {
    let once = times.iter().filter(|times| **times == 1).count() as f64;
    (once + 1.0) / ((starts as f64 + 1.0) * (times.len() as f64 + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_by_hand() {
        // Four starts, one value: 1/5 for a new value, half of it for a better one.
        assert_eq!(better_chance(4, &[4]), 0.1);
        assert_eq!(better_chance(4, &[3, 1]), 2.0 / 15.0);
        assert_eq!(better_chance(9, &[]), 0.1);
    }

    #[test]
    fn a_rule_stops_between_its_numbers() {
        let normal = StopRule::of(Effort::Normal, None);
        assert_eq!(normal.left(0, 1.0, 0.0), 8);
        assert_eq!(normal.left(23, better_chance(23, &[23]), 0.0), 41);
        assert_eq!(normal.left(24, better_chance(24, &[24]), 0.0), 0);
        assert_eq!(normal.left(64, 1.0, 0.0), 0);
        let four = StopRule::of(Effort::Thorough, Some(4));
        assert_eq!((four.left(3, 0.0, 1e9), four.left(4, 1.0, 0.0)), (1, 0));
        assert_eq!([four, normal].map(|rule| [false, true].map(|folds| rule.of_larger_cell(folds))), [[3, 4], [3, 4]]);
        let timed = StopRule::of(Effort::Seconds(2.0), None);
        assert!(timed.left(1000, 1e-9, 1.9) > 0);
        assert_eq!(timed.left(1000, 1.0, 2.1), 0);
    }
}
