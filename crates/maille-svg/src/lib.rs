//! Figures as files: SVG to PNG and PDF. Texts become outlines of letters that are part of this crate.
//!
//! | file | content |
//! | --- | --- |
//! | `letters.rs` | texts as outlines |
//! | `png.rs` | PNG, and PNG of 256 colours |
//! | `pdf.rs` | PDF of lines and areas |

mod letters;
mod pdf;
mod png;

pub use pdf::{outlined_svg, svg_to_pdf};
pub use png::{COLOURS, PlotError, SAMPLE, svg_to_png, with_palette};

/// The title of an SVG, as it was given.
fn title_of(svg: &str) -> String {
    let title =
        svg.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>")).map_or("", |(title, _)| title);
    title.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}
