//! The curvature on motions that repeat over the sheet as a wave, which decides whether a larger cell goes further.
//!
//! In the cell s each element moves by Re(u e^{i q·s}), with a wave vector q. The mean over the sheet of −Σ μ ∇²g along it is the
//! half of that along the two real motions of a pair, y = A u + e^{i q·s} B u with its real and its imaginary part, s being the cell of the
//! second ring. Unknowns are Re u and Im u of every element; none is held still. The lattice does not move.

use crate::{
    balance::Closed,
    curvature::{CURVATURE, Curvature, Local, Sum, terms, turns},
    record::Row,
    report::{Check, Finding, Verdict},
    sheet::{Pair, Sheet, Vec3},
};
use std::{collections::BTreeMap, f64::consts::TAU};

/// Elements of a cell whose waves are derived: the matrices are dense.
const MOST_ELEMENTS: usize = 40;
/// Waves that alternate from cell to cell: no record may lack a lower one of these.
const ALTERNATING: [[f64; 2]; 3] = [[0.5, 0.0], [0.0, 0.5], [0.5, 0.5]];
/// Columns of a row.
pub(crate) const COLUMNS: [&str; 3] = ["wave_curvature", "wave_q1", "wave_q2"];

/// The curvature on waves with the vector `q`, in units of 2π.
fn of_wave(sheet: &Sheet, points: &[(Closed<'_>, f64)], q: [f64; 2]) -> Result<Curvature, String> {
    let motions: Vec<Vec<[Vec3; 2]>> = (0..sheet.bodies.len())
        .map(|element| {
            let shifts = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| [axis, Vec3::zeros()]);
            shifts.into_iter().chain(turns(sheet, element).into_iter().map(|axis| [Vec3::zeros(), axis])).collect()
        })
        .collect();
    let mut first = vec![0];
    motions.iter().for_each(|of| first.push(first[first.len() - 1] + of.len()));
    let n = first[motions.len()];
    let columns = |(a, b, shift): Pair, imaginary: bool| {
        let (sin, cos) = (TAU * (q[0] * f64::from(shift[0]) + q[1] * f64::from(shift[1]))).sin_cos();
        let mut out: BTreeMap<usize, Local> = BTreeMap::new();
        // What Re u and Im u give to this part of the motion.
        let [of_a, of_b] = if imaginary { [[0.0, 1.0], [sin, cos]] } else { [[1.0, 0.0], [cos, -sin]] };
        for (ring, at, weights) in [(a, 0, of_a), (b, 6, of_b)] {
            let element = sheet.rings[ring].element;
            for (k, [shift, turn]) in motions[element].iter().enumerate() {
                for (part, weight) in weights.into_iter().enumerate() {
                    let local = out.entry(first[element] + k + part * n).or_insert_with(Local::zeros);
                    for axis in 0..3 {
                        local[at + axis] += weight * shift[axis];
                        local[at + 3 + axis] += weight * turn[axis];
                    }
                }
            }
        }
        out.into_iter().collect::<Vec<_>>()
    };
    let (terms, flat) = terms(sheet, points)?;
    let mut sum = Sum::new(2 * n);
    for term in &terms {
        [false, true].into_iter().for_each(|imaginary| sum.add(term, &columns(term.pair, imaginary)));
    }
    sum.curvature(flat)
}

/// The row's least curvature on waves, derived again; none where the row does not tell it, and need not.
pub(crate) fn finding(row: &Row, sheet: &Sheet, points: &[(Closed<'_>, f64)], told: bool) -> Option<Finding> {
    if !told || row.status != "local" || sheet.bodies.len() > MOST_ELEMENTS {
        return None;
    }
    let say = |verdict, figure, words: String| Some(Finding::new(Check::Waves, verdict, figure, words));
    let written = row.wave_curvature.zip(row.wave_q1).zip(row.wave_q2).map(|((least, q1), q2)| (least, [q1, q2]));
    let mut lowest: Option<(f64, [f64; 2])> = None;
    for q in written.map(|(_, q)| q).into_iter().chain(ALTERNATING) {
        let found = match of_wave(sheet, points, q) {
            Ok(found) => found,
            Err(words) => return say(Verdict::Open, None, words),
        };
        // About the size that counts as zero, an eigenvalue is none in one computation and one in another.
        let unsure = found.flat || found.near_zero();
        let least = found.least();
        if let Some((known, at)) = written.filter(|(_, at)| *at == q) {
            // Of a pair that lies flat the figures depend on how its force is spread, and the signs are compared.
            let apart = |least: f64| match found.flat {
                true => known.signum() != least.signum(),
                false => (known - least).abs() > CURVATURE * least.abs().max(known.abs()),
            };
            if least.is_none_or(apart) && q == at {
                let words = format!("wave_curvature is {known:?} at q = 2π {q:?}, {least:?} in the state");
                return say(if unsure { Verdict::Open } else { Verdict::False }, least, words);
            }
        } else if let (Some(least), false) = (least, unsure)
            && lowest.is_none_or(|(lowest, _)| least < lowest)
        {
            lowest = Some((least, q));
        }
    }
    match (written, lowest) {
        (None, Some((least, q))) => {
            let words = format!("wave_curvature is empty, {least:.3e} at q = 2π {q:?}");
            say(Verdict::False, Some(least), words)
        }
        (None, None) => None,
        (Some((known, _)), Some((least, q))) if least < known - CURVATURE * known.abs().max(least.abs()) => {
            let words = format!("wave_curvature is {known:?}, but the wave with q = 2π {q:?} has {least:.3e}");
            say(Verdict::False, Some(least), words)
        }
        (Some((known, q)), _) => {
            let meaning =
                if known < 0.0 { "a larger cell may go further" } else { "no wave that was tried goes further" };
            say(
                Verdict::Proved,
                Some(known),
                format!("the wave with q = 2π {q:?} has the curvature {known:.3e}: {meaning}"),
            )
        }
    }
}
