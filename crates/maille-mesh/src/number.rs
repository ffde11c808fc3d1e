//! Numbers of the text formats: single precision, the fewest digits that read back.

use nalgebra::{Isometry3, Vector3};

/// Single precision, about 1e-7 of the number; what rounding left of a zero becomes one.
pub(super) fn single(x: f64) -> f32 {
    if x.abs() < 1e-9 { 0.0 } else { x as f32 }
}

/// A vector in single precision.
pub(super) fn singles(v: &Vector3<f64>) -> [f32; 3] {
    [single(v.x), single(v.y), single(v.z)]
}

/// The rotation as `[x, y, z, w]`, as glTF has it.
pub(super) fn quaternion(pose: &Isometry3<f64>) -> [f32; 4] {
    let q = pose.rotation.coords;
    [single(q.x), single(q.y), single(q.z), single(q.w)]
}
