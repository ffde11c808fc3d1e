//! What chapter 6 says of the designs that its text fixes, measured with the exact method in steps of 15°.
//!
//! The verdicts are asserted as they came out, exceptions too, beside numbers that closed forms give.

use maille::{
    characterize::{Method, characterize},
    design::Design,
    lattice::Cell,
    limit::exact::ExactOptions,
    model::Model,
    record::LimitRow,
};
use maille_io::{
    record::{Counters, NamedRecord, Record, RunRecord},
    report::{Finding, Map, SCALED, Verdict, statements},
};
use std::sync::{Mutex, atomic::AtomicBool};

const DESIGNS: [&str; 6] = ["1.1", "1.2", "1.3", "2", "3.1", "3.2"];

fn limits(design: &Design, l2: &[f64]) -> Map {
    let model = Model::compile(design, Cell::PRIMITIVE).unwrap();
    let directions: Vec<f64> = (0..12).map(|k| 15.0 * f64::from(k)).collect();
    let rows: Mutex<Vec<LimitRow>> = Mutex::new(Vec::new());
    let method = Method::Exact(ExactOptions::default());
    let found = |finished: maille::characterize::Finished| rows.lock().unwrap().push(finished.row);
    let cancel = AtomicBool::new(false);
    characterize(&[model], design.minor_radius, &method, &directions, l2, &|_| true, &cancel, &found);
    let mut rows = rows.into_inner().unwrap();
    rows.sort_by(|a, b| a.l2.total_cmp(&b.l2).then(a.direction_deg.total_cmp(&b.direction_deg)));
    let run = RunRecord {
        schema: maille::record::RECORD_SCHEMA,
        program_version: String::new(),
        input_hash: String::new(),
        design: design.clone(),
        parameters: serde_json::json!({ "method": "exact", "cells": ["1x1"] }),
        counters: Counters::of(&rows),
        files: Default::default(),
    };
    Map::of(&NamedRecord { name: design.name.clone(), record: Record { run, rows, states: Vec::new() } }).unwrap()
}

fn design(name: &str, ratio: f64) -> Design {
    maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap().with_minor_radius(ratio)
}

fn l1(maps: &[Map], design: &str, ratio: f64, direction_deg: f64, l2: f64) -> f64 {
    let map = maps.iter().find(|map| map.design == design && map.ratio == ratio).unwrap();
    let row = map.rows.iter().find(|row| row.direction_deg == direction_deg && row.l2 == l2).unwrap();
    assert_eq!(row.links_ok, Some(true));
    assert!(row.max_overlap.unwrap() < 1e-9);
    row.l1.unwrap()
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-6, "{a}, not {b}");
}

#[test]
fn statements_1_to_5_and_8_as_measured() {
    let l2 = [-0.25, -0.125, 0.0];
    let mut maps: Vec<Map> =
        DESIGNS.iter().flat_map(|name| [0.1, 0.05].map(|ratio| limits(&design(name, ratio), &l2))).collect();
    let base = design("1.1", 0.1);
    let scaled = Design { name: base.name.clone() + SCALED, ..base.scaled(7.3) };
    maps.push(limits(&scaled, &l2));

    // Interlocking directions come from the links.
    let interlocking = |name: &str| maps.iter().find(|map| map.design == name).unwrap().interlocking_deg.clone();
    let is = |name: &str, wanted: &[f64]| {
        let found = interlocking(name);
        assert_eq!(found.len(), wanted.len(), "{name}: {found:?}");
        found.iter().zip(wanted).for_each(|(a, b)| near(*a, *b));
    };
    ["1.1", "1.2", "1.3"].iter().for_each(|name| is(name, &[0.0, 90.0]));
    ["3.1", "3.2"].iter().for_each(|name| is(name, &[0.0, 60.0, 120.0]));
    let diagonal = (2.3f64 / 1.4).atan().to_degrees();
    is("2", &[diagonal, 180.0 - diagonal]);

    // Chains of two flat rings and a standing one are no longer than d = 2 (R1 + R2 − 2 r), for every l2. Between them both
    // bind: in a square cell (1 + l1)² + (1 + l2)² = 2 (d/s)², in a triangular one at l2 = 0 (1 + l1)² = (4 (d/s)² − 1)/3.
    for (name, ratio, d) in [
        ("1.1", 0.1, 3.6),
        ("1.1", 0.05, 3.8),
        ("1.2", 0.1, 2.6),
        ("1.2", 0.05, 2.8),
        ("3.1", 0.1, 3.6),
        ("3.1", 0.05, 3.8),
        ("3.2", 0.1, 2.6),
        ("3.2", 0.05, 2.8),
    ] {
        let reach: f64 = d / 2.5;
        let triangular = name.starts_with('3');
        let (along, between): (&[f64], &[f64]) =
            if triangular { (&[0.0, 60.0, 120.0], &[30.0, 90.0, 150.0]) } else { (&[0.0, 90.0], &[45.0, 135.0]) };
        for l2 in l2 {
            along.iter().for_each(|at| near(l1(&maps, name, ratio, *at, l2), reach - 1.0));
            if !triangular {
                let both = (2.0 * reach * reach - (1.0 + l2).powi(2)).sqrt() - 1.0;
                between.iter().for_each(|at| near(l1(&maps, name, ratio, *at, l2), both));
            }
        }
        let largest = ((4.0 * reach * reach - 1.0) / 3.0).sqrt() - 1.0;
        between.iter().filter(|_| triangular).for_each(|at| near(l1(&maps, name, ratio, *at, 0.0), largest));
    }
    // Largest limits that no closed form gives: 3.x under compression, 1.3 and 2 for each l2.
    for (name, ratio, at, of_l2) in [
        ("3.1", 0.1, 30.0, [0.604566, 0.584058, 0.559316]),
        ("3.1", 0.05, 30.0, [0.700718, 0.680870, 0.657468]),
        ("3.2", 0.1, 30.0, [0.116903, 0.089028, 0.052996]),
        ("3.2", 0.05, 30.0, [0.218072, 0.190515, 0.157238]),
        ("1.3", 0.1, 45.0, [0.141914, 0.133313, 0.073873]),
        ("1.3", 0.05, 45.0, [0.269019, 0.253992, 0.207449]),
        ("2", 0.1, 0.0, [0.616369, 0.650292, 0.768381]),
        ("2", 0.1, 60.0, [0.337253, 0.337212, 0.337165]),
        ("2", 0.05, 0.0, [1.105146, 1.069030, 1.044155]),
        ("2", 0.05, 60.0, [0.411557, 0.411518, 0.411474]),
    ] {
        for (l2, limit) in l2.into_iter().zip(of_l2) {
            near(l1(&maps, name, ratio, at, l2), limit);
        }
    }

    let found = statements(&maps);
    let of = |number: u32| -> &Finding { found.iter().find(|finding| finding.number == number).unwrap() };
    let scores = |number: u32| of(number).evidence.join(" ");
    for (number, verdict) in [
        (1, Verdict::Holds),
        (2, Verdict::HoldsWithExceptions),
        (3, Verdict::HoldsWithExceptions),
        (4, Verdict::Holds),
        (5, Verdict::Holds),
        (6, Verdict::NotMeasured),
        (8, Verdict::Fails),
    ] {
        assert_eq!(of(number).verdict, verdict, "{number}: {:?}", of(number).exceptions);
    }
    let says = |number: u32, words: &str| assert!(scores(number).contains(words), "{number}: {}", scores(number));
    // 1: in 34 turns.
    says(1, "along every interlocking direction in 34 of 34 cases. It is largest midway between two in 34 of 34 cases");
    assert!(of(1).exceptions.is_empty(), "{:?}", of(1).exceptions);
    // 2: everywhere; of design 2 the thesis expects otherwise, through stacking, which does not come about.
    says(2, "goes further in 210 of 210 cases");
    says(2, "grows with it in 17 of 17 cases. Least gain in l₁: 0.0743");
    assert!(of(2).exceptions[0].starts_with("2: the exception that the thesis names is not seen"));
    // 3: along the links nothing changes. Near 0° design 2 is lowered at R/10 (above), not at R/20.
    says(3, "raises the limit in 232 of 276 cases");
    says(3, "leaves it as it is in 42, and lowers it in 2.");
    for exception in [
        "2, r = R/20, exact: the exception within ±15° is not seen",
        "1.3, r = R/10, exact, l₂ = −0.125: lower than at l₂ = 0 at 0°, 90°",
        "3.1, r = R/10, exact, l₂ = −0.25, −0.125: as at l₂ = 0 at 0°, 60°, 120°",
    ] {
        assert!(of(3).exceptions.iter().any(|text| text == exception), "{:?}", of(3).exceptions);
    }
    // 4
    says(4, "agree in 24 of 24 cases. The larger R has the larger limit in 144 of 144 cases");
    says(4, "(within 10 %) in 8 of 8 cases");
    // 5
    says(5, "36 of 36 cases agree to 1e-9");
    // Where chains bind, the difference of (1 + l1)² falls by what (1 + l2)² grows, for either major radius.
    for (name, ratio) in [("1.1", 0.1), ("1.1", 0.05), ("1.2", 0.1), ("1.2", 0.05)] {
        let square = |d: f64, l2: f64| (1.0 + l1(&maps, name, ratio, d, l2)).powi(2);
        let fall = (square(45.0, -0.125) - square(0.0, -0.125)) - (square(45.0, 0.0) - square(0.0, 0.0));
        near(fall, 1.0 - 0.875f64.powi(2));
    }
    // 8: 1.2 is blunter under compression, and has the same shape at l2 = 0.
    says(8, "blunter in 4 of 6 cases. l₂ < 0: blunter 4, unchanged 0, sharper 0. l₂ = 0: blunter 0, unchanged 2");
}
