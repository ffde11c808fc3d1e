//! The figures of chapter 6, from records.

use crate::{
    map::{Map, extreme, ratio_label, signed},
    plan::{CORNERS, COSTS},
    statements::MAJOR,
};
use maille::{design::Design, model::Model};
use maille_io::{
    Quantity,
    plot::{
        Cost, Layout, OfStep, PolarPlot, Ray, RayKind, cost_svg, difference_svg, parameter_words, polar_svg, run_svg,
    },
    record::NamedRecord,
};
use maille_render::{Extent, RenderError, RenderOptions, Subject, View, render};

/// A figure of the thesis, computed anew.
pub(crate) struct Figure {
    /// Number in the thesis, as `6.4`.
    pub(crate) number: &'static str,
    /// Name of its file.
    pub(crate) file: String,
    /// What it shows.
    pub(crate) title: String,
    /// The picture.
    pub(crate) svg: String,
}

/// A record, and what it is.
type Pair<'a> = (&'a NamedRecord, &'a Map);

/// Designs of each figure of polar plots; of those in two cells, the rectangular one follows after all others.
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

/// All figures but the pictures of the sheets; `maps` are those of `records`, in their order.
pub(crate) fn figures(records: &[NamedRecord], maps: &[Map]) -> Vec<Figure> {
    let pairs: Vec<Pair<'_>> = records.iter().zip(maps).collect();
    let mut out = Vec::new();
    costs(&pairs, &mut out);
    steps_of_runs(&pairs, &mut out);
    for rearranged in [false, true] {
        for (number, designs) in POLAR {
            let in_cell = |map: &Map| if rearranged { map.rearranged } else { map.is_plain() };
            let wanted = |map: &Map| map.method == "exact" && in_cell(map);
            out.extend(of(&pairs, designs, wanted).into_iter().map(|pair| polar(number, pair, &pairs)));
        }
    }
    let mut differences = |number, designs: &[&str], words: &str| {
        let chosen = named(&of(&pairs, designs, |map| map.is_plain() && map.method == "exact"));
        out.extend((!chosen.is_empty()).then(|| Figure {
            number,
            file: format!("{number}-{}", designs.join("-")),
            title: format!("{words}: {}", designs.join(", ")),
            svg: difference_svg(&chosen, Quantity::Lambda1, Layout::Below),
        }));
    };
    RADII.iter().for_each(|designs| differences("6.10", designs, "Largest less smallest limit by minor radius"));
    MAJOR.iter().for_each(|designs| differences("6.11", designs, "Effect of the major radius"));
    for design in CORNERS {
        arrangements(design, &pairs, &mut out);
    }
    out
}

/// Figure 6.12 of one design, r = R/10: the corner distances of the thesis in the sheared and in the rectangular cell at every l₂, and
/// both beside the exact limits at l₂ = 0.
fn arrangements(design: &str, pairs: &[Pair<'_>], out: &mut Vec<Figure>) {
    for (rearranged, cell) in [(false, "sheared"), (true, "rectangular")] {
        for (named, _) in of(pairs, &[design], |map| map.corners && map.rearranged == rearranged) {
            let mut plot = plot(named);
            plot.room_for = lambda1(pairs, |map| map.design == design && map.corners);
            out.push(Figure {
                number: "6.12",
                file: format!("6.12-{design}-corners-{cell}"),
                title: format!("{design}, corner distances in the {cell} cell (energy method, τ = 0.1)"),
                svg: polar_svg(&plot, Layout::Below),
            });
        }
    }
    let exact = |map: &Map| map.method == "exact" && !map.minima && map.is_thick();
    let mut chosen = of(pairs, &[design], exact);
    chosen.extend(of(pairs, &[design], |map| map.corners));
    chosen.retain(|(_, map)| map.rows_at(0.0).next().is_some());
    if chosen.len() > 1 {
        let corners = chosen.iter().any(|(_, map)| map.corners);
        let mut chosen = named(&chosen);
        chosen.iter_mut().for_each(|named| named.record.rows.retain(|row| row.l2 == 0.0));
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

/// Limits of one record in λ1 − 1.
fn plot(named: &NamedRecord) -> PolarPlot {
    let run = &named.record.run;
    PolarPlot::from_rows(&run.design, &named.record.rows, Quantity::Lambda1, &parameter_words(run))
}

/// λ1 − 1 of all limits of some maps.
fn lambda1(pairs: &[Pair<'_>], wanted: impl Fn(&Map) -> bool) -> Vec<f64> {
    let rows = pairs.iter().filter(|(_, map)| wanted(map)).flat_map(|(_, map)| &map.rows);
    rows.filter_map(|row| Some(row.lambda1? - 1.0)).collect()
}

/// The records of `designs`, in that order, the thicker ring first.
fn of<'a>(pairs: &[Pair<'a>], designs: &[&str], wanted: impl Fn(&Map) -> bool) -> Vec<Pair<'a>> {
    let place = |map: &Map| designs.iter().position(|name| *name == map.design);
    let mut out: Vec<_> = pairs.iter().copied().filter(|(_, map)| wanted(map) && place(map).is_some()).collect();
    out.sort_by(|a, b| place(a.1).cmp(&place(b.1)).then(b.1.ratio.total_cmp(&a.1.ratio)));
    out
}

fn named(chosen: &[Pair<'_>]) -> Vec<NamedRecord> {
    chosen.iter().map(|(named, _)| (*named).clone()).collect()
}

/// Limits of one sheet in λ1 − 1, with its directions and, where there is one, the energy method's limits as markers.
fn polar(number: &'static str, (named, map): Pair<'_>, pairs: &[Pair<'_>]) -> Figure {
    let mut plot = plot(named).without_bounds();
    // R/10 and R/20 on one scale.
    plot.room_for = lambda1(pairs, |other| other.alike(map) && other.method == "exact");
    if let Some((check, _)) = pairs.iter().find(|(_, other)| other.checks(map)) {
        plot = plot.checked_by(&check.record.rows, "energy method");
        let words = parameter_words(&check.record.run).join("  ·  ");
        plot.caption.push(format!("Lines: exact method. Markers: energy method, {words}."));
    }
    let ray = |kind: RayKind| move |degrees: f64| Ray { degrees, kind };
    plot.rays.extend(map.interlocking_deg.iter().copied().map(ray(RayKind::Interlocking)));
    let turns = map.l2().into_iter().filter_map(|l2| Some((l2, map.turn(l2)?)));
    if let Some((l2, turn)) = turns.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())) {
        for (kind, sign) in [(RayKind::Least, 1.0), (RayKind::Largest, -1.0)] {
            let all = extreme(&turn, sign, map.tie());
            if 2 * all.len() <= turn.len() {
                plot.rays.extend(all.into_iter().map(ray(kind)));
            }
        }
        plot.caption.push(format!("Largest and least limit are those at l₂ = {}.", signed(l2)));
    }
    let (cell, words) = if map.rearranged { ("-rectangular", ", rectangular cell") } else { ("", "") };
    Figure {
        number,
        file: format!("{number}-{}-R{:.0}{cell}", map.design, 1.0 / map.ratio),
        title: format!("{}, {}{words}", map.design, ratio_label(map.ratio)),
        svg: polar_svg(&plot, Layout::Below),
    }
}

/// Figure 6.1: steps and times of either method, l₂ = ±0.25. Of many sheets the curves of all directions hide each other;
/// the page's table has the means of all.
fn costs(pairs: &[Pair<'_>], out: &mut Vec<Figure>) {
    for method in ["exact", "energy"] {
        let wanted = |map: &Map| {
            map.is_plain() && map.method == method && map.is_thick() && COSTS.contains(&map.design.as_str())
        };
        let mut chosen: Vec<NamedRecord> =
            pairs.iter().filter(|(_, map)| wanted(map)).map(|(named, _)| (*named).clone()).collect();
        for named in &mut chosen {
            named.record.rows.retain(|row| row.l2.abs() == 0.25 && row.l1.is_some());
        }
        chosen.retain(|named| !named.record.rows.is_empty());
        if chosen.is_empty() {
            continue;
        }
        let kinds = [("steps", "Steps of each limit", Cost::Steps), ("times", "Time of each limit", Cost::WallTime)];
        out.extend(kinds.map(|(kind, title, cost)| Figure {
            number: "6.1",
            file: format!("6.1-{kind}-{method}"),
            title: format!("{title}, {method} method, r = R/10"),
            svg: cost_svg(&chosen, cost, Layout::Below),
        }));
    }
}

/// Figure 6.1's line plot: each step of one pull of each design.
fn steps_of_runs(pairs: &[Pair<'_>], out: &mut Vec<Figure>) {
    let kept: Vec<NamedRecord> = pairs.iter().filter(|(_, map)| map.steps).map(|(named, _)| (*named).clone()).collect();
    for (kind, what, shown) in [("times", "Time", OfStep::Time), ("sizes", "Size", OfStep::Size)] {
        out.extend(run_svg(&kept, shown, Layout::Below).map(|svg| Figure {
            number: "6.1",
            file: format!("6.1-{kind}-of-steps"),
            title: format!("{what} of each step of one pull, energy method"),
            svg,
        }));
    }
}

/// A picture of a design's start, as PNG of this size.
pub(crate) fn sheet_png(design: &Design, model: &Model, size: [u32; 2]) -> Result<Vec<u8>, RenderError> {
    let subject = Subject { model, state: &model.start, contacts: &[], unit: design.unit.as_deref() };
    let extent = Extent::filling(size, View::TILTED, design.reference_radius);
    let options = RenderOptions { size, scale_bar: false, ..RenderOptions::new(extent) };
    render(&subject, &options)?.to_png()
}
