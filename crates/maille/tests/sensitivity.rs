//! Derivatives of limits against differences of limits that are solved anew.

mod common;

use maille::{
    Across, Answer, Cell, Design, Goal, Question, Sense, Sheet, Strain,
    question::Effort,
    sensitivity::{DesignVector, Sensitivity, Slope},
};
use maille_geometry::Vec3;
use nalgebra::{UnitQuaternion, Vector2};
use std::collections::BTreeSet;

fn builtin(name: &str) -> Design {
    maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap()
}

fn solved(design: &Design, question: &Question) -> (Sheet, Answer) {
    let sheet = Sheet::in_cells(design, Cell::PRIMITIVE.into()).unwrap();
    let answer = sheet.answer(question).unwrap();
    (sheet, answer)
}

fn stretch(direction_deg: f64, l2: f64) -> Question {
    Question { starts: Some(4), ..Question::stretch_along(direction_deg).with_lateral(l2) }
}

fn rings(design: &Design) -> usize {
    design.elements.iter().map(|element| element.rings.len()).sum()
}

/// The design changed by `step` times `change`.
fn moved(design: &Design, change: &DesignVector, step: f64) -> Design {
    let mut out = design.clone();
    for (a, rate) in [&mut out.lattice.a1, &mut out.lattice.a2].into_iter().zip(&change.lattice) {
        (0..2).for_each(|k| a[k] += step * rate[k]);
    }
    let own = out.elements.iter_mut().flat_map(|element| &mut element.rings);
    for (ring, rate) in own.zip(&change.rings) {
        ring.major_radius += step * rate.major_radius;
        ring.minor_radius = Some(ring.minor_radius.or(design.minor_radius).unwrap() + step * rate.minor_radius);
        ring.offset = (Vec3::from(ring.offset) + rate.offset * step).into();
        ring.normal = (UnitQuaternion::from_scaled_axis(rate.tilt * step) * Vec3::from(ring.normal)).into();
    }
    out
}

/// One unit change for each raw number of the design, by its name.
fn raw_numbers(design: &Design) -> Vec<(String, DesignVector)> {
    let zeros = || DesignVector::zeros(rings(design));
    let mut out = Vec::new();
    for k in 0..4 {
        let mut change = zeros();
        change.lattice[k / 2][k % 2] = 1.0;
        out.push((format!("a{}.{}", k / 2 + 1, ["x", "y"][k % 2]), change));
    }
    for ring in 0..rings(design) {
        let mut add = |what: &str, set: &dyn Fn(&mut maille::sensitivity::RingVector)| {
            let mut change = zeros();
            set(&mut change.rings[ring]);
            out.push((format!("ring {ring} {what}"), change));
        };
        add("R", &|r| r.major_radius = 1.0);
        add("r", &|r| r.minor_radius = 1.0);
        for k in 0..3 {
            add(&format!("offset {k}"), &|r| r.offset[k] = 1.0);
            add(&format!("tilt {k}"), &|r| r.tilt[k] = 1.0);
        }
    }
    out
}

/// Pairs that carry.
fn loaded(answer: &Answer) -> BTreeSet<(usize, usize, [i32; 2])> {
    let carrying = answer.contacts.iter().filter(|contact| contact.force > 1e-6);
    carrying.map(|contact| (contact.pair.ring_a, contact.pair.ring_b, contact.pair.shift)).collect()
}

/// The answers at −2h, −h, h, 2h along `change`, if the loaded contacts are those of `from` in all of them.
fn around(design: &Design, question: &Question, change: &DesignVector, h: f64, from: &Answer) -> Option<[f64; 4]> {
    let mut out = [0.0; 4];
    for (value, step) in out.iter_mut().zip([-2.0, -1.0, 1.0, 2.0]) {
        let (_, answer) = solved(&moved(design, change, step * h), question);
        *value = answer.limit().filter(|_| loaded(&answer) == loaded(from))?;
    }
    Some(out)
}

/// Counts of compared and of left-out numbers, and the largest error relative to the design's largest derivative of its kind.
#[derive(Debug, Default)]
struct Tally {
    limits: usize,
    unique: usize,
    compared: usize,
    changed: usize,
    worst: f64,
    where_worst: String,
}

fn compare(name: &str, directions: &[f64], l2: &[f64], tally: &mut Tally) {
    let design = builtin(name);
    let h = 1e-4 * design.reference_radius;
    for (&direction, &l2) in directions.iter().flat_map(|d| l2.iter().map(move |l2| (d, l2))) {
        let question = stretch(direction, l2);
        let (sheet, answer) = solved(&design, &question);
        if !answer.is_limit() {
            continue;
        }
        tally.limits += 1;
        let found = Sensitivity::of(&sheet.model_of(&answer), &question, &answer).unwrap();
        if !found.forces_are_unique() {
            continue;
        }
        tally.unique += 1;
        for (number, change) in raw_numbers(&design) {
            let h = if number.contains("tilt") { 1e-4 } else { h };
            let Some([f0, f1, f2, f3]) = around(&design, &question, &change, h, &answer) else {
                tally.changed += 1;
                continue;
            };
            let expected = (f0 - 8.0 * f1 + 8.0 * f2 - f3) / (12.0 * h);
            let error = (found.along(&change) - expected).abs() / expected.abs().max(0.1 * h / 1e-4 * 1e-2 / design.reference_radius.max(h / 1e-4));
            tally.compared += 1;
            if error > tally.worst {
                tally.worst = error;
                tally.where_worst = format!("{name} {direction}° l2 {l2} {number}: {} {expected}", found.along(&change));
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_limits_solved_anew() {
    let mut tally = Tally::default();
    for name in ["1.1", "2", "4.1"] {
        compare(name, &[10.0, 33.0], &[0.0, -0.05], &mut tally);
    }
    println!("{tally:#?}");
    assert!(tally.worst < 1e-5, "{tally:#?}");
}

#[test]
#[ignore = "minutes: all built-in designs"]
fn derivatives_of_all_builtin_designs() {
    for builtin in maille_io::builtin_designs() {
        let mut tally = Tally::default();
        compare(builtin.name, &[0.0, 10.0, 33.0], &[0.0, -0.05], &mut tally);
        println!("{}: {tally:?}", builtin.name);
    }
}
