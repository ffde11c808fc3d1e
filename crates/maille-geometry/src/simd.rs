//! The numbers that the fast method is written in: one `f64`, or a SIMD register with one value per lane.
//!
//! Kernels are generic over [`SimdReal`] and compiled once for `f64` and once per instruction set, through `pulp`.
//! All operations are correctly rounded (IEEE 754), so every lane gives the same bits whatever the other lanes
//! hold. The one difference between instruction sets is [`SimdReal::mul_add`], fused where the hardware can: they
//! differ by rounding.
//!
//! Kernels contain no closures: a closure is not always inlined into the function that enables the instruction set,
//! and then runs without it.

use pulp::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or a register of real numbers. Operations act lane by lane.
///
/// Call the methods through a type parameter only: on a plain `f64`, `x.mul_add(…)` means the always fused method
/// of the standard library.
pub(crate) trait SimdReal:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    /// One truth value per lane.
    type Mask: Copy;
    /// The same value in every lane; `self` serves only to name the instruction set.
    fn splat(self, value: f64) -> Self;
    /// `self · factor + term`, rounded once (fused) or twice, depending on the instruction set.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `term − self · factor`, rounded like [`Self::mul_add`].
    fn neg_mul_add(self, factor: Self, term: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The larger of the two.
    fn max(self, other: Self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// `p ∧ q`.
    fn and(p: Self::Mask, q: Self::Mask) -> Self::Mask;
    /// `p ∨ q`.
    fn or(p: Self::Mask, q: Self::Mask) -> Self::Mask;
    /// Is the mask true in any lane?
    fn any(mask: Self::Mask) -> bool;

    /// `self + 1` where the mask is true, `self` elsewhere.
    #[inline(always)]
    fn add_one_if(self, mask: Self::Mask) -> Self {
        Self::select(mask, self + self.splat(1.0), self)
    }
}

impl SimdReal for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn mul_add(self, factor: f64, term: f64) -> f64 {
        self * factor + term
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: f64, term: f64) -> f64 {
        term - self * factor
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        f64::max(self, other)
    }

    #[inline(always)]
    fn lt(self, other: f64) -> bool {
        self < other
    }

    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn and(p: bool, q: bool) -> bool {
        p & q
    }

    #[inline(always)]
    fn or(p: bool, q: bool) -> bool {
        p | q
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
}

/// A register of `f64` lanes of the instruction set `S`.
#[derive(Clone, Copy)]
pub(crate) struct Register<S: Simd> {
    pub simd: S,
    pub value: S::f64s,
}

/// One truth value per lane of a register.
#[derive(Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    value: S::m64s,
}

impl<S: Simd> Register<S> {
    /// The same value in every lane.
    #[inline(always)]
    pub fn broadcast(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// Loads `S::F64_LANES` values, beginning at index `from`.
    #[inline(always)]
    pub fn load(simd: S, values: &[f64], from: usize) -> Self {
        Self { simd, value: S::as_simd_f64s(&values[from..from + S::F64_LANES]).0[0] }
    }

    /// Stores the lanes, beginning at index `from`.
    #[inline(always)]
    pub fn store(self, values: &mut [f64], from: usize) {
        S::as_mut_simd_f64s(&mut values[from..from + S::F64_LANES]).0[0] = self.value;
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $method:ident) => {
        impl<S: Simd> $trait for Register<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self { simd: self.simd, value: self.simd.$method(self.value, other.value) }
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Register<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { simd: self.simd, value: self.simd.neg_f64s(self.value) }
    }
}

impl<S: Simd> Mul<f64> for Register<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * self.splat(factor)
    }
}

impl<S: Simd> SimdReal for Register<S> {
    type Mask = Mask<S>;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self { simd: self.simd, value: self.simd.splat_f64s(value) }
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self { simd: self.simd, value: self.simd.mul_add_e_f64s(self.value, factor.value, term.value) }
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        Self { simd: self.simd, value: self.simd.negate_mul_add_e_f64s(self.value, factor.value, term.value) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self { simd: self.simd, value: self.simd.sqrt_f64s(self.value) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self { simd: self.simd, value: self.simd.abs_f64s(self.value) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.max_f64s(self.value, other.value) }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, value: self.simd.less_than_f64s(self.value, other.value) }
    }

    #[inline(always)]
    fn select(mask: Mask<S>, yes: Self, no: Self) -> Self {
        Self { simd: yes.simd, value: yes.simd.select_f64s(mask.value, yes.value, no.value) }
    }

    #[inline(always)]
    fn and(p: Mask<S>, q: Mask<S>) -> Mask<S> {
        Mask { simd: p.simd, value: p.simd.and_m64s(p.value, q.value) }
    }

    #[inline(always)]
    fn or(p: Mask<S>, q: Mask<S>) -> Mask<S> {
        Mask { simd: p.simd, value: p.simd.or_m64s(p.value, q.value) }
    }

    #[inline(always)]
    fn any(mask: Mask<S>) -> bool {
        mask.simd.first_true_m64s(mask.value) < S::F64_LANES
    }
}
