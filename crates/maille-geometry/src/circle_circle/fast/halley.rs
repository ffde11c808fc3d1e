//! The minima of an ordinary pair, quickly: arcs with one minimum each ([`crate::brackets`]), then Halley's iteration in
//! each of them.
//!
//! Written once for a number and for a register of numbers ([`SimdReal`]). Positions that it cannot decide (degenerate ones, and
//! what comes near them) it says so of, and [`crate::search`] takes them.

use crate::circle_circle::angle::{Angle, Direction};
use crate::circle_circle::fast::bracket::Bracket;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Steps of Halley's iteration at most, and those that are taken unasked.
const MAX_STEPS: usize = 8;
const UNCHECKED_STEPS: usize = 2;
/// After a step shorter than this (the tangent of half of it) the cubic rest is below rounding.
const CONVERGED_STEP_TAN: f64 = 2e-6;
/// Steps of the bracketed iteration at most, and the step after which the quadratic rest is below rounding.
const MAX_NEWTON_STEPS: usize = 60;
const CONVERGED_NEWTON_STEP_TAN: f64 = 1e-9;
/// A minimum must be this far from the axis of the base, in radii of the moving circle.
const MIN_AXIS_DISTANCE: f64 = 1e-2;

/// The roots of h′ in brackets of these pairs, found together; and which are good (1, else 0).
#[inline(always)]
pub(crate) fn halley_roots<T: SimdReal, const N: usize>(
    pairs: [&NormalizedPair<T>; N],
    brackets: &[Bracket<T>; N],
    used: usize,
) -> ([Angle<T>; N], [T; N]) {
    let (zero, one) = (pairs[0].radius.splat(0.0), pairs[0].radius.splat(1.0));
    let mut at = [brackets[0].middle; N];
    for k in 0..used {
        at[k] = brackets[k].initial_guess(pairs[k]);
    }
    let mut good = [zero; N];
    let mut open = [one; N];
    for _ in 1..UNCHECKED_STEPS {
        for k in 0..used {
            at[k] = checked_step(pairs[k], at[k]).0;
        }
    }
    for _ in UNCHECKED_STEPS..=MAX_STEPS {
        let mut left = zero;
        for k in 0..used {
            let (turned, short, sound) = checked_step(pairs[k], at[k]);
            // A root that is found stays: other lanes of the register do not move it.
            let moves = zero.lt(open[k]);
            at[k] = Angle::select(moves, turned, at[k]);
            good[k] = T::select(moves, T::select(sound, one, zero), good[k]);
            open[k] = T::select(short, zero, open[k]);
            left = left.max(open[k]);
        }
        if !T::any(zero.lt(left)) {
            break;
        }
    }
    for k in 0..used {
        good[k] = T::select(brackets[k].contains(at[k]), good[k] * (one - open[k]), zero);
    }
    (at, good)
}

/// An angle after a step, whether it was the last one, and whether the minimum is one that the kernel may answer for.
#[inline(always)]
fn checked_step<T: SimdReal>(pair: &NormalizedPair<T>, angle: Angle<T>) -> (Angle<T>, T::Mask, T::Mask) {
    let ([numerator, denominator], [rho, rise]) = pair.halley_step(angle.cos, angle.sin);
    let sound = T::and((pair.radius * MIN_AXIS_DISTANCE).lt(rho), rise.splat(0.0).lt(rise));
    (
        angle.rotated_by_half_tan(numerator, denominator),
        numerator.abs().lt(denominator.abs() * CONVERGED_STEP_TAN),
        sound,
    )
}

/// The root in a bracket by Newton's method, kept inside by bisection.
pub(crate) fn safeguarded_newton(pair: &NormalizedPair<f64>, bracket: &Bracket<f64>) -> Option<Angle<f64>> {
    let Angle { cos, sin } = bracket.middle;
    let middle = Direction { cos, sin };
    let [mut first, mut last] =
        [-bracket.quarter_tan, bracket.quarter_tan].map(|quarter_tan| middle.rotated_by_half_tan(quarter_tan));
    let mut shorter = f64::INFINITY;
    let mut at = first;
    for _ in 0..MAX_NEWTON_STEPS {
        let [h1, h2, rho] = pair.slope_and_curvature(at.cos, at.sin);
        let half = -0.5 * h1 / h2;
        let there = at.rotated_by_half_tan(half);
        let inside =
            first.cos * there.sin - first.sin * there.cos > 0.0 && there.cos * last.sin - there.sin * last.cos > 0.0;
        if inside && half.abs() < shorter {
            if half.abs() < CONVERGED_NEWTON_STEP_TAN {
                let sound = h2 > 0.0 && rho > MIN_AXIS_DISTANCE * pair.radius;
                return sound.then_some(Angle { cos: there.cos, sin: there.sin });
            }
            shorter = 0.5 * half.abs();
            at = there;
        } else {
            let (x, y) = (first.cos + last.cos, first.sin + last.sin);
            let length = (x * x + y * y).sqrt();
            at = Direction { cos: x / length, sin: y / length };
            shorter = f64::INFINITY;
        }
        let rising = pair.slope_and_curvature(at.cos, at.sin)[0] >= 0.0;
        *(if rising { &mut last } else { &mut first }) = at;
    }
    None
}
