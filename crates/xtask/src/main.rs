//! Chores of the repository: `cargo xtask test`, `cargo xtask ci`, and the checks that `ci` is made of.
//!
//! It depends on `serde_json` alone, so that the first command after a clone starts soon.

mod bench;
mod certify;
mod gallery;
mod layers;
mod paths;
mod program;
mod steps;
mod tokens;
mod uses;
mod view;
mod wheel;

use std::{
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

const HELP: &str = "\
cargo xtask COMMAND

  test     every test there is, documentation examples and those of the Python package included
  view     build the viewer's page, and the program with it (target/release/maille); needs Node.js
  wheel    build the Python package, install it into a new environment below target, run its examples
  ci       format, clippy, layers, paths, rustdoc, then test
  layers   no `use` points backward in the order of crates and modules
  paths    every path named in the documents exists
  gallery  write docs/gallery: pictures, plots and numbers of every built-in design, by the program
           --quick         few directions, into maille-out/gallery
           --program PATH  this program; otherwise it is built
  certify  maps of all built-in designs and of random ones, each row verified, as validation/certified.csv; a quarter of an hour; goes on
           where it was stopped
           --quick         few designs and directions, in minutes, beside their records in maille-out/certify
           --program PATH  this program; otherwise it is built
           --limit-s N     time for one map and for its verification, each [default: 1800]
           --threads N     threads of the program [default: all cores]
  bench    every bench, and docs/performance.md from it; close other programs first
           --from FILE     from what `cargo bench` has printed to FILE
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let root = match root() {
        Ok(root) => root,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::FAILURE;
        }
    };
    let done = match words[..] {
        ["test"] => steps::test(&root),
        ["view"] => steps::view(&root),
        ["wheel"] => steps::wheel(&root),
        ["ci"] => steps::ci(&root),
        ["layers"] => steps::layers(&root),
        ["paths"] => steps::paths(&root),
        ["gallery"] => steps::gallery(&root, false, None),
        ["gallery", "--quick"] => steps::gallery(&root, true, None),
        ["gallery", "--program", program] => steps::gallery(&root, false, Some(program)),
        ["gallery", "--quick", "--program", program] => steps::gallery(&root, true, Some(program)),
        ["bench"] => steps::bench(&root, None),
        ["bench", "--from", file] => steps::bench(&root, Some(file)),
        ["certify", ref options @ ..] => steps::certify(&root, options),
        [] | ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprintln!("xtask: unknown command `{}`\n\n{HELP}", words.join(" "));
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // The step has said why.
        Err(steps::Failed) => ExitCode::FAILURE,
    }
}

/// The repository: two folders above this crate. Asked at run time, for a binary may outlive the clone it was built in.
fn root() -> Result<PathBuf, String> {
    let manifest = std::env::var("CARGO_MANIFEST_DIR").map_err(|_| "xtask: start it with `cargo xtask`".to_string())?;
    let root = Path::new(&manifest).ancestors().nth(2);
    root.map(Path::to_path_buf).ok_or_else(|| format!("xtask: {manifest} is not a crate of the workspace"))
}

/// Something that a check found, with its place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Finding {
    /// Path from the repository's root.
    file: String,
    /// Line, from 1; 0 for the whole file.
    line: usize,
    /// What is wrong, and the rule.
    problem: String,
}

impl Finding {
    fn new(file: impl Into<String>, line: usize, problem: impl Into<String>) -> Self {
        Finding { file: file.into(), line, problem: problem.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.problem),
            line => write!(f, "{}:{line}: {}", self.file, self.problem),
        }
    }
}

/// All files below `folder` (a path from `root`) whose names end with `.extension`, sorted, as paths from `root`.
fn files(root: &Path, folder: &str, extension: &str) -> std::io::Result<Vec<String>> {
    let mut out = Vec::new();
    let mut open = vec![folder.to_string()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.file_type()?.is_dir() {
                open.push(path);
            } else if path.ends_with(&format!(".{extension}")) {
                out.push(path);
            }
        }
    }
    out.sort_unstable();
    Ok(out)
}

/// Reads a file of the repository; a failure is a finding of its own.
fn read(root: &Path, file: &str) -> Result<String, Finding> {
    std::fs::read_to_string(root.join(file)).map_err(|e| Finding::new(file, 0, format!("cannot be read: {e}")))
}
