//! Polish of a limit by Newton's method on its optimality conditions, and the figures that certify it.
//!
//! At a maximum of c·y under rows g ≥ 0 there are multipliers μ ≥ 0 with c + Σ μ ∇g = 0 and μ g = 0; it is strict to
//! second order where −Σ μ ∇²g is positive on the directions that keep the loaded rows. Rows can be dependent and
//! elements can rattle, so the equations are solved in the least-squares sense, minimum norm.

use super::{
    eigen::{Eigen, block, coupled, symmetric_eigen},
    qp::{self, QuadraticProgram, SparseRows},
    rows::{Derivatives, Multiplier, Row, lagrangian_hessian, multiplier_of, violation},
    sqp::{Program, SqpEnd, elastic_program},
};
use faer::Mat;

/// What was found at a polished point.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// Least true gap, at most 0 (where everything touches or clears, 0).
    pub smallest_gap: f64,
    /// Largest entry of c + Σ μ ∇g.
    pub dual_residual: f64,
    /// Largest |μ g|.
    pub complementarity: f64,
    /// Least multiplier of a row that was taken as active.
    pub min_multiplier: f64,
    /// Least curvature of the Lagrangian on the null space of the loaded rows, zero modes left out; `None` where
    /// nothing but zero modes is left.
    pub min_curvature: Option<f64>,
    /// Directions of that null space without curvature: elements that rattle.
    pub zero_modes: usize,
    /// The multipliers.
    pub multipliers: Vec<Multiplier>,
}

/// Gaps may be negative by this, in units of the reference radius: rounding.
pub const GAP_TOLERANCE: f64 = 1e-12;
/// Residuals of a certified limit.
pub const RESIDUAL_TOLERANCE: f64 = 1e-9;
/// Overlaps below this are cleared in one small step, see [`cleared`].
const ALMOST: f64 = 1e-8;
/// The value may fall by this much in that step.
const MOST_LOSS: f64 = 1e-10;
/// Largest step of the polish in one unknown.
const MOST_STEP: f64 = 0.05;
/// Curvature below which a direction counts as a zero mode, relative to the largest curvature.
const ZERO_MODE: f64 = 1e-7;

impl Certificate {
    /// Whether every condition holds to its tolerance.
    pub fn holds(&self) -> bool {
        self.smallest_gap >= -GAP_TOLERANCE && self.is_critical()
    }

    /// Whether all but the gaps hold, and those nearly.
    fn lacks_only_room(&self) -> bool {
        (-ALMOST..-GAP_TOLERANCE).contains(&self.smallest_gap) && self.is_critical()
    }

    fn is_critical(&self) -> bool {
        self.dual_residual <= RESIDUAL_TOLERANCE
            && self.complementarity <= RESIDUAL_TOLERANCE
            && self.min_multiplier >= -RESIDUAL_TOLERANCE
            && self.min_curvature.is_none_or(|c| c > 0.0)
    }
}

/// Newton on the active rows of `end`, with rows taken in and let go until gaps and multipliers have their signs.
pub fn polish<P: Program>(program: &P, end: &SqpEnd<P::Point>) -> (P::Point, Certificate) {
    const BAND: f64 = 1e-2;
    let c = program.objective();
    let mut x = end.point.clone();
    let most = end.multipliers.iter().map(|m| m.value).fold(0.0, f64::max);
    let mut active: Vec<Multiplier> = end.multipliers.iter().copied().filter(|m| m.value > 1e-5 * most).collect();
    let mut best: Option<(P::Point, Certificate)> = None;
    for _ in 0..12 {
        let mut rows = program.rows(&x, BAND, Derivatives::Second(&active));
        for _ in 0..10 {
            let chosen = matched(&rows, &active);
            let chosen_rows: Vec<Row> = chosen.iter().map(|(k, _)| rows[*k].clone()).collect();
            let known: Vec<f64> = chosen.iter().map(|(_, mu)| *mu).collect();
            let (step, multipliers) = newton_step(&c, &chosen_rows, &known);
            let size = step.iter().fold(0.0f64, |a, s| a.max(s.abs()));
            if !size.is_finite() || size > MOST_STEP {
                break;
            }
            active = labelled(&chosen_rows, &multipliers);
            let guard = program.guard(&x);
            if size < 1e-15 || program.largest_step(&x, &guard, &step) < 1.0 {
                break;
            }
            x = program.moved(&x, &step);
            rows = program.rows(&x, BAND, Derivatives::Second(&active));
            if size < 1e-13 {
                break;
            }
        }
        let mut certificate = certify(program, &x, &rows, &active);
        if certificate.lacks_only_room()
            && let Some(cleared) = cleared(program, &x, BAND)
        {
            let there = program.rows(&cleared, BAND, Derivatives::Second(&active));
            let again = certify(program, &cleared, &there, &active);
            if again.holds() && program.value(&cleared) > program.value(&x) - MOST_LOSS {
                (x, certificate) = (cleared, again);
            }
        }
        let done = certificate.holds();
        let score = |c: &Certificate| (-c.smallest_gap).max(c.dual_residual).max(-c.min_multiplier);
        if best.as_ref().is_none_or(|b| score(&certificate) < score(&b.1)) {
            active = certificate.multipliers.clone();
            best = Some((x.clone(), certificate));
        }
        if done {
            break;
        }
        // Take in what is violated, or let the most negative multiplier go.
        let before = active.len();
        let violated: Vec<&Row> =
            rows.iter().filter(|r| r.gap < -GAP_TOLERANCE && multiplier_of(r, &active) == 0.0).collect();
        active.extend(violated.iter().map(|r| Multiplier {
            key: r.key,
            angle: r.angle,
            minimum: r.minimum,
            value: 1e-300,
        }));
        if active.len() == before {
            match active.iter().enumerate().min_by(|a, b| a.1.value.total_cmp(&b.1.value)) {
                Some((k, m)) if m.value < 0.0 => drop(active.swap_remove(k)),
                _ => break,
            }
        }
    }
    best.unwrap_or_else(|| {
        let rows = program.rows(&end.point, BAND, Derivatives::Second(&end.multipliers));
        (end.point.clone(), certify(program, &end.point, &rows, &end.multipliers))
    })
}

/// `x` moved by the smallest step that clears its overlaps, in units of the worst of them, where rounding does not count.
///
/// A ring that rattles often touches at the limit and carries nothing. Its row is not among the active ones, and its
/// overlap, of the second order in Newton's step, goes away as fast as the ring can give way: by less than 1e-8.
fn cleared<P: Program>(program: &P, x: &P::Point, band: f64) -> Option<P::Point> {
    const MOST: f64 = 1e3;
    let mut rows = program.rows(x, band, Derivatives::First);
    let worst = violation(&rows);
    rows.retain_mut(|row| {
        row.gap /= worst;
        row.gap < 10.0 * MOST
    });
    let n = program.objective().len();
    let (step, _, _) = elastic_program(&rows, &Mat::identity(n, n), &vec![0.0; n], 1e2 * MOST, MOST);
    let step: Vec<f64> = step.iter().map(|d| d * worst).collect();
    let allowed = program.largest_step(x, &program.guard(x), &step) >= 1.0;
    allowed.then(|| program.moved(x, &step))
}

/// Indices of the rows that `active` names, with their multipliers.
fn matched(rows: &[Row], active: &[Multiplier]) -> Vec<(usize, f64)> {
    rows.iter().enumerate().map(|(k, r)| (k, multiplier_of(r, active))).filter(|(_, mu)| *mu != 0.0).collect()
}

fn labelled(rows: &[Row], multipliers: &[f64]) -> Vec<Multiplier> {
    let pairs = rows.iter().zip(multipliers);
    pairs.map(|(r, &value)| Multiplier { key: r.key, angle: r.angle, minimum: r.minimum, value }).collect()
}

/// d and μ of [H −Aᵀ; A 0][d; μ] = [c; −g], minimum norm; H = −Σ μ ∇²g with the known multipliers.
fn newton_step(c: &[f64], rows: &[Row], known: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (n, m) = (c.len(), rows.len());
    let h = lagrangian_hessian(n, rows, known);
    // Symmetric with −μ as the unknown.
    let mut system = Mat::zeros(n + m, n + m);
    for i in 0..n {
        for j in 0..n {
            system[(i, j)] = 0.5 * (h[(i, j)] + h[(j, i)]);
        }
    }
    let mut right = c.to_vec();
    for (k, row) in rows.iter().enumerate() {
        for (&column, &value) in row.columns.iter().zip(&row.gradient) {
            system[(n + k, column)] = value;
            system[(column, n + k)] = value;
        }
        right.push(-row.gap);
    }
    // Motions that hardly matter get huge steps from tiny residuals: leave out as many as it takes.
    let system = LeastNorm::new(&system);
    let mut solution = vec![f64::NAN; n + m];
    for cut in [1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3] {
        solution = system.solve(&right, cut);
        if solution[..n].iter().all(|d| d.abs() <= MOST_STEP) {
            break;
        }
    }
    (solution[..n].to_vec(), solution[n..].iter().map(|x| -x).collect())
}

/// Minimum-norm least-squares solutions of a symmetric system.
struct LeastNorm {
    /// The unknowns that the system couples; the others are 0.
    coupled: Vec<usize>,
    eigen: Option<Eigen>,
}

impl LeastNorm {
    fn new(system: &Mat<f64>) -> Self {
        let coupled = coupled(system);
        let eigen = symmetric_eigen(&block(system, &coupled)).ok();
        LeastNorm { coupled, eigen }
    }

    /// The solution where eigenvalues below `cut` times the largest count as zero.
    fn solve(&self, right: &[f64], cut: f64) -> Vec<f64> {
        let Some(eigen) = &self.eigen else { return vec![f64::NAN; right.len()] };
        let largest = eigen.values.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let mut out = vec![0.0; right.len()];
        for (k, value) in eigen.values.iter().enumerate().filter(|(_, v)| v.abs() > cut * largest) {
            let v = || eigen.vectors.col(k).iter().zip(&self.coupled);
            let along: f64 = v().map(|(v, &i)| v * right[i]).sum::<f64>() / value;
            v().for_each(|(v, &i)| out[i] += along * v);
        }
        out
    }
}

/// Multipliers ≥ 0 with the least |c + Σ μ ∇g|, for dependent rows whose minimum-norm multipliers have wrong signs.
fn non_negative_multipliers(c: &[f64], rows: &[Row], most: f64) -> Vec<f64> {
    let m = rows.len();
    let n = c.len();
    let gradient = |k: usize| {
        let mut dense = vec![0.0; n];
        for (&column, &value) in rows[k].columns.iter().zip(&rows[k].gradient) {
            dense[column] += value;
        }
        dense
    };
    let gradients: Vec<Vec<f64>> = (0..m).map(gradient).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let hessian = Mat::from_fn(m, m, |i, j| dot(&gradients[i], &gradients[j]) + if i == j { 1e-13 } else { 0.0 });
    let linear: Vec<f64> = gradients.iter().map(|g| dot(g, c)).collect();
    let mut identity = SparseRows::default();
    (0..m).for_each(|k| identity.push([(k, 1.0)]));
    let half_width = vec![10.0 * most + 1.0; m];
    let zeros = vec![0.0; m];
    qp::solve(&QuadraticProgram {
        hessian: &hessian,
        linear: &linear,
        rows: &identity,
        lower: &zeros,
        half_width: &half_width,
    })
    .x
    .iter()
    .map(|mu| mu.max(0.0))
    .collect()
}

fn dual_residual(c: &[f64], rows: &[Row], multipliers: &[f64]) -> f64 {
    let mut residual = c.to_vec();
    for (row, mu) in rows.iter().zip(multipliers) {
        for (&column, &value) in row.columns.iter().zip(&row.gradient) {
            residual[column] += mu * value;
        }
    }
    residual.iter().fold(0.0, |a, r| a.max(r.abs()))
}

/// The figures at a point with its rows and the multipliers of the active ones.
fn certify<P: Program>(program: &P, x: &P::Point, rows: &[Row], active: &[Multiplier]) -> Certificate {
    let c = &program.objective()[..];
    let n = c.len();
    let chosen_rows: Vec<Row> = matched(rows, active).iter().map(|(k, _)| rows[*k].clone()).collect();
    // Least squares first: exact to rounding. Where signs are wrong, the constrained ones.
    let mut multipliers = least_squares_multipliers(c, &chosen_rows);
    let least = |mu: &[f64]| mu.iter().copied().fold(f64::INFINITY, f64::min);
    if least(&multipliers) < -RESIDUAL_TOLERANCE {
        let most = multipliers.iter().fold(0.0f64, |a, m| a.max(m.abs()));
        let signed = non_negative_multipliers(c, &chosen_rows, most);
        if dual_residual(c, &chosen_rows, &signed) <= RESIDUAL_TOLERANCE {
            multipliers = signed;
        }
    }
    let loaded: Vec<&Row> =
        chosen_rows.iter().zip(&multipliers).filter(|(_, mu)| **mu > 1e-8).map(|(r, _)| r).collect();
    let mut hessian = lagrangian_hessian(n, &chosen_rows, &multipliers);
    for v in program.hidden_curvature(x, &labelled(&chosen_rows, &multipliers)) {
        for i in 0..n {
            for j in 0..n {
                hessian[(i, j)] -= v[i] * v[j];
            }
        }
    }
    let (min_curvature, zero_modes) = curvature(n, &hessian, &loaded);
    Certificate {
        smallest_gap: program.rows(x, 0.0, Derivatives::None).iter().map(|r| r.gap).fold(0.0, f64::min),
        dual_residual: dual_residual(c, &chosen_rows, &multipliers),
        complementarity: chosen_rows.iter().zip(&multipliers).map(|(r, mu)| (r.gap * mu).abs()).fold(0.0, f64::max),
        min_multiplier: least(&multipliers),
        min_curvature,
        zero_modes,
        multipliers: labelled(&chosen_rows, &multipliers),
    }
}

/// Minimum-norm least-squares solution of Σ μ ∇g = −c.
fn least_squares_multipliers(c: &[f64], rows: &[Row]) -> Vec<f64> {
    let (n, m) = (c.len(), rows.len());
    let mut system = Mat::zeros(n + m, n + m);
    for (k, row) in rows.iter().enumerate() {
        for (&column, &value) in row.columns.iter().zip(&row.gradient) {
            system[(n + k, column)] = value;
            system[(column, n + k)] = value;
        }
    }
    let mut right: Vec<f64> = c.iter().map(|x| -x).collect();
    right.resize(n + m, 0.0);
    LeastNorm::new(&system).solve(&right, 1e-11)[n..].to_vec()
}

/// Least non-zero curvature of `h` on the null space of `loaded`, and the number of its zero modes.
fn curvature(n: usize, h: &Mat<f64>, loaded: &[&Row]) -> (Option<f64>, usize) {
    let mut gram = Mat::zeros(n, n);
    for row in loaded {
        for (&i, &a) in row.columns.iter().zip(&row.gradient) {
            for (&j, &b) in row.columns.iter().zip(&row.gradient) {
                gram[(i, j)] += a * b;
            }
        }
    }
    // Unknowns that neither meets are zero modes.
    let met: Vec<usize> =
        (0..n).filter(|&j| [h, &gram].iter().any(|matrix| matrix.col(j).iter().any(|v| *v != 0.0))).collect();
    let idle = n - met.len();
    let Ok(eigen) = symmetric_eigen(&block(&gram, &met)) else { return (Some(f64::NAN), 0) };
    let largest = eigen.values.last().copied().unwrap_or(0.0).max(1e-300);
    let free: Vec<usize> = (0..met.len()).filter(|&k| eigen.values[k] < 1e-12 * largest).collect();
    let basis = Mat::from_fn(met.len(), free.len(), |i, k| eigen.vectors[(i, free[k])]);
    if free.is_empty() {
        return (None, idle);
    }
    let reduced = basis.transpose() * block(h, &met) * &basis;
    let symmetric = Mat::from_fn(free.len(), free.len(), |i, j| 0.5 * (reduced[(i, j)] + reduced[(j, i)]));
    let Ok(eigen) = symmetric_eigen(&symmetric) else { return (Some(f64::NAN), 0) };
    let scale = eigen.values.iter().fold(0.0f64, |a, v| a.max(v.abs())).max(1e-300);
    let is_zero = |v: &f64| v.abs() <= ZERO_MODE * scale.max(1.0);
    let zero_modes = idle + eigen.values.iter().filter(|v| is_zero(v)).count();
    (eigen.values.iter().copied().find(|v| !is_zero(v)), zero_modes)
}
