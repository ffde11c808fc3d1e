//! Whether the files of a record are whole and fit together.

use crate::{
    record::{Counters, LIMITS, RUN, Row, Run, SENSITIVITIES, STATES, State, Texts},
    report::{Check, Finding, Verdict},
};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};

/// Version of records, which every input hash begins with.
pub(crate) const RECORDS: u64 = 1;

/// Every status that a row can have.
const STATUSES: [&str; 10] = [
    "global",
    "local",
    "threshold-reached",
    "uncertified",
    "l2-unreachable",
    "l2-not-reached",
    "unbounded",
    "not-converged",
    "infeasible-start",
    "interrupted",
];

/// A row's direction and l2, bit for bit.
pub(crate) fn key(direction_deg: f64, l2: f64) -> (u64, u64) {
    (direction_deg.to_bits(), l2.to_bits())
}

/// A finding on files.
pub(crate) fn say(verdict: Verdict, words: impl Into<String>) -> Finding {
    Finding::new(Check::Files, verdict, None, words)
}

/// SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Whether the file `name` is the one whose sum the file `head` has among `sums`.
pub(crate) fn checksum(head: &str, sums: &BTreeMap<String, String>, name: &str, text: &str) -> Finding {
    let found = sha256(text.as_bytes());
    match sums.get(name) {
        Some(sum) if *sum == found => say(Verdict::Proved, format!("{name} has the checksum of {head}")),
        Some(sum) => {
            let words = format!("{name} was edited, cut off or continued: its SHA-256 is {found}, {head} has {sum}");
            say(Verdict::False, words)
        }
        None => say(Verdict::Open, format!("{name} has no checksum in {head}")),
    }
}

/// All findings on the files.
pub(crate) fn check(texts: &Texts<'_>, run: &Run, rows: &[Row], states: &[State]) -> Vec<Finding> {
    let mut out = vec![inputs(texts.run, run)];
    let sums = sums(texts, run);
    // A run that was killed between two files leaves what does not fit together until it goes on.
    let torn = sums.iter().any(|finding| finding.verdict == Verdict::Open);
    out.extend(sums);
    let mut rest = rows_and_states(run, rows, states);
    for finding in rest.iter_mut().filter(|finding| torn && finding.verdict == Verdict::False) {
        finding.verdict = Verdict::Open;
    }
    out.extend(rest);
    out
}

/// Whether the hash of schema, design and parameters as JSON with sorted keys is the one that is written.
fn inputs(text: &str, run: &Run) -> Finding {
    let value: Value = serde_json::from_str(text).unwrap_or_default();
    inputs_of(RUN, run.schema, &value["design"], &value["parameters"], &run.input_hash)
}

/// The same of the file `head`.
pub(crate) fn inputs_of(head: &str, schema: u64, design: &Value, parameters: &Value, written: &str) -> Finding {
    let mut canonical = String::new();
    let all = serde_json::json!({ "schema": schema, "design": design, "parameters": parameters });
    sorted(&all, &mut canonical);
    let found = sha256(canonical.as_bytes());
    if found == written {
        say(Verdict::Proved, format!("design and parameters have the input hash of {head}"))
    } else {
        let words = format!("design or parameters of {head} were edited: their hash is {found}, {written} is written");
        say(Verdict::False, words)
    }
}

/// Whether the hash of a file as JSON with sorted keys, without its `checksum`, is the one that is written there.
pub(crate) fn whole(head: &str, mut value: Value, written: &str) -> Finding {
    if let Some(map) = value.as_object_mut() {
        map.remove("checksum");
    }
    let mut canonical = String::new();
    sorted(&value, &mut canonical);
    let found = sha256(canonical.as_bytes());
    if found == written {
        say(Verdict::Proved, format!("{head} is as it was written"))
    } else {
        say(Verdict::False, format!("{head} was edited: its hash is {found}, {written} is written"))
    }
}

fn sorted(value: &Value, out: &mut String) {
    let mut list = |open: char, close: char, items: Vec<(Option<&String>, &Value)>| {
        out.push(open);
        for (k, (key, value)) in items.into_iter().enumerate() {
            if k > 0 {
                out.push(',');
            }
            if let Some(key) = key {
                out.push_str(&Value::from(key.as_str()).to_string());
                out.push(':');
            }
            sorted(value, out);
        }
        out.push(close);
    };
    match value {
        Value::Object(map) => {
            let by_key: BTreeMap<_, _> = map.iter().collect();
            list('{', '}', by_key.into_iter().map(|(k, v)| (Some(k), v)).collect());
        }
        Value::Array(items) => list('[', ']', items.iter().map(|v| (None, v)).collect()),
        leaf => out.push_str(&leaf.to_string()),
    }
}

fn sums(texts: &Texts<'_>, run: &Run) -> Vec<Finding> {
    let judge = |(name, text): (&str, Option<&str>)| match (run.files.get(name).map(Vec::as_slice), text) {
        (None | Some([]), Some(_)) => {
            say(Verdict::Consistent, format!("{name} has no checksum in {RUN}: an older version of maille wrote it"))
        }
        (_, None) => say(
            Verdict::Open,
            format!("there is no {name}: the run was stopped before it wrote one, or it was deleted"),
        ),
        (Some([now, before @ ..]), Some(text)) => {
            let found = sha256(text.as_bytes());
            if found == *now {
                say(Verdict::Proved, format!("{name} has the checksum of {RUN}"))
            } else if before.contains(&found) {
                let words =
                    format!("{name} is the one before the last: a run was stopped while it wrote; go on with it");
                say(Verdict::Open, words)
            } else {
                let words = format!("{name} was edited or cut off: its SHA-256 is {found}, {RUN} has {now}");
                say(Verdict::False, words)
            }
        }
    };
    // Derivatives are there where they were asked for.
    let asked = texts.sensitivities.is_some() || run.files.contains_key(SENSITIVITIES);
    let derivatives = asked.then_some((SENSITIVITIES, texts.sensitivities));
    [(LIMITS, texts.limits), (STATES, texts.states)].into_iter().chain(derivatives).map(judge).collect()
}

fn rows_and_states(run: &Run, rows: &[Row], states: &[State]) -> Vec<Finding> {
    let mut wrong = Vec::new();
    let mut keys = BTreeSet::new();
    for (k, row) in rows.iter().enumerate() {
        let at = format!("{LIMITS}:{}", k + 2);
        if !keys.insert(key(row.direction_deg, row.l2)) {
            wrong.push(format!("{at}: {}°, l2 = {} a second time", row.direction_deg, row.l2));
        }
        if !STATUSES.contains(&row.status.as_str()) {
            wrong.push(format!("{at}: \"{}\" is not a status", row.status));
        }
        let design = &run.design;
        if row.design != design.name || row.minor_radius != design.minor_radius {
            wrong.push(format!(
                "{at}: design \"{}\" with minor radius {:?} is not the one of {RUN}",
                row.design, row.minor_radius
            ));
        }
        if Some(row.method.as_str()) != run.parameters["method"].as_str() {
            wrong.push(format!("{at}: method \"{}\" is not the one of {RUN}", row.method));
        }
    }
    let mut found = BTreeSet::new();
    for (k, state) in states.iter().enumerate() {
        let at = format!("{STATES}:{}", k + 1);
        let (direction_deg, l2) = (state.direction_deg, state.l2);
        if !found.insert(key(direction_deg, l2)) {
            wrong.push(format!("{at}: {direction_deg}°, l2 = {l2} a second time"));
        }
        match rows.iter().find(|row| key(row.direction_deg, row.l2) == key(direction_deg, l2)) {
            None => wrong.push(format!("{at}: {direction_deg}°, l2 = {l2} has no row")),
            Some(row) if row.status != state.status => {
                wrong
                    .push(format!("{at}: {direction_deg}°, l2 = {l2} is {}, {} in {LIMITS}", state.status, row.status));
            }
            Some(_) => {}
        }
    }
    for row in rows.iter().filter(|row| !found.contains(&key(row.direction_deg, row.l2))) {
        wrong.push(format!("{}°, l2 = {} has no state", row.direction_deg, row.l2));
    }
    let mut counted = Counters::default();
    for row in rows {
        *counted.rows.entry(row.status.clone()).or_default() += 1;
        (counted.iterations, counted.runs) = (counted.iterations + row.iterations, counted.runs + row.runs);
    }
    if counted != run.counters {
        wrong.push(format!("the counters of {RUN} are not those of the rows"));
    }
    let list = |name: &str| run.parameters[name].as_array().cloned().unwrap_or_default();
    let numbers = |name: &str| list(name).iter().filter_map(Value::as_f64).collect::<Vec<f64>>();
    let (directions, l2) = (numbers("directions_deg"), numbers("l2"));
    let asked: BTreeSet<_> = directions.iter().flat_map(|&d| l2.iter().map(move |&l2| key(d, l2))).collect();
    let sought = run.parameters["extremes"].as_bool().unwrap_or(false);
    for row in rows {
        match (asked.contains(&key(row.direction_deg, row.l2)), &row.extreme) {
            (true, None) => continue,
            (true, Some(extreme)) => {
                wrong.push(format!(
                    "{}°, l2 = {} was asked for, and is called the {extreme} between those",
                    row.direction_deg, row.l2
                ));
                continue;
            }
            (false, Some(extreme)) if sought => {
                wrong.extend(not_extreme(row, extreme, rows, &directions, &l2));
                continue;
            }
            _ => {}
        }
        wrong.push(format!("{}°, l2 = {} was not asked for in {RUN}", row.direction_deg, row.l2));
    }
    let count = wrong.len();
    wrong.truncate(5);
    let mut out: Vec<Finding> = wrong.into_iter().map(|words| say(Verdict::False, words)).collect();
    if count > out.len() {
        out.push(say(Verdict::False, format!("{} more of this kind", count - out.len())));
    }
    if out.is_empty() {
        out.push(say(Verdict::Proved, "each row stands once, with its state"));
    }
    let missing = asked.iter().filter(|k| !keys.contains(k)).count();
    if missing > 0 {
        out.push(say(
            Verdict::Open,
            format!("{missing} of {} limits are not in the record: the run was stopped", asked.len()),
        ));
    }
    out
}

/// What is wrong with a row that is called the largest or the smallest l1 of its l2 between the directions that were asked for.
fn not_extreme(row: &Row, extreme: &str, rows: &[Row], directions: &[f64], l2: &[f64]) -> Option<String> {
    let at = format!("{}°, l2 = {}", row.direction_deg, row.l2);
    let range = directions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), deg| (a.min(*deg), b.max(*deg)));
    let between = (range.0..=range.1).contains(&row.direction_deg);
    if !between || !l2.contains(&row.l2) || !["largest", "smallest"].contains(&extreme) {
        return Some(format!("{at} was not asked for in {RUN}"));
    }
    let sign = if extreme == "largest" { 1.0 } else { -1.0 };
    let others = rows.iter().filter(|other| other.l2 == row.l2).filter_map(|other| other.l1);
    let beyond = others.map(|l1| sign * l1).fold(f64::NEG_INFINITY, f64::max);
    let own = row.l1.map_or(f64::NEG_INFINITY, |l1| sign * l1);
    // Images differ by rounding.
    (own < beyond - 1e-12).then(|| format!("{at} is called the {extreme} l1 of its l2, and another row goes beyond it"))
}
