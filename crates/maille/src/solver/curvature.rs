//! The Hessian of an objective, as Newton's iteration needs it: dense with its eigenvalues for few unknowns, sparse with
//! Cholesky's factorisation for many.
//!
//! A sparse Hessian is kept as the blocks that were added. Newton's step is that of H + floor·1 where this is positive;
//! elsewhere every block is made positive by itself, and the step is that of their sum. Either descends.

use super::{
    cholesky::Cholesky,
    eigen::{Eigen, EigenFailure, symmetric_eigen},
    sparse::{Entries, GROUP, Patterns},
    symmetric::Symmetric,
};
use faer::{Mat, Side};
use rayon::prelude::*;
use std::sync::Arc;

/// Up to this many unknowns the Hessian is dense: eigenvalues of more cost too much.
const MOST_DENSE: usize = 120;

/// A symmetric Hessian in the making: blocks are added to it.
pub struct Curvature {
    n: usize,
    held: Vec<bool>,
    kind: Kind,
}

enum Kind {
    Dense(Mat<f64>),
    Sparse(Vec<Piece>),
}

/// Σ c_p c_q B(p, q).
struct Piece {
    /// Row of the block B, unknown, coefficient c.
    entries: Box<[(u32, u32, f64)]>,
    size: usize,
    /// B's lower triangle, row after row.
    block: Box<[f64]>,
}

impl Piece {
    fn at(block: &[f64], p: usize, q: usize) -> f64 {
        let (row, column) = (p.max(q), p.min(q));
        block[row * (row + 1) / 2 + column]
    }

    /// Calls `each` with row, column and value of the entries of the lower triangle that `block` makes.
    fn scatter(&self, block: &[f64], mut each: impl FnMut(usize, usize, f64)) {
        for &(p, row, c) in &self.entries {
            for &(q, column, d) in self.entries.iter().filter(|e| e.1 <= row) {
                each(row as usize, column as usize, c * d * Self::at(block, p as usize, q as usize));
            }
        }
    }

    /// Groups of the unknowns.
    fn groups(&self) -> Vec<usize> {
        let mut groups: Vec<usize> = self.entries.iter().map(|e| e.1 as usize / GROUP).collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// B with its negative eigenvalues set to 0; B itself where the decomposition fails.
    fn positive(&self) -> Box<[f64]> {
        let n = self.size;
        if n == 1 {
            return [self.block[0].max(0.0)].into();
        }
        let whole = Mat::from_fn(n, n, |p, q| Self::at(&self.block, p, q));
        let Ok(eigen) = whole.self_adjoint_eigen(Side::Lower) else { return self.block.clone() };
        let (vectors, values) = (eigen.U(), eigen.S().column_vector());
        if values.iter().all(|v| *v >= 0.0) {
            return self.block.clone();
        }
        let entry = |p: usize, q: usize| (0..n).map(|k| vectors[(p, k)] * vectors[(q, k)] * values[k].max(0.0)).sum();
        (0..n).flat_map(|p| (0..=p).map(move |q| (p, q))).map(|(p, q)| entry(p, q)).collect()
    }
}

impl Curvature {
    /// Zero, but for a unit diagonal of the unknowns that are held; blocks do not reach these.
    pub(crate) fn new(n: usize, held: &[usize]) -> Self {
        let kind = match n <= MOST_DENSE {
            true => Kind::Dense(Mat::zeros(n, n)),
            false => Kind::Sparse(Vec::new()),
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
    pub(crate) fn add(&mut self, entries: &[(usize, usize, f64)], size: usize, block: impl Fn(usize, usize) -> f64) {
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
            Kind::Sparse(pieces) => {
                let entries = free().map(|&(p, unknown, c)| (p as u32, unknown as u32, c)).collect();
                let lower = (0..size).flat_map(|p| (0..=p).map(move |q| (p, q)));
                pieces.push(Piece { entries, size, block: lower.map(|(p, q)| block(p, q)).collect() });
            }
        }
    }

    /// All entries.
    pub fn to_dense(&self) -> Mat<f64> {
        match &self.kind {
            Kind::Dense(h) => h.clone(),
            Kind::Sparse(pieces) => {
                let mut h = Mat::zeros(self.n, self.n);
                for piece in pieces {
                    piece.scatter(&piece.block, |row, column, value| {
                        h[(row, column)] += value;
                        if row != column {
                            h[(column, row)] += value;
                        }
                    });
                }
                h
            }
        }
    }

    /// Decomposes what can be decomposed once; `patterns` are those of the matrices before.
    pub fn decompose(self, patterns: &mut Patterns) -> Result<Decomposed, EigenFailure> {
        let pieces = match self.kind {
            Kind::Dense(h) => return Ok(Decomposed::Dense(symmetric_eigen(&h)?)),
            Kind::Sparse(pieces) => pieces,
        };
        let groups: Vec<Vec<usize>> = pieces.iter().map(Piece::groups).collect();
        let pattern = patterns.with(self.n, groups.iter().map(|of| &of[..]));
        pattern.symbolic().ok_or(EigenFailure { residual: f64::NAN, norm: f64::NAN })?; // no memory
        let exact = sum(&pattern, pieces.iter().map(|piece| (piece, &piece.block)));
        Ok(Decomposed::Sparse(SparseHessian { pattern, exact, pieces }))
    }
}

/// Σ of the pieces with the blocks that stand beside them.
fn sum<'a>(pattern: &Arc<Entries>, pieces: impl Iterator<Item = (&'a Piece, &'a Box<[f64]>)>) -> Symmetric {
    let mut out = Symmetric::sparse(pattern.clone());
    pieces.for_each(|(piece, block)| piece.scatter(block, |row, column, value| out.add_entry(row, column, value)));
    out
}

/// The factor of a matrix with `shift` added to its diagonal; `None` where that is not positive.
fn factored(matrix: Symmetric, shift: f64) -> Option<Cholesky> {
    let mut system = Cholesky::new(matrix);
    let matrix = system.matrix_mut();
    (0..matrix.n()).for_each(|k| matrix.add_to_diagonal(k, shift));
    system.factor().then_some(system)
}

/// A Hessian of which steps and signs can be asked.
pub enum Decomposed {
    /// Eigenvalues and vectors.
    Dense(Eigen),
    /// Entries, and the blocks they were made of.
    Sparse(SparseHessian),
}

/// A large Hessian.
pub struct SparseHessian {
    pattern: Arc<Entries>,
    exact: Symmetric,
    pieces: Vec<Piece>,
}

impl SparseHessian {
    /// The sum of the blocks' positive parts.
    fn convex(&self) -> Symmetric {
        let blocks: Vec<Box<[f64]>> = self.pieces.par_iter().with_min_len(64).map(Piece::positive).collect();
        sum(&self.pattern, self.pieces.iter().zip(&blocks))
    }

    fn step(&self, gradient: &[f64], floor: f64) -> Option<Vec<f64>> {
        let mut system = factored(self.exact.clone(), floor).or_else(|| factored(self.convex(), floor))?;
        let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
        system.solve(&mut step);
        Some(step)
    }

    fn lowest(&self) -> Option<(f64, Vec<f64>)> {
        let size = self.exact.values().iter().fold(1e-300f64, |m, v| m.max(v.abs()));
        let mut system = (0..60).find_map(|k| factored(self.exact.clone(), 1e-9 * size * 2f64.powi(k)))?;
        // Any start that is orthogonal to no vector in particular.
        let mut vector: Vec<f64> = (0..self.exact.n()).map(|k| (1.0 + k as f64).sin()).collect();
        for _ in 0..INVERSE_ITERATIONS {
            system.solve(&mut vector);
            let norm = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|x| *x /= norm);
        }
        Some((self.exact.quadratic_form(&vector), vector))
    }
}

/// Inverse iterations for the lowest eigenvector of a sparse Hessian.
const INVERSE_ITERATIONS: usize = 40;

impl Decomposed {
    /// A step that descends: Newton's where the curvature is above `floor`.
    pub fn descent_step(&self, gradient: &[f64], floor: f64) -> Option<Vec<f64>> {
        match self {
            Decomposed::Dense(eigen) => Some(eigen.descent_step(gradient, floor)),
            Decomposed::Sparse(hessian) => hessian.step(gradient, floor),
        }
    }

    /// Whether no eigenvalue is below −`tolerance`.
    pub(crate) fn no_saddle(&self, tolerance: f64) -> bool {
        match self {
            Decomposed::Dense(eigen) => eigen.values[0] >= -tolerance,
            Decomposed::Sparse(hessian) => factored(hessian.exact.clone(), tolerance).is_some(),
        }
    }

    /// The least eigenvalue with its vector; of a sparse Hessian by inverse iteration, as good as that gets.
    pub fn lowest(&self) -> Option<(f64, Vec<f64>)> {
        match self {
            Decomposed::Dense(eigen) => Some((eigen.values[0], eigen.lowest())),
            Decomposed::Sparse(hessian) => hessian.lowest(),
        }
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
            let sparse = sparse.decompose(&mut Patterns::default()).unwrap();
            assert!(matches!(sparse, Decomposed::Sparse(_)));
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
