//! The closed surface of all in-plane strains that a sheet can have: rays from the written lattice in the space of Green
//! strains (E_xx, E_yy, E_xy), each as far as it goes.
//!
//! Each ray is a query of [`crate::search::strain`] with one parameter. The farthest certified state of all starts, its
//! neighbours' states among them, is the vertex. Nearer states of the ray may overlap: then it leaves the set and enters it again.
//!
//! The first rays are searched as the effort says. A later one starts from the states of the two rays that it was put between, and
//! draws starts only until two lead to the best; none where both states are of larger cells. A ray may still end in a worse fold than a neighbour found. So
//! after each pass states are handed on along the edges at which the surface bends more than it should, until no ray gains by it;
//! what bends then is divided.

use super::{
    icosphere::{Bent, Sphere},
    request::CellChoice,
};
use crate::{
    lattice::Cell,
    model::Model,
    question::{Effort, Goal, Question, Sense, StrainQuery},
    record::Status,
    search::strain::{OtherStarts, StrainMethod, StrainOptions},
    state::{Pose, State},
};
use maille_design::InvalidInput;
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Quaternion, UnitQuaternion};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::atomic::{AtomicBool, Ordering},
};

/// How fine the surface is, and how each ray is searched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundaryOptions {
    /// Rays are added until the surface between them is expected within this of its triangles.
    pub tolerance: f64,
    /// Vertices at most.
    pub most: usize,
    /// How long each ray is searched whose bound is not attained.
    pub effort: Effort,
    /// So many starts in place of an effort.
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    pub seed: u64,
    /// The cell that is solved; with `auto` the design's own, and unstable waves are followed into larger ones.
    pub cells: CellChoice,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        BoundaryOptions {
            tolerance: 3e-3,
            most: 5000,
            effort: Effort::Normal,
            starts: None,
            seed: 1,
            cells: Cell::PRIMITIVE.into(),
        }
    }
}

impl BoundaryOptions {
    /// The cell to compile.
    #[doc(hidden)]
    pub fn cell(&self) -> Cell {
        match &self.cells {
            CellChoice::These(cells) => cells.first().copied().unwrap_or_default(),
            CellChoice::Auto => Cell::PRIMITIVE,
        }
    }
}

/// A ray and where it ends. Lengths in units of the reference radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundaryVertex {
    /// Unit vector (E_xx, E_yy, E_xy).
    pub direction: [f64; 3],
    /// `global`, `local`, `uncertified`, or `l2-not-reached` where nothing was found.
    pub status: Status,
    /// Distance of the farthest state.
    pub distance: Option<f64>,
    /// Proven bound of the distance.
    pub bound: Option<f64>,
    /// Distinct certified distances that the starts led to.
    pub n_distinct: u64,
    /// Least curvature found on waves through the sheet at the state, see [`crate::answer::WaveCurvature`]; negative where a larger cell may go
    /// further. `None` where it was not measured.
    #[serde(default)]
    pub wave_curvature: Option<f64>,
    /// The cell of the state.
    #[serde(default)]
    pub cell: Cell,
    /// Lattice vectors of the state.
    pub lattice: [[f64; 3]; 2],
    /// Position and quaternion (w, x, y, z) of each element.
    pub poses: Vec<[f64; 7]>,
}

impl BoundaryVertex {
    /// (E_xx, E_yy, E_xy) at the distance `at`.
    #[doc(hidden)]
    pub fn point(&self, at: f64) -> [f64; 3] {
        self.direction.map(|x| x * at)
    }

    fn state(&self) -> (Cell, State) {
        let pose = |&[x, y, z, w, i, j, k]: &[f64; 7]| Pose {
            position: Vec3::new(x, y, z),
            rotation: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
        };
        let [a1, a2] = self.lattice.map(Vec3::from);
        (self.cell, State { poses: self.poses.iter().map(pose).collect(), a1, a2, roll: None })
    }
}

/// The surface.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Its vertices; fewer than the triangles name where the search was stopped.
    pub vertices: Vec<BoundaryVertex>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[usize; 3]>,
    /// Largest expected distance between the surface and its triangles.
    pub arch: f64,
    /// Edges beyond the tolerance that were long enough to be divided, had there been room for more vertices.
    pub open: usize,
    /// Edges beyond the tolerance that are too short to be divided: there the distance jumps.
    pub jumps: usize,
    /// Whether all rays were solved.
    pub complete: bool,
}

/// Divisions of the icosahedron before the surface decides: 162 rays.
const FIRST: usize = 2;
/// The rays of one division, on which thorough effort follows an unstable wave into each cell: what they find is handed on.
const EVERY_WAVE: usize = 42;

/// Rays that are solved beside each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pass {
    /// So many that are new.
    New(usize),
    /// So many once more, from their neighbours' states.
    Again(usize),
}

/// A ray that is to be solved.
#[doc(hidden)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ray {
    /// Unit vector (E_xx, E_yy, E_xy).
    pub direction: [f64; 3],
    /// Vertices whose states are starts.
    pub from: Vec<BoundaryVertex>,
    /// Which other starts it gets.
    pub others: OtherStarts,
}

/// Solves rays of which none needs another: gets them, and whether they are new, and gives their ends in order, `None` after a stop.
pub(crate) type SolveRays<'a> = &'a mut dyn FnMut(&[Ray], bool) -> Vec<Option<BoundaryVertex>>;

/// Solves rays, each for itself.
#[doc(hidden)]
pub struct RaySolver<'a>(StrainMethod<'a>);

impl<'a> RaySolver<'a> {
    /// For rays of one surface.
    pub fn new(model: &'a Model, options: &BoundaryOptions) -> Self {
        let BoundaryOptions { effort, starts, seed, .. } = *options;
        let follow_waves = options.cells == CellChoice::Auto;
        let options = StrainOptions { effort, starts, seed, follow_waves, sense: Sense::Largest };
        RaySolver(StrainMethod::new(std::slice::from_ref(model), options))
    }

    /// Where the ray ends; `None` after `cancel`.
    pub fn solve(&self, ray: &Ray, cancel: &AtomicBool) -> Option<BoundaryVertex> {
        let from: Vec<(Cell, State)> = ray.from.iter().map(BoundaryVertex::state).collect();
        let [xx, yy, xy] = ray.direction;
        let query = StrainQuery { held: Matrix2::zeros(), free: vec![Matrix2::new(xx, xy, xy, yy)] };
        let answer = self.0.solve_beside(&query, &from, ray.others, cancel);
        if cancel.load(Ordering::Relaxed) || answer.status == Status::Interrupted {
            return None;
        }
        let pose = |pose: &Pose| {
            let (p, q) = (pose.position, pose.rotation.quaternion());
            [p.x, p.y, p.z, q.w, q.i, q.j, q.k]
        };
        Some(BoundaryVertex {
            direction: ray.direction,
            status: answer.status,
            distance: answer.value,
            bound: answer.bound.filter(|bound| bound.is_finite()),
            n_distinct: answer.n_distinct.unwrap_or(0),
            wave_curvature: answer.wave.map(|wave| wave.least),
            cell: answer.cell,
            lattice: [answer.state.a1, answer.state.a2].map(Into::into),
            poses: answer.state.poses.iter().map(pose).collect(),
        })
    }
}

/// Whether the sheet of `model` has a surface of strains: a chain has none.
///
/// # Errors
/// That of [`Question::suits`] for a ray.
pub fn has_surface(model: &Model) -> Result<(), InvalidInput> {
    Question::new(Goal::Ray { direction: [1.0, 0.0, 0.0] }, Sense::Largest).suits(model)
}

/// Finds the surface on the current thread pool; the result does not depend on the number of threads. `known` are vertices of
/// an earlier run. Of the same tolerance it goes on as if it had not been stopped; of another, rays may start from other neighbours, and
/// end in other folds, than in a run of its own. `found` gets each new one, `planned` each pass before it begins.
pub fn boundary(
    model: &Model,
    options: &BoundaryOptions,
    known: &[BoundaryVertex],
    cancel: &AtomicBool,
    planned: &mut dyn FnMut(Pass),
    found: &(dyn Fn(&BoundaryVertex) + Sync),
) -> Boundary {
    let solver = RaySolver::new(model, options);
    let mut solve = |rays: &[Ray], new: bool| -> Vec<Option<BoundaryVertex>> {
        let one = |ray: &Ray| -> Option<BoundaryVertex> {
            let vertex = solver.solve(ray, cancel)?;
            if new {
                found(&vertex);
            }
            Some(vertex)
        };
        rays.par_iter().with_max_len(1).map(one).collect()
    };
    boundary_by(options, known, cancel, planned, &mut solve)
}

/// The same with rays solved elsewhere: `solve` gets those of a pass; those that are not new are tried again from their neighbours'
/// states.
#[doc(hidden)]
pub fn boundary_by(
    options: &BoundaryOptions,
    known: &[BoundaryVertex],
    cancel: &AtomicBool,
    planned: &mut dyn FnMut(Pass),
    solve: SolveRays<'_>,
) -> Boundary {
    let bits = |direction: [f64; 3]| direction.map(f64::to_bits);
    let known: BTreeMap<[u64; 3], &BoundaryVertex> = known.iter().map(|v| (bits(v.direction), v)).collect();
    let mut sphere = Sphere::new(FIRST);
    let mut vertices: Vec<BoundaryVertex> = Vec::new();
    let mut tried = BTreeSet::new();
    loop {
        let open = vertices.len()..sphere.directions.len();
        let count = open.len();
        let known = |k: &usize| known.get(&bits(sphere.directions[*k].into())).copied();
        let rays = open.clone().filter(|k| known(k).is_none()).map(|k| {
            let parents = sphere.parents[k].into_iter().filter_map(|parent| vertices.get(parent));
            let from = parents.filter(|p| p.distance.is_some()).cloned().collect();
            let others = match k {
                _ if !vertices.is_empty() => OtherStarts::WhereNeighboursDiffer,
                _ if k < EVERY_WAVE && options.effort == Effort::Thorough => OtherStarts::AndEveryWave,
                _ => OtherStarts::Usual,
            };
            Ray { direction: sphere.directions[k].into(), from, others }
        });
        let rays: Vec<Ray> = rays.collect();
        planned(Pass::New(rays.len()));
        let mut solved = solve(&rays, true).into_iter();
        let mut end = |k: usize| known(&k).cloned().or_else(|| solved.next().flatten());
        let ends: Vec<Option<BoundaryVertex>> = open.map(&mut end).collect();
        vertices.extend(ends.into_iter().map_while(|vertex| vertex));
        let complete = vertices.len() == sphere.directions.len();
        if complete {
            hand_on(&sphere, options.tolerance, &mut vertices, &mut tried, planned, solve);
        }
        // Stopped while states were handed on: the next run does that again.
        let complete = complete && !cancel.load(Ordering::Relaxed);
        let bends = if complete { sphere.bent(&points(&vertices), options.tolerance) } else { Vec::new() };
        let divided: Vec<Bent> = bends.into_iter().filter(|bent| bent.wide).collect();
        let room = options.most.saturating_sub(vertices.len());
        if !complete || divided.is_empty() || room == 0 || count == 0 {
            let bent = if complete { sphere.bent(&points(&vertices), 0.0) } else { Vec::new() };
            let arch = bent.first().map_or(if complete { 0.0 } else { f64::NAN }, |worst| worst.arch);
            let beyond = |wide: bool| bent.iter().filter(|b| b.arch > options.tolerance && b.wide == wide).count();
            let (open, jumps) = (beyond(true), beyond(false));
            return Boundary { vertices, triangles: sphere.triangles, arch, open, jumps, complete };
        }
        let marked: Vec<[usize; 2]> = divided.into_iter().take(room).map(|bent| bent.edge).collect();
        sphere.divide(&marked);
    }
}

fn points(vertices: &[BoundaryVertex]) -> Vec<Option<Vec3>> {
    vertices.iter().map(|v| Some(v.point(v.distance?).into())).collect()
}

/// Rounds in which states are handed on, at most.
const ROUNDS: usize = 40;
/// A ray has gained if it goes further by more than this.
const GAIN: f64 = 1e-7;

/// Rays at bent edges, solved once more from the state at the other end. `tried` has the ray, that end and its distance: a state is
/// tried once on a ray.
fn hand_on(
    sphere: &Sphere,
    tolerance: f64,
    vertices: &mut [BoundaryVertex],
    tried: &mut BTreeSet<(usize, usize, u64)>,
    planned: &mut dyn FnMut(Pass),
    solve: SolveRays<'_>,
) {
    for _ in 0..ROUNDS {
        let mut tasks: BTreeMap<usize, Ray> = BTreeMap::new();
        for Bent { edge: [a, b], .. } in sphere.bent(&points(vertices), tolerance) {
            for (k, other) in [(a, b), (b, a)] {
                let (Some(own), Some(distance)) = (vertices[k].distance, vertices[other].distance) else { continue };
                if tried.insert((k, other, distance.to_bits())) {
                    let others = OtherStarts::NoneAndBeyond(own);
                    let ray = || Ray { direction: sphere.directions[k].into(), from: Vec::new(), others };
                    tasks.entry(k).or_insert_with(ray).from.push(vertices[other].clone());
                }
            }
        }
        let (places, rays): (Vec<usize>, Vec<Ray>) = tasks.into_iter().unzip();
        if !rays.is_empty() {
            planned(Pass::Again(rays.len()));
        }
        let mut gained = false;
        for (k, new) in places.into_iter().zip(solve(&rays, false)) {
            let (old, Some(new)) = (&vertices[k], new) else { continue };
            let certified = matches!(new.status, Status::Global | Status::Local);
            let farther = new.distance.is_some_and(|d| old.distance.is_some_and(|old| d > old + GAIN));
            if certified && farther {
                let n_distinct = new.n_distinct.max(old.n_distinct);
                vertices[k] = BoundaryVertex { n_distinct, ..new };
                gained = true;
            }
        }
        if !gained {
            return;
        }
    }
}
