//! Arcs of the moving circle with one minimum each: what the count ([`crate::count`]) proves of eight arcs.
//!
//! Where it proves nothing, [`crate::halving`] goes on.

use crate::count::{ARCS, Arcs, Harmonics, changes};
use crate::grid::Direction;
use crate::lane::Lane;
use crate::relative::Reduced;

/// Minima of a register's pairs; a third one has never been seen.
pub(crate) const SLOTS: usize = 2;
/// The slope and its parts must be larger than this, in units of the pair's scale.
const LEAST_SLOPE: f64 = 1e-10;

/// An angle as its cosine and sine.
#[derive(Clone, Copy)]
pub(crate) struct Angle<T> {
    pub cos: T,
    pub sin: T,
}

impl<T: Lane> Angle<T> {
    #[inline(always)]
    pub fn pick(mask: T::Mask, yes: Self, no: Self) -> Self {
        Angle { cos: T::pick(mask, yes.cos, no.cos), sin: T::pick(mask, yes.sin, no.sin) }
    }

    /// Turned by twice the angle whose tangent is `top / bottom`.
    #[inline(always)]
    pub fn ahead(self, top: T, bottom: T) -> Self {
        let (square, whole) = (top * top, bottom * bottom);
        let inverse = top.like(1.0) / (whole + square);
        let (cos, sin) = ((whole - square) * inverse, top * bottom * 2.0 * inverse);
        Angle { cos: self.cos * cos - self.sin * sin, sin: self.sin * cos + self.cos * sin }
    }
}

/// An arc at whose ends G₋ is `low` < 0 and `high` ≥ 0, with one root between.
#[derive(Clone, Copy)]
pub(crate) struct Bracket<T> {
    pub middle: Angle<T>,
    /// tan of a quarter of its width.
    pub edge: T,
    pub low: T,
    pub high: T,
}

impl<T: Lane> Bracket<T> {
    /// The arc number `k` of a table.
    #[inline(always)]
    pub fn arc(table: &Arcs, k: usize, low: T, high: T) -> Self {
        let Direction { cos, sin } = table.centers[k];
        Bracket { middle: Angle { cos: low.like(cos), sin: low.like(sin) }, edge: low.like(table.edge), low, high }
    }

    /// As numbers, for the way out of a register and back.
    #[inline(always)]
    pub fn parts(&self) -> [T; 5] {
        [self.middle.cos, self.middle.sin, self.edge, self.low, self.high]
    }

    /// From its numbers.
    #[inline(always)]
    pub fn of_parts([cos, sin, edge, low, high]: [T; 5]) -> Self {
        Bracket { middle: Angle { cos, sin }, edge, low, high }
    }

    #[inline(always)]
    pub fn pick(mask: T::Mask, yes: Self, no: Self) -> Self {
        Bracket {
            middle: Angle::pick(mask, yes.middle, no.middle),
            edge: T::pick(mask, yes.edge, no.edge),
            low: T::pick(mask, yes.low, no.low),
            high: T::pick(mask, yes.high, no.high),
        }
    }

    /// Where the parabola through G₋ at the ends and in the middle is 0.
    #[inline(always)]
    pub fn seed(&self, pair: &Reduced<T>) -> Angle<T> {
        let [middle, _] = pair.factors(self.middle.cos, self.middle.sin);
        let slope = (self.high - self.low) * 0.5;
        let bend = (self.high + self.low) * 0.5 - middle;
        // It has one root between ends of different signs, so this is not negative but for rounding.
        let root = (slope * slope - bend * middle * 4.0).max(slope.like(0.0)).sqrt();
        self.middle.ahead(-(middle * self.edge * 2.0), slope + root)
    }

    /// Whether an angle lies on the arc, to rounding.
    #[inline(always)]
    pub fn contains(&self, at: Angle<T>) -> T::Mask {
        let across = self.middle.cos * at.sin - self.middle.sin * at.cos;
        let along = self.middle.cos * at.cos + self.middle.sin * at.sin;
        // tan(δ/2) = sin δ/(1 + cos δ)
        across.abs().below((along + along.like(1.0)) * self.edge + along.like(1e-12))
    }
}

/// The count of a pair, or of a register of pairs.
pub(crate) struct Counted<T> {
    /// How many more critical points than known an arc could have.
    pub excess: [T; ARCS],
    /// G₋ at the first ends of the arcs.
    pub minus: [T; ARCS],
    /// G₊ there.
    pub plus: [T; ARCS],
}

impl<T: Lane> Counted<T> {
    #[inline(always)]
    pub fn new(pair: &Reduced<T>, harmonics: &Harmonics<T>, table: &Arcs) -> Self {
        let (zero, one) = (pair.radius.like(0.0), pair.radius.like(1.0));
        let [minus, plus] = at_ends(pair, table);
        let (turned, doubt) = (harmonics.turned(), harmonics.doubt());
        let mut counted = Self { excess: [zero; ARCS], minus, plus };
        let ends = counted.ends();
        for m in 0..ARCS / 2 {
            let both = turned.coefficients(m, &ends, table);
            for half in 0..2 {
                let k = m + half * (ARCS / 2);
                let next = (k + 1) % ARCS;
                let root = T::pick((minus[k] * minus[next]).below(zero), one, zero);
                let far = T::pick((plus[k] * plus[next]).below(zero), one, zero);
                counted.excess[k] = changes(&both[half], doubt) - (root + far);
            }
        }
        counted
    }

    /// H at the first ends of the arcs.
    #[inline(always)]
    pub fn ends(&self) -> [T; ARCS] {
        let mut ends = self.minus;
        for k in 0..ARCS {
            ends[k] = ends[k] * self.plus[k];
        }
        ends
    }

    /// 0 if the count is known.
    #[inline(always)]
    pub fn doubts(&self) -> T {
        let mut sums = [self.excess[0].abs(), self.excess[1].abs()];
        for k in 2..ARCS {
            sums[k % 2] = sums[k % 2] + self.excess[k].abs();
        }
        sums[0] + sums[1]
    }

    /// The first and the last arc on which G₋ rises through 0, and how many there are.
    #[inline(always)]
    pub fn rising(&self, table: &Arcs) -> ([Bracket<T>; SLOTS], T) {
        let (zero, one) = (self.minus[0].like(0.0), self.minus[0].like(1.0));
        let mut slots = [Bracket::arc(table, 0, self.minus[0], self.minus[1]); SLOTS];
        let mut count = zero;
        for k in 0..ARCS {
            let (low, high) = (self.minus[k], self.minus[(k + 1) % ARCS]);
            let rises = T::both(low.below(zero), zero.below(high));
            slots[1] = Bracket::pick(rises, Bracket::arc(table, k, low, high), slots[1]);
            count = count + T::pick(rises, one, zero);
        }
        for k in (0..ARCS).rev() {
            let (low, high) = (self.minus[k], self.minus[(k + 1) % ARCS]);
            let rises = T::both(low.below(zero), zero.below(high));
            slots[0] = Bracket::pick(rises, Bracket::arc(table, k, low, high), slots[0]);
        }
        (slots, count)
    }
}

/// G₋ and G₊ at the first ends of the arcs; opposite ends share their odd parts.
#[inline(always)]
fn at_ends<T: Lane>(pair: &Reduced<T>, table: &Arcs) -> [[T; ARCS]; 2] {
    let mut out = [[pair.radius; ARCS]; 2];
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
    out
}

/// The pair is steep enough for the count to mean something.
#[inline(always)]
pub(crate) fn is_steep<T: Lane>(pair: &Reduced<T>) -> T::Mask {
    pair.radius.like(LEAST_SLOPE).below(pair.steepness())
}
