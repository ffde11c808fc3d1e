//! Answers by search: limits of stretches by the thesis's energy method or by the exact one, extremes of strains, of the wire and
//! of the clearance, and the surface of all strains.

pub mod boundary;
pub mod energy;
pub mod extreme;
mod local;
mod multistart;
mod options;
mod overlap;
pub mod sphere;
pub mod strain;
pub mod stretch;
mod stretch_lattices;
mod unlinked;

pub use options::{ExactOptions, ExactParameters};
