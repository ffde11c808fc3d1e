//! Angles as cosine and sine.

use crate::simd::SimdReal;

/// The grid starts at an angle that no symmetric design singles out.
pub(crate) const START_RAD: f64 = 0.123_456_789_101_112;

/// A direction on the moving circle.
#[derive(Clone, Copy, Default)]
pub(crate) struct Direction {
    pub cos: f64,
    pub sin: f64,
}

impl Direction {
    pub fn at(angle_rad: f64) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        Self { cos, sin }
    }

    /// Turned by twice the angle whose tangent is given.
    pub fn rotated_by_half_tan(self, tan: f64) -> Self {
        let inverse = 1.0 / (1.0 + tan * tan);
        let (cos, sin) = ((1.0 - tan * tan) * inverse, 2.0 * tan * inverse);
        Self { cos: self.cos * cos - self.sin * sin, sin: self.sin * cos + self.cos * sin }
    }

    /// Turned by `±` the angle of another.
    pub fn rotated_both_ways(self, by: Self) -> [Self; 2] {
        let (cc, ss) = (self.cos * by.cos, self.sin * by.sin);
        let (sc, cs) = (self.sin * by.cos, self.cos * by.sin);
        [Self { cos: cc + ss, sin: sc - cs }, Self { cos: cc - ss, sin: sc + cs }]
    }
}

/// An angle as its cosine and sine.
#[derive(Clone, Copy)]
pub(crate) struct Angle<T> {
    pub cos: T,
    pub sin: T,
}

impl<T: SimdReal> Angle<T> {
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Angle { cos: T::select(mask, yes.cos, no.cos), sin: T::select(mask, yes.sin, no.sin) }
    }

    /// A constant.
    #[inline(always)]
    pub fn splat(self, direction: Direction) -> Self {
        Angle { cos: self.cos.splat(direction.cos), sin: self.cos.splat(direction.sin) }
    }

    /// Turned by an angle of this cosine and sine.
    #[inline(always)]
    pub fn rotated(self, cos: T, sin: T) -> Self {
        Angle { cos: self.sin.neg_mul_add(sin, self.cos * cos), sin: self.cos.mul_add(sin, self.sin * cos) }
    }

    /// Turned by twice the angle whose tangent is `numerator / denominator`.
    #[inline(always)]
    pub fn rotated_by_half_tan(self, numerator: T, denominator: T) -> Self {
        let (square, whole) = (numerator * numerator, denominator * denominator);
        let inverse = numerator.splat(1.0) / (whole + square);
        // Divided last: the quotient takes as long as all else.
        let Angle { cos, sin } = self.rotated(whole - square, (numerator + numerator) * denominator);
        Angle { cos: cos * inverse, sin: sin * inverse }
    }
}
