//! A chart with two axes: curves over l2, the direction of the pull, the stretch, or the radius of rings.

use super::canvas::{Anchor, Canvas, Stroke, TextStyle, wrap};
use super::clip;
use super::frame::{Area, Entry, Frame, GRID, INK, Layout, RIM, SOFT, style};
use super::look::{self, Look, MARKER};
use super::palette;
use super::scale::Axis;

/// A curve: points in the order of x, a gap where there is no value.
pub(super) struct Series {
    pub(super) look: Look,
    pub(super) points: Vec<Point>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: Option<f64>,
    /// Drawn with a hollow marker: the value lacks something, as the legend says.
    pub(super) hollow: bool,
}

/// A chart, ready to be drawn.
pub(super) struct Chart {
    pub(super) frame: Frame,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Name and unit of each axis.
    pub(super) names: [String; 2],
    pub(super) series: Vec<Series>,
    /// Areas below the curves: points once around, and the colour with its opacity.
    pub(super) bands: Vec<(Vec<Point>, String)>,
    /// Lines without markers, cut where they leave the chart.
    pub(super) bare: Vec<Series>,
    /// What it means that a point has no value; it is marked on the axis then. Not marked if empty.
    pub(super) gap: &'static str,
}

/// The rectangle between the axes.
#[derive(Clone, Copy)]
struct Axes {
    area: Area,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Chart {
    /// A chart of lines without areas, bare lines and marked gaps.
    pub(super) fn of_lines(frame: Frame, [x, y]: [Axis; 2], names: [String; 2], series: Vec<Series>) -> Self {
        Chart { frame, x, y, names, series, bands: Vec::new(), bare: Vec::new(), gap: "" }
    }

    pub(super) fn svg(mut self, layout: Layout) -> String {
        let gaps = !self.gap.is_empty() && self.series.iter().any(|s| s.points.iter().any(|point| point.y.is_none()));
        let cross = look::hollow().with_shape(palette::CROSS);
        self.frame
            .legend
            .extend(gaps.then(|| Entry::sample(&Look { color: SOFT.into(), ..cross }, false, true, self.gap)));
        let axes = self.axes(layout);
        let names = wrap(&self.names[0], 13.0, axes.right - axes.left).len() as f64;
        self.frame.svg(layout, axes.bottom + 36.0 + 16.0 * names, |canvas| self.draw(canvas, &axes))
    }

    fn axes(&self, layout: Layout) -> Axes {
        let area = self.frame.area(layout);
        // In print the name of y stands upright beside the labels.
        let beside = if area.print { 16.0 * self.upright(area).len() as f64 - 4.0 } else { 0.0 };
        let (left, right) = (area.left + 58.0 + beside, area.right - 20.0);
        let top = if area.print { 12.0 } else { area.top };
        Axes { area, left, right, top, bottom: top + 400.0 / 518.0 * (right - left) }
    }

    /// The lines of the name of y beside its axis.
    fn upright(&self, area: Area) -> Vec<String> {
        wrap(&self.names[1], 13.0, 0.65 * (area.right - area.left))
    }

    fn draw(&self, canvas: &mut Canvas, axes: &Axes) {
        self.draw_grid(canvas, axes);
        for (points, color) in &self.bands {
            let around: Vec<[f64; 2]> = points.iter().filter_map(|point| self.at(axes, point)).collect();
            canvas.path(&around, true, color, Stroke::solid("none", 0.0));
        }
        for (series, bare) in self.bare.iter().map(|s| (s, true)).chain(self.series.iter().map(|s| (s, false))) {
            for run in series.points.split(|point| point.y.is_none()) {
                let run: Vec<[f64; 2]> = run.iter().filter_map(|point| self.at(axes, point)).collect();
                let parts = match bare {
                    true => clip::to_rectangle(&run, [axes.left, axes.top], [axes.right, axes.bottom]),
                    false => vec![run],
                };
                for part in parts.iter().filter(|part| part.len() > 1) {
                    canvas.path(part, false, "none", series.look.stroke());
                }
            }
        }
        let mut looks: Vec<&Look> = Vec::new();
        for (i, series) in self.series.iter().enumerate() {
            if !looks.contains(&&series.look) {
                looks.push(&series.look);
            }
            self.draw_markers(canvas, axes, series, [i, looks.len() - 1]);
        }
    }

    fn at(&self, axes: &Axes, point: &Point) -> Option<[f64; 2]> {
        let x = axes.left + (axes.right - axes.left) * self.x.fraction(point.x);
        Some([x, axes.bottom + (axes.top - axes.bottom) * self.y.fraction(point.y?)])
    }

    /// At most 24 a curve, and none twice as near as that; those of several curves at different places. Gaps are marked on
    /// the axis, those of another look above.
    fn draw_markers(&self, canvas: &mut Canvas, axes: &Axes, series: &Series, [i, look]: [usize; 2]) {
        let every = series.points.len().div_ceil(24).max(1);
        for (k, point) in series.points.iter().enumerate() {
            let Some(at) = self.at(axes, point) else {
                if !self.gap.is_empty() {
                    let x = axes.left + (axes.right - axes.left) * self.x.fraction(point.x);
                    let cross = series.look.with_shape(palette::CROSS);
                    cross.draw_marker(canvas, [x, axes.bottom - 8.0 - 9.0 * (look % 6) as f64], MARKER);
                }
                continue;
            };
            let alone = |j: Option<usize>| j.and_then(|j| series.points.get(j)).is_none_or(|p| p.y.is_none());
            let single = alone(k.checked_sub(1)) && alone(Some(k + 1));
            if single || point.hollow || k % every == i % every {
                series.look.hollow_if(point.hollow).draw_marker(canvas, at, MARKER);
            }
        }
    }

    fn draw_grid(&self, canvas: &mut Canvas, axes: &Axes) {
        let &Axes { area, left, right, top, bottom } = axes;
        for (x, label) in &self.x.ticks {
            let x = left + (right - left) * self.x.fraction(*x);
            canvas.line([x, top], [x, bottom], Stroke::solid(GRID, 1.0));
            canvas.text([x, bottom + 20.0], style(13.0, INK, Anchor::Middle), label);
        }
        for (y, label) in &self.y.ticks {
            let y = bottom + (top - bottom) * self.y.fraction(*y);
            canvas.line([left, y], [right, y], Stroke::solid(GRID, 1.0));
            canvas.text([left - 9.0, y + 4.5], style(13.0, INK, Anchor::End), label);
        }
        canvas.line([left, bottom], [right, bottom], Stroke::solid(RIM, 1.2));
        for (k, line) in wrap(&self.names[0], 13.0, right - left).iter().enumerate() {
            let at = [(left + right) / 2.0, bottom + 44.0 + 16.0 * k as f64];
            canvas.text(at, style(13.0, INK, Anchor::Middle), line);
        }
        if area.print {
            for (k, line) in self.upright(area).iter().enumerate() {
                canvas.text_upward([area.left + 12.0 + 16.0 * k as f64, (top + bottom) / 2.0], 13.0, line);
            }
        } else {
            let halo = TextStyle { halo: true, ..style(13.0, INK, Anchor::Start) };
            canvas.text([area.left, top - 18.0], halo, &self.names[1]);
        }
    }
}

/// A legend that tells records apart, each with a line and a marker.
pub(super) fn legend_of_records(apart: String, labels: &[String]) -> Vec<Entry> {
    let mut out = vec![Entry::Heading(if labels.len() > 1 { apart } else { "Design".into() })];
    let looks = look::of_records(labels.len());
    out.extend(looks.iter().zip(labels).map(|(look, label)| Entry::sample(look, true, true, label)));
    out
}

/// The note on hollow markers.
pub(super) fn hollow_note(text: &str) -> Entry {
    Entry::sample(&Look { color: SOFT.into(), ..look::hollow() }, false, true, text)
}
