//! Arcs in doubt, halved until the count agrees: the first one of every lane of a register once, which settles most
//! of the pairs; and those of one pair as often as it takes.

use crate::MAX_MINIMA;
use crate::brackets::{Angle, Bracket, Counted, SLOTS};
use crate::count::{ARCS, Arcs, Harmonics, changes, halves};
use crate::grid::Direction;
use crate::lane::Lane;
use crate::relative::Reduced;

/// Halvings of an arc at most.
const HALVINGS: usize = 6;

/// The first arc in doubt of each lane.
struct Chosen<T> {
    center: Angle<T>,
    /// cos and sin of its turn from the first arc.
    turn: [T; 2],
    minus: [T; 2],
    plus: [T; 2],
    excess: T,
}

impl<T: Lane> Chosen<T> {
    #[inline(always)]
    fn of(counted: &Counted<T>, table: &Arcs) -> Self {
        let (zero, one) = (counted.minus[0].like(0.0), counted.minus[0].like(1.0));
        let mut chosen = Self {
            center: Angle { cos: one, sin: zero },
            turn: [one, zero],
            minus: [one; 2],
            plus: [one; 2],
            excess: zero,
        };
        for k in (0..ARCS).rev() {
            let (next, excess) = ((k + 1) % ARCS, counted.excess[k].abs());
            let here = zero.like(0.5).below(excess);
            let Angle { cos, sin } = chosen.center;
            chosen.center = Angle {
                cos: T::pick(here, one.like(table.centers[k].cos), cos),
                sin: T::pick(here, one.like(table.centers[k].sin), sin),
            };
            for i in 0..2 {
                chosen.turn[i] = T::pick(here, one.like(table.eighths[k][i]), chosen.turn[i]);
                let end = if i == 0 { k } else { next };
                chosen.minus[i] = T::pick(here, counted.minus[end], chosen.minus[i]);
                chosen.plus[i] = T::pick(here, counted.plus[end], chosen.plus[i]);
            }
            chosen.excess = T::pick(here, excess, chosen.excess);
        }
        chosen
    }
}

/// Halves the first arc in doubt of each lane, and mends the brackets and their number where that settles the pair;
/// returns the doubts that are left.
#[inline(always)]
pub(crate) fn halved<T: Lane>(
    pair: &Reduced<T>,
    harmonics: &Harmonics<T>,
    counted: &Counted<T>,
    (slots, count): &mut ([Bracket<T>; SLOTS], T),
    table: &Arcs,
) -> T {
    let (zero, one) = (count.like(0.0), count.like(1.0));
    let half = count.like(0.5);
    let arc = Chosen::of(counted, table);
    let ends = [arc.minus[0] * arc.plus[0], arc.minus[1] * arc.plus[1]];
    let mut whole = harmonics.around(arc.turn, ends, table);
    for i in 0..whole.len() {
        whole[i] = whole[i] * table.weights[i];
    }
    let parts = halves(&whole);
    let [minus, plus] = pair.factors(arc.center.cos, arc.center.sin);
    let (minus, plus) = ([arc.minus[0], minus, arc.minus[1]], [arc.plus[0], plus, arc.plus[1]]);
    let mut left = zero;
    let mut rises = [zero; 2];
    for side in 0..2 {
        let root = T::pick((minus[side] * minus[side + 1]).below(zero), one, zero);
        let far = T::pick((plus[side] * plus[side + 1]).below(zero), one, zero);
        left = left + (changes(&parts[side], harmonics.doubt()) - (root + far)).abs();
        rises[side] = T::pick(T::both(minus[side].below(zero), zero.below(minus[side + 1])), one, zero);
    }
    let doubts = counted.doubts();
    let alone = T::both(half.below(arc.excess), (doubts - arc.excess).below(half));
    let settled = T::both(left.below(half), alone);
    // The half on which G₋ rises, if there is one; one of them at most, for the middle has one sign.
    let Arcs { half_edge, half_turn, .. } = *table;
    let on_left = half.below(rises[0]);
    let (low, high) = (T::pick(on_left, minus[0], minus[1]), T::pick(on_left, minus[1], minus[2]));
    let sin = T::pick(on_left, one.like(-half_turn.sin), one.like(half_turn.sin));
    let Angle { cos: x, sin: y } = arc.center;
    let middle = Angle { cos: x * half_turn.cos - y * sin, sin: y * half_turn.cos + x * sin };
    let there = Bracket { middle, edge: one.like(half_edge), low, high };
    let before = T::pick(T::both(minus[0].below(zero), zero.below(minus[2])), one, zero);
    let extra = T::both(settled, half.below(rises[0] + rises[1] - before));
    let kept = T::both(settled, half.below(before));
    for slot in slots.iter_mut() {
        let off = (slot.middle.cos - x).abs() + (slot.middle.sin - y).abs();
        *slot = Bracket::pick(T::both(kept, off.below(zero.like(1e-9))), there, *slot);
    }
    slots[0] = Bracket::pick(T::both(extra, count.below(half)), there, slots[0]);
    slots[1] = Bracket::pick(extra, there, slots[1]);
    *count = *count + T::pick(extra, one, zero);
    T::pick(settled, zero, doubts)
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
            coefficients[i] *= table.weights[i];
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
