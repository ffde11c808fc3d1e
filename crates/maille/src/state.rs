//! The state: all that changes. Poses of the elements, the deformed lattice, and how the sheet is rolled.

pub mod images;
mod roll;

pub use roll::{Carried, NeutralSurface, Roll};

use crate::lattice::Shift;
use maille_geometry::Vec3;
use nalgebra::UnitQuaternion;

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

/// Poses of the cell's elements, its lattice vectors, and how the sheet is rolled; lengths in units of the reference radius.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// One pose for each element of the cell.
    pub poses: Vec<Pose>,
    /// First lattice vector, deformed.
    pub a1: Vec3,
    /// Second lattice vector, deformed.
    pub a2: Vec3,
    /// How images are turned; `None` for a flat sheet, whose images are translations.
    pub roll: Option<Roll>,
}

impl State {
    /// The lattice vector of `shift`: in a flat sheet the translation of that image.
    pub fn translation(&self, shift: Shift) -> Vec3 {
        self.a1 * f64::from(shift[0]) + self.a2 * f64::from(shift[1])
    }
}
