//! What is wrong with a text that a person wrote: a study, targets.

use crate::design_toml::line_column;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode, SourceSpan};
use std::{fmt, iter, ops::Range, sync::Arc};
use thiserror::Error;

/// What is wrong, shown at its place in the text.
#[derive(Debug, Error)]
#[error("{problem}")]
pub struct TextError {
    source_code: Arc<NamedSource<String>>,
    problem: String,
    help: String,
    span: SourceSpan,
}

impl Diagnostic for TextError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source_code)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(iter::once(LabeledSpan::new_with_span(None, self.span))))
    }
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
