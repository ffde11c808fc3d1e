//! The near pairs of one state with what is known of their distance: each is examined once, and only if asked.

use super::{RingPair, broad_phase::in_chunks, close_pairs};
use crate::{model::Model, state::State};
use maille_geometry::{Circle, Minimum, circle_distance_lower_bound, circle_distance_minima};
use std::cell::OnceCell;

/// A pair of rings as it stands.
pub(crate) struct NearPair {
    /// Which rings.
    pub pair: RingPair,
    /// Core circle of the first.
    pub a: Circle,
    /// Core circle of the second, in its image.
    pub b: Circle,
    /// Core distance at which the tori touch.
    pub touching: f64,
    /// The core distance is not smaller than this.
    pub floor: f64,
    minima: OnceCell<Box<[Minimum]>>,
}

impl NearPair {
    /// All minima of the core distance, ascending. Complete; found at the first call.
    pub(crate) fn minima(&self) -> &[Minimum] {
        self.minima.get_or_init(|| circle_distance_minima(&self.a, &self.b).as_slice().into())
    }

    /// Least core distance.
    pub(crate) fn distance(&self) -> f64 {
        self.minima()[0].distance
    }

    /// Whether the gap is at most `band`; the minima are looked for only where the floor does not tell.
    pub(crate) fn within(&self, band: f64) -> bool {
        self.floor - self.touching <= band && self.distance() - self.touching <= band
    }
}

/// All pairs whose tori may be within `margin` of each other, in the order of [`close_pairs`].
pub(crate) fn near_pairs(model: &Model, state: &State, margin: f64) -> Vec<NearPair> {
    let circles: Vec<Circle> = (0..model.rings.len()).map(|ring| state.circle(model, ring, [0, 0])).collect();
    let of = |pair: &RingPair| {
        let (a, b) = (circles[pair.ring_a], circles[pair.ring_b]);
        let b = state.image(pair.shift).circle(&b);
        let touching = model.contact_distance(pair.ring_a, pair.ring_b);
        let floor = circle_distance_lower_bound(&a, &b);
        NearPair { pair: *pair, a, b, touching, floor, minima: OnceCell::new() }
    };
    in_chunks(&close_pairs(model, state, margin), |pairs| pairs.iter().map(of).collect())
}
