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
    cancel: &AtomicBool,
) -> (Cow<'a, Model>, Answer) {
    let method = Method::Exact(options.clone());
    let (operations, chains) = symmetric_chains(&models[0], &method, &[direction_deg]);
    let solved_deg = chains[0].representative_deg;
    let mut answer = Answer::new(&models[0], Status::Interrupted);
    let solved = Direction::of_degrees(solved_deg);
    let mut finished = |_, found, _| answer = found;
    ExactMethod::new(models, options.clone(), cancel).limits(solved, &[l2], cancel, &|_| (), &mut finished);
    let answer = both_shears(answer, &operations, solved_deg);
    if solved_deg != direction_deg {
        return image(&operations, models, &answer, solved_deg, direction_deg);
    }
    (of_cell(models, answer.cell), answer)
}
