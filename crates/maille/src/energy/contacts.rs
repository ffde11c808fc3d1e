//! Contact energy E_c of a cell: every overlapping local minimum (eq. 4.1.3), and the sampled points beside it (§4.1.2).

use super::barrier::ContactLaw;
use crate::{
    contact::kernel::{Grad, Hess, PairFrame, RootMotion},
    model::Model,
    solve::curvature::Curvature,
    state::State,
    topology::{RingPair, close_pairs},
};
use maille_geometry::{circle_distance_minima, circle_distance_minima_polynomial};
use serde::{Deserialize, Serialize};

/// Which way the minima of the circle–circle distance are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MinimaMethod {
    /// Complete enumeration.
    Enumeration,
    /// The degree-8 polynomial of Appendix A; loses minima in near-degenerate pairs.
    Polynomial,
}

/// Parameters of the contact energy, in units of the reference radius.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactOptions {
    /// What an overlap costs.
    pub law: ContactLaw,
    /// Its weight α (eq. 4.1.1, 4.1.3).
    pub alpha: f64,
    /// Offsets δ of the non-minimal points θ + δ on the second circle (eq. 4.1.4), radians.
    pub sample_offsets_rad: Vec<f64>,
    /// How minima are found.
    pub minima: MinimaMethod,
}

/// An overlapping pair with its frame and the angles on B of its overlapping minima.
struct Overlap {
    pair: RingPair,
    frame: PairFrame,
    contact_distance: f64,
    minima: Vec<(f64, f64)>,
}

fn overlaps(model: &Model, state: &State, options: &ContactOptions) -> Vec<Overlap> {
    close_pairs(model, state, 0.0)
        .into_iter()
        .filter_map(|pair| {
            let a = state.circle(model, pair.ring_a, [0, 0]);
            let b = state.circle(model, pair.ring_b, pair.shift);
            let found = match options.minima {
                MinimaMethod::Enumeration => circle_distance_minima(&a, &b),
                MinimaMethod::Polynomial => circle_distance_minima_polynomial(&a, &b),
            };
            let contact_distance = model.contact_distance(pair.ring_a, pair.ring_b);
            let minima: Vec<(f64, f64)> = found
                .as_slice()
                .iter()
                .filter(|m| m.distance < contact_distance)
                .map(|m| (m.angle_b_rad, m.distance))
                .collect();
            if minima.is_empty() {
                return None;
            }
            let reference_a = state.poses[model.rings[pair.ring_a].element].position;
            let reference_b = state.poses[model.rings[pair.ring_b].element].position + state.translation(pair.shift);
            Some(Overlap { pair, frame: PairFrame::new(&a, &reference_a, &b, &reference_b), contact_distance, minima })
        })
        .collect()
}

/// E_c of one cell.
pub(super) fn energy(model: &Model, options: &ContactOptions, state: &State) -> f64 {
    let mut sum = 0.0;
    for overlap in overlaps(model, state, options) {
        for &(angle, distance) in &overlap.minima {
            sum += options.law.at(distance, overlap.contact_distance, options.alpha)[0];
            for offset in &options.sample_offsets_rad {
                let distance = overlap.frame.distance(angle + offset);
                sum += options.law.at(distance, overlap.contact_distance, options.alpha)[0];
            }
        }
    }
    sum
}

/// Adds gradient and Hessian of E_c; returns E_c.
pub(super) fn add_derivatives(
    model: &Model,
    options: &ContactOptions,
    state: &State,
    gradient: &mut [f64],
    hessian: &mut Curvature,
) -> f64 {
    let mut sum = 0.0;
    for overlap in overlaps(model, state, options) {
        let (mut grad, mut hess) = (Grad::zeros(), Hess::zeros());
        for &(angle, _) in &overlap.minima {
            let root = overlap.frame.jet(angle);
            let motion = RootMotion::at(&root);
            let samples = options
                .sample_offsets_rad
                .iter()
                .filter(|offset| overlap.frame.distance(angle + **offset) < overlap.contact_distance)
                .map(|offset| overlap.frame.jet(angle + offset));
            for jet in std::iter::once(root).chain(samples) {
                let [value, first, second] = options.law.at(jet.distance, overlap.contact_distance, options.alpha);
                let (d_grad, d_hess) = jet.distance_derivatives(&motion);
                sum += value;
                grad += d_grad * first;
                hess += d_hess * first + d_grad * d_grad.transpose() * second;
            }
        }
        scatter(model, &overlap.pair, &grad, &hess, gradient, hessian);
    }
    sum
}

/// Adds a pair's derivatives in y = (x, α, β) to those in the cell's unknowns: x = x_j + s1 a1 + s2 a2 − x_i.
fn scatter(model: &Model, pair: &RingPair, grad: &Grad, hess: &Hess, gradient: &mut [f64], hessian: &mut Curvature) {
    let (i, j) = (model.rings[pair.ring_a].element, model.rings[pair.ring_b].element);
    let lattice = 6 * model.elements.len();
    let (s1, s2) = (f64::from(pair.shift[0]), f64::from(pair.shift[1]));
    let mut entries: Vec<(usize, usize, f64)> = Vec::with_capacity(18);
    for axis in 0..3 {
        if i != j {
            entries.push((axis, 6 * i + axis, -1.0));
            entries.push((axis, 6 * j + axis, 1.0));
        }
        if s1 != 0.0 {
            entries.push((axis, lattice + axis, s1));
        }
        if s2 != 0.0 {
            entries.push((axis, lattice + 3 + axis, s2));
        }
        entries.push((3 + axis, 6 * i + 3 + axis, 1.0));
        entries.push((6 + axis, 6 * j + 3 + axis, 1.0));
    }
    for &(p, column, c) in &entries {
        gradient[column] += c * grad[p];
    }
    hessian.add(&entries, 9, |p, q| hess[(p, q)]);
}
