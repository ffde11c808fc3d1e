//! What is done to a finite sheet: places by their names, and on the elements of a model.

use maille::{
    error::InvalidInput,
    model::Model,
    relaxation::{
        limit::EnergyOptions,
        simulate::{Setup, elements_at, force::Grip},
    },
};
use maille_geometry::Vec3;
use serde::{Deserialize, Serialize};

/// What is done to a finite sheet, as given: places by their names (see [`elements_at`]), lengths in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetPlan {
    /// Where elements are held.
    pub fix: Vec<String>,
    /// Where they are pulled.
    pub pull: Vec<PulledPlace>,
    /// Weight of every element, in [`maille::relaxation::simulate::WEIGHT_UNIT`].
    pub gravity: Option<[f64; 3]>,
    /// Where else forces act.
    pub force: Vec<LoadedPlace>,
    /// Height of a floor.
    pub floor: Option<f64>,
    /// Curvatures along x and y, in 1/unit, of the surface onto which the sheet is bent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend: Option<[f64; 2]>,
    /// Steps of the pull; with a drag, of the whole motion.
    pub steps: u32,
    /// What slows the sheet.
    #[serde(default)]
    pub drag: Option<f64>,
    /// Weight of the contacts against the pulls, α/β.
    #[serde(default = "usual_alpha")]
    pub alpha: f64,
    /// Largest miss of a pulled element that is still no lock, in R.
    #[serde(default = "usual_tau")]
    pub tau: f64,
    /// Newton iterations of one step at most.
    pub max_iterations: u32,
    /// Seed of everything random.
    pub seed: u64,
}

/// A place and its way: displacements from the start, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PulledPlace {
    /// Its name.
    pub place: String,
    /// The displacements.
    pub way: Vec<[f64; 3]>,
}

/// A place and the force on each of its elements, in [`maille::relaxation::simulate::WEIGHT_UNIT`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadedPlace {
    /// Its name.
    pub place: String,
    /// The force.
    pub force: [f64; 3],
}

fn usual_alpha() -> f64 {
    EnergyOptions::default().alpha
}

fn usual_tau() -> f64 {
    maille::relaxation::simulate::TAU
}

fn elements_of(model: &Model, field: &str, place: &str) -> Result<Vec<usize>, InvalidInput> {
    elements_at(model, place).map_err(|problem| InvalidInput { field: field.into(), ..problem })
}

impl SheetPlan {
    /// Whether nothing is pulled or bent and no force acts.
    pub fn is_still(&self) -> bool {
        self.bend.is_none_or(|bend| bend == [0.0; 2])
            && self.pull.is_empty()
            && self.force.is_empty()
            && self.gravity.is_none_or(|g| g == [0.0; 3])
    }

    /// The places that are held, on the elements of a sheet: fixed ones, then pulled ones. An element of two fixed
    /// places, as at a corner, belongs to the first; a place without an element of its own is left out. A wrong place
    /// names its field: `fix` or `pull`.
    pub fn grips(&self, model: &Model) -> Result<Vec<Grip>, InvalidInput> {
        let mut grips: Vec<Grip> = Vec::new();
        for place in &self.fix {
            let mut elements = elements_of(model, "fix", place)?;
            elements.retain(|e| !grips.iter().any(|grip| grip.elements.contains(e)));
            grips.push(Grip { name: place.clone(), elements, way: None });
        }
        grips.retain(|grip| !grip.elements.is_empty());
        for PulledPlace { place, way } in &self.pull {
            let elements = elements_of(model, "pull", place)?;
            let way = way.iter().map(|by| Vec3::from(*by) / model.unit).collect();
            grips.push(Grip { name: place.clone(), elements, way: Some(way) });
        }
        Ok(grips)
    }

    /// The plan on the elements of a sheet. A wrong place names its field: `fix`, `pull` or `force`.
    pub fn setup(&self, model: &Model) -> Result<Setup, InvalidInput> {
        let (mut fix, mut pull, mut forces) = (Vec::new(), Vec::new(), Vec::new());
        for Grip { elements, way, .. } in self.grips(model)? {
            match way {
                None => fix.extend(elements),
                Some(way) => pull.extend(elements.into_iter().map(|element| (element, way.clone()))),
            }
        }
        for LoadedPlace { place, force } in &self.force {
            forces.extend(elements_of(model, "force", place)?.into_iter().map(|element| (element, Vec3::from(*force))));
        }
        let options = EnergyOptions {
            alpha: self.alpha,
            tau: self.tau,
            max_iterations: self.max_iterations as usize,
            seed: self.seed,
            ..EnergyOptions::default()
        };
        let gravity = self.gravity.map_or_else(Vec3::zeros, Vec3::from);
        let floor = self.floor.map(|height| (height - model.origin.z) / model.unit);
        let bend = self.bend.map(|curvature| curvature.map(|k| k * model.unit));
        Ok(Setup { fix, pull, gravity, forces, floor, bend, steps: self.steps, drag: self.drag, options })
    }
}
