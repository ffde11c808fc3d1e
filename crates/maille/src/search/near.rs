//! A limit searched from a state near by: of another design, whose rings are linked alike, or along another direction.

use super::{
    multistart::{CellStarts, Target},
    starts::{Route, Start},
    stop::StopRule,
    stretch::{ExactMethod, Stretch},
};
use crate::{
    answer::Answer,
    lattice::{Across, Direction},
    model::of_cell,
    record::Status,
    state::State,
    topology::links_kept,
};
use std::sync::atomic::AtomicBool;

impl ExactMethod<'_> {
    /// One limit with width and shear held, searched from the state of `near` first, the same limit of another design, and then from starts of
    /// its own. Where that state is not linked as this design is, found as usual.
    pub fn limit_near(&self, direction: Direction, l2: f64, near: &Answer, cancel: &AtomicBool) -> Answer {
        let at = Stretch { direction, l2, across: Across::HELD, sign: 1.0 };
        let starts = self.start_near(&at, near);
        if starts.is_empty() {
            let mut answer = self.without_state(Status::Interrupted);
            self.limits(direction, &[l2], cancel, &|_| (), &mut |_, found, _| answer = found);
            return answer;
        }
        let (answer, _) = self.limit(&at, &starts, cancel);
        self.without_one_trend(answer)
    }

    /// The strains along and across a pull with free width, where one local search from the state of `near` ends, the limit of another
    /// design; `None` where it is not certified.
    pub fn strains_near(
        &self,
        direction: Direction,
        across: Across,
        near: &Answer,
        cancel: &AtomicBool,
    ) -> Option<[f64; 2]> {
        let at = Stretch { direction, l2: 0.0, across, sign: 1.0 };
        let (cell, start) = self.start_near(&at, near).pop()?;
        let search = self.search(&at, f64::INFINITY, cancel);
        let best = search.run(&of_cell(self.models, cell), vec![start], StopRule::given_only()).best?;
        let Start { l1, l2, .. } = search.target.start(&best);
        best.certified.then_some([l1, l2])
    }

    /// The limit with width and shear held where one local search from the state of `near` ends, a limit along another direction; `None`
    /// where that is not certified.
    pub(crate) fn turned(&self, direction: Direction, l2: f64, near: &Answer, cancel: &AtomicBool) -> Option<Answer> {
        let at = Stretch { direction, l2, across: Across::HELD, sign: 1.0 };
        let (cell, start) = self.start_near(&at, near).pop()?;
        let model = of_cell(self.models, cell);
        let search = self.search(&at, f64::INFINITY, cancel);
        let best = search.solve_nearby(&model, start).best.filter(|best| best.certified)?;
        let (value, gradient) = (Some(best.value()), at.lattices(&model).gradient(&best.p, l2));
        Some(Answer { value, gradient, state: best.state, ..Answer::new(&model, Status::Local) })
    }

    fn start_near(&self, at: &Stretch, near: &Answer) -> CellStarts {
        if !near.is_limit() {
            return Vec::new();
        }
        let model = of_cell(self.models, near.cell);
        let (f, along, side) = (near.gradient, at.direction.along(), at.direction.across());
        let [l1, there, shear] = [along.dot(&(f * along)) - 1.0, side.dot(&(f * side)) - 1.0, along.dot(&(f * side))];
        let l2 = if at.across.lateral_free { there } else { at.l2 };
        let shear = if at.across.shear_free { shear } else { 0.0 };
        let [a1, a2] = at.lattices(&model).lattice(l1, l2, shear);
        let state = State { a1, a2, ..near.state.clone() };
        let linked = state.poses.len() == model.start.poses.len() && links_kept(&model, &state);
        let start = || Start { state, l1, l2, shear, route: Route::DIRECT };
        linked.then(start).map(|start| (near.cell, start)).into_iter().collect()
    }
}
