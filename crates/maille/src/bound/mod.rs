//! Bounds of every attainable limit: what a certified limit is compared with.
//!
//! They rest on the links alone and are proofs: no state of any cell of the sheet, reached on any path that
//! keeps the links, has a larger l1. A limit that attains its bound is therefore global.
//!
//! | bound | idea | cost |
//! | --- | --- | --- |
//! | [`ChainBound`] | a lattice vector is no longer than the chain of links that joins its ends | microseconds |
//! | [`LinkBound`] | all links at once, poses relaxed to a convex set; the value of a dual solution | a millisecond |
//!
//! Where a limit stays below both, the [normals](LinkBound::limit_by_normals) of the rings tighten the link bound. Another one, [`ImageBound`], tells from the shapes of the elements alone how near own images can come. It proves for a
//! single cell that an l2 is out of reach.
//!
//! The lemma behind the first two. Let the circles a and b be linked, their tori disjoint: core distance ≥ r_a + r_b. Then a
//! crosses b's disc at some point p; p lies in b's plane, so its distance to b's core is R_b − |p − c_b|, hence
//! |p − c_b| ≤ R_b − r_a − r_b, and |c_a − c_b| ≤ |c_a − p| + |p − c_b| ≤ R_a + R_b − r_a − r_b.
//!
//! For closed curves of any form the same holds with R the radius of a ball about c that holds the curve: if the cores were further apart
//! than R_a + R_b − r_a − r_b along n = (c_b − c_a)/|c_b − c_a|, b could be moved along n by less than r_a + r_b, without meeting a, until a plane
//! separates the balls; but linked curves cannot be separated so.
//!
//! Every inequality used is convex in the centres, in matrices of rotation relaxed to their convex hull, and in F, and
//! holds in each cell alike. So for a state of any supercell the average over its primitive cells, with the same F,
//! satisfies the inequalities of the primitive cell: what is proved for the primitive cell holds for every cell.

mod chain;
mod image;
mod link;
mod metric;
mod normals;
mod outcome;
mod proof;
mod tie;
mod width;

pub use chain::ChainBound;
pub use image::{ImageBound, NearImages};
pub use link::{LinkBound, LinkSolution};
pub use metric::{MetricBound, metric_bound};
pub use outcome::{BindingChain, Bound, BoundKind, DualForce};
pub use tie::{TieKind, crossing_pairs_length};

use crate::lattice::{Across, Direction};

/// The link bound counts as lower than the chain bound from this difference on; below it they are the same number.
const SAME: f64 = 1e-10;

/// The lower of the two bounds; the link bound is solved only where it is asked for and the chain bound is finite.
pub fn best_bound(chain: &ChainBound, link: Option<&LinkBound>, direction: Direction, l2: f64) -> Bound {
    let first = chain.limit(direction, l2);
    let (Some(link), Bound::Finite { l1: chain_l1, chain: path, .. }) = (link, &first) else {
        return first;
    };
    let solution = link.limit(direction, l2);
    if solution.l2_unreachable() {
        Bound::L2Unreachable { kind: BoundKind::Link, chain: path.clone(), dual: solution.dual }
    } else if solution.l1 < chain_l1 - SAME {
        Bound::Finite { l1: solution.l1, kind: BoundKind::Link, chain: path.clone(), dual: solution.dual }
    } else {
        first
    }
}

/// `bound`, or what the normals of the rings prove where that is lower: for limits that do not attain their bound.
pub(crate) fn lowered(bound: Bound, link: &LinkBound, direction: Direction, l2: f64, free: Across) -> Bound {
    let Bound::Finite { l1, chain, .. } = &bound else { return bound };
    let solution = link.limit_by_normals(direction, l2, free);
    let (kind, chain) = (BoundKind::Link, chain.clone());
    if solution.l2_unreachable() {
        Bound::L2Unreachable { kind, chain, dual: solution.dual }
    } else if solution.l1 < l1 - SAME {
        Bound::Finite { l1: solution.l1, kind, chain, dual: solution.dual }
    } else {
        bound
    }
}

/// The lower of the two bounds with the width or the shear free.
pub(crate) fn best_bound_across(
    chain: &ChainBound,
    link: Option<&LinkBound>,
    direction: Direction,
    l2: f64,
    free: Across,
) -> Bound {
    if !free.any() {
        return best_bound(chain, link, direction, l2);
    }
    let of_chains = LinkBound::of_chains(chain).limit_across(direction, l2, free);
    if of_chains.l2_unreachable() {
        return Bound::L2Unreachable { kind: BoundKind::Chain, chain: None, dual: of_chains.dual };
    }
    if !of_chains.l1.is_finite() {
        return Bound::Unbounded;
    }
    let (kind, solution) = match link.map(|link| link.limit_across(direction, l2, free)) {
        Some(solution) if solution.l1 < of_chains.l1 - SAME => (BoundKind::Link, solution),
        _ => (BoundKind::Chain, of_chains),
    };
    if solution.l2_unreachable() {
        return Bound::L2Unreachable { kind, chain: None, dual: solution.dual };
    }
    Bound::Finite { l1: solution.l1, kind, chain: None, dual: solution.dual }
}
