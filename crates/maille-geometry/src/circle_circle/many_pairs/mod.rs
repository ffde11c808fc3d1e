//! The minima of many pairs at once: the quick kernel on registers, one pair in each lane.
//!
//! Pairs that are certainly too far apart are sorted out first, those that remain fill the lanes, and what the quick
//! kernel cannot decide goes to [`circle_distance_minima`]. The instruction set is chosen when the program runs; two of them
//! differ by rounding, for some fuse products and sums.
//!
//! No closures in the kernels: what is not inlined into the function of an instruction set cannot use it.

mod block;
mod soa;

use crate::circle::Circle;
use crate::circle_circle::approach::Approaches;
use crate::circle_circle::many_pairs::block::{BlockKernel, LaneBuffers};
use crate::circle_circle::many_pairs::soa::{PairBlock, WIDTH};
use crate::simd::{Register, SimdReal};
use pulp::{Scalar, Simd, WithSimd};

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
    let kernel = BatchKernel { pairs, reach, out };
    #[cfg(target_arch = "x86_64")]
    match set {
        Instructions::Avx512 => {
            if let Some(simd) = pulp::x86::V4::try_new() {
                return Simd::vectorize(simd, kernel);
            }
        }
        Instructions::Avx2 => {
            if let Some(simd) = pulp::x86::V3::try_new() {
                return Simd::vectorize(simd, kernel);
            }
        }
        Instructions::Baseline => {}
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = set;
    Simd::vectorize(Scalar, kernel);
}

/// A batch on its way into registers.
struct BatchKernel<'a> {
    pairs: &'a [(Circle, Circle)],
    reach: &'a [f64],
    out: &'a mut [Approaches],
}

impl WithSimd for BatchKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let BatchKernel { pairs, reach, out } = self;
        let (mut all, mut near, mut buffers) = (PairBlock::new(), PairBlock::new(), LaneBuffers::new());
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
                let (zero, one) = (limit.splat(0.0), limit.splat(1.0));
                let is_beyond = all.load(simd, from).is_beyond(limit);
                <Register<S>>::select(is_beyond, one, zero).store(&mut beyond, from);
            }
            if beyond == [0.0; WIDTH] {
                simd.vectorize(BlockKernel { block: &all, buffers: &mut buffers, pairs, out });
                continue;
            }
            for lane in 0..all.count {
                if beyond[lane] == 1.0 {
                    out[first + lane] = Approaches::NONE;
                    continue;
                }
                near.push(first + lane, &pairs[first + lane]);
                if near.count == WIDTH {
                    simd.vectorize(BlockKernel { block: &near, buffers: &mut buffers, pairs, out });
                    near.count = 0;
                }
            }
        }
        simd.vectorize(BlockKernel { block: &near, buffers: &mut buffers, pairs, out });
    }
}
