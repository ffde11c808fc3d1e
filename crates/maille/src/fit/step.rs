//! The model of a step: each deviation by its linear pieces, and the step within a box and the bounds that makes the misses smallest.
//!
//! Where the forces of a limit are not unique, or another state takes over, its limit has a kink as a function of the design, and the
//! derivatives at one design promise too much. So designs near by to which a step led in vain lend their own tangents. Of a deviation δ with the tangent T of the
//! current design and the tangent P of a neighbour y:
//!
//! - δ(y) < T(y): the limit bends down. Below, the deviation is modelled as min(T, P): the least of all tangents.
//! - δ(y) > T(y): it bends up. Above, it is modelled as max(T, P).
//!
//! A piece that contradicts the value at the current design is shifted to it. The misses e_k then obey e_k ≥ −piece below and e_k ≥ piece above, and
//! ½ Σ e_k², or the largest e_k, is least over the step: a convex quadratic program.

use super::{options::Norm, target::Wanted};
use crate::solver::{
    qp::{QuadraticProgram, SparseRows, solve},
    symmetric::Symmetric,
};
use nalgebra::DVector;

/// A deviation times its weight near the current design: offset + slope·d.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub offset: f64,
    pub slope: DVector<f64>,
}

impl Piece {
    fn at(&self, d: &DVector<f64>) -> f64 {
        self.offset + self.slope.dot(d)
    }
}

/// The model of one target: the tangent of the current design, and those of its neighbours.
pub(super) struct Pieces {
    wanted: Wanted,
    tangent: Piece,
    below: Vec<Piece>,
    above: Vec<Piece>,
}

impl Pieces {
    pub fn new(wanted: Wanted, tangent: Piece) -> Self {
        Pieces { wanted, tangent, below: Vec::new(), above: Vec::new() }
    }

    /// Adds the tangent of a design that is `away` from the current one and has the deviation `value` there.
    pub fn add_neighbour(&mut self, away: &DVector<f64>, value: f64, slope: &DVector<f64>) {
        let offset = value - slope.dot(away);
        if value < self.tangent.at(away) {
            self.below.push(Piece { offset: offset.max(self.tangent.offset), slope: slope.clone() });
        } else {
            self.above.push(Piece { offset: offset.min(self.tangent.offset), slope: slope.clone() });
        }
    }

    /// The pieces that say by how much the value is too small, and those that say by how much it is too large, as signs with pieces.
    fn sides(&self) -> impl Iterator<Item = (f64, &Piece)> {
        let [below, above] = self.wanted.misses_sides();
        let tangent = || std::iter::once(&self.tangent);
        let small = tangent().chain(&self.below).filter(move |_| below).map(|piece| (-1.0, piece));
        small.chain(tangent().chain(&self.above).filter(move |_| above).map(|piece| (1.0, piece)))
    }

    /// The miss of the model at a step.
    fn miss(&self, d: &DVector<f64>) -> f64 {
        self.sides().map(|(sign, piece)| sign * piece.at(d)).fold(0.0, f64::max)
    }
}

/// The misses of the model at a step.
pub(super) fn misses(model: &[Pieces], d: &DVector<f64>) -> DVector<f64> {
    DVector::from_iterator(model.len(), model.iter().map(|pieces| pieces.miss(d)))
}

/// Weight of |d/Δ|² beside misses in units of the largest: no long steps along numbers that change next to nothing. It loses its weight as
/// the misses vanish.
const SHORT: f64 = 1e-3;

/// The step with the smallest misses of the model, with every |d_i| ≤ `reach` and `lower` ≤ d ≤ `upper`, which include 0.
pub(super) fn best_step(model: &[Pieces], norm: Norm, lower: &[f64], upper: &[f64], reach: f64) -> DVector<f64> {
    let n = lower.len();
    let now = misses(model, &DVector::zeros(n));
    let size = now.amax();
    if size == 0.0 {
        return DVector::zeros(n);
    }
    // Unknowns: steps in units of the reach, then misses in units of the largest, less those of now.
    let extra = if norm == Norm::Minimax { 1 } else { model.len() };
    let miss = |k: usize| n + if norm == Norm::Minimax { 0 } else { k };
    let start = |k: usize| if norm == Norm::Minimax { 1.0 } else { now[k] / size };
    let (mut rows, mut right) = (SparseRows::default(), Vec::new());
    let mut steepest: f64 = 0.0;
    for (k, pieces) in model.iter().enumerate() {
        for (sign, Piece { offset, slope }) in pieces.sides() {
            // e_k ≥ sign (offset + slope·d)
            let entries = slope.iter().enumerate().map(|(i, x)| (i, -sign * x * reach / size));
            steepest = steepest.max(slope.iter().map(|x| (x * reach / size).abs()).sum());
            rows.push(entries.chain([(miss(k), 1.0)]));
            right.push(sign * offset / size - start(k));
        }
        // e_k ≥ 0
        rows.push([(miss(k), 1.0)]);
        right.push(-start(k));
    }
    for i in 0..n {
        for (sign, bound) in [(1.0, lower[i]), (-1.0, -upper[i])] {
            rows.push([(i, sign)]);
            right.push((bound / reach).max(-2.0));
        }
    }
    let mut hessian =
        Symmetric::new(n + extra, (0..n + extra).map(|i| vec![i]).collect::<Vec<_>>().iter().map(Vec::as_slice));
    let mut linear = vec![0.0; n + extra];
    (0..n).for_each(|i| hessian.add(&[i], |_, _| SHORT));
    match norm {
        Norm::Minimax => linear[n] = 1.0,
        Norm::LeastSquares => (0..model.len()).for_each(|k| {
            hessian.add(&[miss(k)], |_, _| 1.0);
            linear[miss(k)] = start(k);
        }),
    }
    let half_width: Vec<f64> = (0..n + extra).map(|i| if i < n { 1.0 } else { 2.0 + steepest }).collect();
    let program =
        QuadraticProgram { hessian: &hessian, linear: &linear, rows: &rows, lower: &right, half_width: &half_width };
    let x = solve(&program).x;
    DVector::from_fn(n, |i, _| (x[i] * reach).clamp(lower[i].max(-reach), upper[i].min(reach)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn random(rng: &mut ChaCha8Rng, n: usize, wanted: Wanted) -> Pieces {
        let slope = DVector::from_fn(n, |_, _| rng.random_range(-1.0..1.0));
        let mut pieces = Pieces::new(wanted, Piece { offset: rng.random_range(-0.3..0.3), slope });
        for _ in 0..2 {
            let away = DVector::from_fn(n, |_, _| rng.random_range(-0.1..0.1));
            let slope = DVector::from_fn(n, |_, _| rng.random_range(-1.0..1.0));
            pieces.add_neighbour(&away, rng.random_range(-0.3..0.3), &slope);
        }
        pieces
    }

    /// What a step makes smallest.
    fn objective(model: &[Pieces], norm: Norm, d: &DVector<f64>, reach: f64) -> f64 {
        let size = misses(model, &DVector::zeros(d.len())).amax();
        let of = norm.of(&(misses(model, d) / size));
        let of = if norm == Norm::Minimax { of } else { 0.5 * of };
        of + 0.5 * SHORT * d.norm_squared() / (reach * reach)
    }

    /// No other step of the box does better.
    #[test]
    fn steps_are_the_best_of_their_box() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for case in 0..60 {
            let n = 1 + case % 4;
            let wanted = [Wanted::Value(0.0), Wanted::AtLeast(0.0), Wanted::AtMost(0.0)];
            let model: Vec<Pieces> = (0..2 * n).map(|k| random(&mut rng, n, wanted[k % 3])).collect();
            let lower: Vec<f64> = (0..n).map(|_| rng.random_range(-0.5..0.0)).collect();
            let upper: Vec<f64> = (0..n).map(|_| rng.random_range(0.0..0.5)).collect();
            for norm in [Norm::LeastSquares, Norm::Minimax] {
                for reach in [0.03, 0.4] {
                    let d = best_step(&model, norm, &lower, &upper, reach);
                    assert!((0..n).all(|i| d[i] >= lower[i].max(-reach) && d[i] <= upper[i].min(reach)));
                    let best = objective(&model, norm, &d, reach);
                    for _ in 0..300 {
                        let other = DVector::from_fn(n, |i, _| {
                            let near = d[i] + rng.random_range(-0.01..0.01);
                            let far = rng.random_range(-reach..reach);
                            let x: f64 = if rng.random_range(0.0..1.0) < 0.5 { near } else { far };
                            x.clamp(lower[i].max(-reach), upper[i].min(reach))
                        });
                        let there = objective(&model, norm, &other, reach);
                        assert!(best <= there + 1e-7, "{case}: {best} at {d}, {there} at {other}");
                    }
                }
            }
        }
    }

    #[test]
    fn neighbours_cut_what_the_tangent_promises() {
        // A roof: min(x, 0.1 − x) − 1, to be raised to 0: its ridge is at 0.05.
        let slope = |x: f64| DVector::from_element(1, x);
        let tangent = Piece { offset: -1.0, slope: slope(1.0) };
        let mut pieces = Pieces::new(Wanted::AtLeast(0.0), tangent);
        pieces.add_neighbour(&slope(0.3), -1.2, &slope(-1.0));
        let d = best_step(&[pieces], Norm::Minimax, &[-1.0], &[1.0], 0.5);
        assert!((d[0] - 0.05).abs() < 1e-6, "{d}");
    }
}
