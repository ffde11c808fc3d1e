//! What came of a search, and how plots mark it.

use super::frame::{Entry, SOFT};
use super::look::{self, Look};
use super::palette;
use maille::record::Status;

/// What came of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// A limit that attains its proven bound.
    Proven,
    /// A limit; a larger one is not excluded.
    NotProven,
    /// Proved: there is no limit.
    NoState,
    /// No limit was found.
    NotFound,
}

impl Outcome {
    const ALL: [Outcome; 4] = [Outcome::Proven, Outcome::NotProven, Outcome::NoState, Outcome::NotFound];

    /// That of a row.
    pub(super) fn of(status: Status) -> Self {
        match status {
            Status::Global => Outcome::Proven,
            Status::Local | Status::ThresholdReached => Outcome::NotProven,
            Status::L2Unreachable | Status::Unbounded => Outcome::NoState,
            _ => Outcome::NotFound,
        }
    }

    /// The mark where there is no limit.
    pub(super) fn shape(self) -> Option<&'static [[f64; 2]]> {
        match self {
            Outcome::Proven | Outcome::NotProven => None,
            Outcome::NoState => Some(palette::DASH),
            Outcome::NotFound => Some(palette::CROSS),
        }
    }

    fn label(self) -> &'static str {
        match self {
            Outcome::Proven => "proved",
            Outcome::NotProven => "not proved (local)",
            Outcome::NoState => "no limit (proved)",
            Outcome::NotFound => "no limit found",
        }
    }

    /// Samples of the marks of these rows; the first two only if `limits` are told apart.
    pub(super) fn legend(of: impl Iterator<Item = (Option<f64>, Status)>, limits: bool) -> Vec<Entry> {
        let mut there = [false; 4];
        for (value, status) in of {
            let outcome = Outcome::of(status);
            if value.is_some() != outcome.shape().is_some() {
                there[outcome as usize] = true;
            }
        }
        // Filled markers speak for themselves where there are no others.
        if !limits || !there[Outcome::NotProven as usize] {
            (there[Outcome::Proven as usize], there[Outcome::NotProven as usize]) = (false, false);
        }
        let hollow = Look { color: SOFT.into(), ..look::hollow() };
        let sample = |outcome: Outcome| {
            let look = match outcome.shape() {
                Some(shape) => hollow.with_shape(shape),
                None => hollow.hollow_if(outcome == Outcome::NotProven),
            };
            Entry::sample(&look, false, true, outcome.label())
        };
        Outcome::ALL.into_iter().filter(|outcome| there[*outcome as usize]).map(sample).collect()
    }
}
