//! Descent from one start: Levenberg–Marquardt steps within the bounds.

use super::{
    search::{Point, Refused, Search},
    step::within_bounds,
};
use nalgebra::DMatrix;
use std::sync::atomic::Ordering;

/// Damping at first, relative to the largest diagonal entry of JᵀJ.
const DAMPING: f64 = 1e-4;
/// Damping at which a start is given up, relative to the same.
const MOST_DAMPING: f64 = 1e8;
/// Damping is multiplied by this after a step that does not help, and divided by it after one that does.
const CHANGE: f64 = 5.0;
/// A step helps where the cost falls by this share of what its model promises.
const HELPS: f64 = 1e-3;
/// Steps below this share of the ranges end the descent.
const SMALLEST: f64 = 1e-10;

/// The best point of a descent from `begin`. A point without derivatives ends it.
pub(super) fn descend(search: &Search<'_>, begin: Point, tell: &dyn Fn(&Point)) -> Point {
    let mut at = begin;
    let mut damping = DAMPING;
    let Ok(mut slopes) = search.slopes(&at) else { return at };
    for _ in 1..search.options.designs {
        tell(&at);
        if search.reached(&at) || search.cancel.load(Ordering::Relaxed) {
            return at;
        }
        let (squares, force) = (slopes.transpose() * &slopes, slopes.transpose() * &at.residuals);
        let largest = squares.diagonal().amax();
        if largest == 0.0 {
            return at;
        }
        let lower: Vec<f64> = at.shares.iter().map(|x| -x).collect();
        let upper: Vec<f64> = at.shares.iter().map(|x| 1.0 - x).collect();
        let damped = &squares + DMatrix::identity(force.len(), force.len()) * (damping * largest);
        let step = within_bounds(&damped, &force, &lower, &upper);
        let promised = at.cost() - (&at.residuals + &slopes * &step).norm_squared();
        if step.amax() < SMALLEST || promised <= 0.0 || damping > MOST_DAMPING {
            return at;
        }
        let shares = at.shares.iter().zip(step.iter()).map(|(x, d)| (x + d).clamp(0.0, 1.0)).collect();
        match search.solve(shares) {
            Ok(next) if at.cost() - next.cost() > HELPS * promised => {
                let Ok(new) = search.slopes(&next) else { return next };
                (at, slopes) = (next, new);
                damping = (damping / CHANGE).max(1e-12);
            }
            Err(Refused::Interrupted) => return at,
            Ok(_) | Err(_) => damping *= CHANGE,
        }
    }
    at
}
