//! Forces on elements (§4.1.4): constant ones (eq. 4.1.7), targets for positions (eq. 4.1.8), and what holds against
//! them: elements whose position is no unknown, a floor, and drag.

use super::barrier::barrier;
use crate::{
    model::{Core, Model},
    solver::curvature::Curvature,
    state::{Pose, State},
    topology::{broad_phase::in_chunks, linked_parts},
};
use maille_design::InvalidInput;
use maille_geometry::Vec3;
use nalgebra::{Matrix3, Matrix4, Vector4};

/// A position that an element is pulled to, with energy β |x − x_T|².
#[derive(Clone, Debug, PartialEq)]
pub struct PositionTarget {
    /// The element.
    pub element: usize,
    /// x_T.
    pub position: Vec3,
    /// β.
    pub weight: f64,
}

/// A half space that no ring may enter: z below `height` is solid.
///
/// The contact law of rings acts between the plane and `FLOOR_POINTS` points of each core circle, which are fixed in
/// their ring. So a ring that lies flat has a smooth energy (its lowest point has none); a standing one may dip by
/// R (1 − cos(π / points)) between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Height of the plane.
    pub height: f64,
    /// Weight α of its contacts.
    pub alpha: f64,
}

/// Points of a core that feel the floor.
pub(crate) const FLOOR_POINTS: usize = 32;

/// A surface to which reference points are drawn: z = ζ_e − (κ_x X² + κ_y Y²)/2 with X, Y from `middle` and ζ_e the element's height at the
/// start, of the energy β q², q the height of the point above it. κ above 0 bends downwards, as the axis of a roll lies below.
#[derive(Clone, Debug, PartialEq)]
pub struct Bend {
    /// κ_x and κ_y.
    pub curvature: [f64; 2],
    /// Where the surface is level.
    pub middle: [f64; 2],
    /// The elements that are drawn, with ζ_e.
    pub heights: Vec<(usize, f64)>,
    /// β.
    pub weight: f64,
}

impl Bend {
    /// q of a point with the height ζ, and ∂q/∂x.
    fn above(&self, position: &Vec3, height: f64) -> (f64, Vec3) {
        let [x, y] = [position.x - self.middle[0], position.y - self.middle[1]];
        let [kx, ky] = self.curvature;
        let q = position.z - height + 0.5 * (kx * x * x + ky * y * y);
        (q, Vec3::new(kx * x, ky * y, 1.0))
    }

    /// The largest |q| of the elements.
    pub(crate) fn miss(&self, state: &State) -> f64 {
        self.heights.iter().map(|(e, z)| self.above(&state.poses[*e].position, *z).0.abs()).fold(0.0, f64::max)
    }

    /// The force of the surface on each element, −2 β q ∂q/∂x.
    pub(crate) fn forces(&self, state: &State) -> impl Iterator<Item = Vec3> {
        self.heights.iter().map(|(e, z)| {
            let (q, slope) = self.above(&state.poses[*e].position, *z);
            slope * (-2.0 * self.weight * q)
        })
    }
}

/// Resistance to motion: an implicit step of overdamped motion from the poses `from`.
///
/// Energy of an element that has moved by Δx and turned by the angle θ since: c/2 |Δx|² + c R² (1 − cos θ), where
/// R = 1 is the reference radius. With Q = rotation · from⁻¹, 1 − cos θ = (3 − tr Q)/2, smooth but at θ = π.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// Poses at the beginning of the step.
    pub from: Vec<Pose>,
    /// c: drag coefficient over time step, in β.
    pub coefficient: f64,
}

impl Drag {
    /// 1 − cos of the angle turned, its gradient and its Hessian in a further turn.
    fn turned(&self, e: usize, pose: &Pose) -> (f64, Vec3, Matrix3<f64>) {
        let q = (pose.rotation * self.from[e].rotation.inverse()).to_rotation_matrix();
        let q = q.matrix();
        let axis = Vec3::new(q[(2, 1)] - q[(1, 2)], q[(0, 2)] - q[(2, 0)], q[(1, 0)] - q[(0, 1)]);
        let bend = (Matrix3::identity() * q.trace() - (q + q.transpose()) * 0.5) * 0.5;
        (0.5 * (3.0 - q.trace()), axis * 0.5, bend)
    }
}

/// What acts on single elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// Constant forces (element, f), of the energy −f·x.
    pub forces: Vec<(usize, Vec3)>,
    /// Targets.
    pub targets: Vec<PositionTarget>,
    /// Elements whose reference point stays where it is; they still turn.
    pub held: Vec<usize>,
    /// A floor.
    pub floor: Option<Floor>,
    /// Resistance to motion.
    pub drag: Option<Drag>,
    /// A surface that draws elements.
    pub bend: Option<Bend>,
}

impl Loads {
    /// The unknowns that are none: positions of held elements.
    pub(crate) fn held_unknowns(&self) -> Vec<usize> {
        self.held.iter().flat_map(|e| 6 * e..6 * e + 3).collect()
    }

    /// Refuses a load under which some linked group of elements would fall for ever, and a floor that is not below.
    pub(crate) fn check(&self, model: &Model) -> Result<(), InvalidInput> {
        if let Some(floor) = self.floor {
            for (ring, r) in model.rings.iter().enumerate() {
                let lowest = match model.start.core(model, ring, [0, 0]) {
                    Core::Circle(circle) => {
                        circle.center.z - circle.radius * (1.0 - circle.normal.z.powi(2)).max(0.0).sqrt()
                    }
                    core => floor_angles_rad().map(|angle| core.at_angle(angle).point.z).fold(f64::INFINITY, f64::min),
                };
                if lowest < floor.height + r.minor_radius {
                    return Err(InvalidInput::new(
                        "floor",
                        format!(
                            "{} is above the lowest point of {}, {:.6}",
                            floor.height * model.unit + model.origin.z,
                            model.ring_label(ring, [0, 0]),
                            (lowest - r.minor_radius) * model.unit + model.origin.z,
                        ),
                        "give the height of a plane below the sheet",
                    ));
                }
            }
        }
        for group in linked_parts(model).into_iter().map(|part| part.elements) {
            let inside = |e: &usize| group.binary_search(e).is_ok();
            let force: Vec3 = self.forces.iter().filter(|f| inside(&f.0)).map(|f| f.1).sum();
            let held = self.held.iter().chain(self.targets.iter().map(|t| &t.element)).any(inside);
            let caught = self.floor.is_some() && force.z < 0.0 && force.x == 0.0 && force.y == 0.0;
            if force != Vec3::zeros() && !held && !caught {
                let element = &model.elements[group[0]].name;
                return Err(InvalidInput::new(
                    "gravity",
                    format!(
                        "nothing holds \"{element}\" and the {} elements linked with it against the force",
                        group.len() - 1
                    ),
                    "fix an edge or an element, or put a floor below a force along −z",
                ));
            }
        }
        Ok(())
    }

    /// Energy.
    pub fn energy(&self, model: &Model, state: &State) -> f64 {
        let forces: f64 = self.forces.iter().map(|(e, f)| -f.dot(&state.poses[*e].position)).sum();
        let targets: f64 =
            self.targets.iter().map(|t| t.weight * (state.poses[t.element].position - t.position).norm_squared()).sum();
        let mut floor = 0.0;
        if let Some(plane) = self.floor {
            for ring in 0..model.rings.len() {
                for_points_of(model, state, plane, ring, |_, depth, touching| {
                    floor += barrier(depth, touching, plane.alpha)[0];
                });
            }
        }
        let mut dragged = 0.0;
        if let Some(drag) = &self.drag {
            for (e, pose) in state.poses.iter().enumerate() {
                let moved = (pose.position - drag.from[e].position).norm_squared();
                dragged += drag.coefficient * (0.5 * moved + drag.turned(e, pose).0);
            }
        }
        let bent = |bend: &Bend| {
            bend.heights.iter().map(|(e, z)| bend.above(&state.poses[*e].position, *z).0.powi(2)).sum::<f64>()
                * bend.weight
        };
        forces + targets + floor + dragged + self.bend.as_ref().map_or(0.0, bent)
    }

    /// Adds gradient and Hessian.
    pub(crate) fn add_derivatives(&self, model: &Model, state: &State, gradient: &mut [f64], hessian: &mut Curvature) {
        for (e, f) in &self.forces {
            for axis in 0..3 {
                gradient[6 * e + axis] -= f[axis];
            }
        }
        for t in &self.targets {
            let miss = state.poses[t.element].position - t.position;
            for axis in 0..3 {
                gradient[6 * t.element + axis] += 2.0 * t.weight * miss[axis];
                hessian.add(&[(0, 6 * t.element + axis, 1.0)], 1, |_, _| 2.0 * t.weight);
            }
        }
        if let Some(drag) = &self.drag {
            for (e, pose) in state.poses.iter().enumerate() {
                let c = drag.coefficient;
                let moved = pose.position - drag.from[e].position;
                let (_, slope, bend) = drag.turned(e, pose);
                for axis in 0..3 {
                    gradient[6 * e + axis] += c * moved[axis];
                    gradient[6 * e + 3 + axis] += c * slope[axis];
                }
                let entries: Vec<(usize, usize, f64)> = (0..6).map(|k| (k, 6 * e + k, 1.0)).collect();
                hessian.add(&entries, 6, |p, q| match (p, q) {
                    (3.., 3..) => c * bend[(p - 3, q - 3)],
                    _ if p == q => c,
                    _ => 0.0,
                });
            }
        }
        for (bend, (e, z)) in self.bend.iter().flat_map(|bend| bend.heights.iter().map(move |at| (bend, at))) {
            let (q, slope) = bend.above(&state.poses[*e].position, *z);
            (0..3).for_each(|axis| gradient[6 * e + axis] += 2.0 * bend.weight * q * slope[axis]);
            let entries: Vec<(usize, usize, f64)> = (0..3).map(|k| (k, 6 * e + k, 1.0)).collect();
            let curved = |k: usize| bend.curvature.get(k).map_or(0.0, |curvature| q * curvature);
            hessian.add(&entries, 3, |a, b| {
                2.0 * bend.weight * (slope[a] * slope[b] + if a == b { curved(a) } else { 0.0 })
            });
        }
        let Some(plane) = self.floor else { return };
        let rings: Vec<usize> = (0..model.rings.len()).collect();
        let parts =
            in_chunks(&rings, |some| some.iter().filter_map(|ring| floor_part(model, state, plane, *ring)).collect());
        for (element, slope, bend) in parts {
            let entries: Vec<(usize, usize, f64)> =
                [2, 3, 4, 5].iter().enumerate().map(|(p, k)| (p, 6 * element + k, 1.0)).collect();
            for &(p, column, _) in &entries {
                gradient[column] += slope[p];
            }
            hessian.add(&entries, 4, |p, q| bend[(p, q)]);
        }
    }
}

/// The floor's gradient and Hessian in height and turn of the element of a ring that presses on it.
fn floor_part(model: &Model, state: &State, floor: Floor, ring: usize) -> Option<(usize, Vector4<f64>, Matrix4<f64>)> {
    let (mut gradient, mut hessian) = (Vector4::zeros(), Matrix4::zeros());
    let mut presses = false;
    for_points_of(model, state, floor, ring, |arm, depth, touching| {
        presses = true;
        let [_, first, second] = barrier(depth, touching, floor.alpha);
        // z of e^ω arm: derivative arm × e_z, second derivative ½ (e_z armᵀ + arm e_zᵀ) − arm_z 1.
        let turn = arm.cross(&Vec3::z());
        let slope = Vector4::new(1.0, turn.x, turn.y, turn.z);
        gradient += slope * first;
        hessian += slope * slope.transpose() * second;
        let bend = (Vec3::z() * arm.transpose() + arm * Vec3::z().transpose()) * 0.5 - Matrix3::identity() * arm.z;
        let mut turns = hessian.fixed_view_mut::<3, 3>(1, 1);
        turns += bend * first;
    });
    presses.then_some((model.rings[ring].element, gradient, hessian))
}

/// Angles of the points of a core that feel the floor.
fn floor_angles_rad() -> impl Iterator<Item = f64> {
    (0..FLOOR_POINTS).map(|k| std::f64::consts::TAU * k as f64 / FLOOR_POINTS as f64)
}

/// Calls `each` with (arm from the element's reference point, height above the floor, height at which it touches) for the
/// points of a ring that press on the floor.
fn for_points_of(model: &Model, state: &State, floor: Floor, index: usize, mut each: impl FnMut(Vec3, f64, f64)) {
    let ring = &model.rings[index];
    let pose = &state.poses[ring.element];
    if let Some(curve) = &ring.curve {
        for angle in floor_angles_rad() {
            let at = curve.at_angle(angle);
            let arm = pose.rotation * at.point;
            let height = (pose.position + arm).z - floor.height;
            if height < ring.minor_radius && curve.owns(&at) {
                each(arm, height, ring.minor_radius);
            }
        }
        return;
    }
    let arm = state.arm(model, index);
    let normal = pose.rotation * ring.normal.into_inner();
    let lowest = (pose.position + arm).z - ring.major_radius * (1.0 - normal.z * normal.z).max(0.0).sqrt();
    if lowest >= floor.height + ring.minor_radius {
        return;
    }
    // Two directions in the ring's own plane, which turn with it.
    let least = ring.normal.iamin();
    let u = ring.normal.cross(&Vec3::ith(least, 1.0)).normalize();
    let v = ring.normal.cross(&u);
    let (u, v) = (pose.rotation * u, pose.rotation * v);
    for angle in floor_angles_rad() {
        let arm = arm + (u * angle.cos() + v * angle.sin()) * ring.major_radius;
        let height = (pose.position + arm).z - floor.height;
        if height < ring.minor_radius {
            each(arm, height, ring.minor_radius);
        }
    }
}
