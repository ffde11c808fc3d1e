//! What chapter 6 of the thesis says, and what records say to it: one function a statement.
//!
//! A statement is broken into cases, as "1.1 at r = R/10 with l2 = 0". It holds if every case shows it, holds with
//! exceptions if at least three quarters do (of what is said to be usual: more than half), and else fails. A tie counts
//! neither way: what does not change is neither larger nor smaller. Parts are judged apart; the worst counts. A part that
//! only says that something is to be seen fails where no case shows it.

mod cases;
mod cause;
mod directions;
mod effort;
mod radii;

pub(crate) use cases::RULE;
pub use cases::{Finding, Part, Verdict};
pub(crate) use radii::MAJOR;

use crate::map::Map;
use directions::{arrangement, compression_raises, least_along_interlocking};
use effort::{shown, steps};
use radii::{major_radius, scale, sharpness, thinner_goes_further};

/// All statements.
pub fn statements(maps: &[Map]) -> Vec<Finding> {
    vec![
        least_along_interlocking(maps),
        thinner_goes_further(maps),
        compression_raises(maps),
        major_radius(maps),
        scale(maps),
        arrangement(maps),
        steps(maps),
        sharpness(maps),
        shown(maps),
    ]
}

#[cfg(test)]
mod tests;
