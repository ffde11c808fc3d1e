//! Polish of a limit by Newton's method on its optimality conditions.
//!
//! Rows can be dependent and elements can rattle, so the equations are solved in the least-squares sense, minimum norm.

use super::{
    certificate::{
        BAND, Certificate, GAP_TOLERANCE, RESIDUAL_TOLERANCE, certify, labelled, matched, measure_curvature,
    },
    constraints::{Derivatives, Loads, Multiplier, Row, lagrangian_hessian, violation},
    kkt_system,
    sqp::{Program, SqpEnd, elastic_program, stiff_where_loaded},
};

/// The value may fall by this much in that step.
const MOST_LOSS: f64 = 1e-10;
/// By this much where nothing else is certified: what a certificate's complementarity leaves open.
const LAST_LOSS: f64 = RESIDUAL_TOLERANCE;
/// Shares of the largest multiplier above which a row counts as loaded: with the first, chains that are stretched side by
/// side all count; with the second, what only touches does not.
const LOADED: [f64; 2] = [1e-5, 1e-3];
/// Newton steps at most; half as many as there are unknowns if that is more.
const LEAST_BUDGET: usize = 30;
/// Rows are taken in or let go so often in a row while the point stays.
const MOST_IDLE: usize = 30;
/// Times that overlaps are cleared in a row.
const CLEARINGS: usize = 6;
/// Largest step of the polish in one unknown.
const MOST_STEP: f64 = 0.05;
/// Curvature that is added to hold motions without curvature of their own.
const HOLDS: [f64; 5] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2];

/// A point with its certificate.
type Certified<X> = (X, Certificate);

/// Newton on the rows of `end` that are loaded, by either measure of that; the better point with its certificate,
/// whose curvature is measured if all else holds. Where it does not hold, also a point whose certificate holds at the cost of up to
/// `LAST_LOSS`, if there is one: a last resort.
pub(crate) fn polish<P: Program>(
    program: &P,
    end: &SqpEnd<P::Point>,
) -> (Certified<P::Point>, Option<Certified<P::Point>>) {
    let mut last_resort = None;
    let most = end.multipliers.iter().map(|m| m.value).fold(0.0, f64::max);
    let mut best: Option<(P::Point, Certificate)> = None;
    let mut tried = 0;
    for share in LOADED {
        let active: Vec<Multiplier> = end.multipliers.iter().copied().filter(|m| m.value > share * most).collect();
        if active.len() == tried {
            break;
        }
        tried = active.len();
        let found = polished(program, end.point.clone(), active, &mut last_resort);
        if best.as_ref().is_none_or(|b| found.1.score() < b.1.score()) {
            best = Some(found);
        }
        if best.as_ref().is_some_and(|b| b.1.holds()) {
            break;
        }
    }
    let best = best.unwrap_or_else(|| {
        let certificate = certify(program, &end.point, &end.multipliers);
        (end.point.clone(), certificate)
    });
    let last_resort = last_resort.filter(|_| !best.1.holds());
    (best, last_resort)
}

/// Newton on the rows `active`, with rows taken in and let go until gaps and multipliers have their signs.
fn polished<P: Program>(
    program: &P,
    mut x: P::Point,
    mut active: Vec<Multiplier>,
    last_resort: &mut Option<Certified<P::Point>>,
) -> Certified<P::Point> {
    let mut best: Option<(P::Point, Certificate)> = None;
    let mut budget = LEAST_BUDGET.max(program.objective().len() / 2);
    // Where rows were taken in: what stood there before.
    let mut taken: Option<(f64, Vec<Multiplier>)> = None;
    let mut idle = 0;
    while budget > 0 && idle < MOST_IDLE {
        // Newton on the optimality conditions of the active set.
        idle = if newton(program, &mut x, &mut active, &mut budget) { 0 } else { idle + 1 };
        let mut certificate = certify(program, &x, &active);
        // Where only overlaps are left, they are removed by a least-norm step, at a small cost in the value.
        for _ in 0..CLEARINGS {
            if !certificate.lacks_only_room() {
                break;
            }
            let Some(cleared) = cleared(program, &x, &active) else { break };
            let (mut settled, mut carrying) = (cleared.clone(), active.clone());
            newton(program, &mut settled, &mut carrying, &mut budget);
            let again = certify(program, &settled, &carrying);
            if again.smallest_gap > 0.5 * certificate.smallest_gap {
                (x, active, certificate) = (settled, carrying, again);
                continue;
            }
            let again = certify(program, &cleared, &active);
            let loss = program.value(&x) - program.value(&cleared);
            if again.holds_to_first_order() && loss < MOST_LOSS {
                (x, certificate) = (cleared, again);
            } else if again.holds_to_first_order() && loss < LAST_LOSS && last_resort.is_none() {
                let mut last = again;
                measure_curvature(program, &cleared, &mut last);
                *last_resort = Some((cleared, last)).filter(|(_, last)| last.holds());
            }
            break;
        }
        if certificate.holds_to_first_order() {
            measure_curvature(program, &x, &mut certificate);
        }
        let figures = (certificate.smallest_gap, certificate.multipliers.clone());
        // Rows were taken in, but nothing has moved: the same would go on.
        let done = certificate.holds() || taken.as_ref() == Some(&figures);
        taken = None;
        if best.as_ref().is_none_or(|b| certificate.score() < b.1.score()) {
            active = certificate.multipliers.clone();
            best = Some((x.clone(), certificate));
        }
        if done {
            break;
        }
        // Change of the active set: take in what is violated, or let the most negative multiplier go.
        let before = active.len();
        let rows = program.rows(&x, BAND, Derivatives::None);
        let loads = Loads::new(&active).of(&rows);
        let violated = rows.iter().zip(loads).filter(|(r, mu)| r.gap < -GAP_TOLERANCE && *mu == 0.0);
        let taken_in: Vec<Multiplier> = violated.map(|(row, _)| row.multiplier(1e-300)).collect();
        active.extend(taken_in);
        if active.len() > before {
            taken = Some(figures);
        } else {
            match active.iter().enumerate().min_by(|a, b| a.1.value.total_cmp(&b.1.value)) {
                Some((k, m)) if m.value < 0.0 => drop(active.swap_remove(k)),
                _ => break,
            }
        }
    }
    best.unwrap_or_else(|| {
        let certificate = certify(program, &x, &active);
        (x, certificate)
    })
}

/// Newton's method on the rows `active`, whose multipliers it improves; `x` moves while steps stay small and the budget
/// of steps lasts. Whether it has moved.
fn newton<P: Program>(program: &P, x: &mut P::Point, active: &mut Vec<Multiplier>, budget: &mut usize) -> bool {
    let c = program.objective();
    let mut moved = false;
    let mut last = f64::INFINITY;
    for _ in 0..10 {
        if *budget == 0 {
            break;
        }
        *budget -= 1;
        let loads = Loads::new(active);
        let rows = program.rows(x, BAND, Derivatives::Second(&loads));
        let chosen = matched(&rows, &loads);
        let chosen_rows: Vec<Row> = chosen.iter().map(|(k, _)| rows[*k].clone()).collect();
        let known: Vec<f64> = chosen.iter().map(|(_, mu)| *mu).collect();
        let Some((step, multipliers)) = newton_step(&c, &chosen_rows, &known) else { break };
        let size = step.iter().fold(0.0f64, |a, s| a.max(s.abs()));
        *active = labelled(&chosen_rows, &multipliers);
        if size < 1e-15 || program.largest_step(x, &program.guard(x), &step) < 1.0 {
            break;
        }
        *x = program.moved(x, &step);
        moved = true;
        // After a quadratic step of this size only rounding moves on.
        if size < 1e-13 || size < 1e-9 && size > 0.1 * last {
            break;
        }
        last = size;
    }
    moved
}

/// `x` moved by the smallest step that clears its overlaps, in units of the worst of them, where rounding does not count.
///
/// A ring that rattles often touches at the limit and carries nothing. Its row is not among the active ones, so that
/// Newton's step leaves an overlap there. It goes away as far as the ring can give way; what carries stays nearly.
fn cleared<P: Program>(program: &P, x: &P::Point, active: &[Multiplier]) -> Option<P::Point> {
    const MOST: f64 = 1e3;
    let worst = violation(&program.rows(x, 0.0, Derivatives::None));
    let mut rows = program.rows(x, BAND + 4.0 * worst, Derivatives::First);
    let n = program.objective().len();
    let loads = Loads::new(active).of(&rows);
    let metric = stiff_where_loaded(n, &rows, &loads);
    let most = MOST.min(MOST_STEP / worst);
    rows.retain_mut(|row| {
        row.gap /= worst;
        row.gap < 10.0 * most
    });
    let (step, _, _) = elastic_program(&rows, &metric, &vec![0.0; n], 1e2 * MOST, most);
    let step: Vec<f64> = step.iter().map(|d| d * worst).collect();
    let allowed = program.largest_step(x, &program.guard(x), &step) >= 1.0;
    allowed.then(|| program.moved(x, &step))
}

/// Step and multipliers of Newton's method on c + Σ μ ∇g = 0, g = 0 with the known multipliers in H = −Σ μ ∇²g.
fn newton_step(c: &[f64], rows: &[Row], known: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let h = lagrangian_hessian(c.len(), rows, known, &[]);
    // Motions that hardly matter get huge steps from tiny residuals: hold them as much as it takes.
    HOLDS
        .iter()
        .filter_map(|&hold| kkt_system::solve(&h, rows, c, hold))
        .find(|(step, _)| step.iter().all(|d| d.abs() <= MOST_STEP))
}
