//! A chart with two axes: curves over l2, over the direction of the pull, or over the stretch.

use super::canvas::{Anchor, Canvas, Stroke, TextStyle};
use super::frame::{Entry, Frame, GRID, INK, Layout, MARGIN, RIM, SOFT, TOP, style};
use super::look::{self, Look, MARKER};
use super::scale::Axis;

const LEFT: f64 = MARGIN + 58.0;
const RIGHT: f64 = 612.0;
const BOTTOM: f64 = TOP + 400.0;

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
}

impl Chart {
    pub(super) fn svg(&self, layout: Layout) -> String {
        self.frame.svg(layout, BOTTOM + 52.0, |canvas| {
            self.draw_grid(canvas);
            for (points, color) in &self.bands {
                let around: Vec<[f64; 2]> = points.iter().filter_map(|point| self.at(point)).collect();
                canvas.path(&around, true, color, Stroke::solid("none", 0.0));
            }
            for series in &self.series {
                for run in series.points.split(|point| point.y.is_none()) {
                    let run: Vec<[f64; 2]> = run.iter().filter_map(|point| self.at(point)).collect();
                    if run.len() > 1 {
                        canvas.path(&run, false, "none", series.look.stroke());
                    }
                }
            }
            for (i, series) in self.series.iter().enumerate() {
                self.draw_markers(canvas, series, i);
            }
        })
    }

    fn at(&self, point: &Point) -> Option<[f64; 2]> {
        let x = LEFT + (RIGHT - LEFT) * self.x.fraction(point.x);
        Some([x, BOTTOM + (TOP - BOTTOM) * self.y.fraction(point.y?)])
    }

    /// At most 24 a curve, and none twice as near as that; those of several curves at different places.
    fn draw_markers(&self, canvas: &mut Canvas, series: &Series, i: usize) {
        let every = series.points.len().div_ceil(24).max(1);
        for (k, point) in series.points.iter().enumerate() {
            let Some(at) = self.at(point) else { continue };
            let alone = |j: Option<usize>| j.and_then(|j| series.points.get(j)).is_none_or(|p| p.y.is_none());
            let single = alone(k.checked_sub(1)) && alone(Some(k + 1));
            if single || point.hollow || k % every == i % every {
                let mut look = series.look.clone();
                look.marker.filled &= !point.hollow;
                look.draw_marker(canvas, at, MARKER);
            }
        }
    }

    fn draw_grid(&self, canvas: &mut Canvas) {
        for (x, label) in &self.x.ticks {
            let x = LEFT + (RIGHT - LEFT) * self.x.fraction(*x);
            canvas.line([x, TOP], [x, BOTTOM], Stroke::solid(GRID, 1.0));
            canvas.text([x, BOTTOM + 20.0], style(13.0, INK, Anchor::Middle), label);
        }
        for (y, label) in &self.y.ticks {
            let y = BOTTOM + (TOP - BOTTOM) * self.y.fraction(*y);
            canvas.line([LEFT, y], [RIGHT, y], Stroke::solid(GRID, 1.0));
            canvas.text([LEFT - 9.0, y + 4.5], style(13.0, INK, Anchor::End), label);
        }
        canvas.line([LEFT, BOTTOM], [RIGHT, BOTTOM], Stroke::solid(RIM, 1.2));
        let [x, y] = &self.names;
        canvas.text([(LEFT + RIGHT) / 2.0, BOTTOM + 44.0], style(13.0, INK, Anchor::Middle), x);
        let halo = TextStyle { halo: true, ..style(13.0, INK, Anchor::Start) };
        canvas.text([MARGIN, TOP - 18.0], halo, y);
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
