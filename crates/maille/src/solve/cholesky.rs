//! Cholesky's factorisation of a positive matrix, again and again in the same room: a plain loop where it is small, faer's
//! blocked kernels where it is larger, and where it is larger still, and mostly zeros, faer's sparse ones.

use faer::{
    MatMut, Par, Side, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch},
        solvers::Solve,
    },
    sparse::{
        SparseColMatRef, SymbolicSparseColMat,
        linalg::solvers::{Llt as SparseLlt, SymbolicLlt},
    },
};

/// From this size on faer's blocked kernels are faster than the plain loop.
const BLOCKED_FROM: usize = 40;

/// From this size on zeros are left out.
const SPARSE_FROM: usize = 200;

/// A symmetric matrix, column after column, and its factor L (A = L Lᵀ).
pub struct Cholesky {
    n: usize,
    matrix: Vec<f64>,
    room: MemBuffer,
    sparse: Option<SparseLlt<usize, f64>>,
    pattern: Option<Pattern>,
}

/// Where the lower triangle is not zero, with what follows from that for its factor.
struct Pattern {
    at: SymbolicSparseColMat<usize>,
    factor: SymbolicLlt<usize>,
}

impl Cholesky {
    /// For matrices of n rows.
    pub fn new(n: usize) -> Self {
        let room = MemBuffer::new(cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default()));
        Cholesky { n, matrix: vec![0.0; n * n], room, sparse: None, pattern: None }
    }

    /// The matrix, column-major, to be written before each factorisation; only its lower triangle is read.
    pub fn matrix_mut(&mut self) -> &mut [f64] {
        &mut self.matrix
    }

    /// Factors the matrix; false where it is not positive. The matrix is lost.
    pub fn factor(&mut self) -> bool {
        let n = self.n;
        if n >= SPARSE_FROM {
            self.sparse = self.factor_sparse();
            return self.sparse.is_some();
        }
        if n >= BLOCKED_FROM {
            let matrix = MatMut::from_column_major_slice_mut(&mut self.matrix, n, n);
            let room = MemStack::new(&mut self.room);
            return cholesky_in_place(matrix, Default::default(), Par::Seq, room, Spec::default()).is_ok();
        }
        for k in 0..n {
            let (left, right) = self.matrix.split_at_mut((k + 1) * n);
            let column = &mut left[k * n + k..];
            let pivot = column[0];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let inverse = 1.0 / pivot.sqrt();
            column.iter_mut().for_each(|v| *v *= inverse);
            for (j, later) in right.chunks_exact_mut(n).enumerate() {
                let below = &column[j + 1..];
                let by = below[0];
                if by != 0.0 {
                    later[k + 1 + j..].iter_mut().zip(below).for_each(|(a, l)| *a -= by * l);
                }
            }
        }
        true
    }

    /// The sparse factor; what follows from the pattern is kept while the pattern stays.
    fn factor_sparse(&mut self) -> Option<SparseLlt<usize, f64>> {
        let n = self.n;
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for (j, column) in self.matrix.chunks_exact(n).enumerate() {
            for (i, &value) in column.iter().enumerate().skip(j).filter(|(_, v)| **v != 0.0) {
                rows.push(i);
                values.push(value);
            }
            starts.push(rows.len());
        }
        if !self.pattern.as_ref().is_some_and(|p| p.at.row_idx() == rows && p.at.col_ptr() == starts) {
            let at = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
            let factor = SymbolicLlt::try_new(at.as_ref(), Side::Lower).ok()?;
            self.pattern = Some(Pattern { at, factor });
        }
        let pattern = self.pattern.as_ref()?;
        let matrix = SparseColMatRef::new(pattern.at.as_ref(), &values);
        SparseLlt::try_new_with_symbolic(pattern.factor.clone(), matrix, Side::Lower).ok()
    }

    /// Puts A⁻¹ b in the place of b.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.n;
        if let Some(factor) = &self.sparse {
            factor.solve_in_place(MatMut::from_column_major_slice_mut(b, n, 1));
            return;
        }
        for k in 0..n {
            let column = &self.matrix[k * n + k..(k + 1) * n];
            b[k] /= column[0];
            let bk = b[k];
            b[k + 1..].iter_mut().zip(&column[1..]).for_each(|(b, l)| *b -= l * bk);
        }
        for k in (0..n).rev() {
            let column = &self.matrix[k * n + k..(k + 1) * n];
            let known = dot(&column[1..], &b[k + 1..]);
            b[k] = (b[k] - known) / column[0];
        }
    }
}

/// a · b, summed in eight lanes: the order is fixed, and the processor can do them at once.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (chunks, rest) = (a.chunks_exact(8).zip(b.chunks_exact(8)), a.len() / 8 * 8);
    for (a, b) in chunks {
        (0..8).for_each(|k| lanes[k] += a[k] * b[k]);
    }
    let tail: f64 = a[rest..].iter().zip(&b[rest..]).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f64>() + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A x = b with A = M Mᵀ + I, below and above the size where the kernel changes; and an indefinite matrix.
    #[test]
    fn solves_what_it_factors() {
        for n in [1, 7, BLOCKED_FROM - 1, BLOCKED_FROM, 90, SPARSE_FROM] {
            let entry = |i: usize, j: usize| ((3 * i + 7 * j) as f64).sin();
            let a = |i: usize, j: usize| {
                (0..n).map(|k| entry(i, k) * entry(j, k)).sum::<f64>() + f64::from(u8::from(i == j))
            };
            let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a(i, j) * x[j]).sum()).collect();
            let mut system = Cholesky::new(n);
            (0..n * n).for_each(|k| system.matrix_mut()[k] = a(k % n, k / n));
            assert!(system.factor());
            system.solve(&mut b);
            assert!(b.iter().zip(&x).all(|(b, x)| (b - x).abs() < 1e-10), "{n}");
            (0..n).for_each(|k| system.matrix_mut()[k * n + k] = -1.0);
            assert!(!system.factor());
        }
    }
}
