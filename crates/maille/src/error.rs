//! What can be wrong with the input of the mechanics.

use thiserror::Error;

/// A design or a parameter that cannot be used.
///
/// `field` is the path in the design, as in `elements[2].rings[0].normal`, so that a reader can point at the line.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field}: {problem}")]
pub struct InvalidInput {
    /// Path of the field: `lattice.a1`, `elements[2].rings[0].normal`, or an option's name.
    pub field: String,
    /// What is wrong, with the value.
    pub problem: String,
    /// What would be right.
    pub help: String,
}

impl InvalidInput {
    /// An error at `field`.
    pub fn new(field: impl Into<String>, problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self { field: field.into(), problem: problem.into(), help: help.into() }
    }
}
