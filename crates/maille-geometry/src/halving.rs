//! One halving of an arc in doubt in every lane of a register: settles two in three of the pairs that the count leaves.

use crate::brackets::{Angle, Bracket, Counted, SLOTS};
use crate::count::{ARCS, Arcs, Harmonics, changes, halves};
use crate::lane::Lane;
use crate::relative::Reduced;

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
