//! The minima of an ordinary pair, quickly: arcs with one minimum each ([`crate::brackets`]), then Halley's iteration in
//! each of them.
//!
//! Written once for a number and for a register of numbers ([`Lane`]). Positions that it cannot decide (degenerate ones, and
//! what comes near them) it says so of, and [`crate::search`] takes them.

use crate::MAX_MINIMA;
use crate::arcs::TABLE;
use crate::brackets::{Angle, Bracket, is_steep};
use crate::grid::Direction;
use crate::halving::Brackets;
use crate::lane::Lane;
use crate::reduced::Reduced;

/// Steps of Halley's iteration at most, and those that are taken unasked.
const STEPS: usize = 8;
const ALWAYS: usize = 2;
/// After a step shorter than this (the tangent of half of it) the cubic rest is below rounding.
const SHORT: f64 = 2e-6;
/// Steps of the bracketed iteration at most, and the step after which the quadratic rest is below rounding.
const BISECTIONS: usize = 60;
const NEWTON_SHORT: f64 = 1e-9;
/// A minimum must be this far from the axis of the base, in radii of the moving circle.
const OFF_AXIS: f64 = 1e-2;

/// The roots of h′ in brackets of these pairs, found together; and which are good (1, else 0).
#[inline(always)]
pub(crate) fn roots<T: Lane, const N: usize>(
    pairs: [&Reduced<T>; N],
    brackets: &[Bracket<T>; N],
    used: usize,
) -> ([Angle<T>; N], [T; N]) {
    let (zero, one) = (pairs[0].radius.like(0.0), pairs[0].radius.like(1.0));
    let mut at = [brackets[0].middle; N];
    for k in 0..used {
        at[k] = brackets[k].seed(pairs[k]);
    }
    let mut good = [zero; N];
    let mut open = [one; N];
    for _ in 1..ALWAYS {
        for k in 0..used {
            at[k] = step(pairs[k], at[k]).0;
        }
    }
    for _ in ALWAYS..=STEPS {
        let mut left = zero;
        for k in 0..used {
            let (turned, short, sound) = step(pairs[k], at[k]);
            // A root that is found stays: other lanes of the register do not move it.
            let moves = zero.below(open[k]);
            at[k] = Angle::pick(moves, turned, at[k]);
            good[k] = T::pick(moves, T::pick(sound, one, zero), good[k]);
            open[k] = T::pick(short, zero, open[k]);
            left = left.max(open[k]);
        }
        if !T::any(zero.below(left)) {
            break;
        }
    }
    for k in 0..used {
        good[k] = T::pick(brackets[k].contains(at[k]), good[k] * (one - open[k]), zero);
    }
    (at, good)
}

/// An angle after a step, whether it was the last one, and whether the minimum is one that the kernel may answer for.
#[inline(always)]
fn step<T: Lane>(pair: &Reduced<T>, angle: Angle<T>) -> (Angle<T>, T::Mask, T::Mask) {
    let ([top, bottom], [rho, rise]) = pair.step(angle.cos, angle.sin);
    let sound = T::both((pair.radius * OFF_AXIS).below(rho), rise.like(0.0).below(rise));
    (angle.ahead(top, bottom), top.abs().below(bottom.abs() * SHORT), sound)
}

/// The root in a bracket by Newton's method, kept inside by bisection.
fn bisected(pair: &Reduced<f64>, bracket: &Bracket<f64>) -> Option<Angle<f64>> {
    let Angle { cos, sin } = bracket.middle;
    let middle = Direction { cos, sin };
    let [mut first, mut last] = [-bracket.edge, bracket.edge].map(|edge| middle.ahead(edge));
    let mut shorter = f64::INFINITY;
    let mut at = first;
    for _ in 0..BISECTIONS {
        let [h1, h2, rho] = pair.slopes(at.cos, at.sin);
        let half = -0.5 * h1 / h2;
        let there = at.ahead(half);
        let inside =
            first.cos * there.sin - first.sin * there.cos > 0.0 && there.cos * last.sin - there.sin * last.cos > 0.0;
        if inside && half.abs() < shorter {
            if half.abs() < NEWTON_SHORT {
                let sound = h2 > 0.0 && rho > OFF_AXIS * pair.radius;
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
        let rising = pair.slopes(at.cos, at.sin)[0] >= 0.0;
        *(if rising { &mut last } else { &mut first }) = at;
    }
    None
}

/// The angles of all minima, or `None` where this is not the way to find them.
pub(crate) fn minima(pair: &Reduced<f64>) -> Option<([Direction; MAX_MINIMA], usize)> {
    if !is_steep(pair) {
        return None;
    }
    let brackets = Brackets::of_pair(pair, &TABLE)?;
    let (mut angles, good) = roots([pair; MAX_MINIMA], &brackets.all, brackets.count);
    for k in (0..brackets.count).filter(|k| good[*k] != 1.0) {
        angles[k] = bisected(pair, &brackets.all[k])?;
    }
    let directions = angles.map(|Angle { cos, sin }| Direction { cos, sin });
    (brackets.count > 0).then_some((directions, brackets.count))
}
