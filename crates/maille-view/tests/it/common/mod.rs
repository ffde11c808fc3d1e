//! What tests of the server begin with.

use maille_io::builtin;
use maille_view::Opened;
use std::collections::BTreeMap;

/// A built-in design, opened.
pub fn opened() -> Opened {
    Opened {
        name: "1.1".into(),
        file: None,
        text: builtin("1.1").unwrap().into(),
        parameters: BTreeMap::new(),
        record: None,
    }
}
