//! Newton's iteration with shifts of the Hessian: Algorithm 4.3.2 as it is printed, and with its line search put right.
//!
//! A step solves (H + γ 1) dq = −grad, with γ = 0 first; while dq·grad ≥ 0, γ grows. H may be indefinite as long as the
//! step descends. Then δ is halved until the energy is not above the one before and the step bound holds. At a point
//! without gradient where H is indefinite, the system is shifted along its lowest eigenvector, and the iteration goes on (§4.3.5).
//!
//! As printed, γ is not reset from one iteration to the next, and a trial adds δ dq to the trial before, not to the point
//! from which the step was taken: trials lie at 1, 3/2, 7/4, … of the step, and none is shorter than the first one.

use super::{
    eigen::{Eigen, symmetric_eigen},
    newton::{Minimization, NewtonOptions, Objective, Outcome, norm},
};
use std::sync::atomic::{AtomicBool, Ordering};

/// What the printed algorithm leaves open or does wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// To the letter: trials add up, γ is kept.
    Printed,
    /// As it must be meant: trials start from the same point, γ begins anew in each iteration.
    Corrected,
}

/// First γ after 0, as a part of the floor of the curvature that Newton's method has.
const FIRST_SHIFT: f64 = 1.0;
/// Growth of γ with each attempt.
const GROWTH: f64 = 2.0;
/// Attempts at a step that descends.
const MOST_SHIFTS: usize = 200;
/// Least δ.
const LEAST_FRACTION: f64 = 1e-9;
/// Length of a shift along the lowest eigenvector, in units of the unknowns.
const PERTURBATION: f64 = 1e-2;
/// Eigenvalues below this part of the largest count as 0: what moves the whole sheet has neither curvature nor gradient.
const ZERO: f64 = 1e-13;

/// Minimises `objective` from `start`. Of the options the tolerances, the first shift (the floor of the curvature) and the
/// iterations count; there are no kicks.
pub(crate) fn shifted_newton<O: Objective>(
    objective: &O,
    start: O::Point,
    options: &NewtonOptions,
    reading: Reading,
    cancel: &AtomicBool,
) -> Minimization<O::Point> {
    let mut out = Minimization::at(start);
    let mut shift = FIRST_SHIFT * options.curvature_floor;
    while out.iterations < options.max_iterations {
        if cancel.load(Ordering::Relaxed) {
            return out.ended(Outcome::Interrupted);
        }
        let here = objective.derivatives(&out.point);
        (out.energy, out.gradient_norm) = (here.energy, norm(&here.gradient));
        out.iterations += 1;
        let eigen = match symmetric_eigen(&here.hessian.to_dense()) {
            Ok(eigen) => eigen,
            Err(failure) => return out.ended(Outcome::Eigen(failure)),
        };
        if out.gradient_norm < options.gradient_tolerance {
            if eigen.values.first().is_none_or(|least| *least >= -options.saddle_tolerance) {
                return out.ended(Outcome::Minimum);
            }
            let step: Vec<f64> = eigen.lowest().iter().map(|v| PERTURBATION * v).collect();
            let fraction = objective.largest_step(&here.guard, &step);
            out.point = objective.moved(&out.point, &step, fraction);
            out.escapes += 1;
            continue;
        }
        if reading == Reading::Corrected {
            shift = FIRST_SHIFT * options.curvature_floor;
        }
        let Some(step) = descending_step(&eigen, &here.gradient, &mut shift) else {
            return out.ended(Outcome::Stalled);
        };
        // The sum of all trials is at most twice the first: so the step bound is asked for that.
        let most = match reading {
            Reading::Printed => objective.largest_step(&here.guard, &step.iter().map(|s| 2.0 * s).collect::<Vec<_>>()),
            Reading::Corrected => objective.largest_step(&here.guard, &step),
        };
        let (mut fraction, mut total) = (most, 0.0);
        out.point = loop {
            if fraction <= LEAST_FRACTION * most {
                return out.ended(Outcome::Stalled);
            }
            total = if reading == Reading::Printed { total + fraction } else { fraction };
            fraction *= 0.5;
            let trial = objective.moved(&out.point, &step, total);
            if objective.energy(&trial) <= here.energy && objective.allows(&out.point, &trial) {
                break trial;
            }
        };
    }
    out
}

/// −(H + γ 1)⁻¹ grad for γ = 0, or the first of the growing γ for which it descends.
fn descending_step(eigen: &Eigen, gradient: &[f64], shift: &mut f64) -> Option<Vec<f64>> {
    let n = gradient.len();
    let largest = eigen.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let parts: Vec<f64> = (0..n).map(|k| (0..n).map(|i| eigen.vectors[(i, k)] * gradient[i]).sum()).collect();
    let mut added = 0.0;
    for _ in 0..MOST_SHIFTS {
        let along = |k: usize| {
            let value = eigen.values[k] + added;
            if value.abs() <= ZERO * largest { 0.0 } else { -parts[k] / value }
        };
        let slope: f64 = (0..n).map(|k| along(k) * parts[k]).sum();
        if slope < 0.0 {
            return Some((0..n).map(|i| (0..n).map(|k| eigen.vectors[(i, k)] * along(k)).sum()).collect());
        }
        // As printed H = H + ε 1, ε = 2 ε: the shifts add up.
        added += *shift;
        *shift *= GROWTH;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::newton::tests::DoubleWell;

    const OPTIONS: NewtonOptions = NewtonOptions {
        gradient_tolerance: 1e-10,
        curvature_floor: 1e-3,
        saddle_tolerance: 1e-8,
        max_iterations: 200,
        max_kicks: 0,
    };

    #[test]
    fn both_readings_leave_a_saddle_and_find_the_well() {
        for reading in [Reading::Printed, Reading::Corrected] {
            let end = shifted_newton(&DoubleWell, [0.0, 0.7], &OPTIONS, reading, &AtomicBool::new(false));
            assert_eq!(end.outcome, Outcome::Minimum, "{reading:?}");
            assert!(end.escapes >= 1 && (end.point[0].abs() - 1.0).abs() < 1e-9, "{reading:?}: {:?}", end.point);
        }
    }

    /// Where the first trial is too long, the printed trials only get longer.
    #[test]
    fn the_printed_trials_do_not_shorten_a_step() {
        let from = [0.60, 0.0]; // Newton's step from there ends at 5.4, far beyond the well
        let end = |reading| shifted_newton(&DoubleWell, from, &OPTIONS, reading, &AtomicBool::new(false)).outcome;
        assert_eq!((end(Reading::Printed), end(Reading::Corrected)), (Outcome::Stalled, Outcome::Minimum));
    }
}
