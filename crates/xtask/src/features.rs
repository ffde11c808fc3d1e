//! The check that what `cargo xtask test` builds asks for one choice of features of each library, so that cargo compiles it once.

use crate::{program::cargo, repository::Finding};
use std::{collections::BTreeSet, path::Path, process::Command};

/// Where the features are chosen.
const CHOICE: &str = "crates/maille-features/Cargo.toml";
/// What is built beside the tests of the whole workspace but this program.
const BUILDS: [&[&str]; 3] =
    [&["--package", "maille-py"], &["--package", "maille-cli"], &["--package", "maille-cli", "--features", "view"]];
/// Its own features may differ.
const TOP: &str = "maille-cli ";

/// The libraries that a build asks for with other features than the tests do.
pub fn check(root: &Path) -> Vec<Finding> {
    let other = |all: &BTreeSet<String>, build: &[&str]| -> Result<Vec<Finding>, String> {
        let libraries = libraries(root, "normal,build", build)?;
        let problem = |library: &String| {
            let problem =
                format!("cargo tree {} has `{library}`, the tests do not: add its features here", build.join(" "));
            Finding::new(CHOICE, 0, problem)
        };
        Ok(libraries.difference(all).filter(|library| !library.starts_with(TOP)).map(problem).collect())
    };
    let found = libraries(root, "normal,build,dev", &["--workspace", "--exclude", "xtask"])
        .and_then(|all| BUILDS.iter().map(|build| other(&all, build)).collect::<Result<Vec<_>, _>>());
    found.map_or_else(|problem| vec![Finding::new(CHOICE, 0, problem)], |found| found.concat())
}

/// Each library of a build, as name, version and features.
fn libraries(root: &Path, edges: &str, build: &[&str]) -> Result<BTreeSet<String>, String> {
    let arguments = ["tree", "--locked", "--prefix", "none", "--format", "{p} with {f}", "--edges", edges];
    let output = Command::new(cargo()).args(arguments).args(build).current_dir(root).output();
    let output = output.map_err(|e| format!("cargo tree did not start: {e}"))?;
    if !output.status.success() {
        return Err(format!("cargo tree ended with {}: {}", output.status, String::from_utf8_lossy(&output.stderr)));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).filter(|line| !line.is_empty()).collect())
}
