//! All multipliers that balance: {μ ≥ 0: c + Σ μ ∇g = 0} over the closed rows.
//!
//! With one solution μ⁰ and a basis Z of the combinations Σ z ∇g = 0 they are μ⁰ + Z y ≥ 0. Where there is no such combination
//! they are unique. Else the least Σ μ b over them is a linear program in y, of as many unknowns as Z has columns.

use crate::solver::{
    constraints::Row,
    qp::{self, QuadraticProgram, SparseRows},
    symmetric::Symmetric,
};
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// Singular values below this share of the largest are 0.
const DEPENDENT: f64 = 1e-8;
/// Entries of Z below this are 0: their rows have one multiplier.
const FIXED: f64 = 1e-7;
/// Multipliers may be negative by this in the linear program, which then has an interior.
const SLACK: f64 = 1e-10;
/// The box of y, in units of 1 + Σ μ⁰. A solution at its side is unbounded.
const BOX: f64 = 1e2;
/// The linear program is solved to this, relative to its size.
const SOLVED: f64 = 1e-7;

/// The multipliers of a locked state.
pub(super) struct Multipliers {
    /// Those of the answer, 0 on closed rows that carry nothing.
    pub first: Vec<f64>,
    /// The closed rows.
    pub rows: Vec<Row>,
    unknowns: usize,
    /// Z, column by column, once it is asked for: it takes longer than all else here.
    basis: OnceLock<Vec<Vec<f64>>>,
}

/// The least of a linear program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Least {
    Value(f64),
    Unbounded,
    /// Rounding has kept it from being found.
    NotFound,
}

impl Multipliers {
    /// Of `rows` in `unknowns` unknowns, the first of which carry `forces`.
    pub fn new(rows: Vec<Row>, unknowns: usize, forces: impl IntoIterator<Item = f64>) -> Self {
        let mut first = vec![0.0; rows.len()];
        first.iter_mut().zip(forces).for_each(|(mu, force)| *mu = force);
        Multipliers { first, rows, unknowns, basis: OnceLock::new() }
    }

    fn basis(&self) -> &[Vec<f64>] {
        self.basis.get_or_init(|| {
            let count = self.rows.len();
            // Rows of zeros below, so that the decomposition has a right vector for each row of the program.
            let mut matrix = DMatrix::zeros(self.unknowns.max(count), count);
            for (k, row) in self.rows.iter().enumerate() {
                row.columns.iter().zip(&row.gradient).for_each(|(&i, slope)| matrix[(i, k)] += slope);
            }
            let decomposed = matrix.svd(false, true);
            let largest = decomposed.singular_values.iter().copied().fold(0.0, f64::max);
            let null = decomposed.singular_values.iter().enumerate().filter(|(_, s)| **s <= DEPENDENT * largest);
            let right = decomposed.v_t.iter();
            right.flat_map(|v| null.clone().map(|(k, _)| v.row(k).iter().copied().collect())).collect()
        })
    }

    /// Largest entry of c + Σ μ ∇g, with the first ones.
    pub fn residual(&self, c: &[f64]) -> f64 {
        let mut left = c.to_vec();
        for (row, mu) in self.rows.iter().zip(&self.first) {
            row.columns.iter().zip(&row.gradient).for_each(|(&i, slope)| left[i] += mu * slope);
        }
        left.iter().fold(0.0, |worst, x| worst.max(x.abs()))
    }

    /// Whether there are others than the first.
    pub fn unique(&self) -> bool {
        self.basis().is_empty()
    }

    /// Σ μ b with the first ones.
    pub fn first_sum(&self, b: &[f64]) -> f64 {
        self.first.iter().zip(b).map(|(mu, b)| mu * b).sum()
    }

    /// The least Σ μ b over all of them.
    pub fn least(&self, b: &[f64]) -> Least {
        let first = self.first_sum(b);
        let mut linear: Vec<f64> = self.basis().iter().map(|z| z.iter().zip(b).map(|(z, b)| z * b).sum()).collect();
        let scale = linear.iter().fold(0.0f64, |a, c| a.max(c.abs()));
        let size = b.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        // All of them give the same.
        if scale <= FIXED * size {
            return Least::Value(first);
        }
        linear.iter_mut().for_each(|c| *c /= scale);
        let (mut rows, mut lower) = (SparseRows::default(), Vec::new());
        for (k, mu) in self.first.iter().enumerate() {
            let entries: Vec<(usize, f64)> = self.basis().iter().map(|z| z[k]).enumerate().collect();
            if entries.iter().any(|(_, z)| z.abs() > FIXED) {
                rows.push(entries);
                lower.push(-mu.max(0.0) - SLACK);
            }
        }
        let most = BOX * (1.0 + self.first.iter().sum::<f64>());
        let dimension = self.basis().len();
        let found = qp::solve(&QuadraticProgram {
            hessian: &Symmetric::new(dimension, [&(0..dimension).collect::<Vec<_>>()[..]]),
            linear: &linear,
            rows: &rows,
            lower: &lower,
            half_width: &vec![most; dimension],
        });
        if found.residual > SOLVED {
            Least::NotFound
        } else if found.x.iter().any(|y| y.abs() > 0.9 * most) {
            Least::Unbounded
        } else {
            Least::Value(first + scale * found.x.iter().zip(&linear).map(|(y, c)| y * c).sum::<f64>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// p at most q1 and at most q2, both 0: the smaller of them is reached, so raising one alone does nothing and lowering it costs.
    #[test]
    fn the_smaller_of_two_bounds_has_a_kink() {
        let row = |key| Row { columns: vec![0], gradient: vec![-1.0], ..Row::value(key, 0.0, 0.0) };
        let multipliers = Multipliers::new(vec![row(0), row(1)], 1, [0.7, 0.3]);
        assert!(!multipliers.unique());
        for (b, least) in [([1.0, 0.0], 0.0), ([-1.0, 0.0], -1.0), ([1.0, 1.0], 1.0), ([1.0, -2.0], -2.0)] {
            let Least::Value(found) = multipliers.least(&b) else { panic!("{b:?}") };
            assert!((found - least).abs() < 1e-8, "{b:?}: {found}");
        }
    }

    /// A bound from each side, on an unknown that is not maximised: squeezed without a pull, it has no state if one of them closes.
    #[test]
    fn what_is_squeezed_has_no_state() {
        let row =
            |key, column, slope| Row { columns: vec![column], gradient: vec![slope], ..Row::value(key, 0.0, 0.0) };
        let rows = vec![row(0, 0, -1.0), row(1, 1, 1.0), row(2, 1, -1.0)];
        let multipliers = Multipliers::new(rows, 2, [1.0]);
        assert_eq!(multipliers.least(&[0.0, -1.0, 0.0]), Least::Unbounded);
        assert_eq!(multipliers.least(&[1.0, 0.0, 0.0]), Least::Value(1.0));
        assert!(matches!(multipliers.least(&[0.0, 1.0, 0.0]), Least::Value(x) if x.abs() < 1e-8));
    }
}
