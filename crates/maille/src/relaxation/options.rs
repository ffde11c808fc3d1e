//! Options of the energy method, with what a record needs to repeat a run.

use crate::{
    model::Model,
    relaxation::{
        ContactOptions, HessianMethod, MinimaMethod, barrier::ContactLaw, flat::FLAT_CURVATURE, target::Protocol,
    },
    solver::newton::NewtonOptions,
};
use maille_design::InvalidInput;
use serde::{Deserialize, Serialize};

/// How the energy is minimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Minimiser {
    /// Newton's iteration with floored eigenvalues.
    #[default]
    Newton,
    /// Newton's iteration with growing shifts γ 1 of the Hessian (Algorithm 4.3.2), trials from the same point.
    NewtonShifted,
    /// Algorithm 4.3.2 to the letter: trials add up, γ is not reset.
    NewtonPrinted,
    /// Plain gradient descent, which the thesis rejects.
    GradientDescent,
}

/// Parameters of the energy method. Lengths are in units of the design's reference radius R, energies in β R².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyOptions {
    /// How a deformation is imposed and judged.
    pub protocol: Protocol,
    /// Weight of the contacts, α/β.
    pub alpha: f64,
    /// Weight of E_b, k_b/β (corner protocol).
    pub corner_weight: f64,
    /// Threshold τ: on |F − F_target| (strain protocol), or on a corner's distance in R (corner protocol).
    pub tau: f64,
    /// Step of l1.
    pub l1_step: f64,
    /// The bisection stops at this width of l1.
    pub l1_resolution: f64,
    /// Non-minimal points on each side of a contact (§4.1.2).
    pub samples: usize,
    /// Spacing of those points, radians; `None`: from the expected width of an overlap.
    pub sample_spacing_rad: Option<f64>,
    /// How the Hessian is found.
    pub hessian: HessianMethod,
    /// How minima are found.
    pub minima: MinimaMethod,
    /// Newton iterations of one run at most.
    pub max_iterations: usize,
    /// Seed of the kicks that end stalls.
    pub seed: u64,
    /// Keep every step of every run with its size and time.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub steps: bool,
    /// What an overlap costs.
    #[serde(default)]
    pub contact_law: ContactLaw,
    /// How the energy is minimised.
    #[serde(default)]
    pub minimiser: Minimiser,
    /// Refuse steps that flip a side sign (§4.3.3).
    #[serde(default)]
    pub side_signs: bool,
    /// |gradient| of a run that is at rest, in β R.
    #[serde(default = "gradient_tolerance")]
    pub gradient_tolerance: f64,
    /// Points on each circle of a pair that touches along nearly the whole circle; 0: minima alone, as in records of before.
    #[serde(default)]
    pub flat_points: usize,
}

fn gradient_tolerance() -> f64 {
    1e-6
}

impl Default for EnergyOptions {
    fn default() -> Self {
        EnergyOptions {
            protocol: Protocol::Strain,
            alpha: 1e5,
            corner_weight: 100.0,
            tau: 1e-4,
            l1_step: 0.05,
            l1_resolution: 5e-4,
            samples: 1,
            sample_spacing_rad: None,
            hessian: HessianMethod::Analytic,
            minima: MinimaMethod::Enumeration,
            max_iterations: 400,
            seed: 1,
            steps: false,
            contact_law: ContactLaw::Barrier,
            minimiser: Minimiser::Newton,
            side_signs: false,
            gradient_tolerance: gradient_tolerance(),
            flat_points: 64,
        }
    }
}

/// l1 is not raised beyond this.
pub(super) const L1_MOST: f64 = 20.0;
/// l1 is not lowered beyond this.
pub(super) const L1_LEAST: f64 = -0.95;
/// Floor of the curvature in Newton's step, in β.
pub(super) const CURVATURE_FLOOR: f64 = 1e-3;
/// Negative curvature that makes a saddle, in β.
pub(super) const SADDLE_TOLERANCE: f64 = 1e-5;
/// Random kicks in a run.
pub(super) const MAX_KICKS: usize = 3;

/// The options with everything that follows from them or is fixed: what a record needs to repeat a run.
#[doc(hidden)]
#[derive(Clone, Debug, Serialize)]
pub struct EnergyParameters {
    #[serde(flatten)]
    options: EnergyOptions,
    sample_offsets_rad: Vec<f64>,
    flat_curvature: f64,
    curvature_floor: f64,
    saddle_tolerance: f64,
    max_kicks: usize,
    l1_least: f64,
    l1_most: f64,
}

impl EnergyOptions {
    /// As many points as can follow a flat pair's circle; 0 is allowed beside these.
    #[doc(hidden)]
    pub const FLAT_POINTS: std::ops::RangeInclusive<usize> = 16..=1024;

    /// Whether they can be used.
    ///
    /// # Errors
    /// For a length, weight or angle that is not positive, and a number of points out of range.
    pub(crate) fn check(&self) -> Result<(), InvalidInput> {
        let positive = [
            ("alpha", self.alpha),
            ("corner_weight", self.corner_weight),
            ("gradient_tolerance", self.gradient_tolerance),
            ("tau", self.tau),
            ("l1_step", self.l1_step),
            ("l1_resolution", self.l1_resolution),
            ("sample_spacing_rad", self.sample_spacing_rad.unwrap_or(1.0)),
        ];
        if let Some((name, x)) = positive.into_iter().find(|(_, x)| !(x.is_finite() && *x > 0.0)) {
            return Err(InvalidInput::new(name, format!("{name} = {x} is not positive"), "give a positive number"));
        }
        if self.flat_points != 0 && !Self::FLAT_POINTS.contains(&self.flat_points) {
            let problem = format!("flat_points = {} is out of range", self.flat_points);
            let (least, most) = (Self::FLAT_POINTS.start(), Self::FLAT_POINTS.end());
            return Err(InvalidInput::new(
                "flat_points",
                problem,
                format!("give 0, or a whole number from {least} to {most}"),
            ));
        }
        Ok(())
    }

    /// All parameters and tolerances of a run on `model`.
    #[doc(hidden)]
    pub fn parameters(&self, model: &Model) -> EnergyParameters {
        EnergyParameters {
            options: self.clone(),
            sample_offsets_rad: self.sample_offsets_rad(model),
            flat_curvature: FLAT_CURVATURE,
            curvature_floor: CURVATURE_FLOOR,
            saddle_tolerance: SADDLE_TOLERANCE,
            max_kicks: MAX_KICKS,
            l1_least: L1_LEAST,
            l1_most: L1_MOST,
        }
    }

    /// The contact energy on `model`.
    #[doc(hidden)]
    pub fn contacts(&self, model: &Model) -> ContactOptions {
        ContactOptions {
            law: self.contact_law,
            alpha: self.alpha,
            sample_offsets_rad: self.sample_offsets_rad(model),
            minima: self.minima,
            flat_points: self.flat_points,
        }
    }

    /// Tolerances of one minimisation.
    #[doc(hidden)]
    pub fn newton(&self) -> NewtonOptions {
        NewtonOptions {
            gradient_tolerance: self.gradient_tolerance,
            curvature_floor: CURVATURE_FLOOR,
            saddle_tolerance: SADDLE_TOLERANCE,
            max_iterations: self.max_iterations,
            max_kicks: MAX_KICKS,
        }
    }

    /// Offsets of the non-minimal points. The default spacing follows the overlap that balances the pull at the
    /// threshold: depth p = √(4 β τ r̂ / (3 α)), half width √(2 r̂ p) / R; the points divide the half width evenly.
    #[doc(hidden)]
    pub fn sample_offsets_rad(&self, model: &Model) -> Vec<f64> {
        let touching = 2.0 * model.rings.iter().map(|r| r.minor_radius).sum::<f64>() / model.rings.len() as f64;
        let depth = (4.0 * self.tau * touching / (3.0 * self.alpha)).sqrt();
        let half_width = (2.0 * touching * depth).sqrt() / model.largest_radius;
        let spacing = self.sample_spacing_rad.unwrap_or(half_width / (self.samples as f64 + 1.0));
        (1..=self.samples).flat_map(|k| [-(k as f64) * spacing, k as f64 * spacing]).collect()
    }
}
