//! A block of pairs on the quick kernel: two registers at a time, and what leaves them for memory.
//!
//! No closures in what runs on registers: what is not inlined into the function of an instruction set cannot use it.

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

/// What the registers of a block leave in memory.
pub(crate) struct LaneBuffers {
    numbers: [Lanes; 7],
    brackets: [[Lanes; 3]; MAX_SIMD_MINIMA],
    counts: Lanes,
    complete: Lanes,
    distance: [Lanes; MAX_SIMD_MINIMA],
    direction: [[Lanes; 3]; MAX_SIMD_MINIMA],
}

impl LaneBuffers {
    pub fn new() -> Self {
        let row = [0.0; WIDTH];
        Self {
            numbers: [row; 7],
            brackets: [[row; 3]; MAX_SIMD_MINIMA],
            counts: row,
            complete: row,
            distance: [row; MAX_SIMD_MINIMA],
            direction: [[row; 3]; MAX_SIMD_MINIMA],
        }
    }

    /// The brackets of a register, and how many.
    #[inline(always)]
    fn isolate<S: Simd>(
        &mut self,
        simd: S,
        from: usize,
        pair: &NormalizedPair<Register<S>>,
    ) -> ([Bracket<Register<S>>; MAX_SIMD_MINIMA], Register<S>) {
        let (tables, zero) = (&*ARC_TABLES, pair.radius.splat(0.0));
        let harmonics = Harmonics::new(pair, tables);
        let counted = RootCounts::new(pair, &harmonics, tables);
        let mut rising = counted.rising_arcs(tables);
        if <Register<S>>::any(zero.lt(counted.total_excess())) {
            let left = subdivide_first_doubtful(pair, &harmonics, &counted, &mut rising, tables);
            if <Register<S>>::any(zero.lt(left)) {
                self.isolate_doubtful(simd, from, pair, left, &mut rising);
            }
        }
        rising
    }

    /// The brackets of a register with pairs that are still in doubt: those leave it for a while.
    #[inline(always)]
    fn isolate_doubtful<S: Simd>(
        &mut self,
        simd: S,
        from: usize,
        pair: &NormalizedPair<Register<S>>,
        left: Register<S>,
        (brackets, count): &mut ([Bracket<Register<S>>; MAX_SIMD_MINIMA], Register<S>),
    ) {
        for (row, number) in self.numbers.iter_mut().zip(pair.to_array()) {
            number.store(row, from);
        }
        count.store(&mut self.counts, from);
        for (rows, bracket) in self.brackets.iter_mut().zip(&*brackets) {
            for (row, part) in rows.iter_mut().zip(bracket.to_array()) {
                part.store(row, from);
            }
        }
        let mut doubts = [0.0; WIDTH];
        left.store(&mut doubts, 0);
        for lane in 0..S::F64_LANES {
            if doubts[lane] != 0.0 {
                self.isolate_lane(from + lane);
            }
        }
        for (bracket, rows) in brackets.iter_mut().zip(&self.brackets) {
            let mut parts = bracket.to_array();
            for (part, row) in parts.iter_mut().zip(rows) {
                *part = Register::load(simd, row, from);
            }
            // The others keep theirs, to the bit.
            *bracket = Bracket::select(left.splat(0.0).lt(left), Bracket::from_array(parts), *bracket);
        }
        *count = Register::load(simd, &self.counts, from);
    }

    /// The brackets of one pair, and how many: 0 if that is not to be decided here.
    fn isolate_lane(&mut self, lane: usize) {
        let pair = NormalizedPair::from_array(lane_values(&self.numbers, lane));
        self.counts[lane] = 0.0;
        let Some(found) = BracketList::isolate(&pair, &ARC_TABLES) else { return };
        if (1..=MAX_SIMD_MINIMA).contains(&found.count) {
            self.counts[lane] = found.count as f64;
            for (slot, rows) in self.brackets.iter_mut().enumerate() {
                let parts = found.all[slot.min(found.count - 1)].to_array();
                for k in 0..parts.len() {
                    rows[k][lane] = parts[k];
                }
            }
        }
    }

    #[inline(always)]
    fn approach(&self, slot: usize, lane: usize) -> Approach {
        let [x, y, z] = lane_values(&self.direction[slot], lane);
        Approach { distance: self.distance[slot][lane], direction_b: Vec3::new(x, y, z) }
    }

    /// Puts the minima of a pair in its place. The second of one alone is as far as can be.
    #[inline(always)]
    fn write(&self, lane: usize, place: &mut Approaches) {
        place.count = self.counts[lane] as usize;
        place.continuum = false;
        let swapped = usize::from(self.distance[1][lane] < self.distance[0][lane]);
        place.found[swapped] = self.approach(0, lane);
        place.found[1 - swapped] = self.approach(1, lane);
    }
}

#[inline(always)]
fn lane_values<const N: usize>(rows: &[Lanes; N], lane: usize) -> [f64; N] {
    let mut out = [0.0; N];
    for k in 0..N {
        out[k] = rows[k][lane];
    }
    out
}

/// The minima of the pairs of a block, put in their places.
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
            let frames = block.load(simd, from).frames();
            let (zero, one) = (frames.pair.radius.splat(0.0), frames.pair.radius.splat(1.0));
            let (brackets, count) = buffers.isolate(simd, from, &frames.pair);
            let (angles, good) = halley_roots([&frames.pair; MAX_SIMD_MINIMA], &brackets, MAX_SIMD_MINIMA);
            let few = <Register<S>>::and(zero.lt(count), count.lt(zero.splat(MAX_SIMD_MINIMA as f64 + 0.5)));
            let regular = <Register<S>>::and(few, <Register<S>>::and(is_steep(&frames.pair), frames.is_regular()));
            count.store(&mut buffers.counts, from);
            <Register<S>>::select(regular, good[0] * good[1], zero).store(&mut buffers.complete, from);
            let alone = count.lt(one + zero.splat(0.5));
            for slot in 0..MAX_SIMD_MINIMA {
                let (mut distance, direction) = frames.distance_and_direction(angles[slot]);
                if slot > 0 {
                    distance = <Register<S>>::select(alone, zero.splat(f64::INFINITY), distance);
                }
                distance.store(&mut buffers.distance[slot], from);
                for axis in 0..3 {
                    direction[axis].store(&mut buffers.direction[slot][axis], from);
                }
            }
        }
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
