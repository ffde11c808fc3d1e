//! The commands that README and the guide show are those of the program.

use crate::Args;
use clap::Parser;
use std::{fs, path::Path};

/// Commands of code blocks, fenced or indented, each with its line: what follows `maille`, or `cargo run … --`.
///
/// In such a line, words after two spaces or `#` are a comment, and `|`, `>` and `&&` end a command.
fn commands(text: &str) -> Vec<(usize, Vec<String>)> {
    let mut out = Vec::new();
    let (mut fenced, mut before) = (false, String::new());
    for (index, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if fenced || line.starts_with("    ") {
            let whole = std::mem::take(&mut before) + line.trim();
            match whole.strip_suffix('\\') {
                Some(begun) => before = begun.to_string(),
                None => out.extend(pipeline(&whole).into_iter().map(|words| (index + 1, words))),
            }
        }
    }
    out
}

fn pipeline(line: &str) -> Vec<Vec<String>> {
    let mut commands = vec![Vec::new()];
    let (mut word, mut quote, mut blanks) = (None::<String>, None, 0);
    for c in line.chars().chain([' ']) {
        if quote == Some(c) {
            quote = None;
        } else if quote.is_some() {
            word.get_or_insert_default().push(c);
        } else if c == '\'' || c == '"' {
            quote = Some(c);
            word.get_or_insert_default();
        } else if c != ' ' {
            word.get_or_insert_default().push(c);
        } else if let Some(done) = word.take() {
            match done.as_str() {
                "#" => break,
                "|" | ">" | "&&" => commands.push(Vec::new()),
                _ => commands.last_mut().expect("one from the start").push(done),
            }
        }
        blanks = if c == ' ' { blanks + 1 } else { 0 };
        if blanks == 2 && quote.is_none() {
            break;
        }
    }
    commands
        .into_iter()
        .filter_map(|words| {
            let program = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
                ["maille", _, ..] => 0,
                ["cargo", "run", ..] => words.iter().position(|word| word == "--")?,
                _ => return None,
            };
            Some(words[program + 1..].to_vec())
        })
        .collect()
}

/// Whether a word stands for others, as `DESIGN` and `…` do.
fn is_placeholder(word: &str) -> bool {
    word.contains('…') || word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase())
}

#[test]
fn commands_of_the_documents_are_commands_of_the_program() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut documents = vec![root.join("README.md")];
    documents.extend(fs::read_dir(root.join("docs/guide")).unwrap().map(|entry| entry.unwrap().path()));
    documents.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    let mut wrong = Vec::new();
    for document in documents {
        let shown = commands(&fs::read_to_string(&document).unwrap());
        assert!(!shown.is_empty(), "{} shows no command", document.display());
        for (line, words) in shown.into_iter().filter(|(_, words)| !words.iter().any(|word| is_placeholder(word))) {
            if let Err(problem) = Args::try_parse_from(std::iter::once("maille".into()).chain(words)) {
                wrong.push(format!("{}:{line}: {problem}", document.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn commands_are_found_in_code_blocks() {
    let text = "maille prose\n\n    maille a 'b c'  a comment\n    cargo run --release -- d   # e\n    cargo xtask test\n\
        ```\nmaille f -o - | maille g -\nmaille h \\\n  i > j\n```\n`maille k`\n";
    let expected: [(usize, &[&str]); 5] =
        [(3, &["a", "b c"]), (4, &["d"]), (7, &["f", "-o", "-"]), (7, &["g", "-"]), (9, &["h", "i"])];
    let found = commands(text);
    assert_eq!(found, expected.map(|(line, words)| (line, words.iter().map(|word| word.to_string()).collect())));
    assert!(Args::try_parse_from(["maille", "inspect", "1.1", "--no-such-option"]).is_err());
}
