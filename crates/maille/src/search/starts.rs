//! Starts of a search: states, and how they are perturbed and repeated over larger cells.

use super::options::PERTURBATIONS;
use crate::{
    lattice::Cell,
    model::Model,
    state::{Pose, State},
    topology::step_bound::{Motion, StepBound},
};
use maille_geometry::Vec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// A state from which a search begins, with the strains of its lattice where it is stretched along a direction.
#[derive(Clone)]
pub(super) struct Start {
    pub state: State,
    pub l1: f64,
    pub l2: f64,
    pub shear: f64,
}

impl Start {
    /// A state with the written lattice.
    pub(crate) fn written(state: State) -> Self {
        Start { state, l1: 0.0, l2: 0.0, shear: 0.0 }
    }
}

/// The random numbers of one start, kept apart from those of all others by its seed.
pub(super) fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Starts of a cell: the design's state, every element moved and turned at random, but no circle across another.
pub(super) fn perturbed_starts(model: &Model, seed: u64, numbers: Range<usize>) -> impl Iterator<Item = Start> {
    numbers.map(move |k| {
        let mut stream = rng(seed.wrapping_mul(0x9e37_79b9).wrapping_add(k as u64));
        Start::written(perturbed(model, &model.start, PERTURBATIONS[k % PERTURBATIONS.len()], &mut stream))
    })
}

/// `state` with its elements moved and turned by up to `size`, in R and radians; less where circles could meet.
pub(super) fn perturbed(model: &Model, state: &State, size: f64, rng: &mut ChaCha8Rng) -> State {
    let mut vector = || Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
    let elements = state.poses.iter().map(|_| (vector(), vector())).collect();
    moved(model, state, Motion { elements, lattice: [Vec3::zeros(); 2], carried: false })
}

/// `state` after a motion of its elements; after less of it where circles could meet.
pub(super) fn moved(model: &Model, state: &State, motion: Motion) -> State {
    let fraction = StepBound::new(model, state).largest_fraction(model, &motion, f64::INFINITY);
    let moved = state
        .poses
        .iter()
        .zip(&motion.elements)
        .map(|(p, (shift, turn))| p.moved(&(shift * fraction), &(turn * fraction)));
    State { poses: moved.collect(), ..state.clone() }
}

/// A state of the cell `of` repeated over the cell of `model`, which consists of copies of it.
pub(super) fn tiled(model: &Model, of: Cell, state: &State) -> State {
    let elements = state.poses.len() / of.copies();
    let poses = model.cell.cosets().into_iter().flat_map(|coset| {
        let (copy, image) = of.copy_at(coset);
        let shift = state.translation(image);
        let poses = &state.poses[copy * elements..(copy + 1) * elements];
        poses.iter().map(move |pose| Pose { position: pose.position + shift, ..*pose })
    });
    let [a1, a2] = of.primitive(state.a1, state.a2);
    let [a1, a2] = model.cell.vectors(a1, a2);
    State { poses: poses.collect(), a1, a2 }
}
