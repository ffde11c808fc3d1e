//! A small dense convex quadratic program by Mehrotra's predictor–corrector interior-point method.
//!
//!   minimise ½ xᵀ H x + cᵀ x   subject to   A x ≥ b,  −w ≤ x ≤ w
//!
//! H symmetric positive semidefinite; every x is boxed, so the program is feasible iff A x ≥ b meets the box, and the
//! caller keeps it so with an elastic unknown. Slacks are kept positive throughout; multipliers belong to A x ≥ b and
//! are non-negative. Tens of unknowns and up to hundreds of rows: each iteration forms H + Aᵀ diag(z/s) A and factors
//! it by Cholesky.

use faer::{Mat, Side, linalg::solvers::Solve, prelude::ReborrowMut};

/// The program's data; rows of A are stored one after the other.
pub struct QuadraticProgram<'a> {
    /// H.
    pub hessian: &'a Mat<f64>,
    /// c.
    pub linear: &'a [f64],
    /// A, row-major, b.len() × c.len().
    pub rows: &'a [f64],
    /// b.
    pub lower: &'a [f64],
    /// w > 0, finite.
    pub half_width: &'a [f64],
}

/// A solution with its multipliers and how well it is solved.
#[derive(Clone, Debug)]
pub struct QpSolution {
    /// x.
    pub x: Vec<f64>,
    /// Multipliers of A x ≥ b.
    pub multipliers: Vec<f64>,
    /// Largest of the scaled primal, dual and complementarity residuals.
    pub residual: f64,
    /// Interior-point iterations.
    pub iterations: usize,
}

const MAX_ITERATIONS: usize = 60;
const TOLERANCE: f64 = 1e-12;
/// Fraction of the way to the boundary that a step may take.
const TO_BOUNDARY: f64 = 0.995;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Largest step in (0, 1] that keeps v + step · dv ≥ 0.
fn to_boundary(v: &[f64], dv: &[f64]) -> f64 {
    v.iter().zip(dv).filter(|(_, d)| **d < 0.0).map(|(x, d)| -x / d).fold(1.0, f64::min)
}

/// Slacks and multipliers of the rows, the lower and the upper box sides, one after the other.
struct Cone {
    s: Vec<f64>,
    z: Vec<f64>,
}

impl Cone {
    fn gap(&self) -> f64 {
        dot(&self.s, &self.z) / self.s.len() as f64
    }
}

/// Solves the program. The residual says how far it came; at most 60 iterations.
pub fn solve(program: &QuadraticProgram<'_>) -> QpSolution {
    let (n, m) = (program.linear.len(), program.lower.len());
    let row = |k: usize| &program.rows[k * n..(k + 1) * n];
    let scale = 1.0 + program.linear.iter().fold(0.0f64, |a, c| a.max(c.abs()));
    let mut x = vec![0.0; n];
    let mut cone = Cone { s: vec![0.0; m + 2 * n], z: vec![0.0; m + 2 * n] };
    for k in 0..m {
        cone.s[k] = (-program.lower[k]).max(1e-2);
        cone.z[k] = 1e-2 * scale / cone.s[k].max(1e-1);
    }
    for i in 0..n {
        for side in [m + i, m + n + i] {
            cone.s[side] = program.half_width[i];
            cone.z[side] = 1e-2 * scale / cone.s[side].max(1e-1);
        }
    }
    let mut best = QpSolution { x: x.clone(), multipliers: vec![0.0; m], residual: f64::INFINITY, iterations: 0 };
    let mut system = Mat::<f64>::zeros(n, n);
    for iteration in 0..MAX_ITERATIONS {
        // Residuals: dual H x + c − Aᵀ z_A − z_low + z_up; primal A x − b − s. The box slacks stay exact.
        let mut dual: Vec<f64> = (0..n)
            .map(|i| {
                program.linear[i] + (0..n).map(|j| program.hessian[(i, j)] * x[j]).sum::<f64>() - cone.z[m + i]
                    + cone.z[m + n + i]
            })
            .collect();
        let mut primal = vec![0.0; m];
        for k in 0..m {
            let a = row(k);
            primal[k] = dot(a, &x) - program.lower[k] - cone.s[k];
            for i in 0..n {
                dual[i] -= a[i] * cone.z[k];
            }
        }
        let worst = |v: &[f64]| v.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let residual = (worst(&dual) / scale).max(worst(&primal)).max(cone.gap() / scale);
        if residual < best.residual {
            best = QpSolution { x: x.clone(), multipliers: cone.z[..m].to_vec(), residual, iterations: iteration };
        }
        if residual < TOLERANCE || !residual.is_finite() {
            break;
        }
        // H + Aᵀ diag(z/s) A + diag(box).
        system.copy_from(program.hessian);
        for k in 0..m {
            let (a, weight) = (row(k), cone.z[k] / cone.s[k]);
            for j in 0..n {
                let wa = weight * a[j];
                if wa != 0.0 {
                    for i in j..n {
                        system[(i, j)] += wa * a[i];
                    }
                }
            }
        }
        for i in 0..n {
            system[(i, i)] += cone.z[m + i] / cone.s[m + i] + cone.z[m + n + i] / cone.s[m + n + i] + 1e-13;
        }
        let Ok(factor) = system.llt(Side::Lower) else { break };
        let direction = |target: &[f64]| -> (Vec<f64>, Vec<f64>, Vec<f64>) {
            // s dz + z ds = target − s z for every slack.
            let mut rhs = Mat::from_fn(n, 1, |i, _| -dual[i]);
            let mut right = rhs.rb_mut();
            for k in 0..m {
                let pull = (target[k] - cone.z[k] * primal[k]) / cone.s[k] - cone.z[k];
                for (i, a) in row(k).iter().enumerate() {
                    right[(i, 0)] += a * pull;
                }
            }
            for i in 0..n {
                right[(i, 0)] += target[m + i] / cone.s[m + i] - cone.z[m + i];
                right[(i, 0)] -= target[m + n + i] / cone.s[m + n + i] - cone.z[m + n + i];
            }
            let step = factor.solve(&rhs);
            let dx: Vec<f64> = (0..n).map(|i| step[(i, 0)]).collect();
            let mut ds = vec![0.0; m + 2 * n];
            for k in 0..m {
                ds[k] = dot(row(k), &dx) + primal[k];
            }
            for i in 0..n {
                ds[m + i] = dx[i];
                ds[m + n + i] = -dx[i];
            }
            let dz = (0..m + 2 * n).map(|k| (target[k] - cone.z[k] * ds[k]) / cone.s[k] - cone.z[k]).collect();
            (dx, ds, dz)
        };
        let gap = cone.gap();
        let (_, ds, dz) = direction(&vec![0.0; m + 2 * n]);
        let (primal_step, dual_step) = (to_boundary(&cone.s, &ds), to_boundary(&cone.z, &dz));
        let predicted =
            (0..m + 2 * n).map(|k| (cone.s[k] + primal_step * ds[k]) * (cone.z[k] + dual_step * dz[k])).sum::<f64>()
                / (m + 2 * n) as f64;
        let centering = (predicted / gap).powi(3) * gap;
        let target: Vec<f64> = ds.iter().zip(&dz).map(|(s, z)| centering - s * z).collect();
        let (dx, ds, dz) = direction(&target);
        // One common step length: with a quadratic term separate ones need not lower the dual residual.
        let step = (TO_BOUNDARY * to_boundary(&cone.s, &ds).min(to_boundary(&cone.z, &dz))).min(1.0);
        for i in 0..n {
            x[i] += step * dx[i];
            cone.s[m + i] = program.half_width[i] + x[i];
            cone.s[m + n + i] = program.half_width[i] - x[i];
        }
        for k in 0..m {
            cone.s[k] += step * ds[k];
        }
        for k in 0..m + 2 * n {
            cone.z[k] += step * dz[k];
            cone.s[k] = cone.s[k].max(1e-300);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// minimise (x−1)² + (y−2)² with x + y ≤ 2 and y ≤ ½: x = 1, y = ½; the rows' multipliers are 0 and 3.
    #[test]
    fn known_solution() {
        let hessian = Mat::from_fn(2, 2, |i, j| if i == j { 2.0 } else { 0.0 });
        let program = QuadraticProgram {
            hessian: &hessian,
            linear: &[-2.0, -4.0],
            rows: &[-1.0, -1.0, 0.0, -1.0],
            lower: &[-2.0, -0.5],
            half_width: &[10.0, 10.0],
        };
        let solution = solve(&program);
        assert!(solution.residual < 1e-11, "{solution:?}");
        assert!((solution.x[0] - 1.0).abs() < 1e-9 && (solution.x[1] - 0.5).abs() < 1e-9);
        assert!(solution.multipliers[0].abs() < 1e-9 && (solution.multipliers[1] - 3.0).abs() < 1e-9);
    }

    /// A linear program (H = 0) in a box, with a redundant pair of equal rows.
    #[test]
    fn linear_program_with_dependent_rows() {
        let hessian = Mat::zeros(2, 2);
        let program = QuadraticProgram {
            hessian: &hessian,
            linear: &[-1.0, 0.0],
            rows: &[-1.0, 0.0, -1.0, 0.0],
            lower: &[-0.3, -0.3],
            half_width: &[1.0, 1.0],
        };
        let solution = solve(&program);
        assert!((solution.x[0] - 0.3).abs() < 1e-9, "{solution:?}");
        assert!((solution.multipliers.iter().sum::<f64>() - 1.0).abs() < 1e-8);
    }
}
