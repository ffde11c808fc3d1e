//! Derivatives of limits against differences of limits that are solved anew.

mod builtin;
mod compare;

use crate::common::builtin;
use compare::{Case, Tally, compare, limit, loaded, raw_numbers};
use maille::{
    Across, Answer, Cell, Design, Goal, Question, Sense, Sheet, Strain,
    sensitivity::{DesignVector, Sensitivity, Slope, gradient},
};
use maille_geometry::Vec3;
use nalgebra::UnitQuaternion;
use std::{sync::atomic::AtomicBool, time::Instant};

fn solved(design: &Design, question: &Question) -> (Sheet, Answer) {
    let sheet = Sheet::in_cells(design, Cell::PRIMITIVE.into()).unwrap();
    let answer = sheet.answer(question).unwrap();
    (sheet, answer)
}

/// From the state of `near`, the answer of another design, alone.
fn solved_near(design: &Design, question: &Question, near: &Answer) -> Answer {
    let sheet = Sheet::in_cells(design, Cell::PRIMITIVE.into()).unwrap();
    let alone = Question { starts: Some(1), ..question.clone() };
    sheet.answer_near(&alone, near, &AtomicBool::new(false)).unwrap()
}

fn stretch(direction_deg: f64, l2: f64) -> Question {
    Question { starts: Some(4), ..Question::stretch_along(direction_deg).with_lateral(l2) }
}

fn rings(design: &Design) -> usize {
    design.elements.iter().map(|element| element.rings.len()).sum()
}

/// Along 45° the chains of 1.1 along 0° and 90° are taut at once: longer rings in one of them alone do nothing, shorter ones cost.
/// Both chains have the length P = 2 (R + R') − 2 (r + r') = 3.6, 1.44 times the spacing s, so (1 + l1)² = 2 (P/s)² − 1.
#[test]
fn both_sides_of_a_kink() {
    let mut tally = Tally::default();
    compare("1.1", &[45.0, 135.0], &[0.0], &mut tally);
    println!("{tally:#?}");
    assert!(tally.kinks >= 16 && tally.sides > 100 && tally.wrong + tally.changed + tally.no_limit == 0, "{tally:#?}");

    let (design, question) = (builtin("1.1"), stretch(45.0, 0.0));
    let (sheet, answer) = solved(&design, &question);
    let found = Sensitivity::of(&sheet.model_of(&answer), &question, &answer).unwrap();
    let stretch = (2.0 * 1.44_f64.powi(2) - 1.0).sqrt();
    let slope = 2.0 * 1.44 / stretch * 2.0 / 2.5;
    let mut longer = DesignVector::zeros(3);
    longer.rings[1].major_radius = 1.0;
    let both = found.one_sided(&longer);
    assert!(both.is_kink(), "{both:?}");
    let [backward, forward] = [both.backward, both.forward].map(|slope| slope.finite().unwrap());
    assert!((backward - slope).abs() < 1e-8 && forward.abs() < 1e-8, "{both:?}, expected {slope} and 0");
}

/// Along 33° two chains of 1.3 are taut at once, and the state that is found has forces in one of them alone: longer rings of either chain do
/// nothing, shorter ones cost.
#[test]
fn a_taut_chain_without_force_bounds_the_other_side() {
    let (design, question) = (builtin("1.3"), stretch(33.0, 0.0));
    let (sheet, answer) = solved(&design, &question);
    let found = Sensitivity::of(&sheet.model_of(&answer), &question, &answer).unwrap();
    for ring in [1, 2] {
        let mut longer = DesignVector::zeros(rings(&design));
        longer.rings[ring].major_radius = 1.0;
        let both = found.one_sided(&longer);
        let [backward, forward] = [both.backward, both.forward].map(|slope| slope.finite().unwrap());
        assert!(forward.abs() < 1e-6 && (backward - 0.927).abs() < 1e-3, "ring {ring}: {both:?}");
    }
}

/// A state of the limit and its images under symmetries of the design carry other forces: a change that breaks the symmetry chooses
/// the best of them. So both sides are the same whichever of them was found, and the value rises to both sides.
#[test]
fn images_of_a_limit_tie() {
    for (name, direction, l2, ties) in [("3.4-chapter6", 33.0, -0.05, 18), ("2-chapter6", 0.0, -0.05, 2)] {
        let design = builtin(name);
        let asked = stretch(direction, l2);
        let found = |seed: u64| {
            let question = Question { seed, ..asked.clone() };
            let (sheet, answer) = solved(&design, &question);
            let found = Sensitivity::of(&sheet.model_of(&answer), &question, &answer).unwrap();
            (answer, found)
        };
        let (answer, first) = found(1);
        let tied: Vec<_> = raw_numbers(&design).into_iter().filter(|(_, change)| first.images_tie(change)).collect();
        let mut tally = Tally::default();
        let case = Case { design: &design, question: &asked, answer: &answer, found: &first, label: name.into() };
        tied.iter().for_each(|(number, change)| case.sides(number, change, &mut tally));
        assert!(tied.len() == ties && tally.sides == 2 * ties && tally.wrong == 0, "{name}: {tally:#?}");
        let mut others = 0;
        for seed in 2..4 {
            let (other, again) = found(seed);
            if (other.value.unwrap() - answer.value.unwrap()).abs() > 1e-9 {
                continue;
            }
            for (number, change) in &tied {
                let [a, b] = [&first, &again].map(|found| found.one_sided(change));
                let apart = |a: Slope, b: Slope| (a.finite().unwrap() - b.finite().unwrap()).abs();
                let most = apart(a.backward, b.backward).max(apart(a.forward, b.forward));
                assert!(most < 1e-6, "{name} {number}: {a:?} {b:?}");
                others += usize::from((first.along(change) - again.along(change)).abs() > 1e-3);
            }
        }
        assert!(others > 0, "{name}: every search ends in the same state");
    }
}

/// Prints what the derivatives of a limit take beside the limit.
#[test]
#[ignore = "a measurement of time"]
fn times_of_derivatives_and_of_their_limit() {
    for (name, cell) in [("2", "1x1"), ("1.1", "1x1"), ("1.1", "2x2")] {
        let (design, question) = (builtin(name), stretch(33.0, 0.0));
        let begun = Instant::now();
        let sheet = Sheet::in_cells(&design, cell.parse().unwrap()).unwrap();
        let answer = sheet.answer(&question).unwrap();
        let solve = begun.elapsed().as_secs_f64();
        let (model, changes) = (sheet.model_of(&answer), raw_numbers(&design));
        let changes: Vec<_> = changes.into_iter().map(|(_, change)| change).collect();
        // The least of many: other work on the machine only adds.
        let once = |_| {
            let begun = Instant::now();
            drop(gradient(&model, &question, &answer, &changes).unwrap());
            begun.elapsed().as_secs_f64()
        };
        let each = (0..50).map(once).fold(f64::INFINITY, f64::min);
        let elements = model.elements.len();
        println!("{name}, {elements} elements: limit {solve:.2e} s, {} derivatives {each:.2e} s", changes.len());
    }
}

/// Limits at these multiples of h along `change`, if all are found and `kept` is true of their answers.
fn limits<const N: usize>(
    (design, question, change): (&Design, &Question, &DesignVector),
    h: f64,
    steps: [f64; N],
    kept: impl Fn(&[Answer]) -> bool,
) -> Option<[f64; N]> {
    let answers = steps.map(|step| solved(&change.applied(design, step * h), question).1);
    if !kept(&answers) {
        return None;
    }
    let values: Option<Vec<f64>> = answers.iter().map(limit).collect();
    values?.try_into().ok()
}

/// The other goals, by central differences along the wire, the spacing and one ring's size.
#[test]
fn derivatives_of_other_goals() {
    let strain = |component, free: &[Strain], sense| {
        Question::new(Goal::Strain { component, direction_deg: 20.0, fix: vec![], free: free.to_vec() }, sense)
    };
    let free = Across { lateral_free: true, shear_free: true };
    let questions = [
        Question::stretch_along(20.0).with_free(free),
        strain(Strain::Exx, &[], Sense::Largest),
        strain(Strain::Exy, &[Strain::Exx], Sense::Largest),
        strain(Strain::Exx, &[], Sense::Least),
        Question::thickest_wire(),
        Question::new(Goal::Wire { lattice_free: false }, Sense::Largest),
        Question::largest_clearance(),
        Question::new(Goal::Ray { direction: [0.6, 0.0, 0.8] }, Sense::Largest),
    ];
    let mut compared = 0;
    for (name, question) in ["1.1"].iter().flat_map(|n| questions.iter().map(move |q| (*n, q))) {
        let design = builtin(name);
        let question = Question { starts: Some(2), ..question.clone() };
        let (sheet, answer) = solved(&design, &question);
        if !answer.is_limit() {
            continue;
        }
        let model = sheet.model_of(&answer).into_owned();
        let found = Sensitivity::of(&model, &question, &answer).unwrap();
        // A clearance is a length, in reference radii.
        let unit = if matches!(question.goal, Goal::Clearance { .. }) { model.unit } else { 1.0 };
        let mut ring = DesignVector::zeros(rings(&design));
        ring.rings[0].major_radius = 1.0;
        for change in [DesignVector::common_minor_radius(&design), DesignVector::spacing(&design), ring] {
            let h = 1e-4 * design.reference_radius;
            let kept = |answers: &[Answer]| answers.iter().all(|a| loaded(a) == loaded(&answer));
            let values = limits((&design, &question, &change), h, [-2.0, -1.0, 1.0, 2.0], kept);
            let Some([f0, f1, f2, f3]) = values.filter(|_| !found.one_sided(&change).is_kink()) else { continue };
            let expected = unit * (f0 - 8.0 * f1 + 8.0 * f2 - f3) / (12.0 * h);
            let derivative = found.along(&change);
            println!("{name} {:?}: {derivative} {expected}", question.goal);
            let close = (derivative - expected).abs() < 1e-5 * expected.abs().max(0.1);
            assert!(close, "{name} {question:?}: {derivative} {expected}");
            compared += 1;
        }
    }
    assert!(compared >= 15, "{compared}");
}

/// All lengths doubled leave l1 as it is; the wire alone costs the sum of the forces, twice; a family of designs gives the same as
/// its tangent.
#[test]
fn derivatives_add_up() {
    for name in ["1.1", "2-oblong", "3.1", "kings-mail", "japanese-4-in-1"] {
        let design = builtin(name);
        let question = stretch(33.0, 0.0);
        let (sheet, answer) = solved(&design, &question);
        let model = sheet.model_of(&answer);
        let found = Sensitivity::of(&model, &question, &answer).unwrap();
        let (scale, wire) = (DesignVector::scale(&design), DesignVector::common_minor_radius(&design));
        assert!(found.along(&scale).abs() < 1e-8, "{name}: {}", found.along(&scale));
        let forces: f64 = answer.contacts.iter().map(|contact| contact.force).sum();
        let by_force = -2.0 * forces / design.reference_radius;
        assert!((found.along(&wire) - by_force).abs() < 1e-12 * by_force.abs(), "{name}");
        let h = 1e-5;
        let spaced = DesignVector::between(&design.spaced(1.0 - h), &design.spaced(1.0 + h), 2.0 * h).unwrap();
        let changes = [spaced, DesignVector::spacing(&design)];
        let [a, b] = gradient(&model, &question, &answer, &changes).unwrap()[..] else { panic!("two changes") };
        assert!((a - b).abs() < 1e-9 * b.abs() && b < 0.0, "{name}: {a} {b}");
        let parts: f64 = found.by_pair(&wire).iter().map(|(_, part)| part).sum();
        assert!((parts - by_force).abs() < 1e-9 * by_force.abs(), "{name}");
    }
}

/// A design turned or mirrored has the derivatives turned or mirrored with it.
#[test]
fn derivatives_turn_with_the_design() {
    let design = builtin("2-oblong");
    let of = |design: &Design, direction: f64| {
        let question = stretch(direction, 0.0);
        let (sheet, answer) = solved(design, &question);
        Sensitivity::of(&sheet.model_of(&answer), &question, &answer).unwrap().gradient()
    };
    let here = of(&design, 20.0);
    let turn = UnitQuaternion::from_axis_angle(&Vec3::z_axis(), 0.5);
    for mirrored in [false, true] {
        let map = |v: Vec3| if mirrored { Vec3::new(v.x, -v.y, v.z) } else { turn * v };
        let mut image = design.clone();
        for element in &mut image.elements {
            element.center = map(element.center.into()).into();
            for ring in &mut element.rings {
                ring.normal = map(ring.normal.into()).into();
                ring.offset = map(ring.offset.into()).into();
            }
        }
        image.lattice.a1 = map(image.lattice.a1.into()).into();
        image.lattice.a2 = map(image.lattice.a2.into()).into();
        let there = of(&image, if mirrored { -20.0 } else { 20.0 + 0.5_f64.to_degrees() });
        for (a, b) in here.lattice.iter().zip(&there.lattice) {
            assert!((map(a.push(0.0)).xy() - b).norm() < 1e-7, "{a} {b}");
        }
        for (a, b) in here.rings.iter().zip(&there.rings) {
            assert!((a.major_radius - b.major_radius).abs() < 1e-7 && (a.minor_radius - b.minor_radius).abs() < 1e-7);
            assert!((map(a.offset) - b.offset).norm() < 1e-7);
        }
    }
}

#[test]
fn what_has_no_derivatives_is_refused() {
    let design = builtin("1.1");
    let question = stretch(33.0, 0.0);
    let (sheet, answer) = solved(&design, &question);
    let model = sheet.model_of(&answer);
    let refused = |question: &Question, answer: &Answer| match Sensitivity::of(&model, question, answer) {
        Err(problem) => problem.problem,
        Ok(_) => panic!("taken"),
    };
    let uncertified = Answer { status: maille::Status::Uncertified, ..answer.clone() };
    assert!(refused(&question, &uncertified).contains("no certified forces"));
    assert!(refused(&stretch(80.0, 0.0), &answer).contains("do not balance"));
    let mut weak = answer.clone();
    weak.contacts[0].force *= 0.99;
    assert!(refused(&question, &weak).contains("do not balance"));
    let other = builtin("3.1");
    assert_eq!(DesignVector::between(&design, &other, 1.0).unwrap_err().field, "elements");
    assert_eq!(DesignVector::between(&design, &design, 0.0).unwrap_err().field, "step");
    let mut turned = design.clone();
    turned.elements[0].rings[0].normal = [0.0, 0.0, -1.0];
    assert_eq!(DesignVector::between(&design, &turned, 1.0).unwrap_err().field, "normal");
}
