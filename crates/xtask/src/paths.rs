//! The documented-paths check: what the documents call by path is there.
//!
//! Looked at are code spans (every word with a slash in it) and the targets of relative links. Fenced blocks are left
//! alone: they hold commands and listings.

use crate::repository::{Finding, files, read};
use std::path::Path;

/// Documents at the root; those below [`FOLDER`] join them.
const DOCUMENTS: &[&str] = &["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"];
const FOLDER: &str = "docs";
/// Folders that commands make.
const MADE: &[&str] = &["target", "maille-out"];

/// Paths that the documents name and the repository lacks, sorted; a missing document is one.
pub fn check(root: &Path) -> Vec<Finding> {
    let mut out = Vec::new();
    let mut documents: Vec<String> = DOCUMENTS.iter().map(|d| d.to_string()).collect();
    match files(root, FOLDER, "md") {
        Ok(files) => documents.extend(files),
        Err(e) => out.push(Finding::new(FOLDER, 0, format!("cannot be read: {e}"))),
    }
    for document in documents {
        match read(root, &document) {
            Ok(text) => out.extend(
                named_paths(&text)
                    .into_iter()
                    .filter(|(path, _)| !exists(root, &document, path))
                    .map(|(path, line)| Finding::new(&document, line, format!("there is no {path}"))),
            ),
            Err(finding) => out.push(finding),
        }
    }
    out.sort_unstable();
    out
}

/// A path is there if the root or the document's folder has it. An empty folder is not: a clone would not have it.
fn exists(root: &Path, document: &str, path: &str) -> bool {
    let beside = Path::new(document).parent().unwrap_or(Path::new(""));
    [root.join(path), root.join(beside).join(path)].iter().any(|found| match std::fs::read_dir(found) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => found.is_file() && !path.ends_with('/'),
    })
}

/// The paths that a document names, each with its line.
fn named_paths(text: &str) -> Vec<(String, usize)> {
    let mut out = Vec::new();
    let mut fence: Option<&str> = None;
    // A code span or a link may run over a line's end: lines of one paragraph are read together.
    let mut paragraph: Vec<(char, usize)> = Vec::new();
    for (index, line) in text.lines().chain([""]).enumerate() {
        let trimmed = line.trim_start();
        let mark = ["```", "~~~"].into_iter().find(|mark| trimmed.starts_with(mark));
        match (fence, mark) {
            (None, Some(mark)) => fence = Some(mark),
            (Some(open), Some(mark)) if open == mark => fence = None,
            _ => {}
        }
        if fence.is_some() || mark.is_some() || trimmed.is_empty() {
            out.extend(paths_of_paragraph(&paragraph));
            paragraph.clear();
        } else {
            paragraph.extend(line.chars().chain(['\n']).map(|c| (c, index + 1)));
        }
    }
    out.extend(paths_of_paragraph(&paragraph));
    out
}

fn paths_of_paragraph(text: &[(char, usize)]) -> Vec<(String, usize)> {
    let mut out = Vec::new();
    let mut at = 0;
    while at < text.len() {
        match text[at].0 {
            '`' => {
                let ticks = text[at..].iter().take_while(|c| c.0 == '`').count();
                let begin = at + ticks;
                match (begin..text.len()).find(|&end| closes(text, end, ticks)) {
                    Some(end) => {
                        out.extend(words(&text[begin..end]).into_iter().filter(|(word, _)| is_path(word)));
                        at = end + ticks;
                    }
                    None => at = begin,
                }
            }
            ']' if text.get(at + 1).is_some_and(|c| c.0 == '(') => {
                let end = (at + 2..text.len()).find(|&end| text[end].0 == ')').unwrap_or(text.len());
                let target = words(&text[at + 2..end]).into_iter().next();
                out.extend(target.filter(|(target, _)| is_relative_link(target)));
                at = end;
            }
            _ => at += 1,
        }
    }
    out.into_iter().map(|(path, line)| (bare(&path).to_string(), line)).collect()
}

/// Whether a run of exactly `ticks` backticks begins at `at`.
fn closes(text: &[(char, usize)], at: usize, ticks: usize) -> bool {
    let run = text[at..].iter().take_while(|c| c.0 == '`').count();
    run == ticks && text[at - 1].0 != '`'
}

fn words(text: &[(char, usize)]) -> Vec<(String, usize)> {
    let words = text.split(|c| c.0.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| (word.iter().map(|c| c.0).collect(), word[0].1)).collect()
}

/// Whether a word of a code span names a file of the repository.
///
/// Not so: what has other signs than a path's (addresses, `α/β`, placeholders as `<name>`, `*`, `…`), what begins at
/// the machine's root, short names on both sides of a slash (`r/R`, `1/2`: a formula), and what commands make.
fn is_path(word: &str) -> bool {
    let signs = word.chars().all(|c| c.is_ascii_alphanumeric() || "._-/:+@".contains(c));
    let formula = word.split('/').all(|part| part.len() <= 2 && part.chars().all(|c| c.is_ascii_alphanumeric()));
    let made = MADE.iter().any(|made| word.split('/').find(|part| *part != ".") == Some(made));
    signs
        && word.contains('/')
        && !word.contains("::")
        && !word.contains("//")
        && !word.contains("...")
        && !word.starts_with(['/', '-'])
        && !formula
        && !made
}

fn is_relative_link(target: &str) -> bool {
    !target.contains("://") && !target.starts_with(['#', '/']) && !target.starts_with("mailto:")
}

/// Without an anchor (`#part`) or a line number (`:12`).
fn bare(path: &str) -> &str {
    let path = path.split('#').next().unwrap_or(path);
    match path.rsplit_once(':') {
        Some((file, line)) if line.chars().all(|c| c.is_ascii_digit()) => file,
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(text: &str) -> Vec<String> {
        named_paths(text).into_iter().map(|found| found.0).collect()
    }

    #[test]
    fn paths_are_found_with_their_lines() {
        let text = "A `src/a.rs:12` and\n`docs/`.\n\n```\n`no/no.md`\n```\nSee [it](guide/b.md#part), `maille x designs/1.1.toml\n--y z/w.md`.";
        let found = named_paths(text);
        let expected = [("src/a.rs", 1), ("docs/", 2), ("guide/b.md", 7), ("designs/1.1.toml", 7), ("z/w.md", 8)];
        assert_eq!(found, expected.map(|(path, line)| (path.to_string(), line)));
        assert_eq!(paths("``a/b.md`` `` `c/d.md` ``"), ["a/b.md"]);
        assert_eq!(paths("a lone ` tick, then `a/b.md`"), Vec::<String>::new());
    }

    #[test]
    fn what_names_no_file_is_let_be() {
        let text = "`designs/<name>.toml` `crates/*` `docs/…` `maille-out/1.1/limits.csv` `./target/release/maille` `r/R` `R/20`
            `α/β` `https://a.org/b` `cargo run` `limits.csv` `crate::a/b` `/api/solve` `a/.../b` [x](https://a.org/b) [y](#z)";
        assert_eq!(paths(text), Vec::<String>::new());
    }

    #[test]
    fn the_repository_is_asked() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for (path, there) in
            [("src/paths.rs", true), ("src/", true), ("src", true), ("src/paths.rs/", false), ("src/none.rs", false)]
        {
            assert_eq!(exists(root, "README.md", path), there, "{path}");
        }
        assert!(exists(root, "src/a.md", "paths.rs") && exists(root, "src/a.md", "../Cargo.toml"));
    }
}
