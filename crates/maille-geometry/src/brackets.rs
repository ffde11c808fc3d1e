//! Arcs of the moving circle with one minimum each: what the count ([`crate::count`]) proves of eight arcs.
//!
//! Where it proves nothing, [`crate::halving`] goes on.

use crate::arcs::{ARCS, Arcs, Level};
use crate::count::{Harmonics, changes};
use crate::grid::Direction;
use crate::lane::Lane;
use crate::reduced::Reduced;

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

    /// A constant.
    #[inline(always)]
    pub fn like(self, direction: Direction) -> Self {
        Angle { cos: self.cos.like(direction.cos), sin: self.cos.like(direction.sin) }
    }

    /// Turned by an angle of this cosine and sine.
    #[inline(always)]
    pub fn turned(self, cos: T, sin: T) -> Self {
        Angle { cos: self.sin.taken(sin, self.cos * cos), sin: self.cos.fused(sin, self.sin * cos) }
    }

    /// Turned by twice the angle whose tangent is `top / bottom`.
    #[inline(always)]
    pub fn ahead(self, top: T, bottom: T) -> Self {
        let (square, whole) = (top * top, bottom * bottom);
        let inverse = top.like(1.0) / (whole + square);
        // Divided last: the quotient takes as long as all else.
        let Angle { cos, sin } = self.turned(whole - square, (top + top) * bottom);
        Angle { cos: cos * inverse, sin: sin * inverse }
    }
}

/// An arc at whose ends G₋ is negative and positive, with one root between.
#[derive(Clone, Copy)]
pub(crate) struct Bracket<T> {
    pub middle: Angle<T>,
    /// tan of a quarter of its width.
    pub edge: T,
    /// Half of its width, and the turn whose half has the tangent `edge / 2`.
    half: Angle<T>,
    part: Angle<T>,
}

impl<T: Lane> Bracket<T> {
    #[inline(always)]
    pub fn new(middle: Angle<T>, edge: T) -> Self {
        let (one, zero) = (edge.like(1.0), edge.like(0.0));
        let ahead = Angle { cos: one, sin: zero };
        Bracket { middle, edge, half: ahead.ahead(edge, one), part: ahead.ahead(edge, one + one) }
    }

    /// One of the arcs of a level, by its centre.
    #[inline(always)]
    pub fn arc(level: &Level, middle: Angle<T>) -> Self {
        let (half, part) = (Angle::like(middle, level.half), Angle::like(middle, level.part));
        Bracket { middle, edge: middle.cos.like(level.edge), half, part }
    }

    /// As numbers, for the way out of a register and back.
    #[inline(always)]
    pub fn parts(&self) -> [T; 3] {
        [self.middle.cos, self.middle.sin, self.edge]
    }

    /// From its numbers.
    #[inline(always)]
    pub fn of_parts([cos, sin, edge]: [T; 3]) -> Self {
        Bracket::new(Angle { cos, sin }, edge)
    }

    #[inline(always)]
    pub fn pick(mask: T::Mask, yes: Self, no: Self) -> Self {
        Bracket {
            middle: Angle::pick(mask, yes.middle, no.middle),
            edge: T::pick(mask, yes.edge, no.edge),
            half: Angle::pick(mask, yes.half, no.half),
            part: Angle::pick(mask, yes.part, no.part),
        }
    }

    /// Where a parabola through three values of G₋ is 0: in the middle, at the end on the root's side, and between.
    #[inline(always)]
    pub fn seed(&self, pair: &Reduced<T>) -> Angle<T> {
        let middle = pair.slope(self.middle.cos, self.middle.sin);
        let (zero, one) = (middle.like(0.0), middle.like(1.0));
        let side = T::pick(middle.below(zero), one, -one);
        let at = self.middle.turned(self.half.cos, side * self.half.sin);
        let end = pair.slope(at.cos, at.sin) * side;
        let at = self.middle.turned(self.part.cos, side * self.part.sin);
        let part = pair.slope(at.cos, at.sin) * side;
        // From −m in the middle it rises over `part` to `end`: −m + u (rise + u bend), 0 ≤ u ≤ 1.
        let (m, two) = (middle.abs(), one + one);
        let bend = (part.taken(two, end) - m) * 2.0;
        let rise = end + m - bend;
        let root = (bend * 4.0).fused(m, rise * rise).max(zero).sqrt();
        self.middle.ahead((m + m) * (self.edge * side), (rise + root).max(zero.like(1e-100)))
    }

    /// Whether an angle lies on the arc, to rounding.
    #[inline(always)]
    pub fn contains(&self, at: Angle<T>) -> T::Mask {
        let across = self.middle.sin.taken(at.cos, self.middle.cos * at.sin);
        let along = self.middle.cos.fused(at.cos, self.middle.sin * at.sin);
        // tan(δ/2) = sin δ/(1 + cos δ)
        across.abs().below((along + along.like(1.0)).fused(self.edge, along.like(1e-12)))
    }
}

/// H = G₋ G₊ at an angle, and numbers with the signs of G₋ and of G₊, without a root: where H > 0 both have the sign of p,
/// where H < 0 they have those of −q and q. Near H = 0 rounding may choose; there the coefficients count as doubtful.
#[derive(Clone, Copy)]
pub(crate) struct Value<T> {
    pub product: T,
    pub minus: T,
    pub plus: T,
}

impl<T: Lane> Value<T> {
    #[inline(always)]
    pub fn of([p, q, square]: [T; 3]) -> Self {
        let product = (p * p).fused(square, -(q * q));
        let outer = product.like(0.0).below(product);
        Value { product, minus: T::pick(outer, p, -q), plus: T::pick(outer, p, q) }
    }

    #[inline(always)]
    pub fn at(pair: &Reduced<T>, cos: T, sin: T) -> Self {
        Self::of(pair.terms(cos, sin))
    }

    #[inline(always)]
    pub fn pick(mask: T::Mask, yes: Self, no: Self) -> Self {
        Value {
            product: T::pick(mask, yes.product, no.product),
            minus: T::pick(mask, yes.minus, no.minus),
            plus: T::pick(mask, yes.plus, no.plus),
        }
    }

    /// How many of G₋ and G₊ change sign on the way to another angle.
    #[inline(always)]
    pub fn changes(self, next: Self) -> T {
        let zero = self.product.like(0.0);
        zero.more((self.minus * next.minus).below(zero)).more((self.plus * next.plus).below(zero))
    }

    /// G₋ rises through 0 on the way.
    #[inline(always)]
    pub fn rises(self, next: Self) -> T::Mask {
        let zero = self.product.like(0.0);
        T::both(self.minus.below(zero), zero.below(next.minus))
    }
}

/// The count of a pair, or of a register of pairs.
pub(crate) struct Counted<T> {
    /// How many more critical points than known an arc could have.
    pub excess: [T; ARCS],
    /// At the first ends of the arcs.
    pub values: [Value<T>; ARCS],
}

impl<T: Lane> Counted<T> {
    #[inline(always)]
    pub fn new(pair: &Reduced<T>, harmonics: &Harmonics<T>, table: &Arcs) -> Self {
        let values = at_ends(pair, table);
        let doubt = harmonics.doubt();
        let mut counted = Self { excess: [doubt; ARCS], values };
        counted.count::<0>(harmonics, table, doubt);
        counted.count::<1>(harmonics, table, doubt);
        counted.count::<2>(harmonics, table, doubt);
        counted.count::<3>(harmonics, table, doubt);
        counted
    }

    /// The excess of an arc and of the opposite one.
    #[inline(always)]
    fn count<const M: usize>(&mut self, harmonics: &Harmonics<T>, table: &Arcs, doubt: T) {
        let both = harmonics.coefficients::<M>(&self.ends(), table);
        for half in 0..2 {
            let k = M + half * (ARCS / 2);
            let known = self.values[k].changes(self.values[(k + 1) % ARCS]);
            self.excess[k] = changes(&both[half], doubt) - known;
        }
    }

    /// H at the first ends of the arcs.
    #[inline(always)]
    pub fn ends(&self) -> [T; ARCS] {
        let mut ends = [self.values[0].product; ARCS];
        for k in 1..ARCS {
            ends[k] = self.values[k].product;
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
        let (zero, one) = (self.excess[0].like(0.0), self.excess[0].like(1.0));
        let mut middles = [Angle { cos: one, sin: zero }; SLOTS];
        let mut count = zero;
        for k in 0..ARCS {
            let rises = self.values[k].rises(self.values[(k + 1) % ARCS]);
            let center = Angle::like(middles[0], table.centers[k]);
            middles[0] = Angle::pick(T::both(rises, count.below(one)), center, middles[0]);
            middles[1] = Angle::pick(rises, center, middles[1]);
            count = count.more(rises);
        }
        ([Bracket::arc(&table.levels[0], middles[0]), Bracket::arc(&table.levels[0], middles[1])], count)
    }
}

/// At the first ends of the arcs; opposite ends share their odd parts.
#[inline(always)]
fn at_ends<T: Lane>(pair: &Reduced<T>, table: &Arcs) -> [Value<T>; ARCS] {
    let across = pair.radius * pair.tilt_cos;
    let zero = across.like(0.0);
    let mut out = [Value { product: zero, minus: zero, plus: zero }; ARCS];
    for k in 0..ARCS / 2 {
        let (cos, sin) = (zero.like(table.ends[k].cos), zero.like(table.ends[k].sin));
        let p = pair.p[0].fused(cos, pair.p[1] * sin);
        let odd = pair.q[0].fused(cos, pair.q[1] * sin);
        let even = pair.q[2] * zero.like(2.0 * table.ends[k].sin * table.ends[k].cos);
        let (x, y) = (across.fused(cos, pair.x0), pair.radius.fused(sin, pair.y0));
        let (x_opposite, y_opposite) = (across.taken(cos, pair.x0), pair.radius.taken(sin, pair.y0));
        out[k] = Value::of([p, even + odd, x.fused(x, y * y)]);
        let square = x_opposite.fused(x_opposite, y_opposite * y_opposite);
        out[k + ARCS / 2] = Value::of([-p, even - odd, square]);
    }
    out
}

/// The pair is steep enough for the count to mean something.
#[inline(always)]
pub(crate) fn is_steep<T: Lane>(pair: &Reduced<T>) -> T::Mask {
    pair.radius.like(LEAST_SLOPE).below(pair.steepness())
}
