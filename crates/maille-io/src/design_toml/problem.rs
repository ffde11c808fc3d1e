//! What is wrong with a design file, and where.

use super::index::Index;
use super::syntax;
use maille::error::InvalidInput;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

/// One thing that is wrong with a design file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{field}{}{problem}", if field.is_empty() { "" } else { ": " })]
pub struct DesignProblem {
    field: String,
    problem: String,
    help: String,
    place: Option<LabeledSpan>,
}

impl Diagnostic for DesignProblem {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.help))
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.place.iter().cloned()))
    }
}

impl DesignProblem {
    pub(super) fn new(field: &str, problem: impl Into<String>, help: impl Into<String>, span: Range<usize>) -> Self {
        let place = Some(LabeledSpan::new_with_span(None, span));
        Self { field: field.into(), problem: problem.into(), help: help.into(), place }
    }

    /// A field that is not there: `span` is where it would stand, `place` how to say so.
    pub(super) fn missing(field: &str, help: &str, span: Range<usize>, place: &str) -> Self {
        let key = field.rsplit('.').next().unwrap_or(field);
        let place = Some(LabeledSpan::new_with_span(Some(format!("`{key}` {place}")), span.clone()));
        Self { place, ..Self::new(field, "is missing", help, span) }
    }

    pub(super) fn syntax(error: &toml::de::Error, text: &str) -> Self {
        let span = error.span().unwrap_or_default();
        let (problem, help) = syntax::describe(error.message(), text, &span);
        Self::new("", problem, help, span)
    }

    pub(super) fn empty(text: &str) -> Self {
        let help = "give name, reference_radius, minor_radius, [lattice] and [[elements]]";
        Self::new("", "the file holds no design", help, 0..text.len())
    }

    pub(super) fn invalid(input: &InvalidInput, index: &Index) -> Self {
        let InvalidInput { field, problem, help } = input.clone();
        Self { place: index.find(&field), field, problem, help }
    }

    pub(super) fn start(&self) -> usize {
        self.place.as_ref().map_or(0, LabeledSpan::offset)
    }

    /// Path of the field, as `elements[2].rings[0].normal`; empty where the file is no TOML.
    pub fn field(&self) -> &str {
        &self.field
    }

    /// What would be right.
    pub fn help_text(&self) -> &str {
        &self.help
    }
}

/// Line and column, from 1, of a byte of a text; columns count characters.
pub(crate) fn line_column(text: &str, at: usize) -> Option<(usize, usize)> {
    let before = text.get(..at)?;
    let line = before.rsplit('\n').next().unwrap_or_default();
    Some((before.matches('\n').count() + 1, line.chars().count() + 1))
}

/// A problem as a list names it: for scripts and for editors.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListedProblem {
    /// Path of the field, as `elements[2].rings[0].normal`; none where the file is no TOML.
    pub field: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// What would be right.
    pub help: Option<String>,
    /// Line, from 1, where the file has a place for it.
    pub line: Option<usize>,
    /// Character in the line, from 1.
    pub column: Option<usize>,
}

/// Everything that is wrong with a design file.
///
/// Shown by miette: with one problem as that problem, with several as a list.
#[derive(Debug)]
pub struct DesignError {
    source: NamedSource<Arc<str>>,
    problems: Vec<DesignProblem>,
}

impl DesignError {
    pub(super) fn new(name: &str, text: Arc<str>, problems: Vec<DesignProblem>) -> Self {
        Self { source: NamedSource::new(name, text), problems }
    }

    /// The problems, in the order of the file.
    pub fn problems(&self) -> &[DesignProblem] {
        &self.problems
    }

    /// Line and column of a problem, from 1; columns count characters.
    pub fn line_column(&self, problem: &DesignProblem) -> Option<(usize, usize)> {
        line_column(self.source.inner(), problem.place.as_ref()?.offset())
    }

    /// The problems as a list, in the order of the file.
    pub fn list(&self) -> Vec<ListedProblem> {
        let one = |p: &DesignProblem| {
            let place = self.line_column(p);
            ListedProblem {
                field: Some(p.field.clone()).filter(|field| !field.is_empty()),
                problem: p.problem.clone(),
                help: Some(p.help.clone()),
                line: place.map(|(line, _)| line),
                column: place.map(|(_, column)| column),
            }
        };
        self.problems.iter().map(one).collect()
    }

    fn only(&self) -> Option<&DesignProblem> {
        match self.problems.as_slice() {
            [one] => Some(one),
            _ => None,
        }
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.only() {
            Some(one) => one.fmt(f),
            None => write!(f, "{} has {} problems", self.source.name(), self.problems.len()),
        }
    }
}

impl std::error::Error for DesignError {}

impl Diagnostic for DesignError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.only().and_then(Diagnostic::help)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.only().and_then(Diagnostic::labels)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let several = self.only().is_none();
        several.then(|| Box::new(self.problems.iter().map(|p| p as &dyn Diagnostic)) as _)
    }
}
