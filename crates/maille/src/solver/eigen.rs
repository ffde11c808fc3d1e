//! Eigen-decomposition of a symmetric matrix, with every eigenpair checked.

use super::symmetric::Symmetric;
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
pub(crate) fn symmetric_eigen(h: &Mat<f64>) -> Result<Eigen, EigenFailure> {
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

/// Steps of Lanczos's method.
const LANCZOS_STEPS: usize = 16;

/// About the least eigenvalue of the symmetric matrix `h`, from above: that of h on a Krylov space.
pub(crate) fn least_eigenvalue(h: &Symmetric) -> f64 {
    let n = h.n();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    // A start that is orthogonal to no vector in particular.
    let mut v: Vec<f64> = (0..n).map(|k| (1.0 + k as f64).sin()).collect();
    let mut before = vec![0.0; n];
    let (mut norm, mut coupling) = (dot(&v, &v).sqrt(), 0.0);
    let mut tridiagonal: Vec<(f64, f64)> = Vec::with_capacity(LANCZOS_STEPS);
    for _ in 0..LANCZOS_STEPS.min(n) {
        if norm <= 1e-12 {
            break;
        }
        v.iter_mut().for_each(|x| *x /= norm);
        let mut next: Vec<f64> = before.iter().map(|x| -coupling * x).collect();
        h.add_times(1.0, &v, &mut next);
        let along = dot(&next, &v);
        next.iter_mut().zip(&v).for_each(|(a, b)| *a -= along * b);
        tridiagonal.push((along, coupling));
        (before, v) = (v, next);
        norm = dot(&v, &v).sqrt();
        coupling = norm;
    }
    // Bisection by the signs of the pivots of T − x.
    let size = tridiagonal.iter().map(|(a, b)| a.abs() + 2.0 * b).fold(0.0, f64::max);
    let (mut low, mut high) = (-size, size);
    while high - low > 1e-3 * size {
        let middle = 0.5 * (low + high);
        let mut pivot = 1.0;
        let negative = tridiagonal.iter().any(|(a, b)| {
            pivot = a - middle - b * b / pivot;
            pivot <= 0.0
        });
        if negative {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

impl Eigen {
    /// −Σ v_k (v_k·g) / max(|λ_k|, floor): Newton's step with every curvature made positive. Always descends.
    pub(crate) fn descent_step(&self, gradient: &[f64], floor: f64) -> Vec<f64> {
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
    pub(crate) fn lowest(&self) -> Vec<f64> {
        self.vectors.col(0).iter().copied().collect()
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
        let mut same = Symmetric::new(3, []);
        assert_eq!(least_eigenvalue(&same), 0.0);
        same.add(&[0, 1, 2], |i, j| h[(i, j)]);
        assert!((least_eigenvalue(&same) - (2.0 - 2f64.sqrt())).abs() < 0.01);
        let nan = Mat::from_fn(2, 2, |_, _| f64::NAN);
        assert!(symmetric_eigen(&nan).is_err());
    }
}
