//! Cholesky's factorisation of large sparse matrices whose pattern changes little from one to the next.
//!
//! Unknowns come in groups ([`GROUP`]): the pattern and the order of elimination (approximate minimum degree) are those of
//! the graph of groups, a sixth of the size. They are kept as long as they hold every block that is wanted and not many
//! more: contacts come and go, and a new pattern costs more than a factorisation.

use faer::{
    Mat, Par, Side, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::cholesky::llt::factor::LltRegularization,
    perm::PermRef,
    sparse::{
        SparseColMatRef, SymbolicSparseColMatRef,
        linalg::{
            amd,
            cholesky::{
                CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
            },
        },
    },
};
use std::sync::Arc;

/// Unknowns of a group: a rigid body's.
pub const GROUP: usize = 6;
/// A pattern is replaced once it has more blocks than this times those wanted.
const STALE: f64 = 1.5;

/// A pair of groups, column and row, the row not before the column.
type Pair = (u32, u32);

/// Blocks of the lower triangle, their entries column by column, and the order of elimination.
pub struct Pattern {
    n: usize,
    /// Blocks of each column of groups, the diagonal one first.
    first_block: Vec<usize>,
    row_of_block: Vec<u32>,
    /// Entries of the lower triangle.
    first_entry: Vec<usize>,
    row_of_entry: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
}

impl Pattern {
    /// The pattern of these blocks (sorted, each once, with every diagonal one) of `n` unknowns; `None` if there is not
    /// enough memory.
    fn new(n: usize, pairs: &[Pair]) -> Option<Self> {
        let groups = n.div_ceil(GROUP);
        let mut first_block = vec![0; groups + 1];
        pairs.iter().for_each(|p| first_block[p.0 as usize + 1] += 1);
        (0..groups).for_each(|g| first_block[g + 1] += first_block[g]);
        let row_of_block: Vec<u32> = pairs.iter().map(|p| p.1).collect();
        let of_group = |g: usize| GROUP * g..(GROUP * (g + 1)).min(n);
        let (mut first_entry, mut row_of_entry) = (vec![0], Vec::new());
        for column in 0..n {
            let group = column / GROUP;
            for &row in &row_of_block[first_block[group]..first_block[group + 1]] {
                row_of_entry.extend(of_group(row as usize).filter(|r| *r >= column));
            }
            first_entry.push(row_of_entry.len());
        }
        let forward = Self::order(groups, &first_block, &row_of_block)?;
        let forward: Vec<usize> = forward.into_iter().flat_map(of_group).collect();
        let mut inverse = vec![0; n];
        forward.iter().enumerate().for_each(|(at, k)| inverse[*k] = at);
        let entries = SymbolicSparseColMatRef::new_checked(n, n, &first_entry, None, &row_of_entry);
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, n));
        let symbolic =
            factorize_symbolic_cholesky(entries, Side::Lower, order, CholeskySymbolicParams::default()).ok()?;
        Some(Pattern { n, first_block, row_of_block, first_entry, row_of_entry, symbolic })
    }

    /// The order in which groups are eliminated.
    fn order(groups: usize, first_block: &[usize], row_of_block: &[u32]) -> Option<Vec<usize>> {
        let rows: Vec<usize> = row_of_block.iter().map(|r| *r as usize).collect();
        let graph = SymbolicSparseColMatRef::new_checked(groups, groups, first_block, None, &rows);
        let (mut forward, mut inverse) = (vec![0; groups], vec![0; groups]);
        let mut memory = MemBuffer::try_new(amd::order_scratch::<usize>(groups, rows.len())).ok()?;
        amd::order(&mut forward, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut memory)).ok()?;
        Some(forward)
    }

    /// Where the entry stands among the values; `None` if the pattern lacks its block.
    fn position(&self, row: usize, column: usize) -> Option<usize> {
        let (group, block) = (column / GROUP, (row / GROUP) as u32);
        let first = self.first_block[group];
        let blocks = &self.row_of_block[first..self.first_block[group + 1]];
        let index = blocks.binary_search(&block).ok()?;
        let start = self.first_entry[column];
        // The diagonal block has the entries from the diagonal on; blocks before this one are full, but for the last
        // group, which no block follows.
        Some(match index {
            0 => start + row - column,
            _ => start + (GROUP - column % GROUP) + GROUP * (index - 1) + row % GROUP,
        })
    }

    fn pairs(&self) -> impl Iterator<Item = Pair> {
        (0..self.first_block.len() - 1).flat_map(|g| {
            self.row_of_block[self.first_block[g]..self.first_block[g + 1]].iter().map(move |row| (g as u32, *row))
        })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.n
    }

    /// Entries of the lower triangle, and of its factor.
    pub fn sizes(&self) -> [usize; 2] {
        [self.row_of_entry.len(), self.symbolic.len_val()]
    }

    /// Values that are all zero.
    pub fn zeros(&self) -> Vec<f64> {
        vec![0.0; self.row_of_entry.len()]
    }

    /// Adds to an entry of the lower triangle, whose block the pattern has.
    pub fn add(&self, values: &mut [f64], row: usize, column: usize, by: f64) {
        match self.position(row, column) {
            Some(at) => values[at] += by,
            None => debug_assert!(false, "the pattern lacks ({row}, {column})"),
        }
    }

    /// vᵀ A v.
    pub fn quadratic_form(&self, values: &[f64], v: &[f64]) -> f64 {
        let mut sum = 0.0;
        for column in 0..self.n {
            for k in self.first_entry[column]..self.first_entry[column + 1] {
                let row = self.row_of_entry[k];
                let times = if row == column { 1.0 } else { 2.0 };
                sum += times * values[k] * v[row] * v[column];
            }
        }
        sum
    }

    /// The factor of the matrix plus `shift` times the unit matrix; `None` where it is not positive.
    pub fn factor(&self, values: &[f64], shift: f64) -> Option<Factor<'_>> {
        let mut shifted = values.to_vec();
        (0..self.n).for_each(|k| shifted[self.first_entry[k]] += shift);
        let entries = SymbolicSparseColMatRef::new_checked(self.n, self.n, &self.first_entry, None, &self.row_of_entry);
        let matrix = SparseColMatRef::new(entries, &shifted);
        let mut factor = vec![0.0; self.symbolic.len_val()];
        let need = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let mut memory = MemBuffer::try_new(need).ok()?;
        let stack = MemStack::new(&mut memory);
        let regularization = LltRegularization::default();
        self.symbolic
            .factorize_numeric_llt(&mut factor, matrix, Side::Lower, regularization, Par::Seq, stack, Spec::default())
            .ok()?;
        Some(Factor { pattern: self, values: factor })
    }
}

/// A factor L with A + shift·1 = L Lᵀ.
pub struct Factor<'a> {
    pattern: &'a Pattern,
    values: Vec<f64>,
}

impl Factor<'_> {
    /// The solution for a right side; `None` if there is not enough memory.
    pub fn solve(&self, right: &[f64]) -> Option<Vec<f64>> {
        let symbolic = &self.pattern.symbolic;
        let mut x = Mat::from_fn(right.len(), 1, |i, _| right[i]);
        let mut memory = MemBuffer::try_new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)).ok()?;
        let stack = MemStack::new(&mut memory);
        LltRef::new(symbolic, &self.values).solve_in_place_with_conj(faer::Conj::No, x.as_mut(), Par::Seq, stack);
        Some(x.col(0).iter().copied().collect())
    }
}

/// The pattern of the last matrix, for the next.
#[derive(Default)]
pub struct Patterns {
    last: Option<Arc<Pattern>>,
    /// Patterns made, for reports and tests.
    pub made: usize,
}

impl Patterns {
    /// A pattern with all these blocks of groups, of `n` unknowns; `None` if there is not enough memory.
    pub fn with(&mut self, n: usize, mut pairs: Vec<Pair>) -> Option<Arc<Pattern>> {
        pairs.extend((0..n.div_ceil(GROUP) as u32).map(|g| (g, g)));
        pairs.sort_unstable();
        pairs.dedup();
        let wanted = pairs.len();
        if let Some(last) = self.last.as_ref().filter(|last| last.n == n) {
            let has = |p: &Pair| {
                let blocks = &last.row_of_block[last.first_block[p.0 as usize]..last.first_block[p.0 as usize + 1]];
                blocks.binary_search(&p.1).is_ok()
            };
            let stale = last.row_of_block.len() as f64 > STALE * wanted as f64;
            if !stale && pairs.iter().all(has) {
                return Some(last.clone());
            }
            if !stale {
                pairs.extend(last.pairs());
                pairs.sort_unstable();
                pairs.dedup();
            }
        }
        self.made += 1;
        self.last = Some(Arc::new(Pattern::new(n, &pairs)?));
        self.last.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of groups with a last one that is not full, and a block across: solved, kept while it fits, replaced when not.
    #[test]
    fn solves_and_keeps_its_pattern() {
        let n: usize = 6 * 40 + 3;
        let groups = n.div_ceil(GROUP) as u32;
        let chain: Vec<Pair> = (1..groups).map(|g| (g - 1, g)).chain([(0, groups - 1)]).collect();
        let mut patterns = Patterns::default();
        let pattern = patterns.with(n, chain.clone()).unwrap();
        let mut values = pattern.zeros();
        let mut dense = Mat::<f64>::zeros(n, n);
        for (column, row) in pattern.pairs().collect::<Vec<_>>() {
            for r in (GROUP * row as usize..n).take(GROUP) {
                for c in (GROUP * column as usize..n).take(GROUP).filter(|c| *c <= r) {
                    let value = ((3 * r + 7 * c) as f64).sin() * 0.2 + if r == c { 6.0 } else { 0.0 };
                    pattern.add(&mut values, r, c, value);
                    (dense[(r, c)], dense[(c, r)]) = (value, value);
                }
            }
        }
        let x: Vec<f64> = (0..n).map(|k| (0.37 * k as f64).cos()).collect();
        let times = |x: &[f64], shift: f64| -> Vec<f64> {
            (0..n).map(|i| (0..n).map(|j| dense[(i, j)] * x[j]).sum::<f64>() + shift * x[i]).collect()
        };
        let found = pattern.factor(&values, 0.5).unwrap().solve(&times(&x, 0.5)).unwrap();
        assert!(found.iter().zip(&x).all(|(f, x)| (f - x).abs() < 1e-12));
        let form: f64 = times(&x, 0.0).iter().zip(&x).map(|(a, b)| a * b).sum();
        assert!((pattern.quadratic_form(&values, &x) - form).abs() < 1e-10 * form);
        assert!(pattern.factor(&values, -20.0).is_none());

        let fewer = chain[1..].to_vec();
        assert!(Arc::ptr_eq(&patterns.with(n, fewer).unwrap(), &pattern) && patterns.made == 1);
        let other = patterns.with(n, chain.iter().copied().chain([(3, 30)]).collect()).unwrap();
        assert!(other.position(6 * 30, 6 * 3).is_some() && pattern.position(6 * 30, 6 * 3).is_none());
        patterns.with(n, Vec::new()).unwrap();
        assert_eq!(patterns.made, 3, "an empty pattern is much smaller");
    }
}
