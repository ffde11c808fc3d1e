//! The minima of many pairs at once: the quick kernel on registers, one pair in each lane.
//!
//! Pairs that are certainly too far apart are sorted out first, those that remain fill the lanes, and what the quick
//! kernel cannot decide goes to [`circle_distance_minima`]. The instruction set is chosen when the program runs; two of them
//! differ by rounding, for some fuse products and sums.
//!
//! No closures in the kernels: what is not inlined into the function of an instruction set cannot use it.

use crate::circle::are_sound;
use crate::grid::Direction;
use crate::lane::{Lane, Register};
use crate::placed::{Block, WIDTH};
use crate::quick;
use crate::relative::Relative;
use crate::solve::{Rows, Solve};
use crate::{Circle, MAX_MINIMA, PairKind, Vec3, circle_distance_minima};
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

    /// The minima.
    pub fn as_slice(&self) -> &[Approach] {
        &self.found[..self.count]
    }

    /// The distance is constant along a whole circle, as in [`Minima`](crate::Minima): one representative is given.
    pub fn continuum(&self) -> bool {
        self.continuum
    }

    /// The special position of the pair that these are the minima of, as [`circle_distance_minima`] reports it.
    pub fn kind(&self, a: &Circle, b: &Circle) -> PairKind {
        // Nearly every pair is told at once by planes and centres that are apart.
        let offset_sq = (b.center - a.center).norm_squared();
        let scale_sq = offset_sq.max(a.radius * a.radius).max(b.radius * b.radius);
        let tilt_sq = a.normal.cross(&b.normal).norm_squared();
        if tilt_sq > 1e-24 && offset_sq > 1e-24 * scale_sq && !self.continuum {
            return PairKind::Generic;
        }
        let pair = if a.radius < b.radius { Relative::new(b, a) } else { Relative::new(a, b) };
        match pair.kind() {
            PairKind::Coaxial => PairKind::Coaxial,
            _ if self.continuum => PairKind::Equidistant,
            kind => kind,
        }
    }

    /// By the complete enumeration of one pair.
    pub(crate) fn of_pair(a: &Circle, b: &Circle) -> Self {
        let (mut out, mut continuum) = (Self::NONE, false);
        if !are_sound(a, b) {
            out.found[0] = Approach { distance: f64::NAN, direction_b: Vec3::repeat(f64::NAN) };
            out.count = 1;
            return out;
        }
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
                let minima = circle_distance_minima(a, b);
                continuum = minima.continuum;
                for minimum in minima.as_slice() {
                    add(minimum.distance, (minimum.point_b - b.center) / b.radius);
                }
            }
        }
        out.continuum = continuum;
        let count = out.count;
        out.found[..count].sort_unstable_by(|p, q| p.distance.total_cmp(&q.distance));
        out
    }
}

impl PartialEq for Approaches {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
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
            }
            let mut limits = [f64::INFINITY; WIDTH];
            limits[..all.count].copy_from_slice(&reach[first..last]);
            let mut beyond = [0.0; WIDTH];
            let within = if limits == [f64::INFINITY; WIDTH] { WIDTH } else { 0 };
            for from in (within..WIDTH).step_by(S::F64_LANES) {
                let limit = Register::load(simd, &limits, from);
                let (zero, one) = (limit.like(0.0), limit.like(1.0));
                let is_beyond = all.load(simd, from).is_beyond(limit);
                <Register<S>>::pick(is_beyond, one, zero).store(&mut beyond, from);
            }
            if beyond == [0.0; WIDTH] {
                simd.vectorize(Solve { block: &all, rows: &mut rows, pairs, out });
                continue;
            }
            for lane in 0..all.count {
                if beyond[lane] == 1.0 {
                    out[first + lane] = Approaches::NONE;
                    continue;
                }
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
