//! Eigen-decomposition of a symmetric matrix, with every eigenpair checked.

use faer::{Mat, Side};
use thiserror::Error;

/// An eigenpair that a decision would rest on is not one.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the eigen-decomposition failed: residual {residual:e} of a matrix of size {norm:e}")]
pub struct EigenFailure {
    /// Largest |H v − λ v|.
    pub residual: f64,
    /// Largest |H| entry.
    pub norm: f64,
}

/// λ_k ascending with orthonormal v_k as the columns of `vectors`.
#[derive(Clone, Debug)]
pub struct Eigen {
    /// Eigenvalues, ascending.
    pub values: Vec<f64>,
    /// Eigenvectors, in columns.
    pub vectors: Mat<f64>,
}

/// Decomposes the symmetric matrix `h` and checks max |H v − λ v| ≤ 1e-10 max |H| for every pair.
pub fn symmetric_eigen(h: &Mat<f64>) -> Result<Eigen, EigenFailure> {
    if h.nrows() == 0 {
        // faer subtracts 1 from the size.
        return Ok(Eigen { values: Vec::new(), vectors: Mat::new() });
    }
    let norm = h.norm_max();
    // The maximum skips NaN, so every entry is looked at.
    if !h.col_iter().all(|column| column.iter().all(|x| x.is_finite())) {
        return Err(EigenFailure { residual: f64::NAN, norm: f64::NAN });
    }
    let eigen = h.self_adjoint_eigen(Side::Lower).map_err(|_| EigenFailure { residual: f64::NAN, norm })?;
    let vectors = eigen.U().to_owned();
    let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
    let scaled = Mat::from_fn(h.nrows(), h.nrows(), |i, k| vectors[(i, k)] * values[k]);
    let residual = (h * &vectors - scaled).norm_max();
    if residual > 1e-10 * norm.max(f64::MIN_POSITIVE) {
        return Err(EigenFailure { residual, norm });
    }
    Ok(Eigen { values, vectors })
}

/// Least eigenvalue of the symmetric matrix `h`, unchecked; `None` where the decomposition fails.
pub fn least_eigenvalue(h: &Mat<f64>) -> Option<f64> {
    let of = coupled(h);
    if of.is_empty() {
        return Some(0.0);
    }
    let values = block(h, &of).self_adjoint_eigenvalues(Side::Lower).ok()?;
    // Unknowns that nothing couples have the eigenvalue 0.
    let zero = (of.len() < h.ncols()).then_some(0.0);
    values.into_iter().chain(zero).reduce(f64::min).filter(|least| least.is_finite())
}

/// Indices of the unknowns that the symmetric matrix `h` couples with anything, themselves included. Elements that carry
/// nothing have none: decompositions leave them out.
pub fn coupled(h: &Mat<f64>) -> Vec<usize> {
    (0..h.ncols()).filter(|&j| h.col(j).iter().any(|v| *v != 0.0)).collect()
}

/// The rows and columns `of` of a matrix.
pub fn block(h: &Mat<f64>, of: &[usize]) -> Mat<f64> {
    Mat::from_fn(of.len(), of.len(), |i, j| h[(of[i], of[j])])
}

impl Eigen {
    /// −Σ v_k (v_k·g) / max(|λ_k|, floor): Newton's step with every curvature made positive. Always descends.
    pub fn descent_step(&self, gradient: &[f64], floor: f64) -> Vec<f64> {
        let n = gradient.len();
        let mut step = vec![0.0; n];
        for k in 0..n {
            let v = self.vectors.col(k);
            let along: f64 = (0..n).map(|i| v[i] * gradient[i]).sum();
            let scale = along / self.values[k].abs().max(floor);
            for i in 0..n {
                step[i] -= scale * v[i];
            }
        }
        step
    }

    /// The eigenvector of the least eigenvalue.
    pub fn lowest(&self) -> Vec<f64> {
        self.vectors.col(0).iter().copied().collect()
    }
}

/// Minimum-norm least-squares solutions of a symmetric system.
pub(super) struct LeastNorm {
    /// The unknowns that the system couples; the others are 0.
    coupled: Vec<usize>,
    eigen: Option<Eigen>,
}

impl LeastNorm {
    pub(super) fn new(system: &Mat<f64>) -> Self {
        let coupled = coupled(system);
        let eigen = symmetric_eigen(&block(system, &coupled)).ok();
        LeastNorm { coupled, eigen }
    }

    /// The solution where eigenvalues below `cut` times the largest count as zero.
    pub(super) fn solve(&self, right: &[f64], cut: f64) -> Vec<f64> {
        let Some(eigen) = &self.eigen else { return vec![f64::NAN; right.len()] };
        let largest = eigen.values.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let mut out = vec![0.0; right.len()];
        for (k, value) in eigen.values.iter().enumerate().filter(|(_, v)| v.abs() > cut * largest) {
            let v = || eigen.vectors.col(k).iter().zip(&self.coupled);
            let along: f64 = v().map(|(v, &i)| v * right[i]).sum::<f64>() / value;
            v().for_each(|(v, &i)| out[i] += along * v);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_spectrum() {
        let h = Mat::from_fn(3, 3, |i, j| [[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]][i][j]);
        let eigen = symmetric_eigen(&h).unwrap();
        for (value, expected) in eigen.values.iter().zip([2.0 - 2f64.sqrt(), 2.0, 2.0 + 2f64.sqrt()]) {
            assert!((value - expected).abs() < 1e-14);
        }
        assert!(symmetric_eigen(&Mat::zeros(0, 0)).unwrap().values.is_empty());
        assert_eq!(least_eigenvalue(&Mat::zeros(3, 3)), Some(0.0));
        let nan = Mat::from_fn(2, 2, |_, _| f64::NAN);
        assert!(symmetric_eigen(&nan).is_err());
    }
}
