//! Starts of a search: states, and how they are perturbed and repeated over larger cells.

use super::options::{
    BUCKLED_HEIGHT, BUCKLED_SHARE, BUCKLED_STEPS, BUCKLED_WAVES, EXPLORATIONS, Exploration, FIRST_RADIUS, MOST_TURNS,
    STRAIGHT, TURN_BLOCKED, TURN_SHIFT, TURN_SIZE_RAD, TURN_STEPS, TURNS, UNTURNED_SHARE,
};
use crate::{
    lattice::Cell,
    model::Model,
    state::{Pose, State},
    topology::{motion::Motion, step_bound::StepBound},
};
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Vector2};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::f64::consts::TAU;

/// A state from which a search begins, with the strains of its lattice where it is stretched along a direction.
#[derive(Clone)]
pub(super) struct Start {
    pub state: State,
    pub l1: f64,
    pub l2: f64,
    pub shear: f64,
    /// How the search goes on from it.
    pub route: Route,
}

/// How a search goes on from a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Route {
    /// Wires with which the value is maximised first, as shares of the model's: the sheet locks in other places with them.
    pub wires: &'static [f64],
    /// First half width of the trust box: with a wide one the first steps pass over what narrow ones run into.
    pub first_radius: f64,
}

impl Route {
    /// With the model's own wire at once.
    pub(super) const DIRECT: Route = Route { wires: &[], first_radius: FIRST_RADIUS };
}

impl Start {
    /// A state with the written lattice.
    pub(crate) fn written(state: State) -> Self {
        Start { state, l1: 0.0, l2: 0.0, shear: 0.0, route: Route::DIRECT }
    }
}

/// What random numbers are for: each use has streams of its own.
#[derive(Clone, Copy)]
pub(super) enum Use {
    /// The start of this number.
    Start,
    /// A solve of this number that begins again without a certificate.
    Restart,
    /// A retry of this number just short of the bound.
    Retry,
    /// The larger cell of this number.
    Cell,
    /// A start of this number that overlaps.
    Freeing,
    /// The buckled start of this number.
    Buckling,
    /// The turned start of this number.
    Turning,
}

/// The random numbers of one use.
pub(super) fn rng(seed: u64, what: Use, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream((what as u64) << 32 | number);
    rng
}

/// The start of number `k` in a cell: the design's state, every element moved and turned at random in some steps, no circle
/// across another; see [`EXPLORATIONS`]. Of a design with curves most are [`turned`].
pub(super) fn explored(model: &Model, seed: u64, k: usize) -> Start {
    match k % UNTURNED_SHARE {
        _ if model.is_round() => walked(model, seed, k),
        0 => walked(model, seed, k / UNTURNED_SHARE),
        _ => turned(model, seed, k),
    }
}

/// The design's state, its elements turned one after the other, each by up to [`TURN_SIZE_RAD`] about every axis, as far as no curve can
/// meet another. A curve fits through another in many ways, and small motions do not lead from one to the next.
fn turned(model: &Model, seed: u64, k: usize) -> Start {
    let mut stream = rng(seed, Use::Turning, k as u64);
    let elements = model.elements.len();
    let first = stream.random_range(0..elements);
    let mut state = model.start.clone();
    for element in (first..).take((TURNS * elements).min(MOST_TURNS)).map(|turn| turn % elements) {
        let mut vector =
            |size: f64| Vec3::from_fn(|_, _| size * stream.random_range(-1.0..1.0)) / f64::from(TURN_STEPS);
        let mut motion = Motion { elements: vec![(Vec3::zeros(), Vec3::zeros()); elements], ..Motion::default() };
        motion.elements[element] = (vector(TURN_SHIFT), vector(TURN_SIZE_RAD));
        for _ in 0..TURN_STEPS {
            let fraction = largest_fraction(model, &state, &motion);
            state = moved_by(&state, &motion, fraction);
            if fraction < TURN_BLOCKED {
                break;
            }
        }
    }
    Start::written(state)
}

/// The walk of number `k`, of the kind whose turn it is.
fn walked(model: &Model, seed: u64, k: usize) -> Start {
    let Exploration { steps, size, wires, first_radius } = EXPLORATIONS[k % EXPLORATIONS.len()];
    let mut stream = rng(seed, Use::Start, k as u64);
    let state = (0..steps).fold(model.start.clone(), |state, _| perturbed(model, &state, size, &mut stream));
    Start { route: Route { wires, first_radius }, ..Start::written(state) }
}

/// The start of number `k` of a search for a fold: every third one is buckled, the others are [`explored`].
pub(super) fn explored_or_buckled(model: &Model, seed: u64, k: usize) -> Start {
    match k % BUCKLED_SHARE {
        2 => buckled(model, seed, k),
        _ => explored(model, seed, k - k / BUCKLED_SHARE),
    }
}

/// The design's state with its elements moved out of the plane in a wave that repeats with the cell, each tilted as the wave slopes:
/// z = h cos(q·x + φ), with q along one vector of the reciprocal lattice, the other, or both, in turn, and height and phase
/// drawn; less where circles could meet.
fn buckled(model: &Model, seed: u64, k: usize) -> Start {
    let mut stream = rng(seed, Use::Buckling, k as u64);
    let state = perturbed(model, &model.start, STRAIGHT, &mut stream);
    let Some(inverse) = Matrix2::from_columns(&[state.a1.xy(), state.a2.xy()]).try_inverse() else {
        return Start::written(state);
    };
    let periods = BUCKLED_WAVES[k / BUCKLED_SHARE % BUCKLED_WAVES.len()];
    let wave = inverse.transpose() * Vector2::from(periods) * TAU;
    let phase_rad = stream.random_range(0.0..TAU);
    let height = stream.random_range(BUCKLED_HEIGHT);
    let out_of_plane = |pose: &Pose| {
        let at_rad = wave.dot(&pose.position.xy()) + phase_rad;
        let slope = wave * (-height * at_rad.sin());
        let steepness = slope.norm();
        // Turned about the horizontal axis across the slope.
        let turn = Vec3::new(slope.y, -slope.x, 0.0) * if steepness > 0.0 { steepness.atan() / steepness } else { 0.0 };
        (Vec3::z() * (height * at_rad.cos()), turn)
    };
    let steps = f64::from(BUCKLED_STEPS);
    let part = |pose: &Pose| {
        let (shift, turn) = out_of_plane(pose);
        (shift / steps, turn / steps)
    };
    let elements: Vec<(Vec3, Vec3)> = state.poses.iter().map(part).collect();
    let motion = Motion { elements, ..Motion::default() };
    Start::written((0..BUCKLED_STEPS).fold(state, |state, _| moved(model, &state, &motion)))
}

/// [`explored`] without a change of the wire on the way.
pub(super) fn explored_with_own_wire(model: &Model, seed: u64, k: usize) -> Start {
    let start = explored(model, seed, k);
    Start { route: Route { wires: &[], ..start.route }, ..start }
}

/// `state` with its elements moved and turned by up to `size`, in R and radians; less where circles could meet.
pub(super) fn perturbed(model: &Model, state: &State, size: f64, rng: &mut ChaCha8Rng) -> State {
    let mut vector = || Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
    let elements = state.poses.iter().map(|_| (vector(), vector())).collect();
    moved(model, state, &Motion { elements, ..Motion::default() })
}

/// `state` after a motion of its elements; after less of it where circles could meet.
pub(super) fn moved(model: &Model, state: &State, motion: &Motion) -> State {
    moved_by(state, motion, largest_fraction(model, state, motion))
}

/// The part of a motion of elements in which no circles can meet.
fn largest_fraction(model: &Model, state: &State, motion: &Motion) -> f64 {
    StepBound::new(model, state).largest_fraction(model, motion, f64::INFINITY)
}

/// `state` after this part of a motion of its elements.
fn moved_by(state: &State, motion: &Motion, fraction: f64) -> State {
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
        let image = state.image(image);
        let poses = &state.poses[copy * elements..(copy + 1) * elements];
        poses.iter().map(move |pose| image.pose(pose))
    });
    let [a1, a2] = of.primitive(state.a1, state.a2);
    let [a1, a2] = model.cell.vectors(a1, a2);
    State { poses: poses.collect(), a1, a2, roll: state.roll.map(|roll| roll.in_cell(of, model.cell)) }
}
