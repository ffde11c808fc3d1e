//! Formats of maille: design files, studies, records, tables, plots; and maps from a design to its record.
//!
//! Nearly everything here works on text, bytes and readers: front ends open paths. The exceptions are the folders of records and
//! of surfaces, whose writes must be atomic, and [`files`].

pub mod answer;
pub mod boundary;
pub mod builtin;
pub mod design_toml;
pub mod files;
pub mod fit;
mod nearest;
pub mod numbers;
#[cfg(feature = "plot")]
pub mod plot;
mod quantity;
pub mod record;
pub mod report;
pub mod roll;
pub mod run;
pub mod sensitivity;
pub mod study;
pub mod table;
mod text_error;
mod tile;
mod unit;
pub mod weave;

pub use builtin::{Builtin, builtin, builtin_designs, chapter6, nearest_builtin};
pub use design_toml::{
    DESIGN_JSON_SCHEMA, DesignError, DesignProblem, DesignSource, ListedProblem, NumberPath, read_design,
    set_parameters, write_design,
};
pub use quantity::Quantity;
pub use text_error::TextError;
pub use tile::Tile;
pub use unit::millimetres;

/// The README's example is run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
