//! The rows of a program, gaps g ≥ 0 with derivatives, and the multipliers that go with them from point to point.

use super::symmetric::Symmetric;

/// One gap g(x) ≥ 0 with its derivatives in the unknowns `columns`.
#[derive(Clone, Debug)]
pub struct Row {
    /// What the row belongs to; several rows may share it.
    pub key: u64,
    /// Tells apart the rows of one key; changes little from point to point.
    pub angle: f64,
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
        Multiplier { key: self.key, angle: self.angle, minimum: self.minimum, value }
    }

    /// A row without derivatives.
    pub(crate) fn value(key: u64, angle: f64, gap: f64) -> Row {
        Row { key, angle, gap, minimum: true, columns: Vec::new(), gradient: Vec::new(), hessian: Vec::new() }
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

    /// Multiplier of `row`: that of the nearest angle under the same key, or 0.
    pub fn of(&self, row: &Row) -> f64 {
        self.at(row.key, row.angle, row.minimum)
    }

    /// [`Self::of`] the row with this key, angle and kind.
    pub(crate) fn at(&self, key: u64, angle: f64, minimum: bool) -> f64 {
        let apart = |m: &Multiplier| {
            let turn = (m.angle - angle).rem_euclid(std::f64::consts::TAU);
            turn.min(std::f64::consts::TAU - turn)
        };
        self.sorted[self.sorted.partition_point(|m| m.key < key)..]
            .iter()
            .take_while(|m| m.key == key)
            .filter(|m| m.minimum == minimum)
            .map(|m| (apart(m), m.value))
            .filter(|(apart, _)| *apart < if minimum { 0.4 } else { 0.05 })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(0.0, |(_, value)| value)
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
