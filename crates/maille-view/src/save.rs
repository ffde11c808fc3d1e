//! Design files that the page writes: whole or not at all, into one folder.

use crate::{
    App,
    api::{Save, Text},
    refusal::Refusal,
};
use axum::http::StatusCode;
use std::{
    io::Write,
    path::{Path, PathBuf},
};

/// Writes the file: that which was opened, or one in the folder that the program runs in.
pub fn save(app: &App, request: &Save) -> Result<Text, Refusal> {
    let opened = app.start.opened.file.as_deref() == Some(&*request.file);
    let path = match opened {
        true => PathBuf::from(&request.file),
        false => app.folder.join(name(&request.file)?),
    };
    if !opened && !request.overwrite && path.exists() {
        let problem = format!("{} is there already", request.file);
        return Err(Refusal::of(StatusCode::CONFLICT, problem, "take another name, or replace it"));
    }
    if path.is_dir() {
        return Err(Refusal::wrong(format!("{} is a folder", request.file), "give the name of a file"));
    }
    let written = maille_io::files::replace(&path, |out| out.write_all(request.text.as_bytes()));
    written.map_err(|e| Refusal::fault(format!("cannot write {}: {e}", path.display())))?;
    Ok(Text { name: path.display().to_string(), text: request.text.clone() })
}

/// A name without folders, of a design file.
fn name(file: &str) -> Result<&str, Refusal> {
    let plain = Path::new(file).file_name().is_some_and(|name| name == file);
    let odd = |c: char| c.is_control() || "\\/:*?\"<>|".contains(c);
    match plain && file.len() <= 100 && !file.starts_with('.') && file.ends_with(".toml") && !file.contains(odd) {
        true => Ok(file),
        false => Err(Refusal::wrong(
            format!("{file:?} is no name of a design file"),
            "give a name without folders that ends in .toml",
        )),
    }
}
