//! All tests of this crate that use it from outside, in one program.

mod adversarial;
mod batch;
mod biarcs;
mod common;
mod completeness;
mod degenerate;
mod invariance;
mod linking;
mod pieces;
mod polynomial;
