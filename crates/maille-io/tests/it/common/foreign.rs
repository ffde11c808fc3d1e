//! Programs of others, installed below Cargo's target directory.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    process::Command,
};

/// The folder of the checkers.
pub fn checkers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/foreign").canonicalize().unwrap()
}

/// Runs a program that must succeed.
pub fn run(command: &mut Command) {
    let shown = format!("{command:?}");
    let output = command.output().unwrap_or_else(|e| {
        panic!(
            "{shown} did not start: {e}; this test needs python3 (3.11 or later, with venv), node and npm in the path"
        )
    });
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(
        output.status.success(),
        "{shown} ended with {}:\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

/// A folder below Cargo's target directory that `install` fills once for each content of `list`; tests of other
/// processes wait for it.
pub fn installed(name: &str, list: &Path, install: impl Fn(&Path)) -> PathBuf {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("foreign");
    fs::create_dir_all(&root).unwrap();
    let lock = File::create(root.join(format!("{name}.lock"))).unwrap();
    lock.lock().unwrap();
    let folder = root.join(name);
    let wanted = fs::read_to_string(list).unwrap();
    let done = root.join(format!("{name}.installed"));
    if fs::read_to_string(&done).ok().as_ref() != Some(&wanted) {
        // A half-made folder of a killed test, or one of an older list.
        if folder.exists() {
            fs::remove_dir_all(&folder).unwrap();
        }
        install(&folder);
        fs::write(&done, wanted).unwrap();
    }
    folder
}

/// Python with the readers.
pub fn python() -> PathBuf {
    let list = checkers().join("requirements.txt");
    let folder = installed("python", &list, |folder| {
        run(Command::new("python3").args(["-m", "venv"]).arg(folder));
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--requirement"];
        run(Command::new(folder.join("bin/python")).args(install).arg(&list));
    });
    folder.join("bin/python")
}
