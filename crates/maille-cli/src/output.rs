//! Where results go: a file, whole or not at all, or standard output.

use crate::exit::{USAGE, wrong};
use maille_io::files;
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use std::{
    fmt, fs,
    io::{self, BufWriter, Write},
    path::Path,
};

/// Whether `-`, standard output, is meant.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether files that are there may be replaced: the same rule in every command that writes a file.
#[derive(clap::Args, Clone, Copy)]
pub struct Replace {
    /// Replace files that are there
    #[arg(long)]
    pub overwrite: bool,
}

impl Replace {
    /// Refuses a file that is there, before anything is computed for it.
    pub fn check(self, path: &Path) -> Result<()> {
        match !self.overwrite && !is_standard(path) && path.is_file() {
            true => Err(wrong(
                USAGE,
                format!("{} is there already", path.display()),
                "name another file, or replace it with --overwrite",
            )),
            false => Ok(()),
        }
    }
}

/// Removes what a killed run left half written in a folder, if there is one.
pub fn remove_leftovers(folder: &Path) -> Result<()> {
    let removed = files::remove_leftovers(folder);
    removed.map_err(|(path, e)| Report::msg(e).wrap_err(format!("cannot remove {}", path.display())))
}

/// Refuses a file where a folder is written; `what` says so of the folder.
pub fn folder(out: &Path, what: &str) -> Result<()> {
    match out.is_file() {
        true => Err(wrong(USAGE, format!("{} is a file; {what}", out.display()), "name another folder with --out")),
        false => Ok(()),
    }
}

/// Writes under a temporary name in the same folder and renames: whatever happens, a file of this name is whole.
pub fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<&mut fs::File>) -> Result<()>) -> Result<()> {
    let context = || format!("cannot write {}", path.display());
    if path.is_dir() {
        let problem = format!("{} is a folder; a file is written here", path.display());
        return Err(wrong(USAGE, problem, "give the name of a file"));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot create the folder {}; name another", folder.display()))?;
    let mut failure = None;
    let done = files::replace(path, |out| {
        write(out).map_err(|report| {
            failure = Some(report);
            io::Error::other("not written")
        })
    });
    match failure {
        Some(report) => Err(report),
        None => done.into_diagnostic(),
    }
    .wrap_err_with(context)
}

/// Writes to the file, or to standard output for `-`.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    match is_standard(path) {
        true => print(bytes),
        false => replace(path, |out| out.write_all(bytes).into_diagnostic()),
    }
}

/// Writes to standard output; a reader that has gone (`| head`) is no error.
pub fn print(bytes: &[u8]) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        done => done.into_diagnostic().wrap_err("cannot write to standard output"),
    }
}

/// A line on standard output, as `println!`, which would panic where the reader has gone.
macro_rules! say {
    ($($text:tt)*) => { $crate::output::line(format_args!($($text)*)) };
}
pub(crate) use say;

/// See [`say`]. What is said here is a word on results that are in files: if nobody can read it, nothing is lost.
pub fn line(text: fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

pub use maille_io::numbers::counted;

/// A document with the time that it took.
pub fn timed(mut document: serde_json::Value, wall_s: f64) -> serde_json::Value {
    document["wall_s"] = wall_s.into();
    document
}

/// Prints one JSON document.
pub fn print_json(document: &impl serde::Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(document).into_diagnostic().wrap_err("cannot write JSON")?;
    print(format!("{text}\n").as_bytes())
}

/// A word of a command line, in quotes where a shell would read it otherwise.
pub fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "._/=+-,:@%".contains(c);
    if text.chars().all(plain) {
        return text.to_owned();
    }
    match text.contains(['"', '$', '`', '\\', '!']) {
        true => format!("'{}'", text.replace('\'', "'\\''")),
        false => format!("\"{text}\""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_asks_for_it() {
        let words = [("a-1.toml", "a-1.toml"), ("a b", "\"a b\""), ("a&b", "\"a&b\""), ("$a's", "'$a'\\''s'")];
        for (word, quotes) in words {
            assert_eq!(quoted(word), quotes);
        }
    }
}
