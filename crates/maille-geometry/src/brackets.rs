//! Arcs of the moving circle with one minimum each: what the count ([`crate::count`]) proves, and the halving of arcs where
//! it does not.

use crate::MAX_MINIMA;
use crate::count::{ARCS, Arcs, Harmonics, changes, halves};
use crate::grid::Direction;
use crate::lane::Lane;
use crate::relative::Reduced;

/// Minima of a register's pairs; a third one has never been seen.
pub(crate) const SLOTS: usize = 2;
/// The slope and its parts must be larger than this, in units of the pair's scale.
const LEAST_SLOPE: f64 = 1e-10;
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
    fn arc(table: &Arcs, k: usize, low: T, high: T) -> Self {
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
    fn ends(&self) -> [T; ARCS] {
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

/// The arcs of one pair on which G₋ rises through 0.
pub(crate) struct Brackets {
    pub all: [Bracket<f64>; MAX_MINIMA],
    pub count: usize,
}

impl Brackets {
    /// From the count, arcs in doubt halved as often as it takes; `None` where that does not decide.
    #[inline(always)]
    pub fn new(pair: &Reduced<f64>, counted: &Counted<f64>, table: &Arcs) -> Option<Self> {
        let mut brackets = Self { all: [Bracket::arc(table, 0, -1.0, 1.0); MAX_MINIMA], count: 0 };
        for k in 0..ARCS {
            let [low, high] = [counted.minus[k], counted.minus[(k + 1) % ARCS]];
            if counted.excess[k] != 0.0 {
                brackets.halve(pair, counted, k, table)?;
            } else if low < 0.0 && high >= 0.0 {
                brackets.add(Bracket::arc(table, k, low, high))?;
            }
        }
        Some(brackets)
    }

    /// Adds what an arc in doubt has.
    #[inline(never)]
    fn halve(&mut self, pair: &Reduced<f64>, counted: &Counted<f64>, k: usize, table: &Arcs) -> Option<()> {
        let harmonics = Harmonics::new(pair, table);
        let mut coefficients = harmonics.turned().coefficients(k % (ARCS / 2), &counted.ends(), table)[k / (ARCS / 2)];
        for i in 0..coefficients.len() {
            coefficients[i] = coefficients[i] * table.weights[i];
        }
        let arc = Arc {
            from: -1.0,
            to: 1.0,
            minus: [counted.minus[k], counted.minus[(k + 1) % ARCS]],
            plus: [counted.plus[k], counted.plus[(k + 1) % ARCS]],
            coefficients,
        };
        arc.examine(
            &Doubtful { pair, doubt: harmonics.certain(), center: table.centers[k], edge: table.edge },
            HALVINGS,
            self,
        )
    }

    /// `None` if there are too many.
    fn add(&mut self, bracket: Bracket<f64>) -> Option<()> {
        *self.all.get_mut(self.count)? = bracket;
        self.count += 1;
        Some(())
    }
}

/// What the parts of an arc have in common.
struct Doubtful<'a> {
    pair: &'a Reduced<f64>,
    /// Coefficients smaller than this have no certain sign.
    doubt: f64,
    center: Direction,
    edge: f64,
}

/// A part of an arc, between the values `from` and `to` of t/T.
struct Arc {
    from: f64,
    to: f64,
    minus: [f64; 2],
    plus: [f64; 2],
    coefficients: [f64; 9],
}

impl Arc {
    /// Adds what the arc has, halving it as often as it takes; `None` where that does not decide.
    fn examine(&self, of: &Doubtful<'_>, halvings: usize, brackets: &mut Brackets) -> Option<()> {
        let change = |g: &[f64; 2]| usize::from((g[0] < 0.0) != (g[1] < 0.0));
        // No branches: what is found here is anyone's guess.
        let mut certain = self.coefficients[8].abs() > of.doubt;
        let mut changes = 0;
        for i in 0..8 {
            let [b, next] = [self.coefficients[i], self.coefficients[i + 1]];
            certain &= b.abs() > of.doubt;
            changes += usize::from((b < 0.0) != (next < 0.0));
        }
        if !certain {
            return None;
        }
        if changes == change(&self.minus) + change(&self.plus) {
            return if self.minus[0] < 0.0 && self.minus[1] >= 0.0 { brackets.add(self.bracket(of)) } else { Some(()) };
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = 0.5 * (self.from + self.to);
        let at = of.center.ahead(middle * of.edge);
        let [minus, plus] = of.pair.factors(at.cos, at.sin);
        let [left, right] = halves(&self.coefficients);
        let left = Arc {
            from: self.from,
            to: middle,
            minus: [self.minus[0], minus],
            plus: [self.plus[0], plus],
            coefficients: left,
        };
        left.examine(of, halvings, brackets)?;
        let right = Arc {
            from: middle,
            to: self.to,
            minus: [minus, self.minus[1]],
            plus: [plus, self.plus[1]],
            coefficients: right,
        };
        right.examine(of, halvings, brackets)
    }

    fn bracket(&self, of: &Doubtful<'_>) -> Bracket<f64> {
        let [first, last] = [self.from, self.to].map(|part| of.center.ahead(part * of.edge));
        let (x, y) = (first.cos + last.cos, first.sin + last.sin);
        let length = (x * x + y * y).sqrt();
        let across = first.cos * last.sin - first.sin * last.cos;
        // With φ the width, length = 2 cos φ/2: tan φ/4 = sin φ/2/(1 + cos φ/2), and sin φ/2 = sin φ/length.
        let edge = across / (length * (1.0 + 0.5 * length));
        let middle = Angle { cos: x / length, sin: y / length };
        Bracket { middle, edge, low: self.minus[0], high: self.minus[1] }
    }
}
