//! The Hessian of the model made positive.

use super::{
    eigen::{block, coupled, least_eigenvalue, symmetric_eigen},
    rows::Row,
};
use faer::Mat;

/// H made positive: first by adding σ Σ ∇g ∇gᵀ / |∇g|² over the loaded rows, which changes nothing on the directions
/// that keep them, so that the model stays exact there; what is still negative is raised to `floor`.
pub fn convexified(mut h: Mat<f64>, rows: &[Row], multipliers: &[f64], floor: f64) -> Mat<f64> {
    let n = h.nrows();
    let Some(least) = least_eigenvalue(&h) else { return Mat::identity(n, n) };
    let sigma = 2.0 * (floor - least).max(0.0);
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
    raised(h, floor)
}

/// `h` with its eigenvalues raised to `floor`.
fn raised(h: Mat<f64>, floor: f64) -> Mat<f64> {
    let n = h.nrows();
    let of = coupled(&h);
    let mut positive = block(&h, &of);
    let Ok(mut eigen) = symmetric_eigen(&positive) else { return Mat::identity(n, n) };
    if eigen.values.first().is_some_and(|least| *least < floor) {
        for (k, value) in eigen.values.iter().enumerate() {
            let root = value.max(floor).sqrt();
            eigen.vectors.col_mut(k).iter_mut().for_each(|v| *v *= root);
        }
        positive = &eigen.vectors * eigen.vectors.transpose();
    }
    let mut out = Mat::zeros(n, n);
    (0..n).for_each(|i| out[(i, i)] = floor);
    for (q, &j) in of.iter().enumerate() {
        for (p, &i) in of.iter().enumerate() {
            out[(i, j)] = positive[(p, q)];
        }
    }
    out
}
