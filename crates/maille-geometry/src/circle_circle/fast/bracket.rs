//! Brackets.

use crate::circle_circle::angle::Angle;
use crate::circle_circle::fast::arc_tables::ArcLevel;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Minima of a register's pairs; a third one has never been seen.
pub(crate) const MAX_SIMD_MINIMA: usize = 2;
/// An arc at whose ends G₋ is negative and positive, with one root between.
#[derive(Clone, Copy)]
pub(crate) struct Bracket<T> {
    pub middle: Angle<T>,
    /// tan of a quarter of its width.
    pub quarter_tan: T,
    /// Half of its width, and the turn whose half has the tangent `quarter_tan / 2`.
    half_width: Angle<T>,
    seed_turn: Angle<T>,
}

impl<T: SimdReal> Bracket<T> {
    #[inline(always)]
    pub fn new(middle: Angle<T>, quarter_tan: T) -> Self {
        let (one, zero) = (quarter_tan.splat(1.0), quarter_tan.splat(0.0));
        let zero_angle = Angle { cos: one, sin: zero };
        Bracket {
            middle,
            quarter_tan,
            half_width: zero_angle.rotated_by_half_tan(quarter_tan, one),
            seed_turn: zero_angle.rotated_by_half_tan(quarter_tan, one + one),
        }
    }

    /// One of the arcs of a level, by its centre.
    #[inline(always)]
    pub fn on_arc(level: &ArcLevel, middle: Angle<T>) -> Self {
        let (half_width, seed_turn) = (Angle::splat(middle, level.half_width), Angle::splat(middle, level.seed_turn));
        Bracket { middle, quarter_tan: middle.cos.splat(level.quarter_tan), half_width, seed_turn }
    }

    /// As numbers, for the way out of a register and back.
    #[inline(always)]
    pub fn to_array(&self) -> [T; 3] {
        [self.middle.cos, self.middle.sin, self.quarter_tan]
    }

    /// From its numbers.
    #[inline(always)]
    pub fn from_array([cos, sin, quarter_tan]: [T; 3]) -> Self {
        Bracket::new(Angle { cos, sin }, quarter_tan)
    }

    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Bracket {
            middle: Angle::select(mask, yes.middle, no.middle),
            quarter_tan: T::select(mask, yes.quarter_tan, no.quarter_tan),
            half_width: Angle::select(mask, yes.half_width, no.half_width),
            seed_turn: Angle::select(mask, yes.seed_turn, no.seed_turn),
        }
    }

    /// Where a parabola through three values of G₋ is 0: in the middle, at the end on the root's side, and between.
    #[inline(always)]
    pub fn initial_guess(&self, pair: &NormalizedPair<T>) -> Angle<T> {
        let middle = pair.rho_slope(self.middle.cos, self.middle.sin);
        let (zero, one) = (middle.splat(0.0), middle.splat(1.0));
        let side = T::select(middle.lt(zero), one, -one);
        let at = self.middle.rotated(self.half_width.cos, side * self.half_width.sin);
        let end = pair.rho_slope(at.cos, at.sin) * side;
        let at = self.middle.rotated(self.seed_turn.cos, side * self.seed_turn.sin);
        let part = pair.rho_slope(at.cos, at.sin) * side;
        // From −m in the middle it rises over `part` to `end`: −m + u (rise + u bend), 0 ≤ u ≤ 1.
        let (m, two) = (middle.abs(), one + one);
        let bend = (part.neg_mul_add(two, end) - m) * 2.0;
        let rise = end + m - bend;
        let root = (bend * 4.0).mul_add(m, rise * rise).max(zero).sqrt();
        self.middle.rotated_by_half_tan((m + m) * (self.quarter_tan * side), (rise + root).max(zero.splat(1e-100)))
    }

    /// Whether an angle lies on the arc, to rounding.
    #[inline(always)]
    pub fn contains(&self, at: Angle<T>) -> T::Mask {
        let across = self.middle.sin.neg_mul_add(at.cos, self.middle.cos * at.sin);
        let along = self.middle.cos.mul_add(at.cos, self.middle.sin * at.sin);
        // tan(δ/2) = sin δ/(1 + cos δ)
        across.abs().lt((along + along.splat(1.0)).mul_add(self.quarter_tan, along.splat(1e-12)))
    }
}
