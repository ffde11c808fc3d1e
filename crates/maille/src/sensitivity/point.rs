//! A closed point of a locked state.

use super::numbers::RingVector;
use crate::model::RingPair;
use nalgebra::Vector2;

/// A closed point with the derivatives of its gap by the design's numbers, in the design's unit.
pub(super) struct Point {
    /// The pair as the design's own cell has it.
    pub pair: RingPair,
    /// The rings as the design counts them; of one ring and its own image both.
    pub rings: [(usize, RingVector); 2],
    pub lattice: [Vector2<f64>; 2],
}
