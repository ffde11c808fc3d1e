//! Plain gradient descent with backtracking, which the thesis tried and rejects (§4.3.5). It sees no curvature: where it
//! ends, the gradient is small, and no more is known.

use super::newton::{Minimization, NewtonOptions, Objective, Outcome, descend, norm};
use std::sync::atomic::{AtomicBool, Ordering};

/// Growth of the step's length from one iteration to the next, before backtracking.
const GROWTH: f64 = 2.0;

/// Minimises `objective` from `start`; of the options only the tolerance on the gradient and the iterations count.
pub fn steepest_descent<O: Objective>(
    objective: &O,
    start: O::Point,
    options: &NewtonOptions,
    cancel: &AtomicBool,
) -> Minimization<O::Point> {
    let mut out = Minimization::at(start);
    let (mut energy, mut gradient, mut guard) = objective.slope(&out.point);
    let mut length = 1.0;
    loop {
        (out.energy, out.gradient_norm) = (energy, norm(&gradient));
        if cancel.load(Ordering::Relaxed) {
            return out.ended(Outcome::Interrupted);
        }
        if out.gradient_norm < options.gradient_tolerance {
            return out.ended(Outcome::Minimum);
        }
        if out.iterations == options.max_iterations {
            return out;
        }
        out.iterations += 1;
        let step: Vec<f64> = gradient.iter().map(|g| -length * g).collect();
        let Some((point, _)) = descend(objective, &out.point, (energy, &gradient), &guard, &step) else {
            return out.ended(Outcome::Stalled);
        };
        let before = energy;
        let slope_sq = out.gradient_norm * out.gradient_norm;
        (energy, gradient, guard) = objective.slope(&point);
        out.point = point;
        // The length that was used, as far as the decrease tells it, and then some.
        length = GROWTH * ((before - energy) / slope_sq).max(1e-12);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{curvature::Curvature, newton::Derivatives};

    /// E = ½ (x² + 50 y²).
    struct Valley;

    impl Objective for Valley {
        type Point = [f64; 2];
        type Guard = ();
        fn energy(&self, p: &[f64; 2]) -> f64 {
            0.5 * (p[0] * p[0] + 50.0 * p[1] * p[1])
        }
        fn slope(&self, p: &[f64; 2]) -> (f64, Vec<f64>, ()) {
            (self.energy(p), vec![p[0], 50.0 * p[1]], ())
        }
        fn derivatives(&self, p: &[f64; 2]) -> Derivatives<()> {
            let (energy, gradient, guard) = self.slope(p);
            Derivatives { energy, gradient, hessian: Curvature::new(2, &[0, 1]), guard }
        }
        fn largest_step(&self, _: &(), _: &[f64]) -> f64 {
            1.0
        }
        fn moved(&self, p: &[f64; 2], step: &[f64], fraction: f64) -> [f64; 2] {
            [p[0] + fraction * step[0], p[1] + fraction * step[1]]
        }
        fn kick(&self, _: usize) -> Vec<f64> {
            vec![0.0; 2]
        }
    }

    #[test]
    fn a_narrow_valley_takes_many_steps() {
        let options = NewtonOptions {
            gradient_tolerance: 1e-8,
            curvature_floor: 1e-3,
            saddle_tolerance: 1e-6,
            max_iterations: 5_000,
            max_kicks: 0,
        };
        let end = steepest_descent(&Valley, [1.0, 1.0], &options, &AtomicBool::new(false));
        assert_eq!(end.outcome, Outcome::Minimum);
        assert!(end.iterations > 20 && end.point[0].abs() < 1e-7 && end.point[1].abs() < 1e-8);
        let short = NewtonOptions { max_iterations: 3, ..options };
        let end = steepest_descent(&Valley, [1.0, 1.0], &short, &AtomicBool::new(false));
        assert_eq!((end.outcome, end.iterations), (Outcome::NotConverged, 3));
    }
}
