//! The state: all that changes. Poses of the elements and the deformed lattice.

use crate::{design::Design, lattice::Shift, model::Model};
use maille_geometry::{Circle, Vec3};
use nalgebra::{Matrix2, Unit, UnitQuaternion};

/// Pose of an element: where its reference point is, and how it is turned from the design's pose (§4.2, eq. 4.2.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the reference point.
    pub position: Vec3,
    /// Rotation R accumulated since the starting state.
    pub rotation: UnitQuaternion<f64>,
}

impl Pose {
    /// Moves by `translation` and turns by the rotation vector `turn` (axis times angle) about the reference point.
    ///
    /// As in §4.2 the step's rotation is kept apart from the accumulated R := exp(turn) R; a rotation vector in
    /// place of three Euler angles, equal to first order and independent of the frame. The quaternion is normalised
    /// at every update, so R stays orthonormal.
    pub fn moved(&self, translation: &Vec3, turn: &Vec3) -> Pose {
        let rotation = UnitQuaternion::from_scaled_axis(*turn) * self.rotation;
        Pose { position: self.position + translation, rotation: UnitQuaternion::new_normalize(rotation.into_inner()) }
    }
}

/// Poses of the cell's elements and its lattice vectors, in units of the reference radius.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// One pose for each element of the cell.
    pub poses: Vec<Pose>,
    /// First lattice vector, deformed.
    pub a1: Vec3,
    /// Second lattice vector, deformed.
    pub a2: Vec3,
}

impl State {
    /// Translation of the image `shift`.
    pub fn translation(&self, shift: Shift) -> Vec3 {
        self.a1 * f64::from(shift[0]) + self.a2 * f64::from(shift[1])
    }

    /// Arm from its element's reference point to the centre of ring `ring`.
    pub fn arm(&self, model: &Model, ring: usize) -> Vec3 {
        let r = &model.rings[ring];
        self.poses[r.element].rotation * r.offset
    }

    /// Core circle of ring `ring` in the image `shift`.
    pub fn circle(&self, model: &Model, ring: usize, shift: Shift) -> Circle {
        let r = &model.rings[ring];
        let pose = &self.poses[r.element];
        let center = pose.position + pose.rotation * r.offset + self.translation(shift);
        Circle::new(center, Unit::new_normalize(pose.rotation * r.normal.into_inner()), r.major_radius)
    }

    /// In-plane deformation gradient F of the lattice vectors, F a_k(reference) = a_k (eq. 5.2.1).
    pub fn deformation_gradient(&self, model: &Model) -> Matrix2<f64> {
        let deformed = Matrix2::new(self.a1.x, self.a2.x, self.a1.y, self.a2.y);
        deformed * model.reference_inverse
    }

    /// `design` as it stands in this state of its own cell: centres, normals, offsets and lattice in the design's unit.
    pub fn design(&self, design: &Design, model: &Model) -> Design {
        let mut out = design.clone();
        out.lattice.a1 = (self.a1 * model.unit).into();
        out.lattice.a2 = (self.a2 * model.unit).into();
        for (element, pose) in out.elements.iter_mut().zip(&self.poses) {
            element.center = (pose.position * model.unit + model.origin).into();
            for ring in &mut element.rings {
                ring.normal = (pose.rotation * Vec3::from(ring.normal)).into();
                ring.offset = (pose.rotation * Vec3::from(ring.offset)).into();
            }
        }
        out
    }
}
