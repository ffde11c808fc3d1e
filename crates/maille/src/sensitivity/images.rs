//! Images of a limit under the symmetries of its design: other limits of the same value, between which a change of the design chooses.
//!
//! Let g be a symmetry of the design q that maps the question to itself, and S a state of the limit. Then g S has the same value. Where
//! the design changes by t v, what g S becomes is the image of what S becomes where the design changes by t g⁻¹ v: g maps the design
//! q + t g⁻¹ v to q + t v. So the derivatives of g S along v are those of S along g⁻¹ v, and no other state is needed. With g the
//! group has g⁻¹, so that all g⁻¹ v are all g v. The maximum of the changed design is the largest of them: forward the largest of the
//! derivatives, backward, where the value falls by the derivative times the step, the least.

use super::{
    numbers::{DesignVector, RingVector},
    point::Point,
    slope::{OneSided, Slope},
};
use crate::{
    model::Model,
    question::{Goal, Question},
    symmetry::{Image, Operation, all_operations, same_direction},
};

/// Entries of two contacts that differ by less are the same, relative to the largest.
const SAME: f64 = 1e-6;

/// Whether a symmetry of the design maps a question to itself. A mirror does so for a stretch along or across its line: the width stays,
/// and a shear that changes its sign is either held at 0 or free.
fn keeps(operation: &Operation, question: &Question) -> bool {
    match question.goal {
        Goal::Stretch { direction_deg, .. } => same_direction(operation.direction_deg(direction_deg), direction_deg),
        Goal::Wire { .. } | Goal::Clearance { .. } => true,
        Goal::Strain { .. } | Goal::Ray { .. } | Goal::Area { .. } | Goal::Curvature { .. } | Goal::Rolled { .. } => {
            operation.keeps_deformations()
        }
    }
}

/// The symmetries of the design of `model` that keep `question` and its cell.
pub(super) fn symmetries(model: &Model, question: &Question) -> Vec<Operation> {
    all_operations(model).into_iter().filter(|operation| keeps(operation, question)).collect()
}

/// What `change` becomes under those of `operations` that make another state of that with the closed points `points`; `design` is
/// compiled in its own cell.
pub(super) fn changes(
    operations: &[Operation],
    design: &Model,
    points: &[Point],
    change: &DesignVector,
) -> Vec<DesignVector> {
    let mut out: Vec<DesignVector> = Vec::new();
    for image in operations.iter().filter_map(|operation| Image::new(operation, design, design)) {
        let there = change.image(&image);
        let known = |other: &DesignVector| other.is_close_to(&there, SAME);
        if !known(change) && !out.iter().any(known) && !maps_to_itself(&image, points) {
            out.push(there);
        }
    }
    out
}

/// For each symmetry of a design, `design` being compiled in its own cell, which of `changes` each of them becomes; symmetries that
/// make something else of one are left out.
pub(crate) fn permutations(design: &Model, changes: &[DesignVector]) -> Vec<Vec<usize>> {
    let operations = all_operations(design);
    let images = operations.iter().filter_map(|operation| Image::new(operation, design, design));
    let place = |there: DesignVector| changes.iter().position(|other| other.is_close_to(&there, SAME));
    images.filter_map(|image| changes.iter().map(|change| place(change.image(&image))).collect()).collect()
}

/// Whether a state goes to itself, as far as its closed points tell.
fn maps_to_itself(image: &Image<'_>, points: &[Point]) -> bool {
    let turned = |(ring, rates): &(usize, RingVector)| {
        (image.ring(*ring, [0, 0]).0, rates.turned(|v| image.vector(v), |v| image.axial(v)))
    };
    let same = |(a, own): &(usize, RingVector), (b, other): &(usize, RingVector)| {
        let mut apart = *own;
        apart.add(-1.0, other);
        a == b && apart.dot(&apart) <= SAME * SAME * own.dot(own)
    };
    points.iter().all(|point| {
        let [one, other] = [turned(&point.rings[0]), turned(&point.rings[1])];
        points
            .iter()
            .any(|Point { rings: [a, b], .. }| (same(&one, a) && same(&other, b)) || (same(&one, b) && same(&other, a)))
    })
}

/// The derivatives of the best of several states of one value: `sign` is 1 where it is maximised, −1 where minimised.
pub(super) fn best(states: impl Iterator<Item = OneSided>, sign: f64) -> Option<OneSided> {
    let better = |a: Slope, b: Slope, sign: f64| match (a, b) {
        (Slope::NotFound, _) | (_, Slope::NotFound) => Slope::NotFound,
        (Slope::NoState, other) | (other, Slope::NoState) => other,
        (Slope::Finite(a), Slope::Finite(b)) => Slope::Finite(if sign * a >= sign * b { a } else { b }),
    };
    states.reduce(|a, b| OneSided {
        backward: better(a.backward, b.backward, -sign),
        forward: better(a.forward, b.forward, sign),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two states the one that rises faster counts forward, that which falls less backward; of a least value the other way round.
    #[test]
    fn the_better_state_counts_to_each_side() {
        let state = |backward, forward| OneSided { backward, forward };
        let of = |x| state(Slope::Finite(x), Slope::Finite(x));
        let both = |sign| best([of(0.5), of(-0.25)].into_iter(), sign).unwrap();
        assert_eq!(both(1.0), state(Slope::Finite(-0.25), Slope::Finite(0.5)));
        assert_eq!(both(-1.0), state(Slope::Finite(0.5), Slope::Finite(-0.25)));
        let gone = state(Slope::NoState, Slope::NotFound);
        assert_eq!(best([of(0.5), gone].into_iter(), 1.0).unwrap(), state(Slope::Finite(0.5), Slope::NotFound));
        assert_eq!(best([gone, gone].into_iter(), 1.0).unwrap(), gone);
    }
}
