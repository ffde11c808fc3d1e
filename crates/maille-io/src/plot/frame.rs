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
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// Beside the data, with a heading above: a picture that stands alone.
    Beside,
    /// Below the data, in larger type and without a heading: for a page that has one, on a narrow screen too.
    Below,
    /// For a printed column: of a given width, without heading and caption.
    Paper(Paper),
}

/// A column of a printed page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// Width of the figure.
    pub width_mm: f64,
    /// Size of its type, in points (1/72 inch).
    pub font_pt: f64,
}

impl Default for Paper {
    /// One column of a journal of two.
    fn default() -> Self {
        Paper { width_mm: 89.0, font_pt: 7.0 }
    }
}

impl Paper {
    /// Length of the drawing's unit on paper: its type is 13 units high.
    fn unit_mm(self) -> f64 {
        25.4 / 72.0 * self.font_pt / TYPE
    }

    /// Its width in units of the drawing.
    fn width(self) -> f64 {
        self.width_mm / self.unit_mm()
    }
}

/// Size of the type of labels.
const TYPE: f64 = 13.0;
/// Of a plot with its legend below: its width, the top of what is drawn, and how much larger its type is.
const NARROW: f64 = 650.0;
const NARROW_TOP: f64 = TOP - 42.0;
const LARGER: f64 = 1.25;
/// Margin of a figure for print, and the least width that has room for a legend beside the data.
const TRIM: f64 = 6.0;
const BROAD: f64 = 760.0;

/// Where the data and the labels of their axes have room: `top` is that of the data.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    /// Whether the names of axes stand along them.
    pub(super) print: bool,
}

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

impl Entry {
    pub(super) fn sample(look: &Look, line: bool, marker: bool, label: &str) -> Entry {
        Entry::Sample { look: look.clone(), line, marker, label: label.to_owned() }
    }
}

/// Heading, legend and caption of a plot.
pub(super) struct Frame {
    pub(super) title: String,
    pub(super) subtitle: String,
    pub(super) legend: Vec<Entry>,
    pub(super) caption: Vec<String>,
}

impl Frame {
    /// Where the data have room.
    pub(super) fn area(&self, layout: Layout) -> Area {
        let (left, right, top, print) = match layout {
            Layout::Beside | Layout::Below => (MARGIN, LEGEND - 12.0, TOP, false),
            Layout::Paper(paper) => (TRIM, self.legend_left(paper).unwrap_or(paper.width()) - TRIM, 26.0, true),
        };
        Area { left, right, top, print }
    }

    /// Where the legend begins beside the data of a figure for print, if it has room there.
    fn legend_left(&self, paper: Paper) -> Option<f64> {
        (paper.width() >= BROAD).then(|| paper.width() - self.legend_width() - TRIM)
    }

    fn legend_width(&self) -> f64 {
        let labels = self.legend.iter().map(|entry| match entry {
            Entry::Heading(text) => 1.1 * text_width(text, TYPE),
            Entry::Note(text) => text_width(text, 12.0),
            Entry::Sample { label, .. } => {
                SAMPLE + lines(label).iter().map(|line| text_width(line, TYPE)).fold(0.0, f64::max)
            }
        });
        labels.fold(0.0, f64::max).ceil()
    }

    /// The picture: `draw` draws the data, down to `bottom`.
    pub(super) fn svg(&self, layout: Layout, bottom: f64, draw: impl FnOnce(&mut Canvas)) -> String {
        match layout {
            Layout::Beside => self.beside_svg(bottom, draw),
            Layout::Below => self.below_svg(bottom, draw),
            Layout::Paper(paper) => self.paper_svg(paper, bottom, draw),
        }
    }

    fn beside_svg(&self, bottom: f64, draw: impl FnOnce(&mut Canvas)) -> String {
        let width = self.legend_width().max(WIDTH - LEGEND - MARGIN) + LEGEND + MARGIN;
        let caption: Vec<_> = self.caption.iter().flat_map(|text| wrap(text, 12.0, width - 2.0 * MARGIN)).collect();
        let places = self.column([LEGEND, TOP]);
        let caption_top = bottom.max(places.last().map_or(TOP, |place| place.0[1])) + 40.0;
        let height = caption_top + 18.0 * caption.len() as f64 + 4.0 * self.caption.len() as f64 + 14.0;

        let mut canvas = Canvas::new(0.0, [width, height], None, &self.title);
        let size = (width - 2.0 * MARGIN) / (0.66 * self.title.chars().count().max(1) as f64);
        let title = TextStyle { size: size.clamp(12.0, 22.0), ..bold(0.0) };
        canvas.text([MARGIN, 46.0], title, &self.title);
        canvas.text([MARGIN, 70.0], style(14.0, SOFT, Anchor::Start), &self.subtitle);
        draw(&mut canvas);
        draw_legend(&mut canvas, &places, 1.0, [4.5, 17.0]);
        self.draw_caption(&mut canvas, caption_top, width, 1.0);
        canvas.finish()
    }

    fn below_svg(&self, bottom: f64, draw: impl FnOnce(&mut Canvas)) -> String {
        let width = NARROW - 2.0 * MARGIN;
        let (places, end) = self.rows([MARGIN, bottom + 34.0], width, width / 2.0, LARGER);
        let caption_top = end + 26.0;
        let caption = self.caption.iter().flat_map(|text| wrap(text, 12.0 * LARGER, width)).count() as f64;
        let height = caption_top + LARGER * (18.0 * caption + 4.0 * self.caption.len() as f64);
        let mut canvas = Canvas::new(NARROW_TOP, [NARROW, height - NARROW_TOP], None, &self.title);
        draw(&mut canvas);
        draw_legend(&mut canvas, &places, LARGER, [5.5, 21.0]);
        self.draw_caption(&mut canvas, caption_top, NARROW, LARGER);
        canvas.finish()
    }

    fn paper_svg(&self, paper: Paper, bottom: f64, draw: impl FnOnce(&mut Canvas)) -> String {
        let width = paper.width();
        let (places, end) = match self.legend_left(paper) {
            Some(left) => {
                let places = self.column([left, 26.0]);
                let end = places.last().map_or(0.0, |(at, _, lines)| at[1] + 17.0 * (lines.len() - 1) as f64);
                (places, end + 8.0)
            }
            None => {
                let room = width - 2.0 * TRIM;
                let columns = (room / (self.legend_width() + 12.0)).floor().clamp(1.0, 4.0);
                self.rows([TRIM, bottom + 22.0], room, room / columns, 1.0)
            }
        };
        let mut canvas = Canvas::new(0.0, [width, bottom.max(end) + TRIM], Some(paper.unit_mm()), &self.title);
        draw(&mut canvas);
        draw_legend(&mut canvas, &places, 1.0, [4.5, 17.0]);
        canvas.finish()
    }

    /// The legend in columns of a width: headings and notes have a row of their own, samples stand side by side. With
    /// the bottom of it.
    fn rows(&self, [left, top]: [f64; 2], width: f64, column_width: f64, larger: f64) -> (Vec<Place<'_>>, f64) {
        let type_of = |size: f64| size * larger;
        let broken = |entry: &Entry| match entry {
            Entry::Heading(text) => wrap(text, type_of(TYPE), 0.9 * width),
            Entry::Note(text) => wrap(text, type_of(12.0), width),
            Entry::Sample { label, .. } => wrap(label, type_of(TYPE), column_width - SAMPLE - 8.0),
        };
        let columns = (width / column_width).round() as u32;
        let (mut y, mut column, mut row) = (top, 0, 0.0_f64);
        let mut places = Vec::new();
        for entry in &self.legend {
            let lines = broken(entry);
            let sample = matches!(entry, Entry::Sample { .. });
            if column > 0 && (!sample || column == columns) {
                (y, column, row) = (y + row, 0, 0.0);
            }
            if matches!(entry, Entry::Heading(_)) && !places.is_empty() {
                y += 9.6 * larger;
            }
            let height = 20.0 * larger * lines.len().max(1) as f64;
            places.push(([left + column_width * f64::from(column), y], entry, lines));
            if sample {
                (column, row) = (column + 1, row.max(height));
            } else {
                y += height;
            }
        }
        (places, y + row)
    }

    /// Each entry with the place and the lines of its text.
    fn column(&self, [left, top]: [f64; 2]) -> Vec<Place<'_>> {
        let mut y = top;
        let mut places: Vec<Place<'_>> = Vec::new();
        for entry in &self.legend {
            y += match (entry, places.last()) {
                (_, None) => 0.0,
                (Entry::Heading(_), _) => 40.0,
                (Entry::Note(_), Some((_, Entry::Note(_), _))) => 17.0,
                (Entry::Note(_), _) => 20.0,
                (Entry::Sample { .. }, _) => 24.0,
            };
            let text = match entry {
                Entry::Heading(text) | Entry::Note(text) => vec![text.clone()],
                Entry::Sample { label, .. } => lines(label),
            };
            let more = text.len() - 1;
            places.push(([left, y], entry, text));
            y += 17.0 * more as f64;
        }
        places
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

/// An entry of the legend, with the place and the lines of its text.
type Place<'a> = ([f64; 2], &'a Entry, Vec<String>);

/// Draws the entries in type `larger` than usual; samples stand `up` of the base line, lines are `apart`.
fn draw_legend(canvas: &mut Canvas, places: &[Place<'_>], larger: f64, [up, apart]: [f64; 2]) {
    for &([x, y], entry, ref lines) in places {
        let (x, style) = match entry {
            Entry::Heading(_) => (x, bold(13.0 * larger)),
            Entry::Note(_) => (x, style(12.0 * larger, SOFT, Anchor::Start)),
            Entry::Sample { look, line, marker, .. } => {
                draw_sample(canvas, [x, y - up], look, *line, *marker);
                (x + SAMPLE, style(13.0 * larger, INK, Anchor::Start))
            }
        };
        for (k, line) in lines.iter().enumerate() {
            canvas.text([x, y + apart * k as f64], style, line);
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
