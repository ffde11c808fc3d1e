//! Chapter 6 of the thesis computed anew: which maps it needs, its statements beside what records say, its figures, and
//! one page with both.
//!
//! [`plan`] lists the maps, [`report`] makes all files from their records. Nothing here solves or opens files.

mod figures;
mod map;
mod page;
mod plan;
mod report;
mod statements;

pub use map::{MINIMA, Map, SCALED, STEPS};
pub use plan::{Chosen, DESIGNS, MINIMA_DEG, NOTCHED, Planned, plan};
pub use report::{Report, ReportError, report};
pub use statements::{Finding, Part, Verdict, statements};
