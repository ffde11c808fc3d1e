//! Characterisation: limits over directions and lateral strains, as rows and states of a record.

mod image;
pub mod strain;

use crate::{
    bound::DualForce,
    lattice::{Across, Cell, direction},
    limit::{
        FreeRanges, LimitOutcome,
        energy::{EnergyMethod, EnergyOptions},
        exact::{ExactMethod, ExactOptions},
    },
    model::Model,
    record::{ChainRecord, ContactRecord, DualRecord, LimitRow, StateRecord, Status, pose_records},
    symmetry::{Operation, Orbit, mirrored, operations, orbits},
    topology,
};
use maille_geometry::Vec3;
use rayon::prelude::*;
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// How limits are found.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// The thesis's energy method.
    Energy(EnergyOptions),
    /// The exact method, with certificates.
    Exact(ExactOptions),
}

impl Method {
    /// What is left to the sheet.
    pub fn across(&self) -> Across {
        match self {
            Method::Energy(_) => Across::HELD,
            Method::Exact(options) => options.across,
        }
    }

    /// Whether l1 is made as small as can be.
    pub fn compression(&self) -> bool {
        matches!(self, Method::Exact(ExactOptions { compression: true, .. }))
    }

    /// The name in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Method::Energy(_) => "energy",
            Method::Exact(_) => "exact",
        }
    }
}

/// Which cells are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellChoice {
    /// The design's own, and larger ones where the exact method asks for them.
    Auto,
    /// This one.
    One(Cell),
}

/// Cells that `auto` may go on to, in this order.
const LARGER: [&str; 4] = ["2x1", "1x2", "2x2", "3x3"];
/// Elements in a cell that `auto` goes on to, at most.
const MOST_ELEMENTS: usize = 40;

impl CellChoice {
    /// The cells to compile: for the energy method `auto` is the design's own.
    pub fn cells(self, method: &Method, elements: usize) -> Vec<Cell> {
        match (self, method) {
            (CellChoice::One(cell), _) => vec![cell],
            (CellChoice::Auto, Method::Energy(_)) => vec![Cell::PRIMITIVE],
            (CellChoice::Auto, Method::Exact(_)) => {
                let larger = LARGER.iter().filter_map(|text| text.parse::<Cell>().ok());
                let larger = larger.filter(|cell| cell.copies() * elements <= MOST_ELEMENTS);
                std::iter::once(Cell::PRIMITIVE).chain(larger).collect()
            }
        }
    }
}

/// One limit to find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Direction of the pull, degrees counter-clockwise from x.
    pub direction_deg: f64,
    /// Stretch − 1 held across it.
    pub l2: f64,
}

/// A finished row with its state.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The row of the table.
    pub row: LimitRow,
    /// The state at the limit.
    pub state: StateRecord,
}

/// The tasks of a map: every l2 with every direction, in the order of the table.
pub fn tasks(directions_deg: &[f64], l2: &[f64]) -> Vec<Task> {
    l2.iter().flat_map(|&l2| directions_deg.iter().map(move |&direction_deg| Task { direction_deg, l2 })).collect()
}

/// The directions of a map that are solved as one: those that the symmetries of the design make images of each other. `model` is
/// the first of the map's cells, whose translations the symmetries keep. A row of an image is the row of the
/// direction that is solved, with the image of its state.
///
/// The energy method repeats the thesis and checks the exact one, so it uses no symmetry: each direction is solved by itself.
pub fn chains(model: &Model, method: &Method, directions_deg: &[f64]) -> Vec<Orbit> {
    symmetric_chains(model, method, directions_deg).1
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
/// direction are asked for. After `cancel` the limits under way come back as interrupted or not at all.
pub fn characterize(
    models: &[Model],
    minor_radius: Option<f64>,
    method: &Method,
    directions_deg: &[f64],
    l2: &[f64],
    wanted: &(dyn Fn(Task) -> bool + Sync),
    cancel: &AtomicBool,
    finished: &(dyn Fn(Finished) + Sync),
) {
    match method {
        Method::Energy(options) => {
            let energy = EnergyMethod::new(&models[0], options.clone(), cancel);
            let open: Vec<Task> = tasks(directions_deg, l2).into_iter().filter(|t| wanted(*t)).collect();
            open.par_iter().with_max_len(1).for_each(|task| {
                if !cancel.load(Ordering::Relaxed) {
                    let begun = Instant::now();
                    let outcome = energy.limit(task.direction_deg, task.l2, cancel);
                    let found = Found { model: &models[0], outcome: &outcome, cells: &[], image_of_deg: None };
                    finished(report(&found, minor_radius, method, task, begun.elapsed().as_secs_f64()));
                }
            });
        }
        Method::Exact(options) => {
            let exact = ExactMethod::new(models, options.clone(), cancel);
            let (operations, chains) = symmetric_chains(&models[0], method, directions_deg);
            let cells: Vec<Cell> = models.iter().map(|model| model.cell).collect();
            chains.par_iter().with_max_len(1).for_each(|chain| {
                let solved_deg = chain.representative_deg;
                let open = |k: usize| {
                    let task = move |&direction_deg: &f64| Task { direction_deg, l2: l2[k] };
                    chain.directions_deg.iter().map(task).filter(|task| wanted(*task))
                };
                if cancel.load(Ordering::Relaxed) || !(0..l2.len()).any(|k| open(k).next().is_some()) {
                    return;
                }
                let mut begun = Instant::now();
                exact.limits(solved_deg, l2, cancel, &mut |k, mut outcome| {
                    let free = outcome.exact.as_mut().and_then(|figures| figures.free.as_mut());
                    if let Some(free) = free.filter(|_| mirrored(&operations, solved_deg)) {
                        // The states with −γ are there, too.
                        let most = free.shear[1].max(-free.shear[0]);
                        free.shear = [-most, most];
                    }
                    for task in open(k) {
                        let image = (task.direction_deg != solved_deg)
                            .then(|| image::image(&operations, models, &outcome, solved_deg, task.direction_deg));
                        let found = match &image {
                            Some(image) => Found {
                                model: &image.model,
                                outcome: &image.outcome,
                                cells: &image.cells,
                                image_of_deg: Some(solved_deg),
                            },
                            None => {
                                let model = &models[outcome.exact.as_ref().map_or(0, |e| e.cell)];
                                Found { model, outcome: &outcome, cells: &cells, image_of_deg: None }
                            }
                        };
                        finished(report(&found, minor_radius, method, &task, begun.elapsed().as_secs_f64()));
                        begun = Instant::now();
                    }
                });
            });
        }
    }
}

/// What there is to report of a limit.
struct Found<'a> {
    /// The model of its state.
    model: &'a Model,
    outcome: &'a LimitOutcome,
    /// The cells that its trend counts.
    cells: &'a [Cell],
    /// The direction that was solved, where this is an image.
    image_of_deg: Option<f64>,
}

fn report(found: &Found<'_>, minor_radius: Option<f64>, method: &Method, task: &Task, wall_s: f64) -> Finished {
    let Found { model, outcome, cells, image_of_deg } = *found;
    let f = outcome.gradient;
    let earned = matches!(outcome.status, Status::ThresholdReached | Status::Global | Status::Local);
    let solved = earned || outcome.status == Status::Uncertified;
    let along = direction(task.direction_deg);
    let c = f.transpose() * f;
    let (mean, half) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, ((c[(0, 0)] - c[(1, 1)]) / 2.0).hypot(c[(0, 1)]));
    // A proof has no state, and a search that found none ends with its last one.
    let ended = solved || matches!(outcome.status, Status::L2NotReached | Status::NotConverged);
    let gap = topology::smallest_gap(model, &outcome.state).map(|(gap, _)| gap * model.unit).filter(|_| solved);
    let number = |x: f64| earned.then_some(x);
    let l1 = number(along.dot(&(f * along)) - 1.0);
    let exact = outcome.exact.as_ref();
    let bound = exact.and_then(|e| e.bound);
    let certificate = exact.and_then(|e| e.certificate.as_ref());
    let across = method.across();
    let word = |free: bool| if free { "free" } else { "fixed" }.to_owned();
    let held = FreeRanges { l2: [task.l2; 2], shear: [0.0; 2] };
    let ranges = if across.any() { exact.and_then(|e| e.free) } else { Some(held) }.filter(|_| earned);
    // Inside a model the unit is R.
    let [a1, a2] = model.cell.primitive(outcome.state.a1, outcome.state.a2);
    let trend = exact.map_or(&[][..], |e| &e.trend);
    let by_cell: Vec<String> = trend.iter().map(|t| t.words(&cells[t.cell].to_string())).collect();
    // A proven limit does not grow, whichever cell it is found in.
    let grows = trend.last().filter(|_| trend.len() > 1).zip(exact);
    let grows = grows.map(|(last, e)| last.cell == e.cell && outcome.status != Status::Global);
    let row = LimitRow {
        design: model.name.clone(),
        minor_radius,
        direction_deg: task.direction_deg,
        l2: task.l2,
        method: method.name().into(),
        cell: model.cell.to_string(),
        status: outcome.status,
        l1,
        lambda1: number(mean + half),
        lambda2: number(mean - half),
        stretch1: number((mean + half).sqrt()),
        stretch2: number((mean - half).max(0.0).sqrt()),
        max_overlap: gap.map(|gap| (-gap).max(0.0)),
        min_gap: gap,
        iterations: outcome.iterations,
        runs: outcome.runs,
        wall_s,
        bound_l1: bound.map(|b| b.0),
        bound_kind: bound.map(|b| b.1.to_string()),
        bound_gap: bound.zip(l1).map(|(b, l1)| b.0 - l1),
        dual_residual: certificate.map(|c| c.dual_residual),
        complementarity: certificate.map(|c| c.complementarity),
        min_multiplier: certificate.map(|c| c.min_multiplier).filter(|m| m.is_finite()),
        min_curvature: certificate.and_then(|c| c.min_curvature).filter(|m| m.is_finite()),
        zero_modes: certificate.map(|c| c.zero_modes as u64),
        links_ok: exact.and_then(|e| e.links_ok).or_else(|| ended.then(|| topology::links_kept(model, &outcome.state))),
        n_starts: exact.map(|e| e.n_starts),
        n_distinct: exact.map(|e| e.n_distinct),
        own_image_force: exact.and_then(|e| e.own_image_force),
        l1_uncertified: exact.and_then(|e| e.l1_uncertified),
        lateral: Some(word(across.lateral_free)),
        shear: Some(word(across.shear_free)),
        l2_min: ranges.map(|r| r.l2[0]),
        l2_max: ranges.map(|r| r.l2[1]),
        shear_min: ranges.map(|r| r.shear[0]),
        shear_max: ranges.map(|r| r.shear[1]),
        a1_x: number(a1.x),
        a1_y: number(a1.y),
        a2_x: number(a2.x),
        a2_y: number(a2.y),
        end: Some(if method.compression() { "least" } else { "largest" }.to_owned()),
        by_cell: (!by_cell.is_empty()).then(|| by_cell.join("; ")),
        image_of_deg,
        grows_with_cell: grows,
    };
    let position = |v: Vec3| -> [f64; 3] { (v * model.unit).into() };
    let poses = pose_records(model, &outcome.state);
    let contact = |c: &crate::constraint::Contact| ContactRecord {
        ring_a: c.pair.ring_a,
        ring_b: c.pair.ring_b,
        shift: c.pair.shift,
        point_a: position(c.point_a),
        point_b: position(c.point_b),
        normal: (c.point_b - c.point_a).normalize().into(),
        force: c.force,
    };
    let chain = exact.and_then(|e| e.chain.as_ref()).map(|chain| ChainRecord {
        vector: chain.vector,
        length: chain.length * model.unit,
        rings: chain.rings.clone(),
    });
    let force = |dual: &DualForce| DualRecord {
        tie: dual.kind.name().into(),
        rings: dual.rings.clone(),
        force: dual.force.into(),
    };
    let state = StateRecord {
        direction_deg: task.direction_deg,
        l2: task.l2,
        status: outcome.status,
        a1: position(outcome.state.a1),
        a2: position(outcome.state.a2),
        deformation_gradient: [[f[(0, 0)], f[(0, 1)]], [f[(1, 0)], f[(1, 1)]]],
        poses,
        residual: outcome.residual.filter(|r| r.is_finite()),
        note: outcome.note.clone(),
        contacts: exact.map_or(Vec::new(), |e| e.contacts.iter().map(contact).collect()),
        chain,
        dual: exact.map_or(Vec::new(), |e| e.dual.iter().map(force).collect()),
        steps: outcome.steps.clone(),
    };
    Finished { row, state }
}
