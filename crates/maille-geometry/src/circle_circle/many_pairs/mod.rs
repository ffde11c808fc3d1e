//! The minima of many pairs at once, by the fast method in SIMD registers with one pair per lane.
//!
//! Pairs that are certainly too far apart are discarded first; the remaining ones are collected into blocks
//! (`soa.rs`) and solved (`block.rs`); pairs that the registers cannot decide go to the code for one pair. The
//! instruction set is chosen at run time. Results of different sets differ by rounding, because some fuse
//! multiplications with additions.

mod block;
mod soa;

use crate::circle::Circle;
use crate::circle_circle::approach::Approaches;
use crate::circle_circle::many_pairs::block::{BlockKernel, LaneBuffers};
use crate::circle_circle::many_pairs::soa::{PairBlock, WIDTH};
use crate::simd::{Register, SimdReal};
use pulp::{Scalar, Simd, WithSimd};

/// A SIMD instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// Plain `f64`: one pair at a time.
    Baseline,
    /// AVX2 with FMA: four pairs at a time.
    Avx2,
    /// AVX-512: eight pairs at a time.
    Avx512,
}

impl Instructions {
    /// The sets that this machine supports, the widest last.
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

/// All local minima of the distance for many pairs of circles, with the widest instruction set of this machine.
///
/// For each pair `k`, `out[k]` receives the minima of `pairs[k]`, complete and as accurate as those of
/// [`circle_distance_minima`](crate::circle_distance_minima), with the same degenerate cases and the same treatment
/// of invalid input. If the circles are certainly more than `reach[k]` apart (a length; infinity to disable the
/// test), `out[k]` is [`Approaches::NONE`]; otherwise all minima are returned, including those beyond the reach.
///
/// The result for a pair does not depend on the other pairs. On machines with other instruction sets it may differ by
/// rounding.
///
/// # Panics
///
/// If the slices differ in length.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Approaches, Circle, Vec3, circle_distance_approaches};
///
/// let a = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
/// let near = Circle::new(Vec3::new(0.8, 0.0, 0.0), Vec3::y_axis(), 1.0);
/// let far = Circle::new(Vec3::new(9.0, 0.0, 0.0), Vec3::y_axis(), 1.0);
/// let mut out = [Approaches::NONE; 2];
/// circle_distance_approaches(&[(a, near), (a, far)], &[1.0, 1.0], &mut out);
/// assert!((out[0].as_slice()[0].distance - 0.8).abs() < 1e-15);
/// assert!(out[1].as_slice().is_empty());
/// ```
pub fn circle_distance_approaches(pairs: &[(Circle, Circle)], reach: &[f64], out: &mut [Approaches]) {
    let widest = Instructions::available().last().unwrap_or(Instructions::Baseline);
    circle_distance_approaches_with(widest, pairs, reach, out);
}

/// [`circle_distance_approaches`] with a given instruction set, or in plain `f64` if the machine does not support it.
///
/// # Panics
///
/// If the slices differ in length.
pub fn circle_distance_approaches_with(
    set: Instructions,
    pairs: &[(Circle, Circle)],
    reach: &[f64],
    out: &mut [Approaches],
) {
    assert!(pairs.len() == reach.len() && pairs.len() == out.len(), "pairs, reach and out must be of the same length");
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

/// The arguments of a batch, to be run with an instruction set.
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
            // Load the next pairs.
            all.count = 0;
            for index in first..last {
                all.push(index, &pairs[index]);
            }
            // Which are certainly out of reach? Nothing to test if all reaches are infinite.
            let mut limits = [f64::INFINITY; WIDTH];
            limits[..all.count].copy_from_slice(&reach[first..last]);
            let mut beyond = [0.0; WIDTH];
            let first_tested = if limits == [f64::INFINITY; WIDTH] { WIDTH } else { 0 };
            for from in (first_tested..WIDTH).step_by(S::F64_LANES) {
                let limit = Register::load(simd, &limits, from);
                let (zero, one) = (limit.splat(0.0), limit.splat(1.0));
                let is_beyond = all.load(simd, from).is_beyond(limit);
                <Register<S>>::select(is_beyond, one, zero).store(&mut beyond, from);
            }
            // All within reach: solve the block as it is.
            if beyond == [0.0; WIDTH] {
                simd.vectorize(BlockKernel { block: &all, buffers: &mut buffers, pairs, out });
                continue;
            }
            // Otherwise collect those within reach until a block is full.
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
