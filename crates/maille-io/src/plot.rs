//! Plots of records, as SVG. Each kind is a file.

mod boundary;
mod canvas;
mod chart;
mod clip;
mod compare;
mod curve;
mod difference;
mod effort;
mod force;
mod frame;
mod look;
mod outcome;
mod palette;
mod poisson;
mod polar;
mod radius;
mod records;
mod run;
mod scale;
mod tolerance;

pub use boundary::boundary_svg;
pub use compare::parameter_words;
pub use curve::{Curve, CurveKind};
pub use difference::difference_svg;
pub use effort::{Cost, cost_svg};
pub use force::{NamedSimulation, force_svg};
pub use frame::{Layout, Paper};
pub use poisson::poisson_svg;
pub use polar::{PolarPlot, Ray, RayKind, polar_svg, roll_svg};
pub use radius::radius_svg;
pub use run::{OfStep, run_svg};
pub use tolerance::{Band, Tolerance};
