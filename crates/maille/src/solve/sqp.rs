//! Sequential quadratic programming with exact second derivatives: maximise a linear objective under gaps ≥ 0.
//!
//! The solver knows no ring. At each point the program lists its rows (gaps near zero, with gradient and Hessian);
//! rows may be born and die from point to point and are followed by key and angle. A step solves a convex quadratic
//! program in a box, with one elastic unknown on the worst violation; it is accepted by the merit
//! −value + ν · violation, after a restoration step where the rows at the trial point ask for one. Steps are cut to
//! what the program's guard allows, so that what the guard protects (the topology) is kept on every path.

use super::{
    eigen::symmetric_eigen,
    qp::{self, QuadraticProgram},
};
use faer::Mat;
use std::sync::atomic::{AtomicBool, Ordering};

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
    /// ∂²g in those, k × k.
    pub hessian: Vec<f64>,
}

impl Row {
    /// A row without derivatives.
    pub fn value(key: u64, angle: f64, gap: f64) -> Row {
        Row { key, angle, gap, minimum: true, columns: Vec::new(), gradient: Vec::new(), hessian: Vec::new() }
    }
}

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
    /// All rows with a gap of at most `band`, with derivatives if asked.
    fn rows(&self, x: &Self::Point, band: f64, derivatives: bool) -> Vec<Row>;
    /// Data for [`Program::largest_step`] at `x`.
    fn guard(&self, x: &Self::Point) -> Self::Guard;
    /// Largest fraction of `step` (at most 1) that is allowed.
    fn largest_step(&self, x: &Self::Point, guard: &Self::Guard, step: &[f64]) -> f64;
    /// The point reached by `step`.
    fn moved(&self, x: &Self::Point, step: &[f64]) -> Self::Point;
    /// Curvature that the rows stand for but do not show, as vectors v of terms −v vᵀ of the Lagrangian's Hessian.
    fn hidden_curvature(&self, x: &Self::Point, multipliers: &[Multiplier]) -> Vec<Vec<f64>>;
}

/// Limits of the iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SqpOptions {
    /// First half width of the trust box.
    pub first_radius: f64,
    /// Largest half width.
    pub most_radius: f64,
    /// Weight ν of the violation in the merit; raised above the multipliers' sum.
    pub penalty: f64,
    /// Iterations at most.
    pub max_iterations: usize,
    /// Stop when the model promises less than this.
    pub tolerance: f64,
    /// Stop as soon as the violation is below 1e-13 and the value above this.
    pub enough: f64,
    /// Pause when a full step is shorter than this and promises less than a thousandth of it: time to try the polish.
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

/// Where the iteration ended.
#[derive(Clone, Debug)]
pub struct SqpEnd<P> {
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
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Largest violation among `rows`.
pub fn violation(rows: &[Row]) -> f64 {
    rows.iter().map(|r| -r.gap).fold(0.0, f64::max)
}

/// Multiplier of `row` among `known`: that of the nearest angle under the same key.
pub fn multiplier_of(row: &Row, known: &[Multiplier]) -> f64 {
    let apart = |m: &Multiplier| {
        let turn = (m.angle - row.angle).rem_euclid(std::f64::consts::TAU);
        turn.min(std::f64::consts::TAU - turn)
    };
    known
        .iter()
        .filter(|m| m.key == row.key && m.minimum == row.minimum)
        .map(|m| (apart(m), m.value))
        .filter(|(apart, _)| *apart < if row.minimum { 0.4 } else { 0.05 })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0.0, |(_, value)| value)
}

/// −Σ μ ∇²g over all unknowns.
pub fn lagrangian_hessian(n: usize, rows: &[Row], multipliers: &[f64]) -> Mat<f64> {
    let mut h = Mat::zeros(n, n);
    for (row, mu) in rows.iter().zip(multipliers).filter(|(_, mu)| **mu != 0.0) {
        let k = row.columns.len();
        for (p, &i) in row.columns.iter().enumerate() {
            for (q, &j) in row.columns.iter().enumerate() {
                h[(i, j)] -= mu * row.hessian[p * k + q];
            }
        }
    }
    h
}

/// H made positive: first by adding σ Σ ∇g ∇gᵀ / |∇g|² over the loaded rows, which changes nothing on the directions
/// that keep them, so that the model stays exact there; what is still negative is raised to `floor`.
fn convexified(mut h: Mat<f64>, rows: &[Row], multipliers: &[f64], floor: f64) -> Mat<f64> {
    let n = h.nrows();
    let raise = |h: Mat<f64>| match symmetric_eigen(&h) {
        Ok(eigen) if eigen.values[0] >= floor => h,
        Ok(eigen) => {
            let scaled = Mat::from_fn(n, n, |i, k| eigen.vectors[(i, k)] * eigen.values[k].max(floor));
            scaled * eigen.vectors.transpose()
        }
        Err(_) => Mat::identity(n, n),
    };
    let sigma = match symmetric_eigen(&h) {
        Ok(eigen) => 2.0 * (floor - eigen.values[0]).max(0.0),
        Err(_) => return Mat::identity(n, n),
    };
    if sigma > 0.0 {
        for (row, _) in rows.iter().zip(multipliers).filter(|(_, mu)| **mu > 1e-6) {
            let weight = sigma / dot(&row.gradient, &row.gradient).max(1e-300);
            for (&i, &a) in row.columns.iter().zip(&row.gradient) {
                for (&j, &b) in row.columns.iter().zip(&row.gradient) {
                    h[(i, j)] += weight * a * b;
                }
            }
        }
    }
    raise(h)
}

/// Solves min ½ dᵀ H d + linear·d + weight · t under gap + ∇g·d + t ≥ 0, t ≥ 0, |d| ≤ radius: the step d, the rows'
/// multipliers, and the violation t that is left.
fn elastic_program(rows: &[Row], h: &Mat<f64>, linear: &[f64], weight: f64, radius: f64) -> (Vec<f64>, Vec<f64>, f64) {
    let n = linear.len();
    let hessian = Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
        (true, true) => h[(i, j)],
        (false, false) => 1e-8,
        _ => 0.0,
    });
    let linear: Vec<f64> = linear.iter().copied().chain([weight]).collect();
    let width = n + 1;
    let mut matrix = vec![0.0; (rows.len() + 1) * width];
    for (k, row) in rows.iter().enumerate() {
        for (&column, &value) in row.columns.iter().zip(&row.gradient) {
            matrix[k * width + column] = value;
        }
        matrix[k * width + n] = 1.0;
    }
    matrix[rows.len() * width + n] = 1.0;
    let lower: Vec<f64> = rows.iter().map(|r| -r.gap).chain([0.0]).collect();
    let mut half_width = vec![radius; n];
    half_width.push(2.0 * violation(rows) + 1.0);
    let solution = qp::solve(&QuadraticProgram {
        hessian: &hessian,
        linear: &linear,
        rows: &matrix,
        lower: &lower,
        half_width: &half_width,
    });
    (solution.x[..n].to_vec(), solution.multipliers[..rows.len()].to_vec(), solution.x[n].max(0.0))
}

/// Least curvature of the convexified model: it follows the step's size between these. Far from the limit it keeps
/// free motions from being spent on tiny gains (which would carry contacts to the edge where their minima merge).
const LEAST_FLOOR: f64 = 1e-4;
/// See [`LEAST_FLOOR`].
const MOST_FLOOR: f64 = 0.1;

/// Maximises `program` from `start`; `known` are multipliers of an earlier iteration, if there was one.
pub fn maximize<P: Program>(
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
    let band = |radius: f64| 0.1 + 2.0 * radius;
    let mut floor = MOST_FLOOR;
    let mut end = SqpEnd { point: start, multipliers: known, iterations: 0, settled: false, violation: f64::INFINITY };
    let mut rows = program.rows(&end.point, band(radius), true);
    end.violation = violation(&rows);
    while end.iterations < options.max_iterations && !cancel.load(Ordering::Relaxed) {
        if end.violation < 1e-13 && program.value(&end.point) >= options.enough {
            end.settled = true;
            break;
        }
        end.iterations += 1;
        let known: Vec<f64> = rows.iter().map(|row| multiplier_of(row, &end.multipliers)).collect();
        let h = convexified(lagrangian_hessian(n, &rows, &known), &rows, &known, floor);
        let (step, multipliers, left) = elastic_program(&rows, &h, &descent, penalty, radius);
        let keep = |multipliers: &[f64]| -> Vec<Multiplier> {
            let pairs = rows.iter().zip(multipliers).filter(|(_, mu)| **mu > 1e-9);
            pairs.map(|(r, &value)| Multiplier { key: r.key, angle: r.angle, minimum: r.minimum, value }).collect()
        };
        let size = step.iter().fold(0.0f64, |a, s| a.max(s.abs()));
        let promised = dot(&c, &step) + penalty * (end.violation - left);
        end.multipliers = keep(&multipliers);
        floor = size.clamp(LEAST_FLOOR, MOST_FLOOR);
        penalty = penalty.max(2.0 * multipliers.iter().sum::<f64>().min(1e4));
        if promised < options.tolerance || size < 1e-12 {
            end.settled = true;
            break;
        }
        if size < options.pause_at && promised < 1e-3 * options.pause_at {
            break;
        }
        let guard = program.guard(&end.point);
        let fraction = program.largest_step(&end.point, &guard, &step);
        let step: Vec<f64> = step.iter().map(|s| s * fraction).collect();
        let merit = -program.value(&end.point) + penalty * end.violation;
        let judge = |point: &P::Point| {
            let violation = violation(&program.rows(point, 0.0, false));
            (-program.value(point) + penalty * violation, violation)
        };
        let mut trial = program.moved(&end.point, &step);
        let (mut reached, mut worst) = judge(&trial);
        let wanted = promised * fraction;
        if merit - reached < 0.5 * wanted && worst > 0.0 {
            let there = program.rows(&trial, band(radius).min(0.2), true);
            let none = vec![0.0; n];
            let (correction, _, _) = elastic_program(&there, &Mat::identity(n, n), &none, 1e3 * radius, radius);
            let guard = program.guard(&trial);
            let fraction = program.largest_step(&trial, &guard, &correction);
            let correction: Vec<f64> = correction.iter().map(|s| s * fraction).collect();
            let corrected = program.moved(&trial, &correction);
            let (better, left) = judge(&corrected);
            if better < reached {
                (trial, reached, worst) = (corrected, better, left);
            }
        }
        let ratio = (merit - reached) / wanted;
        if ratio > 0.05 || (promised < 1e-9 && merit - reached > -1e-14) {
            end.point = trial;
            end.violation = worst;
            if ratio > 0.7 && size > 0.9 * radius {
                radius = (2.0 * radius).min(options.most_radius);
            } else if ratio < 0.3 {
                radius *= 0.5;
            }
            rows = program.rows(&end.point, band(radius), true);
        } else {
            radius = 0.3 * radius.min(size);
            if radius < 1e-13 {
                break;
            }
        }
    }
    end
}
