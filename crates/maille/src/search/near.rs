//! A limit searched from the state of another design near by, whose rings are linked alike.

use super::{
    multistart::CellStarts,
    starts::{Route, Start},
    stretch::{ExactMethod, Stretch},
};
use crate::{
    answer::Answer,
    lattice::{Across, Direction},
    model::of_cell,
    state::State,
    topology::links_kept,
};
use std::sync::atomic::AtomicBool;

impl ExactMethod<'_> {
    /// One limit with width and shear held, searched from the state of `near` first, the same limit of another design, and then from starts of
    /// its own. A state whose rings are not linked as this design's is left out.
    pub fn limit_near(&self, direction: Direction, l2: f64, near: &Answer, cancel: &AtomicBool) -> Answer {
        let at = Stretch { direction, l2, across: Across::HELD, sign: 1.0 };
        let (answer, _) = self.limit(&at, &self.start_near(&at, near), cancel);
        self.without_one_trend(answer)
    }

    fn start_near(&self, at: &Stretch, near: &Answer) -> CellStarts {
        let Some(l1) = near.limit() else { return Vec::new() };
        let model = of_cell(self.models, near.cell);
        let [a1, a2] = at.lattices(&model).lattice(l1, at.l2, 0.0);
        let state = State { a1, a2, ..near.state.clone() };
        let linked = state.poses.len() == model.start.poses.len() && links_kept(&model, &state);
        let start = || Start { state, l1, l2: at.l2, shear: 0.0, route: Route::DIRECT };
        linked.then(start).map(|start| (near.cell, start)).into_iter().collect()
    }
}
