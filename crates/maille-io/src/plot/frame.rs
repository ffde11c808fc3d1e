//! What all plots share: the heading, the legend beside the data and the caption below it.

use super::canvas::{Anchor, Canvas, Stroke, TextStyle, text_width, wrap};
use super::look::{Look, MARKER};

pub(super) const MARGIN: f64 = 36.0;
/// Top of what is drawn below the heading.
pub(super) const TOP: f64 = 122.0;
/// Left end of the legend.
pub(super) const LEGEND: f64 = 644.0;
/// A picture is never narrower.
const WIDTH: f64 = 860.0;
/// Width of a line or marker in the legend, with the space behind it.
const SAMPLE: f64 = 48.0;
/// A longer text in the legend is broken.
const LABEL: f64 = 250.0;

pub(super) const INK: &str = "#222222";
pub(super) const SOFT: &str = "#5a5a5a";
pub(super) const GRID: &str = "#dcdcdc";
pub(super) const RIM: &str = "#9a9a9a";

pub(super) fn style(size: f64, color: &'static str, anchor: Anchor) -> TextStyle {
    TextStyle { size, color, bold: false, anchor, halo: false }
}

pub(super) fn bold(size: f64) -> TextStyle {
    TextStyle { bold: true, ..style(size, INK, Anchor::Start) }
}

/// Where a plot has its legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Beside the data, with a heading above: a picture that stands alone.
    Beside,
    /// Below the data, in larger type and without a heading: for a page that has one, on a narrow screen too.
    Below,
}

/// Of a plot with its legend below: its width, the top of what is drawn, the width of a column of the legend, and how much
/// larger its type is.
const NARROW: f64 = 650.0;
const NARROW_TOP: f64 = TOP - 42.0;
const COLUMN: f64 = (NARROW - 2.0 * MARGIN) / 2.0;
const LARGER: f64 = 1.25;

/// A line of the legend.
pub(super) enum Entry {
    Heading(String),
    /// A sample of a curve, with or without its line and its marker, and what it is.
    Sample {
        look: Look,
        line: bool,
        marker: bool,
        label: String,
    },
    Note(String),
}

/// Heading, legend and caption of a plot.
pub(super) struct Frame {
    pub(super) title: String,
    pub(super) subtitle: String,
    pub(super) legend: Vec<Entry>,
    pub(super) caption: Vec<String>,
}

impl Frame {
    /// The picture: `draw` draws the data, down to `bottom`.
    pub(super) fn svg(&self, layout: Layout, bottom: f64, draw: impl FnOnce(&mut Canvas)) -> String {
        if layout == Layout::Below {
            return self.narrow_svg(bottom, draw);
        }
        let labels = self.legend.iter().map(|entry| match entry {
            Entry::Heading(text) => 1.1 * text_width(text, 13.0),
            Entry::Note(text) => text_width(text, 12.0),
            Entry::Sample { label, .. } => {
                SAMPLE + lines(label).iter().map(|line| text_width(line, 13.0)).fold(0.0, f64::max)
            }
        });
        let width = labels.fold(WIDTH - LEGEND - MARGIN, f64::max).ceil() + LEGEND + MARGIN;
        let caption: Vec<_> = self.caption.iter().flat_map(|text| wrap(text, 12.0, width - 2.0 * MARGIN)).collect();
        let caption_top = bottom.max(self.legend_end()) + 40.0;
        let height = caption_top + 18.0 * caption.len() as f64 + 4.0 * self.caption.len() as f64 + 14.0;

        let mut canvas = Canvas::new(0.0, width, height, &self.title);
        let size = (width - 2.0 * MARGIN) / (0.66 * self.title.chars().count().max(1) as f64);
        let title = TextStyle { size: size.clamp(12.0, 22.0), ..bold(0.0) };
        canvas.text([MARGIN, 46.0], title, &self.title);
        canvas.text([MARGIN, 70.0], style(14.0, SOFT, Anchor::Start), &self.subtitle);
        draw(&mut canvas);
        self.draw_legend(&mut canvas);
        self.draw_caption(&mut canvas, caption_top, width, 1.0);
        canvas.finish()
    }

    /// The legend runs through two columns below the data.
    fn narrow_svg(&self, bottom: f64, draw: impl FnOnce(&mut Canvas)) -> String {
        let type_of = |size: f64| size * LARGER;
        let broken: Vec<(&Entry, Vec<String>)> = self
            .legend
            .iter()
            .map(|entry| match entry {
                Entry::Heading(text) => (entry, wrap(text, type_of(13.0), 0.9 * 2.0 * COLUMN)),
                Entry::Note(text) => (entry, wrap(text, type_of(12.0), 2.0 * COLUMN)),
                Entry::Sample { label, .. } => (entry, wrap(label, type_of(13.0), COLUMN - SAMPLE - 8.0)),
            })
            .collect();
        // Headings and notes have a row of their own, samples stand two in a row.
        let (mut y, mut column, mut row) = (bottom + 34.0, 0, 0.0_f64);
        let mut places = Vec::new();
        for (entry, lines) in &broken {
            let sample = matches!(entry, Entry::Sample { .. });
            if column > 0 && (!sample || column == 2) {
                (y, column, row) = (y + row, 0, 0.0);
            }
            if matches!(entry, Entry::Heading(_)) && !places.is_empty() {
                y += 12.0;
            }
            places.push(([MARGIN + COLUMN * f64::from(column), y], *entry, lines));
            let height = 25.0 * lines.len().max(1) as f64;
            if sample {
                (column, row) = (column + 1, row.max(height));
            } else {
                y += height;
            }
        }
        let caption_top = y + row + 26.0;
        let width = NARROW - 2.0 * MARGIN;
        let caption = self.caption.iter().flat_map(|text| wrap(text, type_of(12.0), width)).count() as f64;
        let height = caption_top + LARGER * (18.0 * caption + 4.0 * self.caption.len() as f64);
        let mut canvas = Canvas::new(NARROW_TOP, NARROW, height - NARROW_TOP, &self.title);
        draw(&mut canvas);
        for ([x, y], entry, lines) in places {
            let (x, style) = match entry {
                Entry::Heading(_) => (x, bold(type_of(13.0))),
                Entry::Note(_) => (x, style(type_of(12.0), SOFT, Anchor::Start)),
                Entry::Sample { look, line, marker, .. } => {
                    draw_sample(&mut canvas, [x, y - 5.5], look, *line, *marker);
                    (x + SAMPLE, style(type_of(13.0), INK, Anchor::Start))
                }
            };
            for (k, line) in lines.iter().enumerate() {
                canvas.text([x, y + 21.0 * k as f64], style, line);
            }
        }
        self.draw_caption(&mut canvas, caption_top, NARROW, LARGER);
        canvas.finish()
    }

    /// Each entry with its baseline.
    fn legend_places(&self) -> Vec<(&Entry, f64)> {
        let mut y = TOP;
        let mut places = Vec::new();
        let mut before: Option<&Entry> = None;
        for entry in &self.legend {
            y += match (entry, before) {
                (_, None) => 0.0,
                (Entry::Heading(_), _) => 40.0,
                (Entry::Note(_), Some(Entry::Note(_))) => 17.0,
                (Entry::Note(_), _) => 20.0,
                (Entry::Sample { .. }, _) => 24.0,
            };
            places.push((entry, y));
            if let Entry::Sample { label, .. } = entry {
                y += 17.0 * (lines(label).len() - 1) as f64;
            }
            before = Some(entry);
        }
        places
    }

    fn legend_end(&self) -> f64 {
        self.legend_places().last().map_or(TOP, |(_, y)| *y)
    }

    fn draw_legend(&self, canvas: &mut Canvas) {
        for (entry, y) in self.legend_places() {
            match entry {
                Entry::Heading(text) => canvas.text([LEGEND, y], bold(13.0), text),
                Entry::Note(text) => canvas.text([LEGEND, y], style(12.0, SOFT, Anchor::Start), text),
                Entry::Sample { look, line, marker, label } => {
                    draw_sample(canvas, [LEGEND, y - 4.5], look, *line, *marker);
                    for (k, line) in lines(label).iter().enumerate() {
                        canvas.text([LEGEND + SAMPLE, y + 17.0 * k as f64], style(13.0, INK, Anchor::Start), line);
                    }
                }
            }
        }
    }

    fn draw_caption(&self, canvas: &mut Canvas, top: f64, width: f64, larger: f64) {
        let mut y = top;
        canvas.line([MARGIN, y - 22.0], [width - MARGIN, y - 22.0], Stroke::solid(GRID, 1.0));
        for paragraph in &self.caption {
            for line in wrap(paragraph, 12.0 * larger, width - 2.0 * MARGIN) {
                canvas.text([MARGIN, y], style(12.0 * larger, SOFT, Anchor::Start), &line);
                y += 18.0 * larger;
            }
            y += 4.0 * larger;
        }
    }
}

fn draw_sample(canvas: &mut Canvas, [x, y]: [f64; 2], look: &Look, line: bool, marker: bool) {
    if line {
        canvas.line([x, y], [x + 36.0, y], look.stroke());
    }
    if marker {
        look.draw_marker(canvas, [x + 18.0, y], MARKER);
    }
}

fn lines(label: &str) -> Vec<String> {
    wrap(label, 13.0, LABEL)
}
