//! Angles θ on the moving circle, stored as cosine and sine so that no trigonometric function is evaluated in a loop.
//!
//! [`Direction`] is for plain `f64` and for tables, [`Angle`] for code that also runs on SIMD registers. Both
//! rotate by twice an angle whose tangent is known: with `t = tan(δ/2)`, `cos δ = (1 − t²)/(1 + t²)` and
//! `sin δ = 2t/(1 + t²)`. Their roundings differ, so one cannot replace the other.

use crate::simd::SimdReal;

/// Start of all subdivisions of the circle: an arbitrary angle, so that the extrema of symmetric pairs do not fall
/// on ends of arcs.
pub(crate) const START_RAD: f64 = 0.123_456_789_101_112;

/// An angle in `f64`.
#[derive(Clone, Copy, Default)]
pub(crate) struct Direction {
    pub cos: f64,
    pub sin: f64,
}

impl Direction {
    /// The direction at an angle in radians.
    pub fn at(angle_rad: f64) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        Self { cos, sin }
    }

    /// Rotated by δ, given `tan(δ/2)`.
    pub fn rotated_by_half_tan(self, tan: f64) -> Self {
        let inverse = 1.0 / (1.0 + tan * tan);
        let (cos, sin) = ((1.0 - tan * tan) * inverse, 2.0 * tan * inverse);
        Self { cos: self.cos * cos - self.sin * sin, sin: self.sin * cos + self.cos * sin }
    }

    /// Rotated backwards and forwards by the angle of `by`.
    pub fn rotated_both_ways(self, by: Self) -> [Self; 2] {
        let (cc, ss) = (self.cos * by.cos, self.sin * by.sin);
        let (sc, cs) = (self.sin * by.cos, self.cos * by.sin);
        [Self { cos: cc + ss, sin: sc - cs }, Self { cos: cc - ss, sin: sc + cs }]
    }
}

/// An angle, or one angle per lane of a register.
#[derive(Clone, Copy)]
pub(crate) struct Angle<T> {
    pub cos: T,
    pub sin: T,
}

impl<T: SimdReal> Angle<T> {
    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Angle { cos: T::select(mask, yes.cos, no.cos), sin: T::select(mask, yes.sin, no.sin) }
    }

    /// The same direction in every lane.
    #[inline(always)]
    pub fn splat(self, direction: Direction) -> Self {
        Angle { cos: self.cos.splat(direction.cos), sin: self.cos.splat(direction.sin) }
    }

    /// Rotated by the angle with this cosine and sine.
    #[inline(always)]
    pub fn rotated(self, cos: T, sin: T) -> Self {
        Angle { cos: self.sin.neg_mul_add(sin, self.cos * cos), sin: self.cos.mul_add(sin, self.sin * cos) }
    }

    /// Rotated by δ, with `tan(δ/2) = numerator / denominator`.
    #[inline(always)]
    pub fn rotated_by_half_tan(self, numerator: T, denominator: T) -> Self {
        let (square, whole) = (numerator * numerator, denominator * denominator);
        let inverse = numerator.splat(1.0) / (whole + square);
        // The division runs in parallel with the rotation and is applied last: it takes as long as all else.
        let Angle { cos, sin } = self.rotated(whole - square, (numerator + numerator) * denominator);
        Angle { cos: cos * inverse, sin: sin * inverse }
    }
}
