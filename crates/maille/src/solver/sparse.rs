//! Patterns of sparse symmetric matrices, with what Cholesky's factorisation takes from the pattern alone.
//!
//! In a sheet's Hessian unknowns come in groups (`GROUP`): its pattern and the order of elimination (approximate minimum
//! degree) are those of the graph of groups, a sixth of the size. They are kept as long as they hold every block that is
//! wanted and not many more: contacts come and go, and a new pattern costs more than a factorisation.

use faer::{
    Side,
    dyn_stack::{MemBuffer, MemStack},
    perm::PermRef,
    sparse::{
        SymbolicSparseColMatRef,
        linalg::{
            amd,
            cholesky::{CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky},
        },
    },
};
use std::sync::{Arc, OnceLock};

/// Unknowns of a group: a rigid body's.
pub(crate) const GROUP: usize = 6;
/// A pattern is replaced once it has more blocks than this times those wanted.
const STALE: f64 = 1.5;

/// Where the lower triangle is not zero: each column's rows ascending, the diagonal first.
#[derive(Debug)]
pub(crate) struct Entries {
    /// First entry of each column, and the number of all.
    pub starts: Vec<usize>,
    /// Row of each entry.
    pub rows: Vec<usize>,
    /// The graph of groups, where all entries of their blocks are there.
    groups: Option<Box<Entries>>,
    symbolic: OnceLock<Option<SymbolicCholesky<usize>>>,
}

impl PartialEq for Entries {
    fn eq(&self, other: &Self) -> bool {
        self.starts == other.starts && self.rows == other.rows
    }
}

impl Eq for Entries {}

impl Entries {
    /// The diagonal, the entries of `first`, and what `cliques` of unknowns reach.
    pub(crate) fn new<'c>(n: usize, first: Option<&Entries>, cliques: impl IntoIterator<Item = &'c [usize]>) -> Self {
        let mut columns: Vec<Vec<usize>> = (0..n).map(|i| vec![i]).collect();
        if let Some(first) = first {
            (0..first.n()).for_each(|j| columns[j].extend_from_slice(first.column(j)));
        }
        let mut last: &[usize] = &[];
        for clique in cliques {
            // Rows of one pair follow one another.
            if clique == last {
                continue;
            }
            last = clique;
            for &j in clique {
                columns[j].extend(clique.iter().filter(|i| **i > j));
            }
        }
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
        }
        Self::of_columns(columns)
    }

    /// The whole triangle.
    pub(crate) fn full(n: usize) -> Self {
        Self::of_columns((0..n).map(|j| (j..n).collect()))
    }

    fn of_columns(columns: impl IntoIterator<Item = Vec<usize>>) -> Self {
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in columns {
            rows.extend(column);
            starts.push(rows.len());
        }
        Entries { starts, rows, groups: None, symbolic: OnceLock::new() }
    }

    /// All entries of the blocks that `groups` has, of `n` unknowns.
    fn of_groups(n: usize, groups: Entries) -> Self {
        let rows = |column: usize| {
            let blocks = groups.column(column / GROUP).iter().flat_map(|block| unknowns(*block, n));
            blocks.filter(|row| *row >= column).collect()
        };
        let all = Self::of_columns((0..n).map(rows));
        Entries { groups: Some(Box::new(groups)), ..all }
    }

    fn n(&self) -> usize {
        self.starts.len() - 1
    }

    fn column(&self, j: usize) -> &[usize] {
        &self.rows[self.starts[j]..self.starts[j + 1]]
    }

    /// Where the entry (i, j) or (j, i) stands.
    ///
    /// # Panics
    /// Where there is none.
    pub(crate) fn position(&self, i: usize, j: usize) -> usize {
        let (row, column) = (i.max(j), i.min(j));
        let start = self.starts[column];
        let found = |rows: &[usize], row: usize| rows.binary_search(&row).expect("a clique reaches the entry");
        let Some(groups) = &self.groups else { return start + found(self.column(column), row) };
        // The diagonal block has the entries from the diagonal on; blocks before this one are full, but for the last
        // group, which no block follows.
        match found(groups.column(column / GROUP), row / GROUP) {
            0 => start + row - column,
            index => start + (GROUP - column % GROUP) + GROUP * (index - 1) + row % GROUP,
        }
    }

    /// The pattern as faer wants it.
    pub(super) fn as_faer(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.n(), self.n(), &self.starts, None, &self.rows)
    }

    /// The order of elimination, and where the factor is not zero; `None` if there is not enough memory.
    pub(super) fn symbolic(&self) -> Option<&SymbolicCholesky<usize>> {
        self.symbolic.get_or_init(|| self.analysed()).as_ref()
    }

    fn analysed(&self) -> Option<SymbolicCholesky<usize>> {
        let by = |order| {
            factorize_symbolic_cholesky(self.as_faer(), Side::Lower, order, CholeskySymbolicParams::default()).ok()
        };
        let Some(groups) = &self.groups else { return by(SymmetricOrdering::Amd) };
        let n = self.n();
        let forward: Vec<usize> = groups.order()?.into_iter().flat_map(|group| unknowns(group, n)).collect();
        let mut inverse = vec![0; n];
        forward.iter().enumerate().for_each(|(at, k)| inverse[*k] = at);
        by(SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, n)))
    }

    fn order(&self) -> Option<Vec<usize>> {
        let n = self.n();
        let (mut forward, mut inverse) = (vec![0; n], vec![0; n]);
        let mut memory = MemBuffer::try_new(amd::order_scratch::<usize>(n, self.rows.len())).ok()?;
        let room = MemStack::new(&mut memory);
        amd::order(&mut forward, &mut inverse, self.as_faer(), amd::Control::default(), room).ok()?;
        Some(forward)
    }
}

/// Unknowns of a group, of `n` in all.
fn unknowns(group: usize, n: usize) -> std::ops::Range<usize> {
    GROUP * group..(GROUP * (group + 1)).min(n)
}

/// The pattern of the last matrix, for the next.
#[derive(Default)]
pub struct Patterns {
    last: Option<Arc<Entries>>,
    /// Patterns made, for reports and tests.
    pub made: usize,
}

impl Patterns {
    /// A pattern of `n` unknowns with all blocks that these cliques of groups reach.
    pub(crate) fn with<'c>(
        &mut self,
        n: usize,
        cliques: impl IntoIterator<Item = &'c [usize]> + Clone,
    ) -> Arc<Entries> {
        let size = n.div_ceil(GROUP);
        let mut wanted = Entries::new(size, None, cliques.clone());
        let last = self.last.as_ref().filter(|last| last.n() == n);
        if let Some((last, groups)) = last.and_then(|last| Some((last, last.groups.as_deref()?)))
            && groups.rows.len() as f64 <= STALE * wanted.rows.len() as f64
        {
            let has = |g: usize| wanted.column(g).iter().all(|row| groups.column(g).binary_search(row).is_ok());
            if (0..size).all(has) {
                return last.clone();
            }
            wanted = Entries::new(size, Some(groups), cliques);
        }
        self.made += 1;
        let made = Arc::new(Entries::of_groups(n, wanted));
        self.last = Some(made.clone());
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{cholesky::Cholesky, symmetric::Symmetric};
    use faer::Mat;

    /// A ring of groups with a last one that is not full, and a block across: solved, kept while it fits, replaced when not.
    #[test]
    fn solves_and_keeps_its_pattern() {
        let n: usize = 6 * 40 + 3;
        let groups = n.div_ceil(GROUP);
        let chain: Vec<[usize; 2]> = (1..groups).map(|g| [g - 1, g]).chain([[0, groups - 1]]).collect();
        let of = |pairs: &[[usize; 2]], patterns: &mut Patterns| patterns.with(n, pairs.iter().map(|pair| &pair[..]));
        let mut patterns = Patterns::default();
        let pattern = of(&chain, &mut patterns);
        let mut matrix = Symmetric::sparse(pattern.clone());
        let mut dense = Mat::<f64>::zeros(n, n);
        for c in 0..n {
            for &r in pattern.column(c) {
                let value = ((3 * r + 7 * c) as f64).sin() * 0.2 + if r == c { 6.5 } else { 0.0 };
                matrix.add_entry(r, c, value);
                (dense[(r, c)], dense[(c, r)]) = (value, value);
            }
        }
        assert_eq!(pattern.rows.len(), (groups - 1) * (21 + 36) + 6, "all entries of all blocks");
        let x: Vec<f64> = (0..n).map(|k| (0.37 * k as f64).cos()).collect();
        let mut right: Vec<f64> = (0..n).map(|i| (0..n).map(|j| dense[(i, j)] * x[j]).sum()).collect();
        let mut system = Cholesky::new(matrix);
        assert!(system.factor());
        system.solve(&mut right);
        assert!(right.iter().zip(&x).all(|(f, x)| (f - x).abs() < 1e-12));
        (0..n).for_each(|k| system.matrix_mut().add_to_diagonal(k, -20.0));
        assert!(!system.factor());

        assert!(Arc::ptr_eq(&of(&chain[1..], &mut patterns), &pattern) && patterns.made == 1);
        let more: Vec<[usize; 2]> = chain.iter().copied().chain([[3, 30]]).collect();
        let other = of(&more, &mut patterns);
        let has = |pattern: &Entries| pattern.column(6 * 3).contains(&(6 * 30));
        assert!(has(&other) && !has(&pattern));
        of(&[], &mut patterns);
        assert_eq!(patterns.made, 3, "an empty pattern is much smaller");
    }
}
