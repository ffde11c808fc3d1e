//! What holds a finite sheet: the forces of its grips, its stretch and its deformation gradient, in one state.
//!
//! A grip is a place that is fixed or pulled. f is the force that it exerts on the sheet: on a fixed element e
//! f_e = ∂E/∂x_e, with E = contacts + floor − Σ f·x of the constant forces (§4.1.4), which is what keeps it where it is; on a
//! pulled one f_e = 2 β_t (x_T − x_e), minus the slope of its target β_t |x − x_T|² (eq. 4.1.8). The force of a grip is the
//! sum over its elements. Contacts push both rings alike, so at rest all grips, the constant forces and the floor add up to 0.
//!
//! These are forces of the energy method. Rings are rigid and contacts a steep barrier: where a sheet gives way freely the
//! forces are 0 to the tolerance of rest. Where it has locked they say how hard the targets pull, at most 2 β_t τ on an
//! element, not what a ring withstands. What is meaningful is the stretch at which they rise.

use super::{Setup, WEIGHT_UNIT};
use crate::{
    model::Model,
    record::ForceRow,
    relaxation::{Configuration, SheetEnergy, load::Loads},
    solver::curvature::Curvature,
    state::State,
};
use maille_geometry::Vec3;
use nalgebra::Matrix2;

/// A place where a sheet is held. Lengths in units of the reference radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Its name, as given.
    pub name: String,
    /// Its elements.
    pub elements: Vec<usize>,
    /// The way that they are pulled, as in [`Setup`]; none where they are fixed.
    pub way: Option<Vec<Vec3>>,
}

/// Between the pull and the line from grip to grip: above 60° (cosine below ½) there is no stretch along the pull.
const LEAST_COSINE: f64 = 0.5;
/// Elements lie on one line where the smaller eigenvalue of their second moments is this part of the larger one.
const ON_ONE_LINE: f64 = 1e-9;

/// The row of a state: `share` of the pull is done, `energy` is that of the minimisation. The elements of `grips` are those
/// that `setup` fixes and pulls, each in one grip.
///
/// Forces are in [`WEIGHT_UNIT`]s, 1e-3 β R, as `setup.gravity` and `setup.forces` are.
pub fn force_row(model: &Model, setup: &Setup, grips: &[Grip], share: f64, energy: f64, state: &State) -> ForceRow {
    let loads = setup.loads(model, share, setup.options.alpha);
    let contacts = setup.options.contacts(model);
    let unheld =
        Loads { forces: loads.forces.clone(), floor: loads.floor, bend: loads.bend.clone(), ..Loads::default() };
    let sheet = SheetEnergy { loads: unheld, ..SheetEnergy::new(model, &contacts) };
    let (_, slope) = sheet.gradient(&Configuration::start(state.clone()));
    let mut on = vec![Vec3::zeros(); model.elements.len()];
    for e in &loads.held {
        on[*e] = Vec3::new(slope[6 * e], slope[6 * e + 1], slope[6 * e + 2]);
    }
    for t in &loads.targets {
        on[t.element] = (t.position - state.poses[t.element].position) * (2.0 * t.weight);
    }
    let force = |grip: &Grip| grip.elements.iter().map(|e| on[*e]).sum::<Vec3>() / WEIGHT_UNIT;
    let axis = Axis::of(model, grips);
    ForceRow {
        share,
        stretch: axis.as_ref().and_then(|axis| axis.stretch(model, state)),
        mean_force: axis.map(|axis| axis.direction.dot(&force(axis.pulled)) / axis.pulled.elements.len() as f64),
        deformation: deformation_gradient(model, state).map(|f| [[f.m11, f.m12], [f.m21, f.m22]]),
        energy,
        floor_force: loads.floor.is_some().then(|| floor_force(model, &loads, state) / WEIGHT_UNIT),
        bend_force: loads.bend.as_ref().map(|bend| bend.forces(state).map(|f| f.norm()).sum::<f64>() / WEIGHT_UNIT),
        forces: grips.iter().map(|grip| force(grip).into()).collect(),
    }
}

/// F, the affine map of the plane that fits the way of all elements best.
///
/// With X_e and x_e the positions in the plane of the reference points at the start and now, both from their means,
/// F = (Σ x_e X_eᵀ)(Σ X_e X_eᵀ)⁻¹ minimises Σ |x_e − F X_e|². It is exact where the sheet is deformed affinely. Nothing where
/// the elements start on one line.
#[doc(hidden)]
pub fn deformation_gradient(model: &Model, state: &State) -> Option<Matrix2<f64>> {
    let count = model.elements.len() as f64;
    let mean = |s: &State| s.poses.iter().map(|pose| pose.position).sum::<Vec3>() / count;
    let (from, to) = (mean(&model.start), mean(state));
    let (mut moved, mut moments) = (Matrix2::zeros(), Matrix2::zeros());
    for (start, now) in model.start.poses.iter().zip(&state.poses) {
        let (x0, x) = ((start.position - from).xy(), (now.position - to).xy());
        moved += x * x0.transpose();
        moments += x0 * x0.transpose();
    }
    let eigen = moments.symmetric_eigenvalues();
    (eigen.min() > ON_ONE_LINE * eigen.max()).then(|| moments.try_inverse().map(|inverse| moved * inverse)).flatten()
}

/// The force of the floor along z.
fn floor_force(model: &Model, loads: &Loads, state: &State) -> f64 {
    let unknowns = 6 * model.elements.len();
    let mut slope = vec![0.0; unknowns];
    let floor = Loads { floor: loads.floor, ..Loads::default() };
    floor.add_derivatives(model, state, &mut slope, &mut Curvature::new(unknowns, &[]));
    -slope.iter().skip(2).step_by(6).sum::<f64>()
}

/// The axis of a pull: from the grip that lies opposite to the first pulled one.
struct Axis<'a> {
    pulled: &'a Grip,
    opposite: Option<&'a Grip>,
    /// Unit vector along the pull, away from the opposite grip: a force along it stretches the sheet.
    direction: Vec3,
}

/// Mean position of a grip's elements.
fn middle(state: &State, grip: &Grip) -> Vec3 {
    grip.elements.iter().map(|e| state.poses[*e].position).sum::<Vec3>() / grip.elements.len() as f64
}

impl<'a> Axis<'a> {
    /// The pull is along the point of the way that is farthest from its start; of other grips, fixed or pulled, that one lies
    /// opposite which is farthest off along the pull, forward or backward.
    fn of(model: &Model, grips: &'a [Grip]) -> Option<Self> {
        let at = grips.iter().position(|grip| grip.way.is_some() && !grip.elements.is_empty())?;
        let pulled = &grips[at];
        let way = pulled.way.iter().flatten();
        let direction = way.max_by(|a, b| a.norm().total_cmp(&b.norm()))?.try_normalize(0.0)?;
        let apart = |grip: &Grip| middle(&model.start, pulled) - middle(&model.start, grip);
        let others = grips.iter().enumerate().filter(|(k, grip)| *k != at && !grip.elements.is_empty());
        let along = |grip: &Grip| direction.dot(&apart(grip)).abs();
        let opposite = others
            .map(|(_, grip)| grip)
            .max_by(|a, b| along(a).total_cmp(&along(b)))
            .filter(|grip| along(grip) > LEAST_COSINE * apart(grip).norm());
        let backward = opposite.is_some_and(|grip| direction.dot(&apart(grip)) < 0.0);
        Some(Axis { pulled, opposite, direction: if backward { -direction } else { direction } })
    }

    /// Distance of the two grips along the pull by that at the start.
    fn stretch(&self, model: &Model, state: &State) -> Option<f64> {
        let opposite = self.opposite?;
        let distance = |s: &State| self.direction.dot(&(middle(s, self.pulled) - middle(s, opposite)));
        Some(distance(state) / distance(&model.start))
    }
}
