//! All tests of this crate that use it from outside, in one program.

#[path = "../../../maille-io/tests/it/common/foreign.rs"]
mod programs;

mod foreign;
mod mesh;
