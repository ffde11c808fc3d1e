//! Constants of the exhaustive method: the initial intervals of θ and the widths after each bisection.

use crate::circle_circle::angle::{Direction, START_RAD};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Number of initial intervals.
pub(crate) const INTERVALS: usize = 16;
/// Maximum number of bisections: intervals of width `2π · 2⁻²⁴`.
pub(crate) const MAX_LEVEL: usize = 20;

/// Directions that do not depend on the pair.
pub(crate) struct Grid {
    /// Ends of the initial intervals.
    pub ends: [Direction; INTERVALS + 1],
    /// Centres of the initial intervals.
    pub centers: [Direction; INTERVALS],
    /// A quarter of the width of an interval, by number of bisections.
    pub quarters: [Direction; MAX_LEVEL + 1],
}

/// The grid, computed at the first use.
pub(crate) static GRID: LazyLock<Grid> = LazyLock::new(|| {
    let angle = |index: f64| START_RAD + index * TAU / INTERVALS as f64;
    // The last end equals the first bit by bit, so that a sign has one value there.
    let ends = std::array::from_fn(|i| Direction::at(angle((i % INTERVALS) as f64)));
    let centers = std::array::from_fn(|i| Direction::at(angle(i as f64 + 0.5)));
    let quarters = std::array::from_fn(|level| Direction::at(half_width(level) / 2.0));
    Grid { ends, centers, quarters }
});

/// Half the width of an interval after `level` bisections, in radians.
pub(crate) fn half_width(level: usize) -> f64 {
    TAU / ((2 * INTERVALS) << level) as f64
}
