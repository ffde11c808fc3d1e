//! What a question refuses, what it stores, and that it is answered as a map answers it.

use maille::{
    Across, CellChoice, Goal, Question, Sense, Sheet, Status, Strain,
    lattice::Cell,
    search::ExactOptions,
    survey::{Method, characterize},
};
use std::sync::{Mutex, atomic::AtomicBool};

fn sheet(name: &str) -> Sheet {
    let design = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap();
    Sheet::in_cells(&design, CellChoice::One(Cell::PRIMITIVE)).unwrap()
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
    assert_eq!([Question::stretch_along(0.0).starts(), Question::thickest_wire().starts()], [4, 8]);
}

/// By a map, by a question, and by the question on a strain that asks the same: one limit.
#[test]
fn a_stretch_is_answered_as_in_a_map() {
    let sheet = sheet("3.1");
    let found = Mutex::new(Vec::new());
    let method = Method::Exact(ExactOptions::default());
    let models = std::slice::from_ref(sheet.model());
    let cancel = AtomicBool::new(false);
    characterize(models, None, &method, &[20.0, 80.0], &[-0.125], &|_| true, &cancel, &|f| {
        found.lock().unwrap().push(f.row)
    });
    for row in found.into_inner().unwrap() {
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
