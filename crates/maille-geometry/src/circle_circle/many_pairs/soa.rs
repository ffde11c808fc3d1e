//! A block of pairs of circles as a structure of arrays: one array per coordinate, so that a register loads one
//! coordinate of several pairs.

use crate::circle::Circle;
use crate::circle_circle::simd_frame::{PairVectors, Vector, sub};
use crate::simd::Register;
use pulp::Simd;

/// Number of pairs in a block. Several times the widest register: loading values that have just been stored would
/// stall.
pub(crate) const WIDTH: usize = 32;
/// One value per pair of a block.
pub(crate) type Lanes = [f64; WIDTH];
/// Values per pair: centre, normal and radius of A, then of B.
const NUMBERS: usize = 14;

/// Up to [`WIDTH`] pairs.
pub(crate) struct PairBlock {
    numbers: [Lanes; NUMBERS],
    /// Where each pair came from.
    pub index: [usize; WIDTH],
    /// Number of pairs in use.
    pub count: usize,
}

impl PairBlock {
    /// An empty block. Unused places hold a valid, non-degenerate pair.
    pub fn new() -> Self {
        let one = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0];
        Self { numbers: one.map(|x| [x; WIDTH]), index: [0; WIDTH], count: 0 }
    }

    /// Adds a pair; a full block begins again at its first place.
    #[inline(always)]
    pub fn push(&mut self, index: usize, (a, b): &(Circle, Circle)) {
        let lane = self.count % WIDTH;
        for (k, circle) in [(0, a), (7, b)] {
            let numbers = [
                circle.center.x,
                circle.center.y,
                circle.center.z,
                circle.normal.x,
                circle.normal.y,
                circle.normal.z,
                circle.radius,
            ];
            for (number, x) in self.numbers[k..].iter_mut().zip(numbers) {
                number[lane] = x;
            }
        }
        self.index[lane] = index;
        self.count = lane + 1;
    }

    /// The pairs from number `from` on, one per lane.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, from: usize) -> PairVectors<Register<S>> {
        PairVectors {
            between: sub(self.vector(simd, 7, from), self.vector(simd, 0, from)),
            normals: [self.vector(simd, 3, from), self.vector(simd, 10, from)],
            radii: [self.number(simd, 6, from), self.number(simd, 13, from)],
        }
    }

    #[inline(always)]
    fn number<S: Simd>(&self, simd: S, k: usize, from: usize) -> Register<S> {
        Register::load(simd, &self.numbers[k], from)
    }

    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, k: usize, from: usize) -> Vector<Register<S>> {
        [self.number(simd, k, from), self.number(simd, k + 1, from), self.number(simd, k + 2, from)]
    }
}
