//! The figures that certify a limit.
//!
//! At a maximum of c·y under rows g ≥ 0 there are multipliers μ ≥ 0 with c + Σ μ ∇g = 0 and μ g = 0; it is strict to
//! second order where −Σ μ ∇²g is positive on the directions that keep the loaded rows.

use super::{
    eigen::{block, symmetric_eigen},
    qp::{self, QuadraticProgram, SparseRows},
    rows::{Derivatives, Multiplier, Row, lagrangian_hessian, multiplier_of},
    saddle::least_squares_multipliers,
    sqp::Program,
};
use faer::Mat;

/// What was found at a polished point.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// Least true gap, at most 0 (where everything touches or clears, 0).
    pub smallest_gap: f64,
    /// Largest entry of c + Σ μ ∇g.
    pub dual_residual: f64,
    /// Largest |μ g|.
    pub complementarity: f64,
    /// Least multiplier of a row that was taken as active.
    pub min_multiplier: f64,
    /// Least curvature of the Lagrangian on the null space of the loaded rows, zero modes left out; `None` where
    /// nothing but zero modes is left, NaN where it was not measured.
    pub min_curvature: Option<f64>,
    /// Directions of that null space without curvature: elements that rattle.
    pub zero_modes: usize,
    /// The multipliers.
    pub multipliers: Vec<Multiplier>,
}

/// Gaps may be negative by this, in units of the reference radius: rounding.
pub const GAP_TOLERANCE: f64 = 1e-12;
/// Residuals of a certified limit.
pub const RESIDUAL_TOLERANCE: f64 = 1e-9;
/// Overlaps below this can be cleared by what carries nothing, see the polish.
const ALMOST: f64 = 0.03;
/// Curvature below which a direction counts as a zero mode, relative to the largest curvature.
const ZERO_MODE: f64 = 1e-7;

/// Rows within this gap are looked at.
pub(super) const BAND: f64 = 1e-2;

impl Certificate {
    /// Whether every condition holds to its tolerance.
    pub fn holds(&self) -> bool {
        self.holds_to_first_order() && self.min_curvature.is_none_or(|c| c > 0.0)
    }

    /// Whether all but the curvature holds.
    pub(super) fn holds_to_first_order(&self) -> bool {
        self.smallest_gap >= -GAP_TOLERANCE && self.is_critical()
    }

    /// Whether all but the gaps hold, and those nearly.
    pub(super) fn lacks_only_room(&self) -> bool {
        (-ALMOST..-GAP_TOLERANCE).contains(&self.smallest_gap) && self.is_critical()
    }

    /// The smaller, the better.
    pub(super) fn score(&self) -> f64 {
        (-self.smallest_gap).max(self.dual_residual).max(-self.min_multiplier)
    }

    fn is_critical(&self) -> bool {
        self.dual_residual <= RESIDUAL_TOLERANCE
            && self.complementarity <= RESIDUAL_TOLERANCE
            && self.min_multiplier >= -RESIDUAL_TOLERANCE
    }
}

/// Indices of the rows that `active` names, with their multipliers.
pub(super) fn matched(rows: &[Row], active: &[Multiplier]) -> Vec<(usize, f64)> {
    rows.iter().enumerate().map(|(k, r)| (k, multiplier_of(r, active))).filter(|(_, mu)| *mu != 0.0).collect()
}

pub(super) fn labelled(rows: &[Row], multipliers: &[f64]) -> Vec<Multiplier> {
    let pairs = rows.iter().zip(multipliers);
    pairs.map(|(r, &value)| Multiplier { key: r.key, angle: r.angle, minimum: r.minimum, value }).collect()
}

/// Multipliers ≥ 0 with the least |c + Σ μ ∇g|, for dependent rows whose minimum-norm multipliers have wrong signs.
fn non_negative_multipliers(c: &[f64], rows: &[Row], most: f64) -> Vec<f64> {
    let m = rows.len();
    let n = c.len();
    let gradient = |k: usize| {
        let mut dense = vec![0.0; n];
        for (&column, &value) in rows[k].columns.iter().zip(&rows[k].gradient) {
            dense[column] += value;
        }
        dense
    };
    let gradients: Vec<Vec<f64>> = (0..m).map(gradient).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let hessian = Mat::from_fn(m, m, |i, j| dot(&gradients[i], &gradients[j]) + if i == j { 1e-13 } else { 0.0 });
    let linear: Vec<f64> = gradients.iter().map(|g| dot(g, c)).collect();
    let mut identity = SparseRows::default();
    (0..m).for_each(|k| identity.push([(k, 1.0)]));
    let half_width = vec![10.0 * most + 1.0; m];
    let zeros = vec![0.0; m];
    qp::solve(&QuadraticProgram {
        hessian: &hessian,
        linear: &linear,
        rows: &identity,
        lower: &zeros,
        half_width: &half_width,
    })
    .x
    .iter()
    .map(|mu| mu.max(0.0))
    .collect()
}

fn dual_residual(c: &[f64], rows: &[Row], multipliers: &[f64]) -> f64 {
    let mut residual = c.to_vec();
    for (row, mu) in rows.iter().zip(multipliers) {
        for (&column, &value) in row.columns.iter().zip(&row.gradient) {
            residual[column] += mu * value;
        }
    }
    residual.iter().fold(0.0, |a, r| a.max(r.abs()))
}

/// The figures at a point with the multipliers of its active rows, but for the curvature, which costs far more than the
/// others: see [`measure_curvature`].
pub(super) fn certify<P: Program>(program: &P, x: &P::Point, active: &[Multiplier]) -> Certificate {
    let c = &program.objective()[..];
    let rows = program.rows(x, BAND, Derivatives::First);
    let chosen_rows: Vec<Row> = matched(&rows, active).iter().map(|(k, _)| rows[*k].clone()).collect();
    // Least squares first: exact to rounding. Where signs are wrong, the constrained ones.
    let mut multipliers = least_squares_multipliers(c, &chosen_rows);
    let least = |mu: &[f64]| mu.iter().copied().fold(f64::INFINITY, f64::min);
    if least(&multipliers) < -RESIDUAL_TOLERANCE {
        let most = multipliers.iter().fold(0.0f64, |a, m| a.max(m.abs()));
        let signed = non_negative_multipliers(c, &chosen_rows, most);
        if dual_residual(c, &chosen_rows, &signed) <= RESIDUAL_TOLERANCE {
            multipliers = signed;
        }
    }
    Certificate {
        smallest_gap: program.rows(x, 0.0, Derivatives::None).iter().map(|r| r.gap).fold(0.0, f64::min),
        dual_residual: dual_residual(c, &chosen_rows, &multipliers),
        complementarity: chosen_rows.iter().zip(&multipliers).map(|(r, mu)| (r.gap * mu).abs()).fold(0.0, f64::max),
        min_multiplier: least(&multipliers),
        min_curvature: Some(f64::NAN),
        zero_modes: 0,
        multipliers: labelled(&chosen_rows, &multipliers),
    }
}

/// Adds the curvature's figures to a certificate of the point `x`, unless it has them.
pub fn measure_curvature<P: Program>(program: &P, x: &P::Point, certificate: &mut Certificate) {
    if !certificate.min_curvature.is_some_and(f64::is_nan) {
        return;
    }
    let n = program.objective().len();
    let rows = program.rows(x, BAND, Derivatives::Second(&certificate.multipliers));
    let (chosen, multipliers): (Vec<&Row>, Vec<f64>) =
        matched(&rows, &certificate.multipliers).into_iter().map(|(k, mu)| (&rows[k], mu)).unzip();
    let mut hessian = lagrangian_hessian(n, chosen.iter().copied(), &multipliers);
    for v in program.hidden_curvature(x, &certificate.multipliers) {
        for i in 0..n {
            for j in 0..n {
                hessian[(i, j)] -= v[i] * v[j];
            }
        }
    }
    let loaded: Vec<&Row> =
        chosen.into_iter().zip(&multipliers).filter(|(_, mu)| **mu > 1e-8).map(|(r, _)| r).collect();
    (certificate.min_curvature, certificate.zero_modes) = curvature(n, &hessian, &loaded);
}

/// Least non-zero curvature of `h` on the null space of `loaded`, and the number of its zero modes.
fn curvature(n: usize, h: &Mat<f64>, loaded: &[&Row]) -> (Option<f64>, usize) {
    let mut gram = Mat::zeros(n, n);
    for row in loaded {
        for (&i, &a) in row.columns.iter().zip(&row.gradient) {
            for (&j, &b) in row.columns.iter().zip(&row.gradient) {
                gram[(i, j)] += a * b;
            }
        }
    }
    // Unknowns that neither meets are zero modes.
    let met: Vec<usize> =
        (0..n).filter(|&j| [h, &gram].iter().any(|matrix| matrix.col(j).iter().any(|v| *v != 0.0))).collect();
    let idle = n - met.len();
    let Ok(eigen) = symmetric_eigen(&block(&gram, &met)) else { return (Some(f64::NAN), 0) };
    let largest = eigen.values.last().copied().unwrap_or(0.0).max(1e-300);
    let free: Vec<usize> = (0..met.len()).filter(|&k| eigen.values[k] < 1e-12 * largest).collect();
    let basis = Mat::from_fn(met.len(), free.len(), |i, k| eigen.vectors[(i, free[k])]);
    if free.is_empty() {
        return (None, idle);
    }
    let reduced = basis.transpose() * block(h, &met) * &basis;
    let symmetric = Mat::from_fn(free.len(), free.len(), |i, j| 0.5 * (reduced[(i, j)] + reduced[(j, i)]));
    let Ok(eigen) = symmetric_eigen(&symmetric) else { return (Some(f64::NAN), 0) };
    let scale = eigen.values.iter().fold(0.0f64, |a, v| a.max(v.abs())).max(1e-300);
    let is_zero = |v: &f64| v.abs() <= ZERO_MODE * scale.max(1.0);
    let zero_modes = idle + eigen.values.iter().filter(|v| is_zero(v)).count();
    (eigen.values.iter().copied().find(|v| !is_zero(v)), zero_modes)
}
