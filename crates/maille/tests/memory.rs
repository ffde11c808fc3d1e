//! A long run needs no more memory than a short one, a large sheet so much for each ring and contact.
//!
//! Measured of the whole process, so these tests are a program of their own.
#![cfg(target_os = "linux")]

use maille::{
    lattice::{Cell, Direction},
    model::Model,
    relaxation::{Configuration, SheetEnergy, limit::EnergyOptions},
    search::{ExactOptions, stretch::ExactMethod},
    solver::{newton::Objective, sparse::Patterns},
    topology::{RingPair, close_pairs},
};
use maille_geometry::{Circle, Vec3, circle_distance_minima};
use rand::{RngExt, SeedableRng};
use std::sync::atomic::AtomicBool;

/// What the system says of this process's memory, in KiB: `VmRSS`, resident now, or `VmHWM`, at its peak.
fn memory_kib(what: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with(what)).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn a_thousand_limits_leave_nothing_behind() {
    let design = maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap();
    let models = [Model::compile(&design, Cell::PRIMITIVE).unwrap()];
    let mut limits = 0;
    let mut map = || {
        let method = ExactMethod::new(&models, ExactOptions::default(), &AtomicBool::new(false));
        for k in 0..24 {
            let mut count = |_, outcome: maille::answer::Answer, _| limits += usize::from(outcome.n_starts.is_some());
            method.limits(
                Direction::of_degrees(7.5 * f64::from(k)),
                &[-0.125, 0.0, 0.125],
                &AtomicBool::new(false),
                &|_| (),
                &mut count,
            );
        }
    };
    (0..3).for_each(|_| map());
    let before = memory_kib("VmRSS:");
    (0..14).for_each(|_| map());
    let grown = memory_kib("VmRSS:") - before;
    assert_eq!(limits, 17 * 72);
    assert!(grown < 2048.0, "{grown} KiB more after 1,008 further limits");
}

/// The sheet of the bench `sheet`: taut, so that every link presses.
fn taut_sheet(tile: &str) -> (Model, Configuration) {
    let design = maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap().with_minor_radius(0.1);
    let model = Model::compile_sheet(&design, tile.parse().unwrap()).unwrap();
    let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(7);
    let mut shake = || Vec3::from_fn(|_, _| 1e-3 * rng.random_range(-1.0..1.0));
    let mut state = model.start.clone();
    for pose in &mut state.poses {
        pose.position = Vec3::new(1.4405 * pose.position.x, 1.4405 * pose.position.y, pose.position.z);
        *pose = pose.moved(&shake(), &shake());
    }
    (model, Configuration::start(state))
}

/// Places where two tubes are within reach of the energy.
fn contacts(model: &Model, x: &Configuration) -> usize {
    let circle = |ring: usize| -> Circle { x.state.circle(model, ring, [0, 0]) };
    let of = |pair: &RingPair| {
        let reach = model.contact_distance(pair.ring_a, pair.ring_b);
        let minima = circle_distance_minima(&circle(pair.ring_a), &circle(pair.ring_b));
        minima.as_slice().iter().filter(|m| m.distance < reach).count()
    };
    close_pairs(model, &x.state, 0.0).iter().map(of).sum()
}

/// A Newton step of the energy method at its peak; the figures of `docs/performance.md`.
#[test]
fn a_newton_step_needs_so_much_for_a_ring_and_a_contact() {
    let mut per_ring = Vec::new();
    for tile in ["32x32", "100x100"] {
        let (model, x) = taut_sheet(tile);
        let before = memory_kib("VmRSS:");
        let options = EnergyOptions::default().contacts(&model);
        let energy = SheetEnergy::new(&model, &options);
        let here = energy.derivatives(&x);
        let step =
            here.hessian.decompose(&mut Patterns::default()).unwrap().descent_step(&here.gradient, 1e-3).unwrap();
        assert_eq!(step.len(), 6 * model.elements.len());
        let (rings, contacts) = (model.rings.len(), contacts(&model, &x));
        let kib = memory_kib("VmHWM:") - before;
        println!(
            "{rings} rings, {contacts} contacts: {:.1} KiB a ring, {:.1} KiB a contact",
            kib / rings as f64,
            kib / contacts as f64
        );
        assert!(contacts > rings, "{contacts} contacts of {rings} rings");
        per_ring.push(kib / rings as f64);
    }
    assert!(per_ring.iter().all(|kib| *kib < 15.0), "{per_ring:?} KiB a ring");
    assert!(per_ring[1] < 1.5 * per_ring[0], "{per_ring:?} KiB a ring");
}
