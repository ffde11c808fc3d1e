//! Where each field stands in the file.

use super::fields;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Byte ranges of the values by path: `elements[2].rings[0].normal`.
pub(super) struct Index {
    places: BTreeMap<String, Range<usize>>,
    first: usize,
    last: usize,
}

/// Where to point for a path.
pub(super) enum Place {
    /// The value itself.
    Exact(Range<usize>),
    /// The nearest parent that the file contains.
    Parent(Range<usize>),
    /// A key of the top of the file that is not there: where it would stand.
    Top(Range<usize>),
    /// No field of a design file.
    None,
}

impl Index {
    /// An index that knows no place, for a text that is no TOML.
    pub(super) fn empty() -> Self {
        Self { places: BTreeMap::new(), first: 0, last: 0 }
    }

    pub(super) fn new(table: &DeTable<'_>, text: &str) -> Self {
        let mut places = BTreeMap::new();
        add_table(table, "", &mut places);
        let first = table.iter().map(|(key, value)| key.span().start.min(value.span().start)).min();
        // The key of [table] starts after its bracket: go back to the start of the line.
        let first = first.map_or(text.len(), |at| text[..at].rfind('\n').map_or(0, |i| i + 1));
        let last = text.trim_end().rfind('\n').map_or(0, |i| i + 1);
        Self { places, first, last }
    }

    /// Start of the line of the first key: where a missing top-level key would stand.
    pub(super) fn first_line(&self) -> usize {
        self.first
    }

    /// Start of the last line: a missing table would stand below.
    pub(super) fn last_line(&self) -> usize {
        self.last
    }

    pub(super) fn find(&self, path: &str) -> Place {
        if let Some(range) = self.places.get(path) {
            return Place::Exact(range.clone());
        }
        let mut path = path;
        while let Some(cut) = path.rfind(['.', '[']) {
            path = &path[..cut];
            if let Some(range) = self.places.get(path) {
                return Place::Parent(range.clone());
            }
        }
        if fields::TOP.contains(&path) { Place::Top(self.first..self.first) } else { Place::None }
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
