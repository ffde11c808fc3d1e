//! A Hermitian form on the vectors that keep some complex rows: its eigenvalues and their vectors.

use faer::{Mat, Side, c64};

/// Rows count as dependent below this share of the largest eigenvalue of their Gram matrix.
const DEPENDENT: f64 = 1e-12;
/// An eigenpair is one if it misses by less than this share of the matrix.
const MISSED: f64 = 1e-10;

/// Eigenvalues of a form on a space, ascending, with their vectors.
pub struct Modes {
    /// Eigenvalues.
    pub values: Vec<f64>,
    /// Orthonormal vectors, in columns.
    pub vectors: Mat<c64>,
}

fn eigen(h: &Mat<c64>) -> Option<Modes> {
    let n = h.nrows();
    if n == 0 {
        // faer subtracts 1 from the size.
        return Some(Modes { values: Vec::new(), vectors: Mat::new() });
    }
    if !h.col_iter().all(|column| column.iter().all(|x| x.re.is_finite() && x.im.is_finite())) {
        return None;
    }
    let found = h.self_adjoint_eigen(Side::Lower).ok()?;
    let vectors = found.U().to_owned();
    let values: Vec<f64> = found.S().column_vector().iter().map(|x| x.re).collect();
    let scaled = Mat::from_fn(n, n, |i, k| vectors[(i, k)] * values[k]);
    let missed = (h * &vectors - scaled).norm_max();
    (missed <= MISSED * h.norm_max().max(f64::MIN_POSITIVE)).then_some(Modes { values, vectors })
}

/// The modes of `h` on the vectors u with r·u = 0 for each of `rows`; `None` where they could not be found.
pub(crate) fn kept_modes(h: &Mat<c64>, rows: &[Vec<c64>]) -> Option<Modes> {
    let n = h.nrows();
    let a = Mat::from_fn(rows.len(), n, |k, i| rows[k][i]);
    let gram = eigen(&(a.adjoint() * &a))?;
    let largest = gram.values.last().copied().unwrap_or(0.0).max(1e-300);
    let free: Vec<usize> = (0..n).filter(|&k| gram.values[k] < DEPENDENT * largest).collect();
    let basis = Mat::from_fn(n, free.len(), |i, k| gram.vectors[(i, free[k])]);
    let reduced = basis.adjoint() * h * &basis;
    let hermitian = Mat::from_fn(free.len(), free.len(), |i, j| (reduced[(i, j)] + reduced[(j, i)].conj()) * 0.5);
    let Modes { values, vectors } = eigen(&hermitian)?;
    Some(Modes { values, vectors: &basis * &vectors })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_modes() {
        let [one, i] = [c64::new(1.0, 0.0), c64::new(0.0, 1.0)];
        // 2 on the diagonal and a phase beside it: 2 ± |phase| and 5.
        let entry = |r: usize, c: usize| match (r, c) {
            (0, 1) => one * 0.6 + i * 0.8,
            (1, 0) => one * 0.6 - i * 0.8,
            (2, 2) => one * 5.0,
            (r, c) if r == c => one * 2.0,
            _ => one * 0.0,
        };
        let h = Mat::from_fn(3, 3, entry);
        let values = |rows: &[Vec<c64>]| kept_modes(&h, rows).unwrap().values;
        let near = |found: &[f64], known: &[f64]| {
            assert_eq!(found.len(), known.len());
            assert!(found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?} {known:?}");
        };
        near(&values(&[]), &[1.0, 3.0, 5.0]);
        // u₀ = i u₁: what is left is 2 + Re of the phase turned by i, on a unit vector.
        let row = vec![one, -i, one * 0.0];
        near(&values(std::slice::from_ref(&row)), &[2.0 + 0.8, 5.0]);
        near(&values(&[row.clone(), row.clone(), vec![one * 0.0, one * 0.0, one]]), &[2.8]);
        let modes = kept_modes(&h, &[row]).unwrap();
        let u = modes.vectors.col(0);
        assert!((u[0] - i * u[1]).norm() < 1e-13 && (u[0].norm() - 0.5f64.sqrt()).abs() < 1e-13);
        assert!(kept_modes(&Mat::new(), &[]).unwrap().values.is_empty());
        assert!(kept_modes(&Mat::from_fn(1, 1, |_, _| one * f64::NAN), &[]).is_none());
    }
}
