//! Plots of records, as SVG and PNG.

mod canvas;
mod curve;
mod palette;
mod png;
mod polar;
mod scale;

pub use curve::{Curve, CurveKind};
pub use png::{PlotError, svg_to_png};
pub use polar::{PolarPlot, Quantity, polar_svg};
