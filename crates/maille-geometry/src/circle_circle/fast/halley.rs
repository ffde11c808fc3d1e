//! The minimum in a bracket: Halley's iteration, for several brackets or lanes at once, and Newton's method with
//! bisection where it fails.
//!
//! The unknown is a root of `f = ρ h′`, see `NormalizedPair::halley_step`. Halley's iteration converges cubically;
//! from the initial guess of the bracket two steps are usually enough. One step takes one square root and one
//! division.

use crate::circle_circle::angle::{Angle, Direction};
use crate::circle_circle::fast::bracket::Bracket;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Maximum number of Halley steps.
const MAX_STEPS: usize = 8;
/// Convergence is tested from this step on.
const FIRST_TESTED_STEP: usize = 2;
/// Tangent of half a step: after a shorter step the remaining error, which is cubic in it, is below rounding.
const CONVERGED_STEP_TAN: f64 = 2e-6;
/// Maximum number of Newton and bisection steps.
const MAX_NEWTON_STEPS: usize = 60;
/// Tangent of half a step: after a shorter Newton step the remaining error, which is quadratic in it, is below
/// rounding.
const CONVERGED_NEWTON_STEP_TAN: f64 = 1e-9;
/// Minima nearer to the axis of the base, in radii of the moving circle, are left to the exhaustive method.
const MIN_AXIS_DISTANCE: f64 = 1e-2;

/// The roots of `h′` in the first `used` brackets, one pair each, and whether each is a converged minimum inside
/// its bracket (1, else 0).
#[inline(always)]
pub(crate) fn halley_roots<T: SimdReal, const N: usize>(
    pairs: [&NormalizedPair<T>; N],
    brackets: &[Bracket<T>; N],
    used: usize,
) -> ([Angle<T>; N], [T; N]) {
    let (zero, one) = (pairs[0].radius.splat(0.0), pairs[0].radius.splat(1.0));
    // Initial guesses, and steps that are always needed.
    let mut at = [brackets[0].middle; N];
    for k in 0..used {
        at[k] = brackets[k].initial_guess(pairs[k]);
    }
    for _ in 1..FIRST_TESTED_STEP {
        for k in 0..used {
            at[k] = checked_step(pairs[k], at[k]).0;
        }
    }
    // Steps until all have converged (`open` is 0).
    let mut good = [zero; N];
    let mut open = [one; N];
    for _ in FIRST_TESTED_STEP..=MAX_STEPS {
        let mut left = zero;
        for k in 0..used {
            let (next, is_short, is_acceptable) = checked_step(pairs[k], at[k]);
            // A converged root stays, so that a lane does not depend on the others.
            let is_open = zero.lt(open[k]);
            at[k] = Angle::select(is_open, next, at[k]);
            good[k] = T::select(is_open, T::select(is_acceptable, one, zero), good[k]);
            open[k] = T::select(is_short, zero, open[k]);
            left = left.max(open[k]);
        }
        if !T::any(zero.lt(left)) {
            break;
        }
    }
    // Roots outside of their brackets do not count.
    for k in 0..used {
        good[k] = T::select(brackets[k].contains(at[k]), good[k] * (one - open[k]), zero);
    }
    (at, good)
}

/// The angle after a Halley step; whether the step was short enough to be the last; and whether the point is
/// acceptable: far enough from the axis, and a minimum.
#[inline(always)]
fn checked_step<T: SimdReal>(pair: &NormalizedPair<T>, angle: Angle<T>) -> (Angle<T>, T::Mask, T::Mask) {
    let ([numerator, denominator], [rho, rho_f1]) = pair.halley_step(angle.cos, angle.sin);
    let is_acceptable = T::and((pair.radius * MIN_AXIS_DISTANCE).lt(rho), rho_f1.splat(0.0).lt(rho_f1));
    (
        angle.rotated_by_half_tan(numerator, denominator),
        numerator.abs().lt(denominator.abs() * CONVERGED_STEP_TAN),
        is_acceptable,
    )
}

/// The root of `h′` in a bracket by Newton's method, safeguarded by bisection. `None` if it does not converge to an
/// acceptable minimum.
pub(crate) fn safeguarded_newton(pair: &NormalizedPair<f64>, bracket: &Bracket<f64>) -> Option<Angle<f64>> {
    let Angle { cos, sin } = bracket.middle;
    let middle = Direction { cos, sin };
    let [mut first, mut last] =
        [-bracket.quarter_tan, bracket.quarter_tan].map(|quarter_tan| middle.rotated_by_half_tan(quarter_tan));
    // A Newton step must be shorter than half of the one before, or bisection follows.
    let mut max_half_tan = f64::INFINITY;
    let mut at = first;
    for _ in 0..MAX_NEWTON_STEPS {
        let [h1, h2, rho] = pair.slope_and_curvature(at.cos, at.sin);
        let half_tan = -0.5 * h1 / h2;
        let next = at.rotated_by_half_tan(half_tan);
        let inside =
            first.cos * next.sin - first.sin * next.cos > 0.0 && next.cos * last.sin - next.sin * last.cos > 0.0;
        if inside && half_tan.abs() < max_half_tan {
            if half_tan.abs() < CONVERGED_NEWTON_STEP_TAN {
                let is_acceptable = h2 > 0.0 && rho > MIN_AXIS_DISTANCE * pair.radius;
                return is_acceptable.then_some(Angle { cos: next.cos, sin: next.sin });
            }
            max_half_tan = 0.5 * half_tan.abs();
            at = next;
        } else {
            // The middle of the bracket.
            let (x, y) = (first.cos + last.cos, first.sin + last.sin);
            let length = (x * x + y * y).sqrt();
            at = Direction { cos: x / length, sin: y / length };
            max_half_tan = f64::INFINITY;
        }
        // The bracket shrinks to the side of the root.
        let rising = pair.slope_and_curvature(at.cos, at.sin)[0] >= 0.0;
        *(if rising { &mut last } else { &mut first }) = at;
    }
    None
}
