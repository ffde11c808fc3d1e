//! Rolls in a folder: rows are the answers to their questions, a run goes on from the journal, and edited files are refused.

use maille::{
    Across, CellChoice, Effort, Question, Sheet,
    lattice::Cell,
    survey::roll::{RollLimit, RollQuestion},
};
use maille_io::{
    builtin, read_design,
    roll::{ROLL_STATES, ROLL_TABLE, ROLLS, RollFolder, open_rolls, roll_states, rolls_csv},
};
use std::{
    fs,
    sync::{Mutex, atomic::AtomicBool},
};

#[test]
fn rolls_are_kept_and_read_again() {
    let design = read_design("e", builtin("european-4-in-1").unwrap()).unwrap();
    let question = RollQuestion {
        directions_deg: vec![90.0],
        free: vec![Across::HELD],
        cells: CellChoice::These(vec![Cell::PRIMITIVE]),
        effort: Effort::Low,
        starts: Some(2),
        seed: 1,
    };
    let sheet = Sheet::in_cells(&design, question.cells.clone()).unwrap();
    let cancel = AtomicBool::new(false);
    let folder = tempfile::tempdir().unwrap();
    let (opened, known) = RollFolder::open(folder.path(), &design, &question, false).unwrap();
    assert!(known.is_empty());
    let opened = Mutex::new(opened);
    let keep = |limit: &RollLimit| opened.lock().unwrap().keep(limit).unwrap();
    let limits = sheet.rolls(&question, &known, &cancel, &keep).unwrap();
    assert_eq!(limits.len(), 2);
    for (limit, sign) in limits.iter().zip([1.0, -1.0]) {
        let question = Question { starts: Some(2), ..Question::curvature_along(90.0, sign) };
        let answer = sheet.answer(&question).unwrap().limit().unwrap();
        assert!((limit.curvature.unwrap() * design.reference_radius - answer).abs() < 1e-9);
        assert!((limit.bend_radius.unwrap() - 1.0 / answer.abs()).abs() < 1e-9 && limit.min_gap.unwrap() > -1e-11);
    }
    drop(opened);
    // What is there is not asked again.
    let (opened, known) = RollFolder::open(folder.path(), &design, &question, false).unwrap();
    // In the order in which they were found.
    assert!(known.len() == 2 && limits.iter().all(|limit| known.contains(limit)));
    let again = sheet.rolls(&question, &known, &cancel, &|_| panic!("solved again")).unwrap();
    assert_eq!(again, limits);
    let (table, states) = (rolls_csv(&limits), roll_states(&limits));
    let record = opened.record(&design, &question, true, [&table, &states]);
    let text = serde_json::to_string(&record).unwrap();
    for (name, text) in [(ROLL_TABLE, &table), (ROLL_STATES, &states), (ROLLS, &text)] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    assert_eq!(open_rolls(folder.path()).unwrap().1, limits);
    fs::write(folder.path().join(ROLL_TABLE), table.replace("largest", "least")).unwrap();
    assert!(open_rolls(folder.path()).unwrap_err().to_string().contains("edited"));
    drop(opened);
    let other = RollQuestion { seed: 2, ..question };
    assert!(RollFolder::open(folder.path(), &design, &other, false).is_err());
}
