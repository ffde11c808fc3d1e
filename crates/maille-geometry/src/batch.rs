//! The minima of many pairs at once: the quick kernel on registers, one pair in each lane.
//!
//! Pairs that are certainly too far apart are sorted out first, those that remain fill the lanes, and what the quick
//! kernel cannot decide goes to [`circle_distance_minima`]. The instruction set is chosen when the program runs; every one
//! gives the same bits, for [`crate::lane`] has no operation that rounds differently.
//!
//! No closures in the kernels: what is not inlined into the function of an instruction set cannot use it.

use crate::brackets::{Bracket, Brackets, Counted, SLOTS, is_steep};
use crate::count::{ARCS, Harmonics, TABLE};
use crate::grid::Direction;
use crate::halving::halved;
use crate::lane::{Lane, Register};
use crate::placed::{Block, Row, WIDTH};
use crate::quick::{self, roots};
use crate::relative::{Reduced, Relative};
use crate::{Circle, MAX_MINIMA, Vec3, circle_distance_minima};
use pulp::{Scalar, Simd, WithSimd};

/// A minimum of the distance of two circles, as the batch gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// The distance.
    pub distance: f64,
    /// Unit vector from the centre of B to its point.
    pub direction_b: Vec3,
}

/// The minima of one pair, in ascending order of distance; none if the circles are farther apart than was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approaches {
    found: [Approach; MAX_MINIMA],
    count: usize,
}

impl Approaches {
    /// No minimum.
    pub const NONE: Self = Self {
        found: [Approach { distance: f64::INFINITY, direction_b: Vec3::new(0.0, 0.0, 0.0) }; MAX_MINIMA],
        count: 0,
    };

    /// The minima.
    pub fn as_slice(&self) -> &[Approach] {
        &self.found[..self.count]
    }

    /// By the complete enumeration of one pair.
    fn of_pair(a: &Circle, b: &Circle) -> Self {
        let mut out = Self::NONE;
        let mut add = |distance: f64, direction_b: Vec3| {
            out.found[out.count] = Approach { distance, direction_b };
            out.count += 1;
        };
        let swapped = a.radius < b.radius;
        let pair = if swapped { Relative::new(b, a) } else { Relative::new(a, b) };
        match quick::minima(&pair.reduced()) {
            Some((directions, count)) => {
                for Direction { cos, sin } in &directions[..count] {
                    let (distance, [base, moving]) = pair.approach(*cos, *sin);
                    add(distance, if swapped { base } else { moving });
                }
            }
            None => {
                for minimum in circle_distance_minima(a, b).as_slice() {
                    add(minimum.distance, (minimum.point_b - b.center) / b.radius);
                }
            }
        }
        let count = out.count;
        out.found[..count].sort_unstable_by(|p, q| p.distance.total_cmp(&q.distance));
        out
    }
}

/// An instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// One pair at a time.
    Baseline,
    /// Four pairs at a time.
    Avx2,
    /// Eight pairs at a time.
    Avx512,
}

impl Instructions {
    /// The sets that this machine has, the widest last.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|set| set.is_available())
    }

    #[cfg(target_arch = "x86_64")]
    fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            Self::Avx2 => pulp::x86::V3::try_new().is_some(),
            Self::Avx512 => pulp::x86::V4::try_new().is_some(),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_available(self) -> bool {
        self == Self::Baseline
    }
}

/// All minima of each pair whose circles may be within `reach` of each other (one number for each pair), with the widest
/// instruction set there is. The slices are of one length.
pub fn circle_distance_approaches(pairs: &[(Circle, Circle)], reach: &[f64], out: &mut [Approaches]) {
    let widest = Instructions::available().last().unwrap_or(Instructions::Baseline);
    circle_distance_approaches_with(widest, pairs, reach, out);
}

/// [`circle_distance_approaches`] with a given instruction set, or one pair at a time where the machine lacks it.
pub fn circle_distance_approaches_with(
    set: Instructions,
    pairs: &[(Circle, Circle)],
    reach: &[f64],
    out: &mut [Approaches],
) {
    assert!(pairs.len() == reach.len() && pairs.len() == out.len(), "a reach and a place for each pair");
    let work = Work { pairs, reach, out };
    #[cfg(target_arch = "x86_64")]
    match set {
        Instructions::Avx512 => {
            if let Some(simd) = pulp::x86::V4::try_new() {
                return Simd::vectorize(simd, work);
            }
        }
        Instructions::Avx2 => {
            if let Some(simd) = pulp::x86::V3::try_new() {
                return Simd::vectorize(simd, work);
            }
        }
        Instructions::Baseline => {}
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = set;
    Simd::vectorize(Scalar, work);
}

/// A batch on its way into registers.
struct Work<'a> {
    pairs: &'a [(Circle, Circle)],
    reach: &'a [f64],
    out: &'a mut [Approaches],
}

impl WithSimd for Work<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Work { pairs, reach, out } = self;
        let (mut all, mut near, mut rows) = (Block::new(), Block::new(), Rows::new());
        for first in (0..pairs.len()).step_by(WIDTH) {
            let last = (first + WIDTH).min(pairs.len());
            all.count = 0;
            for index in first..last {
                all.push(index, &pairs[index]);
                out[index] = Approaches::NONE;
            }
            let mut floors = [0.0; WIDTH];
            for from in (0..WIDTH).step_by(S::F64_LANES) {
                all.load(simd, from).floor().store(&mut floors, from);
            }
            let mut within = [false; WIDTH];
            for lane in 0..all.count {
                within[lane] = floors[lane] <= reach[first + lane];
            }
            if within == [true; WIDTH] {
                simd.vectorize(Solve { block: &all, rows: &mut rows, pairs, out });
                continue;
            }
            for lane in (0..all.count).filter(|lane| within[*lane]) {
                near.push(first + lane, &pairs[first + lane]);
                if near.count == WIDTH {
                    simd.vectorize(Solve { block: &near, rows: &mut rows, pairs, out });
                    near.count = 0;
                }
            }
        }
        simd.vectorize(Solve { block: &near, rows: &mut rows, pairs, out });
    }
}

/// What the registers of a block leave in memory.
struct Rows {
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
    fn new() -> Self {
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

    /// Puts the minima of a pair in its place, which has none yet.
    #[inline(always)]
    fn put(&self, lane: usize, place: &mut Approaches) {
        let count = self.counts[lane];
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
struct Solve<'a> {
    block: &'a Block,
    rows: &'a mut Rows,
    pairs: &'a [(Circle, Circle)],
    out: &'a mut [Approaches],
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
