//! The Hessian of an objective, as Newton's iteration needs it: dense with its eigenvalues for few unknowns, sparse with
//! Cholesky's factorisation for many.
//!
//! A sparse Hessian is kept twice: exact, and with every block that was added made positive by itself. Newton's step is
//! that of H + floor·1 where this is positive, and of the second one elsewhere: either descends.

use super::eigen::{Eigen, EigenFailure, symmetric_eigen};
use faer::{
    Mat, Side,
    linalg::solvers::Solve,
    sparse::{SparseColMat, Triplet, linalg::solvers::Llt},
};

/// Up to this many unknowns the Hessian is dense: eigenvalues of more cost too much.
const MOST_DENSE: usize = 250;

/// A symmetric Hessian in the making: blocks are added to it.
pub struct Curvature {
    n: usize,
    held: Vec<bool>,
    kind: Kind,
}

enum Kind {
    Dense(Mat<f64>),
    /// Lower triangles: of the exact Hessian, and of the sum of the blocks' positive parts.
    Sparse {
        exact: Vec<Triplet<usize, usize, f64>>,
        convex: Vec<Triplet<usize, usize, f64>>,
    },
}

impl Curvature {
    /// Zero, but for a unit diagonal of the unknowns that are held; blocks do not reach these.
    pub fn new(n: usize, held: &[usize]) -> Self {
        let kind = match n <= MOST_DENSE {
            true => Kind::Dense(Mat::zeros(n, n)),
            false => Kind::Sparse { exact: Vec::new(), convex: Vec::new() },
        };
        let mut out = Curvature { n, held: vec![false; n], kind };
        for &k in held {
            out.add(&[(0, k, 1.0)], 1, |_, _| 1.0);
            out.held[k] = true;
        }
        out
    }

    /// From a dense matrix.
    pub fn dense(h: Mat<f64>) -> Self {
        Curvature { n: h.nrows(), held: vec![false; h.nrows()], kind: Kind::Dense(h) }
    }

    /// Adds Σ c_p c_q B(p, q): `entries` are (row of the block B, unknown, coefficient c), B has `size` rows.
    pub fn add(&mut self, entries: &[(usize, usize, f64)], size: usize, block: impl Fn(usize, usize) -> f64) {
        let held = &self.held;
        let free = || entries.iter().filter(|e| !held[e.1]);
        match &mut self.kind {
            Kind::Dense(h) => {
                for &(p, row, c) in free() {
                    for &(q, column, d) in free() {
                        h[(row, column)] += c * d * block(p, q);
                    }
                }
            }
            Kind::Sparse { exact, convex } => {
                let positive = positive_part(&Mat::from_fn(size, size, &block));
                for &(p, row, c) in free() {
                    for &(q, column, d) in free().filter(|e| e.1 <= row) {
                        exact.push(Triplet::new(row, column, c * d * block(p, q)));
                        convex.push(Triplet::new(row, column, c * d * positive[(p, q)]));
                    }
                }
            }
        }
    }

    /// All entries.
    pub fn to_dense(&self) -> Mat<f64> {
        match &self.kind {
            Kind::Dense(h) => h.clone(),
            Kind::Sparse { exact, .. } => {
                let mut h = Mat::zeros(self.n, self.n);
                for t in exact {
                    h[(t.row, t.col)] += t.val;
                    if t.row != t.col {
                        h[(t.col, t.row)] += t.val;
                    }
                }
                h
            }
        }
    }

    /// Decomposes what can be decomposed once.
    pub fn decompose(self) -> Result<Decomposed, EigenFailure> {
        Ok(match self.kind {
            Kind::Dense(h) => Decomposed::Dense(symmetric_eigen(&h)?),
            Kind::Sparse { exact, convex } => Decomposed::Sparse { n: self.n, exact, convex },
        })
    }
}

/// The matrix with its negative eigenvalues set to 0; itself where the decomposition fails.
fn positive_part(block: &Mat<f64>) -> Mat<f64> {
    let n = block.nrows();
    if n == 1 {
        return Mat::from_fn(1, 1, |_, _| block[(0, 0)].max(0.0));
    }
    let Ok(eigen) = block.self_adjoint_eigen(Side::Lower) else { return block.clone() };
    let (vectors, values) = (eigen.U(), eigen.S().column_vector());
    let scaled = Mat::from_fn(n, n, |i, k| vectors[(i, k)] * values[k].max(0.0));
    scaled * vectors.transpose()
}

/// A Hessian of which steps and signs can be asked.
pub enum Decomposed {
    /// Eigenvalues and vectors.
    Dense(Eigen),
    /// Lower triangles, exact and made positive block by block.
    Sparse {
        /// Unknowns.
        n: usize,
        /// Of the Hessian.
        exact: Vec<Triplet<usize, usize, f64>>,
        /// Of the sum of the blocks' positive parts.
        convex: Vec<Triplet<usize, usize, f64>>,
    },
}

/// Cholesky's factor of the lower triangle plus `shift` times the unit matrix; `None` where it is not positive.
fn shifted(n: usize, lower: &[Triplet<usize, usize, f64>], shift: f64) -> Option<Llt<usize, f64>> {
    let mut all = lower.to_vec();
    all.extend((0..n).map(|k| Triplet::new(k, k, shift)));
    SparseColMat::try_new_from_triplets(n, n, &all).ok()?.sp_cholesky(Side::Lower).ok()
}

fn solved(factor: &Llt<usize, f64>, right: &[f64]) -> Vec<f64> {
    let mut x = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    factor.solve_in_place(&mut x);
    x.col(0).iter().copied().collect()
}

/// Inverse iterations for the lowest eigenvector of a sparse Hessian.
const INVERSE_ITERATIONS: usize = 40;

impl Decomposed {
    /// A step that descends: Newton's where the curvature is above `floor`.
    pub fn descent_step(&self, gradient: &[f64], floor: f64) -> Option<Vec<f64>> {
        match self {
            Decomposed::Dense(eigen) => Some(eigen.descent_step(gradient, floor)),
            Decomposed::Sparse { n, exact, convex } => {
                let factor = shifted(*n, exact, floor).or_else(|| shifted(*n, convex, floor))?;
                Some(solved(&factor, gradient).iter().map(|x| -x).collect())
            }
        }
    }

    /// Whether no eigenvalue is below −`tolerance`.
    pub fn no_saddle(&self, tolerance: f64) -> bool {
        match self {
            Decomposed::Dense(eigen) => eigen.values[0] >= -tolerance,
            Decomposed::Sparse { n, exact, .. } => shifted(*n, exact, tolerance).is_some(),
        }
    }

    /// The least eigenvalue with its vector; of a sparse Hessian by inverse iteration, as good as that gets.
    pub fn lowest(&self) -> Option<(f64, Vec<f64>)> {
        let (n, exact) = match self {
            Decomposed::Dense(eigen) => return Some((eigen.values[0], eigen.lowest())),
            Decomposed::Sparse { n, exact, .. } => (*n, exact),
        };
        let size = exact.iter().map(|t| t.val.abs()).fold(1e-300, f64::max);
        let factor = (0..60).find_map(|k| shifted(n, exact, 1e-9 * size * 2f64.powi(k)))?;
        // Any start that is orthogonal to no vector in particular.
        let mut vector: Vec<f64> = (0..n).map(|k| (1.0 + k as f64).sin()).collect();
        for _ in 0..INVERSE_ITERATIONS {
            vector = solved(&factor, &vector);
            let norm = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|x| *x /= norm);
        }
        let of = |t: &Triplet<usize, usize, f64>| match t.row == t.col {
            true => t.val * vector[t.row] * vector[t.col],
            false => 2.0 * t.val * vector[t.row] * vector[t.col],
        };
        Some((exact.iter().map(of).sum(), vector))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs, some of them negative: dense and sparse see the same matrix.
    fn chain(n: usize, negative: f64) -> Curvature {
        let mut out = Curvature::new(n, &[0]);
        for k in 1..n {
            let stiff = if k % 7 == 3 { negative } else { 1.0 };
            out.add(&[(0, k - 1, 1.0), (1, k, 1.0)], 2, |p, q| if p == q { stiff } else { -stiff });
            out.add(&[(0, k, 1.0)], 1, |_, _| 0.3);
        }
        out
    }

    #[test]
    fn sparse_steps_and_signs_are_those_of_the_dense_matrix() {
        let n = MOST_DENSE + 50;
        for negative in [0.5, -0.2] {
            let sparse = chain(n, negative);
            let eigen = symmetric_eigen(&sparse.to_dense()).unwrap();
            let sparse = sparse.decompose().unwrap();
            assert!(matches!(sparse, Decomposed::Sparse { .. }));
            assert_eq!(sparse.no_saddle(1e-6), eigen.values[0] >= -1e-6);
            let (value, vector) = sparse.lowest().unwrap();
            // The low eigenvalues lie close together: inverse iteration mixes them.
            assert!((value - eigen.values[0]).abs() < 0.02, "{value} {}", eigen.values[0]);
            assert!(vector[0].abs() < 1e-12, "a held unknown does not move");
            let gradient: Vec<f64> = (0..n).map(|k| (0.3 * k as f64).cos() * f64::from(u8::from(k > 0))).collect();
            let step = sparse.descent_step(&gradient, 1e-3).unwrap();
            let slope: f64 = step.iter().zip(&gradient).map(|(s, g)| s * g).sum();
            assert!(slope < 0.0 && step[0] == 0.0);
            if negative > 0.0 {
                let expected = eigen.descent_step(&gradient, 0.0);
                for (s, e) in step.iter().zip(expected) {
                    assert!((s - e).abs() < 0.02 * e.abs().max(0.1), "{s} {e}"); // the floor shifts it a little
                }
            }
        }
    }
}
