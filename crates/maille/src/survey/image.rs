//! The image of a limit under a symmetry of the design: a limit along another direction, which needs no solve.

use crate::{
    answer::{Answer, CellTrend, FreeRanges, WaveCurvature},
    bound::{BindingChain, DualForce, TieKind},
    lattice::{Cell, Direction},
    model::{Core, Model, of_cell},
    program::Contact,
    state::State,
    symmetry::{Image, Operation, between},
};
use maille_geometry::point_circle_distance;
use std::borrow::Cow;

/// The image of `answer`, a limit along `solved_deg`, along `direction_deg`, with the model of its cell. Of several operations the
/// first is taken that leads to one of the cells of `models`.
///
/// # Panics
/// If none of `operations` takes the one direction to the other.
pub(crate) fn image<'a>(
    operations: &[Operation],
    models: &'a [Model],
    answer: &Answer,
    solved_deg: f64,
    direction_deg: f64,
) -> (Cow<'a, Model>, Answer) {
    let from = &*of_cell(models, answer.cell);
    let known = |cell: Cell| models.iter().find(|model| model.cell.same_lattice(&cell));
    let possible = || between(operations, solved_deg, direction_deg).filter_map(|o| Some((o, o.cell(from.cell)?)));
    let (operation, model) = possible()
        .find_map(|(operation, cell)| Some((operation, Cow::Borrowed(known(cell)?))))
        .or_else(|| possible().next().map(|(operation, cell)| (operation, Cow::Owned(from.in_cell(cell)))))
        .unwrap_or_else(|| panic!("{direction_deg}° is no image of {solved_deg}°"));
    let primitive = models[0].primitive();
    let maps = |from, to| {
        Image::new(operation, from, to).unwrap_or_else(|| panic!("an operation does not map its own design"))
    };
    let (own, first, image) = (maps(&primitive, &primitive), maps(&models[0], &models[0]), maps(from, &model));
    let to = image.model();
    // A search that ends without a state has the start.
    let (state, gradient) = if answer.state == from.start {
        (to.start.clone(), answer.gradient)
    } else {
        let state = image.state(&answer.state);
        let gradient = state.deformation_gradient(to);
        (state, gradient)
    };
    let along = Direction::of_degrees(direction_deg).along();
    let cell = |cell: Cell| operation.cell(cell).map_or(cell, |cell| known(cell).map_or(cell, |model| model.cell));
    // All that is written of a state passes here. The chain counts the rings of the first cell, ties those of the design's own.
    let answer = Answer {
        value: answer.value.map(|_| along.dot(&(gradient * along)) - 1.0),
        gradient,
        cell: to.cell,
        note: answer.note.as_ref().map(|note| format!("image of {solved_deg}°: {note}")),
        chain: answer.chain.as_ref().map(|chain| mapped_chain(&first, chain)),
        dual: answer.dual.iter().map(|tie| mapped_tie(&own, &first, tie)).collect(),
        contacts: answer.contacts.iter().map(|contact| mapped_contact(&image, contact, &state)).collect(),
        wave: answer.wave.map(|wave| mapped_wave(&image, wave)),
        free: answer.free.map(|free| mapped_ranges(&image, free)),
        by_cell: answer.by_cell.iter().map(|t| CellTrend { cell: cell(t.cell), ..*t }).collect(),
        state,
        ..answer.clone()
    };
    (model, answer)
}

fn mapped_contact(image: &Image<'_>, contact: &Contact, state: &State) -> Contact {
    let (pair, [point_a, point_b]) = image.contact(&contact.pair, [contact.point_a, contact.point_b], state);
    // The point of b and the nearest one of a: where the two rings change their order, that is another one by a hair.
    let point_a = match state.core(image.model(), pair.ring_a, [0, 0]) {
        Core::Circle(circle) => point_circle_distance(&point_b, &circle).point,
        Core::Curve(..) => point_a,
    };
    Contact { pair, point_a, point_b, force: contact.force }
}

/// The chain goes on from the same cell.
fn mapped_chain(first: &Image<'_>, chain: &BindingChain) -> BindingChain {
    let rings: Vec<_> = chain.rings.iter().map(|&(ring, shift)| first.ring(ring, shift)).collect();
    let [p, q] = rings.first().map_or([0, 0], |(_, shift)| *shift);
    BindingChain {
        vector: first.shift(chain.vector),
        length: chain.length,
        rings: rings.into_iter().map(|(ring, [m, n])| (ring, [m - p, n - q])).collect(),
    }
}

fn mapped_tie(own: &Image<'_>, first: &Image<'_>, tie: &DualForce) -> DualForce {
    let counted = if tie.kind == TieKind::Chain { first } else { own };
    let rings = tie.rings.iter().map(|&(ring, shift)| counted.ring(ring, shift)).collect();
    DualForce { kind: tie.kind, rings, force: own.vector(&tie.force) }
}

/// A shift s of the image is that of the solved cell under an integer matrix N, and the phase q·s stays the same: q' = N⁻ᵀ q.
fn mapped_wave(image: &Image<'_>, wave: WaveCurvature) -> WaveCurvature {
    let [[a, c], [b, d]] = [[1, 0], [0, 1]].map(|s| image.shift(s).map(f64::from));
    let ([q1, q2], det) = (wave.q, a * d - b * c);
    WaveCurvature { q: [(d * q1 - c * q2) / det, (a * q2 - b * q1) / det], ..wave }
}

fn mapped_ranges(image: &Image<'_>, free: FreeRanges) -> FreeRanges {
    let [least, most] = free.shear;
    FreeRanges { shear: if image.mirrors() { [-most, -least] } else { free.shear }, ..free }
}
