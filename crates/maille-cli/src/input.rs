//! A design from a built-in name or a file, and its model.

use maille::{design::Design, error::InvalidInput, lattice::Cell, model::Model};
use maille_io::{DesignSource, builtin, builtin_designs};
use miette::{IntoDiagnostic, Report, Result, WrapErr, miette};
use std::path::Path;

/// A design as read, with the text that its errors point into.
pub struct Input {
    /// The design, with the minor radius of the command line.
    pub design: Design,
    source: DesignSource,
    minor_radius: Option<f64>,
}

impl Input {
    /// Reads the built-in design `name`, or the file of that path.
    pub fn read(name: &str, minor_radius: Option<f64>) -> Result<Input> {
        let path = Path::new(name);
        let source = match builtin(name) {
            Some(text) if !path.is_file() => DesignSource::new(format!("{name} (built in)"), text),
            _ if path.is_dir() => return Err(miette!(help = "give a TOML file", "{name} is a folder, not a design")),
            _ => match std::fs::read_to_string(path) {
                Ok(text) => DesignSource::new(name, text),
                Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Err(unknown(name)),
                Err(e) => return Err(e).into_diagnostic().wrap_err_with(|| format!("cannot read the design {name}")),
            },
        };
        let mut design = source.read()?;
        if let Some(r) = minor_radius {
            design = design.with_minor_radius(r);
        }
        Ok(Input { design, source, minor_radius })
    }

    /// Compiles the design for `cell`; what is wrong is shown at its place in the file, or, where it comes from
    /// `--minor-radius`, named after that option.
    pub fn compile(&self, design: &Design, cell: Cell) -> Result<Model> {
        Model::compile(design, cell).map_err(|problems| match self.minor_radius {
            Some(r) => of_minor_radius(r, &problems),
            None => Report::new(self.source.explain(&problems)),
        })
    }
}

fn of_minor_radius(r: f64, problems: &[InvalidInput]) -> Report {
    let list: Vec<String> = problems.iter().map(|p| format!("  {}: {}", p.field, p.problem)).collect();
    miette!(
        help = "take a smaller --minor-radius, or allow_initial_overlap = true in the file where rings may start overlapped",
        "with --minor-radius {r} the design cannot be used:\n{}",
        list.join("\n")
    )
}

fn unknown(name: &str) -> Report {
    let names: Vec<&str> = builtin_designs().iter().map(|b| b.name).collect();
    miette!(
        help = format!("built in are {}; `maille designs` says what they are", names.join(", ")),
        "there is no built-in design and no file \"{name}\""
    )
}

/// A design's name as a file or folder: path separators and other odd characters become underscores.
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || ".-_ ".contains(c) { c } else { '_' }).collect()
}
