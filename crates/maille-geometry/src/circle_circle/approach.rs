//! The compact result type of a batch: distance and direction on circle B only.

use crate::circle::{Circle, Vec3};
use crate::circle_circle::minimum::{MAX_MINIMA, PairKind};
use crate::circle_circle::pair_frame::PairFrame;

/// A local minimum of the distance of two circles, as returned for batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// The distance (length).
    pub distance: f64,
    /// Unit vector from the centre of B to the nearest point of B.
    pub direction_b: Vec3,
}

/// The minima of one pair of a batch, in ascending order of distance; empty if the circles are certainly farther
/// apart than the requested reach.
#[derive(Clone, Copy, Debug)]
pub struct Approaches {
    pub(crate) found: [Approach; MAX_MINIMA],
    pub(crate) count: usize,
    pub(crate) continuum: bool,
}

impl Approaches {
    /// No minimum.
    pub const NONE: Self = Self {
        found: [Approach { distance: f64::INFINITY, direction_b: Vec3::new(0.0, 0.0, 0.0) }; MAX_MINIMA],
        count: 0,
        continuum: false,
    };

    /// The minima, in ascending order of distance.
    pub fn as_slice(&self) -> &[Approach] {
        &self.found[..self.count]
    }

    /// Whether the distance is constant along a whole circle, as in [`Minima`](crate::Minima::continuum). One
    /// representative is then returned.
    pub fn continuum(&self) -> bool {
        self.continuum
    }

    /// The special position of the pair, as [`circle_distance_minima`](crate::circle_distance_minima) reports it.
    /// `a` and `b` must be the circles that these minima belong to.
    pub fn kind(&self, a: &Circle, b: &Circle) -> PairKind {
        // Tilted planes and distinct centres: nearly every pair is generic and needs no frame.
        let offset_sq = (b.center - a.center).norm_squared();
        let scale_sq = offset_sq.max(a.radius * a.radius).max(b.radius * b.radius);
        let tilt_sq = a.normal.cross(&b.normal).norm_squared();
        if tilt_sq > 1e-24 && offset_sq > 1e-24 * scale_sq && !self.continuum {
            return PairKind::Generic;
        }
        let pair = if a.radius < b.radius { PairFrame::new(b, a) } else { PairFrame::new(a, b) };
        match pair.kind() {
            PairKind::Coaxial => PairKind::Coaxial,
            _ if self.continuum => PairKind::Equidistant,
            kind => kind,
        }
    }
}

impl PartialEq for Approaches {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}
