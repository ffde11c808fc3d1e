//! Plots of records, as SVG and PNG. Each kind is a file.

mod boundary;
mod canvas;
mod chart;
mod compare;
mod curve;
mod difference;
mod effort;
mod force;
mod frame;
mod look;
mod palette;
mod png;
mod poisson;
mod polar;
mod run;
mod scale;
mod steps;
mod times;

pub use boundary::boundary_svg;
pub use compare::parameter_words;
pub use curve::{Curve, CurveKind};
pub use difference::{Spread, difference_svg};
pub use force::{NamedSimulation, force_svg};
pub use frame::Layout;
pub use png::{PlotError, svg_to_png};
pub use poisson::poisson_svg;
pub use polar::{PolarPlot, Quantity, Ray, RayKind, polar_svg};
pub use run::{OfStep, run_svg};
pub use steps::steps_svg;
pub use times::times_svg;
