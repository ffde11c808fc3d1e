//! Whether a limit of one cell is one of every larger cell, to second order: the least curvature on waves, see
//! [`crate::program::waves`].
//!
//! Wave vectors are tried that fit into a cell of up to [`WAVE_COPIES`] copies, and the worst of them is moved while that makes it
//! worse. Between them nothing is proved: the motions that keep the contacts change with q by leaps.
//!
//! Where the curvature is positive, one set of forces is enough to show that the state is a strict maximum along that wave, zero modes
//! aside. Where it is negative, another set could still balance and hold; so a wave is followed, and what counts is what is found.

use super::{
    local::LocalSolution,
    multistart::{CellSearch, FollowedWaves, LargerCells, Multistart, SearchResult, Target},
    options::{ATTAINED, FOLLOWED_ELEMENTS, WAVE_COPIES, WAVE_ELEMENTS, WAVE_SIZE},
    starts::{Start, moved, tiled},
    stop::StopRule,
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

/// Waves along which a search goes on from one state, until one gives more.
const FOLLOWED_WAVES: usize = 3;
/// Steps with which the worst wave vector is moved, in 2π.
const STEPS: [f64; 4] = [1.0 / 12.0, 1.0 / 24.0, 1.0 / 48.0, 1.0 / 96.0];

/// What was found of the waves at a solution.
pub(super) struct FoundWaves {
    /// The cell that was solved.
    of: Cell,
    /// That of least curvature.
    least: Option<WaveMode>,
    /// Those of negative curvature that fit into a cell of a few copies, worst first.
    unstable: Vec<WaveMode>,
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
    if elements > WAVE_ELEMENTS || !model.periodic {
        return 0;
    }
    (WAVE_COPIES / model.cell.copies()).min(WAVE_ELEMENTS / elements).clamp(2, WAVE_COPIES) as i32
}

impl FoundWaves {
    fn none(of: Cell) -> Self {
        FoundWaves { of, least: None, unstable: Vec::new() }
    }

    /// Of up to `orders` copies of the cell.
    fn among(waves: &Waves, of: Cell, orders: i32) -> Self {
        let tried = (2..=orders).flat_map(of_order).filter_map(|q| waves.least(q));
        let mut tried: Vec<WaveMode> = tried.collect();
        // Of equals the first: a stable sort.
        tried.sort_by(|a, b| a.curvature.total_cmp(&b.curvature));
        let Some(first) = tried.first().cloned() else { return FoundWaves::none(of) };
        let least = if first.curvature < 0.0 { worsened(waves, first) } else { first };
        tried.retain(|mode| mode.curvature < 0.0);
        FoundWaves { of, least: Some(least), unstable: tried }
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
            return FoundWaves::none(model.cell);
        }
        let family = self.target.family(model);
        // Waves are known of sheets whose images are translations.
        if family.roll.is_some() {
            return FoundWaves::none(model.cell);
        }
        let program = SheetProgram::new(model, &family).with_flat_pairs(best.flat.clone());
        let x = program.posed(best.state.clone(), best.p.clone());
        FoundWaves::among(&program.waves(&x, &best.certificate.multipliers), model.cell, orders)
    }
}

impl<T: Target> Multistart<'_, T> {
    /// Measures the waves at the best solution of some cells and, where they are followed, goes on along the worst of them, each in
    /// the smallest cell that holds it, until one gives more; that cell is then searched from as many starts
    /// of its own, and the waves of what is best there are followed.
    pub(super) fn follow_waves(&self, models: &[Model], rule: &LargerCells<'_>, found: &mut CellSearch) {
        let most = match rule.waves {
            FollowedWaves::None => 0,
            FollowedWaves::Worst => FOLLOWED_WAVES,
            FollowedWaves::All => usize::MAX,
        };
        loop {
            let (model, Some(best)) = (found.model(models), &found.result.best) else { return };
            let (waves, from) = (self.waves(model, best), self.target.start(best));
            let cells = waves.next_cells(model.elements.len());
            found.wave = waves.curvature();
            let mut improved = false;
            for (cell, wave) in cells.into_iter().take(most) {
                if self.cancelled() || (improved && rule.waves == FollowedWaves::Worst) {
                    break;
                }
                let larger = models[0].in_cell(cell);
                let mut here = self.run(&larger, waves.starts(&larger, wave, &from), StopRule::given_only());
                if here.improves_on(&found.result) {
                    // Where a wave leads further, other states of its cell may, too.
                    here.merge(self.run(&larger, Vec::new(), StopRule::exactly(rule.own_starts)));
                    here = here.with_chance(self.upper_bound);
                }
                found.by_cell.push(here.by_cell(cell));
                if here.improves_on(&found.result) {
                    improved = true;
                    found.further = Some(larger);
                }
                found.result.merge(here);
            }
            if !improved {
                return;
            }
        }
    }
}

/// What the design's own cell gives to a larger one that is solved alone.
#[derive(Default)]
pub(super) struct OwnCell {
    /// Its best state, for the next question.
    pub best: Option<Start>,
    /// Starts of the larger cell: that state repeated, and moved along the worst wave that fits.
    pub starts: Vec<Start>,
    /// Local maximisations that it took.
    pub runs: u64,
    /// Quadratic programs.
    pub iterations: u64,
}

impl<T: Target> Multistart<'_, T> {
    /// Solves the design's own cell `own` for starts of the larger cell `model`. So the larger cell begins with all that the own
    /// cell has reached.
    pub(super) fn own_cell(&self, own: &Model, given: Vec<Start>, rule: StopRule, model: &Model) -> OwnCell {
        let SearchResult { best, runs, iterations, .. } = self.run(own, given, rule);
        let Some(best) = best else { return OwnCell { runs, iterations, ..OwnCell::default() } };
        let (from, waves) = (self.target.start(&best), self.waves(own, &best));
        let repeated = Start { state: tiled(model, own.cell, &from.state), ..from.clone() };
        let fitting = waves.unstable.iter().filter(|wave| model.cell.holds_wave(wave.phases_rad));
        let along = fitting.take(1).flat_map(|wave| waves.starts(model, wave, &from));
        OwnCell { starts: std::iter::once(repeated).chain(along).collect(), best: Some(from), runs, iterations }
    }
}

impl FoundWaves {
    /// The smallest cells into which the unstable waves fit, that of the worst first, each with the worst of its waves.
    fn next_cells(&self, elements: usize) -> Vec<(Cell, &WaveMode)> {
        let fits =
            |n: &i32| *n as usize * self.of.copies() <= WAVE_COPIES && *n as usize * elements <= FOLLOWED_ELEMENTS;
        let mut out: Vec<(Cell, &WaveMode)> = Vec::new();
        for wave in &self.unstable {
            let mut cells = (2..).take_while(fits).flat_map(Cell::of_copies);
            let cell = cells.find(|cell| cell.holds_wave(wave.phases_rad)).and_then(|cell| self.of.repeated(&cell));
            out.extend(cell.filter(|cell| !out.iter().any(|(other, _)| other == cell)).map(|cell| (cell, wave)));
        }
        out
    }

    /// The state of the solved cell repeated over the cell of `model` and moved along a wave; both ways, where the one is not a
    /// translation of the other.
    fn starts(&self, model: &Model, wave: &WaveMode, from: &Start) -> Vec<Start> {
        let copies: Vec<_> = model.cell.cosets().into_iter().map(|coset| self.of.copy_at(coset)).collect();
        let repeated = tiled(model, self.of, &from.state);
        let along = |size: f64| {
            let state = moved(model, &repeated, &wave.motion(&copies, size));
            Start { state, ..from.clone() }
        };
        let order = model.cell.copies() / self.of.copies();
        if order.is_multiple_of(2) { vec![along(WAVE_SIZE)] } else { vec![along(WAVE_SIZE), along(-WAVE_SIZE)] }
    }
}
