//! Proven bounds of a design's limits, and their derivatives by the radii of its rings.
//!
//! A bound costs a small part of a limit and is often attained, so a fit looks for starts among designs whose bounds are what is wanted.
//! With the unit pull of the bound's forces y, dl1 = Σ |y_k| dL_k over its ties (`bound`); one chain of length d along the lattice vector v has
//! (1 + l1)² (v·D)² = d² − (1 + l2)² (v·D⊥)², so dl1/dd = d/((1 + l1) (v·D)²).

use crate::{
    bound::{Bound, ChainBound, DualForce, LinkBound, TieKind, best_bound, lowered},
    lattice::{Across, Direction},
    model::Model,
    sensitivity::{DesignVector, is_link},
};
use maille_design::Design;

/// A model with the radii of another design of its family: enough for bounds.
pub(super) fn with_radii(model: &Model, design: &Design) -> Model {
    let mut out = model.clone();
    let sizes = design.elements.iter().flat_map(|element| &element.rings);
    for (ring, size) in out.rings.iter_mut().zip(sizes) {
        ring.major_radius = size.major_radius / model.unit;
        ring.minor_radius = size.minor_radius.or(design.minor_radius).unwrap_or(f64::NAN) / model.unit;
    }
    out
}

/// The bounds of one design.
pub(super) struct Bounds<'a> {
    model: &'a Model,
    chain: ChainBound,
    link: LinkBound,
}

impl<'a> Bounds<'a> {
    /// Of the design of `model`, which is in the design's own cell.
    pub fn new(model: &'a Model) -> Self {
        let chain = ChainBound::new(model);
        let link = LinkBound::new(model, &chain);
        Bounds { model, chain, link }
    }

    /// Of l1 along a direction, by links.
    pub fn by_links(&self, direction: Direction, l2: f64) -> Bound {
        best_bound(&self.chain, Some(&self.link), direction, l2)
    }

    /// The same by chains alone.
    pub fn by_chains(&self, direction: Direction, l2: f64) -> Bound {
        self.chain.limit(direction, l2)
    }

    /// The same by links and by the normals of the rings.
    pub fn by_normals(&self, direction: Direction, l2: f64) -> Bound {
        lowered(self.by_links(direction, l2), &self.link, direction, l2, Across::HELD)
    }

    /// The derivatives of a bound by the radii of the rings, in the design's unit; what other numbers of the design do is left out.
    pub fn slopes(&self, bound: &Bound, direction: Direction) -> DesignVector {
        let mut out = DesignVector::zeros(self.model.rings.len());
        match (bound.l1(), bound.chain()) {
            (Some(_), _) if !bound.dual().is_empty() => bound.dual().iter().for_each(|tie| self.add_tie(&mut out, tie)),
            (Some(l1), Some(chain)) => {
                let pulled = self.model.start.translation(chain.vector).xy().dot(&direction.along());
                let share = chain.length / ((1.0 + l1) * pulled * pulled);
                chain.rings.windows(2).filter(|ends| is_link(self.model, ends)).for_each(|ends| {
                    self.add_link(&mut out, [ends[0].0, ends[1].0], share);
                });
            }
            _ => {}
        }
        out
    }

    /// L = R_a + R_b − r_a − r_b.
    fn add_link(&self, out: &mut DesignVector, rings: [usize; 2], share: f64) {
        for ring in rings {
            out.rings[ring].major_radius += share / self.model.unit;
            out.rings[ring].minor_radius -= share / self.model.unit;
        }
    }

    fn add_tie(&self, out: &mut DesignVector, tie: &DualForce) {
        let share = tie.force.norm();
        let rings: Vec<usize> = tie.rings.iter().map(|(ring, _)| *ring).collect();
        match (tie.kind, rings.as_slice()) {
            (TieKind::Link, &[a, b]) => self.add_link(out, [a, b], share),
            (TieKind::StrandPair, &[a, a2, b]) => self.add_strands(out, [a, a2], b, share),
            // Crossing pairs are for rings of one size: they have no derivative by a single radius.
            _ => {}
        }
    }

    /// L = √(ρ²/2 + ρ'²/2 − (r_a + r_a')²/4) + (R_a + R_a')/2 with ρ = R_b − r_b − r_a and ρ' alike.
    fn add_strands(&self, out: &mut DesignVector, strands: [usize; 2], b: usize, share: f64) {
        let share = share / self.model.unit;
        let rho = strands.map(|a| self.model.rings[b].major_radius - self.model.contact_distance(a, b));
        let apart = self.model.contact_distance(strands[0], strands[1]);
        let root = (0.5 * (rho[0] * rho[0] + rho[1] * rho[1]) - 0.25 * apart * apart).max(0.0).sqrt();
        let by_rho = rho.map(|rho| if root > 0.0 { 0.5 * rho / root } else { 0.0 });
        let by_apart = if root > 0.0 { -0.25 * apart / root } else { 0.0 };
        out.rings[b].major_radius += share * (by_rho[0] + by_rho[1]);
        out.rings[b].minor_radius -= share * (by_rho[0] + by_rho[1]);
        for (a, by_rho) in strands.into_iter().zip(by_rho) {
            out.rings[a].major_radius += 0.5 * share;
            out.rings[a].minor_radius += share * (by_apart - by_rho);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bound::{BoundKind, LinkSolution},
        lattice::Cell,
    };
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    /// Against differences to both sides, at random radii: by chains, links and strand pairs, with elements of one ring and of several.
    #[test]
    fn slopes_of_bounds_are_their_derivatives() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut kinds = Vec::new();
        for name in ["1.1", "3.1", "4.2", "5.1", "5.2", "european-4-in-1", "european-6-in-1", "japanese-8-in-2"] {
            let built_in = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap();
            let design: Design = serde_json::from_str(&serde_json::to_string(&built_in).unwrap()).unwrap();
            let mut model = Model::compile(&design, Cell::PRIMITIVE).unwrap();
            model.rings.iter_mut().for_each(|ring| ring.major_radius *= random.random_range(0.97..1.03));
            model.rings.iter_mut().for_each(|ring| ring.minor_radius *= random.random_range(0.8..1.0));
            for (direction_deg, l2) in [(10.0, 0.0), (33.0, -0.05), (75.0, 0.02)] {
                let direction = Direction::of_degrees(direction_deg);
                for by_links in [false, true] {
                    let label = format!("{name} {direction_deg}\u{b0} {by_links}");
                    kinds.extend(compare(&model, direction, l2, by_links, &label));
                }
            }
        }
        assert!([TieKind::Link, TieKind::StrandPair].iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
    }

    /// The bound by all links at once, also where one chain alone gives it, or that by chains.
    fn bound(model: &Model, direction: Direction, l2: f64, by_links: bool) -> (Bounds<'_>, Bound) {
        let bounds = Bounds::new(model);
        let bound = match by_links {
            false => bounds.by_chains(direction, l2),
            true => {
                let LinkSolution { l1, dual, .. } = bounds.link.limit(direction, l2);
                Bound::Finite { l1, kind: BoundKind::Link, chain: None, dual }
            }
        };
        (bounds, bound)
    }

    /// The kinds of ties of the bound, when its derivatives are compared.
    fn compare(model: &Model, direction: Direction, l2: f64, by_links: bool, label: &str) -> Vec<TieKind> {
        let (bounds, here) = bound(model, direction, l2, by_links);
        let slopes = bounds.slopes(&here, direction);
        for ring in 0..model.rings.len() {
            let beside = |major: f64, minor: f64| {
                let mut beside = model.clone();
                beside.rings[ring].major_radius += major;
                beside.rings[ring].minor_radius += minor;
                bound(&beside, direction, l2, by_links).1.l1().unwrap()
            };
            let h = 1e-5;
            // At a kink, forces that are not the only ones give a value between both sides.
            let at = beside(0.0, 0.0);
            let sides = [[beside(h, 0.0) - at, at - beside(-h, 0.0)], [beside(0.0, h) - at, at - beside(0.0, -h)]];
            let own = [slopes.rings[ring].major_radius, slopes.rings[ring].minor_radius];
            for ([ahead, back], own) in
                sides.map(|both| both.map(|x| x / h)).into_iter().zip(own.map(|x| x * model.unit))
            {
                let within = ahead.min(back) - 1e-3..ahead.max(back) + 1e-3;
                assert!(within.contains(&own), "{label} ring {ring}: {own} beside {ahead} and {back}");
            }
        }
        here.dual().iter().filter(|tie| tie.force.norm() > 0.1).map(|tie| tie.kind).collect()
    }
}
