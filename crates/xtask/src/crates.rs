//! The sources of all crates, each read once, with which file uses which.

use crate::{
    repository::{Finding, sources},
    uses::{Use, uses},
};
use std::{collections::BTreeMap, path::Path, thread};

/// The sources of a crate.
pub struct Sources {
    /// Texts by their paths below `src`.
    pub files: BTreeMap<String, String>,
    pub uses: Vec<Use>,
}

/// Crates by name; a finding for one that cannot be read.
pub type Crates = BTreeMap<String, Result<Sources, Finding>>;

/// Where the sources of a crate are.
pub fn folder(name: &str) -> String {
    format!("crates/{name}/src")
}

/// Reads all crates, beside each other: to parse them takes most of the time.
pub fn read(root: &Path) -> Crates {
    let folders = std::fs::read_dir(root.join("crates")).into_iter().flatten().flatten();
    let names: Vec<String> = folders.map(|f| f.file_name().to_string_lossy().into_owned()).collect();
    thread::scope(|scope| {
        let threads: Vec<_> = names.iter().map(|name| (name, scope.spawn(|| read_one(root, name)))).collect();
        let read = threads.into_iter().map(|(name, thread)| {
            let failed = |_| Err(Finding::new(folder(name), 0, "cannot be read: the check itself failed"));
            (name.clone(), thread.join().unwrap_or_else(failed))
        });
        read.collect()
    })
}

fn read_one(root: &Path, name: &str) -> Result<Sources, Finding> {
    let folder = folder(name);
    let files = sources(root, &folder)?;
    let uses = uses(&files).map_err(|problem| Finding::new(folder, 0, problem))?;
    Ok(Sources { files, uses })
}
