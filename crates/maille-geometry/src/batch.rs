//! The minima of many pairs at once: the quick kernel on registers, one pair in each lane.
//!
//! Pairs that are certainly too far apart are sorted out first, those that remain fill the lanes, and what the quick
//! kernel cannot decide goes to [`circle_distance_minima`]. The instruction set is chosen when the program runs; every one
//! gives the same bits, for [`crate::lane`] has no operation that rounds differently.
//!
//! No closures in the kernels: what is not inlined into the function of an instruction set cannot use it.

use crate::brackets::{Bracket, Brackets, Counted, SLOTS, is_steep};
use crate::count::{ARCS, TABLE};
use crate::grid::Direction;
use crate::lane::{Lane, Register};
use crate::placed::{Block, WIDTH};
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
        let mut near = Block::new();
        for first in (0..self.pairs.len()).step_by(WIDTH) {
            let mut all = Block::new();
            let last = (first + WIDTH).min(self.pairs.len());
            for index in first..last {
                all.push(index, &self.pairs[index]);
            }
            let mut floors = [0.0; WIDTH];
            for from in (0..WIDTH).step_by(S::F64_LANES) {
                store(all.load(simd, from).floor(), &mut floors, from);
            }
            for index in first..last {
                self.out[index] = Approaches::NONE;
                if floors[index - first] <= self.reach[index] {
                    near.push(index, &self.pairs[index]);
                    if near.count == WIDTH {
                        solve(simd, &near, self.pairs, self.out);
                        near.count = 0;
                    }
                }
            }
        }
        solve(simd, &near, self.pairs, self.out);
    }
}

#[inline(always)]
fn store<S: Simd>(register: Register<S>, to: &mut Row, from: usize) {
    S::as_mut_simd_f64s(&mut to[from..from + S::F64_LANES]).0[0] = register.value;
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &Row, from: usize) -> Register<S> {
    Register { simd, value: S::as_simd_f64s(&row[from..from + S::F64_LANES]).0[0] }
}

/// One number of each pair of a block.
type Row = [f64; WIDTH];

/// Numbers of a bracket.
const PARTS: usize = 5;

/// The brackets of a register with arcs in doubt: those pairs leave the register for a while.
#[inline(always)]
fn decided<S: Simd>(
    simd: S,
    pair: &Reduced<Register<S>>,
    counted: &Counted<Register<S>>,
    (brackets, count): ([Bracket<Register<S>>; SLOTS], Register<S>),
) -> ([Bracket<Register<S>>; SLOTS], Register<S>) {
    let mut doubts = [0.0; WIDTH];
    store(counted.doubts(), &mut doubts, 0);
    let (mut excess, mut minus) = ([[0.0; WIDTH]; ARCS], [[0.0; WIDTH]; ARCS]);
    for k in 0..ARCS {
        store(counted.excess[k], &mut excess[k], 0);
        store(counted.minus[k], &mut minus[k], 0);
    }
    let mut numbers = [[0.0; WIDTH]; 7];
    for (row, number) in numbers.iter_mut().zip(pair.numbers()) {
        store(number, row, 0);
    }
    let mut parts = [[[0.0; WIDTH]; PARTS]; SLOTS];
    let mut counts = [0.0; WIDTH];
    store(count, &mut counts, 0);
    for (rows, bracket) in parts.iter_mut().zip(&brackets) {
        for (row, part) in rows.iter_mut().zip(bracket.parts()) {
            store(part, row, 0);
        }
    }
    for lane in 0..S::F64_LANES {
        if doubts[lane] != 0.0 {
            counts[lane] = decide(lane, &numbers, &excess, &minus, &mut parts);
        }
    }
    let mut brackets = brackets;
    for (bracket, rows) in brackets.iter_mut().zip(&parts) {
        let mut parts = bracket.parts();
        for (part, row) in parts.iter_mut().zip(rows) {
            *part = load(simd, row, 0);
        }
        *bracket = Bracket::of_parts(parts);
    }
    (brackets, load(simd, &counts, 0))
}

/// The brackets of one pair of a block, and how many: 0 if that is not to be decided here.
fn decide(
    lane: usize,
    numbers: &[Row; 7],
    excess: &[Row; ARCS],
    minus: &[Row; ARCS],
    parts: &mut [[Row; PARTS]; SLOTS],
) -> f64 {
    let pair = Reduced::of_numbers(numbers.map(|row| row[lane]));
    let counted = Counted { excess: excess.map(|row| row[lane]), minus: minus.map(|row| row[lane]) };
    match Brackets::new(&pair, &counted, &TABLE) {
        Some(found) if (1..=SLOTS).contains(&found.count) => {
            for (slot, rows) in parts.iter_mut().enumerate() {
                for (row, part) in rows.iter_mut().zip(found.all[slot.min(found.count - 1)].parts()) {
                    row[lane] = part;
                }
            }
            found.count as f64
        }
        _ => 0.0,
    }
}

/// The minima of the pairs of a block, put in their places.
#[inline(always)]
fn solve<S: Simd>(simd: S, block: &Block, pairs: &[(Circle, Circle)], out: &mut [Approaches]) {
    let table = &*TABLE;
    let (mut counts, mut complete) = ([0.0; WIDTH], [0.0; WIDTH]);
    let mut distance = [[0.0; WIDTH]; SLOTS];
    let mut direction = [[[0.0; WIDTH]; 3]; SLOTS];
    for from in (0..block.count).step_by(S::F64_LANES) {
        let framed = block.load(simd, from).framed();
        let pair = &framed.pair;
        let counted = Counted::new(pair, table);
        let zero = pair.radius.like(0.0);
        let mut rising = counted.rising(table);
        if <Register<S>>::any(zero.below(counted.doubts())) {
            rising = decided(simd, pair, &counted, rising);
        }
        let (brackets, count) = rising;
        let (angles, good) = roots(pair, &brackets, SLOTS);
        let few = <Register<S>>::both(zero.below(count), count.below(zero.like(SLOTS as f64 + 0.5)));
        let regular = <Register<S>>::both(few, <Register<S>>::both(is_steep(pair), framed.is_tilted()));
        store(count, &mut counts, from);
        store(<Register<S>>::pick(regular, good[0] * good[1], zero), &mut complete, from);
        for slot in 0..SLOTS {
            let (d, v) = framed.approach(angles[slot]);
            store(d, &mut distance[slot], from);
            for axis in 0..3 {
                store(v[axis], &mut direction[slot][axis], from);
            }
        }
    }
    for lane in 0..block.count {
        let index = block.index[lane];
        if complete[lane] != 1.0 {
            let (a, b) = &pairs[index];
            out[index] = Approaches::of_pair(a, b);
            continue;
        }
        let approach = |slot: usize| Approach {
            distance: distance[slot][lane],
            direction_b: Vec3::from(direction[slot].map(|axis| axis[lane])),
        };
        let there = &mut out[index];
        there.count = counts[lane] as usize;
        for slot in 0..there.count {
            there.found[slot] = approach(slot);
        }
        if there.count == 2 && there.found[1].distance < there.found[0].distance {
            there.found.swap(0, 1);
        }
    }
}
