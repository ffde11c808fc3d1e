//! What a question refuses, what it stores, and that it is answered as a map answers it.

use crate::common::{builtin, map};
use maille::{
    Across, CellChoice, Effort, Goal, Question, Sense, Sheet, Status, Strain,
    lattice::Cell,
    relaxation::limit::EnergyOptions,
    search::ExactOptions,
    survey::{Finished, MapQuestion, Method},
};
use std::sync::atomic::AtomicBool;

fn sheet(name: &str) -> Sheet {
    let design = builtin(name);
    Sheet::in_cells(&design, Cell::PRIMITIVE.into()).unwrap()
}

#[test]
fn what_cannot_be_asked_is_refused_with_its_field() {
    let stretch = Question::stretch_along(30.0);
    let strain = |fix: Vec<(Strain, f64)>, free: Vec<Strain>| {
        Question::new(Goal::Strain { component: Strain::Exx, direction_deg: 0.0, fix, free }, Sense::Largest)
    };
    for (question, field) in [
        (Question { starts: Some(0), ..stretch.clone() }, "starts"),
        (Question::stretch_along(f64::NAN), "direction_deg"),
        (Question::stretch_along(1e19), "direction_deg"),
        (stretch.clone().with_lateral(-1.0), "l2"),
        (stretch.clone().with_lateral(f64::INFINITY), "l2"),
        (strain(vec![(Strain::Exx, 0.1)], vec![]), "fix"),
        (strain(vec![(Strain::Eyy, -0.6)], vec![]), "fix"),
        (strain(vec![(Strain::Eyy, f64::NAN)], vec![]), "fix"),
        (Question::new(Goal::Ray { direction: [0.0; 3] }, Sense::Largest), "direction"),
        (Question::new(Goal::Ray { direction: [1.0, 1.0, 0.0] }, Sense::Largest), "direction"),
        (Question::thickest_wire().least(), "sense"),
    ] {
        let problem = question.check().expect_err(&format!("{question:?}"));
        assert_eq!(problem.field, field, "{problem}");
        assert!(!problem.help.is_empty());
    }
    assert_eq!(stretch.check(), Ok(()));
    // The stretch that asks the same is asked only where it can be, too.
    let far = Goal::Strain { component: Strain::Eyy, direction_deg: 1e6, fix: vec![], free: vec![] };
    assert_eq!(Question::new(far, Sense::Largest).as_stretch().unwrap().check(), Ok(()));
    assert_eq!(strain(vec![(Strain::Eyy, 1e13)], vec![]).as_stretch(), None);
}

/// A map is refused where one of its limits is, and for what its method cannot do.
#[test]
fn what_a_map_cannot_ask_is_refused_with_its_field() {
    let map = |method: &Method, directions: &[f64], l2: Option<&[f64]>| {
        MapQuestion::new(method.clone(), CellChoice::Auto, Some(directions.to_vec()), l2.map(<[f64]>::to_vec), None)
    };
    let exact = Method::Exact(ExactOptions::default());
    let free = Across { lateral_free: true, shear_free: false };
    let width_free = Method::Exact(ExactOptions { across: free, ..ExactOptions::default() });
    let without_starts = Method::Exact(ExactOptions { starts: Some(0), ..ExactOptions::default() });
    let energy = |change: fn(&mut EnergyOptions)| {
        let mut options = EnergyOptions::default();
        change(&mut options);
        Method::Energy(options)
    };
    for (asked, field) in [
        (map(&exact, &[], None), "directions_deg"),
        (map(&exact, &[0.0], Some(&[])), "l2"),
        (map(&exact, &[0.0, f64::NAN], None), "direction_deg"),
        (map(&exact, &[0.0, -1e7], None), "direction_deg"),
        (MapQuestion::new(exact.clone(), CellChoice::These(Vec::new()), None, None, None), "cells"),
        (map(&exact, &[0.0], Some(&[0.0, -1.0])), "l2"),
        (map(&width_free, &[0.0], Some(&[0.0])), "l2"),
        (map(&without_starts, &[0.0], None), "starts"),
        (map(&energy(|o| o.tau = 0.0), &[0.0], None), "tau"),
        (map(&energy(|o| o.sample_spacing_rad = Some(f64::NAN)), &[0.0], None), "sample_spacing_rad"),
        (map(&energy(|o| o.flat_points = 15), &[0.0], None), "flat_points"),
    ] {
        assert_eq!(asked.expect_err(field).field, field);
    }
    let refused =
        |across, compression| Method::energy(EnergyOptions::default(), across, compression).unwrap_err().field;
    assert_eq!([refused(Across::HELD, true), refused(free, false)], ["method", "method"]);
    assert_eq!(map(&width_free, &[0.0], None).unwrap().l2, [0.0]);
    assert_eq!(map(&energy(|o| o.flat_points = 0), &[0.0], None).unwrap().l2.len(), 5);
}

/// As run.json has it: cells by name, or as a list of those that were compiled.
#[test]
fn a_map_is_what_was_written() {
    let usual = MapQuestion::new(Method::Exact(ExactOptions::default()), CellChoice::Auto, None, None, None).unwrap();
    assert_eq!((usual.directions_deg.len(), usual.directions_deg[36]), (37, 180.0));
    for (cells, text) in [("auto".parse().unwrap(), "\"auto\""), ("1,0;-1,2".parse().unwrap(), "[\"1,0;-1,2\"]")] {
        let question = MapQuestion { cells, ..usual.clone() };
        let written = serde_json::to_string(&question).unwrap();
        assert!(written.contains(&format!("\"cells\":{text}")), "{written}");
        assert_eq!(serde_json::from_str::<MapQuestion>(&written).unwrap(), question);
    }
    assert!("2y1".parse::<CellChoice>().is_err());
}

#[test]
fn a_question_is_what_was_written() {
    let free = Across { lateral_free: true, shear_free: false };
    let question = Question::stretch_along(30.0).with_free(free).least();
    let text = serde_json::to_string(&question).unwrap();
    assert_eq!(serde_json::from_str::<Question>(&text).unwrap(), question);
    assert!(serde_json::from_str::<Question>(&text.replace("seed", "sead")).is_err());
    // The last word counts: a width that is held is not free.
    let held = question.with_lateral(0.1);
    let Goal::Stretch { l2, across, .. } = held.goal else { panic!("a stretch") };
    assert_eq!((l2, across), (0.1, Across::HELD));
    assert_eq!(
        [Question::stretch_along(0.0), Question::thickest_wire()].map(|q| (q.effort, q.starts)),
        [(Effort::Normal, None); 2]
    );
}

/// By a map, by a question, and by the question on a strain that asks the same: one limit.
#[test]
fn a_stretch_is_answered_as_in_a_map() {
    let sheet = sheet("3.1");
    let models = std::slice::from_ref(sheet.model());
    for Finished { row, .. } in map(models, &[20.0, 80.0], &[-0.125], &ExactOptions::default()) {
        let answer = sheet.answer(&Question::stretch_along(row.direction_deg).with_lateral(-0.125)).unwrap();
        assert_eq!((answer.status, answer.limit()), (row.status, row.l1));
        assert_eq!((answer.bound, answer.n_starts, answer.n_distinct), (row.bound_l1, row.n_starts, row.n_distinct));
        let fix = vec![(Strain::Eyy, 0.5 * (0.875_f64.powi(2) - 1.0))];
        let goal = Goal::Strain { component: Strain::Exx, direction_deg: row.direction_deg, fix, free: vec![] };
        let strain = sheet.answer(&Question::new(goal, Sense::Largest)).unwrap();
        let l1 = row.l1.unwrap();
        assert_eq!(strain.status, row.status);
        assert!((strain.value.unwrap() - (l1 + 0.5 * l1 * l1)).abs() < 1e-9, "{:?} for {l1}", strain.value);
    }
}

/// A ray along E_xx = E_yy = E_xy of 1.1 is the stretch at 45° with its width held: E_11 = l1 + l1²/2, of length √3/2 of it.
#[test]
fn a_ray_ends_where_its_stretch_does() {
    let third = 1.0 / 3.0_f64.sqrt();
    let answer = sheet("1.1").answer(&Question::new(Goal::Ray { direction: [third; 3] }, Sense::Largest)).unwrap();
    let l1 = 0.774034949;
    let expected = (l1 + 0.5 * l1 * l1) / 2.0 / third;
    assert_eq!(answer.status, Status::Global);
    assert!((answer.value.unwrap() - expected).abs() < 1e-8, "{:?} for {expected}", answer.value);
}

/// Once it is cancelled, nothing is claimed.
#[test]
fn a_cancelled_question_is_interrupted() {
    let (sheet, cancel) = (sheet("1.1"), AtomicBool::new(true));
    let free = Across { lateral_free: true, shear_free: true };
    let strain =
        Goal::Strain { component: Strain::Eyy, direction_deg: 0.0, fix: vec![], free: vec![Strain::Exx, Strain::Exy] };
    for question in [
        Question::stretch_along(30.0),
        Question::stretch_along(30.0).with_free(free),
        Question::stretch_along(30.0).least(),
        Question::new(strain, Sense::Largest),
        Question::new(Goal::Ray { direction: [0.0, 0.0, 1.0] }, Sense::Largest),
        Question::largest_clearance(),
    ] {
        let answer = sheet.answer_until(&question, &cancel).unwrap();
        assert_eq!((answer.status, answer.value), (Status::Interrupted, None), "{question:?}");
    }
}
