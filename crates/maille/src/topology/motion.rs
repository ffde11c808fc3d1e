//! A step of a sheet, and what all bounds of steps share.

use crate::model::Model;
use maille_geometry::Vec3;

/// A step: translation and rotation vector of every element, and the change of the lattice vectors and of their turns.
#[derive(Default)]
pub(crate) struct Motion {
    /// (translation, rotation vector) of each element.
    pub elements: Vec<(Vec3, Vec3)>,
    /// Change of a1 and a2.
    pub lattice: [Vec3; 2],
    /// Change of the turns of a1 and a2, where the sheet is rolled.
    pub turn_rad: [f64; 2],
    /// Whether the lattice carries the elements along, each at its copy of the design's cell: translations are then what is left.
    pub carried: bool,
}

impl Motion {
    /// Where the lattice carries element `e` to.
    pub(crate) fn carries(&self, model: &Model, e: usize) -> Vec3 {
        let [u, v] = if self.carried { model.elements[e].anchor } else { [0.0; 2] };
        self.lattice[0] * u + self.lattice[1] * v
    }
}

/// Pairs up to this many largest radii apart bound a step one by one.
pub(crate) const MARGIN: f64 = 1.5;
/// Largest fraction of a pair's core distance that a step may use.
pub(super) const SAFETY: f64 = 0.9;

/// Largest |Δa1 s1 + Δa2 s2| / |a1 s1 + a2 s2|: the root of the larger eigenvalue of Gram(a)⁻¹ Gram(Δa), whatever the basis.
pub(super) fn largest_growth(lattice: [Vec3; 2], change: [Vec3; 2]) -> f64 {
    let gram = |[a, b]: [Vec3; 2]| (a.norm_squared(), a.dot(&b), b.norm_squared());
    let ((g11, g12, g22), (d11, d12, d22)) = (gram(lattice), gram(change));
    let det = g11 * g22 - g12 * g12;
    let half_trace = (g22 * d11 - 2.0 * g12 * d12 + g11 * d22) / (2.0 * det);
    let product = (d11 * d22 - d12 * d12) / det;
    (half_trace + (half_trace * half_trace - product).max(0.0).sqrt()).max(0.0).sqrt()
}
