//! The end of the directions with a state, beside one without.
//!
//! Towards a direction in which no state has the width, what has limits ends. While the height rises that way, the last limit's state is
//! followed to the end, each direction by one local search from the state before, in steps that are doubled where one ends in a certificate
//! and halved where none does. The last direction is then solved as any other, from that state first.

use super::{CLOSE_DEG, Place, Point, Search, rounded};
use crate::answer::Answer;
use std::sync::atomic::{AtomicBool, Ordering};

/// The end of the directions with a state is found to this, in degrees.
pub(super) const END_DEG: f64 = 1e-3;
/// Directions to which a state is followed, at most.
const MOST_TURNS: usize = 60;

impl Search<'_> {
    /// The last direction towards `end_deg` to which the state of the limit along `from_deg` can be followed, with the limit there; none where
    /// it cannot be.
    pub(super) fn follow(&self, from_deg: f64, end_deg: f64, cancel: &AtomicBool) -> Option<(f64, Answer)> {
        let near = |deg: f64| (deg - from_deg).abs() <= CLOSE_DEG / 4.0;
        let mut at = self.states.iter().find(|(deg, _)| near(*deg))?.1.clone();
        let (mut deg, mut step_deg) = (from_deg, 0.5 * (end_deg - from_deg));
        for _ in 0..MOST_TURNS {
            step_deg = step_deg.abs().min(0.5 * (end_deg - deg).abs()).copysign(end_deg - deg);
            if step_deg.abs() < 0.5 * END_DEG || cancel.load(Ordering::Relaxed) {
                break;
            }
            let next_deg = rounded(deg + step_deg);
            match self.one.turned(next_deg, self.l2, &at) {
                Some(next) => (deg, at, step_deg) = (next_deg, next, 2.0 * step_deg),
                None => step_deg *= 0.5,
            }
        }
        (deg != from_deg).then_some((deg, at))
    }

    /// Directions without a state beside one with a limit, towards which the height rises.
    pub(super) fn ends(&self) -> impl Iterator<Item = Place> {
        self.points.windows(2).filter_map(|pair| match pair[1].ends {
            true => end(&pair[0], &pair[1]),
            false => end(&pair[1], &pair[0]),
        })
    }
}

/// The way from a limit to a direction without a state, where the height rises that way: as high as its tangent at most.
fn end(last: &Point, end: &Point) -> Option<Place> {
    let width = (end.deg - last.deg).to_radians();
    let slope = last.slope?;
    let rise = if last.mirrored { slope.abs() * width.abs() } else { slope * width };
    let promise = last.height? + rise;
    let open = end.ends && !last.ends && rise > 0.0 && (end.deg - last.deg).abs() > 1.5 * END_DEG;
    open.then_some(Place { deg: end.deg, promise, from_deg: Some(last.deg) })
}
