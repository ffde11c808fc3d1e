//! A limit's state in which all chains that could carry are straight.
//!
//! Chains can be taut at once, and the recorded forces are one choice of many. A chain without force in this choice is closed, but may
//! zigzag: a sideways shift δ shortens it by δ² only, far below the tolerance of l1 where δ is 1e-4. The normals of its contacts are then
//! off by δ, and its forces balance to δ instead of to rounding. Newton's method with forces in all such chains straightens them.

use crate::{
    program::{Posed, SheetProgram},
    solver::{
        constraints::{Derivatives, Multiplier, Row, violation},
        polish,
        qp::{self, QuadraticProgram, SparseRows},
        sqp::Program,
        symmetric::Symmetric,
    },
};

/// Residual of the balance that weighs as much as a force of 1: above what a zigzag leaves, below what a chain that does not pull along
/// leaves.
const NEARLY: f64 = 1e-2;
/// Forces above this share of the largest straighten.
const CARRIES: f64 = 1e-2;
/// The residual of their balance may be this large.
const MOST_LEFT: f64 = 1e-3;
/// The straightened state may overlap and lose by this much.
const TOLERANCE: f64 = 1e-12;
const MOST_LOSS: f64 = 1e-9;

/// The state near `at` in which all its closed `rows` that can carry balance; `None` where those with `forces` are all of them.
pub(super) fn straightened(program: &SheetProgram<'_>, at: &Posed, rows: &[Row], forces: &[f64]) -> Option<Posed> {
    let c = program.objective();
    let spread = spread(rows, &c)?;
    let most = spread.iter().copied().fold(0.0, f64::max);
    let carries = |k: usize| spread[k] > CARRIES * most;
    let more = (0..rows.len()).any(|k| carries(k) && forces.get(k).is_none_or(|force| *force == 0.0));
    if !more {
        return None;
    }
    let active: Vec<Multiplier> =
        (0..rows.len()).filter(|k| carries(*k)).map(|k| rows[k].multiplier(spread[k])).collect();
    let straight = polish::balanced(program, at.clone(), active);
    let overlap = violation(&program.rows(&straight, TOLERANCE, Derivatives::None));
    let loss = program.value(at) - program.value(&straight);
    (overlap <= TOLERANCE && loss.abs() <= MOST_LOSS).then_some(straight)
}

/// Forces on all rows that nearly balance, spread over as many rows as possible: those of least ½ |μ|² + ½ |c + Σ μ ∇g|²/t², μ ≥ 0.
fn spread(rows: &[Row], c: &[f64]) -> Option<Vec<f64>> {
    let count = rows.len();
    let all: Vec<usize> = (0..count).collect();
    let mut dense = vec![vec![0.0; c.len()]; count];
    for (row, dense) in rows.iter().zip(&mut dense) {
        row.columns.iter().zip(&row.gradient).for_each(|(&i, slope)| dense[i] += slope);
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut hessian = Symmetric::new(count, [&all[..]]);
    hessian.add(&all, |i, j| dot(&dense[i], &dense[j]) + if i == j { NEARLY * NEARLY } else { 0.0 });
    let linear: Vec<f64> = dense.iter().map(|row| dot(row, c)).collect();
    let mut positive = SparseRows::default();
    all.iter().for_each(|&k| positive.push([(k, 1.0)]));
    let found = qp::solve(&QuadraticProgram {
        hessian: &hessian,
        linear: &linear,
        rows: &positive,
        lower: &vec![0.0; count],
        half_width: &vec![1e3; count],
    });
    let mut left = c.to_vec();
    for (row, mu) in dense.iter().zip(&found.x) {
        left.iter_mut().zip(row).for_each(|(left, slope)| *left += mu * slope);
    }
    let balanced = left.iter().all(|x| x.abs() <= MOST_LEFT);
    balanced.then_some(found.x)
}
