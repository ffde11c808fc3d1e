//! Every wrong design of `tests/errors/` gives the text that lies beside it. `MAILLE_BLESS=1` writes the texts anew.

use maille::error::InvalidInput;
use maille_io::{DesignSource, builtin, read_design, report::Drawing};
use miette::Diagnostic;
use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/errors")
}

fn render(error: &dyn Diagnostic) -> String {
    let out = Drawing { unicode: false, colours: false }.draw(error);
    let lines: Vec<_> = out.lines().map(str::trim_end).collect();
    lines.join("\n").trim_matches('\n').to_owned() + "\n"
}

fn matches(name: &str, text: &str) -> bool {
    let path = folder().join(name);
    if std::env::var_os("MAILLE_BLESS").is_some() {
        fs::write(&path, text).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    if expected != text {
        eprintln!("--- {name}: expected\n{expected}--- found\n{text}");
    }
    expected == text
}

#[test]
fn wrong_designs_say_what_is_wrong() {
    let mut names: Vec<_> =
        fs::read_dir(folder()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| name.ends_with(".toml"));
    names.sort();
    assert!(names.len() >= 40);
    let mut right = true;
    for name in &names {
        let text = fs::read_to_string(folder().join(name)).unwrap();
        match read_design(name, &text) {
            Err(error) => right &= matches(&name.replace(".toml", ".txt"), &render(&error)),
            Ok(_) => panic!("{name} was read without an error"),
        }
    }
    assert!(right, "texts differ; if the new ones are better, run again with MAILLE_BLESS=1");
}

#[test]
fn later_problems_find_their_place() {
    let source = DesignSource::new("1.1", builtin("1.1").unwrap());
    let overlap = InvalidInput::new(
        "elements[1]",
        "overlaps elements[0] by 0.14 in the starting state",
        "move them apart, or set allow_initial_overlap = true at the top of the file",
    );
    let of_a_default = InvalidInput::new("elements[2].rings[0].offset", "is not used", "");
    let of_no_field = InvalidInput::new("--l2", "0.9 is too large", "stay below 0.5");
    assert!(matches("later-overlap.txt", &render(&source.explain(std::slice::from_ref(&overlap)))));
    assert!(matches("later-option.txt", &render(&source.explain(std::slice::from_ref(&of_no_field)))));

    let error = source.explain(&[overlap, of_a_default, of_no_field]);
    let places: Vec<_> = error.problems().iter().map(|p| (p.field().to_owned(), error.line_column(p))).collect();
    assert_eq!(
        places,
        [
            ("--l2".to_owned(), None),
            ("elements[1]".to_owned(), Some((21, 1))),
            ("elements[2].rings[0].offset".to_owned(), Some((29, 10))),
        ]
    );
}
