//! Where the elements of designs with other radii are written.
//!
//! A design's links are those of the written state. Where radii change by much, rings that stay where they are written would cross: two long
//! rings that pass through the same short one, say. So the given design is changed in steps, and after each its elements move
//! to where the gaps are widest. A limit does not depend on where they are written.

use super::family::Family;
use crate::{
    lattice::Cell,
    model::Model,
    search::{
        ExtremeOptions,
        extreme::{Extreme, extreme},
    },
};
use maille_design::Design;
use std::sync::atomic::AtomicBool;

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

/// The design of a family with these numbers, linked as the one with its first numbers: as the family writes it or, where that is
/// linked in another way and only radii are free, with its elements moved. `None` where neither is found.
pub fn linked_alike(family: &Family<'_>, values: &[f64], cancel: &AtomicBool) -> Option<Design> {
    let first: Vec<f64> = family.numbers.iter().map(|number| number.value).collect();
    let given = Model::compile(&(family.make)(&first).ok()?, Cell::PRIMITIVE).ok()?;
    linked_as(family, &given, values, cancel)
}

/// The same, `given` being the design with the family's first numbers.
pub(super) fn linked_as(family: &Family<'_>, given: &Model, values: &[f64], cancel: &AtomicBool) -> Option<Design> {
    let written = (family.make)(values).ok()?;
    if Model::compile(&written, Cell::PRIMITIVE).is_ok_and(|model| model.links == given.links) {
        return Some(written);
    }
    family.of_radii().then(|| steps(family, given, values, cancel))?
}

/// The design with the numbers `to`, its elements moved so that it is linked as `model`, the design with the first numbers; `None` where
/// the steps do not get there.
fn steps(family: &Family<'_>, model: &Model, to: &[f64], cancel: &AtomicBool) -> Option<Design> {
    let from: Vec<f64> = family.numbers.iter().map(|number| number.value).collect();
    let (mut reached, mut step, mut design) = (0.0, LARGEST_STEP, (family.make)(&from).ok()?);
    while reached < 1.0 {
        let next = f64::min(reached + step, 1.0);
        // The end exactly.
        let value = |(from, to): (&f64, &f64)| if next == 1.0 { *to } else { from + next * (to - from) };
        let between: Vec<f64> = from.iter().zip(to).map(value).collect();
        let moved = (family.make)(&between).ok().map(|moved| at(moved, &design));
        match moved.and_then(|moved| roomiest(model, moved, cancel)) {
            Some(moved) => (reached, step, design) = (next, f64::min(2.0 * step, LARGEST_STEP), moved),
            None if step <= SMALLEST_STEP => return None,
            None => step *= 0.5,
        }
    }
    Some(design)
}

/// The design with its elements where the gaps are widest, as far as one search finds; `None` where it is not linked as `given`.
fn roomiest(given: &Model, design: Design, cancel: &AtomicBool) -> Option<Design> {
    let model = Model::compile(&design, Cell::PRIMITIVE).ok().filter(|model| model.links == given.links)?;
    let options = ExtremeOptions { lattice_free: false, starts: Some(1), ..ExtremeOptions::default() };
    Some(extreme(&model, Extreme::LargestClearance, &options, cancel).state.design(&design, &model))
}
