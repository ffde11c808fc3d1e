//! Polar plots of limits against the direction of the pull: 0° right, counter-clockwise.

use super::canvas::{Anchor, Canvas, Stroke, TextStyle, wrap};
use super::curve::{Curve, CurveKind};
use super::palette;
use super::scale::{Scale, signed};
use maille::design::Design;
use maille::record::{LimitRow, Status};

/// What the radius of the plot shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// 1 + l1, length over original length along the pull.
    #[default]
    Stretch,
    /// l1.
    L1,
    /// λ1 − 1, with λ1 the larger eigenvalue of C = FᵀF: what the thesis plots.
    Lambda1,
}

impl Quantity {
    fn of(self, row: &LimitRow) -> Option<f64> {
        match self {
            Quantity::Stretch => row.l1.map(|l1| 1.0 + l1),
            Quantity::L1 => row.l1,
            Quantity::Lambda1 => row.lambda1.map(|lambda1| lambda1 - 1.0),
        }
    }

    /// The same of the proven bound: of λ1, the larger eigenvalue that F = diag(1 + bound, 1 + l2) has.
    fn of_bound(self, row: &LimitRow) -> Option<f64> {
        let bound = row.bound_l1?;
        Some(match self {
            Quantity::Stretch => 1.0 + bound,
            Quantity::L1 => bound,
            Quantity::Lambda1 => (1.0 + bound).max(1.0 + row.l2).powi(2) - 1.0,
        })
    }

    /// The value of the sheet as it lies, in the centre of the plot.
    fn base(self) -> f64 {
        match self {
            Quantity::Stretch => 1.0,
            Quantity::L1 | Quantity::Lambda1 => 0.0,
        }
    }

    fn symbol(self) -> &'static str {
        match self {
            Quantity::Stretch => "1 + l₁",
            Quantity::L1 => "l₁",
            Quantity::Lambda1 => "λ₁ − 1",
        }
    }

    fn subtitle(self) -> &'static str {
        match self {
            Quantity::Stretch => "Largest stretch 1 + l₁ along each direction of pull",
            Quantity::L1 => "Largest elongation l₁ along each direction of pull",
            Quantity::Lambda1 => "Larger eigenvalue λ₁ of C = FᵀF, less 1, at the limit of each direction of pull",
        }
    }
}

/// A polar plot, ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarPlot {
    /// Heading.
    pub title: String,
    /// What the radius shows.
    pub quantity: Quantity,
    /// Curves, in the order of the legend.
    pub curves: Vec<Curve>,
    /// Paragraphs below the plot.
    pub caption: Vec<String>,
}

impl PolarPlot {
    /// The plot of a record's rows: one curve for each l2, ordered by value.
    ///
    /// `parameters` are further words for the caption, as `τ = 0.01`.
    pub fn from_rows(design: &Design, rows: &[LimitRow], quantity: Quantity, parameters: &[String]) -> Self {
        let mut l2: Vec<f64> = rows.iter().map(|row| row.l2 + 0.0).collect(); // + 0.0 makes −0 equal to 0
        l2.sort_by(f64::total_cmp);
        l2.dedup();
        let curve = |&l2: &f64| {
            let of_l2 = rows.iter().filter(|row| row.l2 == l2);
            let points: Vec<_> = of_l2.map(|row| (row.direction_deg, quantity.of(row))).collect();
            Curve::new(signed(&format!("{l2}")), l2, CurveKind::Limits, &points)
        };
        // Where every limit attains its bound the two curves are one.
        let open = |l2: &&f64| rows.iter().any(|row| row.l2 == **l2 && row.bound_gap.is_some_and(|gap| gap > 1e-6));
        let bound = |&l2: &f64| {
            let of_l2 = rows.iter().filter(|row| row.l2 == l2 && row.l1.is_some());
            let points: Vec<_> = of_l2.map(|row| (row.direction_deg, quantity.of_bound(row))).collect();
            Curve::new(String::new(), l2, CurveKind::Bound, &points)
        };
        let mut caption = vec![inputs(design, rows, parameters)];
        caption.extend(symmetry(rows, quantity));
        caption.extend(proven(rows));
        caption.extend(missing(rows, quantity));
        let curves = l2.iter().map(curve).chain(l2.iter().filter(open).map(bound)).collect();
        Self { title: heading(design), quantity, curves, caption }
    }
}

fn heading(design: &Design) -> String {
    if design.title.is_empty() { design.name.clone() } else { format!("{} · {}", design.name, design.title) }
}

/// Radius, method, cell and parameters of the rows.
fn inputs(design: &Design, rows: &[LimitRow], parameters: &[String]) -> String {
    let mut words = Vec::new();
    let mut radii: Vec<f64> = rows.iter().filter_map(|row| row.minor_radius).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup();
    let unit = design.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
    for r in radii {
        words.push(format!("r = {r}{unit} (r/R = {})", significant(r / design.reference_radius)));
    }
    let distinct = |of: fn(&LimitRow) -> &String| {
        let mut all: Vec<_> = rows.iter().map(of).collect();
        all.sort();
        all.dedup();
        all
    };
    words.extend(distinct(|row| &row.method).iter().map(|method| format!("{method} method")));
    words.extend(distinct(|row| &row.cell).iter().map(|cell| format!("cell {}", cell.replace('x', " × "))));
    words.extend(parameters.iter().cloned());
    words.join("  ·  ")
}

/// Which directions were computed, and why the plot goes all the way round.
fn symmetry(rows: &[LimitRow], quantity: Quantity) -> Option<String> {
    let mut directions: Vec<f64> = rows.iter().map(|row| row.direction_deg).collect();
    directions.sort_by(f64::total_cmp);
    directions.dedup();
    let (first, last) = (directions.first()?, directions.last()?);
    let computed = match directions.len() {
        1 => format!("1 direction computed, {first}°"),
        n => format!("{n} directions computed, {first}° to {last}°"),
    };
    let symbol = if quantity == Quantity::Lambda1 { "λ₁" } else { "l₁" };
    Some(format!("{computed}. A pull along D is the same pull along −D: {symbol} repeats after 180°."))
}

/// How many limits attain a proven bound, where a record has bounds.
fn proven(rows: &[LimitRow]) -> Option<String> {
    let limits = rows.iter().filter(|row| row.l1.is_some()).count();
    let global = rows.iter().filter(|row| row.status == Status::Global).count();
    rows.iter().any(|row| row.bound_l1.is_some()).then(|| match limits - global {
        0 => format!("All {limits} limits attain their proven bound: none can be larger."),
        _ => format!("{global} of {limits} limits attain their proven bound; dashed: the bound where others do not."),
    })
}

fn significant(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    format!("{rounded}")
}

/// How many rows have no value, and why: `3 directions without limit: 2 l2-unreachable, 1 not-converged.`
fn missing(rows: &[LimitRow], quantity: Quantity) -> Option<String> {
    let without: Vec<_> = rows.iter().filter(|row| quantity.of(row).is_none()).collect();
    if without.is_empty() {
        return None;
    }
    let count = |status: Status| without.iter().filter(|row| row.status == status).count();
    let by_status = Status::ALL.into_iter().map(|s| (count(s), s.name())).filter(|(n, _)| *n > 0);
    let parts: Vec<_> = by_status.map(|(n, name)| format!("{n} {name}")).collect();
    let (n, total) = (without.len(), rows.len());
    Some(format!("Gaps: {n} of {total} searches gave no limit ({}).", parts.join(", ")))
}

const WIDTH: f64 = 860.0;
const MARGIN: f64 = 36.0;
const RADIUS: f64 = 250.0;
const CENTER: [f64; 2] = [MARGIN + 40.0 + RADIUS, 122.0 + RADIUS];
const LEGEND: [f64; 2] = [CENTER[0] + RADIUS + 68.0, 122.0];
const CAPTION: f64 = CENTER[1] + RADIUS + 62.0;

const INK: &str = "#222222";
const SOFT: &str = "#5a5a5a";
const GRID: &str = "#dcdcdc";
const RIM: &str = "#9a9a9a";
const MARKER: f64 = 3.6;

fn style(size: f64, color: &'static str, anchor: Anchor) -> TextStyle {
    TextStyle { size, color, bold: false, anchor, halo: false }
}

/// The plot as SVG.
pub fn polar_svg(input: &PolarPlot) -> String {
    let caption: Vec<Vec<String>> = input.caption.iter().map(|text| wrap(text, 12.0, WIDTH - 2.0 * MARGIN)).collect();
    let lines: usize = caption.iter().map(Vec::len).sum();
    let legend_end = LEGEND[1] + 24.0 * (input.curves.len() as f64 + 4.0);
    let caption_top = CAPTION.max(legend_end + 30.0);
    let height = caption_top + 18.0 * lines as f64 + 4.0 * caption.len() as f64 + 14.0;
    let mut canvas = Canvas::new(WIDTH, height, &input.title);

    let size = (WIDTH - 2.0 * MARGIN) / (0.66 * input.title.chars().count().max(1) as f64);
    let title = TextStyle { bold: true, ..style(size.clamp(12.0, 22.0), INK, Anchor::Start) };
    canvas.text([MARGIN, 46.0], title, &input.title);
    canvas.text([MARGIN, 70.0], style(14.0, SOFT, Anchor::Start), input.quantity.subtitle());

    let scale = Scale::new(input.quantity.base(), input.curves.iter().flat_map(Curve::values), 6);
    let looks = looks(&input.curves);
    draw_grid(&mut canvas, &scale, input.quantity.base());
    let mut back_to_front: Vec<_> = input.curves.iter().zip(&looks).collect();
    back_to_front.sort_by(|a, b| (b.0.l2.abs()).total_cmp(&a.0.l2.abs()));
    for (curve, look) in &back_to_front {
        draw_line(&mut canvas, curve, look, &scale);
    }
    draw_ticks(&mut canvas, &scale, input);
    for (curve, look) in &back_to_front {
        draw_markers(&mut canvas, curve, look, &scale);
    }
    draw_legend(&mut canvas, input, &looks, &scale);
    draw_caption(&mut canvas, &caption, caption_top);
    canvas.finish()
}

/// Point of the canvas at a distance in pixels from the centre.
fn polar(degrees: f64, distance: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [CENTER[0] + distance * cos, CENTER[1] - distance * sin]
}

/// Point of the canvas for a value in a direction.
fn at(scale: &Scale, degrees: f64, value: f64) -> [f64; 2] {
    polar(degrees, RADIUS * scale.fraction(value))
}

fn draw_grid(canvas: &mut Canvas, scale: &Scale, base: f64) {
    for k in 0..12 {
        let degrees = 30.0 * f64::from(k);
        canvas.line(polar(degrees, 0.0), polar(degrees, RADIUS), Stroke::solid(GRID, 1.0));
        let label = format!("{degrees}°");
        let [x, y] = polar(degrees, RADIUS + 16.0);
        let half_width = 3.4 * label.chars().count() as f64;
        canvas.text(
            [x + half_width * degrees.to_radians().cos() + 2.0, y + 5.0],
            style(14.0, INK, Anchor::Middle),
            &label,
        );
    }
    for &tick in &scale.ticks {
        let radius = RADIUS * scale.fraction(tick);
        let stroke = if tick == scale.high {
            Stroke::solid(RIM, 1.2)
        } else if tick == base {
            Stroke { color: SOFT, width: 1.2, dash: "1 3" }
        } else {
            Stroke::solid(GRID, 1.0)
        };
        canvas.circle(CENTER, radius, "none", stroke);
    }
}

/// Labels of the circles, along the direction in which they are furthest from the curves.
fn draw_ticks(canvas: &mut Canvas, scale: &Scale, input: &PolarPlot) {
    const RAYS: [f64; 10] = [22.5, 37.5, 52.5, 67.5, 7.5, 82.5, 97.5, 112.5, 127.5, 142.5];
    let places: Vec<[f64; 2]> = input.curves.iter().flat_map(|curve| line_points(curve, scale)).collect();
    let ticks = || scale.ticks.iter().filter(|&&tick| scale.fraction(tick) > 0.1);
    // How clear the labels stand on a ray: a sum, so that one label on a curve does not hide what the others gain.
    let clear = |ray: f64| -> f64 {
        let nearest = |tick: &f64| {
            let label = at(scale, ray, *tick);
            let gaps = places.iter().map(|p| ((p[0] - label[0]) / 1.6).hypot(p[1] - label[1]));
            gaps.fold(18.0, f64::min)
        };
        ticks().map(nearest).sum()
    };
    let best = RAYS.into_iter().rev().max_by(|&a, &b| clear(a).total_cmp(&clear(b))).unwrap_or(RAYS[0]);
    for &tick in ticks() {
        let [x, y] = at(scale, best, tick);
        let style = TextStyle { halo: true, ..style(12.0, SOFT, Anchor::Middle) };
        canvas.text([x, y + 4.0], style, &scale.label(tick));
    }
}

/// Colour, width and marker of a curve.
struct Look {
    color: String,
    width: f64,
    rank: i32,
}

fn looks(curves: &[Curve]) -> Vec<Look> {
    let side = |sign: f64| {
        let mut l2: Vec<f64> = curves.iter().map(|c| c.l2 * sign).filter(|l2| *l2 > 0.0).collect();
        l2.sort_by(f64::total_cmp);
        l2.dedup();
        l2
    };
    let (below, above) = (side(-1.0), side(1.0));
    let (blues, oranges) = (palette::negative(below.len()), palette::positive(above.len()));
    let rank = |side: &[f64], l2: f64| side.iter().position(|x| *x == l2).unwrap_or(0);
    let look = |curve: &Curve| {
        if curve.l2 < 0.0 {
            let i = rank(&below, -curve.l2);
            Look { color: blues[i].clone(), width: 1.9, rank: -(i as i32) - 1 }
        } else if curve.l2 > 0.0 {
            let i = rank(&above, curve.l2);
            Look { color: oranges[i].clone(), width: 1.9, rank: i as i32 + 1 }
        } else {
            Look { color: palette::NEUTRAL.into(), width: 2.6, rank: 0 }
        }
    };
    curves.iter().map(look).collect()
}

impl Look {
    fn stroke(&self, kind: CurveKind) -> Stroke<'_> {
        match kind {
            CurveKind::Limits => Stroke::solid(&self.color, self.width),
            CurveKind::Bound => Stroke { color: &self.color, width: 1.4, dash: "5 4" },
        }
    }

    /// Filled where the sheet is held compressed or as it is, hollow where it is held stretched.
    fn draw_marker(&self, canvas: &mut Canvas, at: [f64; 2], size: f64) {
        let fill = if self.rank > 0 { "#ffffff" } else { &self.color };
        let stroke = Stroke::solid(&self.color, 1.4);
        let shape = palette::marker(self.rank);
        if shape.is_empty() {
            canvas.circle(at, size, fill, stroke);
        } else {
            let points: Vec<_> = shape.iter().map(|p| [at[0] + size * p[0], at[1] + size * p[1]]).collect();
            canvas.path(&points, true, fill, stroke);
        }
    }
}

/// Straight between neighbouring directions.
fn draw_line(canvas: &mut Canvas, curve: &Curve, look: &Look, scale: &Scale) {
    let (runs, closed) = curve.runs();
    for run in runs.iter().filter(|run| run.len() > 1) {
        let points: Vec<_> = run.iter().map(|&(degrees, value)| at(scale, degrees, value)).collect();
        canvas.path(&points, closed, "none", look.stroke(curve.kind));
    }
}

/// Points along the drawn lines, close to each other.
fn line_points(curve: &Curve, scale: &Scale) -> Vec<[f64; 2]> {
    let (mut runs, closed) = curve.runs();
    if closed {
        let first = runs[0][0];
        runs[0].push(first);
    }
    let ends = runs.iter().flat_map(|run| {
        let next = run.iter().skip(1).chain(run.last());
        run.iter().zip(next).map(|(&(d, v), &(e, w))| (at(scale, d, v), at(scale, e, w)))
    });
    let mix = |a: [f64; 2], b: [f64; 2], t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    ends.flat_map(|(a, b)| (0..12).map(move |k| mix(a, b, f64::from(k) / 12.0))).collect()
}

fn draw_markers(canvas: &mut Canvas, curve: &Curve, look: &Look, scale: &Scale) {
    if curve.kind == CurveKind::Bound {
        return;
    }
    let turn = curve.turn();
    let every = turn.len().div_ceil(72).max(1);
    let size = MARKER * (24.0 / (turn.len() / every) as f64).sqrt().clamp(0.6, 1.0);
    for &(degrees, value) in turn.iter().step_by(every) {
        if let Some(value) = value {
            look.draw_marker(canvas, at(scale, degrees, value), size);
        }
    }
}

fn draw_legend(canvas: &mut Canvas, input: &PolarPlot, looks: &[Look], scale: &Scale) {
    let [x, mut y] = LEGEND;
    canvas.text([x, y], TextStyle { bold: true, ..style(13.0, INK, Anchor::Start) }, "l₂ across the pull");
    for (curve, look) in input.curves.iter().zip(looks).filter(|(curve, _)| curve.kind == CurveKind::Limits) {
        y += 24.0;
        canvas.line([x, y - 4.5], [x + 36.0, y - 4.5], look.stroke(curve.kind));
        look.draw_marker(canvas, [x + 18.0, y - 4.5], MARKER);
        canvas.text([x + 48.0, y], style(13.0, INK, Anchor::Start), &curve.label);
        if curve.values().next().is_none() {
            canvas.text([x + 100.0, y], style(12.0, SOFT, Anchor::Start), "no limit");
        }
    }
    if let Some((curve, _)) = input.curves.iter().zip(looks).find(|(curve, _)| curve.kind == CurveKind::Bound) {
        y += 24.0;
        let dashed = Stroke { color: SOFT, ..looks[0].stroke(curve.kind) };
        canvas.line([x, y - 4.5], [x + 36.0, y - 4.5], dashed);
        canvas.text([x + 48.0, y], style(13.0, INK, Anchor::Start), "proven bound");
    }
    y += 40.0;
    canvas.text(
        [x, y],
        TextStyle { bold: true, ..style(13.0, INK, Anchor::Start) },
        &format!("Radius: {}", input.quantity.symbol()),
    );
    let base = input.quantity.base();
    let place = if scale.low < base { "dotted circle" } else { "centre" };
    let note = format!("{place} {}: undeformed", scale.label(base));
    canvas.text([x, y + 20.0], style(12.0, SOFT, Anchor::Start), &note);
    if scale.low < base {
        canvas.text([x, y + 37.0], style(12.0, SOFT, Anchor::Start), &format!("centre {}", scale.label(scale.low)));
    }
}

fn draw_caption(canvas: &mut Canvas, caption: &[Vec<String>], top: f64) {
    let mut y = top;
    canvas.line([MARGIN, y - 22.0], [WIDTH - MARGIN, y - 22.0], Stroke::solid(GRID, 1.0));
    for paragraph in caption {
        for line in paragraph {
            canvas.text([MARGIN, y], style(12.0, SOFT, Anchor::Start), line);
            y += 18.0;
        }
        y += 4.0;
    }
}
