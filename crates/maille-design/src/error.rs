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

/// The word of `known` that `word` was probably meant to be: by the number of letters that differ.
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let distance = |k: &str| {
        let contained = word.len() >= 4 && (k.contains(&word) || word.contains(k));
        if contained { 1 } else { strsim::damerau_levenshtein(&word, k) }
    };
    let best = known.iter().copied().min_by_key(|k| distance(k))?;
    (distance(best) <= 1 + word.chars().count() / 4).then_some(best)
}
