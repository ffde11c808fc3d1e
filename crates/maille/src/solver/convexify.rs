//! The Hessian of the model made positive.

use super::{cholesky::Cholesky, constraints::Row, eigen::least_eigenvalue, symmetric::Symmetric};

/// Shares of [`raised`]'s diagonal that are tried one after the other; with the last one the matrix is positive.
const SHARES: [f64; 6] = [0.0, 0.0625, 0.125, 0.25, 0.5, 1.0];

/// H made positive: first by adding σ Σ ∇g ∇gᵀ / |∇g|² over the loaded rows, which changes nothing on the directions
/// that keep them, so that the model stays exact there; then by `floor` and, where that is not enough, by a part of
/// the diagonal that would make H dominant. That part follows the curvature of each unknown, and Cholesky's
/// factorisation tells when it is enough: far cheaper than eigenvalues.
pub(crate) fn convexified(mut h: Symmetric, rows: &[Row], multipliers: &[f64], floor: f64) -> Symmetric {
    let off_diagonal = h.off_diagonal_sums();
    let lack: Vec<f64> = off_diagonal.iter().enumerate().map(|(i, sum)| (sum - h.diagonal(i)).max(0.0)).collect();
    let sigma = 2.0 * (floor - least_eigenvalue(&h)).max(0.0);
    if sigma > 0.0 {
        for (row, _) in rows.iter().zip(multipliers).filter(|(_, mu)| **mu > 1e-6) {
            let square: f64 = row.gradient.iter().map(|a| a * a).sum();
            let weight = sigma / square.max(1e-300);
            h.add(&row.columns, |p, q| weight * row.gradient[p] * row.gradient[q]);
        }
    }
    raised(h, &lack, floor)
}

/// `h` + `floor` + the least share of the diagonal `lack` that makes it positive.
fn raised(mut h: Symmetric, lack: &[f64], floor: f64) -> Symmetric {
    let mut factor = Cholesky::new(h.clone());
    let mut added = 0.0;
    for share in SHARES {
        for (i, lack) in lack.iter().enumerate() {
            h.add_to_diagonal(i, (share - added) * lack);
        }
        added = share;
        let matrix = factor.matrix_mut();
        matrix.set(&h);
        (0..h.n()).for_each(|i| matrix.add_to_diagonal(i, 0.5 * floor));
        if factor.factor() {
            break;
        }
    }
    (0..h.n()).for_each(|i| h.add_to_diagonal(i, floor));
    h
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::eigen::symmetric_eigen;

    /// Positive in any case; on the motions that keep a loaded row the curvature is H's, where that is positive.
    #[test]
    fn positive_and_exact_where_rows_are_kept() {
        let mut h = Symmetric::new(3, []);
        h.add(&[0, 1], |i, j| [[-2.0, 0.5], [0.5, 1.0]][i][j]);
        let lowest = |model: &Symmetric| symmetric_eigen(&model.block(&[0, 1, 2])).unwrap().values[0];
        let row = Row { columns: vec![0], gradient: vec![3.0], ..Row::value(0, 0.0, 0.0) };
        let floor = 1e-3;
        let model = convexified(h.clone(), &[row], &[1.0], floor);
        assert!(lowest(&model) > 0.5 * floor);
        assert!((model.diagonal(1) - (1.0 + floor)).abs() < 1e-15 && (model.diagonal(2) - floor).abs() < 1e-15);
        // Without the row the negative curvature has to be made up for.
        let model = convexified(h, &[], &[], floor);
        assert!(lowest(&model) > 0.5 * floor);
    }
}
