//! The repository's files, and what a check finds in them.

use std::{
    collections::BTreeMap,
    fmt,
    path::{Path, PathBuf},
    process::Command,
};

/// The repository: two folders above this crate. Asked at run time, for a binary may outlive the clone it was built in.
pub fn root() -> Result<PathBuf, String> {
    let manifest = std::env::var("CARGO_MANIFEST_DIR").map_err(|_| "xtask: start it with `cargo xtask`".to_string())?;
    let root = Path::new(&manifest).ancestors().nth(2);
    root.map(Path::to_path_buf).ok_or_else(|| format!("xtask: {manifest} is not a crate of the workspace"))
}

/// Something that a check found, with its place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// Path from the repository's root.
    pub file: String,
    /// Line, from 1; 0 for the whole file.
    pub line: usize,
    /// What is wrong, and the rule.
    pub problem: String,
}

impl Finding {
    pub fn new(file: impl Into<String>, line: usize, problem: impl Into<String>) -> Self {
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
pub fn files(root: &Path, folder: &str, extension: &str) -> std::io::Result<Vec<String>> {
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
pub fn read(root: &Path, file: &str) -> Result<String, Finding> {
    std::fs::read_to_string(root.join(file)).map_err(|e| Finding::new(file, 0, format!("cannot be read: {e}")))
}

/// The Rust files below `folder` with their texts, by their paths below it.
pub fn sources(root: &Path, folder: &str) -> Result<BTreeMap<String, String>, Finding> {
    let files = files(root, folder, "rs").map_err(|e| Finding::new(folder, 0, format!("cannot be read: {e}")))?;
    files.into_iter().map(|file| Ok((file[folder.len() + 1..].to_string(), read(root, &file)?))).collect()
}

/// The commit of the repository, if git tells.
pub fn commit(root: &Path) -> Option<String> {
    let arguments = ["describe", "--always", "--dirty", "--exclude=*"];
    let described = Command::new("git").args(arguments).current_dir(root).output().ok()?;
    described.status.success().then(|| String::from_utf8_lossy(&described.stdout).trim().to_owned())
}

/// The day in UTC, as 2026-11-22; nothing where the system does not tell.
pub fn today() -> String {
    let told = Command::new("date").args(["-u", "+%F"]).output();
    told.map_or_else(|_| String::new(), |told| String::from_utf8_lossy(&told.stdout).trim().to_owned())
}
