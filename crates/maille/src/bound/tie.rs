//! Ties: inequalities |Σ_m w_m (c_m + Q_m o_m + F s_m)| ≤ L, Σ_m w_m = 0, that every state of the sheet obeys.
//!
//! - A **link** of rings a, b: w = (1, −1), L = R_a + R_b − r_a − r_b (lemma of [`crate::bound`]). Of curves that are no circles R is the
//!   radius of a ball that holds the core; they are in no other tie.
//! - A **strand pair**: rings a, a' of different elements, both linked with b. They cross b's disc at points p, p' with
//!   |p − c_b| ≤ ρ = R_b − r_b − r_a, |p' − c_b| ≤ ρ' alike, and |p − p'| ≥ r_a + r_a', since tori do not overlap. For
//!   m = (p + p')/2: |m − c_b|² = |p − c_b|²/2 + |p' − c_b|²/2 − |p − p'|²/4. As |c_a − p| ≤ R_a, this gives
//!   w = (½, ½, −1) for (a, a', b) and L = √(ρ²/2 + ρ'²/2 − (r_a + r_a')²/4) + (R_a + R_a')/2: less than the mean of
//!   both links, because two strands do not fit in one place.
//! - **Crossing pairs**: rings a, a' and b, b' of one size, each of a, a' linked with each of b, b', no other two linked:
//!   w = (½, ½, −½, −½) and [`crossing_pairs_length`], the theorem of this file. It matters in doubled weaves (5.1, 5.2).

use crate::{lattice::Shift, model::Model};
use maille_geometry::Vec3;
use std::collections::BTreeSet;

/// A ring in a tie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    pub(super) element: usize,
    pub(super) weight: f64,
    /// Offset in the element.
    pub(super) offset: Vec3,
}

/// What a tie is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieKind {
    /// Two linked rings.
    Link,
    /// Two rings a, a' that are linked with b.
    StrandPair,
    /// Rings a, a' that are each linked with b and b'.
    CrossingPairs,
    /// A chain of links from a ring to its image.
    Chain,
}

impl TieKind {
    /// The name in records.
    pub(crate) fn name(self) -> &'static str {
        match self {
            TieKind::Link => "link",
            TieKind::StrandPair => "strand-pair",
            TieKind::CrossingPairs => "crossing-pairs",
            TieKind::Chain => "chain",
        }
    }
}

/// |Σ w (c + Q o + F s)| ≤ length.
#[derive(Clone, Debug)]
pub(super) struct Tie {
    pub(super) kind: TieKind,
    /// Its rings: a, b; a, a', b; a, a', b, b'; or those along a chain.
    pub(super) rings: Vec<Place>,
    pub(super) terms: Vec<Term>,
    /// S = Σ w s in the reference lattice.
    pub(super) span: Vec3,
    pub(super) length: f64,
}

impl Tie {
    pub(super) fn is_link(&self) -> bool {
        self.kind == TieKind::Link
    }
}

/// A ring of the sheet: index in the model and cell.
pub(super) type Place = (usize, Shift);

/// All ties of a model: its links first, in their order.
pub(super) fn all(model: &Model) -> Vec<Tie> {
    let sheet = Sheet::new(model);
    let mut ties: Vec<Tie> = model
        .links
        .iter()
        .map(|link| {
            let (a, b) = (link.pair.ring_a, link.pair.ring_b);
            let length = model.rings[a].major_radius + model.rings[b].major_radius - model.contact_distance(a, b);
            sheet.tie(TieKind::Link, &[((a, [0, 0]), 1.0), ((b, link.pair.shift), -1.0)], length)
        })
        .collect();
    ties.extend(sheet.strand_pairs());
    ties.extend(sheet.crossing_pairs());
    ties
}

/// A model with the links of each of its rings.
struct Sheet<'a> {
    model: &'a Model,
    /// For each ring of cell (0, 0) the rings linked with it.
    through: Vec<Vec<Place>>,
}

impl<'a> Sheet<'a> {
    fn new(model: &'a Model) -> Self {
        let mut through = vec![Vec::new(); model.rings.len()];
        for pair in model.links.iter().flat_map(|link| link.pair.both_ways()) {
            through[pair.ring_a].push((pair.ring_b, pair.shift));
        }
        Sheet { model, through }
    }

    fn tie(&self, kind: TieKind, weighted: &[(Place, f64)], length: f64) -> Tie {
        let term = |&((ring, _), weight): &(Place, f64)| {
            let ring = &self.model.rings[ring];
            Term { element: ring.element, weight, offset: ring.offset }
        };
        Tie {
            kind,
            rings: weighted.iter().map(|(place, _)| *place).collect(),
            terms: weighted.iter().map(term).collect(),
            span: weighted.iter().map(|((_, shift), weight)| *weight * self.model.start.translation(*shift)).sum(),
            length,
        }
    }

    fn linked(&self, a: Place, b: Place) -> bool {
        self.through[a.0].contains(&(b.0, [b.1[0] - a.1[0], b.1[1] - a.1[1]]))
    }

    /// Whether two rings are of different bodies and lie near each other at the start. Strands that lie far apart do not
    /// compete for a place; leaving them out is no error.
    fn beside(&self, first: Place, second: Place) -> bool {
        let [r1, r2] = [first, second].map(|(ring, _)| &self.model.rings[ring]);
        let [x1, x2] = [first, second].map(|(ring, shift)| self.model.start.circle(self.model, ring, shift));
        (r1.element, first.1) != (r2.element, second.1)
            && (x1.center - x2.center).norm() <= 0.5 * (r1.major_radius + r2.major_radius)
    }

    /// Pairs of rings beside each other that are linked with ring b of cell (0, 0). All are circles: the proofs speak of discs.
    fn strands(&self, b: usize) -> Vec<[Place; 2]> {
        let round = |place: &Place| self.model.rings[place.0].is_round();
        let strands: Vec<Place> = match self.model.rings[b].is_round() {
            true => self.through[b].iter().copied().filter(round).collect(),
            false => Vec::new(),
        };
        let strands = &strands;
        let pairs = (0..strands.len()).flat_map(|k| strands[..k].iter().map(move |&second| [strands[k], second]));
        pairs.filter(|&[first, second]| self.beside(first, second)).collect()
    }

    fn strand_pairs(&self) -> Vec<Tie> {
        let mut out = Vec::new();
        for (b, ring) in self.model.rings.iter().enumerate() {
            for [first, second] in self.strands(b) {
                let rho = [first.0, second.0].map(|a| ring.major_radius - self.model.contact_distance(a, b));
                let apart = self.model.contact_distance(first.0, second.0);
                let middle_sq = 0.5 * (rho[0] * rho[0] + rho[1] * rho[1]) - 0.25 * apart * apart;
                let mean = 0.5 * (self.model.rings[first.0].major_radius + self.model.rings[second.0].major_radius);
                let weighted = [(first, 0.5), (second, 0.5), ((b, [0, 0]), -1.0)];
                out.push(self.tie(TieKind::StrandPair, &weighted, middle_sq.max(0.0).sqrt() + mean));
            }
        }
        out
    }

    fn crossing_pairs(&self) -> Vec<Tie> {
        let mut found = BTreeSet::new();
        for b in 0..self.model.rings.len() {
            let b = (b, [0, 0]);
            for [first, second] in self.strands(b.0) {
                for &(ring, [p, q]) in &self.through[first.0] {
                    let other = (ring, [p + first.1[0], q + first.1[1]]);
                    let crossed =
                        self.model.rings[ring].is_round() && self.linked(second, other) && self.beside(b, other);
                    if crossed && !self.linked(b, other) && !self.linked(first, second) {
                        found.insert(canonical([[first, second], [b, other]]));
                    }
                }
            }
        }
        let tie = |pairs: [[Place; 2]; 2]| {
            let [[a, a2], [b, b2]] = pairs;
            let sizes = [a, a2, b, b2].map(|(ring, _)| {
                let ring = &self.model.rings[ring];
                (ring.major_radius, ring.minor_radius)
            });
            let same = sizes.iter().all(|size| *size == sizes[0]);
            let length = crossing_pairs_length(sizes[0].0, sizes[0].1)?;
            let weighted = [(a, 0.5), (a2, 0.5), (b, -0.5), (b2, -0.5)];
            same.then(|| self.tie(TieKind::CrossingPairs, &weighted, length))
        };
        found.into_iter().filter_map(tie).collect()
    }
}

/// One name for two pairs and all their images, whichever pair and ring comes first.
fn canonical(pairs: [[Place; 2]; 2]) -> [[Place; 2]; 2] {
    let from = |origin: Shift| {
        let mut moved = pairs.map(|pair| {
            let mut pair = pair.map(|(ring, [p, q])| (ring, [p - origin[0], q - origin[1]]));
            pair.sort_unstable();
            pair
        });
        moved.sort_unstable();
        moved
    };
    let [[a, a2], [b, b2]] = pairs;
    let first = from(a.1);
    [a2, b, b2].into_iter().map(|place| from(place.1)).fold(first, Ord::min)
}

/// Largest minor radius in major radii for which the theorem below is proved.
const THICKEST: f64 = 1.0 / 7.0;

/// Upper bound L of |½(c_a + c_a') − ½(c_b + c_b')| for crossing pairs of rings of one size; `None` for r/R > 1/7.
///
/// With R = 1 and tan φ = r (1 + 2 sin φ):
///
/// L = (2 cos φ − 2r − 2r sin φ)/√(1 − 2 sin² φ).
///
/// It is reached where a lies flat on a', b on b', and the pairs stand across each other, all four contacts at the
/// angle φ from the line of centres. Proof: `docs/theory/bounds.md`, "Crossing pairs".
pub fn crossing_pairs_length(major_radius: f64, minor_radius: f64) -> Option<f64> {
    let r = minor_radius / major_radius;
    if !(r > 0.0 && r <= THICKEST) {
        return None;
    }
    // The step shrinks to less than a third each time: 2r cos φ cos² φ < 2/7.
    let mut angle_rad = 0.0_f64;
    for _ in 0..32 {
        angle_rad = (r * (1.0 + 2.0 * angle_rad.sin())).atan();
    }
    let (sin, cos) = angle_rad.sin_cos();
    Some(major_radius * (2.0 * cos - 2.0 * r - 2.0 * r * sin) / (1.0 - 2.0 * sin * sin).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    #[test]
    fn closed_form_is_the_least_of_its_family() {
        for (r, length) in [(0.1, 1.787463044), (0.05, 1.897220314)] {
            let found = crossing_pairs_length(1.0, r).unwrap();
            assert!((found - length).abs() < 1e-9, "{found}");
            assert!((crossing_pairs_length(2.5, 2.5 * r).unwrap() - 2.5 * found).abs() < 1e-13);
            for k in 1..400 {
                let sin: f64 = f64::from(k) * 1e-3;
                let member = (2.0 * (1.0 - sin * sin).sqrt() - 2.0 * r * (1.0 + sin)) / (1.0 - 2.0 * sin * sin).sqrt();
                assert!(member >= found - 1e-12, "{sin}: {member} < {found}");
            }
        }
        assert!(crossing_pairs_length(1.0, 0.143).is_none());
        assert!(crossing_pairs_length(1.0, f64::NAN).is_none());
    }

    /// What the proof multiplies the links of a pair with, in a frame with z along the line of centres.
    struct Weighted {
        normal: [Vec3; 2],
        weight: [f64; 2],
        along: Vec3,
        /// Difference of the centres, as small as the matched points allow.
        apart: Vec3,
    }

    /// A pair in the frame of the proof: leaning by β, twisted by ω, shifted aside by θ and up by δ_z, its bisector at
    /// `turn_rad` from x. The choice of u and μ is the proof's.
    fn pair(r: f64, sin: f64, beta: [f64; 2], omega: f64, theta: f64, up: f64, turn_rad: f64) -> Weighted {
        let bisector = Vec3::new(turn_rad.cos(), turn_rad.sin(), 0.0);
        let aside = Vec3::new(-turn_rad.sin(), turn_rad.cos(), 0.0);
        let side = [1.0, -1.0];
        let normal: [Vec3; 2] = std::array::from_fn(|i| {
            let flat = omega.cos() * bisector + side[i] * omega.sin() * aside;
            beta[i].cos() * flat + Vec3::z() * (side[i] * beta[i].sin())
        });
        let (sum, difference) = (beta[0].sin() + beta[1].sin(), beta[0].sin() - beta[1].sin());
        let held = |theta: f64| {
            let height = up + theta.cos() * (beta[0].cos() - beta[1].cos());
            (4.0 * r * r - height * height).sqrt() + omega.cos() * theta.cos() * sum
        };
        let shift = omega.sin() * theta.cos() * difference - 2.0 * omega.cos() * theta.sin();
        let (p, q) = (2.0 * omega.cos(), omega.sin() * difference);
        let lower = std::f64::consts::PI - (-shift / p.hypot(q)).asin() + q.atan2(p);
        let lower_shift = q * lower.cos() - p * lower.sin();
        assert!((lower_shift - shift).abs() < 1e-9);
        let width = held(theta).max(held(lower));
        let flat = width * bisector + shift * aside;
        let apart = flat + up * Vec3::z();
        let far = 2.0 * r + sin / (1.0 - sin * sin).sqrt() + 18.0 * r * sin.powi(3);
        if flat.norm() >= far {
            return Weighted { normal, weight: [1.0; 2], along: flat.normalize(), apart };
        }
        let turned = |theta: f64| -theta.sin().asin();
        let lean = |xi: f64| (0..2).map(|i| beta[i].sin() * (xi - side[i] * omega).cos()).sum::<f64>();
        let upper = lean(turned(theta));
        let xi = if (-3.3 * sin.powi(3)..0.0).contains(&upper) { turned(lower) } else { turned(theta) };
        let mu = -2.0 * up;
        Weighted { normal, weight: [1.0 + mu, 1.0 - mu], along: xi.cos() * bisector + xi.sin() * aside, apart }
    }

    /// The whole sum of the proof, without its estimates, on random pairs at several scales: no distance above L.
    #[test]
    fn crossing_pairs_inequality() {
        let mut rng = ChaCha8Rng::seed_from_u64(0x5ead);
        for r in [0.01, 0.05, 0.1, 0.125, THICKEST] {
            let length = crossing_pairs_length(1.0, r).unwrap();
            // L = (2ρ − 2r − 2rα)/γ, tan φ = r (1 + 2α) has α = sin φ.
            let mut sin = r;
            for _ in 0..64 {
                sin = (r * (1.0 + 2.0 * sin)).atan().sin();
            }
            let gamma = (1.0 - 2.0 * sin * sin).sqrt();
            let eta = 2.0 - 2.0 * r - length;
            let mut most = f64::NEG_INFINITY;
            for k in 0..40_000 {
                let scale = 10f64.powf(-0.6 * f64::from(k % 6));
                let mut random = |most: f64| rng.random_range(-1.0..1.0) * most * scale;
                let turn_rad = std::f64::consts::FRAC_PI_2 + random(std::f64::consts::FRAC_PI_2);
                let mut sample = |turn_rad: f64| {
                    let mut beta = [random(2.0 * eta.sqrt()), random(2.0 * eta.sqrt())];
                    let size = beta[0].hypot(beta[1]) / (2.0 * eta.sqrt());
                    beta.iter_mut().for_each(|b| *b /= size.max(1.0));
                    pair(r, sin, beta, random(0.465).abs(), random(1.75 * r), random(2.0 * eta), turn_rad)
                };
                let a = sample(0.0);
                let b = sample(turn_rad);
                let mut total = -2.0 * sin * (a.along.dot(&a.apart) + b.along.dot(&b.apart));
                for (weight, up) in [(a.weight, a.apart.z), (b.weight, b.apart.z)] {
                    total += gamma * (weight[0] - weight[1]) * up;
                }
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (s_i, s_j) = (1.0 - 2.0 * i as f64, 1.0 - 2.0 * j as f64);
                    let normal =
                        gamma * Vec3::z() - s_i * sin / a.weight[i] * a.along + s_j * sin / b.weight[j] * b.along;
                    // B is described with z reversed.
                    let across = Vec3::new(b.normal[j].x, b.normal[j].y, -b.normal[j].z);
                    let width = |n: Vec3| (normal.norm_squared() - normal.dot(&n).powi(2)).sqrt();
                    total += a.weight[i] * b.weight[j] * (width(a.normal[i]) + width(across) - 2.0 * r * normal.norm());
                }
                most = most.max(total / (4.0 * gamma) - length);
            }
            assert!(most <= 1e-13, "r = {r}: {most}");
        }
    }
}
