//! SVG to PDF: lines and areas stay what they are, and letters are outlines, so that a reader needs no font.

use crate::png::{PlotError, tree};
use crate::title_of;
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::{
    Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr,
    types::{LineCapStyle, LineJoinStyle},
};
use resvg::{
    tiny_skia::{PathSegment, Transform},
    usvg::{
        Color, Fill, FillRule, Group, Indent, LineCap, LineJoin, Node, Paint, PaintOrder, Path, Stroke, WriteOptions,
    },
};
use std::io::Write;

/// Points (1/72 inch) of an SVG's pixel (1/96 inch).
const POINTS: f32 = 0.75;

/// A PDF of one page, as large as the SVG.
pub fn svg_to_pdf(svg: &str) -> Result<Vec<u8>, PlotError> {
    let tree = tree(svg)?;
    let [width, height] = [tree.size().width(), tree.size().height()].map(|length| POINTS * length);
    let mut page = Page { content: Content::new(), opacities: Vec::new() };
    page.content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height]);
    page.group(tree.root())?;

    let [catalog, pages, only, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([only]).count(1);
    let mut of_page = pdf.page(only);
    of_page.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
    let mut resources = of_page.resources();
    let mut states = resources.ext_g_states();
    for (k, [fill, stroke]) in page.opacities.iter().enumerate() {
        let mut state = states.insert(Name(name(k).as_bytes())).start::<pdf_writer::writers::ExtGraphicsState<'_>>();
        state.non_stroking_alpha(*fill).stroking_alpha(*stroke);
    }
    states.finish();
    resources.finish();
    of_page.finish();
    let fail = |e: std::io::Error| PlotError::Encode(e.to_string());
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&page.content.finish()).map_err(fail)?;
    pdf.stream(content, &encoder.finish().map_err(fail)?).filter(Filter::FlateDecode);
    pdf.document_info(info).title(TextStr(&title_of(svg))).producer(TextStr("maille"));
    Ok(pdf.finish())
}

/// The same picture as an SVG whose letters are outlines.
pub fn outlined_svg(svg: &str) -> Result<String, PlotError> {
    let tree = tree(svg)?;
    let outlined = tree.to_string(&WriteOptions { indent: Indent::None, ..WriteOptions::default() });
    let (_, drawn) = outlined.split_once('>').ok_or_else(|| PlotError::Svg("no element".into()))?;
    // The tree is in pixels, and has no title: both sizes and the title are as they were.
    let view = format!("viewBox=\"0 0 {} {}\"", tree.size().width(), tree.size().height());
    let (head, rest) = svg.split_once(" viewBox=").unwrap_or((svg, ""));
    let title = rest.lines().find(|line| line.starts_with("<title>")).unwrap_or_default();
    Ok(format!("{head} {view} role=\"img\">\n{title}{drawn}"))
}

/// Name of the k-th pair of opacities.
fn name(k: usize) -> String {
    format!("a{k}")
}

/// The content of the page, and the opacities of fills and strokes that it needs.
struct Page {
    content: Content,
    opacities: Vec<[f32; 2]>,
}

impl Page {
    fn group(&mut self, group: &Group) -> Result<(), PlotError> {
        if group.should_isolate() {
            return Err(PlotError::Pdf("a group with an effect of its own"));
        }
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group)?,
                Node::Path(path) if path.is_visible() => self.path(path)?,
                Node::Path(_) => (),
                Node::Text(_) => return Err(PlotError::Pdf("a text that is no outline")),
                Node::Image(_) => return Err(PlotError::Pdf("a picture of pixels")),
            }
        }
        Ok(())
    }

    fn path(&mut self, path: &Path) -> Result<(), PlotError> {
        let opacity =
            [path.fill().map_or(1.0, |fill| fill.opacity().get()), path.stroke().map_or(1.0, |s| s.opacity().get())];
        let known = self.opacities.iter().position(|known| *known == opacity);
        let state = known.unwrap_or_else(|| {
            self.opacities.push(opacity);
            self.opacities.len() - 1
        });
        self.content.save_state();
        self.content.set_parameters(Name(name(state).as_bytes()));
        let Transform { sx, ky, kx, sy, tx, ty } = path.abs_transform();
        self.content.transform([sx, ky, kx, sy, tx, ty]);
        let fill_first = path.paint_order() == PaintOrder::FillAndStroke;
        for filled in [fill_first, !fill_first] {
            match (filled, path.fill(), path.stroke()) {
                (true, Some(fill), _) => self.fill(path, fill)?,
                (false, _, Some(stroke)) => self.stroke(path, stroke)?,
                _ => (),
            }
        }
        self.content.restore_state();
        Ok(())
    }

    fn fill(&mut self, path: &Path, fill: &Fill) -> Result<(), PlotError> {
        let [r, g, b] = color(fill.paint())?;
        self.content.set_fill_rgb(r, g, b);
        self.outline(path);
        match fill.rule() {
            FillRule::NonZero => self.content.fill_nonzero(),
            FillRule::EvenOdd => self.content.fill_even_odd(),
        };
        Ok(())
    }

    fn stroke(&mut self, path: &Path, stroke: &Stroke) -> Result<(), PlotError> {
        let [r, g, b] = color(stroke.paint())?;
        self.content.set_stroke_rgb(r, g, b);
        self.content.set_line_width(stroke.width().get());
        self.content.set_line_cap(match stroke.linecap() {
            LineCap::Butt => LineCapStyle::ButtCap,
            LineCap::Round => LineCapStyle::RoundCap,
            LineCap::Square => LineCapStyle::ProjectingSquareCap,
        });
        self.content.set_line_join(match stroke.linejoin() {
            LineJoin::Round => LineJoinStyle::RoundJoin,
            LineJoin::Bevel => LineJoinStyle::BevelJoin,
            LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
        });
        let dashes = stroke.dasharray().unwrap_or_default();
        self.content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
        self.outline(path);
        self.content.stroke();
        Ok(())
    }

    fn outline(&mut self, path: &Path) {
        let mut at = [0.0; 2];
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(p) => {
                    self.content.move_to(p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::LineTo(p) => {
                    self.content.line_to(p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::QuadTo(q, p) => {
                    let toward = |from: f32, by: f32| from + 2.0 / 3.0 * (by - from);
                    let (from, to) = ([toward(at[0], q.x), toward(at[1], q.y)], [toward(p.x, q.x), toward(p.y, q.y)]);
                    self.content.cubic_to(from[0], from[1], to[0], to[1], p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::CubicTo(q, r, p) => {
                    self.content.cubic_to(q.x, q.y, r.x, r.y, p.x, p.y);
                    at = [p.x, p.y];
                }
                PathSegment::Close => {
                    self.content.close_path();
                }
            }
        }
    }
}

fn color(paint: &Paint) -> Result<[f32; 3], PlotError> {
    match paint {
        Paint::Color(Color { red, green, blue }) => Ok([*red, *green, *blue].map(|x| f32::from(x) / 255.0)),
        _ => Err(PlotError::Pdf("a colour that is not uniform")),
    }
}
