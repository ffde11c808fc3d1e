//! Ties: inequalities |Σ w (c + Q o + F s)| ≤ L, Σ w = 0, that every state with the links of the start obeys, if no rings overlap.
//!
//! c is the centre of a ring's element, Q its turn, o the ring's place in it, s the translation of its cell in the start.
//!
//! - **link** of a, b: w = (1, −1), L = R_a + R_b − r_a − r_b. Circle a passes the disc of b at a point p, r_a + r_b or more from circle b.
//! - **strand pair**: a, a′ of different bodies, both linked with b, w = (½, ½, −1). Their points p, p′ in the disc of b are at most ϱ = R_b −
//!   r_b − r_a and ϱ′ alike from c_b, and at least r_a + r_a′ apart. By the parallelogram law L = √(ϱ²/2 + ϱ′²/2 − (r_a + r_a′)²/4) + (R_a + R_a′)/2.
//! - **crossing pairs**: a, a′ and b, b′ of one size with r/R ≤ 1/7, each of the first two linked with each of the others, a not with a′, b not
//!   with b′: w = (½, ½, −½, −½). L is the least of (2ρ − 2r − 2rα)/√(1 − 2α²), ρ = √(1 − α²), over 0 ≤ α < 1/√2, in units of R: the theorem
//!   of `docs/theory/bounds.md`.
//! - **chain**: a walk of links and of rigid edges from a ring to its image at v: |F v| ≤ L, its length.

use crate::sheet::{Pair, Ring, Sheet, Vec3};

/// Largest minor radius in major radii for which the theorem on crossing pairs is proved.
const THICKEST: f64 = 1.0 / 7.0;

/// A ring and its cell.
pub(crate) type Place = (usize, [i32; 2]);

/// The way from one cell to another, if it is a number.
pub(crate) fn between(from: [i32; 2], to: [i32; 2]) -> Option<[i32; 2]> {
    Some([to[0].checked_sub(from[0])?, to[1].checked_sub(from[1])?])
}

/// A tie, derived from the links of a start.
pub(crate) struct Tie {
    /// Whether it is of two linked rings.
    pub is_link: bool,
    /// Rings with their weights; none for a chain.
    pub terms: Vec<(usize, f64)>,
    /// S = Σ w s.
    pub span: Vec3,
    pub length: f64,
}

/// A start with its linked pairs.
#[derive(Clone, Copy)]
pub(crate) struct Linked<'a> {
    pub sheet: &'a Sheet,
    pub links: &'a [(Pair, i32)],
}

impl<'a> Linked<'a> {
    /// Whether two rings are linked.
    pub fn linked(&self, a: Place, b: Place) -> bool {
        let same = |(x, y, shift): &Pair| {
            (*x, *y, Some(*shift)) == (a.0, b.0, between(a.1, b.1))
                || (*x, *y, Some(*shift)) == (b.0, a.0, between(b.1, a.1))
        };
        self.links.iter().any(|(pair, _)| same(pair))
    }

    fn ring(&self, place: Place) -> Result<&'a Ring, String> {
        let rings = &self.sheet.rings;
        rings.get(place.0).ok_or_else(|| format!("a tie names ring {}, of {} rings", place.0, rings.len()))
    }

    /// The most that the centres of two linked rings can be apart.
    pub fn link(&self, a: Place, b: Place) -> Result<f64, String> {
        let (one, other) = (self.ring(a)?, self.ring(b)?);
        if self.linked(a, b) {
            Ok(one.radius + other.radius - one.wire - other.wire)
        } else {
            Err(format!("a tie joins rings {} at {:?} and {} at {:?}, which are not linked", a.0, a.1, b.0, b.1))
        }
    }

    /// The vector v and the length of a chain from a ring to its image.
    pub fn chain(&self, rings: &[Place]) -> Result<([i32; 2], f64), String> {
        let (Some(first), Some(last)) = (rings.first(), rings.last()) else {
            return Err("the chain is empty".into());
        };
        let Some(vector) = between(first.1, last.1).filter(|vector| first.0 == last.0 && *vector != [0, 0]) else {
            return Err("the chain does not lead from a ring to its image".into());
        };
        let mut length = 0.0;
        let count = self.sheet.rings.len();
        for pair in rings.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if a.0.max(b.0) >= count {
                return Err(format!("the chain names ring {}, of {count} rings", a.0.max(b.0)));
            }
            let (one, other) = (&self.sheet.rings[a.0], &self.sheet.rings[b.0]);
            length += if one.element == other.element && a.1 == b.1 {
                (one.arm - other.arm).norm()
            } else {
                self.link(a, b)?
            };
        }
        Ok((vector, length))
    }

    fn bodies_differ(&self, a: Place, b: Place) -> Result<(), String> {
        if (self.ring(a)?.element, a.1) == (self.ring(b)?.element, b.1) {
            return Err(format!("rings {} and {} of a tie are of one body", a.0, b.0));
        }
        Ok(())
    }

    /// The tie of this kind and these rings, or why there is none.
    pub fn tie(&self, kind: &str, rings: &[Place]) -> Result<Tie, String> {
        let (weights, length): (&[f64], f64) = match (kind, rings) {
            ("link", &[a, b]) => (&[1.0, -1.0], self.link(a, b)?),
            ("strand-pair", &[a, a2, b]) => (&[0.5, 0.5, -1.0], self.strand_pair(a, a2, b)?),
            ("crossing-pairs", &[a, a2, b, b2]) => (&[0.5, 0.5, -0.5, -0.5], self.crossing_pairs([a, a2], [b, b2])?),
            ("chain", _) => {
                let (vector, length) = self.chain(rings)?;
                return Ok(Tie { is_link: false, terms: Vec::new(), span: self.sheet.translation(vector), length });
            }
            _ => return Err(format!("\"{kind}\" of {} rings is no tie", rings.len())),
        };
        let span = rings.iter().zip(weights).map(|(place, w)| self.sheet.translation(place.1) * *w).sum();
        let terms = rings.iter().map(|place| place.0).zip(weights.iter().copied()).collect();
        Ok(Tie { is_link: kind == "link", terms, span, length })
    }

    /// What is said of discs is not said of other curves.
    fn all_round(&self, rings: &[Place]) -> Result<(), String> {
        for place in rings {
            if self.ring(*place)?.curve.is_some() {
                return Err(format!("ring {} of a tie is no circle", place.0));
            }
        }
        Ok(())
    }

    fn strand_pair(&self, a: Place, a2: Place, b: Place) -> Result<f64, String> {
        self.all_round(&[a, a2, b])?;
        self.link(a, b)?;
        self.link(a2, b)?;
        self.bodies_differ(a, a2)?;
        let (one, other, around) = (self.ring(a)?, self.ring(a2)?, self.ring(b)?);
        let [p, q] = [one, other].map(|strand| around.radius - around.wire - strand.wire);
        let apart = one.wire + other.wire;
        let middle_sq = (p * p + q * q) / 2.0 - apart * apart / 4.0;
        Ok(middle_sq.max(0.0).sqrt() + (one.radius + other.radius) / 2.0)
    }

    fn crossing_pairs(&self, [a, a2]: [Place; 2], [b, b2]: [Place; 2]) -> Result<f64, String> {
        self.all_round(&[a, a2, b, b2])?;
        for (x, y) in [(a, b), (a, b2), (a2, b), (a2, b2)] {
            self.link(x, y)?;
        }
        self.bodies_differ(a, a2)?;
        self.bodies_differ(b, b2)?;
        if self.linked(a, a2) || self.linked(b, b2) {
            return Err("two rings of one pair of crossing pairs are linked".into());
        }
        let first = self.ring(a)?;
        for place in [a2, b, b2] {
            let ring = self.ring(place)?;
            if (ring.radius, ring.wire) != (first.radius, first.wire) {
                return Err("crossing pairs of different sizes".into());
            }
        }
        let r = first.wire / first.radius;
        if r > THICKEST {
            return Err(format!("crossing pairs with r/R = {r}; the theorem ends at {THICKEST}"));
        }
        Ok(first.radius * crossing_pairs_length(r))
    }
}

/// The least value of the family, by golden section: every member is not below it, and near its place it is flat.
fn crossing_pairs_length(r: f64) -> f64 {
    let member = |alpha: f64| {
        (2.0 * (1.0 - alpha * alpha).sqrt() - 2.0 * r * (1.0 + alpha)) / (1.0 - 2.0 * alpha * alpha).sqrt()
    };
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.0, 0.3);
    for _ in 0..100 {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if member(left) < member(right) { high = right } else { low = left }
    }
    member(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_pairs_have_the_length_of_the_theorem() {
        // With tan φ = r (1 + 2 sin φ): (2 cos φ − 2r − 2r sin φ)/√(1 − 2 sin² φ).
        for r in [0.001, 0.02, 0.05, 0.1, 0.125, THICKEST] {
            let mut phi = 0.0_f64;
            for _ in 0..200 {
                phi = (r * (1.0 + 2.0 * phi.sin())).atan();
            }
            let (sin, cos) = phi.sin_cos();
            let closed = (2.0 * cos - 2.0 * r - 2.0 * r * sin) / (1.0 - 2.0 * sin * sin).sqrt();
            assert!((crossing_pairs_length(r) - closed).abs() < 1e-14, "{r}");
        }
    }
}
