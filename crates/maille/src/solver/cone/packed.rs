//! Symmetric 4×4 matrices as ten numbers, and their values by Jacobi rotations.

use nalgebra::Matrix4;

/// The upper triangle of a symmetric matrix, row by row, off-diagonals times √2: ⟨A, B⟩ = pack(A)·pack(B).
pub fn pack(m: &Matrix4<f64>) -> [f64; 10] {
    let mut out = [0.0; 10];
    let mut k = 0;
    for i in 0..4 {
        for j in i..4 {
            out[k] = if i == j { m[(i, i)] } else { std::f64::consts::FRAC_1_SQRT_2 * (m[(i, j)] + m[(j, i)]) };
            k += 1;
        }
    }
    out
}

/// The matrix that [`pack`] packed.
pub(super) fn unpack(v: &[f64]) -> Matrix4<f64> {
    let mut out = Matrix4::zeros();
    let mut k = 0;
    for i in 0..4 {
        for j in i..4 {
            let value = if i == j { v[k] } else { v[k] * std::f64::consts::FRAC_1_SQRT_2 };
            out[(i, j)] = value;
            out[(j, i)] = value;
            k += 1;
        }
    }
    out
}

/// Rows of the diagonal in a packed matrix.
pub(super) const DIAGONAL: [usize; 4] = [0, 4, 7, 9];

/// Singular values of a 4×4 matrix and its right singular vectors, by one-sided Jacobi rotations: accurate to the
/// last digits of small values too.
pub(super) fn singular(mut a: Matrix4<f64>) -> ([f64; 4], Matrix4<f64>) {
    let mut right = Matrix4::identity();
    for _sweep in 0..30 {
        let mut turned = false;
        for p in 0..3 {
            for q in p + 1..4 {
                let (pp, qq, pq) =
                    (a.column(p).norm_squared(), a.column(q).norm_squared(), a.column(p).dot(&a.column(q)));
                if pq.abs() <= 1e-16 * (pp * qq).sqrt() {
                    continue;
                }
                turned = true;
                let (c, s) = rotation(pp, qq, pq);
                for m in [&mut a, &mut right] {
                    rotate_columns(m, p, q, c, s);
                }
            }
        }
        if !turned {
            break;
        }
    }
    (std::array::from_fn(|k| a.column(k).norm()), right)
}

/// Eigenvalues of a symmetric 4×4 matrix by Jacobi rotations.
pub fn eigenvalues(mut a: Matrix4<f64>) -> [f64; 4] {
    let size = a.norm();
    for _sweep in 0..30 {
        let mut turned = false;
        for p in 0..3 {
            for q in p + 1..4 {
                if a[(p, q)].abs() <= 1e-17 * size {
                    continue;
                }
                turned = true;
                let (c, s) = rotation(a[(p, p)], a[(q, q)], a[(p, q)]);
                rotate_columns(&mut a, p, q, c, s);
                a.transpose_mut();
                rotate_columns(&mut a, p, q, c, s);
                a.transpose_mut();
            }
        }
        if !turned {
            break;
        }
    }
    std::array::from_fn(|k| a[(k, k)])
}

/// Cosine and sine of the rotation that makes [[pp, pq], [pq, qq]] diagonal.
fn rotation(pp: f64, qq: f64, pq: f64) -> (f64, f64) {
    let tau = (qq - pp) / (2.0 * pq);
    let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    (c, c * t)
}

fn rotate_columns(m: &mut Matrix4<f64>, p: usize, q: usize, c: f64, s: f64) {
    for i in 0..4 {
        let (x, y) = (m[(i, p)], m[(i, q)]);
        m[(i, p)] = c * x - s * y;
        m[(i, q)] = s * x + c * y;
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A positive semidefinite matrix.
    pub(in super::super) fn sample() -> Matrix4<f64> {
        let m = Matrix4::from_fn(|i, j| ((3 * i + 5 * j * j + 1) as f64).sin());
        m * m.transpose()
    }

    #[test]
    fn packing_keeps_the_inner_product() {
        let (a, b) = (sample(), Matrix4::from_diagonal_element(2.0) + sample() * 0.1);
        let (pa, pb) = (pack(&a), pack(&b));
        let dot: f64 = pa.iter().zip(&pb).map(|(x, y)| x * y).sum();
        assert!((dot - a.dot(&b)).abs() < 1e-13);
        assert!((unpack(&pa) - a).norm() < 1e-14);
    }

    #[test]
    fn jacobi_rotations_diagonalise() {
        let m = sample();
        let (values, right) = singular(m);
        assert!((right.transpose() * right - Matrix4::identity()).norm() < 1e-14);
        for k in 0..4 {
            assert!((m * right.column(k) - right.column(k) * values[k]).norm() < 1e-13, "symmetric: singular = eigen");
        }
        let mut eigen = eigenvalues(m);
        let mut values = values;
        eigen.sort_by(f64::total_cmp);
        values.sort_by(f64::total_cmp);
        (0..4).for_each(|k| assert!((eigen[k] - values[k]).abs() < 1e-13));
    }
}
