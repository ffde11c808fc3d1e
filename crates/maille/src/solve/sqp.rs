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

/// The rows as a dense matrix, row-major, with `extra` further columns of zeros.
fn dense(rows: &[Row], n: usize, extra: usize) -> Vec<f64> {
    let width = n + extra;
    let mut out = vec![0.0; rows.len() * width];
    for (k, row) in rows.iter().enumerate() {
        for (&column, &value) in row.columns.iter().zip(&row.gradient) {
            out[k * width + column] = value;
        }
    }
    out
}

/// H with its eigenvalues raised to at least `floor`.
fn convexified(h: Mat<f64>, floor: f64) -> Mat<f64> {
    let n = h.nrows();
    match symmetric_eigen(&h) {
        Ok(eigen) => {
            let scaled = Mat::from_fn(n, n, |i, k| eigen.vectors[(i, k)] * eigen.values[k].max(floor));
            scaled * eigen.vectors.transpose()
        }
        Err(_) => Mat::identity(n, n),
    }
}

/// The step of the convexified model at a point; with the multipliers of its rows and the violation that it leaves.
fn model_step(rows: &[Row], c: &[f64], multipliers: &[f64], radius: f64, penalty: f64) -> (Vec<f64>, Vec<f64>, f64) {
    const FLOOR: f64 = 1e-4;
    let n = c.len();
    let h = convexified(lagrangian_hessian(n, rows, multipliers), FLOOR);
    let worst = violation(rows);
    let mut hessian = Mat::zeros(n + 1, n + 1);
    for i in 0..n {
        for j in 0..n {
            hessian[(i, j)] = h[(i, j)];
        }
    }
    hessian[(n, n)] = 1e-8;
    let mut linear: Vec<f64> = c.iter().map(|x| -x).collect();
    linear.push(penalty);
    let mut matrix = dense(rows, n, 1);
    for k in 0..rows.len() {
        matrix[k * (n + 1) + n] = 1.0;
    }
    matrix.extend((0..=n).map(|i| f64::from(u8::from(i == n))));
    let mut lower: Vec<f64> = rows.iter().map(|r| -r.gap).collect();
    lower.push(0.0);
    let mut half_width = vec![radius; n];
    half_width.push(2.0 * worst + 1.0);
    let solution =
        qp::solve(&QuadraticProgram { hessian: &hessian, linear: &linear, rows: &matrix, lower: &lower, half_width: &half_width });
    let left = solution.x[n].max(0.0);
    (solution.x[..n].to_vec(), solution.multipliers[..rows.len()].to_vec(), left)
}

/// The shortest step that makes all rows non-negative to first order, within `radius`.
fn restoration_step(rows: &[Row], n: usize, radius: f64) -> Vec<f64> {
    let none = vec![0.0; rows.len()];
    let mut hessian = Mat::zeros(n + 1, n + 1);
    for i in 0..n {
        hessian[(i, i)] = 1.0;
    }
    hessian[(n, n)] = 1e-8;
    let mut linear = none.clone();
    linear.resize(n + 1, 0.0);
    linear.truncate(n + 1);
    linear.fill(0.0);
    linear[n] = 1e3 * radius.max(1e-6);
    let mut matrix = dense(rows, n, 1);
    for k in 0..rows.len() {
        matrix[k * (n + 1) + n] = 1.0;
    }
    matrix.extend((0..=n).map(|i| f64::from(u8::from(i == n))));
    let mut lower: Vec<f64> = rows.iter().map(|r| -r.gap).collect();
    lower.push(0.0);
    let mut half_width = vec![radius; n];
    half_width.push(2.0 * violation(rows) + 1.0);
    qp::solve(&QuadraticProgram { hessian: &hessian, linear: &linear, rows: &matrix, lower: &lower, half_width: &half_width }).x
        [..n]
        .to_vec()
}

/// Maximises `program` from `start`.
pub fn maximize<P: Program>(program: &P, start: P::Point, options: &SqpOptions, cancel: &AtomicBool) -> SqpEnd<P::Point> {
    let c = program.objective();
    let n = c.len();
    let mut radius = options.first_radius;
    let mut penalty = options.penalty;
    let band = |radius: f64| 0.1 + 2.0 * radius;
    let mut end = SqpEnd { point: start, multipliers: Vec::new(), iterations: 0, settled: false, violation: f64::INFINITY };
    let mut rows = program.rows(&end.point, band(radius), true);
    end.violation = violation(&rows);
    while end.iterations < options.max_iterations && !cancel.load(Ordering::Relaxed) {
        if end.violation < 1e-13 && program.value(&end.point) >= options.enough {
            end.settled = true;
            break;
        }
        end.iterations += 1;
        let known: Vec<f64> = rows.iter().map(|row| multiplier_of(row, &end.multipliers)).collect();
        let (step, multipliers, left) = model_step(&rows, &c, &known, radius, penalty);
        let keep = |multipliers: &[f64]| -> Vec<Multiplier> {
            let pairs = rows.iter().zip(multipliers).filter(|(_, mu)| **mu > 1e-9);
            pairs.map(|(r, &value)| Multiplier { key: r.key, angle: r.angle, minimum: r.minimum, value }).collect()
        };
        let size = step.iter().fold(0.0f64, |a, s| a.max(s.abs()));
        let promised = dot(&c, &step) + penalty * (end.violation - left);
        end.multipliers = keep(&multipliers);
        penalty = penalty.max(2.0 * multipliers.iter().sum::<f64>().min(1e4));
        if promised < options.tolerance || size < 1e-12 {
            end.settled = true;
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
            let correction = restoration_step(&there, n, radius);
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
