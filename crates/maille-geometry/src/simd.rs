//! Numbers that the quick kernel is written in: one `f64`, or a register of them, one pair of circles in each.
//!
//! Only operations that IEEE 754 rounds in one way: every lane of an instruction set computes the same bits, whatever is
//! in the others. Products and sums are fused where the set can, so that two sets differ by rounding.

use pulp::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One number, or a register of numbers.
pub(crate) trait SimdReal:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    /// A truth value for each number.
    type Mask: Copy;
    /// A constant.
    fn splat(self, value: f64) -> Self;
    /// `self · factor + term`, rounded once or twice.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `from − self · factor`, rounded once or twice.
    fn neg_mul_add(self, factor: Self, from: Self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn and(p: Self::Mask, q: Self::Mask) -> Self::Mask;
    fn or(p: Self::Mask, q: Self::Mask) -> Self::Mask;
    fn any(mask: Self::Mask) -> bool;

    /// One more where it is true.
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
    fn neg_mul_add(self, factor: f64, from: f64) -> f64 {
        from - self * factor
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

/// A register of the instruction set `S`.
#[derive(Clone, Copy)]
pub(crate) struct Register<S: Simd> {
    pub simd: S,
    pub value: S::f64s,
}

/// A truth value for each number of a register.
#[derive(Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    value: S::m64s,
}

impl<S: Simd> Register<S> {
    /// One number in all lanes.
    #[inline(always)]
    pub fn broadcast(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// Some of the numbers of a row.
    #[inline(always)]
    pub fn load(simd: S, row: &[f64], from: usize) -> Self {
        Self { simd, value: S::as_simd_f64s(&row[from..from + S::F64_LANES]).0[0] }
    }

    #[inline(always)]
    pub fn store(self, row: &mut [f64], from: usize) {
        S::as_mut_simd_f64s(&mut row[from..from + S::F64_LANES]).0[0] = self.value;
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $of:ident) => {
        impl<S: Simd> $trait for Register<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self { simd: self.simd, value: self.simd.$of(self.value, other.value) }
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
    fn neg_mul_add(self, factor: Self, from: Self) -> Self {
        Self { simd: self.simd, value: self.simd.negate_mul_add_e_f64s(self.value, factor.value, from.value) }
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
