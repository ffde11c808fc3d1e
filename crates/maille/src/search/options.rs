//! What a search takes from its user, and the tolerances that it takes by itself, as they go into the record. Those of the solver are
//! in `crate::solver`.
//!
//! Lengths are in reference radii R, angles in radians, values in the unit of what is sought (strain, or R for a clearance).

use crate::{
    lattice::Across,
    question::Effort,
    solver::certificate::{GAP_TOLERANCE, RESIDUAL_TOLERANCE},
};
use serde::{Deserialize, Serialize};

/// What a user chooses of the exact method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExactOptions {
    /// How many starts are tried where the bound is not attained: the neighbouring limit's state, with the width free those of held
    /// widths, then states that are drawn.
    #[serde(default)]
    pub effort: Effort,
    /// So many starts in place of an effort.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    pub seed: u64,
    /// Whether width and shear are held or left to the sheet.
    #[serde(default)]
    pub across: Across,
    /// Whether l1 is made as small as can be, not as large.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub compression: bool,
}

impl Default for ExactOptions {
    fn default() -> Self {
        ExactOptions { effort: Effort::Normal, starts: None, seed: 1, across: Across::HELD, compression: false }
    }
}

/// What a user chooses of the search for an extreme.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtremeOptions {
    /// Whether the lattice may change; that of a closest cell always may.
    pub lattice_free: bool,
    /// How long it is searched.
    pub effort: Effort,
    /// So many starts in place of an effort.
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    pub seed: u64,
}

impl Default for ExtremeOptions {
    fn default() -> Self {
        ExtremeOptions { lattice_free: true, effort: Effort::Normal, starts: None, seed: 1 }
    }
}

/// Values that differ by less are the same.
pub(super) const SAME_VALUE: f64 = 1e-7;
/// A bound is attained within this.
pub(super) const ATTAINED: f64 = 1e-9;
/// A state is feasible if no gap is below minus this.
pub(super) const FEASIBLE: f64 = 1e-9;

/// A way to explore the states of a sheet from that of the design.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Exploration {
    /// Random motions of all elements, one after the other.
    pub steps: usize,
    /// Size of each, in R and radians.
    pub size: f64,
    /// Wires with which the value is maximised first, as shares of the model's.
    pub wires: &'static [f64],
    /// First half width of the trust box, in R and radians.
    pub first_radius: f64,
}

/// First half width of the trust box, in R and radians, where nothing else is said.
pub(super) const FIRST_RADIUS: f64 = 0.1;

const fn exploration(steps: usize, size: f64, wires: &'static [f64], first_radius: f64) -> Exploration {
    Exploration { steps, size, wires, first_radius }
}

/// Starts take these in turn. No one of them finds every limit, and more of one kind finds little more: which wire the sheet is
/// first pulled with, and how long the first steps are, decides where it locks (decision 19 has the measurement).
pub(super) const EXPLORATIONS: [Exploration; 8] = [
    exploration(1, 0.03, &[], FIRST_RADIUS),
    exploration(20, 0.1, &[0.5, 0.8], FIRST_RADIUS),
    exploration(20, 0.1, &[1.5, 1.2], FIRST_RADIUS),
    exploration(1, 0.1, &[], 0.4),
    exploration(20, 0.1, &[2.0, 1.5, 1.2], FIRST_RADIUS),
    exploration(1, 0.3, &[], FIRST_RADIUS),
    exploration(20, 0.1, &[0.2, 0.5, 0.8], FIRST_RADIUS),
    exploration(20, 0.1, &[], 0.03),
];
/// Of a design with curves one of so many starts is one of these, the others are turned, see [`super::starts`] (decision 19 has the
/// measurement).
pub(super) const UNTURNED_SHARE: usize = 4;
/// Turns of each element of a turned start.
pub(super) const TURNS: usize = 4;
/// Turns of all elements together, at most.
pub(super) const MOST_TURNS: usize = 24;
/// Largest angle of a turn about each axis, in radians.
pub(super) const TURN_SIZE_RAD: f64 = 2.0;
/// Largest shift along each axis that goes with it, in R.
pub(super) const TURN_SHIFT: f64 = 0.6;
/// A turn is made in so many steps, each as far as no curve can meet another.
pub(super) const TURN_STEPS: u32 = 10;
/// A turn ends with a step of which less than this part is possible.
pub(super) const TURN_BLOCKED: f64 = 0.1;
/// One of so many starts of a least stretch is buckled, see [`super::starts`].
pub(super) const BUCKLED_SHARE: usize = 3;
/// Its waves, in periods along the cell's two vectors: they take turns.
pub(super) const BUCKLED_WAVES: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
/// Its height is drawn from these, in R.
pub(super) const BUCKLED_HEIGHT: std::ops::Range<f64> = 0.2..1.0;
/// Its elements are moved in so many steps, each as far as no circle can meet another.
pub(super) const BUCKLED_STEPS: u32 = 4;
/// A solve with another wire pauses when its steps are shorter than this: only where it goes matters.
pub(super) const WIRE_PAUSE: f64 = 1e-2;
/// Size of the perturbation of a start that goes straight from the design's state: it only breaks symmetries.
pub(super) const STRAIGHT: f64 = 0.003;

/// Rounds of maximising and polishing of one local maximisation.
pub(super) const ROUNDS: usize = 10;
/// A round in a larger cell that uses up its iterations for less than this is the last one: a perturbed state gets further in
/// less time.
pub(super) const STALLED_GAIN: f64 = 1e-3;
/// After a round in a larger cell that changed the value by less than this,
pub(super) const SLOW_GAIN: f64 = 1e-5;
/// the next one has this many quadratic programs at most: what has no certificate by then mostly gets none.
pub(super) const SLOW_ITERATIONS: usize = 40;
/// A start in a larger cell is given up where so many times what its last round gained
pub(super) const HOPELESS_ROUNDS: f64 = 10.0;
/// (this at least) leaves it below the best value of its cell.
pub(super) const HOPELESS_GAIN: f64 = 1e-4;
/// A local maximisation without a certificate begins again from a perturbed state so often.
pub(super) const RESTARTS: usize = 6;
/// The same in larger cells, where it is costly.
pub(super) const LARGER_CELL_RESTARTS: usize = 1;
/// Size of the first of these perturbations; the next ones are multiples.
pub(super) const RESTART_SIZE: f64 = 0.003;

/// A certified value is short of its bound by less than this: it is perturbed and solved again.
pub(super) const BOUND_RETRY_GAP: f64 = 1e-6;
/// So many times at most.
pub(super) const BOUND_RETRIES: u64 = 3;
/// Size of that perturbation.
pub(super) const BOUND_RETRY_SIZE: f64 = 0.003;

/// A force between an element and its own image above this (per unit of what is maximised) calls for a larger cell.
pub(super) const OWN_IMAGE_FORCE: f64 = 1e-6;
/// Perturbation of the smaller cell's state, repeated over a larger cell.
pub(super) const CELL_PERTURBATION: f64 = 0.1;
/// A larger cell takes the least number of starts divided by this,
pub(super) const CELL_SHARE: u64 = 3;
/// by this where a fold is sought,
pub(super) const FOLD_SHARE: u64 = 2;
/// and at most this of a given number.
pub(super) const CELL_STARTS: u64 = 3;

/// What the value gives way, relative to 1 + |value|, while the ranges of what is free are found.
pub(super) const FREE_SLACK: f64 = 1e-6;
/// Solves for an end of such a range, each from where the last one paused.
pub(super) const RANGE_ROUNDS: usize = 3;
/// Largest component of the motion along an unstable wave with which a larger cell begins, in R and radians.
pub(super) const WAVE_SIZE: f64 = 0.05;
/// Copies of the design's cell in the cells whose waves are tried, and in those to which one leads.
pub(super) const WAVE_COPIES: usize = 6;
/// Elements of a cell whose waves are tried.
pub(super) const WAVE_ELEMENTS: usize = 40;
/// Elements in a cell to which a wave leads: its solves are costly.
pub(super) const FOLLOWED_ELEMENTS: usize = 20;
/// With l2 free: distance of the held l2 whose limits are starts.
pub(super) const LATERAL_STEP: f64 = 0.125;
/// As many of the largest of them are starts.
pub(super) const LATERAL_STARTS: usize = 3;
/// With l2 free: how often the limit with l2 held where it was found is asked for, at most.
pub(super) const LATERAL_ROUNDS: usize = 3;

/// Stages of a pull that no chain of links binds: each is twice as long as the one before, up to l1 = 128.
pub(super) const UNLINKED_STAGES: i32 = 10;
/// The first of them.
pub(super) const UNLINKED_STAGE: f64 = 0.125;

/// An overlap of the start below this is left to the search of a limit, which may begin with it.
pub(super) const SLIGHT_OVERLAP: f64 = 1e-6;
/// Sizes of the perturbations with which a start that overlaps is freed; the first is the start itself.
pub(super) const FREEING_PERTURBATIONS: [f64; 4] = [0.0, 0.03, 0.1, 0.3];

/// Minor radius with which the search for the thickest wire begins, as a share of the design's: thin, so that elements find
/// their places.
pub(super) const THIN_WIRE: f64 = 0.2;

/// The options with everything that is fixed: what a record needs to repeat a run.
#[doc(hidden)]
#[derive(Clone, Debug, Serialize)]
pub struct ExactParameters {
    #[serde(flatten)]
    options: ExactOptions,
    gap_tolerance: f64,
    residual_tolerance: f64,
    feasible_within: f64,
    bound_attained_within: f64,
    same_value_within: f64,
    first_radius: f64,
    explorations: [Exploration; 8],
    unturned_share: usize,
    turns: usize,
    most_turns: usize,
    turn_size_rad: f64,
    turn_shift: f64,
    turn_steps: u32,
    turn_blocked: f64,
    wire_pause: f64,
    buckled_share: usize,
    buckled_waves: [[f64; 2]; 4],
    buckled_height: [f64; 2],
    buckled_steps: u32,
    straight_perturbation: f64,
    rounds: usize,
    stalled_gain: f64,
    slow_gain: f64,
    slow_iterations: usize,
    hopeless_rounds: f64,
    hopeless_gain: f64,
    restarts: usize,
    larger_cell_restarts: usize,
    restart_size: f64,
    bound_retry_gap: f64,
    bound_retries: u64,
    bound_retry_size: f64,
    own_image_force: f64,
    cell_perturbation: f64,
    cell_share: u64,
    fold_share: u64,
    cell_starts: u64,
    free_slack: f64,
    range_rounds: usize,
    wave_size: f64,
    wave_copies: usize,
    wave_elements: usize,
    followed_elements: usize,
    lateral_step: f64,
    lateral_starts: usize,
    lateral_rounds: usize,
    unlinked_stage: f64,
    unlinked_stages: i32,
    slight_overlap: f64,
    freeing_perturbations: [f64; 4],
    thin_wire: f64,
}

impl ExactOptions {
    /// All parameters and tolerances of a run.
    #[doc(hidden)]
    pub fn parameters(&self) -> ExactParameters {
        ExactParameters {
            options: self.clone(),
            gap_tolerance: GAP_TOLERANCE,
            residual_tolerance: RESIDUAL_TOLERANCE,
            feasible_within: FEASIBLE,
            bound_attained_within: ATTAINED,
            same_value_within: SAME_VALUE,
            first_radius: FIRST_RADIUS,
            explorations: EXPLORATIONS,
            unturned_share: UNTURNED_SHARE,
            turns: TURNS,
            most_turns: MOST_TURNS,
            turn_size_rad: TURN_SIZE_RAD,
            turn_shift: TURN_SHIFT,
            turn_steps: TURN_STEPS,
            turn_blocked: TURN_BLOCKED,
            wire_pause: WIRE_PAUSE,
            buckled_share: BUCKLED_SHARE,
            buckled_waves: BUCKLED_WAVES,
            buckled_height: [BUCKLED_HEIGHT.start, BUCKLED_HEIGHT.end],
            buckled_steps: BUCKLED_STEPS,
            straight_perturbation: STRAIGHT,
            rounds: ROUNDS,
            stalled_gain: STALLED_GAIN,
            slow_gain: SLOW_GAIN,
            slow_iterations: SLOW_ITERATIONS,
            hopeless_rounds: HOPELESS_ROUNDS,
            hopeless_gain: HOPELESS_GAIN,
            restarts: RESTARTS,
            larger_cell_restarts: LARGER_CELL_RESTARTS,
            restart_size: RESTART_SIZE,
            bound_retry_gap: BOUND_RETRY_GAP,
            bound_retries: BOUND_RETRIES,
            bound_retry_size: BOUND_RETRY_SIZE,
            own_image_force: OWN_IMAGE_FORCE,
            cell_perturbation: CELL_PERTURBATION,
            cell_share: CELL_SHARE,
            fold_share: FOLD_SHARE,
            cell_starts: CELL_STARTS,
            free_slack: FREE_SLACK,
            range_rounds: RANGE_ROUNDS,
            wave_size: WAVE_SIZE,
            wave_copies: WAVE_COPIES,
            wave_elements: WAVE_ELEMENTS,
            followed_elements: FOLLOWED_ELEMENTS,
            lateral_step: LATERAL_STEP,
            lateral_starts: LATERAL_STARTS,
            lateral_rounds: LATERAL_ROUNDS,
            unlinked_stage: UNLINKED_STAGE,
            unlinked_stages: UNLINKED_STAGES,
            slight_overlap: SLIGHT_OVERLAP,
            freeing_perturbations: FREEING_PERTURBATIONS,
            thin_wire: THIN_WIRE,
        }
    }
}
