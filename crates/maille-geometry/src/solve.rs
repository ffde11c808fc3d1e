//! A block of pairs on the quick kernel: two registers at a time, and what leaves them for memory.
//!
//! No closures in what runs on registers: what is not inlined into the function of an instruction set cannot use it.

use crate::batch::{Approach, Approaches};
use crate::brackets::{Bracket, Counted, SLOTS, is_steep};
use crate::count::{ARCS, Harmonics, TABLE};
use crate::halving::{Brackets, halved};
use crate::lane::{Lane, Register};
use crate::placed::{Block, Row, WIDTH};
use crate::quick::roots;
use crate::relative::Reduced;
use crate::{Circle, Vec3};
use pulp::{Simd, WithSimd};

/// What the registers of a block leave in memory.
pub(crate) struct Rows {
    excess: [Row; ARCS],
    minus: [Row; ARCS],
    plus: [Row; ARCS],
    numbers: [Row; 7],
    brackets: [[Row; 5]; SLOTS],
    counts: Row,
    complete: Row,
    distance: [Row; SLOTS],
    direction: [[Row; 3]; SLOTS],
}

impl Rows {
    pub fn new() -> Self {
        let row = [0.0; WIDTH];
        Self {
            excess: [row; ARCS],
            minus: [row; ARCS],
            plus: [row; ARCS],
            numbers: [row; 7],
            brackets: [[row; 5]; SLOTS],
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
                self.decided(simd, from, pair, &counted, left, &mut rising);
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
        counted: &Counted<Register<S>>,
        left: Register<S>,
        (brackets, count): &mut ([Bracket<Register<S>>; SLOTS], Register<S>),
    ) {
        for k in 0..ARCS {
            counted.excess[k].store(&mut self.excess[k], from);
            counted.minus[k].store(&mut self.minus[k], from);
            counted.plus[k].store(&mut self.plus[k], from);
        }
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
            *bracket = Bracket::of_parts(parts);
        }
        *count = Register::load(simd, &self.counts, from);
    }

    /// The brackets of one pair, and how many: 0 if that is not to be decided here.
    fn decide(&mut self, lane: usize) {
        let pair = Reduced::of_numbers(column(&self.numbers, lane));
        let counted = Counted {
            excess: column(&self.excess, lane),
            minus: column(&self.minus, lane),
            plus: column(&self.plus, lane),
        };
        self.counts[lane] = 0.0;
        let Some(found) = Brackets::new(&pair, &counted, &TABLE) else { return };
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

    /// Puts the minima of a pair in its place.
    #[inline(always)]
    fn put(&self, lane: usize, place: &mut Approaches) {
        let count = self.counts[lane];
        *place = Approaches::NONE;
        place.count = count as usize;
        if count < 1.5 {
            place.found[0] = self.approach(0, lane);
            return;
        }
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

/// Registers whose roots are sought together: one step waits for the other's square roots.
const ABREAST: usize = 2;

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
        for from in (0..block.count).step_by(ABREAST * S::F64_LANES) {
            let second = from + S::F64_LANES;
            let framed = [block.load(simd, from).framed(), block.load(simd, second).framed()];
            let zero = framed[0].pair.radius.like(0.0);
            let [first, last] = &framed;
            let rising = [rows.rising(simd, from, &first.pair), rows.rising(simd, second, &last.pair)];
            let [([a, b], _), ([c, d], _)] = rising;
            let (angles, good) = roots([&first.pair, &first.pair, &last.pair, &last.pair], &[a, b, c, d], 4);
            for half in 0..ABREAST {
                let (at, framed, count) = (from + half * S::F64_LANES, &framed[half], rising[half].1);
                let few = <Register<S>>::both(zero.below(count), count.below(zero.like(SLOTS as f64 + 0.5)));
                let regular = <Register<S>>::both(few, <Register<S>>::both(is_steep(&framed.pair), framed.is_tilted()));
                let good = good[SLOTS * half] * good[SLOTS * half + 1];
                count.store(&mut rows.counts, at);
                <Register<S>>::pick(regular, good, zero).store(&mut rows.complete, at);
                for slot in 0..SLOTS {
                    let (distance, direction) = framed.approach(angles[SLOTS * half + slot]);
                    distance.store(&mut rows.distance[slot], at);
                    for axis in 0..3 {
                        direction[axis].store(&mut rows.direction[slot][axis], at);
                    }
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
