//! The chains as a bound of every strain: {C ⪰ 0, xᵀ C x ≤ 1 for every chain x} is convex in the metric C = FᵀF.
//!
//! With C = C₀ + Σ p_m C_m the largest p₀ is a cone program in a few unknowns. **Proof.** For any y_k ≥ 0 and (τ, ζ) with
//! |ζ| ≤ τ each state has Σ y_k (1 − x_kᵀ C x_k) ≥ 0 and τ tr C + ζ₁ (C_xx − C_yy) + 2 ζ₂ C_xy ≥ 0, because C is positive
//! semidefinite. Their sum is affine in p, so
//!
//! p₀ ≤ Σ y_k (1 − x_kᵀ C₀ x_k) + ⟨Z, C₀⟩ + Σ_m r_m p_m,   r_m = [m = 0] − Σ y_k x_kᵀ C_m x_k + ⟨Z, C_m⟩.
//!
//! A good solution has r ≈ 0; what rounding leaves of it is charged with the largest |p_m| that the chains allow.

use super::ChainBound;
use crate::solver::cone::{Cone, ConeProgram};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// What the chains say of the largest p₀.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MetricBound {
    /// No state has a larger p₀.
    Finite(f64),
    /// No state has a metric of this family.
    Unreachable,
    /// Nothing is proved.
    Nothing,
}

/// An excess of the chains beyond rounding.
const EXCESS: f64 = 1e-9;
/// A proof of p₀ below this ends the solve.
const FAR: f64 = -1e3;

/// The bound of p₀ for C = `base` + Σ p_m `rates`_m. The rates must be orthogonal to each other (as matrices).
pub fn metric_bound(chain: &ChainBound, base: &Matrix2<f64>, rates: &[Matrix2<f64>]) -> MetricBound {
    let stretch = chain.largest_stretch();
    if !stretch.is_finite() || rates.is_empty() {
        return MetricBound::Nothing;
    }
    let chains: Vec<Vector2<f64>> = chain.directions().collect();
    // Is the family reachable at all? The largest s with xᵀ C x ≤ 1 − s.
    let program = Metric { chains: &chains, base, rates, slack: true };
    let size = base.norm() + 2.0 * stretch * stretch;
    let reach: Vec<f64> = rates.iter().map(|rate| size / rate.norm()).collect();
    if program.bound(&reach).is_some_and(|s| s < -EXCESS) {
        return MetricBound::Unreachable;
    }
    let program = Metric { slack: false, ..program };
    program.bound(&reach).map_or(MetricBound::Nothing, MetricBound::Finite)
}

struct Metric<'a> {
    chains: &'a [Vector2<f64>],
    base: &'a Matrix2<f64>,
    rates: &'a [Matrix2<f64>],
    /// Whether the least slack of the chains is maximised in place of p₀.
    slack: bool,
}

impl Metric<'_> {
    fn of_chain(&self, k: usize, c: &Matrix2<f64>) -> f64 {
        self.chains[k].dot(&(c * self.chains[k]))
    }

    /// The least value that a multiplier of the solver proves.
    fn bound(&self, reach: &[f64]) -> Option<f64> {
        let unknowns = self.rates.len() + usize::from(self.slack);
        let rows = 4 * (self.chains.len() + 1);
        let mut program = ConeProgram {
            cost: DVector::zeros(unknowns),
            matrix: DMatrix::zeros(rows, unknowns),
            offset: DVector::zeros(rows),
            cones: vec![Cone::Norm; self.chains.len() + 1],
        };
        program.cost[if self.slack { self.rates.len() } else { 0 }] = -1.0;
        for k in 0..self.chains.len() {
            program.offset[4 * k] = 1.0 - self.of_chain(k, self.base);
            for (m, rate) in self.rates.iter().enumerate() {
                program.matrix[(4 * k, m)] = self.of_chain(k, rate);
            }
            if self.slack {
                program.matrix[(4 * k, self.rates.len())] = 1.0;
            }
        }
        let last = 4 * self.chains.len();
        for (i, value) in semidefinite(self.base).into_iter().enumerate() {
            program.offset[last + i] = value;
            for (m, rate) in self.rates.iter().enumerate() {
                program.matrix[(last + i, m)] = -semidefinite(rate)[i];
            }
        }
        let mut least: Option<f64> = None;
        program.solve(|z| {
            if let Some(value) = self.prove(z, reach) {
                least = Some(least.map_or(value, |least: f64| least.min(value)));
            }
            least.is_some_and(|least| least < FAR)
        });
        least
    }

    /// What the multiplier z proves.
    fn prove(&self, z: &DVector<f64>, reach: &[f64]) -> Option<f64> {
        let y: Vec<f64> = (0..self.chains.len()).map(|k| z[4 * k].max(0.0)).collect();
        let last = 4 * self.chains.len();
        let zeta = z[last + 1].hypot(z[last + 2]);
        let dual = [z[last].max(zeta), z[last + 1], z[last + 2]];
        let of_cone = |c: &Matrix2<f64>| semidefinite(c).iter().zip(dual).map(|(s, z)| s * z).sum::<f64>();
        let total = if self.slack { y.iter().sum() } else { 1.0 };
        if total <= 0.0 {
            return None;
        }
        let of_chains = |c: &Matrix2<f64>| y.iter().enumerate().map(|(k, y)| y * self.of_chain(k, c)).sum::<f64>();
        let mut value = y.iter().sum::<f64>() - of_chains(self.base) + of_cone(self.base);
        for (m, (rate, reach)) in self.rates.iter().zip(reach).enumerate() {
            let wanted = if m == 0 && !self.slack { 1.0 } else { 0.0 };
            let left: f64 = wanted - of_chains(rate) + of_cone(rate);
            value += left.abs() * reach;
        }
        let value = value / total;
        value.is_finite().then_some(value)
    }
}

/// (tr C, C_xx − C_yy, 2 C_xy): C ⪰ 0 if the first is at least the norm of the others.
fn semidefinite(c: &Matrix2<f64>) -> [f64; 3] {
    [c[(0, 0)] + c[(1, 1)], c[(0, 0)] - c[(1, 1)], 2.0 * c[(0, 1)]]
}
