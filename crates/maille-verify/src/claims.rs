//! What a row has by its status and method, and what it cannot have.

use crate::record::Row;
use std::collections::BTreeSet;

/// Statuses of the exact method, and of the energy method.
const EXACT: [&str; 7] =
    ["global", "local", "uncertified", "l2-unreachable", "l2-not-reached", "unbounded", "interrupted"];
const ENERGY: [&str; 6] =
    ["threshold-reached", "not-converged", "infeasible-start", "l2-not-reached", "unbounded", "interrupted"];
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
    let of_limit = [
        ("l1", row.l1.is_some()),
        ("lambda1", row.lambda1.is_some()),
        ("lambda2", row.lambda2.is_some()),
        ("stretch1", row.stretch1.is_some()),
        ("stretch2", row.stretch2.is_some()),
        ("a1_x", row.a1_x.is_some()),
        ("a1_y", row.a1_y.is_some()),
        ("a2_x", row.a2_x.is_some()),
        ("a2_y", row.a2_y.is_some()),
        ("l2_min", row.l2_min.is_some()),
        ("l2_max", row.l2_max.is_some()),
        ("shear_min", row.shear_min.is_some()),
        ("shear_max", row.shear_max.is_some()),
    ];
    let of_certificate = [
        ("dual_residual", row.dual_residual.is_some()),
        ("complementarity", row.complementarity.is_some()),
        ("min_multiplier", row.min_multiplier.is_some()),
        ("zero_modes", row.zero_modes.is_some()),
        ("n_starts", row.n_starts.is_some()),
        ("n_distinct", row.n_distinct.is_some()),
        ("own_image_force", row.own_image_force.is_some()),
        ("max_overlap", row.max_overlap.is_some()),
        ("min_gap", row.min_gap.is_some()),
        ("links_ok", row.links_ok.is_some()),
    ];
    let of_bound = [
        ("bound_l1", row.bound_l1.is_some()),
        ("bound_kind", row.bound_kind.is_some()),
        ("bound_gap", row.bound_gap.is_some()),
    ];
    let lacking = |names: &[(&'static str, bool)]| {
        names.iter().find(|(name, there)| !there && columns.contains(*name)).map(|(name, _)| *name)
    };
    let unearned = |names: &[(&'static str, bool)]| names.iter().find(|(_, there)| *there).map(|(name, _)| *name);
    let has_no = |name: &str| Some(format!("a row that is {status} has no {name}"));
    let has = |name: &str| Some(format!("a row that is {status} has {name}"));
    if is_limit && let Some(name) = lacking(&of_limit) {
        return has_no(name);
    }
    if !is_limit && let Some(name) = unearned(&of_limit) {
        return has(name);
    }
    if row.certified() {
        if let Some(name) = lacking(&of_certificate) {
            return has_no(name);
        }
        if let Some(words) = out_of_tolerance(row) {
            return Some(words);
        }
        let bounded = of_bound.map(|(_, there)| there);
        if bounded != [true; 3] && (status == "global" || bounded != [false; 3]) {
            return lacking(&of_bound).and_then(has_no);
        }
    }
    if method != "exact" {
        // Links and gaps are looked at by both methods.
        let of_exact = &of_certificate[..7];
        if let Some(name) = unearned(of_exact).or_else(|| unearned(&of_bound)) {
            return Some(format!("a row of the {method} method has {name}"));
        }
    }
    if row.l1_uncertified.is_some() && status != "uncertified" {
        return has("l1_uncertified");
    }
    if row.end.as_deref() == Some("least") && (status == "global" || unearned(&of_bound).is_some()) {
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
    let above = |x: Option<f64>, most: f64| x.is_some_and(|x| x > most);
    let figure =
        |name: &str, value: Option<f64>| Some(format!("{name} of a certified row is {:?}", value.unwrap_or(f64::NAN)));
    if above(row.dual_residual, CERTIFIED) {
        return figure("dual_residual", row.dual_residual);
    }
    if above(row.complementarity, CERTIFIED) {
        return figure("complementarity", row.complementarity);
    }
    if above(row.min_multiplier.map(|m| -m), CERTIFIED) {
        return figure("min_multiplier", row.min_multiplier);
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
