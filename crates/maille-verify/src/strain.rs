//! The deformation of a cell, and the row's figures that follow from it.
//!
//! With the lattice vectors of the state A′ and of the start A in columns, F = A′ A⁻¹, and D the direction of the pull,
//!
//! l1 = DᵀFD − 1,  l2 = D⊥ᵀFD⊥ − 1,  γ = DᵀFD⊥,  D⊥ᵀFD = 0,  λ = the eigenvalues of FᵀF.

use crate::{
    record::{Row, State},
    sheet::{Cell, Vec3, columns},
};
use nalgebra::{Matrix2, Vector2};

/// Figures of a row are those of its state within this, times the condition of the lattice.
pub(crate) const SAME: f64 = 1e-11;
/// Ranges of what is free are found with l1 less by 1e-6 of 1 + l1 (`free_slack` of the run).
const RANGE: f64 = 1e-6;

/// A vector lies across the pull if its part along it is at most this share of it: what rounding leaves of a direction in
/// degrees, up to 360°, that is turned into radians, and of two products.
pub(crate) const ACROSS: f64 = 16.0 * f64::EPSILON;

/// The direction of the pull and the one across it, to its left.
pub(crate) fn axes(direction_deg: f64) -> (Vector2<f64>, Vector2<f64>) {
    let (sin, cos) = direction_deg.to_radians().sin_cos();
    (Vector2::new(cos, sin), Vector2::new(-sin, cos))
}

/// F of the lattice `now` that was `then`.
pub(crate) fn gradient(now: [Vec3; 2], then: [Vec3; 2]) -> Option<Matrix2<f64>> {
    columns(then).try_inverse().map(|inverse| columns(now) * inverse)
}

/// Ratio of the largest to the least singular value of the lattice, at least.
fn condition(lattice: [Vec3; 2]) -> f64 {
    let m = columns(lattice);
    m.norm_squared() / m.determinant().abs()
}

/// Eigenvalues of a symmetric matrix, the larger one first.
fn eigenvalues(c: &Matrix2<f64>) -> [f64; 2] {
    let (mean, half) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, ((c[(0, 0)] - c[(1, 1)]) / 2.0).hypot(c[(0, 1)]));
    [mean + half, mean - half]
}

/// Compares the state's lattice with all that the row says of it; gives the largest difference, or what does not fit.
///
/// With the thesis's `corners` as targets, F is that of the middle of the cell's four corners, F (A1 + A2) = x4 − x1 for the
/// fourth corner x4, which no record has, and F (A1 − A2) = A1′ − A2′: the row is compared with the F that the state names, and that
/// with the lattice along the one diagonal.
pub(crate) fn deformation(
    row: &Row,
    state: &State,
    now: [Vec3; 2],
    then: [Vec3; 2],
    cell: &Cell,
    corners: bool,
) -> Result<f64, String> {
    let of_lattice = gradient(now, then).ok_or("the design's lattice vectors are parallel")?;
    let written = Matrix2::from(state.deformation_gradient).transpose();
    let f = if corners { written } else { of_lattice };
    let (d, side) = axes(row.direction_deg);
    let (l1, l2) = (d.dot(&(f * d)) - 1.0, side.dot(&(f * side)) - 1.0);
    let (shear, lean) = (d.dot(&(f * side)), side.dot(&(f * d)));
    let [largest_eigenvalue, least_eigenvalue] = eigenvalues(&(f.transpose() * f));
    let allowed = SAME * condition(then);
    let mut largest = 0.0_f64;
    let mut compare = |name: &str, written: Option<f64>, found: f64| {
        let Some(written) = written else { return Ok(()) };
        let off = (written - found).abs() / found.abs().max(1.0);
        largest = largest.max(off);
        let differs = || format!("{name} is {written:?} in limits.csv, {found:?} in the state");
        if off <= allowed { Ok(()) } else { Err(differs()) }
    };
    compare("l1", row.l1.or(row.l1_uncertified), l1)?;
    let free = |word: &Option<String>| word.as_deref() == Some("free");
    let exact = row.method == "exact";
    if exact {
        compare("the shear along the pull", Some(0.0), lean)?;
        if !free(&row.lateral) {
            compare("l2", Some(row.l2), l2)?;
        }
        if !free(&row.shear) {
            compare("the shear", Some(0.0), shear)?;
        }
    }
    compare("lambda1", row.lambda1, largest_eigenvalue)?;
    compare("lambda2", row.lambda2, least_eigenvalue)?;
    compare("stretch1", row.stretch1, largest_eigenvalue.sqrt())?;
    // A root near 0 has half of its square's digits.
    if least_eigenvalue > 1e-4 {
        compare("stretch2", row.stretch2, least_eigenvalue.sqrt())?;
    }
    if corners {
        let diagonal = columns(then) * Vector2::new(1.0, -1.0);
        let (written, found) = (written * diagonal, of_lattice * diagonal);
        for k in 0..2 {
            compare("deformation_gradient along a diagonal of the cell", Some(written[k]), found[k])?;
        }
    } else {
        for (written, found) in written.iter().zip(&of_lattice) {
            compare("an entry of deformation_gradient", Some(*written), *found)?;
        }
    }
    // The exact method keeps the lattice in its plane. The energy method leaves a little, which counts in C by its square.
    let z = now[0].z.abs().max(now[1].z.abs());
    compare("a lattice vector's z", Some(0.0), if exact { z } else { z * z })?;
    let m = Matrix2::from_fn(|i, j| f64::from(cell[j][i]));
    if let Some(inverse) = m.try_inverse() {
        let own = columns(now) * inverse;
        let written = [("a1_x", row.a1_x), ("a1_y", row.a1_y), ("a2_x", row.a2_x), ("a2_y", row.a2_y)];
        for (k, (name, written)) in written.into_iter().enumerate() {
            compare(name, written, own[(k % 2, k / 2)])?;
        }
    }
    let within = |name: &str, found: f64, [least, most]: [Option<f64>; 2]| match (least, most) {
        (Some(least), Some(most)) if !(least - RANGE..=most + RANGE).contains(&found) => {
            Err(format!("{name} of the state is {found:?}, not in [{least:?}, {most:?}]"))
        }
        _ => Ok(()),
    };
    if exact {
        within("l2", l2, [row.l2_min, row.l2_max])?;
        within("the shear", shear, [row.shear_min, row.shear_max])?;
    }
    Ok(largest)
}
