//! Sequential quadratic programming with exact second derivatives: maximise a linear objective under gaps ≥ 0.
//!
//! The solver knows no ring. At each point the program lists its rows (gaps near zero, with gradient and Hessian);
//! rows may be born and die from point to point and are followed by key and angle. A step solves a convex quadratic
//! program in a box, with one elastic unknown on the worst violation; it is accepted by the merit
//! −value + ν · violation, after a restoration step where the rows at the trial point ask for one. Steps are cut to
//! what the program's guard allows, so that what the guard protects (the topology) is kept on every path.

use super::{
    constraints::{Derivatives, Loads, Multiplier, Row, lagrangian_hessian, violation},
    convexify::convexified,
    qp::{self, QuadraticProgram, SparseRows},
    symmetric::Symmetric,
};
use std::sync::atomic::{AtomicBool, Ordering};

/// What is maximised.
pub trait Program {
    /// A point of the configuration space.
    type Point: Clone;
    /// Data for the step bound.
    type Guard;
    /// Gradient of the linear objective in the unknowns.
    fn objective(&self) -> Vec<f64>;
    /// The objective at `x`.
    fn value(&self, x: &Self::Point) -> f64;
    /// All rows with a gap of at most `band`, with the derivatives that are asked for.
    fn rows(&self, x: &Self::Point, band: f64, derivatives: Derivatives<'_>) -> Vec<Row>;
    /// Where some of the rows that `loads` names are stricter than the gaps they stand for: the rows that can carry instead, true
    /// gaps at closed points, with gradients; those of [`Program::rows`] that `loads` names for all else.
    fn closed_rows(&self, x: &Self::Point, band: f64, loads: &Loads) -> Option<Vec<Row>>;
    /// Data for [`Program::largest_step`] at `x`.
    fn guard(&self, x: &Self::Point) -> Self::Guard;
    /// Largest fraction of `step` (at most 1) that is allowed.
    fn largest_step(&self, x: &Self::Point, guard: &Self::Guard, step: &[f64]) -> f64;
    /// Whether `x` is no point of what is asked, though no row says so: steps that lead there are the last ones.
    fn is_outside(&self, x: &Self::Point) -> bool;
    /// The point reached by `step`.
    fn moved(&self, x: &Self::Point, step: &[f64]) -> Self::Point;
    /// Curvature that the rows stand for but do not show, as vectors v of terms −v vᵀ of the Lagrangian's Hessian.
    fn hidden_curvature(&self, x: &Self::Point, multipliers: &[Multiplier]) -> Vec<Vec<f64>>;
}

/// Limits of the iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SqpOptions {
    /// First half width of the trust box.
    pub first_radius: f64,
    /// Largest half width.
    pub most_radius: f64,
    /// Weight ν of the violation in the merit; raised above the multipliers' sum.
    pub penalty: f64,
    /// Iterations at most.
    pub max_iterations: usize,
    /// Stop when the model predicts less than this.
    pub tolerance: f64,
    /// Stop as soon as the violation is below 1e-13 and the value above this.
    pub enough: f64,
    /// Pause when a full step is shorter than this and predicts less than a hundredth of it: time to try the polish.
    pub pause_at: f64,
}

impl Default for SqpOptions {
    fn default() -> Self {
        SqpOptions {
            first_radius: 0.1,
            most_radius: 0.4,
            penalty: 20.0,
            max_iterations: 150,
            tolerance: 1e-11,
            enough: f64::INFINITY,
            pause_at: 0.0,
        }
    }
}

/// Where the iteration ended.
#[derive(Clone, Debug)]
pub(crate) struct SqpEnd<P> {
    /// Last point.
    pub point: P,
    /// Multipliers of the last quadratic program.
    pub multipliers: Vec<Multiplier>,
    /// Quadratic programs solved.
    pub iterations: usize,
    /// Whether no further step promised anything (or the value was enough).
    pub settled: bool,
    /// Largest violation of a row.
    pub violation: f64,
    /// Whether the last point is none of what is asked.
    pub outside: bool,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// A metric for corrections: what carries nothing gives way first.
pub(super) fn stiff_where_loaded(n: usize, rows: &[Row], multipliers: &[f64]) -> Symmetric {
    let mut loaded = vec![false; n];
    for (row, _) in rows.iter().zip(multipliers).filter(|(_, mu)| **mu > 1e-6) {
        row.columns.iter().for_each(|&i| loaded[i] = true);
    }
    let mut metric = Symmetric::new(n, []);
    loaded.iter().enumerate().for_each(|(i, loaded)| metric.add_to_diagonal(i, if *loaded { 1.0 } else { 0.01 }));
    metric
}

/// Solves min ½ dᵀ H d + linear·d + weight · t under gap + ∇g·d + t ≥ 0, t ≥ 0, |d| ≤ radius: the step d, the rows'
/// multipliers, and the violation t that is left.
pub(super) fn elastic_program(
    rows: &[Row],
    h: &Symmetric,
    linear: &[f64],
    weight: f64,
    radius: f64,
) -> (Vec<f64>, Vec<f64>, f64) {
    let n = linear.len();
    let mut hessian = Symmetric::around(h, n + 1, []);
    hessian.add_to_diagonal(n, 1e-8);
    let linear: Vec<f64> = linear.iter().copied().chain([weight]).collect();
    // Rows that no step in the box can reach are left out: they change nothing.
    let within = |row: &Row| row.gap < radius * row.gradient.iter().map(|a| a.abs()).sum::<f64>();
    let reached: Vec<usize> = (0..rows.len()).filter(|&k| within(&rows[k])).collect();
    let mut matrix = SparseRows::default();
    let mut lower = Vec::with_capacity(reached.len() + 1);
    for row in reached.iter().map(|&k| &rows[k]) {
        matrix.push(row.columns.iter().copied().zip(row.gradient.iter().copied()).chain([(n, 1.0)]));
        lower.push(-row.gap);
    }
    matrix.push([(n, 1.0)]);
    lower.push(0.0);
    let mut half_width = vec![radius; n];
    half_width.push(2.0 * violation(rows) + 1.0);
    let solution = qp::solve(&QuadraticProgram {
        hessian: &hessian,
        linear: &linear,
        rows: &matrix,
        lower: &lower,
        half_width: &half_width,
    });
    let mut multipliers = vec![0.0; rows.len()];
    reached.iter().zip(&solution.multipliers).for_each(|(&k, mu)| multipliers[k] = *mu);
    (solution.x[..n].to_vec(), multipliers, solution.x[n].max(0.0))
}

/// A correction reaches at most this many times the violation that it corrects.
const FURTHEST: f64 = 100.0;
/// Least curvature of the convexified model: it follows the step's size between these. Far from the limit it keeps
/// free motions from being spent on tiny gains (which would carry contacts to the edge where their minima merge).
const LEAST_SHIFT: f64 = 1e-4;
/// See [`LEAST_SHIFT`].
const MOST_SHIFT: f64 = 0.1;

/// Rows up to this gap are listed for a step of at most `radius`.
fn band(radius: f64) -> f64 {
    0.1 + 2.0 * radius
}

/// The merit −value + penalty · violation at a point, and the violation.
fn merit_at<P: Program>(program: &P, x: &P::Point, penalty: f64) -> (f64, f64) {
    let violation = violation(&program.rows(x, 0.0, Derivatives::None));
    (-program.value(x) + penalty * violation, violation)
}

/// The point that the shortest correction by `metric` leads to from `x`, whose rows are violated by up to `violation`.
fn corrected<P: Program>(program: &P, x: &P::Point, violation: f64, metric: &Symmetric, radius: f64) -> P::Point {
    let rows = program.rows(x, band(radius).min(0.2), Derivatives::First);
    let none = vec![0.0; metric.n()];
    let (step, _, _) = elastic_program(&rows, metric, &none, 1e3 * radius, radius.min(FURTHEST * violation));
    program.moved(x, &cut_back(program, x, &step).0)
}

/// The part of a step that is allowed, and which part it is.
fn cut_back<P: Program>(program: &P, x: &P::Point, step: &[f64]) -> (Vec<f64>, f64) {
    let fraction = program.largest_step(x, &program.guard(x), step);
    (step.iter().map(|s| s * fraction).collect(), fraction)
}

/// The half width of the trust box after an accepted step of `size`, by the actual reduction over the predicted one.
fn adapted(radius: f64, ratio: f64, size: f64, most: f64) -> f64 {
    if ratio > 0.7 && size > 0.9 * radius {
        (2.0 * radius).min(most)
    } else if ratio < 0.3 {
        0.5 * radius
    } else {
        radius
    }
}

/// Maximises `program` from `start`; `known` are multipliers of an earlier iteration, if there was one.
pub(crate) fn maximize<P: Program>(
    program: &P,
    start: P::Point,
    known: Vec<Multiplier>,
    options: &SqpOptions,
    cancel: &AtomicBool,
) -> SqpEnd<P::Point> {
    let c = program.objective();
    let n = c.len();
    let descent: Vec<f64> = c.iter().map(|x| -x).collect();
    let mut radius = options.first_radius;
    let mut penalty = options.penalty;
    let mut curvature_shift = MOST_SHIFT;
    let mut end = SqpEnd {
        point: start,
        multipliers: known,
        iterations: 0,
        settled: false,
        violation: f64::INFINITY,
        outside: false,
    };
    let mut activation_band = band(radius);
    let mut loads = Loads::new(&end.multipliers);
    let mut rows = program.rows(&end.point, activation_band, Derivatives::Second(&loads));
    end.violation = violation(&rows);
    while end.iterations < options.max_iterations && !cancel.load(Ordering::Relaxed) {
        if end.violation < 1e-13 && program.value(&end.point) >= options.enough {
            end.settled = true;
            break;
        }
        end.iterations += 1;
        // Quadratic model: the Hessian of the Lagrangian, made positive definite; the constraints linearised, elastic.
        let known = loads.of(&rows);
        let h = convexified(lagrangian_hessian(n, &rows, &known, &[]), &rows, &known, curvature_shift);
        let (step, multipliers, elastic_residual) = elastic_program(&rows, &h, &descent, penalty, radius);
        let size = step.iter().fold(0.0f64, |a, s| a.max(s.abs()));
        let predicted = dot(&c, &step) + penalty * (end.violation - elastic_residual);
        let carrying = rows.iter().zip(&multipliers).filter(|(_, mu)| **mu > 1e-9);
        end.multipliers = carrying.map(|(row, mu)| row.multiplier(*mu)).collect();
        loads = Loads::new(&end.multipliers);
        curvature_shift = size.clamp(LEAST_SHIFT, MOST_SHIFT);
        penalty = penalty.max(2.0 * multipliers.iter().sum::<f64>().min(1e4));
        // Converged: the model predicts no gain of the merit −value + ν violation.
        if predicted < options.tolerance || size < 1e-12 {
            end.settled = true;
            break;
        }
        if size < options.pause_at && predicted < 1e-2 * options.pause_at {
            break;
        }
        // The step is cut back so that no two core circles can cross.
        let (step, fraction) = cut_back(program, &end.point, &step);
        let merit = -program.value(&end.point) + penalty * end.violation;
        // Actual reduction of the merit at the trial point, against the predicted one.
        let mut trial = program.moved(&end.point, &step);
        let (mut trial_merit, mut trial_violation) = merit_at(program, &trial, penalty);
        let predicted_decrease = predicted * fraction;
        // What the curved rows take away again, by the model.
        let model_decrease = predicted_decrease - 0.5 * h.quadratic_form(&step);
        // Second-order correction: the trial point violates curved constraints that the model had as straight ones.
        if merit - trial_merit < 0.5 * predicted_decrease && trial_violation > 0.0 {
            let metric = stiff_where_loaded(n, &rows, &multipliers);
            let corrected = corrected(program, &trial, trial_violation, &metric, radius);
            let (better, left) = merit_at(program, &corrected, penalty);
            if better < trial_merit {
                (trial, trial_merit, trial_violation) = (corrected, better, left);
            }
        }
        // Accept or reject by the ratio of actual to predicted reduction, and adapt the trust region.
        let ratio = (merit - trial_merit) / model_decrease.max(0.1 * predicted_decrease);
        if ratio > 0.05 || (predicted < 1e-9 && merit - trial_merit > -1e-14) {
            end.point = trial;
            end.violation = trial_violation;
            radius = adapted(radius, ratio, size, options.most_radius);
            activation_band = band(radius);
            if program.is_outside(&end.point) {
                end.outside = true;
                break;
            }
        } else {
            radius = 0.3 * radius.min(size);
            if radius < 1e-13 {
                break;
            }
        }
        // After a rejected step the same rows, with the Hessians of those that are loaded now.
        rows = program.rows(&end.point, activation_band, Derivatives::Second(&loads));
    }
    end
}
