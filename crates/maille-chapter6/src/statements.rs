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
pub use radii::{MINIMA_DEG, NOTCHED};

use crate::map::{Map, signed};
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

/// `0°, 5°`; many directions are counted.
fn degrees(list: &[f64]) -> String {
    match list.len() {
        n if n > 6 => format!("{n} directions"),
        _ => list.iter().map(|d| format!("{d}°")).collect::<Vec<_>>().join(", "),
    }
}

fn at(map: &Map, l2: f64) -> String {
    format!("{}, l₂ = {}", map.label(), signed(l2))
}

/// Maps of two radii of the same sheet and method, the thicker first.
fn by_radius(maps: &[Map]) -> Vec<(&Map, &Map)> {
    let mut pairs = Vec::new();
    for thick in maps {
        let same = |thin: &&Map| {
            (&thin.design, &thin.method, thin.corners, thin.rearranged, thin.minima)
                == (&thick.design, &thick.method, thick.corners, thick.rearranged, thick.minima)
                && thin.ratio < thick.ratio
        };
        pairs.extend(maps.iter().filter(same).map(|thin| (thick, thin)));
    }
    pairs
}

#[cfg(test)]
mod tests;
