//! Optimality conditions of equality-constrained quadratic programs, where rows may be dependent and motions may have no
//! curvature: the solution of least norm.
//!
//! Proximal method of multipliers: [H + δ₁ −Aᵀ; A δ₂] is solved again and again for what is left of the right-hand side.
//! Each time a motion of curvature λ keeps δ₁/(λ + δ₁) of its error; what neither H nor A sees is never moved, and
//! multipliers stay combinations of the rows. One Cholesky factorisation of H + δ₁ + AᵀA/δ₂ serves all.

use super::{cholesky::Cholesky, constraints::Row, symmetric::Symmetric};

/// δ₂.
const DUAL: f64 = 1e-6;
/// Repetitions at most.
const REPETITIONS: usize = 12;

/// A d for rows A.
fn along(rows: &[Row], d: &[f64]) -> Vec<f64> {
    let dot = |row: &Row| row.columns.iter().zip(&row.gradient).map(|(&i, a)| a * d[i]).sum();
    rows.iter().map(dot).collect()
}

/// out += Aᵀ mu.
pub(super) fn add_combination(rows: &[Row], mu: &[f64], out: &mut [f64]) {
    for (row, mu) in rows.iter().zip(mu) {
        row.columns.iter().zip(&row.gradient).for_each(|(&i, a)| out[i] += a * mu);
    }
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |a, x| a.max(x.abs()))
}

/// d and μ with H d − Aᵀ μ = c and A d = −gap, least norm; `None` where H + `primal` is not positive on the motions that
/// keep the rows. `primal` is δ₁.
pub(super) fn solve(h: &Symmetric, rows: &[Row], c: &[f64], primal: f64) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, m) = (c.len(), rows.len());
    let mut matrix = Symmetric::around(h, n, rows.iter().map(|row| &row.columns[..]));
    for row in rows {
        matrix.add(&row.columns, |p, q| row.gradient[q] * row.gradient[p] / DUAL);
    }
    (0..n).for_each(|i| matrix.add_to_diagonal(i, primal));
    let mut system = Cholesky::new(matrix);
    if !system.factor() {
        return None;
    }
    let (mut d, mut mu) = (vec![0.0; n], vec![0.0; m]);
    let mut last = f64::INFINITY;
    for _ in 0..REPETITIONS {
        // What is left: p = c − H d + Aᵀ μ, q = −gap − A d.
        let mut left = c.to_vec();
        h.add_times(-1.0, &d, &mut left);
        add_combination(rows, &mu, &mut left);
        let short: Vec<f64> = along(rows, &d).iter().zip(rows).map(|(a, row)| -row.gap - a).collect();
        let size = largest(&left).max(largest(&short));
        if size < 1e-16 || size > 0.5 * last {
            break;
        }
        last = size;
        // (H + δ₁) Δd − Aᵀ Δμ = p, A Δd + δ₂ Δμ = q.
        let push: Vec<f64> = short.iter().map(|q| q / DUAL).collect();
        add_combination(rows, &push, &mut left);
        system.solve(&mut left);
        let reached = along(rows, &left);
        for k in 0..m {
            mu[k] += push[k] - reached[k] / DUAL;
        }
        d.iter_mut().zip(&left).for_each(|(d, step)| *d += step);
    }
    Some((d, mu))
}

/// A Aᵀ.
pub(super) fn gram(n: usize, rows: &[Row]) -> Symmetric {
    let mut meeting: Vec<Vec<usize>> = vec![Vec::new(); n];
    for (k, row) in rows.iter().enumerate() {
        row.columns.iter().for_each(|&i| meeting[i].push(k));
    }
    let mut matrix = Symmetric::new(rows.len(), meeting.iter().map(|of| &of[..]));
    let mut dense = vec![0.0; n];
    for (k, row) in rows.iter().enumerate() {
        row.columns.iter().zip(&row.gradient).for_each(|(&i, a)| dense[i] += a);
        let mut met: Vec<usize> = row.columns.iter().flat_map(|&i| meeting[i].iter().copied()).collect();
        met.retain(|other| *other >= k);
        met.sort_unstable();
        met.dedup();
        for other in met {
            let of = &rows[other];
            let product = of.columns.iter().zip(&of.gradient).map(|(&i, a)| a * dense[i]).sum();
            matrix.set_entry(other, k, product);
        }
        row.columns.iter().for_each(|&i| dense[i] = 0.0);
    }
    matrix
}

/// μ of least norm among those with the least |c + Aᵀ μ|: the same method on A Aᵀ.
pub(super) fn least_squares_multipliers(c: &[f64], rows: &[Row]) -> Vec<f64> {
    let m = rows.len();
    let mut matrix = gram(c.len(), rows);
    (0..m).for_each(|k| matrix.add_to_diagonal(k, 1e-9));
    let mut system = Cholesky::new(matrix);
    let mut mu = vec![0.0; m];
    if !system.factor() {
        return vec![f64::NAN; m];
    }
    let mut last = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let mut left = c.to_vec();
        add_combination(rows, &mu, &mut left);
        let mut step: Vec<f64> = along(rows, &left).iter().map(|x| -x).collect();
        let size = largest(&step);
        if size < 1e-17 || size > 0.5 * last {
            break;
        }
        last = size;
        system.solve(&mut step);
        mu.iter_mut().zip(&step).for_each(|(mu, step)| *mu += step);
    }
    mu
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(columns: &[usize], gradient: &[f64], gap: f64) -> Row {
        Row { columns: columns.to_vec(), gradient: gradient.to_vec(), ..Row::value(0, 0.0, gap) }
    }

    /// Curvature along x only, the same row along y twice, nothing along z: x = 1, y = −½, z stays, the multipliers share.
    #[test]
    fn dependent_rows_share_and_idle_motions_stay() {
        let mut h = Symmetric::new(3, []);
        h.add_to_diagonal(0, 1.0);
        let rows = [row(&[1], &[1.0], 0.5), row(&[1], &[1.0], 0.5)];
        let (d, mu) = solve(&h, &rows, &[1.0, -2.0, 0.0], 1e-6).unwrap();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(d[0], 1.0) && near(d[1], -0.5) && d[2] == 0.0, "{d:?}");
        // Shared to rounding over the small number that is added; their sum is exact.
        let shared = |mu: &[f64]| (mu[0] - mu[1]).abs() < 1e-6 && near(mu[0] + mu[1], 2.0);
        assert!(shared(&mu), "{mu:?}");
        let mu = least_squares_multipliers(&[0.0, -2.0, 0.0], &rows);
        assert!(shared(&mu), "{mu:?}");
    }

    /// Where the motions that keep the rows have negative curvature there is no minimum.
    #[test]
    fn a_saddle_is_refused() {
        let mut h = Symmetric::new(2, []);
        (0..2).for_each(|i| h.add_to_diagonal(i, 1.0 - 2.0 * i as f64));
        assert!(solve(&h, &[row(&[0], &[1.0], 0.0)], &[0.0, 0.0], 1e-6).is_none());
        assert!(solve(&h, &[row(&[1], &[1.0], 0.0)], &[0.0, 0.0], 1e-6).is_some());
    }
}
