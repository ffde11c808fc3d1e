//! Limits against the minor radius of the rings: a curve for each design, direction and l2 of many records.

use super::chart::{Chart, Point, Series};
use super::compare::{growing, heading, l2_label, missing};
use super::frame::{Entry, Frame, Layout, SOFT};
use super::look::{self, Look};
use super::outcome::Outcome;
use super::scale::Axis;
use crate::{numbers::counted, quantity::Quantity, record::NamedRecord};
use maille::{design::Design, record::LimitRow};

/// Rows that differ in the radius alone.
struct Curve<'a> {
    design: &'a Design,
    direction_deg: f64,
    l2: f64,
    method: &'a str,
    /// r/R and the row, in the order of r/R.
    rows: Vec<(f64, &'a LimitRow)>,
}

/// The plot of many records, as SVG; `None` where no two rows differ in the minor radius alone.
pub fn radius_svg(records: &[NamedRecord], quantity: Quantity, layout: Layout) -> Option<String> {
    let curves = curves(records);
    let first = curves.iter().find(|curve| curve.rows.len() > 1)?.design;
    // In the unit of the file where all designs have one scale, else relative to R.
    let scale = |design: &Design| (design.reference_radius, design.unit.clone());
    let alike = curves.iter().all(|curve| scale(curve.design) == scale(first)) && first.unit.is_some();
    let (factor, x_name) = match &first.unit {
        Some(unit) if alike => (first.reference_radius, format!("Minor radius r ({unit})")),
        _ => (1.0, "Minor radius / reference radius, r/R".to_owned()),
    };
    let labels = labels(&curves);
    let looks = look::of_records(curves.len());
    let line = |curve: &Curve<'_>, look: &Look, of: &dyn Fn(&LimitRow) -> Option<f64>| {
        let point = |(ratio, row): &(f64, &LimitRow)| Point {
            x: factor * ratio,
            y: of(row),
            hollow: Outcome::of(row.status) == Outcome::NotProven,
        };
        Series { look: look.clone(), points: curve.rows.iter().map(point).collect() }
    };
    let both = || curves.iter().zip(&looks);
    let series: Vec<Series> = both().map(|(curve, look)| line(curve, look, &|row| quantity.of(row))).collect();
    let bounds: Vec<Series> = both()
        .filter(|(curve, _)| curve.rows.iter().any(|(_, row)| row.bound_gap.is_some_and(|gap| gap > 1e-6)))
        .map(|(curve, look)| {
            let thin = Look { width: 0.9, dash: "", ..look.clone() };
            line(curve, &thin, &|row| quantity.of_bound(row))
        })
        .collect();
    let rows = || curves.iter().flat_map(|curve| curve.rows.iter().map(|(_, row)| *row));
    let mut legend = vec![Entry::Heading(apart(&curves))];
    legend.extend(looks.iter().zip(&labels).map(|(look, label)| Entry::sample(look, true, true, label)));
    let values: Vec<f64> = series.iter().flat_map(|s| &s.points).filter_map(|point| point.y).collect();
    let y = Axis::between(&values);
    if let Some(bound) = bounds.first() {
        let look = Look { color: SOFT.into(), ..bound.look.clone() };
        let cut =
            bounds.iter().flat_map(|s| &s.points).any(|point| point.y.is_some_and(|bound| y.fraction(bound) > 1.0));
        legend.push(Entry::sample(
            &look,
            true,
            false,
            if cut { "proven bound, cut off at the edge" } else { "proven bound" },
        ));
    }
    legend.extend(Outcome::legend(rows().filter(|row| row.l1.is_some()).map(|row| (row.l1, row.status)), true));
    let x: Vec<f64> = series.iter().flat_map(|s| &s.points).map(|point| point.x).collect();
    let all: Vec<LimitRow> = rows().cloned().collect();
    let mut caption = vec![format!("{} of {}.", counted(all.len(), "limit"), counted(records.len(), "record"))];
    caption.extend(missing(&all, |row| quantity.of(row)));
    caption.extend(growing(&all));
    let frame = Frame {
        title: title(&curves),
        subtitle: format!("Limit {} against the minor radius of the rings", quantity.symbol()),
        legend,
        caption,
    };
    let axes = [Axis::between(&x), y];
    let chart = Chart::of_lines(frame, axes, [x_name, format!("Limit {}", quantity.symbol())], series);
    Some(Chart { bare: bounds, gap: "no limit", ..chart }.svg(layout))
}

/// A design without what a radius study varies.
fn without_radius(design: &Design) -> Design {
    Design { minor_radius: None, parameters: Vec::new(), formulas: Default::default(), ..design.clone() }
}

fn curves(records: &[NamedRecord]) -> Vec<Curve<'_>> {
    let mut out: Vec<(Design, Curve<'_>)> = Vec::new();
    for named in records {
        let design = &named.record.run.design;
        let kind = without_radius(design);
        for row in &named.record.rows {
            let Some(radius) = row.minor_radius else { continue };
            let same = |(of, curve): &&mut (Design, Curve<'_>)| {
                *of == kind
                    && (curve.direction_deg, curve.l2, curve.method) == (row.direction_deg, row.l2, row.method.as_str())
            };
            let point = (radius / design.reference_radius, row);
            match out.iter_mut().find(same) {
                Some((_, curve)) => curve.rows.push(point),
                None => {
                    let (direction_deg, l2, method) = (row.direction_deg, row.l2, row.method.as_str());
                    out.push((kind.clone(), Curve { design, direction_deg, l2, method, rows: vec![point] }));
                }
            }
        }
    }
    for (_, curve) in &mut out {
        curve.rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    out.into_iter().map(|(_, curve)| curve).collect()
}

/// What a curve is called by: name, and its word.
type Part = (&'static str, fn(&Curve<'_>) -> String);

const PARTS: [Part; 5] = [
    ("design", |curve| curve.design.name.clone()),
    ("direction", |curve| format!("{}°", curve.direction_deg)),
    ("l₂", |curve| match curve.rows.first().and_then(|(_, row)| row.lateral.as_deref()) {
        Some("free") => "width free".into(),
        _ => format!("l₂ = {}", l2_label(curve.l2)),
    }),
    ("numbers", |curve| varied(curve.design)),
    ("method", |curve| curve.method.to_owned()),
];

/// What a study has varied beside the radius, in words.
fn varied(design: &Design) -> String {
    let words: Vec<String> = design.varied.iter().map(|(name, value)| format!("{name} {value}")).collect();
    if words.is_empty() { "as written".to_owned() } else { words.join(", ") }
}

/// The parts in which curves differ.
fn parts<'a>(curves: &'a [Curve<'_>]) -> impl Iterator<Item = Part> + 'a {
    PARTS.into_iter().filter(|(_, of)| curves.windows(2).any(|pair| of(&pair[0]) != of(&pair[1])))
}

fn labels(curves: &[Curve<'_>]) -> Vec<String> {
    let parts: Vec<Part> = parts(curves).collect();
    let label = |curve: &Curve<'_>| match parts.is_empty() {
        true => PARTS[1].1(curve),
        false => parts.iter().map(|(_, of)| of(curve)).collect::<Vec<_>>().join(", "),
    };
    let mut labels: Vec<String> = curves.iter().map(label).collect();
    // Designs of one name that differ otherwise.
    for k in 0..labels.len() {
        let twice = labels[..k].iter().filter(|label| **label == labels[k]).count();
        if twice > 0 {
            labels[k] = format!("{} ({})", labels[k], twice + 1);
        }
    }
    labels
}

/// Heading of the legend.
fn apart(curves: &[Curve<'_>]) -> String {
    let names: Vec<&str> = parts(curves).map(|(name, _)| name).collect();
    let words = if names.is_empty() { "direction".to_owned() } else { names.join(", ") };
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The designs, and what all curves have in common.
fn title(curves: &[Curve<'_>]) -> String {
    let varies: Vec<&str> = parts(curves).map(|(name, _)| name).collect();
    let mut words = match varies.contains(&"design") {
        true => vec![super::compare::title_of(curves.iter().map(|curve| curve.design))],
        false => curves.first().map(|curve| heading(curve.design)).into_iter().collect(),
    };
    let common = PARTS[1..3].iter().filter(|(name, _)| !varies.contains(name));
    words.extend(curves.first().into_iter().flat_map(|curve| common.clone().map(|(_, of)| of(curve))));
    words.join(", ")
}
