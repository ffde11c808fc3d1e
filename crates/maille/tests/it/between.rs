//! The largest and the smallest l1 between the directions of a map.

use crate::common::{self, design, exact_map, map, rows};
use maille::{
    design::Design,
    lattice::{Across, Cell},
    model::Model,
    record::{LimitRow, StateRecord, Status},
    search::ExactOptions,
    survey::{Finished, MapQuestion, direction_slope, extremes},
};
use std::sync::{Mutex, atomic::AtomicBool};

/// 1.1 with smaller rings across, on a shorter lattice: its largest l1 is at a corner near 43.4°.
fn uneven() -> Design {
    let mut out = design("1.1", 0.1);
    out.lattice.a2 = [0.0, 14.0 / 6.0, 0.0];
    out.elements[2].center = [0.0, 7.0 / 6.0, 0.0];
    out.elements[2].rings[0].major_radius = 5.0 / 6.0;
    out
}

fn compiled(design: &Design) -> Vec<Model> {
    vec![Model::compile(design, Cell::PRIMITIVE).unwrap()]
}

/// The extremes of a map, the largest first.
fn sought(models: &[Model], question: &MapQuestion) -> Vec<Finished> {
    let known: Vec<(LimitRow, StateRecord)> = rows(models, question).into_iter().map(|f| (f.row, f.state)).collect();
    let out = Mutex::new(Vec::new());
    let finished = |found| out.lock().unwrap().push(found);
    extremes(models, None, question, &known, &AtomicBool::new(false), &|_, _| (), &finished);
    let mut out: Vec<Finished> = out.into_inner().unwrap();
    out.sort_by(|a, b| a.row.extreme.cmp(&b.row.extreme));
    out
}

fn l1(found: &Finished) -> f64 {
    found.row.l1.unwrap()
}

/// Held width, free width and free shear, where the limit is smooth.
#[test]
fn the_derivative_by_the_direction_is_that_of_differences() {
    let models = compiled(&uneven());
    let across = |lateral_free, shear_free| Across { lateral_free, shear_free };
    let mut tried = 0;
    for across in [across(false, false), across(false, true), across(true, true)] {
        let options = ExactOptions { across, ..ExactOptions::default() };
        for direction_deg in [17.0, 52.0, 124.0] {
            let step_deg = 1e-4;
            let directions = [direction_deg - step_deg, direction_deg, direction_deg + step_deg];
            let found = map(&models, &directions, if across.lateral_free { &[0.0] } else { &[0.1] }, &options);
            let cell = found[1].row.cell.parse().unwrap();
            let model = Model::compile(&uneven(), cell).unwrap();
            let slope = direction_slope(&model, &found[1].state).unwrap();
            let [before, after] = [l1(&found[1]) - l1(&found[0]), l1(&found[2]) - l1(&found[1])];
            if (before - after).abs() > 1e-3 * step_deg.to_radians() {
                continue; // a corner
            }
            let measured = (before + after) / (2.0 * step_deg.to_radians());
            assert!((slope - measured).abs() < 1e-4, "{across:?} {direction_deg}: {slope} for {measured}");
            tried += 1;
        }
    }
    assert!(tried > 6, "{tried}");
}

/// From a few directions the same corner is found as from many, no direction of a scan goes beyond it, and it is what a map of its
/// direction finds.
#[test]
fn the_largest_l1_lies_between_the_directions() {
    let models = compiled(&uneven());
    let options = ExactOptions::default();
    let every = |step: usize| -> Vec<f64> { (0..=180).step_by(step).map(|deg| deg as f64).collect() };
    let [few, many] = [15, 5].map(|step| sought(&models, &exact_map(&options, &every(step), &[0.0])));
    let (largest, same) = (&few[0], &many[0]);
    assert_eq!(largest.row.extreme.as_deref(), Some("largest"));
    assert!(
        (l1(largest) - l1(same)).abs() < 1e-6 && (l1(same) - 0.741723).abs() < 1e-6,
        "{} {}",
        l1(largest),
        l1(same)
    );
    assert!(largest.row.direction_deg > 43.0 && largest.row.direction_deg < 44.0, "{}", largest.row.direction_deg);
    let fine: Vec<f64> = (0..=90).map(|k| 42.0 + 0.05 * f64::from(k)).collect();
    for found in map(&models, &fine, &[0.0], &options) {
        assert!(l1(&found) <= l1(same) + 1e-6, "{} at {}", l1(&found), found.row.direction_deg);
    }
    let alone = map(&models, &[same.row.direction_deg], &[0.0], &options);
    assert_eq!((alone[0].row.l1, &alone[0].state), (same.row.l1, &same.state));
    // Where the extremes are among the directions there is nothing to add.
    assert!(sought(&compiled(&design("1.1", 0.1)), &exact_map(&options, &every(15), &[0.0])).is_empty());
}

/// In a range that has neither 0° nor 180° within it, and of a mirror image.
#[test]
fn a_range_and_a_mirror_image_have_the_same_corner() {
    let (own, mut mirrored) = (uneven(), uneven());
    mirrored.lattice.a2 = [0.0, -14.0 / 6.0, 0.0];
    mirrored.elements[2].center = [0.0, -7.0 / 6.0, 0.0];
    let options = ExactOptions::default();
    let [right, left] = [(own, [20.0, 35.0, 50.0]), (mirrored, [130.0, 145.0, 160.0])]
        .map(|(design, directions)| sought(&compiled(&design), &exact_map(&options, &directions, &[-0.1, 0.2])));
    let largest = |all: &[Finished]| -> Vec<(f64, f64)> {
        let rows = all.iter().filter(|f| f.row.extreme.as_deref() == Some("largest"));
        let mut out: Vec<_> = rows.map(|f| (f.row.l2, l1(f))).collect();
        out.sort_by(|a, b| a.0.total_cmp(&b.0));
        out
    };
    let (right, left) = (largest(&right), largest(&left));
    assert_eq!((right.len(), left.len()), (2, 2));
    for (a, b) in right.iter().zip(&left) {
        assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-6, "{a:?} {b:?}");
    }
}

/// Where no state has the width further on, the last limit is followed towards there: what is found is certified, near the end, and lower than all
/// around it.
#[test]
fn the_smallest_l1_can_lie_at_the_end_of_the_directions_with_a_state() {
    let models = compiled(&common::builtin("european-4-in-1"));
    let options = ExactOptions::default();
    let found = sought(&models, &exact_map(&options, &[20.0, 30.0, 40.0], &[0.1]));
    let smallest = found.iter().find(|f| f.row.extreme.as_deref() == Some("smallest")).unwrap();
    assert!(matches!(smallest.row.status, Status::Local | Status::Global) && smallest.row.links_ok == Some(true));
    assert!(l1(smallest) < -0.09 && (38.5..38.6).contains(&smallest.row.direction_deg), "{:?}", smallest.row);
    for around in map(&models, &[30.0, 35.0, 38.0, 38.7], &[0.1], &options) {
        assert!(around.row.l1.is_none_or(|l1_around| l1_around > l1(smallest)), "{:?}", around.row);
    }
}
