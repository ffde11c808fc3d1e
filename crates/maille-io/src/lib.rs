//! Formats of maille: design files, studies, records, tables, plots, meshes, pictures, the report on the thesis.
//!
//! Everything here works on text, bytes and readers; only doors open paths. The one exception is
//! [`record::RecordFolder`], which owns a folder because its writes must be atomic.

pub mod answer;
pub mod boundary;
pub mod builtin;
pub mod design_toml;
pub mod files;
pub mod mesh;
mod nearest;
pub mod numbers;
mod palette;
pub mod plot;
pub mod record;
pub mod render;
pub mod report;
pub mod run;
pub mod study;
pub mod table;
pub mod weave;

pub use builtin::{Builtin, builtin, builtin_designs, chapter6, nearest_builtin};
pub use design_toml::{
    DESIGN_JSON_SCHEMA, DesignError, DesignProblem, DesignSource, ListedProblem, NumberPath, read_design, write_design,
};
pub use palette::{film, with_palette};
