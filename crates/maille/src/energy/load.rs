//! Forces on elements (§4.1.4): constant ones (eq. 4.1.7), targets for positions (eq. 4.1.8), and what holds against
//! them: elements whose position is no unknown, and a floor.

use super::barrier::barrier;
use crate::{error::InvalidInput, model::Model, solve::curvature::Curvature, state::State};
use maille_geometry::Vec3;

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
/// The contact law of rings acts between the plane and [`FLOOR_POINTS`] points of each core circle, which are fixed in
/// their ring. So a ring that lies flat has a smooth energy (its lowest point has none); a standing one may dip by
/// R (1 − cos(π / points)) between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Height of the plane.
    pub height: f64,
    /// Weight α of its contacts.
    pub alpha: f64,
}

/// Points of a core circle that feel the floor.
pub const FLOOR_POINTS: usize = 32;

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
}

impl Loads {
    /// The unknowns that are none: positions of held elements.
    pub fn held_unknowns(&self) -> Vec<usize> {
        self.held.iter().flat_map(|e| 6 * e..6 * e + 3).collect()
    }

    /// Refuses a load under which some linked group of elements would fall for ever, and a floor that is not below.
    pub fn check(&self, model: &Model) -> Result<(), InvalidInput> {
        if let Some(floor) = self.floor {
            for (ring, r) in model.rings.iter().enumerate() {
                let circle = model.start.circle(model, ring, [0, 0]);
                let lowest = circle.center.z - circle.radius * (1.0 - circle.normal.z.powi(2)).max(0.0).sqrt();
                if lowest < floor.height + r.minor_radius {
                    return Err(InvalidInput::new(
                        "floor",
                        format!(
                            "{} is above the lowest point of {}, {:.6}",
                            floor.height * model.unit,
                            model.ring_label(ring, [0, 0]),
                            (lowest - r.minor_radius) * model.unit,
                        ),
                        "give the height of a plane below the sheet",
                    ));
                }
            }
        }
        for group in groups(model) {
            let force: Vec3 = self.forces.iter().filter(|f| group.contains(&f.0)).map(|f| f.1).sum();
            let held = self.held.iter().chain(self.targets.iter().map(|t| &t.element)).any(|e| group.contains(e));
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
            for_floor_points(model, state, plane, |_, _, depth, touching| {
                floor += barrier(depth, touching, plane.alpha)[0];
            });
        }
        forces + targets + floor
    }

    /// Adds gradient and Hessian.
    pub fn add_derivatives(&self, model: &Model, state: &State, gradient: &mut [f64], hessian: &mut Curvature) {
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
        let Some(plane) = self.floor else { return };
        for_floor_points(model, state, plane, |element, arm, depth, touching| {
            let [_, first, second] = barrier(depth, touching, plane.alpha);
            // z of e^ω arm: derivative arm × e_z, second derivative ½ (e_z armᵀ + arm e_zᵀ) − arm_z 1.
            let turn = arm.cross(&Vec3::z());
            let slope = [1.0, turn.x, turn.y, turn.z];
            let up = |k: usize| if k == 3 { 1.0 } else { 0.0 };
            let bend = |p: usize, q: usize| match p > 0 && q > 0 {
                true => {
                    let same = if p == q { arm.z } else { 0.0 };
                    0.5 * (up(p) * arm[q - 1] + arm[p - 1] * up(q)) - same
                }
                false => 0.0,
            };
            let entries: Vec<(usize, usize, f64)> =
                [2, 3, 4, 5].iter().enumerate().map(|(p, k)| (p, 6 * element + k, 1.0)).collect();
            for &(p, column, _) in &entries {
                gradient[column] += first * slope[p];
            }
            hessian.add(&entries, 4, |p, q| second * slope[p] * slope[q] + first * bend(p, q));
        });
    }
}

/// Calls `each` with (element, arm from its reference point, height above the floor, height at which it touches) for the
/// points that press on the floor.
fn for_floor_points(model: &Model, state: &State, floor: Floor, mut each: impl FnMut(usize, Vec3, f64, f64)) {
    for (index, ring) in model.rings.iter().enumerate() {
        let pose = &state.poses[ring.element];
        let arm = state.arm(model, index);
        let normal = pose.rotation * ring.normal.into_inner();
        let lowest = (pose.position + arm).z - ring.major_radius * (1.0 - normal.z * normal.z).max(0.0).sqrt();
        if lowest >= floor.height + ring.minor_radius {
            continue;
        }
        // Two directions in the ring's own plane, which turn with it.
        let least = ring.normal.iamin();
        let u = ring.normal.cross(&Vec3::ith(least, 1.0)).normalize();
        let v = ring.normal.cross(&u);
        let (u, v) = (pose.rotation * u, pose.rotation * v);
        for k in 0..FLOOR_POINTS {
            let angle = std::f64::consts::TAU * k as f64 / FLOOR_POINTS as f64;
            let arm = arm + (u * angle.cos() + v * angle.sin()) * ring.major_radius;
            let height = (pose.position + arm).z - floor.height;
            if height < ring.minor_radius {
                each(ring.element, arm, height, ring.minor_radius);
            }
        }
    }
}

/// Elements that chains of links join, images included.
fn groups(model: &Model) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..model.elements.len()).collect();
    for link in &model.links {
        let (i, j) = (model.rings[link.pair.ring_a].element, model.rings[link.pair.ring_b].element);
        let (from, to) = (group[i].max(group[j]), group[i].min(group[j]));
        if from != to {
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
        }
    }
    let firsts: std::collections::BTreeSet<usize> = group.iter().copied().collect();
    firsts.into_iter().map(|g| (0..group.len()).filter(|e| group[*e] == g).collect()).collect()
}
