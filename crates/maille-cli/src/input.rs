//! A design from a built-in name or a file, and its model.

use crate::{
    exit::{self, wrong},
    numbers::positive,
};
use maille::{
    design::Design, error::InvalidInput, lattice::Cell, model::Model, sheet::Sheet, survey::CellChoice, topology,
};
pub use maille_io::record::file_name;
use maille_io::{
    DesignError, DesignSource, ListedProblem, builtin, builtin_designs, millimetres, nearest_builtin, set_parameters,
    study::Variant, write_design,
};
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use serde_json::{Value, json};
use std::{io::Read, path::Path};

/// A value for a parameter of the design, as `radius=5.0`.
#[derive(Clone, Debug)]
pub struct Setting {
    name: String,
    value: f64,
}

#[cfg(feature = "view")]
impl Setting {
    /// Name and value.
    pub fn pair(&self) -> (String, f64) {
        (self.name.clone(), self.value)
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", self.name, self.value)
    }
}

impl std::str::FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Setting, String> {
        let value = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        match text.split_once('=').and_then(|(name, number)| Some((name.trim(), value(number)?))) {
            Some((name, value)) if !name.is_empty() => Ok(Setting { name: name.to_owned(), value }),
            _ => Err(format!("\"{text}\" sets no parameter; write NAME=NUMBER, as radius=5.0")),
        }
    }
}

/// The design of a command, and what changes its numbers.
#[derive(clap::Args)]
pub struct DesignArgs {
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input
    pub design: String,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive)]
    minor_radius: Option<f64>,
    /// A value for a parameter of the design's file, as radius=5.0; several with commas
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    set: Vec<Setting>,
}

impl DesignArgs {
    /// Reads the design.
    pub fn read(&self) -> Result<Input> {
        Input::read_with(&self.design, &self.set, self.minor_radius)
    }
}

/// A design as read, with the text that its errors point into.
pub struct Input {
    /// The design, with the minor radius of the command line.
    pub design: Design,
    source: DesignSource,
    /// What was changed after reading, as it is to be named in errors.
    changed: Option<String>,
}

impl Input {
    /// Reads the design as [`read`](Input::read) does, and sets parameters of it.
    pub fn read_with(name: &str, settings: &[Setting], minor_radius: Option<f64>) -> Result<Input> {
        let mut input = Self::read(name)?;
        let mut words: Vec<String> = settings.iter().map(|set| format!("--set {set}")).collect();
        if !settings.is_empty() {
            let values: Vec<_> = settings.iter().map(|set| (set.name.as_str(), set.value)).collect();
            let set = set_parameters(&input.design, &values);
            input.design = set.map_err(|problems| of_change(&words.join(" "), &problems))?;
        }
        if let Some(r) = minor_radius {
            input.design = input.design.with_minor_radius(r);
            words.push(format!("--minor-radius {r}"));
        }
        input.changed = (!words.is_empty()).then(|| words.join(" "));
        Ok(input)
    }

    /// Reads the built-in design `name`, the file of that path, or standard input for `-`.
    pub fn read(name: &str) -> Result<Input> {
        let path = Path::new(name);
        let source = match builtin(name) {
            _ if name == "-" => {
                let mut text = String::new();
                std::io::stdin()
                    .read_to_string(&mut text)
                    .into_diagnostic()
                    .wrap_err("cannot read a design from standard input")?;
                DesignSource::new("<stdin>", text)
            }
            Some(text) if !path.is_file() => DesignSource::new(format!("{name} (built in)"), text),
            _ if path.is_dir() => {
                return Err(wrong(exit::DESIGN, format!("{name} is a folder, not a design"), "give a TOML file in it"));
            }
            _ => match std::fs::read_to_string(path) {
                Ok(text) => DesignSource::new(name, text),
                Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Err(unknown(name)),
                Err(e) if e.kind() == std::io::ErrorKind::InvalidData => {
                    let help = "a design is a TOML file, encoded in UTF-8";
                    return Err(wrong(exit::DESIGN, format!("{name} is not a text file"), help));
                }
                Err(e) => return Err(e).into_diagnostic().wrap_err_with(|| format!("cannot read the design {name}")),
            },
        };
        Ok(Input { design: source.read()?, source, changed: None })
    }

    /// What is odd about the design, with the place in the file; nothing of it keeps it from being solved.
    pub fn warnings(&self, model: &Model) -> Vec<ListedProblem> {
        let mut found = topology::warnings(model);
        if let Some(unit) = self.design.unit.as_deref().filter(|unit| millimetres(unit).is_none()) {
            let problem = format!("\"{unit}\" is not a known unit: no weight, no size in millimetres");
            found.push(InvalidInput::new("unit", problem, "known are mm, cm, m, um, in and ft"));
        }
        found.extend(self.design.unused_parameters().map(|p| {
            let help = "name it in a formula, or leave it out";
            InvalidInput::new(format!("parameters.{}", p.name), format!("nothing uses the parameter {}", p.name), help)
        }));
        self.source.explain(&found).list()
    }

    /// The same design with the parameters of a study.
    pub fn varied(&self, variant: &Variant) -> Result<Input> {
        let changed = variant.words();
        let design = variant
            .of(&self.design)
            .map_err(|problems| of_change(changed.as_deref().unwrap_or_default(), &problems))?;
        Ok(Input { design, source: self.source.clone(), changed })
    }

    /// The design file.
    #[cfg(feature = "view")]
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// A design that is no file.
    pub fn of(design: Design) -> Input {
        let source = DesignSource::new(format!("{} (made by the program)", design.name), write_design(&design));
        Input { design, source, changed: None }
    }

    /// Compiles the design for `cell`; what is wrong is shown at its place in the file, or, where it comes from
    /// `--minor-radius`, named after that option.
    pub fn compile(&self, design: &Design, cell: Cell) -> Result<Model> {
        Model::compile(design, cell).map_err(|problems| self.explain(&problems))
    }

    /// The same for the cells that a search may go on to.
    pub fn sheet(&self, cells: CellChoice) -> Result<Sheet> {
        Sheet::in_cells(&self.design, cells).map_err(|problems| self.explain(&problems))
    }

    /// The same for a finite sheet of the cells of `tile`.
    pub fn compile_sheet(&self, design: &Design, tile: Cell) -> Result<Model> {
        Model::compile_sheet(design, tile).map_err(|problems| self.explain(&problems))
    }

    fn explain(&self, problems: &[InvalidInput]) -> Report {
        if let Some(changed) = &self.changed {
            return of_change(changed, problems);
        }
        let with_cure = |problem: &InvalidInput| {
            let mut problem = problem.clone();
            if problem.help.contains(OVERLAP_FIELD) {
                problem.help += &format!("\n{}", cure(self.source.name()));
            }
            problem
        };
        Report::new(self.source.explain(&problems.iter().map(with_cure).collect::<Vec<_>>()))
    }
}

/// Prints what is odd about the links of a model, as a sheet that falls apart.
pub fn warn(model: &Model) {
    for warning in topology::warnings(model) {
        eprintln!("warning: {}", warning.problem);
    }
}

/// Problems that are listed one by one.
const MOST: usize = 6;

fn of_change(changed: &str, problems: &[InvalidInput]) -> Report {
    // A name that the design has not is wrong with any value.
    if let [InvalidInput { field, problem, help }] = problems
        && field == "vary"
    {
        return wrong(exit::DESIGN, format!("vary: {problem}"), help.clone());
    }
    let mut list: Vec<String> = problems.iter().take(MOST).map(|p| format!("  {}: {}", p.field, p.problem)).collect();
    list.extend((problems.len() > MOST).then(|| format!("  … and {} more", problems.len() - MOST)));
    let overlap = problems.iter().any(|p| p.help.contains(OVERLAP_FIELD));
    let help = match (overlap, problems) {
        (true, _) => {
            format!("take a smaller minor radius, or write {OVERLAP_FIELD} = true in the file\n{}", cure("FILE"))
        }
        (false, [first, ..]) => first.help.clone(),
        (false, []) => String::new(),
    };
    wrong(exit::DESIGN, format!("with {changed} the design cannot be used:\n{}", list.join("\n")), help)
}

/// The field by which a design allows overlaps at its start; errors of overlaps name it.
const OVERLAP_FIELD: &str = "allow_initial_overlap";

/// How rings that overlap find their places.
fn cure(file: &str) -> String {
    let file = if file.ends_with(".toml") { file } else { "FILE" };
    format!(
        "with that line, `maille roomiest {file} --lattice free --save NEW.toml` moves the rings as far apart as they go"
    )
}

/// The text of a built-in design's file.
pub fn built_in_file(name: &str) -> Result<&'static str> {
    builtin(name)
        .ok_or_else(|| wrong(exit::DESIGN, format!("there is no built-in design \"{name}\""), nearest_help(name)))
}

fn unknown(name: &str) -> Report {
    if Path::new(name).extension().is_some_and(|e| e == "toml") || name.contains(std::path::is_separator) {
        let help = "is it in this folder? `maille designs` lists the built-in ones, `maille new` writes a file";
        return wrong(exit::DESIGN, format!("there is no file \"{name}\""), help);
    }
    let file = format!("{name}.toml");
    if Path::new(&file).is_file() {
        return wrong(
            exit::DESIGN,
            format!("there is no built-in design \"{name}\""),
            format!("did you mean the file {file}?"),
        );
    }
    wrong(exit::DESIGN, format!("there is no built-in design and no file \"{name}\""), nearest_help(name))
}

/// Which built-in design may have been meant.
fn nearest_help(name: &str) -> String {
    // Nearly every number is near another: only words are guessed.
    match nearest_builtin(name).filter(|_| name.len() > 3) {
        Some(near) => format!("did you mean {near}? `maille designs` lists them"),
        None => {
            let names: Vec<&str> = builtin_designs().iter().map(|b| b.name).collect();
            format!("`maille designs` says what they are: {}", names.join(", "))
        }
    }
}

/// What is wrong, as a list for scripts: field, problem, help, and line and column from 1 where the file has a place.
pub fn problems(report: &Report) -> Value {
    let Some(error) = report.downcast_ref::<DesignError>() else {
        let help = report.help().map(|h| h.to_string());
        return json!([{ "field": null, "problem": report.to_string(), "help": help, "line": null, "column": null }]);
    };
    json!(error.list())
}
