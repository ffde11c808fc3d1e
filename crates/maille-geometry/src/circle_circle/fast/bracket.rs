//! A bracket: an arc at whose ends `h′` is negative and positive, with exactly one root, a minimum, between.

use crate::circle_circle::angle::Angle;
use crate::circle_circle::fast::arc_tables::ArcLevel;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Minima per pair that the batch code handles in registers. A third one has never been observed.
pub(crate) const MAX_SIMD_MINIMA: usize = 2;

/// An arc with one minimum inside, given by its middle and its width.
#[derive(Clone, Copy)]
pub(crate) struct Bracket<T> {
    /// The middle of the arc.
    pub middle: Angle<T>,
    /// `T`, the tangent of a quarter of the width.
    pub quarter_tan: T,
    /// Half of the width.
    half_width: Angle<T>,
    /// The rotation by δ with `tan(δ/2) = T/2`, to the third sample of the initial guess.
    seed_turn: Angle<T>,
}

impl<T: SimdReal> Bracket<T> {
    /// The arc with this middle and width.
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

    /// The arc with this middle and one of the tabulated widths.
    #[inline(always)]
    pub fn on_arc(level: &ArcLevel, middle: Angle<T>) -> Self {
        let (half_width, seed_turn) = (Angle::splat(middle, level.half_width), Angle::splat(middle, level.seed_turn));
        Bracket { middle, quarter_tan: middle.cos.splat(level.quarter_tan), half_width, seed_turn }
    }

    /// The arguments of [`Self::new`] (cosine, sine, `T`), for storing in memory.
    #[inline(always)]
    pub fn parameters(&self) -> [T; 3] {
        [self.middle.cos, self.middle.sin, self.quarter_tan]
    }

    /// The inverse of [`Self::parameters`].
    #[inline(always)]
    pub fn from_parameters([cos, sin, quarter_tan]: [T; 3]) -> Self {
        Bracket::new(Angle { cos, sin }, quarter_tan)
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Bracket {
            middle: Angle::select(mask, yes.middle, no.middle),
            quarter_tan: T::select(mask, yes.quarter_tan, no.quarter_tan),
            half_width: Angle::select(mask, yes.half_width, no.half_width),
            seed_turn: Angle::select(mask, yes.seed_turn, no.seed_turn),
        }
    }

    /// The root of the parabola in `t` through three values of `G₋`: in the middle, at the end on the side of the
    /// root, and between the two.
    #[inline(always)]
    pub fn initial_guess(&self, pair: &NormalizedPair<T>) -> Angle<T> {
        // Values of G₋, with the sign that makes G₋ rise from the middle towards the root.
        let middle = pair.rho_slope(self.middle.cos, self.middle.sin);
        let (zero, one) = (middle.splat(0.0), middle.splat(1.0));
        let side = T::select(middle.lt(zero), one, -one);
        let at = self.middle.rotated(self.half_width.cos, side * self.half_width.sin);
        let end = pair.rho_slope(at.cos, at.sin) * side;
        let at = self.middle.rotated(self.seed_turn.cos, side * self.seed_turn.sin);
        let part = pair.rho_slope(at.cos, at.sin) * side;
        // With u = |t|/T the parabola is −m + u (rise + u bend), 0 ≤ u ≤ 1: −m in the middle, `end` at u = 1.
        let (m, two) = (middle.abs(), one + one);
        let bend = (part.neg_mul_add(two, end) - m) * 2.0;
        let rise = end + m - bend;
        // Its root u = 2m/(rise + √(rise² + 4 m bend)), as the tangent u T.
        let root = (bend * 4.0).mul_add(m, rise * rise).max(zero).sqrt();
        self.middle.rotated_by_half_tan((m + m) * (self.quarter_tan * side), (rise + root).max(zero.splat(1e-100)))
    }

    /// Does an angle lie on the arc, up to rounding?
    #[inline(always)]
    pub fn contains(&self, at: Angle<T>) -> T::Mask {
        // Sine and cosine of the angle δ from the middle.
        let across = self.middle.sin.neg_mul_add(at.cos, self.middle.cos * at.sin);
        let along = self.middle.cos.mul_add(at.cos, self.middle.sin * at.sin);
        // |tan(δ/2)| = |sin δ|/(1 + cos δ) < T
        across.abs().lt((along + along.splat(1.0)).mul_add(self.quarter_tan, along.splat(1e-12)))
    }
}
