//! Maps: limits over directions and lateral strains, as rows and states of a record.

use super::{
    image::image,
    request::{Finished, MapQuestion, Method, Task, Work},
    row::Asked,
};
use crate::{
    answer::Answer,
    lattice::Direction,
    model::{Model, of_cell},
    record::Status,
    relaxation::limit::EnergyMethod,
    search::{ExactOptions, stretch::ExactMethod},
    symmetry::{Operation, Orbit, mirrored, operations, orbits},
};
use rayon::prelude::*;
use std::{
    borrow::Cow,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// The directions of a map that are solved as one: those that the symmetries of the design make images of each other. `model` is
/// the first of the map's cells, whose translations the symmetries keep. A row of an image is the row of the
/// direction that is solved, with the image of its state.
///
/// The energy method repeats the thesis and checks the exact one, so it uses no symmetry: each direction is solved by itself.
#[doc(hidden)]
pub fn chains(model: &Model, question: &MapQuestion) -> Vec<Orbit> {
    symmetric_chains(model, &question.method, &question.directions_deg).1
}

fn symmetric_chains(model: &Model, method: &Method, directions_deg: &[f64]) -> (Vec<Operation>, Vec<Orbit>) {
    match method {
        Method::Energy(_) => {
            let alone =
                |&direction_deg: &f64| Orbit { representative_deg: direction_deg, directions_deg: vec![direction_deg] };
            (Vec::new(), directions_deg.iter().map(alone).collect())
        }
        Method::Exact(_) => {
            let operations = operations(model);
            let orbits = orbits(&operations, directions_deg);
            (operations, orbits)
        }
    }
}

/// Finds the limits of a map on the current thread pool and hands each over as it is finished, in any order.
///
/// `models` are the design compiled for the cell to solve and, for the exact method, larger ones that it may go on to.
/// `wanted` tells which tasks are still open. The energy method starts every limit from the design's state alone; the
/// exact one goes along one direction of each of the [`chains`] outwards from l2 = 0, and repeats all of it where one of the limits
/// is open. So rows do not depend on the number of threads, nor on where an earlier run was stopped, nor on which images of a
/// direction are asked for. After `cancel` the limits under way come back as interrupted or not at all. `work` hears when
/// a limit is begun and when it is ended, with the direction that is solved.
pub fn characterize(
    models: &[Model],
    minor_radius: Option<f64>,
    question: &MapQuestion,
    wanted: &(dyn Fn(Task) -> bool + Sync),
    cancel: &AtomicBool,
    work: &(dyn Fn(Task, Work) + Sync),
    finished: &(dyn Fn(Finished) + Sync),
) {
    let MapQuestion { method, directions_deg, l2, .. } = question;
    match method {
        Method::Energy(options) => {
            let energy = EnergyMethod::new(&models[0], options.clone(), cancel);
            let open: Vec<Task> = question.tasks().into_iter().filter(|t| wanted(*t)).collect();
            open.par_iter().with_max_len(1).for_each(|task| {
                if !cancel.load(Ordering::Relaxed) {
                    let begun = Instant::now();
                    work(*task, Work::Begins);
                    let answer = energy.limit(Direction::of_degrees(task.direction_deg), task.l2, cancel);
                    let asked = Asked { task, method, minor_radius, image_of_deg: None };
                    finished(asked.finished(&models[0], &answer, begun.elapsed().as_secs_f64()));
                    work(*task, Work::Ends);
                }
            });
        }
        Method::Exact(options) => {
            let exact = ExactMethod::new(models, options.clone(), cancel);
            let (operations, chains) = symmetric_chains(&models[0], method, directions_deg);
            ends_first(&chains).par_bridge().for_each(|chain| {
                let solved_deg = chain.representative_deg;
                let open = |k: usize| {
                    let task = move |&direction_deg: &f64| Task { direction_deg, l2: l2[k] };
                    chain.directions_deg.iter().map(task).filter(|task| wanted(*task))
                };
                if cancel.load(Ordering::Relaxed) || !(0..l2.len()).any(|k| open(k).next().is_some()) {
                    return;
                }
                let solved = |k: usize| Task { direction_deg: solved_deg, l2: l2[k] };
                let begins = |k| work(solved(k), Work::Begins);
                exact.limits(Direction::of_degrees(solved_deg), l2, cancel, &begins, &mut |k, answer, wall_s| {
                    let answer = both_shears(answer, &operations, solved_deg);
                    for task in open(k) {
                        let image_of_deg = (task.direction_deg != solved_deg).then_some(solved_deg);
                        let asked = Asked { task: &task, method, minor_radius, image_of_deg };
                        finished(match image_of_deg {
                            Some(solved_deg) => {
                                let (model, answer) =
                                    image(&operations, models, &answer, solved_deg, task.direction_deg);
                                asked.finished(&model, &answer, wall_s)
                            }
                            None => asked.finished(&of_cell(models, answer.cell), &answer, wall_s),
                        });
                    }
                    work(solved(k), Work::Ends);
                });
            });
        }
    }
}

/// From both ends inwards. A map often begins and ends with directions along the axes of the weave, which are often the slowest:
/// begun last they would be waited for.
fn ends_first<T: Sync>(all: &[T]) -> impl Iterator<Item = &T> + Send {
    let (mut rest, mut from_back) = (all.iter(), false);
    std::iter::from_fn(move || {
        from_back = !from_back;
        if from_back { rest.next_back() } else { rest.next() }
    })
}

/// A limit along a direction that a symmetry of the design maps to itself mirrored: the states with −γ are there, too.
fn both_shears(mut answer: Answer, operations: &[Operation], direction_deg: f64) -> Answer {
    if let Some(free) = answer.free.as_mut().filter(|_| mirrored(operations, direction_deg)) {
        let most = free.shear[1].max(-free.shear[0]);
        free.shear = [-most, most];
    }
    answer
}

/// The limit of one stretch, found as a map finds it, with the model of its cell: along the representative of the direction's orbit,
/// and mapped from there.
pub(crate) fn one<'a>(
    models: &'a [Model],
    options: &ExactOptions,
    direction_deg: f64,
    l2: f64,
    cancel: &'a AtomicBool,
) -> (Cow<'a, Model>, Answer) {
    let one = OneLimit::new(models, options, cancel);
    let solved_deg = one.representative_deg(direction_deg);
    one.along(&one.solve(solved_deg, l2), solved_deg, direction_deg)
}

/// Limits of one stretch each.
pub(super) struct OneLimit<'a> {
    pub models: &'a [Model],
    pub operations: Vec<Operation>,
    exact: ExactMethod<'a>,
    cancel: &'a AtomicBool,
}

impl<'a> OneLimit<'a> {
    pub fn new(models: &'a [Model], options: &ExactOptions, cancel: &'a AtomicBool) -> Self {
        let exact = ExactMethod::new(models, options.clone(), cancel);
        OneLimit { models, operations: operations(&models[0]), exact, cancel }
    }

    /// The direction that is solved for `direction_deg`.
    pub fn representative_deg(&self, direction_deg: f64) -> f64 {
        orbits(&self.operations, &[direction_deg])[0].representative_deg
    }

    /// As a map of this direction and this l2 alone finds it, along a representative.
    pub fn solve(&self, solved_deg: f64, l2: f64) -> Answer {
        let mut answer = Answer::new(&self.models[0], Status::Interrupted);
        let solved = Direction::of_degrees(solved_deg);
        let mut finished = |_, found, _| answer = found;
        self.exact.limits(solved, &[l2], self.cancel, &|_| (), &mut finished);
        both_shears(answer, &self.operations, solved_deg)
    }

    /// Where one local search along a direction from a state near by ends: see [`ExactMethod::turned`].
    pub fn turned(&self, direction_deg: f64, l2: f64, near: &Answer) -> Option<Answer> {
        self.exact.turned(Direction::of_degrees(direction_deg), l2, near, self.cancel)
    }

    /// The limit along this direction itself, searched from a state near by first: see [`ExactMethod::limit_near`].
    pub fn solve_near(&self, direction_deg: f64, l2: f64, near: &Answer) -> Answer {
        self.exact.limit_near(Direction::of_degrees(direction_deg), l2, near, self.cancel)
    }

    /// The limit that was solved, along it or along an image of it, with the model of its cell.
    pub fn along(&self, answer: &Answer, solved_deg: f64, direction_deg: f64) -> (Cow<'a, Model>, Answer) {
        if solved_deg != direction_deg {
            return image(&self.operations, self.models, answer, solved_deg, direction_deg);
        }
        (of_cell(self.models, answer.cell), answer.clone())
    }
}
