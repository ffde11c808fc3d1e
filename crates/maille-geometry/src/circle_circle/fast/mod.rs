//! The fast method: isolate the minima by counting critical points, then refine them by Halley's iteration.
//!
//! | file | step |
//! | --- | --- |
//! | `arc_tables.rs` | constants of the eight arcs of θ: ends, centres, Bernstein bases |
//! | `bernstein.rs` | coefficients of the trigonometric polynomial H on an arc |
//! | `root_count.rs` | Descartes' rule of signs: which arcs hold how many critical points (with the proof) |
//! | `subdivision.rs` | bisection of arcs where the count is not exact |
//! | `bracket.rs` | an arc with exactly one minimum, and the initial guess on it |
//! | `halley.rs` | the minimum on such an arc |
//!
//! Degenerate and nearly degenerate pairs are recognized and left to the exhaustive method. The functions that are
//! generic over [`SimdReal`](crate::simd::SimdReal) also run on SIMD registers, in `one_pair/simd.rs` and
//! `many_pairs/block.rs`.

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

/// The angles of all minima of a pair and their number, or `None` where the method cannot decide.
pub(crate) fn minima(pair: &NormalizedPair<f64>) -> Option<([Direction; MAX_MINIMA], usize)> {
    // Isolate.
    if !is_steep(pair) {
        return None;
    }
    let brackets = BracketList::isolate(pair, &ARC_TABLES)?;
    // Refine; where Halley's iteration fails, by Newton's method with bisection.
    let (mut angles, converged) = halley_roots([pair; MAX_MINIMA], &brackets.all, brackets.count);
    for k in (0..brackets.count).filter(|k| converged[*k] != 1.0) {
        angles[k] = safeguarded_newton(pair, &brackets.all[k])?;
    }
    let directions = angles.map(|Angle { cos, sin }| Direction { cos, sin });
    (brackets.count > 0).then_some((directions, brackets.count))
}
