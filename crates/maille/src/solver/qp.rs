//! A convex quadratic program by Mehrotra's predictor–corrector interior-point method.
//!
//!   minimise ½ xᵀ H x + cᵀ x   subject to   A x ≥ b,  −w ≤ x ≤ w
//!
//! H symmetric positive semidefinite; every x is boxed, so the program is feasible iff A x ≥ b meets the box, and the
//! caller keeps it so with an elastic unknown. Slacks are kept positive throughout; multipliers belong to A x ≥ b and
//! are non-negative. The rows of A are sparse: each iteration forms H + Aᵀ diag(z/s) A and factors it by Cholesky.

use super::{cholesky::Cholesky, symmetric::Symmetric};

/// Rows of A, by their entries that are not zero.
#[derive(Clone, Debug)]
pub struct SparseRows {
    starts: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Default for SparseRows {
    fn default() -> Self {
        SparseRows { starts: vec![0], columns: Vec::new(), values: Vec::new() }
    }
}

impl SparseRows {
    /// Adds a row of (column, value), each column once.
    pub fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        let start = self.columns.len();
        for (column, value) in entries {
            // In ascending order; rows are short and nearly so.
            let at = self.columns[start..].iter().rposition(|c| *c < column).map_or(start, |k| start + k + 1);
            self.columns.insert(at, column);
            self.values.insert(at, value);
        }
        self.starts.push(self.columns.len());
    }

    fn row(&self, k: usize) -> (&[usize], &[f64]) {
        let range = self.starts[k]..self.starts[k + 1];
        (&self.columns[range.clone()], &self.values[range])
    }
}

/// The program's data.
pub struct QuadraticProgram<'a> {
    /// H.
    pub hessian: &'a Symmetric,
    /// c.
    pub linear: &'a [f64],
    /// A, b.len() rows.
    pub rows: &'a SparseRows,
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

fn sparse_dot(columns: &[usize], values: &[f64], x: &[f64]) -> f64 {
    columns.iter().zip(values).map(|(&i, a)| a * x[i]).sum()
}

/// Largest step in (0, 1] that keeps v + step · dv ≥ 0.
fn to_boundary(v: &[f64], dv: &[f64]) -> f64 {
    v.iter().zip(dv).filter(|(_, d)| **d < 0.0).map(|(x, d)| -x / d).fold(1.0, f64::min)
}

/// Slacks and multipliers of the rows, the lower and the upper box sides, one after the other.
struct Cone {
    s: Vec<f64>,
    z: Vec<f64>,
    /// 1/s, once for each iteration.
    inverse: Vec<f64>,
}

impl Cone {
    /// Where the iteration starts, at x = 0.
    fn start(program: &QuadraticProgram<'_>, scale: f64) -> Self {
        let rows = program.lower.iter().map(|b| (-b).max(1e-2));
        let s: Vec<f64> = rows.chain(program.half_width.iter().chain(program.half_width).copied()).collect();
        let z = s.iter().map(|s| 1e-2 * scale / s.max(1e-1)).collect();
        Cone { inverse: vec![0.0; s.len()], s, z }
    }

    fn gap(&self) -> f64 {
        dot(&self.s, &self.z) / self.s.len() as f64
    }
}

/// Solves the program. The residual says how far it came; at most 60 iterations.
pub fn solve(program: &QuadraticProgram<'_>) -> QpSolution {
    let (n, m) = (program.linear.len(), program.lower.len());
    let sides = m + 2 * n;
    let scale = 1.0 + program.linear.iter().fold(0.0f64, |a, c| a.max(c.abs()));
    let mut x = vec![0.0; n];
    let mut cone = Cone::start(program, scale);
    // The best iterate so far is the answer: rounding can spoil the last ones.
    let mut best = QpSolution { x: x.clone(), multipliers: vec![0.0; m], residual: f64::INFINITY, iterations: 0 };
    let (mut dual, mut primal) = (vec![0.0; n], vec![0.0; m]);
    let (matrix, positions) = normal_pattern(program);
    let mut system = Cholesky::new(matrix);
    let mut direction = Direction { x: vec![0.0; n], s: vec![0.0; sides], z: vec![0.0; sides] };
    let mut target = vec![0.0; sides];
    for iteration in 0..MAX_ITERATIONS {
        residuals(program, &x, &cone, &mut dual, &mut primal);
        // A maximum would skip what is no number.
        if !x.iter().chain(&cone.z).all(|v| v.is_finite()) {
            break;
        }
        let worst = |v: &[f64]| v.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let gap = cone.gap();
        let residual = (worst(&dual) / scale).max(worst(&primal)).max(gap / scale);
        if residual < best.residual {
            best.x.copy_from_slice(&x);
            best.multipliers.copy_from_slice(&cone.z[..m]);
            (best.residual, best.iterations) = (residual, iteration);
        }
        if residual < TOLERANCE {
            break;
        }
        cone.inverse.iter_mut().zip(&cone.s).for_each(|(inverse, s)| *inverse = 1.0 / s);
        write_normal_matrix(program, &cone, &positions, system.matrix_mut());
        if !system.factor() {
            break;
        }
        // Predictor: the affine direction, towards complementarity 0.
        target.fill(0.0);
        direction.find(program, &mut system, &cone, (&dual, &primal), &target);
        let (primal_step, dual_step) = (to_boundary(&cone.s, &direction.s), to_boundary(&cone.z, &direction.z));
        // Mehrotra's centring: the cube of the gap that the predictor leaves, with its second-order term.
        let after = |k: usize| (cone.s[k] + primal_step * direction.s[k]) * (cone.z[k] + dual_step * direction.z[k]);
        let predicted = (0..sides).map(after).sum::<f64>() / sides as f64;
        let centering = (predicted / gap).powi(3) * gap;
        for k in 0..sides {
            target[k] = centering - direction.s[k] * direction.z[k];
        }
        direction.find(program, &mut system, &cone, (&dual, &primal), &target);
        // One common step length: with a quadratic term separate ones need not lower the dual residual.
        let step = to_boundary(&cone.s, &direction.s).min(to_boundary(&cone.z, &direction.z));
        let step = (TO_BOUNDARY * step).min(1.0);
        for i in 0..n {
            x[i] += step * direction.x[i];
            cone.s[m + i] = program.half_width[i] + x[i];
            cone.s[m + n + i] = program.half_width[i] - x[i];
        }
        for k in 0..m {
            cone.s[k] += step * direction.s[k];
        }
        for k in 0..sides {
            cone.z[k] += step * direction.z[k];
            cone.s[k] = cone.s[k].max(1e-300);
        }
    }
    best
}

/// Dual H x + c − Aᵀ z_A − z_low + z_up; primal A x − b − s. The box slacks stay exact.
fn residuals(program: &QuadraticProgram<'_>, x: &[f64], cone: &Cone, dual: &mut [f64], primal: &mut [f64]) {
    let (n, m) = (x.len(), primal.len());
    for i in 0..n {
        dual[i] = program.linear[i] - cone.z[m + i] + cone.z[m + n + i];
    }
    program.hessian.add_times(1.0, x, dual);
    for k in 0..m {
        let (columns, values) = program.rows.row(k);
        primal[k] = sparse_dot(columns, values, x) - program.lower[k] - cone.s[k];
        columns.iter().zip(values).for_each(|(&i, a)| dual[i] -= a * cone.z[k]);
    }
}

/// H + Aᵀ diag(z/s) A + diag(box).
fn write_normal_matrix(program: &QuadraticProgram<'_>, cone: &Cone, positions: &[usize], matrix: &mut Symmetric) {
    let (n, m) = (program.linear.len(), program.lower.len());
    matrix.set(program.hessian);
    let mut at = positions;
    for k in 0..m {
        let ((columns, values), weight) = (program.rows.row(k), cone.z[k] * cone.inverse[k]);
        at = matrix.add_square(columns, values, weight, at);
    }
    for i in 0..n {
        let sides = cone.z[m + i] * cone.inverse[m + i] + cone.z[m + n + i] * cone.inverse[m + n + i];
        matrix.add_to_diagonal(i, sides + 1e-13);
    }
}

/// A matrix with the pattern of H + AᵀA, and the places of the rows' entries in it.
fn normal_pattern(program: &QuadraticProgram<'_>) -> (Symmetric, Vec<usize>) {
    let n = program.linear.len();
    let columns = |k: usize| program.rows.row(k).0;
    let cliques = (0..program.lower.len()).map(columns);
    let matrix = Symmetric::around(program.hessian, n, cliques.clone());
    let mut positions = Vec::new();
    cliques.for_each(|of| matrix.positions(of, &mut positions));
    (matrix, positions)
}

/// A Newton direction of x, s and z.
struct Direction {
    x: Vec<f64>,
    s: Vec<f64>,
    z: Vec<f64>,
}

impl Direction {
    /// The direction with s dz + z ds = target − s z for every slack, and the residuals taken away.
    fn find(
        &mut self,
        program: &QuadraticProgram<'_>,
        system: &mut Cholesky,
        cone: &Cone,
        (dual, primal): (&[f64], &[f64]),
        target: &[f64],
    ) {
        let (n, m) = (dual.len(), primal.len());
        for i in 0..n {
            let (low, up) = (m + i, m + n + i);
            let side = |k: usize| target[k] * cone.inverse[k] - cone.z[k];
            let sides = side(low) - side(up);
            self.x[i] = sides - dual[i];
        }
        for k in 0..m {
            let pull = (target[k] - cone.z[k] * primal[k]) * cone.inverse[k] - cone.z[k];
            let (columns, values) = program.rows.row(k);
            columns.iter().zip(values).for_each(|(&i, a)| self.x[i] += a * pull);
        }
        system.solve(&mut self.x);
        for k in 0..m {
            let (columns, values) = program.rows.row(k);
            self.s[k] = sparse_dot(columns, values, &self.x) + primal[k];
        }
        for i in 0..n {
            (self.s[m + i], self.s[m + n + i]) = (self.x[i], -self.x[i]);
        }
        for k in 0..m + 2 * n {
            self.z[k] = (target[k] - cone.z[k] * self.s[k]) * cone.inverse[k] - cone.z[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sparse(rows: &[[f64; 2]]) -> SparseRows {
        let mut out = SparseRows::default();
        rows.iter().for_each(|row| out.push(row.iter().copied().enumerate().filter(|(_, a)| *a != 0.0)));
        out
    }

    /// minimise (x−1)² + (y−2)² with x + y ≤ 2 and y ≤ ½: x = 1, y = ½; the rows' multipliers are 0 and 3.
    #[test]
    fn known_solution() {
        let mut hessian = Symmetric::new(2, []);
        (0..2).for_each(|i| hessian.add_to_diagonal(i, 2.0));
        let program = QuadraticProgram {
            hessian: &hessian,
            linear: &[-2.0, -4.0],
            rows: &sparse(&[[-1.0, -1.0], [0.0, -1.0]]),
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
        let hessian = Symmetric::new(2, []);
        let program = QuadraticProgram {
            hessian: &hessian,
            linear: &[-1.0, 0.0],
            rows: &sparse(&[[-1.0, 0.0], [-1.0, 0.0]]),
            lower: &[-0.3, -0.3],
            half_width: &[1.0, 1.0],
        };
        let solution = solve(&program);
        assert!((solution.x[0] - 0.3).abs() < 1e-9, "{solution:?}");
        assert!((solution.multipliers.iter().sum::<f64>() - 1.0).abs() < 1e-8);
    }
}
