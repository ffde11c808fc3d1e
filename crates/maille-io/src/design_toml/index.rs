//! Where each field stands in the file.

use super::fields;
use miette::LabeledSpan;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Byte ranges of the values by path: `elements[2].rings[0].normal`. The default knows no place, for a text that is no TOML.
#[derive(Default)]
pub(super) struct Index {
    places: BTreeMap<String, Range<usize>>,
    /// Start of the line of the first key: where a missing top-level key would stand.
    pub first_line: usize,
    /// Start of the last line: a missing table would stand below.
    pub last_line: usize,
}

impl Index {
    pub(super) fn new(table: &DeTable<'_>, text: &str) -> Self {
        let mut places = BTreeMap::new();
        add_table(table, "", &mut places);
        let first = table.iter().map(|(key, value)| key.span().start.min(value.span().start)).min();
        // The key of [table] starts after its bracket: go back to the start of the line.
        let first_line = first.map_or(text.len(), |at| text[..at].rfind('\n').map_or(0, |i| i + 1));
        let last_line = text.trim_end().rfind('\n').map_or(0, |i| i + 1);
        Self { places, first_line, last_line }
    }

    /// The value itself, if the file contains it.
    pub(super) fn exact(&self, path: &str) -> Option<Range<usize>> {
        self.places.get(path).cloned()
    }

    /// Where to point for a path: the value itself, the nearest parent that the file contains, or where a key of the top
    /// would stand. None for what is no field of a design file.
    pub(super) fn find(&self, path: &str) -> Option<LabeledSpan> {
        if let Some(span) = self.exact(path) {
            return Some(LabeledSpan::new_with_span(None, span));
        }
        let mut parent = path;
        while let Some(cut) = parent.rfind(['.', '[']) {
            parent = &parent[..cut];
            if let Some(span) = self.exact(parent) {
                return Some(LabeledSpan::new_with_span(Some("in here".into()), span));
            }
        }
        let top = || LabeledSpan::new(Some(format!("`{path}` belongs here")), self.first_line, 0);
        fields::TOP.contains(&parent).then(top)
    }
}

fn add(value: &Spanned<DeValue<'_>>, path: &str, places: &mut BTreeMap<String, Range<usize>>) {
    places.insert(path.to_owned(), value.span());
    match value.get_ref() {
        DeValue::Table(table) => add_table(table, path, places),
        DeValue::Array(array) => {
            for (i, item) in array.iter().enumerate() {
                add(item, &format!("{path}[{i}]"), places);
            }
        }
        _ => {}
    }
}

fn add_table(table: &DeTable<'_>, path: &str, places: &mut BTreeMap<String, Range<usize>>) {
    for (key, value) in table {
        let path = if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
        add(value, &path, places);
    }
}
