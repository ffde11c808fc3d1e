//! SVG to PNG, with the fonts that come with the program.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};
use std::sync::{Arc, OnceLock};
use thiserror::Error;

const REGULAR: &[u8] = include_bytes!("../../fonts/DejaVuSans-subset.ttf");
const BOLD: &[u8] = include_bytes!("../../fonts/DejaVuSans-Bold-subset.ttf");

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
    /// The pixels could not be written as PNG.
    #[error("the picture cannot be written as PNG: {0}")]
    Encode(String),
}

/// Draws an SVG; `scale` is the number of pixels per unit of the SVG (2 for screens and print).
///
/// Uses only the embedded fonts: the same SVG gives the same pixels on every machine.
pub fn svg_to_png(svg: &str, scale: f32) -> Result<Vec<u8>, PlotError> {
    let options = Options { font_family: "DejaVu Sans".into(), fontdb: fonts(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|e| PlotError::Svg(e.to_string()))?;
    let (width, height) = (tree.size().width(), tree.size().height());
    let pixels = |length: f32| (length * scale).round() as u32;
    let pixmap = (scale > 0.0).then(|| Pixmap::new(pixels(width), pixels(height))).flatten();
    let mut pixmap = pixmap.ok_or(PlotError::Size { width, height, scale })?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|e| PlotError::Encode(e.to_string()))
}

fn fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let load = || {
        let mut fonts = Database::new();
        fonts.load_font_data(REGULAR.to_vec());
        fonts.load_font_data(BOLD.to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}
