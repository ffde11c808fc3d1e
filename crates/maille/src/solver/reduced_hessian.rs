//! The curvature of H on the motions that keep some rows: its least value that is not zero, and its zero modes.
//!
//! With few unknowns by eigenvalues, on an orthonormal basis of the null space of the rows A. With many by counting: by
//! Sylvester's law as many eigenvalues of M = H + ρ AᵀA lie below σ as M − σ = L D Lᵀ has negative pivots D. Motions that
//! keep the rows see H alone, others are stiff. By the minimax principle no eigenvalue of M lies above the one of H on the null
//! space that it stands for; it lies lower by |dμ|²/ρ, where dμ is what the multipliers change along the unit motion.

use super::{constraints::Row, eigen::symmetric_eigen, symmetric::Symmetric};
use faer::{
    Mat, Par, Side, Spec,
    dyn_stack::{MemBuffer, MemStack},
    sparse::{
        SparseColMatRef,
        linalg::{
            SupernodalThreshold,
            cholesky::{
                CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
                factorize_symbolic_cholesky,
            },
        },
    },
};

/// Curvature below which a direction counts as a zero mode, relative to the largest curvature.
pub(crate) const ZERO_MODE: f64 = 1e-7;
/// ρ, relative to the largest curvature: rounding of ρ AᵀA stays a hundredth of what counts as zero.
const STIFF: f64 = 1e7;
/// The least curvature is found to this share of it.
const PRECISION: f64 = 1e-7;

/// Least non-zero curvature of `h` on the null space of `loaded`, and the number of its zero modes. No curvature where nothing
/// but zero modes is left, NaN where it could not be found.
pub(super) fn curvature(h: &Symmetric, loaded: &[&Row]) -> (Option<f64>, usize) {
    let found = match h.entries() {
        None => by_eigenvalues(h, loaded),
        Some(_) => by_counting(h, loaded),
    };
    found.unwrap_or((Some(f64::NAN), 0))
}

fn by_eigenvalues(h: &Symmetric, loaded: &[&Row]) -> Option<(Option<f64>, usize)> {
    let n = h.n();
    let mut gram = Symmetric::new(n, loaded.iter().map(|row| &row.columns[..]));
    for row in loaded {
        gram.add(&row.columns, |p, q| row.gradient[p] * row.gradient[q]);
    }
    // Unknowns that neither meets are zero modes.
    let is_met: Vec<bool> = h.met().iter().zip(gram.met()).map(|(a, b)| *a || b).collect();
    let met: Vec<usize> = (0..n).filter(|&j| is_met[j]).collect();
    let idle = n - met.len();
    let eigen = symmetric_eigen(&gram.block(&met)).ok()?;
    let largest = eigen.values.last().copied().unwrap_or(0.0).max(1e-300);
    let free: Vec<usize> = (0..met.len()).filter(|&k| eigen.values[k] < 1e-12 * largest).collect();
    let basis = Mat::from_fn(met.len(), free.len(), |i, k| eigen.vectors[(i, free[k])]);
    if free.is_empty() {
        return Some((None, idle));
    }
    let reduced = basis.transpose() * h.block(&met) * &basis;
    let symmetric = Mat::from_fn(free.len(), free.len(), |i, j| 0.5 * (reduced[(i, j)] + reduced[(j, i)]));
    let eigen = symmetric_eigen(&symmetric).ok()?;
    let scale = eigen.values.iter().fold(0.0f64, |a, v| a.max(v.abs())).max(1e-300);
    let is_zero = |v: &f64| v.abs() <= ZERO_MODE * scale.max(1.0);
    let zero_modes = idle + eigen.values.iter().filter(|v| is_zero(v)).count();
    Some((eigen.values.iter().copied().find(|v| !is_zero(v)), zero_modes))
}

fn by_counting(h: &Symmetric, loaded: &[&Row]) -> Option<(Option<f64>, usize)> {
    let n = h.n();
    let sums = h.off_diagonal_sums();
    // Not less than any |eigenvalue|.
    let scale = sums.iter().enumerate().map(|(i, sum)| sum + h.diagonal(i).abs()).fold(1e-300, f64::max);
    let steepest = loaded.iter().map(|row| row.gradient.iter().map(|a| a * a).sum()).fold(1e-300, f64::max);
    let stiff = STIFF * scale.max(1.0) / steepest;
    let mut matrix = Symmetric::around(h, n, loaded.iter().map(|row| &row.columns[..]));
    for row in loaded {
        matrix.add(&row.columns, |p, q| stiff * row.gradient[p] * row.gradient[q]);
    }
    let mut counter = Counter::new(matrix)?;
    let zero = ZERO_MODE * scale.max(1.0);
    let (negative, flat) = (counter.below(-zero)?, counter.below(zero)?);
    // The least eigenvalue outside ±zero lies between these.
    let (mut low, mut high, before) = match negative {
        0 => (zero, 2.0 * scale, flat),
        _ => (-2.0 * scale, -zero, 0),
    };
    if high <= low || counter.below(high)? == before {
        return Some((None, flat - negative));
    }
    while high - low > PRECISION * low.abs().min(high.abs()) {
        // Halves the ratio while that is large.
        let (a, b) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
        let middle = if b > 4.0 * a { (a * b).sqrt().copysign(low) } else { 0.5 * (low + high) };
        match counter.below(middle)? > before {
            true => high = middle,
            false => low = middle,
        }
    }
    Some((Some(0.5 * (low + high)), flat - negative))
}

/// Counts eigenvalues of a sparse matrix.
struct Counter {
    matrix: Symmetric,
    shifted: Symmetric,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    room: MemBuffer,
}

impl Counter {
    fn new(matrix: Symmetric) -> Option<Self> {
        // Column by column: the pivots stand where the columns begin.
        let columns = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..Default::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(matrix.entries()?.as_faer(), Side::Lower, SymmetricOrdering::Amd, columns)
                .ok()?;
        let need = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default());
        let (factor, room) = (vec![0.0; symbolic.len_val()], MemBuffer::try_new(need).ok()?);
        Some(Counter { shifted: matrix.clone(), matrix, symbolic, factor, room })
    }

    /// Number of eigenvalues below `sigma`; `None` where a pivot vanishes.
    fn below(&mut self, sigma: f64) -> Option<usize> {
        self.shifted.set(&self.matrix);
        (0..self.matrix.n()).for_each(|i| self.shifted.add_to_diagonal(i, -sigma));
        let matrix = SparseColMatRef::new(self.shifted.entries()?.as_faer(), self.shifted.values());
        let room = MemStack::new(&mut self.room);
        let (symbolic, factor) = (&self.symbolic, &mut self.factor);
        symbolic
            .factorize_numeric_ldlt(factor, matrix, Side::Lower, Default::default(), Par::Seq, room, Spec::default())
            .ok()?;
        let SymbolicCholeskyRaw::Simplicial(columns) = symbolic.raw() else { return None };
        let starts = &columns.col_ptr()[..self.matrix.n()];
        Some(starts.iter().filter(|k| self.factor[**k] < 0.0).count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs with held ends, some links taken as rows, some unknowns left out: both ways see the same.
    #[test]
    fn counting_agrees_with_eigenvalues() {
        let n = 260;
        for (softest, rows) in [(0.3, 40), (0.3, 0), (-0.05, 40)] {
            let chain = |h: &mut Symmetric| {
                for k in 1..n - 20 {
                    let stiff = if k % 9 == 4 { softest } else { 1.0 };
                    h.add(&[k - 1, k], |p, q| if p == q { stiff } else { -stiff });
                }
            };
            let pairs: Vec<[usize; 2]> = (1..n).map(|k| [k - 1, k]).collect();
            let mut h = Symmetric::new(n, pairs.iter().map(|pair| &pair[..]));
            chain(&mut h);
            let rows: Vec<Row> = (0..rows)
                .map(|k| Row { columns: vec![3 * k, 3 * k + 1], gradient: vec![1.0, -0.5], ..Row::value(0, 0.0, 0.0) })
                .collect();
            // One row twice: rows may be dependent.
            let loaded: Vec<&Row> = rows.iter().chain(rows.first()).collect();
            let (counted, zero) = by_counting(&h, &loaded).unwrap();
            let (exact, modes) = by_eigenvalues(&h, &loaded).unwrap();
            let (counted, exact) = (counted.unwrap(), exact.unwrap());
            assert_eq!(zero, modes);
            assert!((counted - exact).abs() < 1e-6 * exact.abs(), "{counted} {exact}");
        }
        let nothing = Symmetric::new(n, []);
        assert_eq!(by_counting(&nothing, &[]), Some((None, n)));
    }
}
