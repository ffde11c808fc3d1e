//! Polish of a limit by Newton's method on its optimality conditions.
//!
//! Rows can be dependent and elements can rattle, so the equations are solved in the least-squares sense, minimum norm.

use super::{
    certificate::{BAND, Certificate, GAP_TOLERANCE, certify, labelled, matched},
    eigen::LeastNorm,
    rows::{Derivatives, Multiplier, Row, lagrangian_hessian, multiplier_of, violation},
    sqp::{Program, SqpEnd, elastic_program},
};
use faer::Mat;

/// The value may fall by this much in that step.
const MOST_LOSS: f64 = 1e-10;
/// Largest step of the polish in one unknown.
const MOST_STEP: f64 = 0.05;
/// Newton on the active rows of `end`, with rows taken in and let go until gaps and multipliers have their signs.
pub fn polish<P: Program>(program: &P, end: &SqpEnd<P::Point>) -> (P::Point, Certificate) {
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
        let mut certificate = certify(program, &x, &active);
        if certificate.lacks_only_room()
            && let Some(cleared) = cleared(program, &x)
        {
            let again = certify(program, &cleared, &active);
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
    best.unwrap_or_else(|| (end.point.clone(), certify(program, &end.point, &end.multipliers)))
}

/// `x` moved by the smallest step that clears its overlaps, in units of the worst of them, where rounding does not count.
///
/// A ring that rattles often touches at the limit and carries nothing. Its row is not among the active ones, and its
/// overlap, of the second order in Newton's step, goes away as fast as the ring can give way: by less than 1e-8.
fn cleared<P: Program>(program: &P, x: &P::Point) -> Option<P::Point> {
    const MOST: f64 = 1e3;
    let mut rows = program.rows(x, BAND, Derivatives::First);
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
