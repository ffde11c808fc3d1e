//! `sensitivities.csv`: the derivatives of each certified limit by the wire and by the spacing are sums over its forces.
//!
//! A wire of radius r + dr closes the gap of a contact by dr for each of its two rings that has no r of its own. So with the forces
//! μ of a state dl1/dr = −Σ μ n / R, n such rings at the contact and R the reference radius; a least l1 has the opposite sign. Where
//! other forces balance, too, the forward derivative is at most this and the backward one at least (of a least l1 the other way round).
//!
//! The spacing s multiplies the lattice vectors a of the design, and the elements' centres follow. Ring B of a contact stands
//! w = w1 a1 + w2 a2 of the design further than ring A, so that its gap widens by n·F w ds, n the unit vector from A to B and F the
//! deformation gradient, and dl1/ds = Σ μ n·F w / R. Derivatives by other numbers are not derived anew.

use crate::{
    files::key,
    record::{Design, Row, SENSITIVITIES as FILE, State},
    report::{Check, Finding, Verdict},
    sheet,
};
use std::collections::{BTreeMap, BTreeSet};

const HEADER: &str = "direction_deg,l2,number,derivative,derivative_back";
const WIRE: &str = "minor_radius";
const SPACING: &str = "spacing";
/// How far a derivative may be from the sum of the forces, relative to it or to 1e-3: forces below 1e-9 are not recorded.
const SAME: f64 = 1e-6;

/// All findings on the table.
pub(crate) fn check(text: &str, design: &Design, rows: &[Row], states: &[State]) -> Vec<Finding> {
    let say = |verdict, words: String| Finding::new(Check::Files, verdict, None, words);
    let states: BTreeMap<_, _> = states.iter().map(|s| (key(s.direction_deg, s.l2), s)).collect();
    let rows: BTreeMap<_, _> =
        rows.iter().filter(|row| row.certified()).map(|row| (key(row.direction_deg, row.l2), row)).collect();
    let mut lines = text.lines();
    if lines.next() != Some(HEADER) {
        return vec![say(Verdict::False, format!("{FILE}:1: the header is not {HEADER}"))];
    }
    let (mut wrong, mut there, mut seen) = (Vec::new(), BTreeSet::new(), BTreeSet::new());
    let (mut proved, mut others, mut empty) = (0, 0, 0);
    for (k, line) in lines.enumerate() {
        let at = format!("{FILE}:{}", k + 2);
        let Some((direction_deg, l2, number, sides)) = cells(line) else {
            wrong.push(format!("{at}: no row of {HEADER}"));
            continue;
        };
        let of = key(direction_deg, l2);
        if !seen.insert((of, number.clone())) {
            wrong.push(format!("{at}: {direction_deg}°, l2 = {l2} has {number} a second time"));
        }
        there.insert(of);
        let (Some(row), Some(state)) = (rows.get(&of), states.get(&of)) else {
            wrong.push(format!("{at}: {direction_deg}°, l2 = {l2} is no certified limit of the record"));
            continue;
        };
        let sum = match number.as_str() {
            WIRE => by_wire(design, row, state),
            SPACING => by_spacing(design, row, state),
            _ => {
                others += 1;
                continue;
            }
        };
        match sides {
            [Some(forward), Some(back)] => match sum {
                Some(sum) if between(sum, [forward, back], least(row)) => proved += 1,
                Some(sum) => wrong.push(format!(
                    "{at}: {forward} forward and {back} back by {number}, where the forces at {direction_deg}°, l2 = {l2} sum up to {sum}"
                )),
                None => wrong.push(format!("{at}: a contact of {direction_deg}°, l2 = {l2} is between rings that are not there")),
            },
            _ => empty += 1,
        }
    }
    let count = wrong.len();
    wrong.truncate(5);
    let mut out: Vec<Finding> = wrong.into_iter().map(|words| say(Verdict::False, words)).collect();
    if count > out.len() {
        out.push(say(Verdict::False, format!("{} more of this kind in {FILE}", count - out.len())));
    }
    if count == 0 && proved > 0 {
        out.push(say(
            Verdict::Proved,
            format!("{proved} derivatives by {WIRE} and {SPACING} in {FILE} are those of the forces"),
        ));
    }
    if others + empty > 0 {
        let words = format!("{} other derivatives in {FILE} are not derived anew", others + empty);
        out.push(say(Verdict::Consistent, words));
    }
    let missing = rows.keys().filter(|of| !there.contains(of)).count();
    if missing > 0 {
        let words =
            format!("{missing} certified limits have no derivatives in {FILE}: a run was stopped before it wrote them");
        out.push(say(Verdict::Open, words));
    }
    out
}

fn least(row: &Row) -> bool {
    row.end.as_deref() == Some("least")
}

/// Direction, l2, number, and the derivatives forward and back.
fn cells(line: &str) -> Option<(f64, f64, String, [Option<f64>; 2])> {
    let cells: Vec<&str> = line.split(',').collect();
    let [direction, l2, number, forward, back] = cells[..] else { return None };
    let finite = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
    let side = |text: &str| if text.is_empty() { Some(None) } else { finite(text).map(Some) };
    Some((finite(direction)?, finite(l2)?, number.to_owned(), [side(forward)?, side(back)?]))
}

/// Whether the sum of forces is at least the forward derivative and at most the backward one; of a least l1 the other way round.
fn between(sum: f64, [forward, back]: [f64; 2], least: bool) -> bool {
    let off = SAME * sum.abs().max(1e-3);
    let [low, high] = if least { [back, forward] } else { [forward, back] };
    low <= sum + off && sum <= high + off
}

/// −Σ μ n / R, or Σ μ n / R of a least l1; `None` where a contact names a ring that is not there.
fn by_wire(design: &Design, row: &Row, state: &State) -> Option<f64> {
    // A copy in a larger cell has the name of its element, then @ and its cell.
    let rings = |name: &str| {
        let own = |full: &&crate::record::Element| full.name == name;
        let copied = |full: &&crate::record::Element| name.rsplit_once('@').is_some_and(|(base, _)| full.name == base);
        design.elements.iter().find(own).or_else(|| design.elements.iter().find(copied)).map(|element| &element.rings)
    };
    let mut common = Vec::new();
    for pose in &state.poses {
        common.extend(rings(&pose.element)?.iter().map(|ring| ring.minor_radius.is_none()));
    }
    let mut sum = 0.0;
    for contact in &state.contacts {
        let shared = [*common.get(contact.ring_a)?, *common.get(contact.ring_b)?];
        sum += contact.force * shared.iter().filter(|common| **common).count() as f64;
    }
    let sign = if least(row) { 1.0 } else { -1.0 };
    Some(sign * sum / design.reference_radius)
}

/// Σ μ n·F w / R, or −Σ μ n·F w / R of a least l1; `None` where a contact names a ring that is not there, or the cell is none.
fn by_spacing(design: &Design, row: &Row, state: &State) -> Option<f64> {
    let cell = sheet::cell(&row.cell)?;
    let mut copies = Vec::new();
    for pose in &state.poses {
        let (element, copy) = sheet::named(design, &cell, &pose.element).ok()?;
        copies.extend(design.elements[element].rings.iter().map(|_| copy));
    }
    let here = sheet::of_design(&cell, [state.a1, state.a2].map(sheet::Vec3::from));
    let mut sum = 0.0;
    for contact in &state.contacts {
        let [from, to] = [*copies.get(contact.ring_a)?, *copies.get(contact.ring_b)?];
        let apart = |j: usize| to[j] - from[j] + (0..2).map(|k| contact.shift[k] * cell[k][j]).sum::<i32>();
        let between = here[0] * f64::from(apart(0)) + here[1] * f64::from(apart(1));
        sum += contact.force * sheet::Vec3::from(contact.normal).dot(&between);
    }
    let sign = if least(row) { -1.0 } else { 1.0 };
    Some(sign * sum / design.reference_radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_lies_between_both_sides_but_for_rounding() {
        assert!(between(-2.0, [-2.0 + 1e-9, -2.0], false) && between(-2.0, [-3.0, -1.0], false));
        assert!(!between(-2.0, [-1.0, -3.0], false) && between(-2.0, [-1.0, -3.0], true));
        assert!(!between(-2.0, [-2.1, -2.1], false) && !between(0.0, [1e-6, 1e-6], true));
    }

    #[test]
    fn a_row_is_read_cell_by_cell() {
        assert_eq!(cells("30.0,-0.05,spacing,-1.5,"), Some((30.0, -0.05, "spacing".into(), [Some(-1.5), None])));
        for line in ["30.0,-0.05,spacing,-1.5", "x,0.0,spacing,1.0,1.0", "0.0,0.0,spacing,inf,1.0"] {
            assert_eq!(cells(line), None, "{line}");
        }
    }
}
