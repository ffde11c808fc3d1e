//! Records: tables, states, and the folder's manners.

use maille::design::Design;
use maille::record::{ForceRow, LIMIT_COLUMNS, LimitRow, PoseRecord, StateRecord, Status};
use maille::{
    lattice::Cell,
    model::Model,
    search::ExactOptions,
    survey::{MapQuestion, Method, Task, Work},
};
use maille_io::record::{
    Counters, ForceTable, Record, RecordError, RecordFolder, input_hash, read_forces, read_limits, read_run,
    read_states, write_forces, write_limits, write_states,
};
use maille_io::{
    Quantity,
    run::{Map, OpenMap, ReplayError, Replayed, replay, run_all},
};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::sync::{
    Mutex,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

fn design() -> Design {
    maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap()
}

fn row(direction_deg: f64, status: Status) -> LimitRow {
    let l1 = matches!(status, Status::ThresholdReached | Status::Global).then_some(0.1 + 0.2);
    LimitRow {
        design: "1.10".into(),
        minor_radius: Some(0.1),
        direction_deg,
        l2: -0.125,
        method: "energy".into(),
        cell: "1,0;-1,2".into(),
        status,
        l1,
        lambda1: l1.map(|x| x * std::f64::consts::PI),
        lambda2: Some(1e-300),
        stretch1: Some(f64::MIN_POSITIVE),
        stretch2: Some(1e21),
        max_overlap: Some(0.0),
        min_gap: Some(-1.0 / 3.0),
        iterations: 123,
        runs: 4,
        wall_s: 0.25,
        ..LimitRow::default()
    }
}

fn state(direction_deg: f64, status: Status) -> StateRecord {
    let pose =
        PoseRecord { element: "flat".into(), position: [0.1, 1.0 / 3.0, -0.0], rotation: [1.0, 0.0, 0.0, 1e-17] };
    StateRecord {
        direction_deg,
        l2: -0.125,
        status,
        a1: [3.6, 0.0, 0.0],
        a2: [0.0, 2.1875, 0.0],
        deformation_gradient: [[1.44, 0.0], [0.0, 0.875]],
        poses: vec![pose],
        residual: Some(1e-4),
        note: None,
        ..StateRecord::default()
    }
}

fn two() -> (Vec<LimitRow>, Vec<StateRecord>) {
    [(0.0, Status::ThresholdReached), (15.0, Status::L2NotReached)]
        .map(|(d, s)| (row(d, s), state(d, s)))
        .into_iter()
        .unzip()
}

fn open(
    path: &Path,
    inputs: &Value,
    overwrite: bool,
) -> Result<(RecordFolder, Vec<LimitRow>, Vec<StateRecord>), RecordError> {
    RecordFolder::open(path, &design(), inputs, "0.1.0", overwrite)
}

fn message(result: Result<impl Sized, RecordError>) -> String {
    result.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn the_columns_are_the_fields_of_a_row_in_order() {
    let json = serde_json::to_string(&row(0.0, Status::Global)).unwrap();
    let places: Vec<_> = LIMIT_COLUMNS.iter().map(|c| json.find(&format!("\"{}\":", c.name)).expect(c.name)).collect();
    assert!(places.is_sorted());
    let Value::Object(fields) = serde_json::from_str(&json).unwrap() else { panic!() };
    assert_eq!(fields.len(), LIMIT_COLUMNS.len());
}

#[test]
fn tables_read_back_bit_for_bit() {
    let rows: Vec<_> = Status::ALL.iter().enumerate().map(|(i, &status)| row(15.0 * i as f64, status)).collect();
    let text = write_limits(&rows).unwrap();
    assert_eq!(read_limits("limits.csv", &text).unwrap(), rows);
    let first = text.lines().nth(1).unwrap();
    assert!(first.starts_with("\"1.10\",0.1,0.0,-0.125,energy,\"1,0;-1,2\",global,0.30000000000000004,"), "{first}");
    let unearned = text.lines().nth(5).unwrap();
    assert!(unearned.contains("l2-unreachable,,,1e-300"), "{unearned}");
    assert_eq!(read_limits("limits.csv", &write_limits(&[]).unwrap()).unwrap(), []);
}

#[test]
fn states_read_back_bit_for_bit() {
    let states = two().1;
    assert_eq!(read_states("states.jsonl", &write_states(&states).unwrap()).unwrap(), states);
}

#[test]
fn columns_of_a_later_version_are_ignored() {
    let rows = two().0;
    let text = write_limits(&rows).unwrap();
    let wider: String = text
        .lines()
        .enumerate()
        .map(|(i, line)| format!("{line},{}\n", if i == 0 { "bound" } else { "0.5" }))
        .collect();
    assert_eq!(read_limits("limits.csv", &wider).unwrap(), rows);
}

#[test]
fn a_damaged_table_is_named_by_line_column_and_value() {
    let text = write_limits(&two().0).unwrap();
    let broken = |from: &str, to: &str| message(read_limits("out/limits.csv", &text.replacen(from, to, 1)));
    assert_eq!(broken("0.30000000000000004", "0.3o"), "out/limits.csv:2: column l1: \"0.3o\" is not a number");
    assert_eq!(broken(",15.0,", ",NaN,"), "out/limits.csv:3: column direction_deg: \"NaN\" is not finite");
    assert_eq!(broken("l2-not-reached", "lost"), "out/limits.csv:3: column status: \"lost\" is not a status");
    assert_eq!(broken(",123,", ",1.5,"), "out/limits.csv:2: column iterations: \"1.5\" is not a whole number");
    assert_eq!(
        broken("lambda1,lambda2", "lambda2,lambda1"),
        "out/limits.csv:1: column 9 is \"lambda2\", expected \"lambda1\""
    );
    assert_eq!(broken(",0.25,", ","), "out/limits.csv:2: 48 columns, expected 49");
    assert_eq!(
        message(read_limits("limits.csv", &text[..text.len() - 3])),
        "limits.csv:3: the file ends within this line"
    );
    assert_eq!(message(read_limits("limits.csv", "")), "limits.csv:1: the header is missing");
}

#[test]
fn a_damaged_line_of_states_is_named() {
    let text = write_states(&two().1).unwrap();
    let broken = text.replacen("\"l2\":-0.125,\"status\":\"l2-not-reached\"", "\"l2\":-0.125,\"status\":\"lost\"", 1);
    let found = message(read_states("states.jsonl", &broken));
    assert!(found.starts_with("states.jsonl:2: unknown variant `lost`"), "{found}");
    let found = message(read_states("states.jsonl", &text[..text.len() - 10]));
    assert_eq!(found, "states.jsonl:2: the file ends within this line");
}

#[test]
fn numbers_that_json_cannot_hold_are_refused() {
    let mut bad = row(30.0, Status::ThresholdReached);
    bad.lambda1 = Some(f64::NAN);
    assert_eq!(message(write_limits(&[bad])), "direction 30°, l2 -0.125: lambda1 is NaN");
    let mut bad = state(30.0, Status::NotConverged);
    bad.poses[0].position[1] = f64::INFINITY;
    assert_eq!(message(write_states(&[bad])), "direction 30°, l2 -0.125: position is inf");
}

#[test]
fn the_hash_sees_every_input_and_no_order() {
    let a = json!({ "tau": 0.01, "step": 0.02, "list": [1.0, 2.0] });
    let b = json!({ "list": [1.0, 2.0], "step": 0.02, "tau": 0.01 });
    assert_eq!(input_hash(&design(), &a), input_hash(&design(), &b));
    assert_eq!(input_hash(&design(), &a).len(), 64);
    assert_ne!(input_hash(&design(), &a), input_hash(&design(), &json!({ "tau": 0.01 })));
    assert_ne!(input_hash(&design(), &a), input_hash(&design().with_minor_radius(0.05), &a));
}

#[test]
fn a_run_is_continued_with_the_same_inputs_only() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("new/folder");
    let inputs = json!({ "tau": 0.01, "directions": [0.0, 15.0] });
    let (mut rows, mut states) = two();
    let (mut folder, found, _) = open(&out, &inputs, false).unwrap();
    assert!(found.is_empty());
    folder.write(&rows, &states).unwrap();
    folder.write_polar("<svg/>", b"png").unwrap();
    drop(folder);

    let (_, found, found_states) = open(&out, &inputs, false).unwrap();
    assert_eq!((&found, &found_states), (&rows, &states));
    let record = Record::read(&out).unwrap();
    assert_eq!(record.run.counters, Counters::of(&rows));
    assert_eq!(record.run.counters.iterations, 246);
    assert_eq!(record.run, read_run("run.json", &fs::read_to_string(out.join("run.json")).unwrap()).unwrap());

    // Interrupted rows, and rows that lost their state, are computed again.
    let (mut folder, ..) = open(&out, &inputs, false).unwrap();
    rows.push(row(30.0, Status::Interrupted));
    states.push(state(30.0, Status::Interrupted));
    rows.push(row(45.0, Status::ThresholdReached));
    folder.write(&rows, &states).unwrap();
    drop(folder);
    let (_, found, _) = open(&out, &inputs, false).unwrap();
    assert_eq!(found, rows[..2]);

    let other = json!({ "tau": 0.02, "directions": [0.0, 15.0] });
    let found = message(open(&out, &other, false));
    assert!(found.ends_with("holds a record of other inputs: parameters.tau is 0.01 there, 0.02 here"), "{found}");
    let found = message(RecordFolder::open(&out, &design(), &inputs, "0.2.0", false));
    assert!(found.ends_with("computed by version 0.1.0, this is 0.2.0"), "{found}");
    assert_eq!(Record::read(&out).unwrap().rows.len(), 4);

    fs::write(out.join("notes.txt"), "mine").unwrap();
    let (_, found, _) = open(&out, &other, true).unwrap();
    assert!(found.is_empty());
    let mut names: Vec<_> =
        fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, [".maille.lock", "notes.txt", "run.json"]);
}

#[test]
fn the_same_inputs_start_afresh_when_asked_to() {
    let dir = tempfile::tempdir().unwrap();
    let (rows, states) = two();
    open(dir.path(), &json!({}), false).unwrap().0.write(&rows, &states).unwrap();
    assert!(open(dir.path(), &json!({}), true).unwrap().1.is_empty());
    assert!(Record::read(dir.path()).unwrap().rows.is_empty());
}

#[test]
fn files_of_others_are_never_replaced() {
    for overwrite in [false, true] {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("run.json"), "{ \"mine\": true }").unwrap();
        fs::write(dir.path().join("limits.csv"), "mine").unwrap();
        assert!(open(dir.path(), &json!({}), overwrite).is_err());
        assert_eq!(fs::read_to_string(dir.path().join("limits.csv")).unwrap(), "mine");

        fs::remove_file(dir.path().join("run.json")).unwrap();
        let found = message(open(dir.path(), &json!({}), overwrite));
        assert!(
            found.ends_with("is not empty and holds no record that this command continues (found limits.csv)"),
            "{found}"
        );

        let file = dir.path().join("limits.csv");
        assert!(matches!(open(&file, &json!({}), overwrite), Err(RecordError::Io { action: "create", .. })));
    }
}

#[test]
fn a_table_that_was_edited_or_cut_where_a_line_ends_is_reported() {
    let (rows, states) = two();
    for name in ["limits.csv", "states.jsonl"] {
        let dir = tempfile::tempdir().unwrap();
        open(dir.path(), &json!({}), false).unwrap().0.write(&rows, &states).unwrap();
        let path = dir.path().join(name);
        let text = fs::read_to_string(&path).unwrap();
        let cut = text[..text.trim_end().rfind('\n').unwrap() + 1].to_owned();
        for wrong in [text.replacen("15.0", "15.5", 1), cut] {
            assert_ne!(wrong, text);
            fs::write(&path, wrong).unwrap();
            for found in [message(Record::read(dir.path())), message(open(dir.path(), &json!({}), false))] {
                assert!(found.contains(&format!("{name} was edited or cut off: its SHA-256 is ")), "{found}");
            }
        }
        assert!(open(dir.path(), &json!({}), true).is_ok(), "{name}");
    }
}

#[test]
fn a_damaged_record_is_reported_and_can_be_replaced() {
    let (rows, states) = two();
    for (name, keep) in [("limits.csv", 250), ("states.jsonl", 300), ("run.json", 150)] {
        let dir = tempfile::tempdir().unwrap();
        open(dir.path(), &json!({}), false).unwrap().0.write(&rows, &states).unwrap();
        let path = dir.path().join(name);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, &text[..keep]).unwrap();
        let found = message(open(dir.path(), &json!({}), false));
        assert!(found.contains(&format!("{name}:")), "{found}");
        assert!(open(dir.path(), &json!({}), true).is_ok(), "{name}");
    }
}

#[test]
fn a_record_of_another_schema_is_refused() {
    let found = message(read_run("run.json", "{ \"schema\": 2, \"new\": true }"));
    assert_eq!(found, "run.json:1: schema 2; this program reads schema 1");
}

/// Symmetry came after forty-two columns.
#[test]
fn a_table_without_symmetry_is_read() {
    let image = LimitRow { image_of_deg: Some(75.0), grows_with_cell: Some(true), ..row(105.0, Status::Global) };
    let table = write_limits(std::slice::from_ref(&image)).unwrap();
    assert_eq!(read_limits("limits.csv", &table).unwrap(), std::slice::from_ref(&image));
    let plain = table.replace("\"1,0;-1,2\"", "2x1");
    let old: String = plain.lines().map(|line| line.split(',').take(42).collect::<Vec<_>>().join(",") + "\n").collect();
    let without = LimitRow { cell: "2x1".into(), image_of_deg: None, grows_with_cell: None, ..image };
    assert_eq!(read_limits("limits.csv", &old).unwrap(), [without]);
}

/// Tables of earlier versions end after thirty columns, or after those of a free width.
#[test]
fn a_table_without_the_later_columns_is_read() {
    let (rows, _) = two();
    let lattice = |a: Option<f64>| LimitRow { shear_max: Some(0.25), a1_x: a, a2_y: a, ..rows[0].clone() };
    let table = write_limits(&[lattice(Some(3.5))]).unwrap().replace("\"1,0;-1,2\"", "2x1");
    let old: String = table.lines().map(|line| line.split(',').take(36).collect::<Vec<_>>().join(",") + "\n").collect();
    let cell = "2x1".to_owned();
    assert_eq!(read_limits("limits.csv", &old).unwrap(), [LimitRow { cell: cell.clone(), ..lattice(None) }]);
    assert_eq!(read_limits("limits.csv", &table).unwrap(), [LimitRow { cell, ..lattice(Some(3.5)) }]);
    let table = write_limits(&rows).unwrap().replace("\"1,0;-1,2\"", "2x1");
    let old: String = table.lines().map(|line| line.split(',').take(30).collect::<Vec<_>>().join(",") + "\n").collect();
    let read = read_limits("limits.csv", &old).unwrap();
    assert_eq!(read, rows.into_iter().map(|row| LimitRow { cell: "2x1".into(), ..row }).collect::<Vec<_>>());
    assert_eq!((&read[0].lateral, read[0].l2_min), (&None, None));
    // One column less is no table of any version.
    let cut: String = table.lines().map(|line| line.split(',').take(31).collect::<Vec<_>>().join(",") + "\n").collect();
    assert!(message(read_limits("limits.csv", &cut)).contains("column 32"));
}

/// The forces of a sheet are read as they were written, with odd names and empty cells; what is no such table is refused with
/// its place.
#[test]
fn tables_of_forces_are_read_as_they_were_written() {
    let full = ForceRow {
        share: 0.1 + 0.2,
        stretch: Some(1.0 / 3.0),
        mean_force: Some(-0.0),
        deformation: Some([[1.44, 1e-300], [-1e21, 0.9]]),
        energy: f64::MIN_POSITIVE,
        floor_force: Some(12.0),
        bend_force: None,
        forces: vec![[0.1, 0.2, 0.3], [4.0, 5.0, 6.0]],
    };
    let empty = ForceRow { stretch: None, mean_force: None, deformation: None, floor_force: None, ..full.clone() };
    let places = vec!["flat@0,2".to_owned(), "a \"b\"\n_x".to_owned()];
    let table = ForceTable { places, bent: false, rows: vec![full, empty] };
    let text = write_forces(&table);
    assert_eq!(read_forces("forces.csv", &text).unwrap(), table);
    let none = ForceTable::default();
    assert_eq!(read_forces("forces.csv", &write_forces(&none)).unwrap(), none);
    let still = ForceTable {
        places: Vec::new(),
        bent: false,
        rows: vec![ForceRow { forces: Vec::new(), ..table.rows[0].clone() }],
    };
    assert_eq!(read_forces("forces.csv", &write_forces(&still)).unwrap(), still);
    let rows = table.rows.iter().cloned().map(|row| ForceRow { bend_force: Some(0.5), ..row }).collect();
    let bent = ForceTable { bent: true, rows, ..table.clone() };
    assert_eq!(read_forces("forces.csv", &write_forces(&bent)).unwrap(), bent);

    let plain = write_forces(&ForceTable { places: vec!["left".into(), "right".into()], ..table });
    for (from, to, line, problem) in [
        ("stretch", "strain", 1, "column 3 is \"strain\", expected \"stretch\""),
        ("force_left_y", "force_left_w", 1, "column 12 is \"force_left_w\", expected \"force_left_y\""),
        (",force_right_z", "", 1, "column 16 is \"\", expected \"force_right_z\""),
        ("force_right_z", "force_right_z,more", 1, "column 17 is \"more\", expected no more"),
        ("\n0,", "\n7,", 2, "column frame: \"7\" is not 0"),
        ("\n1,0.30000000000000004", "\n1,", 3, "column share is empty"),
        ("12.0", "wide", 2, "column floor_force: \"wide\" is not a finite number"),
        ("12.0", "inf", 2, "column floor_force: \"inf\" is not a finite number"),
        ("1.44", "", 2, "some are empty and some are not"),
        (",6.0\n1,", "\n1,", 2, "15 columns, expected 16"),
        (",6.0\n1,", ",\n1,", 2, "column force_right_z is empty"),
    ] {
        assert!(plain.contains(from), "{from:?} in {plain}");
        let found = read_forces("forces.csv", &plain.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(found.starts_with(&format!("forces.csv:{line}: ")) && found.contains(problem), "{to:?}: {found}");
    }
    assert!(read_forces("forces.csv", "").unwrap_err().to_string().contains("the header is missing"));
    assert!(read_forces("forces.csv", &plain[..plain.len() - 1]).unwrap_err().to_string().contains("ends within"));
}

/// A map of 1.1 in its own cell, open, with its record in memory.
fn open_map(directions_deg: &[f64]) -> OpenMap {
    let (method, cells) = (Method::Exact(ExactOptions::default()), Cell::PRIMITIVE.into());
    let question =
        MapQuestion::new(method, cells, Some(directions_deg.to_vec()), Some(vec![-0.125, 0.0]), None).unwrap();
    let map = Map { question, quantity: Quantity::default(), out: None, overwrite: false, sensitivities: false };
    let models = map.cells(&design()).into_iter().map(|cell| Model::compile(&design(), cell).unwrap()).collect();
    map.open(&design(), models).unwrap()
}

#[test]
fn maps_run_side_by_side_as_each_by_itself() {
    let heard = Mutex::new(Vec::new());
    let found = |name: &str, row: &LimitRow| heard.lock().unwrap().push((name.to_owned(), row.direction_deg, row.l2));
    let cancel = AtomicBool::new(false);
    let (at_work, begun) = (Mutex::new(Vec::new()), AtomicUsize::new(0));
    let work = |name: &str, task: Task, what| {
        let limit = (name.to_owned(), task.direction_deg.to_bits(), task.l2.to_bits());
        let mut at_work = at_work.lock().unwrap();
        match what {
            Work::Begins => {
                begun.fetch_add(1, Ordering::Relaxed);
                at_work.push(limit);
            }
            Work::Ends => {
                let at = at_work.iter().position(|begun| *begun == limit).expect("what ends was begun");
                at_work.swap_remove(at);
            }
        }
    };
    let open = vec![("a", open_map(&[0.0, 25.0])), ("b", open_map(&[45.0]))];
    let records = run_all(open, &cancel, &work, &found).unwrap();
    assert_eq!((at_work.into_inner().unwrap().len(), begun.into_inner()), (0, 6));
    let mut heard = heard.into_inner().unwrap();
    heard.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let of = |name: &str, direction_deg, l2| (name.to_owned(), direction_deg, l2);
    let all = [("a", 0.0), ("a", 25.0), ("b", 45.0)].map(|(name, d)| [of(name, d, -0.125), of(name, d, 0.0)]).concat();
    assert_eq!(heard, all);
    let alone = open_map(&[45.0]).run(&cancel, &|_, _| (), &|_, _| ()).unwrap();
    assert_eq!((records.len(), &records[1].states, &records[1].run), (2, &alone.states, &alone.run));
}

#[test]
fn rows_of_a_record_come_out_again_and_an_edited_one_does_not() {
    let cancel = AtomicBool::new(false);
    let mut record = open_map(&[0.0, 25.0]).run(&cancel, &|_, _| (), &|_, _| ()).unwrap();
    let l1 = record.rows[1].l1.as_mut().unwrap();
    *l1 += 1e-8;
    record.rows[3].status = Status::Uncertified;
    // The order is that of the question, and a row may be asked for twice.
    let rows: Vec<&LimitRow> = [3, 0, 1, 2, 0].map(|k| &record.rows[k]).to_vec();
    let replayed = replay(&record, &rows, &cancel).unwrap();
    assert_eq!(replayed.iter().map(Replayed::agrees).collect::<Vec<_>>(), [false, true, false, true, true]);
    for (row, asked) in replayed.iter().zip(rows) {
        assert_eq!((row.then, row.now.row.direction_deg, row.now.row.l2), (asked, asked.direction_deg, asked.l2));
        assert_eq!(row.now.state.poses.len(), design().elements.len());
    }
    assert!(replay(&record, &[], &cancel).unwrap().is_empty());
    record.run.parameters["method"] = json!("guess");
    assert!(matches!(replay(&record, &[&record.rows[0]], &cancel), Err(ReplayError::Record(_))));
}

/// Processors round differently, which moves a limit of the energy method within its bracket.
#[test]
fn limits_of_the_energy_method_come_out_again_within_their_bracket() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/records/energy");
    let mut record = Record::read(&folder).unwrap();
    for (row, shift) in record.rows.iter_mut().zip([1e-5, 2e-3]) {
        *row.l1.as_mut().unwrap() += shift;
    }
    let rows: Vec<&LimitRow> = record.rows.iter().take(2).collect();
    let replayed = replay(&record, &rows, &AtomicBool::new(false)).unwrap();
    assert_eq!(replayed.iter().map(Replayed::agrees).collect::<Vec<_>>(), [true, false]);
}
