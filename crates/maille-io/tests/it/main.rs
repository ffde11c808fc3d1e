//! All tests of this crate that use it from outside, in one program.

mod common;
mod design_files;
mod errors;
mod fit;
mod parameters;
#[cfg(feature = "plot")]
mod plots;
mod records;
mod schema;
mod table_foreign;
mod tables;
mod weaves;
