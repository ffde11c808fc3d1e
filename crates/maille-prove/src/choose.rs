//! What refutes a box, if anything does: candidates for inequalities, and weights with which they contradict each other.

use crate::{
    nearest::{Circle, least_overlap, minima, table},
    program::{Row, weights},
};
use maille_verify::proof::{Cell, Chosen, Form, Piece, Reason, Rings, plain};

/// Circles this much farther apart than they may be, in units of R, are no candidates for a touch.
const REACH: f64 = 0.3;
/// Chosen vectors are rounded to this part of their length.
const FINE: f64 = 1000.0;
/// The largest weight; the others are whole numbers of its parts.
const HEAVIEST: f64 = 1e6;

/// A cell with what its boxes need.
pub(crate) struct Chooser<'a> {
    cell: &'a Cell,
    table: Vec<(f64, f64)>,
}

fn rounded(x: &[f64; 3]) -> Chosen {
    x.map(|x| (x * FINE).round() as i32)
}

/// Inequalities that were evaluated, until one refutes the box alone.
struct Candidates<'a> {
    cell: &'a Cell,
    rings: &'a Rings,
    list: Vec<(Reason, Form)>,
}

impl Candidates<'_> {
    /// Whether this one refutes the box alone.
    fn try_out(&mut self, reason: Reason) -> bool {
        match self.cell.inequality(self.rings, &reason) {
            Some(form) if form.sup() < 0.0 => {
                self.list = vec![(reason, form)];
                true
            }
            // One that holds all over the box helps nobody.
            Some(form) if form.inf() < 0.0 => {
                self.list.push((reason, form));
                false
            }
            _ => false,
        }
    }
}

impl<'a> Chooser<'a> {
    pub(crate) fn new(cell: &'a Cell) -> Self {
        Chooser { cell, table: table() }
    }

    /// Inequalities with weights that refute the box, as the checker sees it.
    pub(crate) fn refutation(&self, piece: &Piece) -> Option<Vec<(Reason, u32)>> {
        let rings = Rings::of(piece);
        let mut candidates = Candidates { cell: self.cell, rings: &rings, list: Vec::new() };
        let terms = match self.collect(&mut candidates) {
            true => vec![(candidates.list[0].0, 1)],
            false if candidates.list.is_empty() => return None,
            false => combined(&candidates.list)?,
        };
        self.cell.refutes(&rings, &terms).then_some(terms)
    }

    /// Whether one of them refutes the box alone.
    fn collect(&self, out: &mut Candidates<'_>) -> bool {
        let (middle, radii) = (*out.rings.middle(), self.cell.radii());
        for (pair, of) in self.cell.pairs.iter().enumerate() {
            let w = self.cell.middle_between(out.rings, of);
            if of.sign.is_some() {
                let least = least_overlap(&middle, radii, &w);
                let apart = |n: &[f64; 3]| Reason::Apart { pair, along: rounded(n) };
                if out.try_out(Reason::Turn { pair })
                    || out.try_out(apart(&plain::unit(&w)))
                    || out.try_out(apart(&least))
                {
                    return true;
                }
                for ring in 0..2 {
                    let below = plain::dot(&w, &middle[ring]) < 0.0;
                    if out.try_out(Reason::Plane { pair, of: ring, below })
                        || out.try_out(Reason::Chord { pair, of: ring })
                    {
                        return true;
                    }
                }
            } else if of.rings[0] != of.rings[1] && out.try_out(Reason::Through { pair }) {
                return true;
            }
            let [a, b] = of.rings;
            let circles: [Circle; 2] = [([0.0; 3], middle[a], radii[a]), (w, middle[b], radii[b])];
            for [first, second] in minima(&circles[0], &circles[1], &self.table, of.touching + REACH) {
                if out.try_out(Reason::Touch { pair, first: rounded(&first), second: rounded(&second) }) {
                    return true;
                }
            }
        }
        false
    }
}

/// Weights of the linear program, as whole numbers; none if its value is not negative.
fn combined(list: &[(Reason, Form)]) -> Option<Vec<(Reason, u32)>> {
    let size = |form: &Form| form.c.abs() + form.r + form.b.iter().map(|b| b.abs()).sum::<f64>();
    let scales: Vec<f64> = list.iter().map(|(_, form)| 1.0 / size(form)).collect();
    let row = |((_, form), scale): (&(Reason, Form), &f64)| Row {
        c: (form.c + form.r) * scale,
        b: form.b.map(|b| b * scale),
    };
    let rows: Vec<Row> = list.iter().zip(&scales).map(row).collect();
    let (value, mut weights) = weights(&rows);
    if value >= 0.0 || value.is_nan() {
        return None;
    }
    weights.iter_mut().zip(&scales).for_each(|(weight, scale)| *weight *= scale);
    let heaviest = weights.iter().copied().fold(0.0, f64::max);
    let whole = |weight: f64| (weight / heaviest * HEAVIEST).round() as u32;
    Some(
        list.iter()
            .zip(&weights)
            .map(|((reason, _), weight)| (*reason, whole(*weight)))
            .filter(|(_, w)| *w > 0)
            .collect(),
    )
}
