//! Shared by the tests: designs, and random states near a start.

use maille::{
    design::Design,
    lattice::Cell,
    model::Model,
    search::ExactOptions,
    state::State,
    survey::{CellChoice, Finished, MapQuestion, Method, characterize},
};
use maille_geometry::Vec3;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::sync::{Mutex, atomic::AtomicBool};

/// A built-in design.
pub fn builtin(name: &str) -> Design {
    let text = maille_io::builtin(name).expect("a built-in design");
    maille_io::read_design(name, text).expect("built-in designs are valid")
}

/// A built-in design with the given minor radius.
pub fn design(name: &str, minor_radius: f64) -> Design {
    builtin(name).with_minor_radius(minor_radius)
}

/// The same design compiled for its own cell.
pub fn model(name: &str, minor_radius: f64) -> Model {
    Model::compile(&design(name, minor_radius), Cell::PRIMITIVE).expect("built-in designs compile")
}

/// A state near the start: poses and lattice moved at random by up to `size`.
pub fn shaken(model: &Model, size: f64, seed: u64) -> State {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
    let poses = model.start.poses.iter().map(|p| p.moved(&vector(size), &vector(size))).collect();
    State { poses, a1: model.start.a1 + vector(size), a2: model.start.a2 + vector(size), roll: None }
}

/// A map by the exact method.
pub fn exact_map(options: &ExactOptions, directions: &[f64], l2: &[f64]) -> MapQuestion {
    let (cells, directions_deg, l2) = (CellChoice::Auto, directions.to_vec(), l2.to_vec());
    MapQuestion { method: Method::Exact(options.clone()), cells, directions_deg, l2, extremes: false }
}

/// The rows of a map by the exact method, in the order of its table.
pub fn map(models: &[Model], directions: &[f64], l2: &[f64], options: &ExactOptions) -> Vec<Finished> {
    rows(models, &exact_map(options, directions, l2))
}

/// The rows of a map, in the order of its table.
pub fn rows(models: &[Model], question: &MapQuestion) -> Vec<Finished> {
    let out = Mutex::new(Vec::new());
    let (cancel, finished) = (AtomicBool::new(false), |row| out.lock().unwrap().push(row));
    characterize(models, None, question, &|_| true, &cancel, &|_, _| (), &finished);
    let order = question.tasks();
    let mut out: Vec<Finished> = out.into_inner().unwrap();
    out.sort_by_key(|f| order.iter().position(|t| (t.direction_deg, t.l2) == (f.row.direction_deg, f.row.l2)));
    assert_eq!(out.len(), order.len());
    out
}
