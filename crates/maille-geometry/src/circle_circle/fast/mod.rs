//! Fast.

pub(crate) mod arc_tables;
pub(crate) mod bernstein;
pub(crate) mod bracket;
pub(crate) mod halley;
pub(crate) mod root_count;
pub(crate) mod subdivision;

use crate::circle_circle::angle::{Angle, Direction};
use crate::circle_circle::fast::arc_tables::ARC_TABLES;
use crate::circle_circle::fast::halley::{halley_roots, safeguarded_newton};
use crate::circle_circle::fast::root_count::is_steep;
use crate::circle_circle::fast::subdivision::BracketList;
use crate::circle_circle::minimum::MAX_MINIMA;
use crate::circle_circle::normalized_pair::NormalizedPair;

/// The angles of all minima, or `None` where this is not the way to find them.
pub(crate) fn minima(pair: &NormalizedPair<f64>) -> Option<([Direction; MAX_MINIMA], usize)> {
    if !is_steep(pair) {
        return None;
    }
    let brackets = BracketList::isolate(pair, &ARC_TABLES)?;
    let (mut angles, good) = halley_roots([pair; MAX_MINIMA], &brackets.all, brackets.count);
    for k in (0..brackets.count).filter(|k| good[*k] != 1.0) {
        angles[k] = safeguarded_newton(pair, &brackets.all[k])?;
    }
    let directions = angles.map(|Angle { cos, sin }| Direction { cos, sin });
    (brackets.count > 0).then_some((directions, brackets.count))
}
