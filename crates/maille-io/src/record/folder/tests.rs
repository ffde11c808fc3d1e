//! A record's folder, killed at every write.

use super::super::run::input_hash;
use super::*;
use serde_json::json;

fn design() -> Design {
    crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap()
}

fn row(direction_deg: f64, status: Status) -> LimitRow {
    LimitRow {
        design: "1.1".into(),
        minor_radius: Some(0.1),
        direction_deg,
        l2: 0.0,
        method: "energy".into(),
        cell: "1x1".into(),
        status,
        l1: Some(0.44),
        lambda1: None,
        lambda2: None,
        stretch1: None,
        stretch2: None,
        max_overlap: None,
        min_gap: None,
        iterations: 7,
        runs: 2,
        wall_s: 0.5,
        ..LimitRow::default()
    }
}

fn state(direction_deg: f64, status: Status) -> StateRecord {
    StateRecord {
        direction_deg,
        l2: 0.0,
        status,
        a1: [2.5, 0.0, 0.0],
        a2: [0.0, 2.5, 0.0],
        deformation_gradient: [[1.0, 0.0], [0.0, 1.0]],
        poses: Vec::new(),
        residual: None,
        note: None,
        ..StateRecord::default()
    }
}

fn rows(n: usize) -> (Vec<LimitRow>, Vec<StateRecord>) {
    let at = |i: usize| (row(i as f64, Status::ThresholdReached), state(i as f64, Status::ThresholdReached));
    (0..n).map(at).unzip()
}

/// Runs the steps up to each point at which a kill can happen, and hands the folder to `check`.
fn killed_anywhere(
    before: impl Fn(&Path) -> RecordFolder,
    steps: impl Fn(&mut RecordFolder) -> Vec<Step>,
    check: impl Fn(&Path, usize),
) {
    let count = {
        let dir = tempfile::tempdir().unwrap();
        steps(&mut before(dir.path())).len()
    };
    for done in 0..=count {
        let dir = tempfile::tempdir().unwrap();
        let mut folder = before(dir.path());
        for step in steps(&mut folder).into_iter().take(done) {
            folder.apply(step).unwrap();
        }
        drop(folder);
        fs::write(dir.path().join(".maille-x1.tmp"), "half a fi").unwrap();
        check(dir.path(), done);
    }
}

/// Limits of the journal come back, once each, but for a line that is cut off; then it is gone.
#[test]
fn a_kill_between_writes_loses_the_limit_in_work_alone() {
    let dir = tempfile::tempdir().unwrap();
    let open = || RecordFolder::open(dir.path(), &design(), &json!({}), "1", false).unwrap();
    let (all, all_states) = rows(4);
    let (mut folder, _, _) = open();
    folder.append(&all[0], &all_states[0]).unwrap();
    folder.write(&all[..1], &all_states[..1]).unwrap();
    assert!(!dir.path().join(JOURNAL).exists());
    // Row 0 again, as if a kill had come between the files and the end of the journal.
    (0..4).for_each(|k| folder.append(&all[k], &all_states[k]).unwrap());
    drop(folder);
    let journal = fs::read_to_string(dir.path().join(JOURNAL)).unwrap();
    fs::write(dir.path().join(JOURNAL), &journal[..journal.len() - 5]).unwrap();
    for _ in 0..2 {
        let (folder, found, states) = open();
        assert_eq!((&found[..], &states[..]), (&all[..3], &all_states[..3]));
        assert_eq!(folder.run().counters, Counters::of(&all[..3]));
        assert!(!dir.path().join(JOURNAL).exists());
    }
}

#[test]
fn kill_while_adding_rows_leaves_old_or_new_rows() {
    let (old, old_states) = rows(2);
    let (new, new_states) = rows(5);
    let inputs = json!({ "tau": 0.01 });
    let before = |path: &Path| {
        let (mut folder, ..) = RecordFolder::open(path, &design(), &inputs, "0.1.0", false).unwrap();
        folder.write(&old, &old_states).unwrap();
        folder
    };
    let steps = |folder: &mut RecordFolder| folder.steps_to_write(&new, &new_states).unwrap().0;
    killed_anywhere(before, steps, |path, done| {
        let (_, rows, states) = RecordFolder::open(path, &design(), &inputs, "0.1.0", false).unwrap();
        let expected = if done < 3 { 2 } else { 5 };
        assert_eq!((rows.len(), states.len()), (expected, expected));
        assert_eq!((&rows[..], &states[..]), (&new[..expected], &new_states[..expected]));
    });
}

#[test]
fn kill_while_replacing_an_interrupted_row_computes_it_again() {
    let (mut old, mut old_states) = rows(2);
    old[1].status = Status::Interrupted;
    old_states[1].status = Status::Interrupted;
    let (new, new_states) = rows(2);
    let inputs = json!({});
    let before = |path: &Path| {
        let (mut folder, ..) = RecordFolder::open(path, &design(), &inputs, "0.1.0", false).unwrap();
        folder.write(&old, &old_states).unwrap();
        folder
    };
    let steps = |folder: &mut RecordFolder| folder.steps_to_write(&new, &new_states).unwrap().0;
    killed_anywhere(before, steps, |path, done| {
        let (_, rows, _) = RecordFolder::open(path, &design(), &inputs, "0.1.0", false).unwrap();
        assert_eq!(rows.len(), if done < 3 { 1 } else { 2 });
    });
}

#[test]
fn kill_while_overwriting_never_mixes_two_computations() {
    let (old, old_states) = rows(3);
    let (old_inputs, new_inputs) = (json!({ "tau": 0.01 }), json!({ "tau": 0.02 }));
    let before = |path: &Path| {
        let (mut folder, ..) = RecordFolder::open(path, &design(), &old_inputs, "0.1.0", false).unwrap();
        folder.write(&old, &old_states).unwrap();
        folder.write_polar("<svg/>", b"png").unwrap();
        folder.write_sensitivities(&[]).unwrap();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        folder
    };
    let steps = |folder: &mut RecordFolder| {
        folder.run.parameters = new_inputs.clone();
        folder.run.input_hash = input_hash(&design(), &new_inputs);
        folder.steps_to_replace()
    };
    killed_anywhere(before, steps, |path, done| {
        let record = Record::read(path).unwrap();
        let old_run = record.run.parameters == old_inputs;
        assert_eq!(old_run, done < 7);
        assert_eq!(record.finished().0.len(), if done == 0 { 3 } else { 0 });
        let (.., rows, _) = RecordFolder::open(path, &design(), &new_inputs, "0.1.0", true).unwrap();
        assert!(rows.is_empty());
        assert_eq!(fs::read_to_string(path.join("notes.txt")).unwrap(), "mine");
        assert!(!path.join(SVG).exists() && !path.join(SENSITIVITIES).exists());
    });
}

#[test]
fn one_run_at_a_time_has_the_folder() {
    let dir = tempfile::tempdir().unwrap();
    let open = |overwrite| RecordFolder::open(dir.path(), &design(), &json!({}), "0.1.0", overwrite);
    let (mut first, ..) = open(false).unwrap();
    // The other one must not take this for what a killed run has left.
    fs::write(dir.path().join(".maille-x1.tmp"), "in work").unwrap();
    for overwrite in [false, true] {
        assert!(matches!(open(overwrite), Err(RecordError::InUse { folder }) if folder == dir.path()));
    }
    assert!(dir.path().join(".maille-x1.tmp").exists());
    let (all, states) = rows(2);
    first.write(&all, &states).unwrap();
    assert_eq!(Record::read(dir.path()).unwrap().rows, all);
    drop(first);
    assert_eq!(open(false).unwrap().1, all);
    assert!(open(true).unwrap().1.is_empty());
}

#[test]
fn kill_while_creating_leaves_a_folder_that_opens() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join(".maille-x1.tmp"), "{").unwrap();
    let (folder, rows, _) = RecordFolder::open(dir.path(), &design(), &json!({}), "0.1.0", false).unwrap();
    assert!(rows.is_empty());
    assert_eq!(names(folder.path()).unwrap(), [RUN]);
}
