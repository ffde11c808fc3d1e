//! How a figure looks and where it is written: `--style`, `--output` and what goes with them.

use crate::{
    exit::{self, wrong},
    numbers::positive,
    output::{self, say},
    units::parse_length,
};
use maille_io::plot::{Layout, Paper};
use maille_svg::{outlined_svg, svg_to_pdf, svg_to_png, with_palette};
use miette::{IntoDiagnostic, Result, WrapErr};
use std::path::{Path, PathBuf};

/// Options of a figure.
#[derive(clap::Args)]
pub struct FigureArgs {
    /// The file, .svg, .pdf or .png; may be given several times [default: maille-out/KIND-DESIGNS.svg and .png, in style
    /// paper .svg and .pdf]
    #[arg(long, short, alias = "out", value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    replace: output::Replace,
    /// Screen has a title above and what was computed below; paper is as wide as a printed column, has neither, and
    /// letters that are outlines
    #[arg(long, value_enum, default_value_t = Style::Screen)]
    style: Style,
    /// Width in style paper, as 89mm, 183mm or 3.5in [default: 89mm]
    #[arg(long, value_name = "LENGTH", value_parser = width)]
    width: Option<f64>,
    /// Size of the letters in style paper, in points [default: 7]
    #[arg(long, value_name = "POINTS", value_parser = positive)]
    font_size: Option<f64>,
    /// Pixels of a PNG for each unit of its SVG (screen: most are 860 units wide; paper: 1/96 inch) [default: 2, in
    /// style paper 6.25, which is 600 pixels an inch]
    #[arg(long, value_parser = positive)]
    scale: Option<f64>,
    /// A PNG of 256 colours, chosen for the figure: a third of the bytes, for web pages
    #[arg(long)]
    palette: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Style {
    /// With title, legend and notes
    Screen,
    /// For a printed column
    Paper,
}

/// In millimetres.
fn width(text: &str) -> Result<f64, String> {
    parse_length(text).map(|length| length.mm)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Svg,
    Pdf,
    Png,
}

/// Least width of a figure, in sizes of its letters: there has to be room for an axis and its labels.
const NARROWEST: f64 = 20.0;

impl FigureArgs {
    /// Where the legend stands and how large all is.
    pub fn layout(&self) -> Result<Layout> {
        if self.style == Style::Screen {
            let problem = match (self.width, self.font_size) {
                (Some(_), _) => "--width is that of --style paper",
                (_, Some(_)) => "--font-size is that of --style paper",
                _ => return Ok(Layout::Beside),
            };
            let help = "add --style paper; a PNG for the screen is made larger or smaller by --scale";
            return Err(wrong(exit::USAGE, problem, help));
        }
        let usual = Paper::default();
        let paper =
            Paper { width_mm: self.width.unwrap_or(usual.width_mm), font_pt: self.font_size.unwrap_or(usual.font_pt) };
        let least_mm = NARROWEST * paper.font_pt * 25.4 / 72.0;
        if paper.width_mm < least_mm {
            let problem =
                format!("a figure {} mm wide has no room for letters of {} points", paper.width_mm, paper.font_pt);
            return Err(wrong(exit::USAGE, problem, format!("take a --width of at least {least_mm:.0}mm")));
        }
        Ok(Layout::Paper(paper))
    }

    /// The formats of the files that are named; checked before anything is drawn.
    pub fn check(&self) -> Result<()> {
        self.output.iter().try_for_each(|file| format(file).and_then(|_| self.replace.check(file)))
    }

    /// Writes the figure to each file; if none is named, as `usual` with two endings.
    pub fn write(&self, svg: &str, usual: &str) -> Result<()> {
        let endings = if self.style == Style::Paper { ["svg", "pdf"] } else { ["svg", "png"] };
        let style = if self.style == Style::Paper { "-paper" } else { "" };
        let default = endings.map(|ending| PathBuf::from(format!("{usual}{style}.{ending}")));
        let files = if self.output.is_empty() { &default[..] } else { &self.output };
        files.iter().try_for_each(|file| self.replace.check(file))?;
        for file in files {
            let bytes = match (format(file)?, self.style) {
                (Format::Svg, Style::Screen) => Ok(svg.as_bytes().to_vec()),
                (Format::Svg, Style::Paper) => outlined_svg(svg).map(String::into_bytes),
                (Format::Pdf, _) => svg_to_pdf(svg),
                (Format::Png, style) => {
                    let scale = self.scale.unwrap_or(if style == Style::Paper { 6.25 } else { 2.0 });
                    let png = svg_to_png(svg, scale as f32);
                    if self.palette { png.and_then(|png| with_palette(&png)) } else { png }
                }
            };
            output::write(file, &bytes.into_diagnostic().wrap_err("cannot draw the plot")?)?;
            say!("{}", file.display());
        }
        Ok(())
    }
}

fn format(file: &Path) -> Result<Format> {
    let ending = file.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "svg" => Ok(Format::Svg),
        "pdf" => Ok(Format::Pdf),
        "png" => Ok(Format::Png),
        _ => Err(wrong(
            exit::USAGE,
            format!("the ending of {} is not a format of plots", file.display()),
            "call it .svg, .pdf or .png",
        )),
    }
}
