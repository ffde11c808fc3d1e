//! Regularised Newton with backtracking and saddle escape (Algorithm 4.3.2, corrected).
//!
//! Differences from the printed algorithm: a trial is the saved point plus a fraction of the step (the printed loop
//! accumulates); the regularisation replaces each eigenvalue λ by max(|λ|, floor), which needs no repeated shifts and
//! passes the descent test by construction, and the floor follows the steps; the decrease must be sufficient (Armijo); a
//! saddle is left along its most negative eigenvector as soon as the gradient is small, and the minimisation goes on.

use super::{
    curvature::{Curvature, Decomposed},
    eigen::EigenFailure,
    sparse::Patterns,
};
use std::sync::atomic::{AtomicBool, Ordering};

/// Energy, gradient and Hessian at a point, with what the objective needs to bound a step from there.
pub struct Derivatives<G> {
    /// Energy.
    pub energy: f64,
    /// Gradient.
    pub gradient: Vec<f64>,
    /// Hessian.
    pub hessian: Curvature,
    /// The objective's own data for [`Objective::largest_step`].
    pub guard: G,
}

/// What is minimised.
pub trait Objective {
    /// A point of the configuration space.
    type Point: Clone;
    /// Data for the step bound.
    type Guard;
    /// Energy at `x`.
    fn energy(&self, x: &Self::Point) -> f64;
    /// Energy and gradient at `x`, with the data of the step bound.
    fn slope(&self, x: &Self::Point) -> (f64, Vec<f64>, Self::Guard);
    /// Energy with derivatives at `x`.
    fn derivatives(&self, x: &Self::Point) -> Derivatives<Self::Guard>;
    /// Largest fraction of `step` (at most 1) that keeps the topology and the step cap.
    fn largest_step(&self, guard: &Self::Guard, step: &[f64]) -> f64;
    /// The point reached by `fraction` of `step`.
    fn moved(&self, x: &Self::Point, step: &[f64], fraction: f64) -> Self::Point;
    /// Whether a step from `from` may end at `to`: rules that the step bound does not know.
    fn allows(&self, _from: &Self::Point, _to: &Self::Point) -> bool {
        true
    }
    /// A small random step to leave a stall; `attempt` counts up.
    fn kick(&self, attempt: usize) -> Vec<f64>;
}

/// Tolerances and limits of a minimisation, in the objective's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Converged where |gradient| is below this.
    pub gradient_tolerance: f64,
    /// Floor of |λ| in the first step. It doubles where less than half of a step could be taken, so that one free ring
    /// does not hold up all others, and halves after every whole step, so that shallow valleys are crossed.
    pub curvature_floor: f64,
    /// A saddle is a point with an eigenvalue below −this.
    pub saddle_tolerance: f64,
    /// Iterations at most.
    pub max_iterations: usize,
    /// Random kicks at most, where the line search finds no decrease (the energy jumps where minima merge).
    pub max_kicks: usize,
}

/// How a minimisation ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Small gradient, no negative curvature.
    Minimum,
    /// Too many iterations.
    NotConverged,
    /// No decrease was found, kicks included: the energy jumps where minima split.
    Stalled,
    /// The caller asked to stop.
    Interrupted,
    /// The eigensolver failed its check.
    Eigen(EigenFailure),
}

/// End point of a minimisation with its figures.
#[derive(Clone, Debug)]
pub struct Minimization<P> {
    /// The last point.
    pub point: P,
    /// How it ended.
    pub outcome: Outcome,
    /// Energy of the last point.
    pub energy: f64,
    /// Norm of the last gradient.
    pub gradient_norm: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Saddles left.
    pub escapes: usize,
    /// Kicks given.
    pub kicks: usize,
}

/// Least fraction tried by the backtracking.
const LEAST_FRACTION: f64 = 1e-9;
/// Sufficient decrease (Armijo).
const ARMIJO: f64 = 1e-4;
/// Least and largest floor of the curvature, as parts of the first.
const FLOOR_RANGE: [f64; 2] = [1e-3, 1e4];

impl<P> Minimization<P> {
    /// At `start`, with nothing done.
    pub(super) fn at(start: P) -> Self {
        Minimization {
            point: start,
            outcome: Outcome::NotConverged,
            energy: f64::NAN,
            gradient_norm: f64::NAN,
            iterations: 0,
            escapes: 0,
            kicks: 0,
        }
    }

    /// Ended so.
    pub(super) fn ended(self, outcome: Outcome) -> Self {
        Minimization { outcome, ..self }
    }
}

/// Minimises `objective` from `start` until `cancel` or an end. `watch` sees every point with its energy, the start
/// first, and how many saddles were left and kicks given so far; the energy falls from one to the next, kicks excepted.
pub fn minimize<O: Objective>(
    objective: &O,
    start: O::Point,
    options: &NewtonOptions,
    cancel: &AtomicBool,
    watch: &mut dyn FnMut(&O::Point, f64, usize),
) -> Minimization<O::Point> {
    let mut out = Minimization::at(start);
    let mut patterns = Patterns::default();
    let mut floor = options.curvature_floor;
    while out.iterations < options.max_iterations {
        if cancel.load(Ordering::Relaxed) {
            return out.ended(Outcome::Interrupted);
        }
        let Derivatives { energy, gradient, hessian, guard } = objective.derivatives(&out.point);
        (out.energy, out.gradient_norm) = (energy, norm(&gradient));
        watch(&out.point, energy, out.escapes + out.kicks);
        let curvature = match hessian.decompose(&mut patterns) {
            Ok(curvature) => curvature,
            Err(failure) => return out.ended(Outcome::Eigen(failure)),
        };
        out.iterations += 1;
        let next = if out.gradient_norm < options.gradient_tolerance {
            if curvature.no_saddle(options.saddle_tolerance) {
                return out.ended(Outcome::Minimum);
            }
            match escape(objective, &out.point, energy, &guard, &curvature) {
                Some(point) => {
                    out.escapes += 1;
                    Some(point)
                }
                // No decrease along negative curvature: the energy jumps there. The point is as low as can be found.
                None => return out.ended(Outcome::Minimum),
            }
        } else {
            let newton = curvature.descent_step(&gradient, floor);
            let along = |step: &[f64]| descend(objective, &out.point, (energy, &gradient), &guard, step);
            newton
                .and_then(|step| along(&step))
                .inspect(|&(_, fraction)| floor = next_floor(floor, fraction, options.curvature_floor))
                .or_else(|| along(&gradient.iter().map(|g| -g).collect::<Vec<_>>()))
                .map(|(point, _)| point)
                .or_else(|| escape(objective, &out.point, energy, &guard, &curvature))
        };
        out.point = match next {
            Some(point) => point,
            None if out.kicks < options.max_kicks => {
                out.kicks += 1;
                let step = objective.kick(out.kicks);
                let fraction = objective.largest_step(&guard, &step);
                let kicked = objective.moved(&out.point, &step, fraction);
                if objective.allows(&out.point, &kicked) { kicked } else { continue }
            }
            None => return out.ended(Outcome::Stalled),
        };
    }
    out
}

fn next_floor(floor: f64, fraction: f64, first: f64) -> f64 {
    let factor = if fraction < 0.5 {
        2.0
    } else if fraction < 1.0 {
        1.0
    } else {
        0.5
    };
    (floor * factor).clamp(FLOOR_RANGE[0] * first, FLOOR_RANGE[1] * first)
}

/// The first point along `step` that decreases enough from `x`, of the energy and gradient `here`, and its fraction.
pub(super) fn descend<O: Objective>(
    objective: &O,
    x: &O::Point,
    here: (f64, &[f64]),
    guard: &O::Guard,
    step: &[f64],
) -> Option<(O::Point, f64)> {
    let slope: f64 = step.iter().zip(here.1).map(|(s, g)| s * g).sum();
    let mut fraction = objective.largest_step(guard, step);
    while slope < 0.0 && fraction > LEAST_FRACTION {
        let trial = objective.moved(x, step, fraction);
        if objective.energy(&trial) <= here.0 + ARMIJO * fraction * slope && objective.allows(x, &trial) {
            return Some((trial, fraction));
        }
        fraction *= 0.5;
    }
    None
}

/// From `x`, of the energy `here`: the lowest of the points tried along ± the most negative eigenvector, if it lies below the saddle as far as its
/// curvature promises (a fraction of it).
fn escape<O: Objective>(
    objective: &O,
    x: &O::Point,
    here: f64,
    guard: &O::Guard,
    curvature: &Decomposed,
) -> Option<O::Point> {
    let (lowest, vector) = curvature.lowest()?;
    let lowest = lowest.min(0.0);
    let mut best: Option<(f64, O::Point)> = None;
    for sign in [1.0, -1.0] {
        let step: Vec<f64> = vector.iter().map(|v| sign * v).collect();
        let mut fraction = objective.largest_step(guard, &step);
        while fraction > 1e-6 {
            let trial = objective.moved(x, &step, fraction);
            let energy = objective.energy(&trial);
            let low_enough = energy < here + 0.1 * lowest * fraction * fraction;
            if low_enough && best.as_ref().is_none_or(|b| energy < b.0) && objective.allows(x, &trial) {
                best = Some((energy, trial));
                break;
            }
            fraction *= 0.5;
        }
    }
    best.map(|b| b.1)
}

pub(super) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use faer::Mat;

    /// E = (x² − 1)² + y²: a saddle at the origin, minima at x = ±1.
    pub(in crate::solver) struct DoubleWell;

    impl Objective for DoubleWell {
        type Point = [f64; 2];
        type Guard = ();
        fn energy(&self, p: &[f64; 2]) -> f64 {
            (p[0] * p[0] - 1.0).powi(2) + p[1] * p[1]
        }
        fn slope(&self, p: &[f64; 2]) -> (f64, Vec<f64>, ()) {
            (self.energy(p), vec![4.0 * p[0] * (p[0] * p[0] - 1.0), 2.0 * p[1]], ())
        }
        fn derivatives(&self, p: &[f64; 2]) -> Derivatives<()> {
            let hessian = [[12.0 * p[0] * p[0] - 4.0, 0.0], [0.0, 2.0]];
            let (energy, gradient, guard) = self.slope(p);
            let hessian = Curvature::dense(Mat::from_fn(2, 2, |i, j| hessian[i][j]));
            Derivatives { energy, gradient, hessian, guard }
        }
        fn largest_step(&self, _: &(), _: &[f64]) -> f64 {
            1.0
        }
        fn moved(&self, p: &[f64; 2], step: &[f64], fraction: f64) -> [f64; 2] {
            [p[0] + fraction * step[0], p[1] + fraction * step[1]]
        }
        fn kick(&self, _: usize) -> Vec<f64> {
            vec![1e-3, 1e-3]
        }
    }

    const OPTIONS: NewtonOptions = NewtonOptions {
        gradient_tolerance: 1e-10,
        curvature_floor: 1e-6,
        saddle_tolerance: 1e-8,
        max_iterations: 100,
        max_kicks: 3,
    };

    #[test]
    fn a_symmetric_start_leaves_its_saddle() {
        let end = minimize(&DoubleWell, [0.0, 0.7], &OPTIONS, &AtomicBool::new(false), &mut |_, _, _| {});
        assert_eq!(end.outcome, Outcome::Minimum);
        assert!(end.escapes >= 1);
        assert!((end.point[0].abs() - 1.0).abs() < 1e-9 && end.point[1].abs() < 1e-9);
    }

    #[test]
    fn a_cancelled_run_says_so() {
        let end = minimize(&DoubleWell, [0.3, 0.7], &OPTIONS, &AtomicBool::new(true), &mut |_, _, _| {});
        assert_eq!((end.outcome, end.iterations), (Outcome::Interrupted, 0));
    }
}
