//! The report on chapter 6 of the thesis: its statements beside what records say, its figures, and one page with both.
//!
//! Everything is computed from records; nothing here solves.

mod figures;
mod map;
mod page;
mod statements;

pub use figures::{Figure, SheetError, figures, sheet_png};
pub use map::{MINIMA, Map, SCALED, STEPS};
pub use page::{Sheet, page};
pub use statements::{Finding, MINIMA_DEG, NOTCHED, Part, Verdict, statements};
