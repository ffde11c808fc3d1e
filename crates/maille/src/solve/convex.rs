//! The Hessian of the model made positive.

use super::{
    eigen::{least_eigenvalue, symmetric_eigen},
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

/// `h` with its eigenvalues raised to `floor`. Unknowns that no entry couples (elements that carry nothing) are left
/// out of the decomposition: theirs are 0.
fn raised(mut h: Mat<f64>, floor: f64) -> Mat<f64> {
    let n = h.nrows();
    let coupled: Vec<usize> = (0..n).filter(|&j| h.col(j).iter().any(|v| *v != 0.0)).collect();
    let block = Mat::from_fn(coupled.len(), coupled.len(), |i, j| h[(coupled[i], coupled[j])]);
    let Ok(mut eigen) = symmetric_eigen(&block) else { return Mat::identity(n, n) };
    let mut out = Mat::zeros(n, n);
    (0..n).for_each(|i| out[(i, i)] = floor);
    if eigen.values.first().is_none_or(|least| *least >= floor) {
        coupled.iter().for_each(|&i| out[(i, i)] = 0.0);
        std::mem::swap(&mut h, &mut out);
        // Now `out` is the given matrix and `h` the floor on the unknowns that nothing couples.
        return out + h;
    }
    for (k, value) in eigen.values.iter().enumerate() {
        let root = value.max(floor).sqrt();
        eigen.vectors.col_mut(k).iter_mut().for_each(|v| *v *= root);
    }
    let positive = &eigen.vectors * eigen.vectors.transpose();
    for (q, &j) in coupled.iter().enumerate() {
        for (p, &i) in coupled.iter().enumerate() {
            out[(i, j)] = positive[(p, q)];
        }
    }
    out
}
