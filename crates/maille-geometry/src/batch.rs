//! The minima of many pairs at once: the quick kernel on registers, one pair in each lane.
//!
//! Pairs that are certainly too far apart are sorted out first, those that remain fill the lanes, and what the quick
//! kernel cannot decide goes to [`circle_distance_minima`]. The instruction set is chosen when the program runs; every one
//! gives the same bits, for [`crate::lane`] has no operation that rounds differently.
//!
//! No closures in the kernels: what is not inlined into the function of an instruction set cannot use it.

use crate::count::TABLE;
use crate::grid::Direction;
use crate::lane::{Lane, Register};
use crate::quick::{self, Angle, Found, SLOTS, minima_of_lanes};
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

/// Pairs side by side: the most lanes of a register.
const WIDTH: usize = 8;
/// Numbers of a pair: centre, normal and radius of A, then of B.
const NUMBERS: usize = 14;

/// Pairs as a structure of arrays.
struct Block {
    numbers: [[f64; WIDTH]; NUMBERS],
    index: [usize; WIDTH],
    count: usize,
}

impl Block {
    /// Full of one harmless pair.
    fn new() -> Self {
        let one = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0];
        Self { numbers: one.map(|x| [x; WIDTH]), index: [0; WIDTH], count: 0 }
    }

    #[inline(always)]
    fn push(&mut self, index: usize, (a, b): &(Circle, Circle)) {
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

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, from: usize) -> Placed<Register<S>> {
        Placed {
            between: minus(self.vector(simd, 7, from), self.vector(simd, 0, from)),
            normals: [self.vector(simd, 3, from), self.vector(simd, 10, from)],
            radii: [self.number(simd, 6, from), self.number(simd, 13, from)],
        }
    }

    #[inline(always)]
    fn number<S: Simd>(&self, simd: S, k: usize, from: usize) -> Register<S> {
        Register { simd, value: S::as_simd_f64s(&self.numbers[k][from..from + S::F64_LANES]).0[0] }
    }

    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, k: usize, from: usize) -> Vector<Register<S>> {
        [self.number(simd, k, from), self.number(simd, k + 1, from), self.number(simd, k + 2, from)]
    }
}

type Vector<T> = [T; 3];

#[inline(always)]
fn minus<T: Lane>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
fn dot<T: Lane>(p: Vector<T>, q: Vector<T>) -> T {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
fn cross<T: Lane>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

#[inline(always)]
fn sum<T: Lane>(p: Vector<T>, by: T, q: Vector<T>, times: T) -> Vector<T> {
    [p[0] * by + q[0] * times, p[1] * by + q[1] * times, p[2] * by + q[2] * times]
}

#[inline(always)]
fn choose<T: Lane>(mask: T::Mask, yes: Vector<T>, no: Vector<T>) -> Vector<T> {
    [T::pick(mask, yes[0], no[0]), T::pick(mask, yes[1], no[1]), T::pick(mask, yes[2], no[2])]
}

/// The pairs of a register: from the centre of A to that of B, normals and radii.
struct Placed<T> {
    between: Vector<T>,
    normals: [Vector<T>; 2],
    radii: [T; 2],
}

/// The minima of a register: for each slot distance and direction on B.
struct Answer<T> {
    slots: [(T, Vector<T>); SLOTS],
    count: T,
    complete: T,
}

/// Sines of the planes' angle below this go to the single kernel.
const LEAST_TILT: f64 = 1e-7;

impl<T: Lane> Placed<T> {
    /// [`crate::circle_distance_floor`].
    #[inline(always)]
    fn floor(&self) -> T {
        let zero = self.radii[0].like(0.0);
        let apart_sq = dot(self.between, self.between);
        let apart = apart_sq.sqrt();
        let cos = dot(self.normals[0], self.normals[1]);
        let sin = (zero.like(1.0) - cos * cos).max(zero).sqrt();
        let mut over = [zero; 2];
        for (base, moving) in [(0, 1), (1, 0)] {
            let height = dot(self.normals[base], self.between);
            let from_axis = (apart_sq - height * height).max(zero).sqrt();
            let rise = (height.abs() - self.radii[moving] * sin).max(zero);
            let radial = ((from_axis - self.radii[base]).abs() - self.radii[moving]).max(zero);
            over[base] = rise * rise + radial * radial;
        }
        let size = apart + self.radii[0] + self.radii[1];
        let spheres = apart - self.radii[0] - self.radii[1];
        let inside = (self.radii[0] - self.radii[1]).abs() - apart;
        let floor = spheres.max(inside).max(over[0].max(over[1]).sqrt()) - size * 1e-7;
        floor.max(zero)
    }

    /// The register's minima; the numbers of a pair are those of [`crate::relative::Relative`].
    #[inline(always)]
    fn minima(&self) -> Answer<T> {
        let one = self.radii[0].like(1.0);
        let zero = self.radii[0].like(0.0);
        // The smaller circle moves; B, if they are equal.
        let swapped = self.radii[0].below(self.radii[1]);
        let base_normal = choose(swapped, self.normals[1], self.normals[0]);
        let normal = choose(swapped, self.normals[0], self.normals[1]);
        let base_radius = T::pick(swapped, self.radii[1], self.radii[0]);
        let radius = T::pick(swapped, self.radii[0], self.radii[1]);
        let [bx, by, bz] = self.between;
        let between = choose(swapped, [-bx, -by, -bz], self.between);
        let scale = dot(between, between).sqrt().max(base_radius).max(radius);
        let inverse = one / scale;
        let tilt = cross(normal, base_normal);
        let flat = sum(tilt, one, base_normal, -dot(base_normal, tilt));
        let length = dot(flat, flat).sqrt();
        let along = one / length;
        let y = [flat[0] * along, flat[1] * along, flat[2] * along];
        let x = cross(y, base_normal);
        let offset = [dot(x, between) * inverse, dot(y, between) * inverse, dot(base_normal, between) * inverse];
        let pair =
            Reduced::new(base_radius * inverse, radius * inverse, offset, dot(base_normal, normal), dot(y, tilt));
        let Found { angles, count, complete } = minima_of_lanes(&pair, &TABLE);
        let steepest = cross(y, normal);
        let mut slots = [(zero, x); SLOTS];
        for k in 0..SLOTS {
            let Angle { cos, sin } = angles[k];
            let moving = sum(steepest, cos, y, sin);
            let [ex, ey, rho] = pair.foot(cos, sin);
            let foot = one / rho;
            let base = sum(x, ex * foot, y, ey * foot);
            slots[k] = (pair.distance(cos, sin) * scale, choose(swapped, base, moving));
        }
        let tilted = zero.like(LEAST_TILT).below(length);
        Answer { slots, count, complete: T::pick(tilted, complete, zero) }
    }
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
fn store<S: Simd>(register: Register<S>, to: &mut [f64; WIDTH], from: usize) {
    S::as_mut_simd_f64s(&mut to[from..from + S::F64_LANES]).0[0] = register.value;
}

/// The minima of the pairs of a block, put in their places.
#[inline(always)]
fn solve<S: Simd>(simd: S, block: &Block, pairs: &[(Circle, Circle)], out: &mut [Approaches]) {
    let (mut count, mut complete) = ([0.0; WIDTH], [0.0; WIDTH]);
    let mut distance = [[0.0; WIDTH]; SLOTS];
    let mut direction = [[[0.0; WIDTH]; 3]; SLOTS];
    for from in (0..block.count).step_by(S::F64_LANES) {
        let answer = block.load(simd, from).minima();
        store(answer.count, &mut count, from);
        store(answer.complete, &mut complete, from);
        for slot in 0..SLOTS {
            let (d, v) = answer.slots[slot];
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
        there.count = count[lane] as usize;
        for slot in 0..there.count {
            there.found[slot] = approach(slot);
        }
        if there.count == 2 && there.found[1].distance < there.found[0].distance {
            there.found.swap(0, 1);
        }
    }
}
