//! Forces of redundant contacts.
//!
//! Where contacts are redundant, many forces balance: {μ ≥ 0: c + Σ μ ∇g = 0}. Which of them a search ends with depends on how it came to the
//! point. Those of least Σ μ² over all closed rows do not, and those of a symmetric point are symmetric: an image of them balances, too,
//! and has the same norm, and the least norm is attained once.

use super::{
    certificate::{
        BAND, Certificate, RESIDUAL_TOLERANCE, dual_residual, figures, measure_curvature, non_negative_multipliers,
    },
    constraints::{Derivatives, Loads, Row},
    kkt_system::least_squares_multipliers,
    sqp::Program,
};

/// Closed rows within this gap can carry.
const CLOSED: f64 = 1e-9;
/// Weight of |μ|² where signs are sought, and shares of the largest multiplier above which one may carry.
const RIDGE: f64 = 1e-7;
const MAY_CARRY: [f64; 2] = [1e-4, 1e-6];

/// Gives a certificate that holds the multipliers of least norm. Where none are found, or it does not hold with them, all stays.
pub(crate) fn balance<P: Program>(program: &P, x: &P::Point, certificate: &mut Certificate) {
    let loads = Loads::new(&certificate.multipliers);
    // Rows of pairs that touch along their circles have the least norm already.
    if !certificate.holds() || program.closed_rows(x, BAND, &loads).is_some() {
        return;
    }
    let mut rows = program.rows(x, BAND, Derivatives::First);
    rows.retain(|row| row.gap.abs() <= CLOSED);
    let c = program.objective();
    let Some(multipliers) = least_norm_multipliers(&c, &rows) else { return };
    let known = loads.of(&rows);
    if multipliers.iter().zip(&known).all(|(new, old)| (new - old).abs() <= RESIDUAL_TOLERANCE) {
        return;
    }
    let (rows, multipliers): (Vec<Row>, Vec<f64>) =
        rows.into_iter().zip(multipliers).filter(|(_, mu)| *mu > 0.0).unzip();
    let mut balanced = figures(&c, &rows, &multipliers, certificate.smallest_gap);
    if balanced.holds_to_first_order() {
        measure_curvature(program, x, &mut balanced);
        if balanced.holds() {
            *certificate = balanced;
        }
    }
}

/// The multipliers ≥ 0 of least norm with c + Σ μ ∇g = 0; `None` where none are found.
fn least_norm_multipliers(c: &[f64], rows: &[Row]) -> Option<Vec<f64>> {
    let clean = |mut mu: Vec<f64>| {
        let signs = mu.iter().all(|mu| *mu >= -RESIDUAL_TOLERANCE);
        let balances = signs && dual_residual(c, rows, &mu) <= RESIDUAL_TOLERANCE;
        mu.iter_mut().for_each(|mu| *mu = mu.max(0.0));
        balances.then_some(mu)
    };
    let free = least_squares_multipliers(c, rows);
    let most = free.iter().fold(0.0f64, |a, m| a.max(m.abs()));
    clean(free).or_else(|| {
        let signed = non_negative_multipliers(c, rows, most, RIDGE);
        MAY_CARRY.into_iter().find_map(|share| {
            let carrying: Vec<usize> = (0..rows.len()).filter(|&k| signed[k] > share * most).collect();
            let kept: Vec<Row> = carrying.iter().map(|&k| rows[k].clone()).collect();
            let mut exact = vec![0.0; rows.len()];
            carrying.iter().zip(least_squares_multipliers(c, &kept)).for_each(|(&k, mu)| exact[k] = mu);
            clean(exact)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(key: u64, columns: &[usize], gradient: &[f64]) -> Row {
        Row { columns: columns.to_vec(), gradient: gradient.to_vec(), ..Row::value(key, 0.0, 0.0) }
    }

    /// Two equal rows share the pull; of three rows of which the one of least norm would pull, it carries nothing.
    #[test]
    fn redundant_rows_share_and_none_pulls() {
        let shared = least_norm_multipliers(&[1.0], &[row(0, &[0], &[-1.0]), row(1, &[0], &[-1.0])]).unwrap();
        assert!(shared.iter().all(|mu| (mu - 0.5).abs() < 1e-9), "{shared:?}");
        // μ0 + μ2 = 1, μ1 + 2 μ2 = 0.1: without signs the least norm has μ1 < 0.
        let rows = [row(0, &[0], &[-1.0]), row(1, &[1], &[-1.0]), row(2, &[0, 1], &[-1.0, -2.0])];
        let signed = least_norm_multipliers(&[1.0, 0.1], &rows).unwrap();
        for (mu, wanted) in signed.iter().zip([0.95, 0.0, 0.05]) {
            assert!((mu - wanted).abs() < 1e-9, "{signed:?}");
        }
        assert!(least_norm_multipliers(&[-1.0], &rows[..1]).is_none());
    }
}
