//! Design files: TOML to [`Design`] and back, with errors that point at the place.

mod fields;
mod index;
mod number;
mod problem;
mod read;
mod syntax;
mod write;

pub use number::{NumberPath, set_parameters};
pub(crate) use problem::line_column;
pub use problem::{DesignError, DesignProblem, ListedProblem};
pub use write::write_design;

use index::Index;
use maille::design::Design;
use maille::error::InvalidInput;
use std::sync::Arc;
use toml::de::DeTable;

/// JSON Schema of a design file, for editors; it takes what the reader takes, but for relations between fields.
pub const DESIGN_JSON_SCHEMA: &str = include_str!("../designs/schema.json");

/// The text of a design file with the name to show for it, so that errors can point into it.
///
/// ```
/// let source = maille_io::DesignSource::new("1.1", maille_io::builtin("1.1").unwrap());
/// let design = source.read().unwrap();
/// assert_eq!(design.elements.len(), 3);
/// ```
#[derive(Clone, Debug)]
pub struct DesignSource {
    name: String,
    text: Arc<str>,
}

impl DesignSource {
    /// The text of a design file; `name` (a path, `<stdin>`) is what errors show.
    pub fn new(name: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// The design, or everything that is wrong with the file.
    pub fn read(&self) -> Result<Design, DesignError> {
        let table = match DeTable::parse(&self.text) {
            Ok(table) => table.into_inner(),
            Err(error) => return Err(self.error(vec![DesignProblem::syntax(&error, &self.text)])),
        };
        if table.is_empty() {
            return Err(self.error(vec![DesignProblem::empty(&self.text)]));
        }
        let index = Index::new(&table, &self.text);
        let (design, mut problems) = read::design(&table, &self.text, &index);
        let invalid = design.iter().flat_map(Design::problems).map(|p| DesignProblem::invalid(&p, &index));
        problems.extend(invalid);
        match design {
            Some(design) if problems.is_empty() => Ok(design),
            _ => Err(self.error(problems)),
        }
    }

    /// The name that errors show.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text itself.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text with the value of `field` replaced by `value`, which is TOML; all else, comments too, stays as it is. The
    /// optional fields of a ring, `offset` and `minor_radius`, are added where they are absent, and a parameter keeps its bounds. None
    /// where the file does not contain another field.
    ///
    /// ```
    /// let source = maille_io::DesignSource::new("a", "name = \"a\" # mine\nminor_radius = 0.1");
    /// assert_eq!(source.with_value("minor_radius", "0.2").unwrap(), "name = \"a\" # mine\nminor_radius = 0.2");
    /// ```
    pub fn with_value(&self, field: &str, value: &str) -> Option<String> {
        let table = DeTable::parse(&self.text).ok()?;
        let index = Index::new(table.get_ref(), &self.text);
        let of_parameter = field.starts_with("parameters.").then(|| index.exact(&format!("{field}.value"))).flatten();
        if let Some(span) = of_parameter.or_else(|| index.exact(field)) {
            return Some([&self.text[..span.start], value, &self.text[span.end..]].concat());
        }
        let (ring, key) = field.rsplit_once('.').filter(|(_, key)| ["offset", "minor_radius"].contains(key))?;
        let after = index.exact(&format!("{ring}.normal"))?.end;
        let inline = self.text[index.exact(ring)?.start..].starts_with('{');
        let line_end = || self.text[after..].find('\n').map_or(self.text.len(), |at| after + at);
        let (at, before) = if inline { (after, ", ") } else { (line_end(), "\n") };
        Some(format!("{}{before}{key} = {value}{}", &self.text[..at], &self.text[at..]))
    }

    /// Attaches problems that were found later, as an overlap in the starting state, to their places in the file.
    ///
    /// A field that the file does not contain is shown at its nearest parent; one with no parent, without a place.
    pub fn explain(&self, problems: &[InvalidInput]) -> DesignError {
        let index =
            DeTable::parse(&self.text).map_or_else(|_| Index::default(), |t| Index::new(t.get_ref(), &self.text));
        self.error(problems.iter().map(|p| DesignProblem::invalid(p, &index)).collect())
    }

    fn error(&self, mut problems: Vec<DesignProblem>) -> DesignError {
        problems.sort_by_key(DesignProblem::start);
        DesignError::new(&self.name, self.text.clone(), problems)
    }
}

/// Reads a design file; `source_name` is what errors show.
pub fn read_design(source_name: &str, text: &str) -> Result<Design, DesignError> {
    DesignSource::new(source_name, text).read()
}
