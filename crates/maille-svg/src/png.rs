//! SVG to PNG, and PNG of 256 colours.

use crate::{letters, title_of};
use color_quant::NeuQuant;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::io::Cursor;
use thiserror::Error;

/// A picture that cannot be drawn.
#[derive(Debug, Error)]
pub enum PlotError {
    /// The text is no SVG.
    #[error("not an SVG: {0}")]
    Svg(String),
    /// The picture would have no pixels, or too many.
    #[error("a picture of {width} × {height} at scale {scale} cannot be drawn")]
    Size {
        /// Width of the SVG.
        width: f32,
        /// Height of the SVG.
        height: f32,
        /// Pixels per unit.
        scale: f32,
    },
    /// The pixels could not be written as PNG, or the page as PDF.
    #[error("the picture cannot be written: {0}")]
    Encode(String),
    /// The SVG has something that a PDF of lines and areas has not.
    #[error("the picture cannot be written as PDF: it has {0}")]
    Pdf(&'static str),
}

/// Draws an SVG; `scale` is the number of pixels per unit of the SVG (2 for screens and print).
///
/// Letters are those that come with the program: the same SVG gives the same pixels on every machine.
pub fn svg_to_png(svg: &str, scale: f32) -> Result<Vec<u8>, PlotError> {
    let tree = tree(svg)?;
    let (width, height) = (tree.size().width(), tree.size().height());
    let pixels = |length: f32| (length * scale).round() as u32;
    let pixmap = (scale > 0.0).then(|| Pixmap::new(pixels(width), pixels(height))).flatten();
    let mut pixmap = pixmap.ok_or(PlotError::Size { width, height, scale })?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    encoded(pixmap, &title_of(svg)).map_err(|e| PlotError::Encode(e.to_string()))
}

/// The pixels as PNG, with the title as a text.
///
/// Areas of one colour are smaller without a filter, and the fastest deflate is enough for them: a third of the time of
/// the usual settings, for a file of the same size.
fn encoded(pixmap: Pixmap, title: &str) -> Result<Vec<u8>, png::EncodingError> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_deflate_compression(png::DeflateCompression::Level(1));
    encoder.set_filter(png::Filter::NoFilter);
    if !title.is_empty() {
        encoder.add_itxt_chunk("Title".to_owned(), title.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixmap.take_demultiplied())?;
    writer.finish()?;
    Ok(out)
}

/// The SVG, its letters as outlines.
pub(crate) fn tree(svg: &str) -> Result<Tree, PlotError> {
    let outlined = letters::outlined(svg).map_err(|e| PlotError::Svg(e.to_string()))?;
    Tree::from_str(&outlined, &Options::default()).map_err(|e| PlotError::Svg(e.to_string()))
}

/// Pixels that a palette is trained on: all of them. It takes longer for large pictures, and is always the same.
pub const SAMPLE: i32 = 1;
/// Colours of a palette.
pub const COLOURS: usize = 256;

/// The picture in a PNG of 8 bits a channel as a PNG of 256 colours, chosen for it.
pub fn with_palette(png: &[u8]) -> Result<Vec<u8>, PlotError> {
    let fail = |e: &dyn std::fmt::Display| PlotError::Encode(e.to_string());
    let pixmap = Pixmap::decode_png(png).map_err(|e| fail(&e))?;
    let straight = pixmap.pixels().iter().map(|p| p.demultiply());
    let rgba: Vec<u8> = straight.flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect();
    let palette = NeuQuant::new(SAMPLE, COLOURS, &rgba);
    let mut colours = palette.color_map_rgba();
    let mut indices: Vec<u8> = rgba.chunks_exact(4).map(|pixel| palette.index_of(pixel) as u8).collect();
    // The ground stays as it was to the last bit: next to other pictures a shade would show.
    let ground = [rgba[0], rgba[1], rgba[2], rgba[3]];
    let at = usize::from(indices[0]);
    colours[4 * at..4 * at + 4].copy_from_slice(&ground);
    for (index, pixel) in indices.iter_mut().zip(rgba.chunks_exact(4)) {
        if pixel == ground {
            *index = at as u8;
        }
    }

    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(colours.chunks_exact(4).flat_map(|c| [c[0], c[1], c[2]]).collect::<Vec<u8>>());
    // A palette that was trained on opaque pixels alone has alphas of 254 too: rounding.
    if rgba.chunks_exact(4).any(|pixel| pixel[3] < u8::MAX) {
        encoder.set_trns(colours.chunks_exact(4).map(|c| c[3]).collect::<Vec<u8>>());
    }
    let texts = png::Decoder::new(Cursor::new(png)).read_info().map_err(|e| fail(&e))?.info().utf8_text.clone();
    for text in texts {
        let words = text.get_text().map_err(|e| fail(&e))?;
        encoder.add_itxt_chunk(text.keyword, words).map_err(|e| fail(&e))?;
    }
    let mut writer = encoder.write_header().map_err(|e| fail(&e))?;
    writer.write_image_data(&indices).map_err(|e| fail(&e))?;
    writer.finish().map_err(|e| fail(&e))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_the_title_of_its_svg() {
        let size = "width=\"8\" height=\"6\" viewBox=\"0 0 8 6\"";
        let svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {size}>\n<title>1.1 &amp; l₂</title>\n</svg>");
        let png = svg_to_png(&svg, 2.0).unwrap();
        for png in [with_palette(&png).unwrap(), png] {
            let reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
            let texts = &reader.info().utf8_text;
            assert_eq!((texts.len(), reader.info().width), (1, 16));
            assert_eq!((texts[0].keyword.as_str(), texts[0].get_text().unwrap()), ("Title", "1.1 & l₂".to_owned()));
        }
    }
}
