//! Several records in one plot: what they have in common, and what tells them apart.

use super::scale::signed;
use crate::record::{NamedRecord, RunRecord};
use maille::design::Design;
use maille::record::{LimitRow, Status};
use maille::relaxation::target::Protocol;
use maille::survey::{MapQuestion, Method};

/// What a record's question says about it in a caption: `τ = 0.01`. Nothing of the exact method.
pub fn parameter_words(run: &RunRecord) -> Vec<String> {
    let Ok(MapQuestion { method: Method::Energy(options), .. }) = run.question() else { return Vec::new() };
    let protocol = match options.protocol {
        Protocol::Corners => "corner protocol",
        Protocol::Strain => "strain protocol",
    };
    vec![
        protocol.to_owned(),
        format!("α/β = {:.0e}", options.alpha),
        format!("τ = {}", options.tau),
        format!("l₁ to {}", options.l1_resolution),
    ]
}

/// Name and title of a design.
pub(super) fn heading(design: &Design) -> String {
    if design.title.is_empty() { design.name.clone() } else { format!("{} · {}", design.name, design.title) }
}

/// Heading of several records: their designs.
pub(super) fn title(records: &[NamedRecord]) -> String {
    title_of(records.iter().map(|named| &named.record.run.design))
}

/// Heading of several sheets: their designs, each once.
pub(super) fn title_of<'a>(designs: impl Iterator<Item = &'a Design>) -> String {
    let mut all: Vec<&Design> = Vec::new();
    for design in designs {
        if all.iter().all(|known| known.name != design.name) {
            all.push(design);
        }
    }
    let names: Vec<&str> = all.iter().map(|design| design.name.as_str()).collect();
    match (names.as_slice(), all.first()) {
        ([_], Some(first)) => heading(first),
        ([most @ .., last], _) if names.len() <= 6 => format!("{} and {last}", most.join(", ")),
        _ => format!(
            "{} and {} more designs",
            names.iter().take(5).copied().collect::<Vec<_>>().join(", "),
            names.len().saturating_sub(5)
        ),
    }
}

/// Radius, method, cell and parameters of the rows.
pub(super) fn inputs(design: &Design, rows: &[LimitRow], parameters: &[String]) -> String {
    let mut words = radii(design, rows, true);
    words.extend(distinct(rows, |row| &row.method).iter().map(|method| format!("{method} method")));
    words.extend(cells(rows));
    words.extend(parameters.iter().cloned());
    words.join("  ·  ")
}

/// `r = 0.1 mm`, with `(r/R = 0.1)` if asked for.
fn radii(design: &Design, rows: &[LimitRow], relative: bool) -> Vec<String> {
    let mut radii: Vec<f64> = rows.iter().filter_map(|row| row.minor_radius).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup();
    let unit = design.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
    let ratio = |r: f64| {
        if relative { format!(" (r/R = {})", significant(r / design.reference_radius)) } else { String::new() }
    };
    radii.into_iter().map(|r| format!("r = {r}{unit}{}", ratio(r))).collect()
}

fn cells(rows: &[LimitRow]) -> Vec<String> {
    distinct(rows, |row| &row.cell).iter().map(|cell| format!("cell {}", cell.replace('x', " × "))).collect()
}

fn distinct(rows: &[LimitRow], of: fn(&LimitRow) -> &String) -> Vec<&String> {
    let mut all: Vec<_> = rows.iter().map(of).collect();
    all.sort();
    all.dedup();
    all
}

fn significant(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    format!("{rounded}")
}

/// What is different in a record, as `exact` or `3.1, r = 0.05`, and above all of them what it is: `Method`, or
/// `Design, r`.
pub(super) fn differences(records: &[NamedRecord]) -> (String, Vec<String>) {
    let method = |named: &NamedRecord| named.record.run.question().map_or("", |asked| asked.method.name()).to_owned();
    let radius = |named: &NamedRecord| {
        let radii = radii(&named.record.run.design, &named.record.rows, false).join(", ");
        if radii.is_empty() { "r of each ring".to_owned() } else { radii }
    };
    type Part = (&'static str, Vec<String>);
    let column =
        |name: &'static str, of: &dyn Fn(&NamedRecord) -> String| -> Part { (name, records.iter().map(of).collect()) };
    let first = [
        column("design", &|named| named.record.run.design.name.clone()),
        column("r", &radius),
        column("method", &method),
        column("limit", &|named| named.record.rows.iter().find_map(|row| row.end.clone()).unwrap_or("largest".into())),
    ];
    let mut parts: Vec<Part> = first.into_iter().filter(|(_, of)| of.windows(2).any(|w| w[0] != w[1])).collect();
    // The method says already that its parameters are others.
    let words: Vec<_> = records.iter().map(|named| parameter_words(&named.record.run)).collect();
    let own = |i: usize| {
        let same_method = (0..records.len()).filter(|&j| method(&records[j]) == method(&records[i]));
        let others: Vec<usize> = same_method.collect();
        words[i].iter().filter(|word| others.iter().any(|&j| !words[j].contains(word))).cloned().collect::<Vec<_>>()
    };
    let own: Vec<String> = (0..records.len()).map(|i| own(i).join(", ")).collect();
    if own.iter().any(|text| !text.is_empty()) {
        parts.push(("parameters", own));
    }
    // If nothing else tells records apart: their cells, and at last their folders.
    for last in
        [column("cell", &|named| cells(&named.record.rows).join(", ")), ("record", without_common_folder(records))]
    {
        let labels = labels(&parts, records.len());
        if (0..labels.len()).any(|i| labels[..i].contains(&labels[i])) {
            parts.retain(|(name, _)| *name != "cell");
            parts.push(last);
        }
    }
    let heading = parts.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let mut letters = heading.chars();
    let heading = match letters.next() {
        Some('r') if heading == "r" || heading.starts_with("r,") => heading, // a symbol
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => heading,
    };
    let mut labels = labels(&parts, records.len());
    for (label, named) in labels.iter_mut().zip(records) {
        if label.is_empty() {
            label.clone_from(&named.record.run.design.name);
        }
    }
    (heading, labels)
}

/// Names of records without the folders that all of them begin with.
fn without_common_folder(records: &[NamedRecord]) -> Vec<String> {
    let names: Vec<&str> = records.iter().map(|named| named.name.as_str()).collect();
    let common = |end: &usize| names.iter().all(|name| name.get(..*end) == names[0].get(..*end));
    let ends = names.first().into_iter().flat_map(|name| name.match_indices('/').map(|(at, _)| at + 1));
    let start = ends.filter(common).max().unwrap_or(0);
    names.iter().map(|name| name[start..].to_owned()).collect()
}

fn labels(parts: &[(&str, Vec<String>)], count: usize) -> Vec<String> {
    let label = |i: usize| parts.iter().map(|(_, of)| of[i].as_str()).filter(|t| !t.is_empty()).collect::<Vec<_>>();
    (0..count).map(|i| label(i).join(", ")).collect()
}

/// What records have in common in one paragraph, then what each has of its own that its label does not say, then what has
/// no limit and what still grows. Nothing is said twice.
pub(super) fn captions(records: &[NamedRecord], labels: &[String]) -> Vec<String> {
    let words = |named: &NamedRecord| {
        let (run, rows) = (&named.record.run, &named.record.rows);
        let mut words = radii(&run.design, rows, records.len() == 1);
        words.extend(distinct(rows, |row| &row.method).iter().map(|method| format!("{method} method")));
        words.extend(cells(rows));
        words.extend(parameter_words(run));
        words.extend(directions(rows));
        words
    };
    let all: Vec<Vec<String>> = records.iter().map(words).collect();
    let common = |word: &&String| all.iter().all(|words| words.contains(*word));
    let shared: Vec<String> = all.first().into_iter().flatten().filter(common).cloned().collect();
    let own = |(words, label): (&Vec<String>, &String)| {
        let said = |word: &str| label.split(", ").any(|part| part == word || format!("{part} method") == word);
        let own: Vec<&str> =
            words.iter().map(String::as_str).filter(|word| !shared.iter().any(|s| s == word) && !said(word)).collect();
        (!own.is_empty()).then(|| format!("{label}: {}", own.join(", ")))
    };
    let own: Vec<String> = all.iter().zip(labels).filter_map(own).collect();
    let mut out: Vec<String> =
        [shared.join("  ·  "), own.join("  ·  ")].into_iter().filter(|p| !p.is_empty()).collect();
    out.extend(of_each(records, labels, |rows| missing(rows, |row| row.l1)));
    out.extend(of_each(records, labels, growing));
    out
}

/// A sentence `Heading: words.` of each record, as one paragraph with the heading once.
fn of_each(
    records: &[NamedRecord],
    labels: &[String],
    sentence: impl Fn(&[LimitRow]) -> Option<String>,
) -> Option<String> {
    let told = |(named, label): (&NamedRecord, &String)| Some((label.clone(), sentence(&named.record.rows)?));
    let told: Vec<(String, String)> = records.iter().zip(labels).filter_map(told).collect();
    let (_, first) = told.first()?;
    if records.len() == 1 {
        return Some(first.clone());
    }
    let heading = first.split_once(": ").map_or("", |(heading, _)| heading);
    let words = |text: &str| text.split_once(": ").map_or(text, |(_, words)| words).trim_end_matches('.').to_owned();
    let parts: Vec<String> = told.iter().map(|(label, text)| format!("{label}: {}", words(text))).collect();
    Some(format!("{heading}: {}.", parts.join("; ")))
}

/// `13 directions computed, 0° to 180°`.
pub(super) fn directions(rows: &[LimitRow]) -> Option<String> {
    let mut directions: Vec<f64> = rows.iter().map(|row| row.direction_deg).collect();
    directions.sort_by(f64::total_cmp);
    directions.dedup();
    let (first, last) = (directions.first()?, directions.last()?);
    Some(match directions.len() {
        1 => format!("1 direction computed, {first}°"),
        n => format!("{n} directions computed, {first}° to {last}°"),
    })
}

/// How many rows have no value, and why: `Gaps: 3 of 39 searches gave no limit (2 l2-unreachable, 1 not-converged).`
pub(super) fn missing(rows: &[LimitRow], of: impl Fn(&LimitRow) -> Option<f64>) -> Option<String> {
    let without: Vec<_> = rows.iter().filter(|row| of(row).is_none()).collect();
    if without.is_empty() {
        return None;
    }
    let count = |status: Status| without.iter().filter(|row| row.status == status).count();
    let by_status = Status::ALL.into_iter().map(|s| (count(s), s.name())).filter(|(n, _)| *n > 0);
    let parts: Vec<_> = by_status.map(|(n, name)| format!("{n} {name}")).collect();
    let (n, total) = (without.len(), rows.len());
    Some(format!("Gaps: {n} of {total} searches gave no limit ({}).", parts.join(", ")))
}

/// Directions that are named of those that still grow.
const NAMED: usize = 6;

/// Which limits still grow with the cell: `Still grows with the cell, so that larger cells may go further: 75°, 90° at
/// l₂ = −0.2.`
pub(super) fn growing(rows: &[LimitRow]) -> Option<String> {
    let grows = || rows.iter().filter(|row| row.l1.is_some() && row.grows_with_cell == Some(true));
    let of = |l2: f64| {
        let mut at: Vec<f64> = grows().filter(|row| row.l2 == l2).map(|row| row.direction_deg).collect();
        at.sort_by(f64::total_cmp);
        let named: Vec<String> = at.iter().take(NAMED).map(|degrees| format!("{degrees}°")).collect();
        let more = at.len() - named.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{}{more} at l₂ = {}", named.join(", "), l2_label(l2))
    };
    let l2 = l2_values(grows());
    let words: Vec<String> = l2.into_iter().map(of).collect();
    (!words.is_empty())
        .then(|| format!("Still grows with the cell, so that larger cells may go further: {}.", words.join("; ")))
}

/// The l2 of rows, from least to largest, each once.
pub(super) fn l2_values<'a>(rows: impl Iterator<Item = &'a LimitRow>) -> Vec<f64> {
    let mut l2: Vec<f64> = rows.map(|row| row.l2 + 0.0).collect(); // + 0.0 makes −0 equal to 0
    l2.sort_by(f64::total_cmp);
    l2.dedup();
    l2
}

/// An l2 in a legend.
pub(super) fn l2_label(l2: f64) -> String {
    signed(&format!("{l2}"))
}
