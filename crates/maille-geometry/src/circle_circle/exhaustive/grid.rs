//! Where the search for minima cuts the circle: angles and widths that do not depend on the pair, with their cosines.

use crate::circle_circle::angle::{Direction, START_RAD};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Intervals at the start.
pub(crate) const INTERVALS: usize = 16;
/// Halvings at most: width 2π · 2⁻²⁴.
pub(crate) const MAX_LEVEL: usize = 20;
/// Directions that do not depend on the pair: of the first intervals' ends and centres, and of the widths.
pub(crate) struct Grid {
    pub ends: [Direction; INTERVALS + 1],
    pub centers: [Direction; INTERVALS],
    /// Half of the half width of an interval, by level.
    pub quarters: [Direction; MAX_LEVEL + 1],
}

pub(crate) static GRID: LazyLock<Grid> = LazyLock::new(|| {
    let angle = |index: f64| START_RAD + index * TAU / INTERVALS as f64;
    // The last end is the first, to the bit.
    let ends = std::array::from_fn(|i| Direction::at(angle((i % INTERVALS) as f64)));
    let centers = std::array::from_fn(|i| Direction::at(angle(i as f64 + 0.5)));
    let quarters = std::array::from_fn(|level| Direction::at(half_width(level) / 2.0));
    Grid { ends, centers, quarters }
});

/// Half width of an interval, by level, in radians.
pub(crate) fn half_width(level: usize) -> f64 {
    TAU / ((2 * INTERVALS) << level) as f64
}
