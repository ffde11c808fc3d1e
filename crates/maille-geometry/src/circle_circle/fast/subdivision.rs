//! ArcTables in doubt, halved until the count agrees: the first one of every lane of a register once, which settles most
//! of the pairs; and those of one pair as often as it takes.

use crate::circle_circle::angle::{Angle, Direction};
use crate::circle_circle::fast::arc_tables::{ARCS, ArcTables, LEVELS};
use crate::circle_circle::fast::bernstein::{Harmonics, sign_changes, split};
use crate::circle_circle::fast::bracket::{Bracket, MAX_SIMD_MINIMA};
use crate::circle_circle::fast::root_count::{FactorSigns, RootCounts};
use crate::circle_circle::minimum::MAX_MINIMA;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Halvings of an arc at most.
const MAX_BISECTIONS: usize = 6;

/// The centre of the first arc in doubt of each lane, and its doubt.
#[inline(always)]
fn first_in_doubt<T: SimdReal>(counted: &RootCounts<T>, tables: &ArcTables) -> (Angle<T>, T) {
    let (zero, one) = (counted.excess[0].splat(0.0), counted.excess[0].splat(1.0));
    let (mut center, mut found) = (Angle { cos: one, sin: zero }, zero);
    for k in (0..ARCS).rev() {
        let excess = counted.excess[k].abs();
        let here = zero.splat(0.5).lt(excess);
        center = Angle::select(here, Angle::splat(center, tables.centers[k]), center);
        found = T::select(here, excess, found);
    }
    (center, found)
}

/// Halves the first arc in doubt of each lane, then the half that is in doubt, and so on; and mends the brackets and
/// their number where that settles the pair; returns the doubts that are left.
#[inline(always)]
pub(crate) fn subdivide_first_doubtful<T: SimdReal>(
    pair: &NormalizedPair<T>,
    harmonics: &Harmonics<T>,
    counted: &RootCounts<T>,
    (slots, count): &mut ([Bracket<T>; MAX_SIMD_MINIMA], T),
    tables: &ArcTables,
) -> T {
    let (zero, one, half) = (count.splat(0.0), count.splat(1.0), count.splat(0.5));
    let (center, excess) = first_in_doubt(counted, tables);
    let turn = Angle::splat(center, tables.levels[0].half_width);
    let [first, last] = [center.rotated(turn.cos, -turn.sin), center.rotated(turn.cos, turn.sin)];
    let ends = [FactorSigns::at(pair, first.cos, first.sin), FactorSigns::at(pair, last.cos, last.sin)];
    // The turn from the first arc to this one.
    let origin = Angle::splat(center, tables.centers[0]);
    let from_first = center.rotated(origin.cos, -origin.sin);
    let products = [ends[0].product, ends[1].product];
    let mut coefficients = harmonics.on_arc([from_first.cos, from_first.sin], products, tables);
    for i in 0..coefficients.len() {
        coefficients[i] = coefficients[i] * tables.bernstein_weights[i];
    }
    let doubts = counted.total_excess();
    // 1 for lanes whose arc is the only one in doubt, while a part of it is.
    let alone = T::and(half.lt(excess), (doubts - excess).lt(half));
    let mut open = T::select(alone, one, zero);
    let mut settled = zero;
    // The part on which G₋ rises, if there is one, and how many there are.
    let (mut there, mut rises) = (slots[0], zero);
    let (mut middle, mut values, doubt) = (center, ends, harmonics.product_threshold());
    for level in 1..LEVELS {
        let between = FactorSigns::at(pair, middle.cos, middle.sin);
        let halves = split(&coefficients);
        let sides = [[values[0], between], [between, values[1]]];
        let quarter = Angle::splat(middle, tables.levels[level].half_width);
        let middles = [middle.rotated(quarter.cos, -quarter.sin), middle.rotated(quarter.cos, quarter.sin)];
        let mut known = [zero; 2];
        for side in 0..2 {
            let [from, to] = sides[side];
            known[side] =
                T::select((sign_changes(&halves[side], doubt) - from.sign_changes(to)).abs().lt(half), open, zero);
            let here = T::and(half.lt(known[side]), from.rises(to));
            there = Bracket::select(here, Bracket::on_arc(&tables.levels[level], middles[side]), there);
            rises = rises.add_one_if(here);
        }
        settled = settled + known[0] * known[1];
        // What goes on has one half in doubt.
        open = known[0] + known[1] - known[0] * known[1] * 2.0;
        if !T::any(zero.lt(open)) {
            break;
        }
        let left = known[0].lt(half);
        middle = Angle::select(left, middles[0], middles[1]);
        for i in 0..2 {
            values[i] = FactorSigns::select(left, sides[0][i], sides[1][i]);
        }
        for i in 0..coefficients.len() {
            coefficients[i] = T::select(left, halves[0][i], halves[1][i]);
        }
    }
    let before = T::select(ends[0].rises(ends[1]), one, zero);
    let settled = T::and(half.lt(settled), rises.lt(one + half));
    let extra = T::and(settled, half.lt(rises - before));
    let kept = T::and(settled, half.lt(before));
    for slot in slots.iter_mut() {
        let off = (slot.middle.cos - center.cos).abs() + (slot.middle.sin - center.sin).abs();
        *slot = Bracket::select(T::and(kept, off.lt(zero.splat(1e-9))), there, *slot);
    }
    slots[0] = Bracket::select(T::and(extra, count.lt(half)), there, slots[0]);
    slots[1] = Bracket::select(extra, there, slots[1]);
    *count = count.add_one_if(extra);
    T::select(settled, zero, doubts)
}

/// The arcs of one pair on which G₋ rises through 0.
pub(crate) struct BracketList {
    pub all: [Bracket<f64>; MAX_MINIMA],
    pub count: usize,
}

impl BracketList {
    /// From the count, arcs in doubt halved as often as it takes; `None` where that does not decide.
    pub fn isolate(pair: &NormalizedPair<f64>, tables: &ArcTables) -> Option<Self> {
        let harmonics = Harmonics::new(pair, tables);
        let counted = &RootCounts::new(pair, &harmonics, tables);
        let none = Bracket::on_arc(&tables.levels[0], Angle { cos: 1.0, sin: 0.0 });
        let mut brackets = Self { all: [none; MAX_MINIMA], count: 0 };
        for k in 0..ARCS {
            if counted.excess[k] != 0.0 {
                brackets.subdivide(pair, &harmonics, counted, k, tables)?;
            } else if counted.signs[k].rises(counted.signs[(k + 1) % ARCS]) {
                brackets.push(Bracket::on_arc(&tables.levels[0], Angle::splat(none.middle, tables.centers[k])))?;
            }
        }
        Some(brackets)
    }

    /// Adds what an arc in doubt has.
    #[inline(never)]
    fn subdivide(
        &mut self,
        pair: &NormalizedPair<f64>,
        harmonics: &Harmonics<f64>,
        counted: &RootCounts<f64>,
        k: usize,
        tables: &ArcTables,
    ) -> Option<()> {
        let turn = Angle { cos: tables.centers[k].cos, sin: tables.centers[k].sin }
            .rotated(tables.centers[0].cos, -tables.centers[0].sin);
        let ends = [counted.signs[k], counted.signs[(k + 1) % ARCS]];
        let mut coefficients = harmonics.on_arc([turn.cos, turn.sin], ends.map(|value| value.product), tables);
        for i in 0..coefficients.len() {
            coefficients[i] *= tables.bernstein_weights[i];
        }
        let arc = SubArc { from: -1.0, to: 1.0, ends, coefficients };
        arc.isolate(
            &DoubtfulArc {
                pair,
                doubt: harmonics.coefficient_threshold(),
                center: tables.centers[k],
                quarter_tan: tables.levels[0].quarter_tan,
            },
            MAX_BISECTIONS,
            self,
        )
    }

    /// `None` if there are too many.
    fn push(&mut self, bracket: Bracket<f64>) -> Option<()> {
        *self.all.get_mut(self.count)? = bracket;
        self.count += 1;
        Some(())
    }
}

/// What the parts of an arc have in common.
struct DoubtfulArc<'a> {
    pair: &'a NormalizedPair<f64>,
    /// Coefficients smaller than this have no certain sign.
    doubt: f64,
    center: Direction,
    quarter_tan: f64,
}

/// A part of an arc, between the values `from` and `to` of t/T.
struct SubArc {
    from: f64,
    to: f64,
    ends: [FactorSigns<f64>; 2],
    coefficients: [f64; 9],
}

impl SubArc {
    /// Adds what the arc has, halving it as often as it takes; `None` where that does not decide.
    fn isolate(&self, of: &DoubtfulArc<'_>, halvings: usize, brackets: &mut BracketList) -> Option<()> {
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
        if f64::from(changes) == first.sign_changes(last) {
            return if first.rises(last) { brackets.push(self.bracket(of)) } else { Some(()) };
        }
        let halvings = halvings.checked_sub(1)?;
        let middle = 0.5 * (self.from + self.to);
        let at = of.center.rotated_by_half_tan(middle * of.quarter_tan);
        let between = FactorSigns::at(of.pair, at.cos, at.sin);
        let [left, right] = split(&self.coefficients);
        let left = SubArc { from: self.from, to: middle, ends: [first, between], coefficients: left };
        left.isolate(of, halvings, brackets)?;
        let right = SubArc { from: middle, to: self.to, ends: [between, last], coefficients: right };
        right.isolate(of, halvings, brackets)
    }

    fn bracket(&self, of: &DoubtfulArc<'_>) -> Bracket<f64> {
        let [first, last] = [self.from, self.to].map(|part| of.center.rotated_by_half_tan(part * of.quarter_tan));
        let (x, y) = (first.cos + last.cos, first.sin + last.sin);
        let length = (x * x + y * y).sqrt();
        let across = first.cos * last.sin - first.sin * last.cos;
        // With φ the width, length = 2 cos φ/2: tan φ/4 = sin φ/2/(1 + cos φ/2), and sin φ/2 = sin φ/length.
        let quarter_tan = across / (length * (1.0 + 0.5 * length));
        Bracket::new(Angle { cos: x / length, sin: y / length }, quarter_tan)
    }
}
