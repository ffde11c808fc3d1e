//! The Hessian of the model made positive.

use super::{cholesky::Cholesky, eigen::least_eigenvalue, rows::Row};
use faer::Mat;

/// Shares of [`raised`]'s diagonal that are tried one after the other; with the last one the matrix is positive.
const SHARES: [f64; 6] = [0.0, 0.0625, 0.125, 0.25, 0.5, 1.0];

/// H made positive: first by adding σ Σ ∇g ∇gᵀ / |∇g|² over the loaded rows, which changes nothing on the directions
/// that keep them, so that the model stays exact there; then by `floor` and, where that is not enough, by a part of
/// the diagonal that would make H dominant. That part follows the curvature of each unknown, and Cholesky's
/// factorisation tells when it is enough: far cheaper than eigenvalues.
pub fn convexified(mut h: Mat<f64>, rows: &[Row], multipliers: &[f64], floor: f64) -> Mat<f64> {
    let n = h.nrows();
    let off_diagonal = |i: usize| (0..n).filter(|&j| j != i).map(|j| h[(i, j)].abs()).sum::<f64>();
    let lack: Vec<f64> = (0..n).map(|i| (off_diagonal(i) - h[(i, i)]).max(0.0)).collect();
    let sigma = 2.0 * (floor - least_eigenvalue(&h)).max(0.0);
    if sigma > 0.0 {
        for (row, _) in rows.iter().zip(multipliers).filter(|(_, mu)| **mu > 1e-6) {
            let square: f64 = row.gradient.iter().map(|a| a * a).sum();
            let weight = sigma / square.max(1e-300);
            for (&i, &a) in row.columns.iter().zip(&row.gradient) {
                for (&j, &b) in row.columns.iter().zip(&row.gradient) {
                    h[(i, j)] += weight * a * b;
                }
            }
        }
    }
    raised(h, &lack, floor)
}

/// `h` + `floor` + the least share of the diagonal `lack` that makes it positive.
fn raised(mut h: Mat<f64>, lack: &[f64], floor: f64) -> Mat<f64> {
    let n = h.nrows();
    let mut factor = Cholesky::new(n);
    let mut added = 0.0;
    for share in SHARES {
        for (i, lack) in lack.iter().enumerate() {
            h[(i, i)] += (share - added) * lack;
        }
        added = share;
        let matrix = factor.matrix_mut();
        for (column, of) in matrix.chunks_exact_mut(n).zip(h.col_iter()) {
            column.iter_mut().zip(of.iter()).for_each(|(a, b)| *a = *b);
        }
        (0..n).for_each(|i| matrix[i * n + i] += 0.5 * floor);
        if factor.factor() {
            break;
        }
    }
    (0..n).for_each(|i| h[(i, i)] += floor);
    h
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::eigen::symmetric_eigen;

    /// Positive in any case; on the motions that keep a loaded row the curvature is H's, where that is positive.
    #[test]
    fn positive_and_exact_where_rows_are_kept() {
        let h = Mat::from_fn(3, 3, |i, j| [[-2.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 0.0]][i][j]);
        let row = Row { columns: vec![0], gradient: vec![3.0], ..Row::value(0, 0.0, 0.0) };
        let floor = 1e-3;
        let model = convexified(h.clone(), &[row], &[1.0], floor);
        assert!(symmetric_eigen(&model).unwrap().values[0] > 0.5 * floor);
        assert!((model[(1, 1)] - (1.0 + floor)).abs() < 1e-15 && (model[(2, 2)] - floor).abs() < 1e-15);
        // Without the row the negative curvature has to be made up for.
        let model = convexified(h, &[], &[], floor);
        assert!(symmetric_eigen(&model).unwrap().values[0] > 0.5 * floor);
    }
}
