//! The figures that certify a limit.
//!
//! At a maximum of c·y under rows g ≥ 0 there are multipliers μ ≥ 0 with c + Σ μ ∇g = 0 and μ g = 0; it is strict to
//! second order where −Σ μ ∇²g is positive on the directions that keep the loaded rows.

use super::{
    constraints::{Derivatives, Loads, Multiplier, Row, lagrangian_hessian},
    kkt_system::{gram, least_squares_multipliers},
    qp::{self, QuadraticProgram, SparseRows},
    reduced_hessian::curvature,
    sqp::Program,
};

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
pub(crate) const GAP_TOLERANCE: f64 = 1e-12;
/// Residuals of a certified limit.
pub(crate) const RESIDUAL_TOLERANCE: f64 = 1e-9;
/// Overlaps below this can be cleared by what carries nothing, see the polish.
const ALMOST: f64 = 0.03;

/// A contact carries where its force for a unit pull is above this: what a record lists, and what counts for the curvature.
pub(crate) const CARRIED: f64 = 1e-9;
/// What the motions whose curvature counts must keep: contacts that carry more.
pub(crate) const LOADED: f64 = 1e-8;
/// Share of the largest multiplier above which one found with a sign counts.
const CARRIES: f64 = 1e-8;

/// Rows within this gap are looked at.
pub(crate) const BAND: f64 = 1e-2;

impl Certificate {
    /// Whether every condition holds to its tolerance.
    pub fn holds(&self) -> bool {
        self.holds_to_first_order() && self.min_curvature.is_none_or(|c| c > 0.0)
    }

    /// Whether all but the curvature holds.
    pub(crate) fn holds_to_first_order(&self) -> bool {
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

/// Indices of the rows that `loads` name, with their multipliers.
pub(super) fn matched(rows: &[Row], loads: &Loads) -> Vec<(usize, f64)> {
    loads.of(rows).into_iter().enumerate().filter(|(_, mu)| *mu != 0.0).collect()
}

pub(super) fn labelled(rows: &[Row], multipliers: &[f64]) -> Vec<Multiplier> {
    rows.iter().zip(multipliers).map(|(row, &value)| row.multiplier(value)).collect()
}

/// Multipliers ≥ 0 with the least |c + Σ μ ∇g|² + `ridge` |μ|², for dependent rows whose minimum-norm multipliers have wrong signs.
pub(super) fn non_negative_multipliers(c: &[f64], rows: &[Row], most: f64, ridge: f64) -> Vec<f64> {
    let m = rows.len();
    let mut hessian = gram(c.len(), rows);
    (0..m).for_each(|k| hessian.add_to_diagonal(k, ridge));
    let along = |row: &Row| row.columns.iter().zip(&row.gradient).map(|(&i, a)| a * c[i]).sum();
    let linear: Vec<f64> = rows.iter().map(along).collect();
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

pub(super) fn dual_residual(c: &[f64], rows: &[Row], multipliers: &[f64]) -> f64 {
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
pub(crate) fn certify<P: Program>(program: &P, x: &P::Point, active: &[Multiplier]) -> Certificate {
    let rows = program.rows(x, BAND, Derivatives::First);
    let chosen: Vec<Row> = matched(&rows, &Loads::new(active)).iter().map(|(k, _)| rows[*k].clone()).collect();
    let smallest_gap = program.rows(x, 0.0, Derivatives::None).iter().map(|r| r.gap).fold(0.0, f64::min);
    first_order(&program.objective(), &chosen, smallest_gap)
}

/// The figures of first order from true gaps, which are what a certificate claims: where the program solves by stricter rows,
/// forces are sought on closed points instead.
pub(crate) fn measure_gaps<P: Program>(program: &P, x: &P::Point, certificate: &mut Certificate) {
    if let Some(rows) = program.closed_rows(x, BAND, &Loads::new(&certificate.multipliers)) {
        let (min_curvature, zero_modes) = (certificate.min_curvature, certificate.zero_modes);
        let by_gaps = first_order(&program.objective(), &rows, certificate.smallest_gap);
        *certificate = Certificate { min_curvature, zero_modes, ..by_gaps };
    }
}

/// The figures of first order with the best multipliers of `chosen`.
fn first_order(c: &[f64], chosen: &[Row], smallest_gap: f64) -> Certificate {
    // Least squares first: exact to rounding. Where signs are wrong, the constrained ones, made exact where they carry.
    let mut multipliers = least_squares_multipliers(c, chosen);
    let least = |mu: &[f64]| mu.iter().copied().fold(f64::INFINITY, f64::min);
    if least(&multipliers) < -RESIDUAL_TOLERANCE {
        let most = multipliers.iter().fold(0.0f64, |a, m| a.max(m.abs()));
        let signed = non_negative_multipliers(c, chosen, most, 1e-13);
        let carrying: Vec<usize> = (0..chosen.len()).filter(|&k| signed[k] > CARRIES * most).collect();
        let rows: Vec<Row> = carrying.iter().map(|&k| chosen[k].clone()).collect();
        let mut exact = vec![0.0; chosen.len()];
        carrying.iter().zip(least_squares_multipliers(c, &rows)).for_each(|(&k, mu)| exact[k] = mu);
        let better = [exact, signed]
            .into_iter()
            .find(|mu| least(mu) >= -RESIDUAL_TOLERANCE && dual_residual(c, chosen, mu) <= RESIDUAL_TOLERANCE);
        multipliers = better.unwrap_or(multipliers);
    }
    figures(c, chosen, &multipliers, smallest_gap)
}

/// The figures of first order with these multipliers.
pub(super) fn figures(c: &[f64], chosen: &[Row], multipliers: &[f64], smallest_gap: f64) -> Certificate {
    Certificate {
        smallest_gap,
        dual_residual: dual_residual(c, chosen, multipliers),
        complementarity: chosen.iter().zip(multipliers).map(|(r, mu)| (r.gap * mu).abs()).fold(0.0, f64::max),
        min_multiplier: multipliers.iter().copied().fold(f64::INFINITY, f64::min),
        min_curvature: Some(f64::NAN),
        zero_modes: 0,
        multipliers: labelled(chosen, multipliers),
    }
}

/// Adds the curvature's figures to a certificate of the point `x`, unless it has them.
pub(crate) fn measure_curvature<P: Program>(program: &P, x: &P::Point, certificate: &mut Certificate) {
    if !certificate.min_curvature.is_some_and(f64::is_nan) {
        return;
    }
    let n = program.objective().len();
    let loads = Loads::new(&certificate.multipliers);
    let rows = program.rows(x, BAND, Derivatives::Second(&loads));
    let (chosen, multipliers): (Vec<&Row>, Vec<f64>) =
        matched(&rows, &loads).into_iter().filter(|(_, mu)| *mu > CARRIED).map(|(k, mu)| (&rows[k], mu)).unzip();
    let hidden = program.hidden_curvature(x, &certificate.multipliers);
    let moves = |v: &Vec<f64>| (0..n).filter(|&i| v[i] != 0.0).collect();
    let places: Vec<Vec<usize>> = hidden.iter().map(moves).collect();
    let more: Vec<&[usize]> = places.iter().map(|at| &at[..]).collect();
    let mut hessian = lagrangian_hessian(n, chosen.iter().copied(), &multipliers, &more);
    for (v, at) in hidden.iter().zip(&places) {
        hessian.add(at, |p, q| -v[at[p]] * v[at[q]]);
    }
    let loaded: Vec<&Row> =
        chosen.into_iter().zip(&multipliers).filter(|(_, mu)| **mu > LOADED).map(|(r, _)| r).collect();
    (certificate.min_curvature, certificate.zero_modes) = curvature(&hessian, &loaded);
}
