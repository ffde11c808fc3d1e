//! A block of pairs on the quick kernel: two registers at a time, and what leaves them for memory.
//!
//! No closures in what runs on registers: what is not inlined into the function of an instruction set cannot use it.

use crate::arcs::TABLE;
use crate::batch::{Approach, Approaches};
use crate::brackets::{Bracket, Counted, SLOTS, is_steep};
use crate::count::Harmonics;
use crate::halving::{Brackets, halved};
use crate::lane::{Lane, Register};
use crate::placed::{Block, Row, WIDTH};
use crate::quick::roots;
use crate::reduced::Reduced;
use crate::{Circle, Vec3};
use pulp::{Simd, WithSimd};

/// What the registers of a block leave in memory.
pub(crate) struct Rows {
    numbers: [Row; 7],
    brackets: [[Row; 3]; SLOTS],
    counts: Row,
    complete: Row,
    distance: [Row; SLOTS],
    direction: [[Row; 3]; SLOTS],
}

impl Rows {
    pub fn new() -> Self {
        let row = [0.0; WIDTH];
        Self {
            numbers: [row; 7],
            brackets: [[row; 3]; SLOTS],
            counts: row,
            complete: row,
            distance: [row; SLOTS],
            direction: [[row; 3]; SLOTS],
        }
    }

    /// The brackets of a register, and how many.
    #[inline(always)]
    fn rising<S: Simd>(
        &mut self,
        simd: S,
        from: usize,
        pair: &Reduced<Register<S>>,
    ) -> ([Bracket<Register<S>>; SLOTS], Register<S>) {
        let (table, zero) = (&*TABLE, pair.radius.like(0.0));
        let harmonics = Harmonics::new(pair, table);
        let counted = Counted::new(pair, &harmonics, table);
        let mut rising = counted.rising(table);
        if <Register<S>>::any(zero.below(counted.doubts())) {
            let left = halved(pair, &harmonics, &counted, &mut rising, table);
            if <Register<S>>::any(zero.below(left)) {
                self.decided(simd, from, pair, left, &mut rising);
            }
        }
        rising
    }

    /// The brackets of a register with pairs that are still in doubt: those leave it for a while.
    #[inline(always)]
    fn decided<S: Simd>(
        &mut self,
        simd: S,
        from: usize,
        pair: &Reduced<Register<S>>,
        left: Register<S>,
        (brackets, count): &mut ([Bracket<Register<S>>; SLOTS], Register<S>),
    ) {
        for (row, number) in self.numbers.iter_mut().zip(pair.numbers()) {
            number.store(row, from);
        }
        count.store(&mut self.counts, from);
        for (rows, bracket) in self.brackets.iter_mut().zip(&*brackets) {
            for (row, part) in rows.iter_mut().zip(bracket.parts()) {
                part.store(row, from);
            }
        }
        let mut doubts = [0.0; WIDTH];
        left.store(&mut doubts, 0);
        for lane in 0..S::F64_LANES {
            if doubts[lane] != 0.0 {
                self.decide(from + lane);
            }
        }
        for (bracket, rows) in brackets.iter_mut().zip(&self.brackets) {
            let mut parts = bracket.parts();
            for (part, row) in parts.iter_mut().zip(rows) {
                *part = Register::load(simd, row, from);
            }
            // The others keep theirs, to the bit.
            *bracket = Bracket::pick(left.like(0.0).below(left), Bracket::of_parts(parts), *bracket);
        }
        *count = Register::load(simd, &self.counts, from);
    }

    /// The brackets of one pair, and how many: 0 if that is not to be decided here.
    fn decide(&mut self, lane: usize) {
        let pair = Reduced::of_numbers(column(&self.numbers, lane));
        self.counts[lane] = 0.0;
        let Some(found) = Brackets::of_pair(&pair, &TABLE) else { return };
        if (1..=SLOTS).contains(&found.count) {
            self.counts[lane] = found.count as f64;
            for (slot, rows) in self.brackets.iter_mut().enumerate() {
                let parts = found.all[slot.min(found.count - 1)].parts();
                for k in 0..parts.len() {
                    rows[k][lane] = parts[k];
                }
            }
        }
    }

    #[inline(always)]
    fn approach(&self, slot: usize, lane: usize) -> Approach {
        let [x, y, z] = column(&self.direction[slot], lane);
        Approach { distance: self.distance[slot][lane], direction_b: Vec3::new(x, y, z) }
    }

    /// Puts the minima of a pair in its place. The second of one alone is as far as can be.
    #[inline(always)]
    fn put(&self, lane: usize, place: &mut Approaches) {
        place.count = self.counts[lane] as usize;
        place.continuum = false;
        let swapped = usize::from(self.distance[1][lane] < self.distance[0][lane]);
        place.found[swapped] = self.approach(0, lane);
        place.found[1 - swapped] = self.approach(1, lane);
    }
}

#[inline(always)]
fn column<const N: usize>(rows: &[Row; N], lane: usize) -> [f64; N] {
    let mut out = [0.0; N];
    for k in 0..N {
        out[k] = rows[k][lane];
    }
    out
}

/// The minima of the pairs of a block, put in their places.
pub(crate) struct Solve<'a> {
    pub block: &'a Block,
    pub rows: &'a mut Rows,
    pub pairs: &'a [(Circle, Circle)],
    pub out: &'a mut [Approaches],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Solve { block, rows, pairs, out } = self;
        for from in (0..block.count).step_by(S::F64_LANES) {
            let framed = block.load(simd, from).framed();
            let (zero, one) = (framed.pair.radius.like(0.0), framed.pair.radius.like(1.0));
            let (brackets, count) = rows.rising(simd, from, &framed.pair);
            let (angles, good) = roots([&framed.pair; SLOTS], &brackets, SLOTS);
            let few = <Register<S>>::both(zero.below(count), count.below(zero.like(SLOTS as f64 + 0.5)));
            let regular = <Register<S>>::both(few, <Register<S>>::both(is_steep(&framed.pair), framed.is_ordinary()));
            count.store(&mut rows.counts, from);
            <Register<S>>::pick(regular, good[0] * good[1], zero).store(&mut rows.complete, from);
            let alone = count.below(one + zero.like(0.5));
            for slot in 0..SLOTS {
                let (mut distance, direction) = framed.approach(angles[slot]);
                if slot > 0 {
                    distance = <Register<S>>::pick(alone, zero.like(f64::INFINITY), distance);
                }
                distance.store(&mut rows.distance[slot], from);
                for axis in 0..3 {
                    direction[axis].store(&mut rows.direction[slot][axis], from);
                }
            }
        }
        for lane in 0..block.count {
            let index = block.index[lane];
            if rows.complete[lane] == 1.0 {
                rows.put(lane, &mut out[index]);
            } else {
                out[index] = Approaches::of_pair(&pairs[index].0, &pairs[index].1);
            }
        }
    }
}
