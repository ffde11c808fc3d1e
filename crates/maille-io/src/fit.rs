//! Fits: what is asked of one as files and front ends have it, and its record.

mod free;
mod record;
mod request;
mod targets;

pub use free::{Bounds, FreeSpec, free_numbers};
pub use record::{FIT, FitOutcome, FitRecord, FittedTarget, document, open_fit, target_rows};
pub use request::{FitRequest, fitted_design};
pub use targets::read_targets;
