//! Thickest wire and widest gap against closed forms, an independent check, each other, and a bisection.

use crate::common::builtin;
use maille::{
    answer::Answer,
    design::Design,
    lattice::Cell,
    model::Model,
    record::Status,
    search::{Extreme, ExtremeOptions, extreme::extreme},
    topology,
};
use std::sync::atomic::AtomicBool;

fn solve(design: &Design, what: Extreme, options: &ExtremeOptions) -> (Model, Answer) {
    let model = Model::compile(design, Cell::PRIMITIVE).unwrap();
    let found = extreme(&model, what, options, &AtomicBool::new(false));
    (model, found)
}

fn certified(found: &Answer) -> f64 {
    assert_eq!(found.status, Status::Local);
    let certificate = found.certificate.as_ref().unwrap();
    assert!(certificate.holds() && found.links_ok == Some(true) && found.n_distinct >= Some(1));
    found.value.unwrap()
}

/// 1.1: four standing rings meet in a flat one, at R (1 − √½). 1.2: three wires fill the small ring, R/6.
#[test]
fn closed_forms() {
    for (name, r) in [("1.1", 1.0 - 0.5_f64.sqrt()), ("1.2", 1.0 / 6.0)] {
        let (_, found) = solve(&builtin(name), Extreme::ThickestWire, &ExtremeOptions::default());
        let thickest = 0.1 * certified(&found);
        assert!((thickest - r).abs() < 1e-9, "{name}: {thickest} for {r}");
    }
}

/// Rings of one wire: the gap that can be opened is twice what the wire can grow by. Seed and scale change nothing.
#[test]
fn the_widest_gap_is_what_the_thickest_wire_fills() {
    for name in ["1.1", "2-oblong", "european-4-in-1"] {
        for lattice_free in [true, false] {
            let design = builtin(name);
            let options = ExtremeOptions { lattice_free, ..ExtremeOptions::default() };
            let (model, thick) = solve(&design, Extreme::ThickestWire, &options);
            let (_, wide) = solve(&design, Extreme::LargestClearance, &ExtremeOptions { seed: 7, ..options.clone() });
            let r = model.rings[0].minor_radius;
            let (factor, gap) = (certified(&thick), certified(&wide));
            assert!((2.0 * r * (factor - 1.0) - gap).abs() < 1e-8, "{name} {lattice_free}: {factor}, {gap}");
            let (found, _) = topology::smallest_gap(&model, &wide.state).unwrap();
            assert!((found - gap).abs() < 1e-9, "{name}: the state has {found}");
            let (_, scaled) = solve(&design.scaled(7.3), Extreme::ThickestWire, &options);
            assert!((certified(&scaled) - factor).abs() < 1e-8);
        }
    }
}

/// At a wire a millionth thinner there is a state; at one a millionth thicker none is found from fifty starts.
#[test]
fn a_bisection_finds_no_thicker_wire() {
    for name in ["1.1", "european-4-in-1"] {
        let design = builtin(name);
        let (_, found) = solve(&design, Extreme::ThickestWire, &ExtremeOptions::default());
        let thickest = certified(&found) * design.minor_radius.unwrap();
        let room = |r: f64, starts: usize| {
            let design = Design { allow_initial_overlap: true, ..design.with_minor_radius(r) };
            let options = ExtremeOptions { starts: Some(starts), ..ExtremeOptions::default() };
            solve(&design, Extreme::LargestClearance, &options).1.value.unwrap()
        };
        let step = 1e-6 * design.reference_radius;
        assert!(room(thickest - step, 2) >= 0.0, "{name}");
        let above = room(thickest + step, 50);
        assert!(above < 0.0, "{name}: {above}");
    }
}

/// The state as a design file is the same sheet.
#[test]
fn a_state_is_a_design() {
    for name in ["european-4-in-1", "1.3-small"] {
        let design = builtin(name);
        let (model, found) =
            solve(&design, Extreme::LargestClearance, &ExtremeOptions { starts: Some(2), ..ExtremeOptions::default() });
        let posed = found.state.design(&design, &model);
        let again = Model::compile(&posed, Cell::PRIMITIVE).unwrap();
        let gap = |model: &Model, state: &maille::state::State| topology::smallest_gap(model, state).unwrap().0;
        assert!((gap(&again, &again.start) - gap(&model, &found.state)).abs() < 1e-12);
        assert_eq!(again.links.len(), model.links.len());
    }
}

#[test]
fn threads_change_nothing() {
    let design = builtin("2-oblong");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&design, Extreme::ThickestWire, &ExtremeOptions::default()).1)
    };
    let (one, three) = (on(1), on(3));
    assert_eq!((one.value, one.state), (three.value, three.state));
}
