//! Runs of the program, as several tests need them.

use std::{
    path::Path,
    process::{Command, Output},
};

/// What a command does in a folder; its words have no spaces.
pub fn maille(folder: &Path, line: &str) -> Output {
    maille_with(folder, &line.split_whitespace().collect::<Vec<_>>())
}

/// What a command does in a folder.
pub fn maille_with(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_maille")).args(arguments).current_dir(folder).output().unwrap()
}

/// What a command prints that does all it was asked.
pub fn done(folder: &Path, line: &str) -> String {
    done_with(folder, &line.split_whitespace().collect::<Vec<_>>())
}

/// What a command prints that does all it was asked.
pub fn done_with(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = maille_with(folder, arguments);
    assert!(status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// The exit code.
pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

/// The exit code of a command, what it prints, and what it says beside that.
pub fn outcome(folder: &Path, line: &str) -> (i32, String, String) {
    let output = maille(folder, line);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (code(&output), text(&output.stdout), text(&output.stderr))
}
