//! All tests of this crate that use it from outside, in one program.

mod api;
mod common;
mod records;
mod types;
