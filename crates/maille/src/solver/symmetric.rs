//! Symmetric matrices that sums of small dense blocks make up: dense for few unknowns, for many only the entries that
//! some block can reach.

use super::sparse::Entries;
use std::sync::Arc;

/// From this size on zeros are left out. It lies between 133 unknowns, where a cell's matrices are nearly full, and 538,
/// where dense factors took ten times as long.
pub(crate) const SPARSE_FROM: usize = 200;

/// A symmetric matrix.
#[derive(Clone, Debug)]
pub struct Symmetric {
    n: usize,
    at: Option<Arc<Entries>>,
    /// All entries, column after column; of a sparse matrix those of the lower triangle in the order of [`Entries`].
    values: Vec<f64>,
}

impl Symmetric {
    /// Zero; a large one has room on its diagonal and within `cliques` of unknowns only.
    pub fn new<'c>(n: usize, cliques: impl IntoIterator<Item = &'c [usize]>) -> Self {
        Self::with_room(n, None, cliques)
    }

    /// `first` in the corner of a matrix of `n` rows, with room for `cliques`.
    pub(crate) fn around<'c>(first: &Symmetric, n: usize, cliques: impl IntoIterator<Item = &'c [usize]>) -> Self {
        let mut out = Self::with_room(n, Some(first), cliques);
        out.set(first);
        out
    }

    fn with_room<'c>(n: usize, first: Option<&Symmetric>, cliques: impl IntoIterator<Item = &'c [usize]>) -> Self {
        if n < SPARSE_FROM {
            return Symmetric { n, at: None, values: vec![0.0; n * n] };
        }
        let full = Entries::full(first.filter(|first| first.at.is_none()).map_or(0, |first| first.n));
        let first = first.map(|first| first.entries().unwrap_or(&full));
        Self::sparse(Arc::new(Entries::new(n, first, cliques)))
    }

    /// Zero, with room for `entries`.
    pub(crate) fn sparse(entries: Arc<Entries>) -> Self {
        Symmetric { n: entries.starts.len() - 1, values: vec![0.0; entries.rows.len()], at: Some(entries) }
    }

    /// Number of rows.
    pub(crate) fn n(&self) -> usize {
        self.n
    }

    /// Where a sparse matrix has entries; `None` of a dense one.
    pub(crate) fn entries(&self) -> Option<&Entries> {
        self.at.as_deref()
    }

    /// The stored values; of a dense matrix column after column.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// See [`Self::values`].
    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Adds a block, given with both triangles, on the unknowns `of`.
    pub fn add(&mut self, of: &[usize], block: impl Fn(usize, usize) -> f64) {
        for (q, &j) in of.iter().enumerate() {
            for (p, &i) in of.iter().enumerate() {
                match &self.at {
                    None => self.values[j * self.n + i] += block(p, q),
                    Some(at) if i >= j => self.values[at.position(i, j)] += block(p, q),
                    Some(_) => {}
                }
            }
        }
    }

    /// Adds to the entries (i, j) and (j, i) of a sparse matrix.
    pub(crate) fn add_entry(&mut self, i: usize, j: usize, by: f64) {
        let at = self.at.as_ref().expect("a sparse matrix").position(i, j);
        self.values[at] += by;
    }

    /// Sets the entries (i, j) and (j, i).
    pub(crate) fn set_entry(&mut self, i: usize, j: usize, value: f64) {
        match &self.at {
            None => (self.values[j * self.n + i], self.values[i * self.n + j]) = (value, value),
            Some(at) => self.values[at.position(i, j)] = value,
        }
    }

    /// Where [`Self::add_square`] will add for the unknowns `of`, which ascend; nothing of a dense matrix.
    pub(crate) fn positions(&self, of: &[usize], out: &mut Vec<usize>) {
        let Some(at) = &self.at else { return };
        for (p, &j) in of.iter().enumerate() {
            let mut k = at.starts[j];
            for &i in &of[p..] {
                while at.rows[k] < i {
                    k += 1;
                }
                debug_assert_eq!(at.rows[k], i);
                out.push(k);
            }
        }
    }

    /// Adds weight · a aᵀ on the unknowns `of`, which ascend, to the lower triangle; of a sparse matrix at `positions`, of
    /// which those are given back that are left.
    pub(crate) fn add_square<'p>(
        &mut self,
        of: &[usize],
        a: &[f64],
        weight: f64,
        positions: &'p [usize],
    ) -> &'p [usize] {
        let mut at = positions;
        for (p, (&j, aj)) in of.iter().zip(a).enumerate() {
            let by = weight * aj;
            if self.at.is_some() {
                let (column, rest) = at.split_at(of.len() - p);
                at = rest;
                column.iter().zip(&a[p..]).for_each(|(&k, a)| self.values[k] += by * a);
            } else {
                let column = &mut self.values[j * self.n..(j + 1) * self.n];
                of[p..].iter().zip(&a[p..]).for_each(|(&i, a)| column[i] += by * a);
            }
        }
        at
    }

    fn diagonal_at(&self, i: usize) -> usize {
        self.at.as_ref().map_or(i * self.n + i, |at| at.starts[i])
    }

    /// An entry of the diagonal.
    pub(crate) fn diagonal(&self, i: usize) -> f64 {
        self.values[self.diagonal_at(i)]
    }

    /// Adds to an entry of the diagonal.
    pub(crate) fn add_to_diagonal(&mut self, i: usize, by: f64) {
        let at = self.diagonal_at(i);
        self.values[at] += by;
    }

    /// Becomes `other`, a matrix of no more rows whose entries this one has room for, with zeros elsewhere.
    pub(crate) fn set(&mut self, other: &Symmetric) {
        let (n, m) = (self.n, other.n);
        match (&self.at, &other.at) {
            (Some(at), Some(of)) if at == of => self.values.copy_from_slice(&other.values),
            (Some(at), _) => {
                self.values.fill(0.0);
                for j in 0..m {
                    let mut k = at.starts[j];
                    other.each_below(j, |i, value| {
                        while at.rows[k] < i {
                            k += 1;
                        }
                        debug_assert!(at.rows[k] == i || value == 0.0);
                        self.values[k] = value;
                    });
                }
            }
            (None, _) if n == m => self.values.copy_from_slice(&other.values),
            (None, _) => {
                self.values.fill(0.0);
                for (column, of) in self.values.chunks_exact_mut(n).zip(other.values.chunks_exact(m)) {
                    column[..m].copy_from_slice(of);
                }
            }
        }
    }

    /// Calls `each` with row and value of the entries of column j from the diagonal on.
    fn each_below(&self, j: usize, mut each: impl FnMut(usize, f64)) {
        match &self.at {
            Some(at) => (at.starts[j]..at.starts[j + 1]).for_each(|k| each(at.rows[k], self.values[k])),
            None => (j..self.n).for_each(|i| each(i, self.values[j * self.n + i])),
        }
    }

    /// out += A (factor · x).
    pub(crate) fn add_times(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        match &self.at {
            None => {
                for (column, x) in self.values.chunks_exact(self.n.max(1)).zip(x) {
                    let x = factor * x;
                    if x != 0.0 {
                        out.iter_mut().zip(column).for_each(|(a, b)| *a += b * x);
                    }
                }
            }
            Some(at) => {
                for j in 0..self.n {
                    let range = at.starts[j] + 1..at.starts[j + 1];
                    let (xj, mut sum) = (factor * x[j], self.values[at.starts[j]] * factor * x[j]);
                    for (&i, value) in at.rows[range.clone()].iter().zip(&self.values[range]) {
                        out[i] += value * xj;
                        sum += value * factor * x[i];
                    }
                    out[j] += sum;
                }
            }
        }
    }

    /// xᵀ A x.
    pub(crate) fn quadratic_form(&self, x: &[f64]) -> f64 {
        let mut image = vec![0.0; self.n];
        self.add_times(1.0, x, &mut image);
        image.iter().zip(x).map(|(a, x)| a * x).sum()
    }

    /// Σ |A_ij| over j ≠ i, row by row.
    pub(crate) fn off_diagonal_sums(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.n];
        for j in 0..self.n {
            self.each_below(j, |i, value| {
                if i != j {
                    sums[i] += value.abs();
                    sums[j] += value.abs();
                }
            });
        }
        sums
    }

    /// Unknowns whose row is not zero.
    pub(crate) fn met(&self) -> Vec<bool> {
        let mut met = vec![false; self.n];
        for j in 0..self.n {
            self.each_below(j, |i, value| {
                if value != 0.0 {
                    (met[i], met[j]) = (true, true);
                }
            });
        }
        met
    }

    /// The dense rows and columns `of`.
    pub(crate) fn block(&self, of: &[usize]) -> faer::Mat<f64> {
        let mut at = vec![usize::MAX; self.n];
        of.iter().enumerate().for_each(|(k, &i)| at[i] = k);
        let mut out = faer::Mat::zeros(of.len(), of.len());
        for &j in of {
            self.each_below(j, |i, value| {
                if at[i] != usize::MAX {
                    out[(at[i], at[j])] = value;
                    out[(at[j], at[i])] = value;
                }
            });
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same sums in a large matrix, whose zeros are left out, and in its dense image.
    #[test]
    fn sparse_and_dense_agree() {
        let n = SPARSE_FROM + 30;
        let cliques: Vec<Vec<usize>> = (0..n - 40).map(|k| vec![(7 * k) % n, k, k + 40]).collect();
        let places = || cliques.iter().filter(|of| of[0] != of[1] && of[0] != of[2]).map(|of| &of[..]);
        let mut sparse = Symmetric::new(n, places());
        let mut dense = faer::Mat::<f64>::zeros(n, n);
        for of in places() {
            let entry = |p: usize, q: usize| ((of[p] * of[q]) as f64).sin();
            sparse.add(of, entry);
            (0..3).for_each(|p| (0..3).for_each(|q| dense[(of[p], of[q])] += entry(p, q)));
        }
        let mut sorted = cliques[11].clone();
        sorted.sort_unstable();
        let (mut at, a) = (Vec::new(), [1.0, -2.0, 0.5]);
        sparse.positions(&sorted, &mut at);
        assert!(sparse.add_square(&sorted, &a, 3.0, &at).is_empty());
        (0..3).for_each(|p| (0..3).for_each(|q| dense[(sorted[p], sorted[q])] += 3.0 * a[p] * a[q]));
        sparse.add_to_diagonal(5, 1.5);
        dense[(5, 5)] += 1.5;
        let all: Vec<usize> = (0..n).collect();
        let close = |a: &faer::Mat<f64>, b: &faer::Mat<f64>| (a - b).norm_max() < 1e-12;
        assert!(sparse.entries().is_some() && close(&sparse.block(&all), &dense));

        let x: Vec<f64> = (0..n).map(|i| (0.3 * i as f64).cos()).collect();
        let mut out = vec![1.0; n];
        sparse.add_times(-2.0, &x, &mut out);
        for i in 0..n {
            let row = (0..n).map(|j| dense[(i, j)] * x[j]).sum::<f64>();
            assert!((out[i] - (1.0 - 2.0 * row)).abs() < 1e-10);
            let others = (0..n).filter(|j| *j != i).map(|j| dense[(i, j)].abs()).sum::<f64>();
            assert!((sparse.off_diagonal_sums()[i] - others).abs() < 1e-10);
            assert_eq!(sparse.met()[i], (0..n).any(|j| dense[(i, j)] != 0.0));
        }
        // In the corner of a larger one with more room.
        let around = Symmetric::around(&sparse, n + 1, [&[3, n][..]]);
        assert!(close(&around.block(&all), &dense) && around.diagonal(n) == 0.0);
    }

    /// A dense matrix keeps all its entries where it becomes part of a sparse one.
    #[test]
    fn the_step_from_dense_to_sparse() {
        let n = SPARSE_FROM - 1;
        let mut dense = Symmetric::new(n, []);
        dense.add(&[2, 77, 5], |p, q| (1 + p + q) as f64);
        let grown = Symmetric::around(&dense, n + 1, []);
        assert!(dense.entries().is_none() && grown.entries().is_some());
        let all: Vec<usize> = (0..n).collect();
        assert_eq!(grown.block(&all), dense.block(&all));
    }
}
