//! The search for a proof that no state of a cell of two rings has a larger l1: branch and bound over boxes of poses.
//!
//! Nothing here is trusted. What is chosen here (where a box is split, which inequalities contradict each other, with which
//! weights) is written into the proof, and `maille_verify::proof` checks it with outward rounding.

mod choose;
mod nearest;
mod program;
mod search;

pub use search::{Options, Outcome, Progress, search};
