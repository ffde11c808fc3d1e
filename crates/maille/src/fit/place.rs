//! Where the elements of designs with other radii are written.
//!
//! A design's links are those of the written state. Where radii change by much, rings that stay where they are written would cross: two long
//! rings that pass through the same short one, say. So the given design is changed in steps, and after each its elements move
//! to where the gaps are widest. A limit does not depend on where they are written.

use super::search::{Point, Search};
use crate::{
    design::Design,
    lattice::Cell,
    model::Model,
    search::{
        ExtremeOptions,
        extreme::{Extreme, extreme},
    },
};

/// Steps from the given design to another one: the largest and the smallest, of the whole way.
const LARGEST_STEP: f64 = 0.25;
const SMALLEST_STEP: f64 = 1.0 / 64.0;

/// `design` with its elements where `place` has them.
pub(super) fn at(mut design: Design, place: &Design) -> Design {
    for (element, there) in design.elements.iter_mut().zip(&place.elements) {
        element.center = there.center;
        for (ring, there) in element.rings.iter_mut().zip(&there.rings) {
            (ring.normal, ring.offset) = (there.normal, there.offset);
        }
    }
    design
}

/// The design with these shares, measured: where only radii are free, with its elements where steps from the given design lead.
pub(super) fn solved_in_place(search: &Search<'_>, given: &Point, shares: Vec<f64>) -> Option<Point> {
    if !search.family.of_radii() {
        return search.solve(shares).ok();
    }
    let place = placed(search, given, &shares)?;
    search.at(&place).solve(shares).ok()
}

/// The design with these shares, linked as the given one; `None` where the steps do not get there.
fn placed(search: &Search<'_>, given: &Point, shares: &[f64]) -> Option<Design> {
    let (mut reached, mut step, mut design) = (0.0, LARGEST_STEP, given.design.clone());
    while reached < 1.0 {
        let next = f64::min(reached + step, 1.0);
        let between = given.shares.iter().zip(shares).map(|(from, to)| from + next * (to - from)).collect::<Vec<_>>();
        let moved = (search.family.make)(&search.values(&between)).ok().map(|moved| at(moved, &design));
        match moved.and_then(|moved| roomiest(search, moved)) {
            Some(moved) => (reached, step, design) = (next, f64::min(2.0 * step, LARGEST_STEP), moved),
            None if step <= SMALLEST_STEP => return None,
            None => step *= 0.5,
        }
    }
    Some(design)
}

/// The design with its elements where the gaps are widest, as far as one search finds; `None` where it is linked in another way.
fn roomiest(search: &Search<'_>, design: Design) -> Option<Design> {
    let model = Model::compile(&design, Cell::PRIMITIVE).ok().filter(|model| model.links == search.model.links)?;
    let options = ExtremeOptions { lattice_free: false, starts: Some(1), ..ExtremeOptions::default() };
    Some(extreme(&model, Extreme::LargestClearance, &options, search.cancel).state.design(&design, &model))
}
