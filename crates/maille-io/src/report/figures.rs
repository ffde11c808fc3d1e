//! The figures of chapter 6, from records.

use super::map::{Map, extreme, imposed_on_corners, ratio_label, signed};
use crate::{
    plot::{
        Layout, OfStep, PolarPlot, Quantity, Ray, RayKind, Spread, difference_svg, parameter_words, polar_svg, run_svg,
        steps_svg, times_svg,
    },
    record::NamedRecord,
    render::{Extent, RenderError, RenderOptions, Subject, View, render},
};
use maille::{design::Design, error::InvalidInput, lattice::Cell, model::Model};

/// A figure of the thesis, computed anew.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Number in the thesis, as `6.4`.
    pub number: &'static str,
    /// Name of its file.
    pub file: String,
    /// What it shows.
    pub title: String,
    /// The picture.
    pub svg: String,
}

/// Designs of each figure of polar plots.
const POLAR: [(&str, &[&str]); 5] = [
    ("6.4", &["1.1", "1.2", "1.3"]),
    ("6.5", &["3.1", "3.2"]),
    ("6.6", &["3.3", "3.4"]),
    ("6.7", &["4.1", "4.2", "4.3"]),
    ("6.8", &["2", "5.1", "5.2"]),
];

/// Designs that are compared in one plot of differences.
const RADII: [&[&str]; 5] =
    [&["1.1", "1.2", "1.3"], &["3.1", "3.2", "3.3", "3.4"], &["4.1", "4.2", "4.3"], &["2"], &["5.1", "5.2"]];
const MAJOR: [&[&str]; 2] = [&["1.1", "1.2"], &["3.1", "3.2"]];

/// All figures but the pictures of the sheets; `maps` are those of `records`, in their order.
pub fn figures(records: &[NamedRecord], maps: &[Map]) -> Vec<Figure> {
    let pairs: Vec<(&NamedRecord, &Map)> = records.iter().zip(maps).collect();
    let mut out = Vec::new();
    costs(&pairs, &mut out);
    steps_of_runs(&pairs, &mut out);
    for (number, designs) in POLAR {
        for &(named, map) in of(&pairs, designs, |map| map.is_plain() && map.method == "exact").iter() {
            out.push(polar(number, named, map, &pairs));
        }
    }
    for (number, designs) in [("6.5", ["3.1", "3.2"]), ("6.6", ["3.3", "3.4"])] {
        for &(named, map) in of(&pairs, &designs, |map| map.rearranged && map.method == "exact").iter() {
            out.push(polar(number, named, map, &pairs));
        }
    }
    let mut differences = |number, groups: &[&[&str]], words: &str| {
        for designs in groups {
            let chosen = named(&of(&pairs, designs, |map| map.is_plain() && map.method == "exact"));
            if !chosen.is_empty() {
                out.push(Figure {
                    number,
                    file: format!("{number}-{}", designs.join("-")),
                    title: format!("{words}: {}", designs.join(", ")),
                    svg: difference_svg(&chosen, Spread::Lambda1, Layout::Below),
                });
            }
        }
    };
    differences("6.10", &RADII, "Largest less smallest limit by minor radius");
    differences("6.11", &MAJOR, "Effect of the major radius");
    for design in ["3.1", "3.2", "3.3"] {
        arrangements(design, &pairs, &mut out);
    }
    out
}

/// Figure 6.12 of one design, r = R/10: the corner distances of the thesis in the sheared and in the rectangular cell at every l₂, and
/// both beside the exact limits at l₂ = 0.
fn arrangements(design: &str, pairs: &[(&NamedRecord, &Map)], out: &mut Vec<Figure>) {
    for (rearranged, cell) in [(false, "sheared"), (true, "rectangular")] {
        for named in named(&of(pairs, &[design], |map| map.corners && map.rearranged == rearranged)) {
            let (run, rows) = (&named.record.run, &named.record.rows);
            let words = parameter_words(run);
            let mut plot = PolarPlot::from_rows(&run.design, rows, Quantity::Lambda1, &words);
            plot.room_for = lambda1(pairs, |map| map.design == design && map.corners);
            out.push(Figure {
                number: "6.12",
                file: format!("6.12-{design}-corners-{cell}"),
                title: format!("{design}, corner distances in the {cell} cell (energy method, τ = 0.1)"),
                svg: polar_svg(&plot, Layout::Below),
            });
        }
    }
    let plain = |map: &Map| map.method == "exact" && !map.minima && (map.ratio - 0.1).abs() < 1e-9;
    let mut chosen = named(&of(pairs, &[design], plain));
    chosen.extend(named(&of(pairs, &[design], |map| map.corners)));
    for named in &mut chosen {
        named.record.rows.retain(|row| row.l2 == 0.0);
    }
    chosen.retain(|named| !named.record.rows.is_empty());
    if chosen.len() > 1 {
        let corners =
            chosen.iter().any(|named| named.record.run.question().is_ok_and(|asked| imposed_on_corners(&asked)));
        out.push(Figure {
            number: "6.12",
            file: format!("6.12-{design}"),
            title: format!(
                "{design}, sheared and rectangular arrangement at l₂ = 0{}",
                if corners { ", exact and with the corners of the cell (energy method, τ = 0.1)" } else { "" }
            ),
            svg: polar_svg(&PolarPlot::from_records(&chosen, Quantity::Lambda1), Layout::Below),
        });
    }
}

/// λ1 − 1 of all limits of some maps.
fn lambda1(pairs: &[(&NamedRecord, &Map)], wanted: impl Fn(&Map) -> bool) -> Vec<f64> {
    let rows = pairs.iter().filter(|(_, map)| wanted(map)).flat_map(|(_, map)| &map.rows);
    rows.filter_map(|row| Some(row.lambda1? - 1.0)).collect()
}

/// The records of `designs`, in that order, the thicker ring first.
fn of<'a>(
    pairs: &[(&'a NamedRecord, &'a Map)],
    designs: &[&str],
    wanted: impl Fn(&Map) -> bool,
) -> Vec<(&'a NamedRecord, &'a Map)> {
    let mut out: Vec<_> = pairs.iter().copied().filter(|(_, map)| wanted(map)).collect();
    out.retain(|(_, map)| designs.contains(&map.design.as_str()));
    let place = |map: &Map| designs.iter().position(|name| *name == map.design);
    out.sort_by(|a, b| place(a.1).cmp(&place(b.1)).then(b.1.ratio.total_cmp(&a.1.ratio)));
    out
}

fn named(chosen: &[(&NamedRecord, &Map)]) -> Vec<NamedRecord> {
    chosen.iter().map(|(named, _)| (*named).clone()).collect()
}

/// Limits of one sheet in λ1 − 1, with its directions and, where there is one, the energy method's limits as markers.
fn polar(number: &'static str, named: &NamedRecord, map: &Map, pairs: &[(&NamedRecord, &Map)]) -> Figure {
    let (run, rows) = (&named.record.run, &named.record.rows);
    let words = parameter_words(run);
    let mut plot = PolarPlot::from_rows(&run.design, rows, Quantity::Lambda1, &words).without_bounds();
    // R/10 and R/20 on one scale.
    plot.room_for = lambda1(pairs, |other| {
        (&other.design, other.rearranged) == (&map.design, map.rearranged) && !other.corners && other.method == "exact"
    });
    let checks = |other: &&(&NamedRecord, &Map)| {
        let b = other.1;
        (&b.design, b.ratio, b.rearranged) == (&map.design, map.ratio, map.rearranged)
            && b.method == "energy"
            && !b.corners
    };
    if let Some((check, _)) = pairs.iter().find(checks) {
        plot = plot.checked_by(&check.record.rows, "energy method");
        let words = parameter_words(&check.record.run).join("  ·  ");
        plot.caption.push(format!("Lines: exact method. Markers: energy method, {words}."));
    }
    let ray = |kind: RayKind| move |degrees: f64| Ray { degrees, kind };
    plot.rays.extend(map.interlocking_deg.iter().copied().map(ray(RayKind::Interlocking)));
    let l2 = map.l2().into_iter().filter(|l2| map.turn(*l2).is_some()).min_by(|a, b| a.abs().total_cmp(&b.abs()));
    if let Some((l2, turn)) = l2.and_then(|l2| Some((l2, map.turn(l2)?))) {
        for (kind, sign) in [(RayKind::Least, 1.0), (RayKind::Largest, -1.0)] {
            let all = extreme(&turn, sign, map.tie());
            if 2 * all.len() <= turn.len() {
                plot.rays.extend(all.into_iter().map(ray(kind)));
            }
        }
        plot.caption.push(format!("Largest and least limit are those at l₂ = {}.", signed(l2)));
    }
    let cell = if map.rearranged { "-rectangular" } else { "" };
    let words = if map.rearranged { ", rectangular cell" } else { "" };
    Figure {
        number,
        file: format!("{number}-{}-R{:.0}{cell}", map.design, 1.0 / map.ratio),
        title: format!("{}, {}{words}", map.design, ratio_label(map.ratio)),
        svg: polar_svg(&plot, Layout::Below),
    }
}

/// Draws a figure of several records.
type Draw = fn(&[NamedRecord], Layout) -> String;

/// Figure 6.1: steps and times of the thesis's own method where there is one, l₂ = ±0.25.
fn costs(pairs: &[(&NamedRecord, &Map)], out: &mut Vec<Figure>) {
    for method in ["exact", "energy"] {
        let wanted = |map: &Map| map.is_plain() && map.method == method && (map.ratio - 0.1).abs() < 1e-9;
        let mut chosen: Vec<NamedRecord> =
            pairs.iter().filter(|(_, map)| wanted(map)).map(|(named, _)| (*named).clone()).collect();
        for named in &mut chosen {
            named.record.rows.retain(|row| row.l2.abs() == 0.25 && row.l1.is_some());
        }
        chosen.retain(|named| !named.record.rows.is_empty());
        // Of many sheets the curves of all directions hide each other; the table has the means of all.
        chosen.retain(|named| ["1.1", "2", "3.1", "5.2"].contains(&named.record.run.design.name.as_str()));
        if chosen.is_empty() {
            continue;
        }
        let kinds: [(&str, &str, Draw); 2] =
            [("steps", "Steps of each limit", steps_svg), ("times", "Time of each limit", times_svg)];
        for (kind, title, draw) in kinds {
            out.push(Figure {
                number: "6.1",
                file: format!("6.1-{kind}-{method}"),
                title: format!("{title}, {method} method, r = R/10"),
                svg: draw(&chosen, Layout::Below),
            });
        }
    }
}

/// Figure 6.1's line plot: each step of one pull of each design.
fn steps_of_runs(pairs: &[(&NamedRecord, &Map)], out: &mut Vec<Figure>) {
    let kept: Vec<NamedRecord> = pairs.iter().filter(|(_, map)| map.steps).map(|(named, _)| (*named).clone()).collect();
    let kinds = [
        ("times", "Time of each step of one pull, energy method", OfStep::Time),
        ("sizes", "Size of each step of one pull, energy method", OfStep::Size),
    ];
    for (kind, title, shown) in kinds {
        out.extend(run_svg(&kept, shown, Layout::Below).map(|svg| Figure {
            number: "6.1",
            file: format!("6.1-{kind}-of-steps"),
            title: title.into(),
            svg,
        }));
    }
}

/// What keeps a sheet's picture from being drawn.
#[derive(Debug, thiserror::Error)]
pub enum SheetError {
    /// The design cannot be compiled.
    #[error("{}", .0.iter().map(|p| format!("{}: {}", p.field, p.problem)).collect::<Vec<_>>().join("; "))]
    Design(Vec<InvalidInput>),
    /// The picture cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A picture of a design's start, as PNG of this size.
pub fn sheet_png(design: &Design, size: [u32; 2]) -> Result<Vec<u8>, SheetError> {
    let model = Model::compile(design, Cell::PRIMITIVE).map_err(SheetError::Design)?;
    let subject = Subject { model: &model, state: &model.start, contacts: &[], unit: design.unit.as_deref() };
    let view = View::TILTED;
    let extent = Extent::filling(size, view, design.reference_radius);
    let options = RenderOptions { size, scale_bar: false, ..RenderOptions::new(extent) };
    Ok(render(&subject, &options)?.to_png()?)
}
