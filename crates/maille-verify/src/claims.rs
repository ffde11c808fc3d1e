//! What a row has by its status and method, and what it cannot have.

use crate::{record::Row, waves::COLUMNS};
use std::collections::BTreeSet;

/// Statuses of the exact method, and of the energy method.
const EXACT: [&str; 7] =
    ["global", "local", "uncertified", "l2-unreachable", "l2-not-reached", "unbounded", "interrupted"];
const ENERGY: [&str; 6] =
    ["threshold-reached", "not-converged", "infeasible-start", "l2-not-reached", "unbounded", "interrupted"];
/// What a limit has.
const OF_LIMIT: [&str; 13] = [
    "l1",
    "lambda1",
    "lambda2",
    "stretch1",
    "stretch2",
    "a1_x",
    "a1_y",
    "a2_x",
    "a2_y",
    "l2_min",
    "l2_max",
    "shear_min",
    "shear_max",
];
/// What a certified limit has besides. The energy method looks at the last three, too.
const OF_CERTIFICATE: [&str; 10] = [
    "dual_residual",
    "complementarity",
    "min_multiplier",
    "zero_modes",
    "n_starts",
    "n_distinct",
    "own_image_force",
    "max_overlap",
    "min_gap",
    "links_ok",
];
/// What a bounded limit has.
const OF_BOUND: [&str; 3] = ["bound_l1", "bound_kind", "bound_gap"];
/// Tolerance of the figures of a certificate.
const CERTIFIED: f64 = 1e-9;

/// What of the row contradicts its status, if something does. `columns` are those of the table: older ones have fewer.
pub(crate) fn contradiction(row: &Row, columns: &BTreeSet<String>) -> Option<String> {
    let (status, method) = (row.status.as_str(), row.method.as_str());
    let known: &[&str] = if method == "exact" { &EXACT } else { &ENERGY };
    if !known.contains(&status) {
        return Some(format!("the {method} method has no status {status}"));
    }
    let is_limit = row.certified() || status == "threshold-reached";
    let lacking =
        |names: &[&'static str]| names.iter().find(|name| !row.has(name) && columns.contains(**name)).copied();
    let unearned = |names: &[&'static str]| names.iter().find(|name| row.has(name)).copied();
    let has_no = |name: &str| Some(format!("a row that is {status} has no {name}"));
    let has = |name: &str| Some(format!("a row that is {status} has {name}"));
    if is_limit && let Some(name) = lacking(&OF_LIMIT) {
        return has_no(name);
    }
    if !is_limit && let Some(name) = unearned(&OF_LIMIT) {
        return has(name);
    }
    if row.certified() {
        if let Some(name) = lacking(&OF_CERTIFICATE) {
            return has_no(name);
        }
        if let Some(words) = out_of_tolerance(row) {
            return Some(words);
        }
        let bounded = OF_BOUND.map(|name| row.has(name));
        if bounded != [true; 3] && (status == "global" || bounded != [false; 3]) {
            return lacking(&OF_BOUND).and_then(has_no);
        }
    }
    if method != "exact" {
        // Links and gaps are looked at by both methods.
        let of_exact = &OF_CERTIFICATE[..7];
        if let Some(name) = unearned(of_exact).or_else(|| unearned(&OF_BOUND)) {
            return Some(format!("a row of the {method} method has {name}"));
        }
    }
    let wave = COLUMNS.map(|name| row.has(name));
    if wave != [false; 3] && (wave != [true; 3] || status != "local" || method != "exact") {
        return Some(format!(
            "a row that is {status} has {} of {}",
            wave.iter().filter(|has| **has).count(),
            COLUMNS.join(", ")
        ));
    }
    if row.l1_uncertified.is_some() && status != "uncertified" {
        return has("l1_uncertified");
    }
    if row.end.as_deref() == Some("least") && (status == "global" || unearned(&OF_BOUND).is_some()) {
        return Some("a least l1 has no bound, and is never global".into());
    }
    if let (Some(overlap), Some(gap)) = (row.max_overlap, row.min_gap)
        && overlap != (-gap).max(0.0)
    {
        return Some(format!("max_overlap is {overlap:?} where min_gap is {gap:?}"));
    }
    None
}

/// What of a certified row's own figures is none of a certificate.
fn out_of_tolerance(row: &Row) -> Option<String> {
    let figure =
        |name: &str, value: Option<f64>| Some(format!("{name} of a certified row is {:?}", value.unwrap_or(f64::NAN)));
    let small = [
        ("dual_residual", row.dual_residual, 1.0),
        ("complementarity", row.complementarity, 1.0),
        ("min_multiplier", row.min_multiplier, -1.0),
    ];
    if let Some((name, value, _)) = small.into_iter().find(|(_, x, sign)| x.is_some_and(|x| sign * x > CERTIFIED)) {
        return figure(name, value);
    }
    if row.min_curvature.is_some_and(|c| c <= 0.0) {
        return figure("min_curvature", row.min_curvature);
    }
    if row.links_ok == Some(false) {
        return Some("links_ok of a certified row is false".into());
    }
    match (row.n_starts, row.n_distinct) {
        (Some(starts), Some(distinct)) if distinct == 0 || distinct > starts => {
            Some(format!("n_distinct is {distinct} of {starts} starts"))
        }
        _ => None,
    }
}
