//! A small dense interior-point method for the cones that bounds need: norms in space and 4×4 positive matrices.
//!
//! minimise qᵀx subject to s = h − G x ∈ K, with the dual: maximise −hᵀz subject to Gᵀz + q = 0, z ∈ K.
//!
//! Primal–dual, infeasible start, Nesterov–Todd scaling, Mehrotra's predictor and corrector (Vandenberghe, *The CVXOPT
//! linear and quadratic cone program solvers*, 2010, whose notation is used). It knows no ring. It claims nothing: it
//! shows every multiplier z to its caller, who proves with it what it proves. That is often best after rounding has
//! spoiled the residuals, because the gap still falls.

mod packed;
mod scaling;

pub use packed::{eigenvalues, pack};

use nalgebra::{DMatrix, DVector, Matrix4};
use packed::{DIAGONAL, unpack};
use scaling::{Block, split_square};

/// A cone; K is a product of them, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cone {
    /// {(t, u): |u| ≤ t}, u in space: four rows.
    Norm,
    /// Positive semidefinite 4×4 matrices, as [`pack`]ed: ten rows.
    Positive,
}

impl Cone {
    /// Rows of G that the cone takes.
    pub(crate) fn rows(self) -> usize {
        match self {
            Cone::Norm => 4,
            Cone::Positive => 10,
        }
    }

    /// The barrier's degree: λ ∘ λ = μ e has trace degree · μ.
    fn degree(self) -> f64 {
        match self {
            Cone::Norm => 1.0,
            Cone::Positive => 4.0,
        }
    }
}

/// The program; dense, for tens of unknowns.
#[derive(Clone, Debug)]
pub struct ConeProgram {
    /// Cost q.
    pub cost: DVector<f64>,
    /// G.
    pub matrix: DMatrix<f64>,
    /// h.
    pub offset: DVector<f64>,
    /// K.
    pub cones: Vec<Cone>,
}

/// The iterate of least residual.
#[derive(Clone, Debug)]
pub struct ConeSolution {
    /// x.
    pub x: DVector<f64>,
    /// z.
    pub z: DVector<f64>,
    /// Largest of the relative residuals of both equations and the gap sᵀz.
    pub residual: f64,
    /// Iterations.
    pub iterations: usize,
}

const MAX_ITERATIONS: usize = 60;
/// The iteration stops at this residual; it usually stops where rounding ends its progress.
const TOLERANCE: f64 = 1e-13;
/// Part of the way to the cone's boundary that a step may take.
const STEP: f64 = 0.99;

impl ConeProgram {
    /// Solves. `stop` is shown every multiplier z and ends the iteration where it is true: an infeasible program shows
    /// itself there, its z growing along a certificate.
    pub fn solve(&self, mut stop: impl FnMut(&DVector<f64>) -> bool) -> ConeSolution {
        let unit = self.unit();
        let mut now = ConeSolution {
            x: DVector::zeros(self.cost.len()),
            z: unit.clone(),
            residual: f64::INFINITY,
            iterations: 0,
        };
        let mut best = now.clone();
        let mut s = unit.clone();
        let degree: f64 = self.cones.iter().map(|c| c.degree()).sum();
        let scale = |v: &DVector<f64>| v.norm().max(1.0);
        for iteration in 0..MAX_ITERATIONS {
            let dual_rest = self.matrix.tr_mul(&now.z) + &self.cost;
            let primal_rest = &s + &self.matrix * &now.x - &self.offset;
            let gap = s.dot(&now.z);
            now.iterations = iteration;
            now.residual = (dual_rest.norm() / scale(&self.cost))
                .max(primal_rest.norm() / scale(&self.offset))
                .max(gap / (1.0 + self.cost.dot(&now.x).abs()));
            if now.residual < best.residual {
                best = now.clone();
            }
            if stop(&now.z) || now.residual < TOLERANCE {
                break;
            }
            let Some(scaling) = self.scaling(&s, &now.z) else { break };
            let Some(newton) = Newton::new(self, &scaling) else { break };
            let mu = gap / degree;
            // Predictor: straight to λ ∘ λ = 0.
            let lambda = &scaling.lambda;
            let target = -self.product(lambda, lambda);
            let (_, ds, dz) = newton.direction(&dual_rest, &primal_rest, &target);
            let reach = self.reach(lambda, &ds).min(self.reach(lambda, &dz)).min(1.0);
            let centering = (1.0 - reach).powi(3);
            // Corrector, with the second-order term of the predictor.
            let rest = 1.0 - centering;
            let target = target - self.product(&ds, &dz) + &unit * (centering * mu);
            let (dx, ds, dz) = newton.direction(&(&dual_rest * rest), &(&primal_rest * rest), &target);
            let step = (STEP * self.reach(lambda, &ds).min(self.reach(lambda, &dz))).min(1.0);
            if !step.is_finite() || step < 1e-9 {
                break;
            }
            now.x += step * dx;
            s += step * self.map(&ds, |block, v, out| scaling.blocks[block].transpose(v, out));
            now.z += step * self.map(&dz, |block, v, out| scaling.blocks[block].inverse(v, out));
        }
        best
    }

    /// e, the unit of every cone.
    fn unit(&self) -> DVector<f64> {
        let mut out = DVector::zeros(self.offset.len());
        for (cone, at) in self.blocks() {
            match cone {
                Cone::Norm => out[at] = 1.0,
                Cone::Positive => out.as_mut_slice()[at..at + 10].copy_from_slice(&pack(&Matrix4::identity())),
            }
        }
        out
    }

    /// Cones with their first rows.
    fn blocks(&self) -> impl Iterator<Item = (Cone, usize)> + '_ {
        self.cones.iter().scan(0, |at, &cone| {
            let first = *at;
            *at += cone.rows();
            Some((cone, first))
        })
    }

    /// Applies `f(block, input, output)` to the rows of every cone.
    fn map(&self, v: &DVector<f64>, f: impl Fn(usize, &[f64], &mut [f64])) -> DVector<f64> {
        let mut out = DVector::zeros(v.len());
        for (k, (cone, at)) in self.blocks().enumerate() {
            let rows = at..at + cone.rows();
            f(k, &v.as_slice()[rows.clone()], &mut out.as_mut_slice()[rows]);
        }
        out
    }

    /// The product u ∘ v of the cones' algebras; λ is diagonal in the 4×4 blocks.
    fn product(&self, u: &DVector<f64>, v: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(u.len());
        for (cone, at) in self.blocks() {
            let rows = at..at + cone.rows();
            let (u, v) = (&u.as_slice()[rows.clone()], &v.as_slice()[rows.clone()]);
            let out = &mut out.as_mut_slice()[rows];
            match cone {
                Cone::Norm => {
                    out[0] = (0..4).map(|i| u[i] * v[i]).sum();
                    (1..4).for_each(|i| out[i] = u[0] * v[i] + v[0] * u[i]);
                }
                Cone::Positive => {
                    let (u, v) = (unpack(u), unpack(v));
                    out.copy_from_slice(&pack(&((u * v + v * u) * 0.5)));
                }
            }
        }
        out
    }

    /// λ \ d: the u with λ ∘ u = d.
    fn quotient(&self, lambda: &DVector<f64>, d: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(d.len());
        for (cone, at) in self.blocks() {
            let rows = at..at + cone.rows();
            let (l, d) = (&lambda.as_slice()[rows.clone()], &d.as_slice()[rows.clone()]);
            let out = &mut out.as_mut_slice()[rows];
            match cone {
                Cone::Norm => {
                    let dot: f64 = (1..4).map(|i| l[i] * d[i]).sum();
                    out[0] = (l[0] * d[0] - dot) / split_square(l);
                    (1..4).for_each(|i| out[i] = (d[i] - out[0] * l[i]) / l[0]);
                }
                Cone::Positive => {
                    let mut u = unpack(d);
                    for i in 0..4 {
                        for j in 0..4 {
                            u[(i, j)] /= 0.5 * (l[DIAGONAL[i]] + l[DIAGONAL[j]]);
                        }
                    }
                    out.copy_from_slice(&pack(&u));
                }
            }
        }
        out
    }

    /// The largest α with λ + α d in K.
    fn reach(&self, lambda: &DVector<f64>, d: &DVector<f64>) -> f64 {
        let mut most = f64::INFINITY;
        for (cone, at) in self.blocks() {
            let rows = at..at + cone.rows();
            let (l, d) = (&lambda.as_slice()[rows.clone()], &d.as_slice()[rows]);
            // The least eigenvalue −ε of d in the algebra where λ is the unit: the reach is 1/ε.
            let least = match cone {
                Cone::Norm => {
                    let norm = split_square(l).sqrt();
                    let l: Vec<f64> = l.iter().map(|x| x / norm).collect();
                    let first = l[0] * d[0] - (1..4).map(|i| l[i] * d[i]).sum::<f64>();
                    let factor = (first + d[0]) / (l[0] + 1.0);
                    let rest = (1..4).map(|i| (d[i] - factor * l[i]).powi(2)).sum::<f64>().sqrt();
                    (first - rest) / norm
                }
                Cone::Positive => {
                    let mut u = unpack(d);
                    for i in 0..4 {
                        for j in 0..4 {
                            u[(i, j)] /= (l[DIAGONAL[i]] * l[DIAGONAL[j]]).sqrt();
                        }
                    }
                    eigenvalues(u).iter().copied().fold(f64::INFINITY, f64::min)
                }
            };
            if least < 0.0 {
                most = most.min(-1.0 / least);
            } else if least.is_nan() {
                return f64::NAN;
            }
        }
        most
    }

    /// The scaling of s and z; `None` where rounding has put one of them on the boundary.
    fn scaling(&self, s: &DVector<f64>, z: &DVector<f64>) -> Option<Scaling> {
        let mut blocks = Vec::with_capacity(self.cones.len());
        let mut lambda = DVector::zeros(s.len());
        for (cone, at) in self.blocks() {
            let rows = at..at + cone.rows();
            let (s, z) = (&s.as_slice()[rows.clone()], &z.as_slice()[rows.clone()]);
            let block = match cone {
                Cone::Norm => Block::norm(s, z)?,
                Cone::Positive => Block::positive(s, z)?,
            };
            block.forward(z, &mut lambda.as_mut_slice()[rows]);
            blocks.push(block);
        }
        Some(Scaling { blocks, lambda })
    }
}

/// W with W z = W⁻ᵀ s = λ.
struct Scaling {
    blocks: Vec<Block>,
    lambda: DVector<f64>,
}

/// The Newton system of one scaling, in scaled variables ds̃ = W⁻ᵀ ds, dz̃ = W dz: with G̃ = W⁻ᵀ G,
/// G̃ᵀ dz̃ = −r_x, ds̃ + G̃ dx = −W⁻ᵀ r_z, dz̃ + ds̃ = λ \ d.
struct Newton<'a> {
    program: &'a ConeProgram,
    scaling: &'a Scaling,
    scaled: DMatrix<f64>,
    /// R of G̃ = Q R.
    triangle: DMatrix<f64>,
}

impl<'a> Newton<'a> {
    fn new(program: &'a ConeProgram, scaling: &'a Scaling) -> Option<Self> {
        let mut scaled = program.matrix.clone();
        for mut column in scaled.column_iter_mut() {
            let mut at = 0;
            for (cone, block) in program.cones.iter().zip(&scaling.blocks) {
                let rows = at..at + cone.rows();
                at = rows.end;
                let part = &mut column.as_mut_slice()[rows];
                if part.iter().any(|x| *x != 0.0) {
                    let mut copy = [0.0; 10];
                    copy[..part.len()].copy_from_slice(part);
                    block.inverse_transpose(&copy[..part.len()], part);
                }
            }
        }
        let triangle = scaled.clone().qr().r();
        let usable = triangle.diagonal().iter().all(|x| x.is_finite() && *x != 0.0);
        usable.then_some(Newton { program, scaling, scaled, triangle })
    }

    /// (dx, ds̃, dz̃) for the residuals r_x, r_z and the target d.
    fn direction(
        &self,
        dual_rest: &DVector<f64>,
        primal_rest: &DVector<f64>,
        target: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>, DVector<f64>) {
        let quotient = self.program.quotient(&self.scaling.lambda, target);
        let rest = self.program.map(primal_rest, |k, v, out| self.scaling.blocks[k].inverse_transpose(v, out));
        // dz̃ = quotient + rest + G̃ dx, and G̃ᵀ dz̃ = −r_x.
        let fixed = quotient.clone() + &rest;
        let mut dx = DVector::zeros(dual_rest.len());
        // Semi-normal equations; the second round repairs what the first lost.
        for _ in 0..2 {
            let right = -(dual_rest + self.scaled.tr_mul(&(&fixed + &self.scaled * &dx)));
            let mut step = right;
            self.triangle.tr_solve_upper_triangular_mut(&mut step);
            self.triangle.solve_upper_triangular_mut(&mut step);
            dx += step;
        }
        let ds = -&rest - &self.scaled * &dx;
        let dz = quotient - &ds;
        (dx, ds, dz)
    }
}

#[cfg(test)]
mod tests {
    use super::{packed::tests::sample, *};

    /// The scaled blocks invert each other, and W z = W⁻ᵀ s.
    #[test]
    fn scalings_balance_both_iterates() {
        let program = ConeProgram {
            cost: DVector::zeros(1),
            matrix: DMatrix::zeros(14, 1),
            offset: DVector::zeros(14),
            cones: vec![Cone::Norm, Cone::Positive],
        };
        let join = |head: [f64; 4], m: Matrix4<f64>| DVector::from_iterator(14, head.into_iter().chain(pack(&m)));
        let s = join([2.0, 1.0, -0.5, 0.3], sample() + Matrix4::identity() * 0.1);
        let z = join([1.0, 0.2, 0.7, -0.6], Matrix4::identity() * 0.5 + sample() * sample() * 0.1);
        let scaling = program.scaling(&s, &z).unwrap();
        let scaled_s = program.map(&s, |k, v, out| scaling.blocks[k].inverse_transpose(v, out));
        assert!((&scaled_s - &scaling.lambda).norm() < 1e-12);
        let back = program.map(&scaled_s, |k, v, out| scaling.blocks[k].transpose(v, out));
        assert!((back - &s).norm() < 1e-12);
        let back = program.map(&scaling.lambda, |k, v, out| scaling.blocks[k].inverse(v, out));
        assert!((back - &z).norm() < 1e-12);
        let d = DVector::from_fn(14, |i, _| (i as f64).cos());
        let quotient = program.quotient(&scaling.lambda, &d);
        assert!((program.product(&scaling.lambda, &quotient) - d).norm() < 1e-12);
    }
}
