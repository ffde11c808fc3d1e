//! Whether a pull has taken a sheet apart: it can then go on for ever.

use crate::{
    lattice::{ACROSS, Direction, shifts_within},
    model::Model,
    state::State,
};

/// Whether l1 can grow without end from `state`, the poses as they are.
///
/// A growing l1 moves the image s of element j against element i by the multiple D·t of D, t = s₁ a₁ + s₂ a₂ in the reference: away from it
/// where it is ahead by that sign, and past it where it is beside. With ϱ the sum of both reaches and of the thickest wires, and
/// o the way from the one to the other, no such pair can ever touch if
///
/// D·t = 0, or sign(D·t) (D·o) > ϱ, or |o − (D·o) D| > ϱ.
///
/// Sufficient, not necessary: a body is taken for its ball. What touches in `state` itself is not looked at.
pub(crate) fn comes_apart(model: &Model, state: &State, direction: Direction) -> bool {
    let (along, across) = (direction.along(), direction.across());
    let thickest = model.rings.iter().map(|r| r.minor_radius).fold(0.0, f64::max);
    let f = state.deformation_gradient(model);
    let lean = (along.dot(&(f * across)) / across.dot(&(f * across))).abs();
    let elements = || state.poses.iter().zip(&model.elements).enumerate();
    elements().all(|(i, (a, first))| {
        elements().skip(i).all(|(j, (b, second))| {
            let between = b.position - a.position;
            let reach = first.reach + second.reach + 2.0 * thickest;
            // An image that is not safe is at most ϱ beside and ahead, and behind by no more than `between` and the shear carry it.
            let far = (2.0 + lean) * (reach + between.norm());
            shifts_within(&Default::default(), &state.a1, &state.a2, far).into_iter().all(|shift| {
                if i == j && shift == [0, 0] {
                    return true;
                }
                let reference = model.start.translation(shift).xy();
                let rate = along.dot(&reference);
                if rate.abs() <= ACROSS * reference.norm() {
                    return true;
                }
                let way = between + state.translation(shift);
                let ahead = along.dot(&way.xy());
                let beside = (way.norm_squared() - ahead * ahead).max(0.0).sqrt();
                rate.signum() * ahead > reach || beside > reach
            })
        })
    })
}
