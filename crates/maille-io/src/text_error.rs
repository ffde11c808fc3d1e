//! What is wrong with a text that a person wrote: a study, targets.

use crate::design_toml::line_column;
use miette::{Diagnostic, NamedSource, SourceSpan};
use std::{ops::Range, sync::Arc};
use thiserror::Error;

/// What is wrong, shown at its place in the text.
#[derive(Debug, Error, Diagnostic)]
#[error("{problem}")]
pub struct TextError {
    #[source_code]
    source_code: Arc<NamedSource<String>>,
    problem: String,
    #[help]
    help: String,
    #[label]
    span: SourceSpan,
}

impl TextError {
    /// An error at the bytes `span` of `text`, which is called `name`.
    pub(crate) fn new(name: &str, text: &str, span: Range<usize>, problem: String, help: String) -> Self {
        let source_code = Arc::new(NamedSource::new(name, text.to_owned()));
        TextError { source_code, problem, help, span: span.into() }
    }

    /// Line and column of the place, from 1.
    pub fn line_column(&self) -> (usize, usize) {
        line_column(self.source_code.inner(), self.span.offset()).unwrap_or((1, 1))
    }

    /// What would be right.
    pub fn help_text(&self) -> &str {
        &self.help
    }

    /// The text at the place.
    #[cfg(test)]
    pub(crate) fn at(&self) -> &str {
        &self.source_code.inner()[self.span.offset()..self.span.offset() + self.span.len()]
    }
}
