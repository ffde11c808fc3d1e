//! The minima of an ordinary pair, quickly: arcs whose critical points are counted ([`crate::count`]), then Halley's
//! iteration in each arc where the slope goes from − to +.
//!
//! Written once for a number and for a register of numbers ([`Lane`]). Positions that it cannot decide (degenerate ones, and
//! what comes near them) it says so of, and [`crate::search`] takes them.

use crate::MAX_MINIMA;
use crate::count::{ARCS, Arcs, Harmonics, TABLE, halves};
use crate::grid::Direction;
use crate::lane::Lane;
use crate::relative::Reduced;

/// Minima of a register's pairs; a third one has never been seen.
pub(crate) const SLOTS: usize = 2;
/// Steps of Halley's iteration at most.
const STEPS: usize = 8;
/// After a step shorter than this the cubic rest is below rounding.
const SHORT: f64 = 1e-6;
/// No step is longer: the tangent of half of it.
const LONGEST_HALF: f64 = 0.2;
/// Steps of the bracketed iteration at most, and the step after which the quadratic rest is below rounding.
const BISECTIONS: usize = 60;
const NEWTON_SHORT: f64 = 1e-9;
/// The slope and its parts must be larger than this, in units of the pair's scale.
const LEAST_SLOPE: f64 = 1e-10;
/// A minimum must be this far from the axis of the base, in radii of the moving circle.
const OFF_AXIS: f64 = 1e-2;
/// Halvings of an arc at most.
const HALVINGS: usize = 6;

/// An angle as its cosine and sine.
#[derive(Clone, Copy)]
pub(crate) struct Angle<T> {
    pub cos: T,
    pub sin: T,
}

impl<T: Lane> Angle<T> {
    #[inline(always)]
    fn constant(of: T, direction: Direction) -> Self {
        Angle { cos: of.like(direction.cos), sin: of.like(direction.sin) }
    }

    #[inline(always)]
    fn pick(mask: T::Mask, yes: Self, no: Self) -> Self {
        Angle { cos: T::pick(mask, yes.cos, no.cos), sin: T::pick(mask, yes.sin, no.sin) }
    }
}

/// An arc at whose ends G₋ is `low` < 0 and `high` ≥ 0, with one root between.
#[derive(Clone, Copy)]
struct Bracket<T> {
    first: Angle<T>,
    last: Angle<T>,
    low: T,
    high: T,
}

impl<T: Lane> Bracket<T> {
    #[inline(always)]
    fn constant(of: T, [first, last]: [Direction; 2], low: T, high: T) -> Self {
        Bracket { first: Angle::constant(of, first), last: Angle::constant(of, last), low, high }
    }

    #[inline(always)]
    fn pick(mask: T::Mask, yes: Self, no: Self) -> Self {
        Bracket {
            first: Angle::pick(mask, yes.first, no.first),
            last: Angle::pick(mask, yes.last, no.last),
            low: T::pick(mask, yes.low, no.low),
            high: T::pick(mask, yes.high, no.high),
        }
    }

    /// Where the chord of G₋ is 0.
    #[inline(always)]
    fn chord(&self) -> Angle<T> {
        let (first, last) = (self.first, self.last);
        let part = self.low / (self.low - self.high);
        let (x, y) = (first.cos + (last.cos - first.cos) * part, first.sin + (last.sin - first.sin) * part);
        let inverse = part.like(1.0) / (x * x + y * y).sqrt();
        Angle { cos: x * inverse, sin: y * inverse }
    }
}

/// The roots of h′ in brackets, found together; and which are good (1, else 0).
#[inline(always)]
fn roots<T: Lane, const N: usize>(
    pair: &Reduced<T>,
    brackets: &[Bracket<T>; N],
    used: usize,
) -> ([Angle<T>; N], [T; N]) {
    let zero = pair.radius.like(0.0);
    let one = pair.radius.like(1.0);
    let (longest_half, short) = (zero.like(LONGEST_HALF), zero.like(SHORT));
    let mut at = [brackets[0].first; N];
    for k in 0..used {
        at[k] = brackets[k].chord();
    }
    let mut good = [zero; N];
    let mut last = [one; N];
    for _ in 0..STEPS {
        let mut longest = zero;
        for k in 0..used {
            // A root that is found stays: other lanes of the register do not move it.
            let (angle, open) = (at[k], short.below(last[k]));
            let [h1, h2, h3, rho] = pair.slopes(angle.cos, angle.sin);
            // Half of Halley's step, as the tangent of half the angle; where h is not convex, down the slope.
            let convex = zero.below(h2);
            let top = T::pick(convex, h1 * h2, h1);
            let half = top / T::pick(convex, h1 * h3 - h2 * h2 * 2.0, -(h1.abs() * 8.0));
            let half = -(-half.max(-longest_half)).max(-longest_half);
            let square = half * half;
            let inverse = one / (one + square);
            let (cos, sin) = ((one - square) * inverse, half * inverse * 2.0);
            let turned = Angle { cos: angle.cos * cos - angle.sin * sin, sin: angle.sin * cos + angle.cos * sin };
            at[k] = Angle::pick(open, turned, angle);
            last[k] = T::pick(open, half.abs(), last[k]);
            longest = longest.max(last[k]);
            let sound = T::both(convex, (pair.radius * OFF_AXIS).below(rho));
            good[k] = T::pick(open, T::pick(sound, one, zero), good[k]);
        }
        if !T::any(short.below(longest)) {
            break;
        }
    }
    // Inside: on the left of the first end and on the right of the last, to rounding.
    let edge = zero.like(-1e-12);
    for k in 0..used {
        let (angle, first, end) = (at[k], brackets[k].first, brackets[k].last);
        let inside = T::both(
            edge.below(first.cos * angle.sin - first.sin * angle.cos),
            edge.below(angle.cos * end.sin - angle.sin * end.cos),
        );
        good[k] = T::pick(T::both(inside, last[k].below(short)), good[k], zero);
    }
    (at, good)
}

/// The root in a bracket by Newton's method, kept inside by bisection.
fn bisected(pair: &Reduced<f64>, bracket: &Bracket<f64>) -> Option<Angle<f64>> {
    let (mut first, mut last) = (bracket.first, bracket.last);
    let mut shorter = f64::INFINITY;
    let mut at = first;
    for _ in 0..BISECTIONS {
        let [h1, h2, _, rho] = pair.slopes(at.cos, at.sin);
        let half = -0.5 * h1 / h2;
        let here = Direction { cos: at.cos, sin: at.sin };
        let there = here.ahead(half);
        let inside =
            first.cos * there.sin - first.sin * there.cos > 0.0 && there.cos * last.sin - there.sin * last.cos > 0.0;
        if inside && half.abs() < shorter {
            if half.abs() < NEWTON_SHORT {
                let sound = h2 > 0.0 && rho > OFF_AXIS * pair.radius;
                return sound.then_some(Angle { cos: there.cos, sin: there.sin });
            }
            shorter = 0.5 * half.abs();
            at = Angle { cos: there.cos, sin: there.sin };
        } else {
            let (x, y) = (first.cos + last.cos, first.sin + last.sin);
            let length = (x * x + y * y).sqrt();
            at = Angle { cos: x / length, sin: y / length };
            shorter = f64::INFINITY;
        }
        let rising = pair.slopes(at.cos, at.sin)[0] >= 0.0;
        *(if rising { &mut last } else { &mut first }) = at;
    }
    None
}

/// G₋ and G₊ at the ends of the arcs, the first again at the end; opposite ends share their odd parts.
#[inline(always)]
fn at_ends<T: Lane>(pair: &Reduced<T>, table: &Arcs) -> [[T; ARCS + 1]; 2] {
    let mut out = [[pair.radius; ARCS + 1]; 2];
    let across = pair.radius * pair.tilt_cos;
    for k in 0..ARCS / 2 {
        let Direction { cos, sin } = table.ends[k];
        let (dx, dy) = (across * cos, pair.radius * sin);
        let p = pair.p[0] * cos + pair.p[1] * sin;
        let odd = pair.q[0] * cos + pair.q[1] * sin;
        let even = pair.q[2] * (2.0 * sin * cos);
        let (x, y) = (pair.x0 + dx, pair.y0 + dy);
        let (x_opposite, y_opposite) = (pair.x0 - dx, pair.y0 - dy);
        let here = p * (x * x + y * y).sqrt();
        let opposite = -p * (x_opposite * x_opposite + y_opposite * y_opposite).sqrt();
        let (q, q_opposite) = (even + odd, even - odd);
        (out[0][k], out[1][k]) = (here - q, here + q);
        (out[0][k + ARCS / 2], out[1][k + ARCS / 2]) = (opposite - q_opposite, opposite + q_opposite);
    }
    (out[0][ARCS], out[1][ARCS]) = (out[0][0], out[1][0]);
    out
}

/// What a register knows of its pairs: the angles of [`SLOTS`] minima, how many of them count, and whether this is all
/// (1) or unknown (0).
pub(crate) struct Found<T> {
    pub angles: [Angle<T>; SLOTS],
    pub count: T,
    pub complete: T,
}

/// The minima of a register's pairs.
#[inline(always)]
pub(crate) fn minima_of_lanes<T: Lane>(pair: &Reduced<T>, table: &Arcs) -> Found<T> {
    let (zero, one) = (pair.radius.like(0.0), pair.radius.like(1.0));
    let harmonics = Harmonics::new(pair, table);
    let changes = harmonics.changes(&harmonics.coefficients(table));
    let [minus, plus] = at_ends(pair, table);
    let mut certain = zero;
    let mut count = zero;
    let first = Bracket::constant(zero, [table.ends[0], table.ends[1]], -one, one);
    let mut slots = [first; SLOTS];
    for k in 0..ARCS {
        let root = (minus[k] * minus[k + 1]).below(zero);
        let far = (plus[k] * plus[k + 1]).below(zero);
        certain = certain + T::pick(root, one, zero) + T::pick(far, one, zero);
        let rising = T::both(root, minus[k].below(zero));
        let bracket = Bracket::constant(zero, [table.ends[k], table.ends[k + 1]], minus[k], minus[k + 1]);
        for i in 0..SLOTS {
            let here = T::both(rising, (count - zero.like(i as f64)).abs().below(zero.like(0.5)));
            slots[i] = Bracket::pick(here, bracket, slots[i]);
        }
        count = count + T::pick(rising, one, zero);
    }
    // A slot that is not used repeats the first one.
    let second = one.like(1.5).below(count);
    slots[1] = Bracket::pick(second, slots[1], slots[0]);
    let (angles, good) = roots(pair, &slots, SLOTS);
    let good = good[0] * good[1];
    let counted = (changes - certain).abs().below(zero.like(0.5));
    let few = T::both(zero.like(0.5).below(count), count.below(zero.like(2.5)));
    let steep = zero.like(LEAST_SLOPE).below(pair.steepness());
    let complete = T::pick(T::both(T::both(counted, few), steep), good, zero);
    Found { angles, count, complete }
}

/// The angles of all minima, or `None` where this is not the way to find them.
pub(crate) fn minima(pair: &Reduced<f64>) -> Option<([Direction; MAX_MINIMA], usize)> {
    if pair.steepness() < LEAST_SLOPE {
        return None;
    }
    let table = &*TABLE;
    let harmonics = Harmonics::new(pair, table);
    let coefficients = harmonics.coefficients(table);
    let [minus, plus] = at_ends(pair, table);
    let change = |g: &[f64; ARCS + 1], k: usize| (g[k] < 0.0) != (g[k + 1] < 0.0);
    let certain: usize = (0..ARCS).map(|k| usize::from(change(&minus, k)) + usize::from(change(&plus, k))).sum();
    let empty = Bracket::constant(0.0, [table.ends[0], table.ends[1]], -1.0, 1.0);
    let mut brackets = Brackets { all: [empty; MAX_MINIMA], count: 0 };
    let every = harmonics.changes(&coefficients) == certain as f64;
    for k in 0..ARCS {
        let ends = [table.ends[k], table.ends[k + 1]];
        if every {
            brackets.add(ends, [minus[k], minus[k + 1]])?;
            continue;
        }
        let arc = Arc {
            from: -1.0,
            to: 1.0,
            ends,
            minus: [minus[k], minus[k + 1]],
            plus: [plus[k], plus[k + 1]],
            coefficients: std::array::from_fn(|i| coefficients[k][i] * table.weights[i]),
        };
        arc.examine(pair, &harmonics, table.centers[k], HALVINGS, &mut brackets)?;
    }
    let (mut angles, good) = roots(pair, &brackets.all, brackets.count);
    for k in (0..brackets.count).filter(|k| good[*k] != 1.0) {
        angles[k] = bisected(pair, &brackets.all[k])?;
    }
    let directions = angles.map(|Angle { cos, sin }| Direction { cos, sin });
    (brackets.count > 0).then_some((directions, brackets.count))
}

struct Brackets {
    all: [Bracket<f64>; MAX_MINIMA],
    count: usize,
}

impl Brackets {
    /// Adds the arc if G₋ rises through 0 in it; `None` if there are too many.
    fn add(&mut self, ends: [Direction; 2], [low, high]: [f64; 2]) -> Option<()> {
        if low < 0.0 && high >= 0.0 {
            *self.all.get_mut(self.count)? = Bracket::constant(0.0, ends, low, high);
            self.count += 1;
        }
        Some(())
    }
}

/// A part of an arc, between the values `from` and `to` of t/T.
struct Arc {
    from: f64,
    to: f64,
    ends: [Direction; 2],
    minus: [f64; 2],
    plus: [f64; 2],
    coefficients: [f64; 9],
}

impl Arc {
    /// Adds what the arc has, halving it as often as it takes; `None` where that does not decide.
    fn examine(
        &self,
        pair: &Reduced<f64>,
        harmonics: &Harmonics<f64>,
        center: Direction,
        halvings: usize,
        brackets: &mut Brackets,
    ) -> Option<()> {
        let change = |g: &[f64; 2]| usize::from((g[0] < 0.0) != (g[1] < 0.0));
        if harmonics.certain_changes(&self.coefficients)? == change(&self.minus) + change(&self.plus) {
            return brackets.add(self.ends, self.minus);
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = 0.5 * (self.from + self.to);
        let at = center.ahead(middle * TABLE.edge);
        let [minus, plus] = pair.factors(at.cos, at.sin);
        let [left, right] = halves(&self.coefficients);
        let left = Arc {
            from: self.from,
            to: middle,
            ends: [self.ends[0], at],
            minus: [self.minus[0], minus],
            plus: [self.plus[0], plus],
            coefficients: left,
        };
        left.examine(pair, harmonics, center, halvings, brackets)?;
        let right = Arc {
            from: middle,
            to: self.to,
            ends: [at, self.ends[1]],
            minus: [minus, self.minus[1]],
            plus: [plus, self.plus[1]],
            coefficients: right,
        };
        right.examine(pair, harmonics, center, halvings, brackets)
    }
}
