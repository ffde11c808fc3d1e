//! The built-in designs: neighbours, gaps, and one limit of each by the energy method.

use crate::common::model;
use maille::{
    lattice::{Cell, Direction},
    model::Model,
    record::Status,
    relaxation::limit::{EnergyMethod, EnergyOptions},
    topology::{RingPair, close_pairs, close_pairs_within, neighbours, smallest_gap},
};
use std::{collections::BTreeSet, sync::atomic::AtomicBool};

/// Name, interlocking neighbours of each element of the cell, smallest gaps at r = 0.1 and 0.05 (negative: overlap).
const DESIGNS: [(&str, &[usize], [f64; 2]); 24] = [
    ("1.1", &[4, 2, 2], [0.1536, 0.2536]),
    ("1.2", &[4, 2, 2], [0.05, 0.15]),
    ("1.3", &[4, 2, 2], [0.0832, 0.1832]),
    ("1.3-small", &[4, 2, 2], [0.0409, 0.1409]),
    ("2", &[4, 4], [0.0178, 0.1178]),
    ("2-oblong", &[4, 4], [0.1, 0.2]),
    ("3.1", &[6, 2, 2, 2], [0.05, 0.15]),
    ("3.2", &[6, 2, 2, 2], [0.05, 0.15]),
    ("3.3", &[4, 4, 4, 2, 2, 2, 2, 2, 2], [0.05, 0.15]),
    ("3.4", &[6, 2, 2, 2], [0.1544, 0.2544]),
    ("4.1", &[4, 4], [0.1, 0.2]),
    ("4.2", &[4, 2, 2], [0.1536, 0.2536]),
    ("4.3", &[4, 2, 2], [0.2, 0.3]),
    ("5.1", &[8, 8, 4, 4, 4, 4], [0.04, 0.14]),
    ("5.2", &[12, 12, 4, 4, 4, 4, 4, 4], [0.04, 0.14]),
    ("1.1-chapter6", &[4, 2, 2], [-0.1576, -0.0576]),
    ("1.2-chapter6", &[4, 2, 2], [-0.14, -0.04]),
    ("2-chapter6", &[4, 4], [-0.18, -0.08]),
    ("3.1-chapter6", &[6, 2, 2, 2], [-0.17, -0.07]),
    ("3.2-chapter6", &[6, 2, 2, 2], [-0.14, -0.04]),
    ("3.4-chapter6", &[6, 2, 2, 2], [-0.1, 0.0]),
    ("4.1-chapter6", &[4, 4], [-0.1777, -0.0777]),
    ("4.3-chapter6", &[4, 2, 2], [-0.11, -0.01]),
    ("5.2-chapter6", &[12, 12, 4, 4, 4, 4, 4, 4], [-0.1028, -0.0028]),
];

/// Four pairs of rings of two elements in one place: one problem.
#[test]
fn elements_that_meet_are_one_problem() {
    let rings = "[{ major_radius = 1.0, normal = [0.0, 0.0, 1.0] }, { major_radius = 1.0, normal = [1.0, 0.0, 0.0] }]";
    let element = |name: &str| format!("[[elements]]\nname = \"{name}\"\ncenter = [0.0, 0.0, 0.0]\nrings = {rings}\n");
    let text = format!(
        "name = \"two\"\nminor_radius = 0.1\nreference_radius = 1.0\n[lattice]\na1 = [6.0, 0.0, 0.0]\na2 = [0.0, 6.0, 0.0]\n{}{}",
        element("a"),
        element("b")
    );
    let design = maille_io::read_design("two", &text).unwrap();
    let problems = Model::compile(&design, Cell::PRIMITIVE).unwrap_err();
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert_eq!(problem.problem, "the core curves of \"a\" and \"b\" meet in the starting state");
}

/// Of a flat sheet the pairs of a tile are those of the sheet whose cells the tile has.
#[test]
fn pairs_of_a_tile_are_those_of_the_sheet() {
    for (name, tile) in [("1.1", [3, 2]), ("japanese-6-in-1", [2, 2]), ("stadium-sheet", [1, 4])] {
        let model = model(name, 0.1);
        let within = |pair: &RingPair| (0..2).all(|k| pair.shift[k].unsigned_abs() < tile[k]);
        let pairs: BTreeSet<RingPair> = close_pairs(&model, &model.start, 0.5).into_iter().filter(within).collect();
        let found: BTreeSet<RingPair> = close_pairs_within(&model, &model.start, tile, 0.5).into_iter().collect();
        assert!(pairs.len() > 2 && pairs == found, "{name}: {pairs:?} {found:?}");
    }
}

#[test]
fn neighbours_and_gaps_are_those_of_the_table() {
    for (name, expected, gaps) in DESIGNS {
        for (r, gap) in [0.1, 0.05].into_iter().zip(gaps) {
            let model = model(name, r);
            let mut counts: Vec<usize> = (0..model.elements.len()).map(|e| neighbours(&model, e).len()).collect();
            counts.sort_by(|a, b| b.cmp(a));
            assert_eq!(counts, expected, "{name} r = {r}");
            let (found, _) = smallest_gap(&model, &model.start).unwrap();
            let digits = if gap < 0.0 { 5.1e-4 } else { 5.1e-5 }; // as many as the table gives
            assert!((found - gap).abs() < digits, "{name} r = {r}: {found} should be {gap}");
        }
    }
}

/// One limit of each along 0°, with a coarse step: the method runs and ends with a limit. `closed` are exact stretches.
fn the_energy_method_runs_every_design(r: f64, closed: &[(&str, f64)]) {
    let coarse = EnergyOptions { tau: 0.01, alpha: 1e4, l1_step: 0.3, l1_resolution: 0.02, ..Default::default() };
    for (name, ..) in DESIGNS.into_iter().filter(|design| design.0 != "5.2-chapter6") {
        let model = model(name, r);
        let cancel = AtomicBool::new(false);
        let limit = EnergyMethod::new(&model, coarse.clone(), &cancel).limit(Direction::of_degrees(0.0), 0.0, &cancel);
        let stretch = limit.gradient[(0, 0)];
        let exact = closed.iter().find(|c| c.0 == name);
        if let Some((_, exact)) = exact {
            assert!((stretch - exact).abs() < 0.03, "{name}: {stretch} should be about {exact}");
        }
        assert!(stretch > 1.0 && stretch < 3.0, "{name}: {stretch}");
        assert_eq!(limit.status, Status::ThresholdReached, "{name}: {:?}", limit.note);
    }
}

/// Chains of two flat rings and a standing one bind in most; 5.x are limits of the exact method.
#[test]
fn the_energy_method_runs_every_design_at_a_tenth() {
    let closed = [
        ("1.1", 1.44),
        ("1.2", 1.04),
        ("1.1-chapter6", 3.6 / 2.06),
        ("1.2-chapter6", 2.6 / 2.06),
        ("3.1", 1.44),
        ("3.2", 1.04),
    ];
    let more = [
        ("3.1-chapter6", 3.6 / 2.06),
        ("3.2-chapter6", 2.6 / 2.06),
        ("3.3", 1.44),
        ("5.1", 1.324047),
        ("5.2", 1.232733),
    ];
    the_energy_method_runs_every_design(0.1, &[&closed[..], &more[..]].concat());
}

#[test]
fn the_energy_method_runs_every_design_at_a_twentieth() {
    let closed = [
        ("1.1", 1.52),
        ("1.2", 1.12),
        ("1.1-chapter6", 3.8 / 2.06),
        ("1.2-chapter6", 2.8 / 2.06),
        ("3.1", 1.52),
        ("3.2", 1.12),
    ];
    let more = [
        ("3.1-chapter6", 3.8 / 2.06),
        ("3.2-chapter6", 2.8 / 2.06),
        ("3.3", 1.52),
        ("5.1", 1.405348),
        ("5.2", 1.308428),
    ];
    the_energy_method_runs_every_design(0.05, &[&closed[..], &more[..]].concat());
}
