//! Designs.

use crate::error;
use maille::{error::InvalidInput, lattice::Cell, model::Model, sheet::Sheet, survey::CellChoice};
use maille_io::{
    DesignSource, NumberPath, builtin, builtin_designs, nearest_builtin, set_parameters, study::Variant, write_design,
};
use pyo3::prelude::*;

/// A parameter: name, value, least and largest value, and whether it can be set.
type Named<'a> = (&'a str, f64, Option<f64>, Option<f64>, bool);

/// A design, with the file that its errors point into.
#[pyclass(frozen, module = "maille._native")]
pub struct Design {
    pub design: maille::design::Design,
    source: Option<(String, DesignSource)>,
}

impl Design {
    /// A design that is no file.
    pub fn of(design: maille::design::Design) -> Self {
        Self { design, source: None }
    }

    /// The model for a cell.
    pub fn compile(&self, cell: Cell) -> PyResult<Model> {
        Model::compile(&self.design, cell).map_err(|problems| self.explain(&problems))
    }

    /// The sheet in the cells that a search may go on to.
    pub fn sheet(&self, cells: CellChoice) -> PyResult<Sheet> {
        Sheet::in_cells(&self.design, cells).map_err(|problems| self.explain(&problems))
    }

    /// The model of a finite sheet.
    pub fn compile_sheet(&self, tile: Cell) -> PyResult<Model> {
        Model::compile_sheet(&self.design, tile).map_err(|problems| self.explain(&problems))
    }

    /// The same with overlaps of its start accepted, to be looked at.
    pub fn tolerant(&self) -> Self {
        Self::of(maille::design::Design { allow_initial_overlap: true, ..self.design.clone() })
    }

    fn explain(&self, problems: &[InvalidInput]) -> PyErr {
        match &self.source {
            Some((name, source)) => error::design_file(name, &source.explain(problems)),
            None => error::design(problems),
        }
    }

    /// Another design, made from this one.
    fn changed(design: maille::design::Design) -> PyResult<Self> {
        let problems = design.problems();
        if problems.is_empty() { Ok(Self::of(design)) } else { Err(error::design(&problems)) }
    }
}

#[pymethods]
impl Design {
    /// From the text of a design file; `name` is what errors show.
    #[staticmethod]
    fn from_toml(text: &str, name: &str) -> PyResult<Self> {
        let source = DesignSource::new(name, text);
        let design = source.read().map_err(|e| error::design_file(name, &e))?;
        Ok(Self { design, source: Some((name.to_owned(), source)) })
    }

    /// The built-in design of that name, if there is one.
    #[staticmethod]
    fn builtin(name: &str) -> PyResult<Option<Self>> {
        builtin(name).map(|text| Self::from_toml(text, &format!("{name} (built in)"))).transpose()
    }

    /// From JSON with the fields of a design file.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let design = serde_json::from_str(text);
        let design =
            design.map_err(|e| error::argument("design", e.to_string(), "give the fields of a design file"))?;
        Self::changed(design)
    }

    fn to_toml(&self) -> String {
        write_design(&self.design)
    }

    fn to_json(&self) -> String {
        serde_json::to_string(&self.design).expect("a design has no map with odd keys")
    }

    fn with_minor_radius(&self, minor_radius: f64) -> PyResult<Self> {
        Self::changed(self.design.with_minor_radius(minor_radius))
    }

    fn with_number(&self, path: &str, value: f64) -> PyResult<Self> {
        let path: NumberPath = path.parse().map_err(|e| error::invalid(&e))?;
        Self::changed(path.set(&self.design, value).map_err(|e| error::invalid(&e))?)
    }

    fn with_parameters(&self, values: Vec<(String, f64)>) -> PyResult<Self> {
        let values: Vec<(&str, f64)> = values.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        Self::changed(set_parameters(&self.design, &values).map_err(|problems| error::design(&problems))?)
    }

    /// The parameters, in the order of the file.
    fn parameters(&self) -> Vec<Named<'_>> {
        self.design.parameters.iter().map(|p| (p.name.as_str(), p.value, p.min, p.max, p.is_free())).collect()
    }

    /// A variant of a study.
    fn varied(
        &self,
        minor_radius: Option<f64>,
        numbers: Vec<(String, f64)>,
        spacing: Option<f64>,
        keep_links: bool,
    ) -> PyResult<Self> {
        let path = |(path, value): &(String, f64)| Ok((path.parse::<NumberPath>()?, *value));
        let numbers = numbers.iter().map(path).collect::<Result<Vec<_>, _>>().map_err(|e| error::invalid(&e))?;
        let variant = Variant { suffix: String::new(), minor_radius, spacing, numbers, keep_links };
        Self::changed(variant.of(&self.design).map_err(|problems| error::design(&problems))?)
    }

    fn spaced(&self, factor: f64) -> PyResult<Self> {
        Self::changed(self.design.spaced(factor))
    }

    fn scaled(&self, factor: f64) -> PyResult<Self> {
        Self::changed(self.design.scaled(factor))
    }

    /// Raises what stands against solving it: rings that overlap, a link that cannot be.
    fn check(&self) -> PyResult<()> {
        self.compile(Cell::PRIMITIVE).map(drop)
    }
}

/// Names of the built-in designs.
#[pyfunction]
pub fn builtin_names() -> Vec<&'static str> {
    builtin_designs().iter().map(|design| design.name).collect()
}

/// The built-in name that was probably meant.
#[pyfunction]
pub fn nearest_builtin_name(name: &str) -> Option<&'static str> {
    // Nearly every number is near another: only words are guessed.
    nearest_builtin(name).filter(|_| name.len() > 3)
}
