//! The near pairs of one state with what is known of their distance: each is examined once, and only if asked.

use super::{RingPair, broad_phase::in_chunks, close_pairs};
use crate::{
    model::{
        Model,
        curve::{Core, CurveMinimum, curve_distance, distance_lower_bound, owned_distance_minima},
    },
    state::State,
};
use maille_geometry::{Circle, Minimum, circle_distance_minima};
use std::{
    cell::{OnceCell, RefCell},
    sync::Arc,
};

/// A pair of rings as it stands.
pub(crate) struct NearPair {
    /// Which rings.
    pub pair: RingPair,
    /// Core of the first.
    pub a: Core,
    /// Core of the second, in its image.
    pub b: Core,
    /// Core distance at which the tori touch.
    pub touching: f64,
    /// The core distance is not smaller than this.
    pub floor: f64,
    minima: OnceCell<Box<[Minimum]>>,
    /// Minima of curves up to a distance, and that distance.
    of_curves: RefCell<Option<(f64, Arc<[CurveMinimum]>)>>,
}

impl NearPair {
    /// The two circles; none where one is another curve.
    pub(crate) fn circles(&self) -> Option<(&Circle, &Circle)> {
        match (&self.a, &self.b) {
            (Core::Circle(a), Core::Circle(b)) => Some((a, b)),
            _ => None,
        }
    }

    /// All minima of the core distance of two circles, ascending; none of other curves. Complete; found at the first call.
    pub(crate) fn minima(&self) -> &[Minimum] {
        let found = |(a, b): (&Circle, &Circle)| circle_distance_minima(a, b).as_slice().into();
        self.minima.get_or_init(|| self.circles().map_or_else(Box::default, found))
    }

    /// All minima of the core distance up to `far`, and the least one, ascending; more may be listed. Of two circles none.
    pub(crate) fn curve_minima(&self, far: f64) -> Arc<[CurveMinimum]> {
        if self.circles().is_some() {
            return Arc::default();
        }
        let known = self.of_curves.borrow().clone();
        if let Some((_, minima)) = known.filter(|(up_to, _)| *up_to >= far) {
            return minima;
        }
        let minima: Arc<[CurveMinimum]> = owned_distance_minima(&self.a, &self.b, far).into();
        *self.of_curves.borrow_mut() = Some((far, Arc::clone(&minima)));
        minima
    }

    /// Least core distance.
    pub(crate) fn distance(&self) -> f64 {
        match self.circles() {
            Some(_) => self.minima()[0].distance,
            // Of a frame's curves the nearest points may belong to others.
            None => match self.curve_minima(0.0).first() {
                Some(minimum) => minimum.distance,
                None => curve_distance(&self.a, &self.b),
            },
        }
    }

    /// Whether the gap is at most `band`; the minima are looked for only where the floor does not tell.
    pub(crate) fn within(&self, band: f64) -> bool {
        self.floor - self.touching <= band && self.distance() - self.touching <= band
    }
}

/// All pairs whose tori may be within `margin` of each other, in the order of [`close_pairs`].
pub(crate) fn near_pairs(model: &Model, state: &State, margin: f64) -> Vec<NearPair> {
    let cores: Vec<Core> = (0..model.rings.len()).map(|ring| state.core(model, ring, [0, 0])).collect();
    let of = |pair: &RingPair| {
        let a = cores[pair.ring_a].clone();
        let b = cores[pair.ring_b].image(&state.image(pair.shift));
        let touching = model.contact_distance(pair.ring_a, pair.ring_b);
        let floor = distance_lower_bound(&a, &b);
        NearPair { pair: *pair, a, b, touching, floor, minima: OnceCell::new(), of_curves: RefCell::default() }
    };
    in_chunks(&close_pairs(model, state, margin), |pairs| pairs.iter().map(of).collect())
}
