//! What no design of a family reaches: bounds that hold for all of them.
//!
//! Links, strand pairs and chains bound states by inequalities |Σ w (c + Q o + F s)| ≤ L in which L grows with every major radius and falls
//! with every minor radius (`bound`). So a state of any design of a family whose free numbers are all radii obeys those of its
//! loosest design, with the largest R and the thinnest r, if both are linked alike; and a bound that follows from them holds for all.
//! Crossing pairs are for rings of one size, which the loosest design may have where others have not: what rests on them is not used.

use super::{bounds::Bounds, family::Family, search::Search, target::Measure};
use crate::{
    bound::{Bound, TieKind},
    lattice::{Cell, Direction},
    model::Model,
};

/// The bound on l1 of each target that holds for every design of the family, where one is known.
pub(super) fn family_bounds(search: &Search<'_>) -> Vec<Option<f64>> {
    let loosest = loosest(search.family).filter(|model| model.links == search.links);
    let bounds = loosest.as_ref().map(Bounds::new);
    let of = |measure: Measure| {
        let (Some(bounds), Measure::Stretch { direction_deg, l2 }) = (&bounds, measure) else { return None };
        let direction = Direction::of_degrees(direction_deg);
        let of_equal_rings = |bound: &Bound| bound.dual().iter().any(|force| force.kind == TieKind::CrossingPairs);
        let by_normals = Some(bounds.by_normals(direction, l2)).filter(|bound| !of_equal_rings(bound));
        by_normals.unwrap_or_else(|| bounds.by_chains(direction, l2)).l1()
    };
    search.targets.iter().map(|target| of(target.measure)).collect()
}

fn loosest(family: &Family<'_>) -> Option<Model> {
    Model::compile(&family.loosest()?, Cell::PRIMITIVE).ok()
}
