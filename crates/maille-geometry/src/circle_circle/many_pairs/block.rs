//! Solves one block of pairs: the fast method with one pair per lane of a register.
//!
//! All registers of a block are processed first and their results stored in [`LaneBuffers`]; then the results are
//! written pair by pair. At most two minima per pair fit; pairs with more, and those that the registers cannot
//! decide, go to `one_pair::approaches`.

use crate::circle::{Circle, Vec3};
use crate::circle_circle::approach::{Approach, Approaches};
use crate::circle_circle::fast::arc_tables::ARC_TABLES;
use crate::circle_circle::fast::bernstein::Harmonics;
use crate::circle_circle::fast::bracket::{Bracket, MAX_SIMD_MINIMA};
use crate::circle_circle::fast::halley::halley_roots;
use crate::circle_circle::fast::root_count::{RootCounts, is_steep};
use crate::circle_circle::fast::subdivision::{BracketList, subdivide_first_doubtful};
use crate::circle_circle::many_pairs::soa::{Lanes, PairBlock, WIDTH};
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::circle_circle::one_pair;
use crate::simd::{Register, SimdReal};
use pulp::{Simd, WithSimd};

/// Values that pass from registers to code for single pairs, and back: one per pair of the block.
pub(crate) struct LaneBuffers {
    /// The normalized pairs, see [`NormalizedPair::parameters`].
    pairs: [Lanes; 7],
    /// The brackets, see [`Bracket::parameters`].
    brackets: [[Lanes; 3]; MAX_SIMD_MINIMA],
    /// Number of brackets.
    counts: Lanes,
    /// 1 if all minima of the pair were found in registers, else 0.
    complete: Lanes,
    /// Distances of the minima.
    distance: [Lanes; MAX_SIMD_MINIMA],
    /// Directions of the minima on circle B.
    direction: [[Lanes; 3]; MAX_SIMD_MINIMA],
}

impl LaneBuffers {
    /// Zeros.
    pub fn new() -> Self {
        let lanes = [0.0; WIDTH];
        Self {
            pairs: [lanes; 7],
            brackets: [[lanes; 3]; MAX_SIMD_MINIMA],
            counts: lanes,
            complete: lanes,
            distance: [lanes; MAX_SIMD_MINIMA],
            direction: [[lanes; 3]; MAX_SIMD_MINIMA],
        }
    }

    /// The brackets of the pairs in a register, and their number.
    #[inline(always)]
    fn isolate<S: Simd>(
        &mut self,
        simd: S,
        from: usize,
        pair: &NormalizedPair<Register<S>>,
    ) -> ([Bracket<Register<S>>; MAX_SIMD_MINIMA], Register<S>) {
        let (tables, zero) = (&*ARC_TABLES, pair.radius.splat(0.0));
        // Count roots; bisect doubtful arcs; leave what is still in doubt to code for single pairs.
        let harmonics = Harmonics::new(pair, tables);
        let counts = RootCounts::new(pair, &harmonics, tables);
        let mut rising = counts.rising_arcs(tables);
        if <Register<S>>::any(zero.lt(counts.total_excess())) {
            let left = subdivide_first_doubtful(pair, &harmonics, &counts, &mut rising, tables);
            if <Register<S>>::any(zero.lt(left)) {
                self.isolate_doubtful(simd, from, pair, left, &mut rising);
            }
        }
        rising
    }

    /// Isolates the minima of the lanes that are still in doubt (`left > 0`), one pair at a time.
    #[inline(always)]
    fn isolate_doubtful<S: Simd>(
        &mut self,
        simd: S,
        from: usize,
        pair: &NormalizedPair<Register<S>>,
        left: Register<S>,
        (brackets, count): &mut ([Bracket<Register<S>>; MAX_SIMD_MINIMA], Register<S>),
    ) {
        // Store the pairs and their brackets.
        for (lanes, number) in self.pairs.iter_mut().zip(pair.parameters()) {
            number.store(lanes, from);
        }
        count.store(&mut self.counts, from);
        for (arrays, bracket) in self.brackets.iter_mut().zip(&*brackets) {
            for (lanes, part) in arrays.iter_mut().zip(bracket.parameters()) {
                part.store(lanes, from);
            }
        }
        // Replace the brackets of the doubtful lanes in memory.
        let mut excess = [0.0; WIDTH];
        left.store(&mut excess, 0);
        for lane in 0..S::F64_LANES {
            if excess[lane] != 0.0 {
                self.isolate_lane(from + lane);
            }
        }
        // Load them.
        for (bracket, arrays) in brackets.iter_mut().zip(&self.brackets) {
            let mut parts = bracket.parameters();
            for (part, lanes) in parts.iter_mut().zip(arrays) {
                *part = Register::load(simd, lanes, from);
            }
            // The other lanes keep theirs bit by bit, so that a lane does not depend on the others.
            *bracket = Bracket::select(left.splat(0.0).lt(left), Bracket::from_parameters(parts), *bracket);
        }
        *count = Register::load(simd, &self.counts, from);
    }

    /// The brackets of the pair in one lane, and their number; 0 if it cannot be decided.
    fn isolate_lane(&mut self, lane: usize) {
        let pair = NormalizedPair::from_parameters(lane_values(&self.pairs, lane));
        self.counts[lane] = 0.0;
        let Some(found) = BracketList::isolate(&pair, &ARC_TABLES) else { return };
        if (1..=MAX_SIMD_MINIMA).contains(&found.count) {
            self.counts[lane] = found.count as f64;
            for (slot, arrays) in self.brackets.iter_mut().enumerate() {
                let parts = found.all[slot.min(found.count - 1)].parameters();
                for k in 0..parts.len() {
                    arrays[k][lane] = parts[k];
                }
            }
        }
    }

    /// One of the minima of a lane.
    #[inline(always)]
    fn approach(&self, slot: usize, lane: usize) -> Approach {
        let [x, y, z] = lane_values(&self.direction[slot], lane);
        Approach { distance: self.distance[slot][lane], direction_b: Vec3::new(x, y, z) }
    }

    /// Writes the minima of a lane in ascending order. If there is only one, the distance of the second is infinite.
    #[inline(always)]
    fn write(&self, lane: usize, out: &mut Approaches) {
        out.count = self.counts[lane] as usize;
        out.continuum = false;
        let swapped = usize::from(self.distance[1][lane] < self.distance[0][lane]);
        out.found[swapped] = self.approach(0, lane);
        out.found[1 - swapped] = self.approach(1, lane);
    }
}

/// The values of one lane.
#[inline(always)]
fn lane_values<const N: usize>(arrays: &[Lanes; N], lane: usize) -> [f64; N] {
    let mut out = [0.0; N];
    for k in 0..N {
        out[k] = arrays[k][lane];
    }
    out
}

/// Finds the minima of the pairs of a block and writes them to `out`, to be run with an instruction set.
pub(crate) struct BlockKernel<'a> {
    pub block: &'a PairBlock,
    pub buffers: &'a mut LaneBuffers,
    pub pairs: &'a [(Circle, Circle)],
    pub out: &'a mut [Approaches],
}

impl WithSimd for BlockKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let BlockKernel { block, buffers, pairs, out } = self;
        for from in (0..block.count).step_by(S::F64_LANES) {
            // Isolate and refine.
            let frames = block.load(simd, from).frames();
            let (zero, one) = (frames.pair.radius.splat(0.0), frames.pair.radius.splat(1.0));
            let (brackets, count) = buffers.isolate(simd, from, &frames.pair);
            let (angles, good) = halley_roots([&frames.pair; MAX_SIMD_MINIMA], &brackets, MAX_SIMD_MINIMA);
            // Which results are valid?
            let few = <Register<S>>::and(zero.lt(count), count.lt(zero.splat(MAX_SIMD_MINIMA as f64 + 0.5)));
            let regular = <Register<S>>::and(few, <Register<S>>::and(is_steep(&frames.pair), frames.is_regular()));
            count.store(&mut buffers.counts, from);
            <Register<S>>::select(regular, good[0] * good[1], zero).store(&mut buffers.complete, from);
            // Store distances and directions.
            let is_single = count.lt(one + zero.splat(0.5));
            for slot in 0..MAX_SIMD_MINIMA {
                let (mut distance, direction) = frames.distance_and_direction(angles[slot]);
                if slot > 0 {
                    distance = <Register<S>>::select(is_single, zero.splat(f64::INFINITY), distance);
                }
                distance.store(&mut buffers.distance[slot], from);
                for axis in 0..3 {
                    direction[axis].store(&mut buffers.direction[slot][axis], from);
                }
            }
        }
        // Write the results, pair by pair.
        for lane in 0..block.count {
            let index = block.index[lane];
            if buffers.complete[lane] == 1.0 {
                buffers.write(lane, &mut out[index]);
            } else {
                out[index] = one_pair::approaches(&pairs[index].0, &pairs[index].1);
            }
        }
    }
}
