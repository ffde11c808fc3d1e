//! The rows of a program, gaps g ≥ 0 with derivatives, and the multipliers that go with them from point to point.

use super::symmetric::Symmetric;

/// One gap g(x) ≥ 0 with its derivatives in the unknowns `columns`.
#[derive(Clone, Debug)]
pub struct Row {
    /// What the row belongs to; several rows may share it.
    pub key: u64,
    /// Tells apart the rows of one key; changes little from point to point.
    pub angle: f64,
    /// The same, where one number does not tell them apart; else 0.
    pub angle_a: f64,
    /// Value.
    pub gap: f64,
    /// A true gap; otherwise a sample beside one, valid but never the smallest.
    pub minimum: bool,
    /// The unknowns that it depends on.
    pub columns: Vec<usize>,
    /// ∂g in those.
    pub gradient: Vec<f64>,
    /// ∂²g in those, k × k; empty where it was not asked for.
    pub hessian: Vec<f64>,
}

impl Row {
    /// Its multiplier, of size `value`.
    pub(crate) fn multiplier(&self, value: f64) -> Multiplier {
        Multiplier { key: self.key, angle: self.angle, angle_a: self.angle_a, minimum: self.minimum, value }
    }

    /// A row without derivatives.
    pub(crate) fn value(key: u64, angle: f64, gap: f64) -> Row {
        Row {
            key,
            angle,
            angle_a: 0.0,
            gap,
            minimum: true,
            columns: Vec::new(),
            gradient: Vec::new(),
            hessian: Vec::new(),
        }
    }
}

/// Which derivatives of the rows are wanted.
#[derive(Clone, Copy, Debug)]
pub enum Derivatives<'a> {
    /// None: gaps alone.
    None,
    /// Gradients.
    First,
    /// Gradients, and Hessians of the rows to which one of these multipliers belongs.
    Second(&'a Loads),
}

/// A multiplier with the row that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiplier {
    /// Key of the row.
    pub key: u64,
    /// Angle of the row.
    pub angle: f64,
    /// Second angle of the row.
    pub angle_a: f64,
    /// Whether the row is a true gap.
    pub minimum: bool,
    /// μ ≥ 0.
    pub value: f64,
}

/// Largest violation among `rows`.
pub(crate) fn violation(rows: &[Row]) -> f64 {
    rows.iter().map(|r| -r.gap).fold(0.0, f64::max)
}

/// Multipliers to be looked up by their rows.
#[derive(Clone, Debug)]
pub struct Loads {
    /// By key; in the given order under one key.
    sorted: Vec<Multiplier>,
}

impl Loads {
    /// Of `known`.
    pub fn new(known: &[Multiplier]) -> Self {
        let mut sorted = known.to_vec();
        sorted.sort_by_key(|m| m.key);
        Loads { sorted }
    }

    /// Whether a row with this key has a positive multiplier.
    pub(crate) fn carries(&self, key: u64) -> bool {
        let of_key = self.sorted[self.sorted.partition_point(|m| m.key < key)..].iter().take_while(|m| m.key == key);
        of_key.into_iter().any(|m| m.value > 0.0)
    }

    /// The multiplier of each of `rows`: that of the nearest angle under the same key, or 0. Of two rows that are near to one multiplier, as two minima
    /// of a pair are before they merge, the nearer one has it.
    pub fn of(&self, rows: &[Row]) -> Vec<f64> {
        let nearest: Vec<_> = rows.iter().map(|row| self.nearest(row)).collect();
        let mut out = vec![0.0; rows.len()];
        let mut order: Vec<(usize, f64, usize)> =
            nearest.iter().enumerate().filter_map(|(row, found)| found.map(|(k, apart)| (k, apart, row))).collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for of_one in order.chunk_by(|a, b| a.0 == b.0) {
            let (k, _, row) = of_one[0];
            out[row] = self.sorted[k].value;
        }
        out
    }

    /// Whether a row with this key, angles and kind may have a multiplier that is not 0.
    pub(crate) fn may_load(&self, row: &Row) -> bool {
        self.nearest(row).is_some_and(|(k, _)| self.sorted[k].value != 0.0)
    }

    /// The place of the nearest multiplier, and how far its angles are.
    fn nearest(&self, row: &Row) -> Option<(usize, f64)> {
        let Row { key, minimum, .. } = *row;
        let between = |x: f64, y: f64| {
            let turn = (x - y).rem_euclid(std::f64::consts::TAU);
            turn.min(std::f64::consts::TAU - turn)
        };
        let apart = |m: &Multiplier| between(m.angle, row.angle).max(between(m.angle_a, row.angle_a));
        let first = self.sorted.partition_point(|m| m.key < key);
        let of_key = self.sorted[first..].iter().enumerate().take_while(|(_, m)| m.key == key);
        of_key
            .filter(|(_, m)| m.minimum == minimum)
            .map(|(k, m)| (first + k, apart(m)))
            .filter(|(_, apart)| *apart < if minimum { 0.4 } else { 0.05 })
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// −Σ μ ∇²g over all unknowns; the rows with μ ≠ 0 must have Hessians. There is room for `more` blocks.
pub(crate) fn lagrangian_hessian<'r>(
    n: usize,
    rows: impl IntoIterator<Item = &'r Row> + Clone,
    multipliers: &[f64],
    more: &[&[usize]],
) -> Symmetric {
    let loaded = || rows.clone().into_iter().zip(multipliers).filter(|(_, mu)| **mu != 0.0);
    let cliques = loaded().map(|(row, _)| &row.columns[..]);
    let mut h = Symmetric::new(n, cliques.chain(more.iter().copied()));
    for (row, mu) in loaded() {
        let k = row.columns.len();
        assert_eq!(row.hessian.len(), k * k, "a loaded row without its Hessian");
        h.add(&row.columns, |p, q| -mu * row.hessian[p * k + q]);
    }
    h
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two minima of a pair that are about to merge: the force of one is not that of the other, too.
    #[test]
    fn of_two_rows_near_one_multiplier_the_nearer_has_it() {
        let row = |key, angle| Row { minimum: true, ..Row::value(key, angle, 0.0) };
        let known = |key, angle, value| Multiplier { key, angle, angle_a: 0.0, minimum: true, value };
        let rows = [row(7, -1.37), row(7, -1.67), row(8, 3.1), row(9, 0.0)];
        let of = |known: &[Multiplier]| Loads::new(known).of(&rows);
        assert_eq!(of(&[known(7, -1.36, 0.5), known(8, -3.1, 2.0)]), [0.5, 0.0, 2.0, 0.0]);
        assert_eq!(of(&[known(7, -1.36, 0.5), known(7, -1.7, -0.1)]), [0.5, -0.1, 0.0, 0.0]);
        assert_eq!(of(&[known(7, -1.6, 0.5), known(9, 0.5, 1.0)]), [0.0, 0.5, 0.0, 0.0]);
    }
}
