//! What must hold for any input: no panic, no hang, no silent nonsense.
//!
//! A target takes bytes and panics if something does not hold. `fuzz` hands them to libFuzzer, the tests of this crate
//! try inputs made from the repository's own files by [`mutate`], and `examples/campaign.rs` tries as many as one likes.

mod circles;
pub mod mutate;
mod pieces;
mod text;

pub use circles::circles;
pub use pieces::pieces;
pub use text::{design, forces, frames, limits, run, simulation, states, study, surface};

use std::path::Path;

/// Sound inputs of a target: files of the repository. Pairs of circles and of pieces need none.
///
/// Panics if they cannot be read.
pub fn sound(target: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = match target {
        "circles" | "pieces" => return Vec::new(),
        "design" => root.join("../maille-io/designs"),
        _ => root.join("corpus").join(target),
    };
    let read = || -> std::io::Result<Vec<Vec<u8>>> {
        let files: std::io::Result<Vec<_>> = std::fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect();
        let mut files = files?;
        files.retain(|file| file.is_file());
        files.sort();
        files.iter().map(std::fs::read).collect()
    };
    let mut all = read().unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    all.retain(|input| input.len() <= mutate::MOST);
    all
}

/// A target by its name.
pub type Target = (&'static str, fn(&[u8]));

/// All of them.
pub const TARGETS: [Target; 11] = [
    ("circles", circles),
    ("pieces", pieces),
    ("design", design),
    ("limits", limits),
    ("states", states),
    ("run", run),
    ("simulation", simulation),
    ("frames", frames),
    ("forces", forces),
    ("study", study),
    ("surface", surface),
];
