//! Cholesky's factorisation of a positive matrix, again and again in the same room: a plain loop where it is small, faer's
//! blocked kernels where it is larger, and where it is larger still, and mostly zeros, faer's sparse ones.

use super::{sparse::Entries, symmetric::Symmetric};
use faer::{
    MatMut, Par, Side, Spec,
    dyn_stack::{MemBuffer, MemStack, StackReq},
    linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch},
    sparse::{SparseColMatRef, linalg::cholesky::LltRef},
};

/// From this size on faer's blocked kernels are faster than the plain loop.
const BLOCKED_FROM: usize = 40;

/// A symmetric matrix and its factor L (A = L Lᵀ).
pub(crate) struct Cholesky {
    matrix: Symmetric,
    /// Values of a sparse factor; a dense one takes the place of its matrix.
    sparse: Vec<f64>,
    room: MemBuffer,
}

impl Cholesky {
    /// For matrices like this one: of its size, and if it is sparse with its pattern.
    pub(crate) fn new(matrix: Symmetric) -> Self {
        let n = matrix.n();
        let room = match matrix.entries() {
            None => MemBuffer::new(cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default())),
            Some(_) => MemBuffer::new(StackReq::EMPTY),
        };
        Cholesky { matrix, sparse: Vec::new(), room }
    }

    /// The matrix, to be written before each factorisation; only its lower triangle is read.
    pub(crate) fn matrix_mut(&mut self) -> &mut Symmetric {
        &mut self.matrix
    }

    /// Factors the matrix; false where it is not positive. A dense matrix is lost.
    pub(crate) fn factor(&mut self) -> bool {
        let n = self.matrix.n();
        if self.matrix.entries().is_some() {
            return self.factor_sparse().is_some();
        }
        let values = self.matrix.values_mut();
        if n >= BLOCKED_FROM {
            let matrix = MatMut::from_column_major_slice_mut(values, n, n);
            let room = MemStack::new(&mut self.room);
            return cholesky_in_place(matrix, Default::default(), Par::Seq, room, Spec::default()).is_ok();
        }
        for k in 0..n {
            let (left, right) = values.split_at_mut((k + 1) * n);
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

    /// The sparse factor; its values and the room are kept.
    fn factor_sparse(&mut self) -> Option<()> {
        let entries = self.matrix.entries()?;
        let symbolic = entries.symbolic()?;
        if self.sparse.is_empty() {
            let factor = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
            let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
            self.room = MemBuffer::try_new(factor.or(solve)).ok()?;
            self.sparse = vec![0.0; symbolic.len_val()];
        }
        let matrix = SparseColMatRef::new(entries.as_faer(), self.matrix.values());
        let (factor, room) = (&mut self.sparse, MemStack::new(&mut self.room));
        symbolic
            .factorize_numeric_llt(factor, matrix, Side::Lower, Default::default(), Par::Seq, room, Spec::default())
            .ok()?;
        Some(())
    }

    /// Puts A⁻¹ b in the place of b.
    pub(crate) fn solve(&mut self, b: &mut [f64]) {
        let n = self.matrix.n();
        if let Some(symbolic) = self.matrix.entries().and_then(Entries::symbolic) {
            let right = MatMut::from_column_major_slice_mut(b, n, 1);
            let room = MemStack::new(&mut self.room);
            LltRef::new(symbolic, &self.sparse).solve_in_place_with_conj(faer::Conj::No, right, Par::Seq, room);
            return;
        }
        let matrix = self.matrix.values();
        for k in 0..n {
            let column = &matrix[k * n + k..(k + 1) * n];
            b[k] /= column[0];
            let bk = b[k];
            b[k + 1..].iter_mut().zip(&column[1..]).for_each(|(b, l)| *b -= l * bk);
        }
        for k in (0..n).rev() {
            let column = &matrix[k * n + k..(k + 1) * n];
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
    use crate::solver::symmetric::SPARSE_FROM;

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
            let all: Vec<usize> = (0..n).collect();
            let mut system = Cholesky::new(Symmetric::new(n, [&all[..]]));
            system.matrix_mut().add(&all, a);
            assert!(system.factor());
            system.solve(&mut b);
            assert!(b.iter().zip(&x).all(|(b, x)| (b - x).abs() < 1e-10), "{n}");
            (0..n).for_each(|k| system.matrix_mut().add_to_diagonal(k, -1e6));
            assert!(!system.factor());
        }
    }
}
