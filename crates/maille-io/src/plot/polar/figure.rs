//! How a polar plot is drawn.

use super::{PolarPlot, Ray, RayKind};
use crate::plot::{
    canvas::{Anchor, Canvas, Stroke, text_width},
    clip,
    compare::l2_label,
    curve::{Curve, CurveKind},
    frame::{Area, Entry, Frame, GRID, INK, Layout, RIM, SOFT, style},
    look::{self, Look, MARKER},
    outcome::Outcome,
    records::Looks,
    scale::Scale,
    tolerance::Band,
};
use crate::record::Reference;

/// The plot as SVG.
pub fn polar_svg(input: &PolarPlot, layout: Layout) -> String {
    let values = input.curves.iter().filter(|curve| curve.kind != CurveKind::Bound).flat_map(Curve::values);
    let scale = Scale::new(input.quantity.base(), values.chain(input.room_for.iter().copied()), 6);
    let of_all = input.looks();
    let looks: Vec<Look> = input.curves.iter().map(|curve| input.look(&of_all, curve)).collect();
    let frame = Frame {
        title: input.title.clone(),
        subtitle: input.subtitle(),
        legend: legend(input, &of_all, &looks, &scale),
        caption: input.caption.clone(),
    };
    // The widest line is furthest behind, of one width the largest l2.
    let mut back_to_front: Vec<_> = input.curves.iter().zip(&looks).collect();
    back_to_front.sort_by(|a, b| (a.0.record.cmp(&b.0.record)).then(b.0.l2.abs().total_cmp(&a.0.l2.abs())));
    let disc = Disc::new(frame.area(layout), scale);
    frame.svg(layout, disc.center[1] + disc.radius + 22.0, |canvas| {
        let own = |band: &Band| {
            let curve = back_to_front.iter().find(|(c, _)| c.l2 == band.l2 && c.kind == CurveKind::Limits);
            curve.map_or(SOFT, |(_, look)| look.color.as_str())
        };
        input.bands.iter().for_each(|band| disc.draw_band(canvas, band, own(band)));
        // Above all of them: bands hide each other, their edges do not.
        input.bands.iter().for_each(|band| disc.draw_edges(canvas, band, own(band)));
        disc.draw_grid(canvas, input.quantity.base());
        disc.draw_rays(canvas, &input.rays);
        for (curve, look) in back_to_front.iter().filter(|(curve, _)| curve.kind != CurveKind::Check) {
            disc.draw_line(canvas, curve, look);
        }
        disc.draw_ticks(canvas, &input.curves);
        let marked = if input.check.is_empty() { CurveKind::Limits } else { CurveKind::Check };
        let marked = back_to_front.iter().filter(|(curve, _)| curve.kind == marked);
        for (k, (curve, look)) in marked.enumerate() {
            disc.draw_markers(canvas, curve, look, input.records.1.len());
            disc.draw_gaps(canvas, curve, look, k);
        }
    })
}

/// Where values stand: on a disc, by direction and by distance from its centre.
pub(super) struct Disc {
    pub(super) center: [f64; 2],
    pub(super) radius: f64,
    scale: Scale,
}

impl Disc {
    pub(super) fn new(area: Area, scale: Scale) -> Self {
        let radius = 0.5 * (area.right - area.left - 96.0);
        Disc { center: [area.left + 40.0 + radius, area.top + radius], radius, scale }
    }

    /// The point at a distance from the centre.
    fn polar(&self, degrees: f64, distance: f64) -> [f64; 2] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [self.center[0] + distance * cos, self.center[1] - distance * sin]
    }

    /// The point of a value.
    fn at(&self, degrees: f64, value: f64) -> [f64; 2] {
        self.polar(degrees, self.radius * self.scale.fraction(value))
    }

    pub(super) fn draw_grid(&self, canvas: &mut Canvas, base: f64) {
        for k in 0..12 {
            let degrees = 30.0 * f64::from(k);
            canvas.line(self.polar(degrees, 0.0), self.polar(degrees, self.radius), Stroke::solid(GRID, 1.0));
            let label = format!("{degrees}°");
            let [x, y] = self.polar(degrees, self.radius + 16.0);
            let half_width = 3.4 * label.chars().count() as f64;
            canvas.text(
                [x + half_width * degrees.to_radians().cos() + 2.0, y + 5.0],
                style(14.0, INK, Anchor::Middle),
                &label,
            );
        }
        for &tick in &self.scale.ticks {
            let stroke = if tick == self.scale.high {
                Stroke::solid(RIM, 1.2)
            } else if tick == base {
                Stroke { color: SOFT, width: 1.2, dash: "1 3" }
            } else {
                Stroke::solid(GRID, 1.0)
            };
            canvas.circle(self.center, self.radius * self.scale.fraction(tick), "none", stroke);
        }
    }

    /// Along each direction and its opposite.
    fn draw_rays(&self, canvas: &mut Canvas, rays: &[Ray]) {
        for ray in rays {
            let look = ray.kind.look();
            let from = if ray.kind == RayKind::Least { 0.95 * self.radius } else { 0.0 };
            for degrees in [ray.degrees, ray.degrees + 180.0] {
                canvas.line(self.polar(degrees, from), self.polar(degrees, self.radius), look.stroke());
            }
        }
    }

    /// Labels of the circles along one direction, where curves strike fewest of them; one that is struck stands in another
    /// direction, and is left out if all are.
    pub(super) fn draw_ticks(&self, canvas: &mut Canvas, curves: &[Curve]) {
        const RAYS: [f64; 12] = [22.5, 37.5, 52.5, 67.5, 7.5, 82.5, 97.5, 112.5, 127.5, 142.5, 157.5, 172.5];
        let places: Vec<[f64; 2]> = curves.iter().flat_map(|curve| self.line_points(curve)).collect();
        let ticks: Vec<f64> =
            self.scale.ticks.iter().copied().filter(|&tick| self.scale.fraction(tick) > 0.1).collect();
        let half = |tick: f64| [0.5 * text_width(&self.scale.label(tick), 12.0) + 3.0, 9.0];
        let free = |ray: f64, tick: f64| {
            let ([x, y], [wide, high]) = (self.at(ray, tick), half(tick));
            places.iter().all(|p| (p[0] - x).abs() > wide || (p[1] - y).abs() > high)
        };
        let count = |ray: f64| ticks.iter().filter(|&&tick| free(ray, tick)).count();
        let best = RAYS.into_iter().rev().max_by_key(|&ray| count(ray)).unwrap_or(RAYS[0]);
        for &tick in &ticks {
            let Some(ray) = std::iter::once(best).chain(RAYS).find(|&ray| free(ray, tick)) else { continue };
            let [x, y] = self.at(ray, tick);
            let [wide, high] = half(tick).map(|length| length - 2.0);
            let corners = [[x - wide, y - high], [x + wide, y - high], [x + wide, y + high], [x - wide, y + high]];
            canvas.path(&corners, true, "#ffffff", Stroke::solid("none", 0.0));
            canvas.text([x, y + 4.0], style(12.0, SOFT, Anchor::Middle), &self.scale.label(tick));
        }
    }

    /// Straight between neighbouring directions, and cut where it leaves the disc.
    pub(super) fn draw_line(&self, canvas: &mut Canvas, curve: &Curve, look: &Look) {
        let (runs, closed) = curve.runs();
        for run in runs.iter().filter(|run| run.len() > 1) {
            let mut points: Vec<_> = run.iter().map(|&(degrees, value)| self.at(degrees, value)).collect();
            if curve.values().all(|value| value <= self.scale.high) {
                canvas.path(&points, closed, "none", look.stroke());
                continue;
            }
            points.extend(closed.then(|| points[0]));
            for part in clip::to_circle(&points, self.center, self.radius) {
                canvas.path(&part, false, "none", look.stroke());
            }
        }
    }

    /// Between its edges: out along the one and back along the other.
    fn draw_band(&self, canvas: &mut Canvas, band: &Band, color: &str) {
        let ((low, closed), (high, _)) = (band.low.runs(), band.high.runs());
        for (low, high) in low.iter().zip(&high).filter(|(low, _)| low.len() > 1) {
            let mut points: Vec<_> = high.iter().map(|&(degrees, value)| self.at(degrees, value)).collect();
            let mut back: Vec<_> = low.iter().map(|&(degrees, value)| self.at(degrees, value)).collect();
            if closed {
                points.push(points[0]);
                back.push(back[0]);
            }
            points.extend(back.into_iter().rev());
            canvas.path(&points, true, &tint(color, BAND), Stroke::solid("none", 0.0));
        }
    }

    fn draw_edges(&self, canvas: &mut Canvas, band: &Band, color: &str) {
        for edge in [&band.low, &band.high] {
            let (runs, closed) = edge.runs();
            for run in runs.iter().filter(|run| run.len() > 1) {
                let points: Vec<_> = run.iter().map(|&(degrees, value)| self.at(degrees, value)).collect();
                canvas.path(&points, closed, "none", Stroke::solid(&tint(color, EDGE), 1.0));
            }
        }
    }

    /// Points along the drawn lines, close to each other.
    fn line_points(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let (mut runs, closed) = curve.runs();
        if closed {
            let first = runs[0][0];
            runs[0].push(first);
        }
        let ends = runs.iter().flat_map(|run| {
            let next = run.iter().skip(1).chain(run.last());
            run.iter().zip(next).map(|(&(d, v), &(e, w))| (self.at(d, v), self.at(e, w)))
        });
        let mix = |a: [f64; 2], b: [f64; 2], t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        ends.flat_map(|(a, b)| {
            let pieces = ((b[0] - a[0]).hypot(b[1] - a[1]) / 4.0).ceil().clamp(1.0, 500.0) as u32;
            (0..pieces).map(move |k| mix(a, b, f64::from(k) / f64::from(pieces)))
        })
        .collect()
    }

    /// Of several records each has its markers at other directions, so that they do not hide each other.
    pub(super) fn draw_markers(&self, canvas: &mut Canvas, curve: &Curve, look: &Look, records: usize) {
        let turn = curve.turn();
        let every = turn.len().div_ceil(if records > 1 { 24 } else { 72 }).max(1);
        let first = (curve.record * every / records.max(1)) % every;
        let size = MARKER * (24.0 / (turn.len() / every) as f64).sqrt().clamp(0.6, 1.0);
        for &(degrees, value, status) in turn.iter().skip(first).step_by(every) {
            if let Some(value) = value {
                let open = curve.kind == CurveKind::Limits && Outcome::of(status) == Outcome::NotProven;
                look.hollow_if(open).draw_marker(canvas, self.at(degrees, value), size);
            }
        }
    }

    /// Marks inside the rim in directions without a limit; those of several curves stand behind each other.
    pub(super) fn draw_gaps(&self, canvas: &mut Canvas, curve: &Curve, look: &Look, behind: usize) {
        let distance = self.radius - 8.0 - 9.0 * (behind % 6) as f64;
        for (degrees, value, status) in curve.turn() {
            if let (None, Some(shape)) = (value, Outcome::of(status).shape()) {
                look.with_shape(shape).draw_marker(canvas, self.polar(degrees, distance), MARKER);
            }
        }
    }
}

/// Shares of a line's colour in the band about it, and in the edges of the band.
const BAND: f64 = 0.18;
const EDGE: f64 = 0.5;

/// A share of a colour in white.
fn tint(color: &str, share: f64) -> String {
    let part = |k: usize| color.get(2 * k + 1..2 * k + 3).and_then(|hex| u8::from_str_radix(hex, 16).ok());
    let mixed = [0, 1, 2].map(|k| part(k).map_or(230.0, |x| 255.0 - share * (255.0 - f64::from(x))));
    let [r, g, b] = mixed.map(|x| x.round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn legend(input: &PolarPlot, of_all: &Looks, looks: &[Look], scale: &Scale) -> Vec<Entry> {
    let empty =
        |l2: f64| input.curves.iter().filter(|curve| curve.l2 == l2).all(|curve| curve.values().next().is_none());
    let name = |l2: f64| if input.lateral_free { "free".into() } else { l2_label(l2) };
    let label = |l2: f64| format!("{}{}", name(l2), if empty(l2) { ", no limit" } else { "" });
    let mut out = of_all.legend(&input.records, if input.lateral_free { "" } else { "= " }, label);
    let of_kind = |kind: CurveKind| input.curves.iter().zip(looks).filter(move |(curve, _)| curve.kind == kind);
    if input.records.1.is_empty() {
        let marker = input.check.is_empty();
        out.extend(of_kind(CurveKind::Limits).map(|(curve, look)| Entry::sample(look, true, marker, &label(curve.l2))));
    }
    let check = of_kind(CurveKind::Check).next().filter(|_| !input.records.1.is_empty()).map(|(_, look)| look.clone());
    let check = check.unwrap_or_else(look::hollow);
    out.extend((!input.check.is_empty()).then(|| Entry::sample(&check, false, true, &input.check)));
    if let Some((_, look)) = of_kind(CurveKind::Bound).next() {
        let cut = of_kind(CurveKind::Bound).flat_map(|(curve, _)| curve.values()).any(|value| value > scale.high);
        let cut = if cut { format!(", cut off at {}", scale.label(scale.high)) } else { String::new() };
        let look = Look { color: SOFT.into(), ..look.clone() };
        out.push(Entry::sample(&look, true, false, &format!("proven bound{cut}")));
    }
    if !input.bands.is_empty() {
        let look = Look { color: tint(SOFT, BAND), width: 9.0, ..look::hollow() };
        out.push(Entry::sample(&look, true, false, "within the tolerance"));
    }
    let shown = if input.check.is_empty() { CurveKind::Limits } else { CurveKind::Check };
    let statuses = of_kind(shown).flat_map(|(curve, _)| curve.turn()).map(|(_, value, status)| (value, status));
    out.extend(Outcome::legend(statuses, input.check.is_empty()));
    let kinds = RayKind::ALL.into_iter().filter(|kind| input.rays.iter().any(|ray| ray.kind == *kind));
    out.extend((!input.rays.is_empty()).then(|| Entry::Heading("Directions".into())));
    out.extend(kinds.map(|kind| Entry::sample(&kind.look(), true, false, kind.label())));
    out.push(Entry::Heading(format!("Radius: {}", input.symbol())));
    let base = input.quantity.base();
    let place = if scale.low < base { "dotted circle" } else { "centre" };
    let undeformed = match input.reference {
        Reference::Start => "undeformed".to_owned(),
        _ => format!("{} cell", input.cell_word().to_lowercase()),
    };
    out.push(Entry::Note(format!("{place} {}: {undeformed}", scale.label(base))));
    if scale.low < base {
        out.push(Entry::Note(format!("centre {}", scale.label(scale.low))));
    }
    out
}
