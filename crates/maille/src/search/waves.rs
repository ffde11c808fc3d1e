//! Whether a limit of one cell is one of every larger cell, to second order: the least curvature on waves, see
//! [`crate::program::waves`].
//!
//! Wave vectors are tried that fit into a cell of up to [`MOST_COPIES`] copies, and the worst of them is moved while that makes it
//! worse. Between them nothing is proved: the motions that keep the contacts change with q by leaps.
//!
//! Where the curvature is positive, one set of forces is enough to show that the state is a strict maximum along that wave, zero modes
//! aside. Where it is negative, another set could still balance and hold; so a wave is followed, and what counts is what is found.

use super::{
    local::LocalSolution,
    multistart::{Multistart, Target},
    options::{ATTAINED, WAVE_SIZE},
    starts::{Start, moved, tiled},
};
use crate::{
    answer::WaveCurvature,
    lattice::Cell,
    model::Model,
    program::{
        SheetProgram,
        waves::{WaveMode, Waves},
    },
};
use std::f64::consts::TAU;

/// Copies of the design's cell in the cells whose waves are tried.
pub(super) const MOST_COPIES: usize = 6;
/// Elements in such a cell, and in the one that is solved.
pub(super) const MOST_ELEMENTS: usize = 40;
/// Steps with which the worst wave vector is moved, in 2π.
const STEPS: [f64; 4] = [1.0 / 12.0, 1.0 / 24.0, 1.0 / 48.0, 1.0 / 96.0];

/// What was found of the waves at a solution.
#[derive(Default)]
pub(super) struct FoundWaves {
    /// That of least curvature.
    pub least: Option<WaveMode>,
    /// Those of negative curvature that fit into a cell of a few copies, worst first.
    pub unstable: Vec<WaveMode>,
}

/// The wave vectors of order `n`: multiples of 2π/n, n copies of the cell along them. One of q and −q, which are the same real motions.
fn of_order(n: i32) -> impl Iterator<Item = [f64; 2]> {
    fn divisor(a: i32, b: i32) -> i32 {
        if b == 0 { a } else { divisor(b, a % b) }
    }
    let all = (0..n).flat_map(move |k| (0..n).map(move |l| [k, l]));
    let new = move |&[k, l]: &[i32; 2]| divisor(divisor(k, l), n) == 1 && [k, l] <= [(n - k) % n, (n - l) % n];
    // From −π to π.
    let phase = move |k: i32| TAU * f64::from(if 2 * k > n { k - n } else { k }) / f64::from(n);
    all.filter(new).map(move |q| q.map(phase))
}

/// How many copies of this model the waves are tried of; fewer than two: none.
fn most_orders(model: &Model) -> i32 {
    let elements = model.elements.len();
    if elements > MOST_ELEMENTS || !model.periodic {
        return 0;
    }
    (MOST_COPIES / model.cell.copies()).min(MOST_ELEMENTS / elements).clamp(2, MOST_COPIES) as i32
}

impl FoundWaves {
    /// Of up to `orders` copies.
    fn of(waves: &Waves, orders: i32) -> Self {
        let tried = (2..=orders).flat_map(of_order).filter_map(|q| waves.least(q));
        let mut tried: Vec<WaveMode> = tried.collect();
        // Of equals the first: a stable sort.
        tried.sort_by(|a, b| a.curvature.total_cmp(&b.curvature));
        let Some(first) = tried.first().cloned() else { return FoundWaves::default() };
        let least = if first.curvature < 0.0 { worsened(waves, first) } else { first };
        tried.retain(|mode| mode.curvature < 0.0);
        FoundWaves { least: Some(least), unstable: tried }
    }

    /// What a record says of it.
    pub fn curvature(&self) -> Option<WaveCurvature> {
        let turns = |phase: f64| phase / TAU;
        self.least.as_ref().map(|mode| WaveCurvature { least: mode.curvature, q: mode.phases_rad.map(turns) })
    }
}

/// The wave vector moved along its components, by smaller and smaller steps, while the least curvature sinks.
fn worsened(waves: &Waves, mut worst: WaveMode) -> WaveMode {
    for step in STEPS {
        let [q1, q2] = worst.phases_rad;
        let by = TAU * step;
        for q in [[q1 + by, q2], [q1 - by, q2], [q1, q2 + by], [q1, q2 - by]] {
            if let Some(mode) = waves.least(q).filter(|mode| mode.curvature < worst.curvature) {
                worst = mode;
            }
        }
    }
    worst
}

impl<T: Target> Multistart<'_, T> {
    /// The waves at a certified solution; none where its bound proves it.
    pub(super) fn waves(&self, model: &Model, best: &LocalSolution) -> FoundWaves {
        let orders = most_orders(model);
        if !best.certified || (best.value() - self.upper_bound).abs() <= ATTAINED || orders < 2 {
            return FoundWaves::default();
        }
        let family = self.target.family(model);
        let program = SheetProgram::new(model, &family).with_flat_pairs(best.flat.clone());
        let x = program.posed(best.state.clone(), best.p.clone());
        FoundWaves::of(&program.waves(&x, &best.certificate.multipliers), orders)
    }
}

impl FoundWaves {
    /// The cell of the fewest copies that holds the worst wave, if none of `cells` holds it.
    pub fn further_cell(&self, cells: &[Model]) -> Option<Cell> {
        let worst = self.unstable.first()?;
        if cells.iter().any(|model| model.cell.holds_wave(worst.phases_rad)) {
            return None;
        }
        let elements = cells[0].elements.len();
        (2..=MOST_COPIES.min(MOST_ELEMENTS / elements) as i32)
            .flat_map(Cell::of_copies)
            .find(|cell| cell.holds_wave(worst.phases_rad))
    }

    /// The state of the first cell repeated over a larger one and moved along each unstable wave that fits into it, both ways.
    pub fn starts(&self, model: &Model, from: &Start) -> Vec<Start> {
        let fitting: Vec<&WaveMode> =
            self.unstable.iter().filter(|wave| model.cell.holds_wave(wave.phases_rad)).collect();
        if fitting.is_empty() {
            return Vec::new();
        }
        let copies = tiled(model, &from.state);
        let along = |wave: &WaveMode, size: f64| {
            let state = moved(model, &copies, wave.motion(&model.cell.cosets(), size));
            Start { state, ..from.clone() }
        };
        fitting.into_iter().flat_map(|wave| [WAVE_SIZE, -WAVE_SIZE].map(|size| along(wave, size))).collect()
    }
}
