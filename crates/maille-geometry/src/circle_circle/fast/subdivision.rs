//! Bisection of the arcs on which the root count is not exact.
//!
//! Bernstein coefficients on a smaller arc change sign less often, so that the two bounds of `root_count.rs` agree
//! sooner or later, unless roots nearly coincide. [`subdivide_first_doubtful`] bisects the first doubtful arc of
//! every lane, which settles most pairs; [`BracketList::isolate`] bisects all doubtful arcs of one pair.

use crate::circle_circle::angle::{Angle, Direction};
use crate::circle_circle::fast::arc_tables::{ARCS, ArcTables, LEVELS};
use crate::circle_circle::fast::bernstein::{Harmonics, sign_changes, split};
use crate::circle_circle::fast::bracket::{Bracket, MAX_SIMD_MINIMA};
use crate::circle_circle::fast::root_count::{FactorSigns, RootCounts};
use crate::circle_circle::minimum::MAX_MINIMA;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Maximum number of bisections of an arc of one pair.
const MAX_BISECTIONS: usize = 6;

/// The centre of the first doubtful arc of each lane, and its excess (0 if no arc is in doubt).
#[inline(always)]
fn first_doubtful<T: SimdReal>(counts: &RootCounts<T>, tables: &ArcTables) -> (Angle<T>, T) {
    let (zero, one) = (counts.excess[0].splat(0.0), counts.excess[0].splat(1.0));
    let (mut center, mut found) = (Angle { cos: one, sin: zero }, zero);
    for k in (0..ARCS).rev() {
        let excess = counts.excess[k].abs();
        let is_doubtful = zero.splat(0.5).lt(excess);
        center = Angle::select(is_doubtful, Angle::splat(center, tables.centers[k]), center);
        found = T::select(is_doubtful, excess, found);
    }
    (center, found)
}

/// Bisects the first doubtful arc of each lane, then its doubtful half, and so on, `LEVELS - 1` times at most.
///
/// Where that settles the pair, the brackets and their number are corrected. Returns the total excess of the lanes
/// that are not settled, 0 for the others. Flags are numbers, 1 for true and 0 for false.
#[inline(always)]
pub(crate) fn subdivide_first_doubtful<T: SimdReal>(
    pair: &NormalizedPair<T>,
    harmonics: &Harmonics<T>,
    counts: &RootCounts<T>,
    (brackets, count): &mut ([Bracket<T>; MAX_SIMD_MINIMA], T),
    tables: &ArcTables,
) -> T {
    let (zero, one, half) = (count.splat(0.0), count.splat(1.0), count.splat(0.5));

    // Signs at the ends of the arc.
    let (center, excess) = first_doubtful(counts, tables);
    let turn = Angle::splat(center, tables.levels[0].half_width);
    let [first, last] = [center.rotated(turn.cos, -turn.sin), center.rotated(turn.cos, turn.sin)];
    let ends = [FactorSigns::at(pair, first.cos, first.sin), FactorSigns::at(pair, last.cos, last.sin)];

    // Bernstein coefficients on the arc, from its rotation relative to the first one.
    let origin = Angle::splat(center, tables.centers[0]);
    let from_first = center.rotated(origin.cos, -origin.sin);
    let products = [ends[0].product, ends[1].product];
    let mut coefficients = harmonics.on_arc([from_first.cos, from_first.sin], products, tables);
    for i in 0..coefficients.len() {
        coefficients[i] = coefficients[i] * tables.bernstein_weights[i];
    }

    // A pair can be settled only if no other arc is in doubt. `open` is 1 while a part of the arc is in doubt.
    let total_excess = counts.total_excess();
    let is_only_one = T::and(half.lt(excess), (total_excess - excess).lt(half));
    let mut open = T::select(is_only_one, one, zero);
    let mut settled = zero;

    // Bisection. `rising` is the part on which G₋ rises, `rising_count` the number of such parts.
    let (mut rising, mut rising_count) = (brackets[0], zero);
    let (mut middle, mut part_ends, threshold) = (center, ends, harmonics.product_threshold());
    for level in 1..LEVELS {
        let between = FactorSigns::at(pair, middle.cos, middle.sin);
        let halves = split(&coefficients);
        let sides = [[part_ends[0], between], [between, part_ends[1]]];
        let quarter = Angle::splat(middle, tables.levels[level].half_width);
        let middles = [middle.rotated(quarter.cos, -quarter.sin), middle.rotated(quarter.cos, quarter.sin)];
        // Compare the two bounds on each half.
        let mut known = [zero; 2];
        for side in 0..2 {
            let [from, to] = sides[side];
            known[side] =
                T::select((sign_changes(&halves[side], threshold) - from.sign_changes(to)).abs().lt(half), open, zero);
            let rises_here = T::and(half.lt(known[side]), from.rises(to));
            rising = Bracket::select(rises_here, Bracket::on_arc(&tables.levels[level], middles[side]), rising);
            rising_count = rising_count.add_one_if(rises_here);
        }
        // Both halves known: settled. One half known: continue with the other. None: give up.
        settled = settled + known[0] * known[1];
        open = known[0] + known[1] - known[0] * known[1] * 2.0;
        if !T::any(zero.lt(open)) {
            break;
        }
        let in_left = known[0].lt(half);
        middle = Angle::select(in_left, middles[0], middles[1]);
        for i in 0..2 {
            part_ends[i] = FactorSigns::select(in_left, sides[0][i], sides[1][i]);
        }
        for i in 0..coefficients.len() {
            coefficients[i] = T::select(in_left, halves[0][i], halves[1][i]);
        }
    }

    // Correct the brackets: narrow the one on this arc, or add one if the signs at the ends had not shown it.
    let was_rising = T::select(ends[0].rises(ends[1]), one, zero);
    let settled = T::and(half.lt(settled), rising_count.lt(one + half));
    let is_new = T::and(settled, half.lt(rising_count - was_rising));
    let is_narrowed = T::and(settled, half.lt(was_rising));
    for bracket in brackets.iter_mut() {
        let off = (bracket.middle.cos - center.cos).abs() + (bracket.middle.sin - center.sin).abs();
        *bracket = Bracket::select(T::and(is_narrowed, off.lt(zero.splat(1e-9))), rising, *bracket);
    }
    brackets[0] = Bracket::select(T::and(is_new, count.lt(half)), rising, brackets[0]);
    brackets[1] = Bracket::select(is_new, rising, brackets[1]);
    *count = count.add_one_if(is_new);
    T::select(settled, zero, total_excess)
}

/// Brackets of all minima of one pair.
pub(crate) struct BracketList {
    /// The brackets, then copies of an unused one.
    pub all: [Bracket<f64>; MAX_MINIMA],
    /// Number of brackets in use.
    pub count: usize,
}

impl BracketList {
    /// Isolates all minima of a pair, bisecting arcs where necessary. `None` if that does not decide.
    pub fn isolate(pair: &NormalizedPair<f64>, tables: &ArcTables) -> Option<Self> {
        let harmonics = Harmonics::new(pair, tables);
        let counts = &RootCounts::new(pair, &harmonics, tables);
        let none = Bracket::on_arc(&tables.levels[0], Angle { cos: 1.0, sin: 0.0 });
        let mut brackets = Self { all: [none; MAX_MINIMA], count: 0 };
        for k in 0..ARCS {
            if counts.excess[k] != 0.0 {
                brackets.subdivide(pair, &harmonics, counts, k, tables)?;
            } else if counts.signs[k].rises(counts.signs[(k + 1) % ARCS]) {
                brackets.push(Bracket::on_arc(&tables.levels[0], Angle::splat(none.middle, tables.centers[k])))?;
            }
        }
        Some(brackets)
    }

    /// Adds the brackets on arc `k`, which is in doubt.
    #[inline(never)]
    fn subdivide(
        &mut self,
        pair: &NormalizedPair<f64>,
        harmonics: &Harmonics<f64>,
        counts: &RootCounts<f64>,
        k: usize,
        tables: &ArcTables,
    ) -> Option<()> {
        let turn = Angle { cos: tables.centers[k].cos, sin: tables.centers[k].sin }
            .rotated(tables.centers[0].cos, -tables.centers[0].sin);
        let ends = [counts.signs[k], counts.signs[(k + 1) % ARCS]];
        let mut coefficients = harmonics.on_arc([turn.cos, turn.sin], ends.map(|value| value.product), tables);
        for i in 0..coefficients.len() {
            coefficients[i] *= tables.bernstein_weights[i];
        }
        let arc = SubArc { from: -1.0, to: 1.0, ends, coefficients };
        arc.isolate(
            &DoubtfulArc {
                pair,
                threshold: harmonics.coefficient_threshold(),
                center: tables.centers[k],
                quarter_tan: tables.levels[0].quarter_tan,
            },
            MAX_BISECTIONS,
            self,
        )
    }

    /// Adds a bracket. `None` if there are too many.
    fn push(&mut self, bracket: Bracket<f64>) -> Option<()> {
        *self.all.get_mut(self.count)? = bracket;
        self.count += 1;
        Some(())
    }
}

/// What all parts of a doubtful arc share.
struct DoubtfulArc<'a> {
    pair: &'a NormalizedPair<f64>,
    /// Coefficients of smaller absolute value have no certain sign.
    threshold: f64,
    /// Centre of the arc.
    center: Direction,
    /// `T` of the arc.
    quarter_tan: f64,
}

/// A part of an arc: `from ≤ t/T ≤ to`.
struct SubArc {
    from: f64,
    to: f64,
    /// Signs at both ends.
    ends: [FactorSigns<f64>; 2],
    /// Bernstein coefficients of H, undivided.
    coefficients: [f64; 9],
}

impl SubArc {
    /// Adds the brackets on this part, bisecting it at most `bisections` times. `None` if that does not decide.
    fn isolate(&self, arc: &DoubtfulArc<'_>, bisections: usize, brackets: &mut BracketList) -> Option<()> {
        // Without branches, which would be mispredicted.
        let mut certain = self.coefficients[8].abs() > arc.threshold;
        let mut changes = 0u8;
        for i in 0..8 {
            let [b, next] = [self.coefficients[i], self.coefficients[i + 1]];
            certain &= b.abs() > arc.threshold;
            changes += u8::from((b < 0.0) != (next < 0.0));
        }
        if !certain {
            return None;
        }
        let [first, last] = self.ends;
        if f64::from(changes) == first.sign_changes(last) {
            return if first.rises(last) { brackets.push(self.bracket(arc)) } else { Some(()) };
        }
        // Bisect.
        let bisections = bisections.checked_sub(1)?;
        let middle = 0.5 * (self.from + self.to);
        let at = arc.center.rotated_by_half_tan(middle * arc.quarter_tan);
        let between = FactorSigns::at(arc.pair, at.cos, at.sin);
        let [left, right] = split(&self.coefficients);
        let left = SubArc { from: self.from, to: middle, ends: [first, between], coefficients: left };
        left.isolate(arc, bisections, brackets)?;
        let right = SubArc { from: middle, to: self.to, ends: [between, last], coefficients: right };
        right.isolate(arc, bisections, brackets)
    }

    /// The bracket that covers this part.
    fn bracket(&self, arc: &DoubtfulArc<'_>) -> Bracket<f64> {
        let [first, last] = [self.from, self.to].map(|t| arc.center.rotated_by_half_tan(t * arc.quarter_tan));
        let (x, y) = (first.cos + last.cos, first.sin + last.sin);
        let length = (x * x + y * y).sqrt();
        let sin_width = first.cos * last.sin - first.sin * last.cos;
        // With φ the width: length = 2 cos(φ/2), sin(φ/2) = sin φ/length, and tan(φ/4) = sin(φ/2)/(1 + cos(φ/2)).
        let quarter_tan = sin_width / (length * (1.0 + 0.5 * length));
        Bracket::new(Angle { cos: x / length, sin: y / length }, quarter_tan)
    }
}
