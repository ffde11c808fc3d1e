//! Arcs in doubt, halved until the count agrees: the first one of every lane of a register once, which settles most
//! of the pairs; and those of one pair as often as it takes.

use crate::MAX_MINIMA;
use crate::arcs::{ARCS, Arcs, LEVELS};
use crate::brackets::{Angle, Bracket, Counted, SLOTS, Value};
use crate::count::{Harmonics, changes, halves};
use crate::grid::Direction;
use crate::lane::Lane;
use crate::reduced::Reduced;

/// Halvings of an arc at most.
const HALVINGS: usize = 6;

/// The centre of the first arc in doubt of each lane, and its doubt.
#[inline(always)]
fn first_in_doubt<T: Lane>(counted: &Counted<T>, table: &Arcs) -> (Angle<T>, T) {
    let (zero, one) = (counted.excess[0].like(0.0), counted.excess[0].like(1.0));
    let (mut center, mut found) = (Angle { cos: one, sin: zero }, zero);
    for k in (0..ARCS).rev() {
        let excess = counted.excess[k].abs();
        let here = zero.like(0.5).below(excess);
        center = Angle::pick(here, Angle::like(center, table.centers[k]), center);
        found = T::pick(here, excess, found);
    }
    (center, found)
}

/// Halves the first arc in doubt of each lane, then the half that is in doubt, and so on; and mends the brackets and
/// their number where that settles the pair; returns the doubts that are left.
#[inline(always)]
pub(crate) fn halved<T: Lane>(
    pair: &Reduced<T>,
    harmonics: &Harmonics<T>,
    counted: &Counted<T>,
    (slots, count): &mut ([Bracket<T>; SLOTS], T),
    table: &Arcs,
) -> T {
    let (zero, one, half) = (count.like(0.0), count.like(1.0), count.like(0.5));
    let (center, excess) = first_in_doubt(counted, table);
    let turn = Angle::like(center, table.levels[0].half);
    let [first, last] = [center.turned(turn.cos, -turn.sin), center.turned(turn.cos, turn.sin)];
    let ends = [Value::at(pair, first.cos, first.sin), Value::at(pair, last.cos, last.sin)];
    // The turn from the first arc to this one.
    let origin = Angle::like(center, table.centers[0]);
    let from_first = center.turned(origin.cos, -origin.sin);
    let products = [ends[0].product, ends[1].product];
    let mut coefficients = harmonics.around([from_first.cos, from_first.sin], products, table);
    for i in 0..coefficients.len() {
        coefficients[i] = coefficients[i] * table.weights[i];
    }
    let doubts = counted.doubts();
    // 1 for lanes whose arc is the only one in doubt, while a part of it is.
    let alone = T::both(half.below(excess), (doubts - excess).below(half));
    let mut open = T::pick(alone, one, zero);
    let mut settled = zero;
    // The part on which G₋ rises, if there is one, and how many there are.
    let (mut there, mut rises) = (slots[0], zero);
    let (mut middle, mut values, doubt) = (center, ends, harmonics.doubt());
    for level in 1..LEVELS {
        let between = Value::at(pair, middle.cos, middle.sin);
        let halves = halves(&coefficients);
        let sides = [[values[0], between], [between, values[1]]];
        let quarter = Angle::like(middle, table.levels[level].half);
        let middles = [middle.turned(quarter.cos, -quarter.sin), middle.turned(quarter.cos, quarter.sin)];
        let mut known = [zero; 2];
        for side in 0..2 {
            let [from, to] = sides[side];
            known[side] = T::pick((changes(&halves[side], doubt) - from.changes(to)).abs().below(half), open, zero);
            let here = T::both(half.below(known[side]), from.rises(to));
            there = Bracket::pick(here, Bracket::arc(&table.levels[level], middles[side]), there);
            rises = rises.more(here);
        }
        settled = settled + known[0] * known[1];
        // What goes on has one half in doubt.
        open = known[0] + known[1] - known[0] * known[1] * 2.0;
        if !T::any(zero.below(open)) {
            break;
        }
        let left = known[0].below(half);
        middle = Angle::pick(left, middles[0], middles[1]);
        for i in 0..2 {
            values[i] = Value::pick(left, sides[0][i], sides[1][i]);
        }
        for i in 0..coefficients.len() {
            coefficients[i] = T::pick(left, halves[0][i], halves[1][i]);
        }
    }
    let before = T::pick(ends[0].rises(ends[1]), one, zero);
    let settled = T::both(half.below(settled), rises.below(one + half));
    let extra = T::both(settled, half.below(rises - before));
    let kept = T::both(settled, half.below(before));
    for slot in slots.iter_mut() {
        let off = (slot.middle.cos - center.cos).abs() + (slot.middle.sin - center.sin).abs();
        *slot = Bracket::pick(T::both(kept, off.below(zero.like(1e-9))), there, *slot);
    }
    slots[0] = Bracket::pick(T::both(extra, count.below(half)), there, slots[0]);
    slots[1] = Bracket::pick(extra, there, slots[1]);
    *count = count.more(extra);
    T::pick(settled, zero, doubts)
}

/// The arcs of one pair on which G₋ rises through 0.
pub(crate) struct Brackets {
    pub all: [Bracket<f64>; MAX_MINIMA],
    pub count: usize,
}

impl Brackets {
    /// From the count, arcs in doubt halved as often as it takes; `None` where that does not decide.
    pub fn of_pair(pair: &Reduced<f64>, table: &Arcs) -> Option<Self> {
        let harmonics = Harmonics::new(pair, table);
        let counted = &Counted::new(pair, &harmonics, table);
        let none = Bracket::arc(&table.levels[0], Angle { cos: 1.0, sin: 0.0 });
        let mut brackets = Self { all: [none; MAX_MINIMA], count: 0 };
        for k in 0..ARCS {
            if counted.excess[k] != 0.0 {
                brackets.halve(pair, &harmonics, counted, k, table)?;
            } else if counted.values[k].rises(counted.values[(k + 1) % ARCS]) {
                brackets.add(Bracket::arc(&table.levels[0], Angle::like(none.middle, table.centers[k])))?;
            }
        }
        Some(brackets)
    }

    /// Adds what an arc in doubt has.
    #[inline(never)]
    fn halve(
        &mut self,
        pair: &Reduced<f64>,
        harmonics: &Harmonics<f64>,
        counted: &Counted<f64>,
        k: usize,
        table: &Arcs,
    ) -> Option<()> {
        let turn = Angle { cos: table.centers[k].cos, sin: table.centers[k].sin }
            .turned(table.centers[0].cos, -table.centers[0].sin);
        let ends = [counted.values[k], counted.values[(k + 1) % ARCS]];
        let mut coefficients = harmonics.around([turn.cos, turn.sin], ends.map(|value| value.product), table);
        for i in 0..coefficients.len() {
            coefficients[i] *= table.weights[i];
        }
        let arc = Arc { from: -1.0, to: 1.0, ends, coefficients };
        arc.examine(
            &Doubtful { pair, doubt: harmonics.certain(), center: table.centers[k], edge: table.levels[0].edge },
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
    ends: [Value<f64>; 2],
    coefficients: [f64; 9],
}

impl Arc {
    /// Adds what the arc has, halving it as often as it takes; `None` where that does not decide.
    fn examine(&self, of: &Doubtful<'_>, halvings: usize, brackets: &mut Brackets) -> Option<()> {
        // No branches: what is found here is anyone's guess.
        let mut certain = self.coefficients[8].abs() > of.doubt;
        let mut changes = 0u8;
        for i in 0..8 {
            let [b, next] = [self.coefficients[i], self.coefficients[i + 1]];
            certain &= b.abs() > of.doubt;
            changes += u8::from((b < 0.0) != (next < 0.0));
        }
        if !certain {
            return None;
        }
        let [first, last] = self.ends;
        if f64::from(changes) == first.changes(last) {
            return if first.rises(last) { brackets.add(self.bracket(of)) } else { Some(()) };
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = 0.5 * (self.from + self.to);
        let at = of.center.ahead(middle * of.edge);
        let between = Value::at(of.pair, at.cos, at.sin);
        let [left, right] = halves(&self.coefficients);
        let left = Arc { from: self.from, to: middle, ends: [first, between], coefficients: left };
        left.examine(of, halvings, brackets)?;
        let right = Arc { from: middle, to: self.to, ends: [between, last], coefficients: right };
        right.examine(of, halvings, brackets)
    }

    fn bracket(&self, of: &Doubtful<'_>) -> Bracket<f64> {
        let [first, last] = [self.from, self.to].map(|part| of.center.ahead(part * of.edge));
        let (x, y) = (first.cos + last.cos, first.sin + last.sin);
        let length = (x * x + y * y).sqrt();
        let across = first.cos * last.sin - first.sin * last.cos;
        // With φ the width, length = 2 cos φ/2: tan φ/4 = sin φ/2/(1 + cos φ/2), and sin φ/2 = sin φ/length.
        let edge = across / (length * (1.0 + 0.5 * length));
        Bracket::new(Angle { cos: x / length, sin: y / length }, edge)
    }
}
