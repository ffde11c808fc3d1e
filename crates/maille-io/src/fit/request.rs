//! What is asked of a fit: the only request type of program, Python and Dask, as the record has it.

use super::free::{FreeSpec, free_numbers};
use crate::{
    design_toml::{NumberPath, set_parameters},
    numbers::nine_digits,
};
use maille::{
    answer::Answer,
    design::{Design, Source},
    error::InvalidInput,
    fit::{Family, Fit, FitOptions, FitProgress, FreeNumber, Measure, Target, Targets, Wanted, fit, linked_alike},
    lattice::Cell,
    model::Model,
    search::extreme::Extreme,
    sheet::Sheet,
};
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;

/// A design whose free numbers are to be moved until its limits are the wanted ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitRequest {
    /// The design to begin with.
    pub design: Design,
    /// Its numbers that may move, by their places.
    pub free: Vec<FreeNumber>,
    /// What is wanted.
    pub targets: Vec<Target>,
    /// Whether only the proportions of the limits count.
    pub shape: bool,
    /// How it is searched.
    pub options: FitOptions,
}

/// Most cells of a supercell.
const MOST_CELLS: usize = 64;

impl FitRequest {
    /// A request for `supercell` cells of a design as one, with its numbers `together` and `each` free ([`free_numbers`]), and with the widest
    /// gap at least `min_gap`, in the design's unit.
    ///
    /// # Errors
    /// What is wrong with one of them.
    pub fn new(
        design: &Design,
        supercell: [usize; 2],
        (together, each): (&[FreeSpec], &[FreeSpec]),
        (mut targets, shape): (Vec<Target>, bool),
        min_gap: Option<f64>,
        options: FitOptions,
    ) -> Result<Self, InvalidInput> {
        let [n, m] = supercell;
        if n == 0 || m == 0 || n.saturating_mul(m) > MOST_CELLS {
            let problem = format!("{n}x{m} is not a supercell of 1 to {MOST_CELLS} cells");
            return Err(InvalidInput::new("supercell", problem, "give the cells along a1 and a2, as 2x2"));
        }
        let design = if supercell == [1, 1] { design.clone() } else { design.repeated(n, m) };
        let free = free_numbers(&design, together, each)?;
        targets.extend(min_gap.map(|gap| Target {
            measure: Measure::Clearance,
            wanted: Wanted::AtLeast(gap / design.reference_radius),
            weight: 1.0,
        }));
        let request = FitRequest { design, free, targets, shape, options };
        request.checked_targets()?;
        Ok(request)
    }

    /// The targets, checked.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn checked_targets(&self) -> Result<Targets, InvalidInput> {
        Targets::new(self.targets.clone(), self.shape)
    }

    /// Searches on the current thread pool: see [`fit`]. Rings may overlap as written on the way.
    ///
    /// # Errors
    /// Those of [`fit`], and a free number that the design has not.
    pub fn solve(
        &self,
        resumed: Option<(&[f64], usize)>,
        progress: &dyn Fn(FitProgress),
        cancel: &AtomicBool,
    ) -> Result<Fit, InvalidInput> {
        let (begin, paths) = (self.tolerant(), self.paths()?);
        let make = |values: &[f64]| with(&begin, &paths, values);
        let family = Family { numbers: self.free.clone(), make: &make };
        fit(&family, &self.checked_targets()?, &self.options, resumed, progress, cancel)
    }

    /// Rings may overlap as written.
    fn tolerant(&self) -> Design {
        Design { allow_initial_overlap: true, ..self.design.clone() }
    }

    fn paths(&self) -> Result<Vec<NumberPath>, InvalidInput> {
        self.free.iter().map(|number| number.name.parse()).collect()
    }

    /// The design with other values of its free numbers, its rings linked as those of the given one.
    fn made(&self, values: &[f64], cancel: &AtomicBool) -> Result<Design, InvalidInput> {
        let none = || InvalidInput::new("numbers", "they make no design", "give those of the fit");
        let (begin, paths) = (self.tolerant(), self.paths()?);
        let make = |values: &[f64]| with(&begin, &paths, values);
        let family = Family { numbers: self.free.clone(), make: &make };
        linked_alike(&family, values, cancel).ok_or_else(none)
    }

    /// The request without what does not change where a search leads: more starts go on from fewer.
    pub fn continues(&self, other: &FitRequest) -> bool {
        let same_starts = |request: &FitRequest| FitRequest {
            options: FitOptions { starts: 1, ..request.options.clone() },
            ..request.clone()
        };
        same_starts(self) == same_starts(other)
    }
}

/// The design with values at these places: parameters first and at once, the spacing last.
fn with(design: &Design, paths: &[NumberPath], values: &[f64]) -> Result<Design, Vec<InvalidInput>> {
    let all = || paths.iter().zip(values);
    let parameters: Vec<_> = all().filter_map(|(path, value)| Some((path.parameter()?, *value))).collect();
    let mut out = if parameters.is_empty() { design.clone() } else { set_parameters(design, &parameters)? };
    for spacing in [false, true] {
        for (path, value) in all().filter(|(path, _)| path.parameter().is_none() && path.is_spacing() == spacing) {
            out = path.set(&out, *value).map_err(|problem| vec![problem])?;
        }
    }
    Ok(out)
}

/// The design of a fit that found these `numbers` as a design of its own, with the numbers to nine digits. Where its rings overlap as written it is laid out
/// with the widest gaps that its lattice allows. It allows overlaps only where these are left.
///
/// # Errors
/// Where the numbers make no design.
pub fn fitted_design(request: &FitRequest, numbers: &[f64], cancel: &AtomicBool) -> Result<Design, InvalidInput> {
    let given = &request.design;
    let title = format!("{}, fitted", if given.title.is_empty() { &given.name } else { &given.title });
    let name = format!("{}-fitted", given.name);
    let made = request.made(&numbers.iter().map(|x| nine_digits(*x)).collect::<Vec<_>>(), cancel)?;
    let mut out = Design { name, title, source: Source::Own, varied: given.varied.clone(), ..made }.rounded();
    let overlaps = |design: &Design| {
        Model::compile(&Design { allow_initial_overlap: false, ..design.clone() }, Cell::PRIMITIVE).is_err()
    };
    if overlaps(&out) && !given.allow_initial_overlap {
        out = laid_out(&out, cancel).unwrap_or(out);
    }
    out.allow_initial_overlap = given.allow_initial_overlap || overlaps(&out);
    // What no ring uses any more would be read as the wire of all.
    if out.elements.iter().flat_map(|element| &element.rings).all(|ring| ring.minor_radius.is_some()) {
        out.minor_radius = None;
        out.formulas.remove("minor_radius");
    }
    Ok(out)
}

/// With the widest gaps that the lattice allows; `None` where no state is found.
fn laid_out(design: &Design, cancel: &AtomicBool) -> Option<Design> {
    let sheet = Sheet::in_cells(design, Cell::PRIMITIVE.into()).ok()?;
    let question = Target { measure: Measure::Clearance, wanted: Wanted::AtLeast(0.0), weight: 1.0 }.question();
    let answer: Answer = sheet.answer_until(&question, cancel).ok()?;
    answer.limit()?;
    let (name, title) = (design.name.clone(), design.title.clone());
    let placed = Extreme::LargestClearance.design(&answer, design, sheet.model());
    Some(Design { name, title, ..placed })
}
