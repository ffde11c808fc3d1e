//! The forces of a locked state: their balance, and the curvature with them, compared with the row.

use crate::{
    balance::{Balance, COMPLEMENTARITY, Free, RESIDUAL, balance, points},
    curvature::{CURVATURE, Curvature, ZERO_MODE, curvature},
    record::{Row, State},
    report::{Check, Finding, Verdict},
    sheet::{Sheet, Vec3},
    start::Start,
    strain, waves,
};
use nalgebra::Vector2;
use std::collections::BTreeSet;

/// A curvature below this share of the largest, with a minus, is no rounding.
const SADDLE: f64 = 1e-6;

/// The forces of the state, and the curvature with them; `unit` is that of the state's lengths, `columns` are those of the table.
pub(crate) fn forces(
    row: &Row,
    state: &State,
    here: &Sheet,
    start: &Start,
    unit: f64,
    columns: &BTreeSet<String>,
) -> Vec<Finding> {
    let (d, side) = strain::axes(row.direction_deg);
    let rate = |to: &Vector2<f64>, of: &Vector2<f64>| {
        start.sheet.lattice.map(|a| {
            let v = to * of.dot(&a.xy());
            Vec3::new(v.x, v.y, 0.0)
        })
    };
    let free = |word: &Option<String>| word.as_deref() == Some("free");
    let sign = if row.end.as_deref() == Some("least") { -1.0 } else { 1.0 };
    let mut rates = vec![rate(&(d * sign), &d)];
    rates.extend(free(&row.lateral).then(|| rate(&side, &side)));
    rates.extend(free(&row.shear).then(|| rate(&d, &side)));
    let free = Free(rates);
    let points = match points(here, &state.contacts, unit) {
        Ok(points) => points,
        Err(words) => return vec![Finding::new(Check::Balance, Verdict::False, None, words)],
    };
    let balance = balance_finding(row, &balance(here, &points, &free));
    let anchors = start.sheet.carried();
    let judged = |still: usize| match curvature(here, &points, &free.0, anchors.clone(), still) {
        Ok(found) => curvature_finding(row, &found, free.0.len() > 1),
        Err(words) => Finding::new(Check::Curvature, Verdict::Open, None, words),
    };
    // The figure depends on which element's translation is no unknown. In an image of another direction it need not be the first.
    let first = judged(0);
    let proved = |finding: &Finding| finding.verdict == Verdict::Proved;
    let curvature = match proved(&first) {
        true => first,
        false => (1..here.bodies.len()).map(judged).find(proved).unwrap_or(first),
    };
    let told = columns.contains(waves::COLUMNS[0]);
    [balance, curvature].into_iter().chain(waves::finding(row, here, &points, told)).collect()
}

fn balance_finding(row: &Row, found: &Balance) -> Finding {
    let wrong = |figure: f64, words: String| Finding::new(Check::Balance, Verdict::False, Some(figure), words);
    if found.least_force < 0.0 {
        return wrong(found.least_force, format!("a contact pulls: its force is {:.3e}", found.least_force));
    }
    if found.complementarity.is_nan() || found.complementarity > COMPLEMENTARITY {
        let words = format!("a contact that carries is not closed: force times gap is {:.3e}", found.complementarity);
        return wrong(found.complementarity, words);
    }
    let residual = found.residual.max(found.slope);
    if residual.is_nan() || residual > RESIDUAL {
        return wrong(residual, format!("the recorded forces do not balance the pull: {residual:.3e} is left"));
    }
    // Contacts that carry next to nothing are not in the state: the least can be below all that are.
    if let Some(least) = row.min_multiplier.filter(|least| *least > found.least_force + RESIDUAL) {
        let words = format!("min_multiplier is {least:?}, a force of the state {:?}", found.least_force);
        return wrong(found.least_force, words);
    }
    if row.own_image_force.is_some_and(|written| (written - found.own_image).abs() > RESIDUAL) {
        let words = format!("own_image_force is {:?}, {:?} in the state", row.own_image_force, found.own_image);
        return wrong(found.own_image, words);
    }
    let words = format!("the recorded forces push, on closed contacts, and balance the pull to {residual:.1e}");
    Finding::new(Check::Balance, Verdict::Proved, Some(residual), words)
}

/// The curvature of a certified row. Its figures depend on the unknowns; where something is free, or a pair lies flat, they are not compared.
fn curvature_finding(row: &Row, found: &Curvature, is_free: bool) -> Finding {
    let say = |verdict, figure, words: String| Finding::new(Check::Curvature, verdict, figure, words);
    let (scale, least) = (found.scale(), found.least());
    match found.values.first() {
        Some(&lowest) if lowest < -SADDLE * scale => {
            let words = format!("a motion that keeps the loaded contacts has the curvature {lowest:.3e}: it raises l1");
            return say(Verdict::False, Some(lowest), words);
        }
        Some(&lowest) if lowest < -ZERO_MODE * scale => {
            let words = format!("the least curvature, {lowest:.3e}, is too near to 0");
            return say(Verdict::Open, Some(lowest), words);
        }
        _ => {}
    }
    if !(found.flat || is_free) {
        let apart = match (row.min_curvature, least) {
            (Some(written), Some(found)) => (written - found).abs() > CURVATURE * found.abs().max(written.abs()),
            (None, None) => false,
            _ => true,
        };
        let modes = found.zero_modes();
        if apart || row.zero_modes != Some(modes) {
            let words = format!(
                "min_curvature is {:?} with {:?} zero modes, {least:?} with {modes} in the state",
                row.min_curvature, row.zero_modes
            );
            // An eigenvalue about the size that counts as zero is none in one computation and one in another.
            let verdict = if found.near_zero() { Verdict::Open } else { Verdict::False };
            return say(verdict, least, words);
        }
    }
    let words = match least {
        Some(least) => format!("no motion raises l1, to second order: the least curvature is {least:.3e}"),
        None => "no motion that keeps the loaded contacts has a curvature".into(),
    };
    say(Verdict::Proved, least, words)
}
