//! Formats of an export, and how its files are named.

use crate::{
    exit::{self, wrong},
    input::file_name,
    output,
    source::Source,
};
use clap::ValueEnum;
use maille_mesh::Format;
use miette::Result;
use std::path::{Path, PathBuf};

/// A format by its name.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub enum FormatArg {
    #[value(name = "3mf")]
    ThreeMf,
    Stl,
    Obj,
    Glb,
    Vtk,
    Ply,
}

impl FormatArg {
    /// The format itself.
    pub fn format(self) -> Format {
        match self {
            FormatArg::ThreeMf => Format::ThreeMf,
            FormatArg::Stl => Format::Stl,
            FormatArg::Obj => Format::Obj,
            FormatArg::Glb => Format::Glb,
            FormatArg::Vtk => Format::Vtk,
            FormatArg::Ply => Format::Ply,
        }
    }

    /// Whether rings share their mesh.
    pub fn instanced(self) -> bool {
        matches!(self, FormatArg::ThreeMf | FormatArg::Glb)
    }

    /// The format whose files end so.
    pub fn of_extension(path: &Path) -> Option<FormatArg> {
        let format = Format::of_ending(&path.extension()?.to_str()?.to_ascii_lowercase())?;
        FormatArg::value_variants().iter().copied().find(|arg| arg.format() == format)
    }
}

/// Where the files go.
pub enum Destination {
    /// How their names begin.
    Files(PathBuf),
    /// The only one to standard output.
    Standard,
}

/// Where the files go, and which; `wanted` is `--format`.
pub fn destination(
    out: Option<&Path>,
    wanted: &[FormatArg],
    frames: bool,
    source: &Source,
) -> Result<(Destination, Vec<FormatArg>)> {
    let mut formats: Vec<FormatArg> = Vec::new();
    for format in wanted {
        if !formats.contains(format) {
            formats.push(*format);
        }
    }
    let named = out.and_then(FormatArg::of_extension);
    let conflict = named.is_some_and(|named| !formats.is_empty() && !formats.contains(&named));
    if let Some(out) = out.filter(|_| named.is_none()) {
        known_ending(out)?;
    }
    formats.extend(formats.is_empty().then_some(named.unwrap_or(FormatArg::ThreeMf)));
    let Some(out) = out else {
        let folder = format!("{}-export", file_name(&source.design.name));
        return Ok((Destination::Files(PathBuf::from("maille-out").join(folder).join(source.stem(false))), formats));
    };
    if output::is_standard(out) {
        return match formats[..] {
            [one] if one != FormatArg::Vtk && !frames => Ok((Destination::Standard, formats)),
            _ => Err(wrong(
                exit::USAGE,
                "standard output takes one file, and this export has several",
                "give one --format other than vtk and no --frames, or name a folder with --out",
            )),
        };
    }
    if out.as_os_str().to_string_lossy().ends_with(std::path::is_separator) || out.is_dir() {
        return Ok((Destination::Files(out.join(source.stem(false))), formats));
    }
    match named {
        None => Ok((Destination::Files(out.to_owned()), formats)),
        Some(_) if !conflict => Ok((Destination::Files(out.with_extension("")), formats)),
        Some(_) => Err(wrong(
            exit::USAGE,
            format!("{} ends otherwise than the files of --format", out.display()),
            "leave --format out, or give a name without an ending",
        )),
    }
}

/// Refuses a name that ends as files of other programs do: `a.step`. An ending with a digit in front is part of a name, as in
/// `wire-1.6mm`.
fn known_ending(out: &Path) -> Result<()> {
    let ending = out.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let folder = out.as_os_str().to_string_lossy().ends_with(std::path::is_separator) || out.is_dir();
    if folder || !ending.starts_with(|c: char| c.is_alphabetic()) {
        return Ok(());
    }
    let known: Vec<String> = FormatArg::value_variants()
        .iter()
        .filter_map(|f| f.to_possible_value())
        .map(|v| v.get_name().to_owned())
        .collect();
    let help = format!("the formats are {}; meshes are made of triangles and are not CAD solids", known.join(", "));
    Err(wrong(
        exit::USAGE,
        format!("{} ends in .{ending}, which is not a format of `maille export`", out.display()),
        help,
    ))
}

/// `prefix` with `ending` added to its name.
pub fn with_ending(prefix: &Path, ending: &str) -> PathBuf {
    let mut path = prefix.as_os_str().to_owned();
    path.push(ending);
    path.into()
}
