//! Rolled sheets: images under two commuting screw motions about one axis, see `docs/theory/roll.md`.
//!
//! With unit vectors u (rolled) and w (along the axis, to the left of u) in the plane, a lattice vector a with α = a·u and
//! β = a·w, and its turn θ about the axis, the image of a point x is
//!
//!   G(x) = R x + a + α (S − u),  R the rotation by θ about w,  S(θ) = ∫₀¹ (cos θs u − sin θs e_z) ds.
//!
//! Turns are linear in the lattice, θ = κ α at the rest length, so these motions form a group: their axis lies along w through
//! −(α/θ) e_z. Nothing cancels as θ → 0, where G is the translation by a. With W = R x, C_n = ∫ sⁿ cos θs, D_n = ∫ sⁿ sin θs:
//!
//!   ∂G/∂θ = w × W + α S′,  ∂²G/∂θ² = w × (w × W) + α S″,  ∂G/∂α = S,  ∂²G/∂α∂θ = S′,
//!   S = C₀ u − D₀ e_z,  S′ = −D₁ u − C₁ e_z,  S″ = −C₂ u + D₂ e_z,  |S| ≤ 1,  |S′| ≤ 1/2,  |S″| ≤ 1/3.

use crate::lattice::Cell;
use maille_geometry::Vec3;
use nalgebra::{Matrix2, UnitQuaternion, Vector2};

/// How a sheet is rolled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roll {
    /// u, the unit vector in the plane along which the sheet is rolled; the axis is along w, to its left.
    pub along: Vec3,
    /// Turn about the axis, along w, from a cell to the next along a1 and along a2.
    pub turn_rad: [f64; 2],
}

/// Turns below which the moments are summed as series: their closed forms lose digits by cancellation.
const SERIES_RAD: f64 = 1.0;
/// Terms of the series: the next one is below 1e-18 at [`SERIES_RAD`].
const TERMS: usize = 10;
/// Coefficients of θ²ᵏ in C_n, and of θ²ᵏ⁺¹ in D_n: (−1)ᵏ/((2k)! (2k + n + 1)) and (−1)ᵏ/((2k + 1)! (2k + n + 2)).
const SERIES: [[[f64; TERMS]; 3]; 2] = {
    let mut out = [[[0.0; TERMS]; 3]; 2];
    let (mut even, mut odd, mut k) = (1.0, 1.0, 0);
    while k < TERMS {
        let order = 2.0 * k as f64;
        let mut n = 0;
        while n < 3 {
            out[0][n][k] = even / (order + n as f64 + 1.0);
            out[1][n][k] = odd / (order + n as f64 + 2.0);
            n += 1;
        }
        even /= -(order + 1.0) * (order + 2.0);
        odd /= -(order + 2.0) * (order + 3.0);
        k += 1;
    }
    out
};

/// [C₀, C₁, C₂] and [D₀, D₁, D₂] of a turn.
pub(super) fn moments(turn_rad: f64) -> [[f64; 3]; 2] {
    if turn_rad.abs() < SERIES_RAD {
        let square = turn_rad * turn_rad;
        let sum = |terms: &[f64; TERMS]| terms.iter().rev().fold(0.0, |sum, term| sum * square + term);
        let [cosine, sine] = SERIES.each_ref().map(|of| of.each_ref().map(sum));
        return [cosine, sine.map(|sum| sum * turn_rad)];
    }
    let (sin, cos) = turn_rad.sin_cos();
    let (c0, d0) = (sin / turn_rad, (1.0 - cos) / turn_rad);
    let (c1, d1) = ((sin - d0) / turn_rad, (c0 - cos) / turn_rad);
    let (c2, d2) = ((sin - 2.0 * d1) / turn_rad, (2.0 * c1 - cos) / turn_rad);
    [[c0, c1, c2], [d0, d1, d2]]
}

impl Roll {
    /// u along `along`, not yet turned.
    pub fn flat(along: Vector2<f64>) -> Self {
        Roll { along: along.push(0.0), turn_rad: [0.0; 2] }
    }

    /// w, along the axis: to the left of u.
    pub fn axis(&self) -> Vec3 {
        Vec3::z().cross(&self.along)
    }

    /// Turn of the lattice vector with these coordinates.
    pub(crate) fn turn(&self, at: [f64; 2]) -> f64 {
        self.turn_rad[0] * at[0] + self.turn_rad[1] * at[1]
    }

    /// The same roll, known in the cell `of`, in the cell `to`.
    pub(crate) fn in_cell(self, of: Cell, to: Cell) -> Self {
        let [first, second] = self.turn_rad.map(|turn| Vec3::x() * turn);
        let [first, second] = of.primitive(first, second);
        Roll { turn_rad: to.vectors(first, second).map(|turn| turn.x), ..self }
    }

    /// Turn for each unit of length of the reference lattice along u: κ. Its turns may not vary across u.
    pub fn curvature(&self, reference_inverse: &Matrix2<f64>) -> f64 {
        (reference_inverse.transpose() * Vector2::from(self.turn_rad)).dot(&self.along.xy())
    }
}

/// The cylinder on which a rolled sheet's length is measured: at the mean distance of its elements' reference points from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeutralSurface {
    /// That distance, in R.
    pub radius: f64,
    /// Its length along u, as a share of the written sheet's.
    pub stretch: f64,
}

/// An element in one of its images, which follows a change of the lattice and of its turns: at the cell s, with the part c of the
/// lattice to which the element is anchored, it is G_{s+c}(q), and q stays.
pub struct Carried {
    /// Where it is.
    pub position: Vec3,
    pub(super) along: Vec3,
    pub(super) axis: Vec3,
    /// Turn of the cell s: what a motion of the element itself is turned by.
    pub(super) cell: UnitQuaternion<f64>,
    /// α of s + c.
    pub(crate) length: f64,
    /// R q.
    pub(crate) arm: Vec3,
    /// S − u, S′ and S″.
    pub(super) moments: [Vec3; 3],
}

impl Carried {
    /// A vector of the main cell as it is turned in this cell.
    pub fn turned(&self, vector: &Vec3) -> Vec3 {
        self.cell * vector
    }

    /// w × v.
    pub fn about_axis(&self, v: &Vec3) -> Vec3 {
        self.axis.cross(v)
    }

    /// Velocity where the lattice vector of s + c changes by `lattice` and its turn by `turn_rad`.
    pub fn rate(&self, lattice: &Vec3, turn_rad: f64) -> Vec3 {
        let [beside, first, _] = self.moments;
        let by_turn = self.axis.cross(&self.arm) + first * self.length;
        lattice + beside * lattice.dot(&self.along) + by_turn * turn_rad
    }

    /// Second derivative along two such changes.
    pub fn bend(&self, (lattice_m, turn_m): (&Vec3, f64), (lattice_n, turn_n): (&Vec3, f64)) -> Vec3 {
        let [_, first, second] = self.moments;
        let mixed = lattice_m.dot(&self.along) * turn_n + lattice_n.dot(&self.along) * turn_m;
        let turned = self.axis.cross(&self.axis.cross(&self.arm)) + second * self.length;
        first * mixed + turned * (turn_m * turn_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_integrals() {
        for turn in [-7.0, -3.1, -1.0 - 1e-12, -1.0 + 1e-12, -0.3, -1e-9, 0.0, 1e-5, 0.7, 0.999, 1.001, 2.0, 6.0f64] {
            // Simpson's rule on 2,000 pieces: its error is at most turn⁴ n⁻⁴/180, 8e-13.
            let n = 2000;
            let mut sums = [[0.0; 3]; 2];
            for k in 0..=n {
                let s = f64::from(k) / f64::from(n);
                let weight = if k == 0 || k == n { 1.0 } else { f64::from(2 + 2 * (k % 2)) } / f64::from(3 * n);
                for power in 0..3 {
                    sums[0][power] += weight * s.powi(power as i32) * (turn * s).cos();
                    sums[1][power] += weight * s.powi(power as i32) * (turn * s).sin();
                }
            }
            let found = moments(turn);
            for (a, b) in found.iter().flatten().zip(sums.iter().flatten()) {
                assert!((a - b).abs() < 1e-12, "{turn}: {found:?} {sums:?}");
            }
        }
    }
}
