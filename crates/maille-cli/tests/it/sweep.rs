//! `maille sweep`: what it writes, what stops nothing, and how it ends; `maille table` and `maille plot` of its folder.

use crate::common::{done, maille};
use std::{fs, path::Path};

/// A study is many records and one table; a variant that cannot be used is named, and does not stop the others.
#[test]
fn a_sweep_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let study =
        "directions = [0, 45]\nl2 = 0\ncell = \"1x1\"\n[[designs]]\ndesign = \"1.1\"\nminor_radius = [0.05, 0.1]\n";
    fs::write(folder.join("wire.toml"), study).unwrap();
    done(folder, "sweep wire.toml --quiet");
    let out = folder.join("maille-out/wire");
    let table = fs::read_to_string(out.join("limits.csv")).unwrap();
    assert_eq!(table.lines().count(), 5);
    for (name, l1) in [("1.1-r0.05", "0.52"), ("1.1-r0.1", "0.44")] {
        let row = table.lines().find(|line| line.contains(name)).unwrap();
        let found: f64 = row.split(',').nth(8).unwrap().parse().unwrap();
        assert!((found - l1.parse::<f64>().unwrap()).abs() < 1e-9, "{row}");
    }
    // One record is lost: its rows alone come anew, and the table is the same but for the times.
    fs::remove_dir_all(out.join("records/1.1-r0.1")).unwrap();
    let again = maille(folder, "sweep wire.toml --threads 1");
    assert!(String::from_utf8_lossy(&again.stderr).contains("2 of 4 limits are in maille-out/wire already"));
    let timeless = |table: &str| -> Vec<String> {
        let column = table.lines().next().unwrap().split(',').position(|name| name == "wall_s").unwrap();
        let without = |line: &str| line.split(',').enumerate().filter(|(k, _)| *k != column).map(|c| c.1).collect();
        table.lines().map(without).collect()
    };
    assert_eq!(timeless(&fs::read_to_string(out.join("limits.csv")).unwrap()), timeless(&table));

    fs::write(folder.join("wire.toml"), format!("{study}spacing = [1, 0.7]\n").replace("0.1]\n", "0.4]\n")).unwrap();
    let some = maille(folder, "sweep wire.toml --out other");
    assert_eq!(some.status.code(), Some(6), "{}", String::from_utf8_lossy(&some.stderr));
    let said = String::from_utf8_lossy(&some.stderr).into_owned();
    assert!(said.contains("1.1-r0.4-s1 could not be used") && said.contains("minor_radius = 0.4"), "{said}");
    assert!(fs::read_to_string(folder.join("other/limits.csv")).unwrap().contains("1.1-r0.05-s1"));
}

/// A study of three designs, of which one is missing, one is broken, and one has no such number in one variant.
#[test]
fn designs_that_cannot_be_used_stop_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let of = |designs: &str| format!("directions = [0, 45]\nl2 = 0\ncell = \"1x1\"\n{designs}");
    fs::write(folder.join("broken.toml"), "name = \"x\n").unwrap();
    let design = |name: &str| format!("[[designs]]\ndesign = \"{name}\"\n");
    let some = of(&["missing.toml", "1.1", "broken.toml"].map(design).concat());
    fs::write(folder.join("some.toml"), some + "[designs.vary]\n\"lattice.a1.x\" = 3\n").unwrap();
    let ended = maille(folder, "sweep some.toml -q");
    assert_eq!(ended.status.code(), Some(6));
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    for words in
        ["missing.toml could not be used", "there is no file", "broken.toml could not be used", "broken.toml:1:"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(fs::read_to_string(folder.join("maille-out/some/limits.csv")).unwrap().lines().count(), 3);
    fs::write(folder.join("none.toml"), of(&design("missing.toml"))).unwrap();
    let ended = maille(folder, "sweep none.toml");
    assert_eq!((ended.status.code(), ended.stdout), (Some(6), Vec::new()));
    assert!(!folder.join("maille-out/none").exists());
}

/// What varies is in columns, each design is asked its own questions, and the folder of the study stands for its records.
#[test]
fn a_folder_of_a_sweep_stands_for_its_records() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let study = "directions = [0, 45]\nl2 = [-0.1, 0]\ncell = \"1x1\"\nstarts = 2\n[[designs]]\ndesign = \"1.1\"\n\
                 minor_radius = [0.05, 0.1]\nspacing = [0.95, 1]\n[designs.vary]\n\"elements.standing-*.rings.major_radius\" = 1\n\
                 [[designs]]\ndesign = \"1.1\"\nname = \"free\"\nlateral = \"free\"\ndirections = 30\n";
    fs::write(folder.join("wide.toml"), study).unwrap();
    done(folder, "sweep wide.toml -q");
    let table =
        done(folder, "table wide --columns spacing,elements.standing-*.rings.major_radius,lateral,l1 --format csv");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    let count = |start: &str| rows.iter().filter(|row| row.starts_with(start)).count();
    assert_eq!(
        (rows.len(), count("0.95,1.0,fixed,"), count("1.0,1.0,fixed,"), count(",,free,")),
        (17, 8, 8, 1),
        "{table}"
    );
    // 1.1 is straight along 0°: of 0.95 of the spacing it stretches to (1.44 / 0.95).
    let own = done(folder, "table wide --where spacing=0.95,r=0.1,direction=0,l2=0 --columns l1 --format csv");
    let l1: f64 = own.lines().nth(1).unwrap().parse().unwrap();
    assert!((l1 - (1.44 / 0.95 - 1.0)).abs() < 1e-9, "{l1}");
    let joint = fs::read_to_string(folder.join("maille-out/wide/limits.csv")).unwrap();
    assert!(joint.lines().next().unwrap().ends_with(",elements.standing-*.rings.major_radius,spacing"));
    assert_eq!(joint, done(folder, "table maille-out/wide --format csv"));
    done(folder, "plot wide --where l2=0 -o wide.svg");
    assert!(folder.join("wide.svg").exists());
    done(folder, "verify maille-out/wide/records/1.1-r0.05-standing-major_radius1-s0.95 -q");
}

/// Limits that are not found have an exit code of their own, which can be refused.
#[test]
fn limits_that_are_not_found_may_be_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let hard = "characterize 1.1 --method energy --max-iterations 1 --directions 0 --l2 0";
    let ended = maille(folder.path(), hard);
    assert_eq!(ended.status.code(), Some(5));
    let said = String::from_utf8_lossy(&ended.stdout).into_owned();
    assert!(said.contains("1 not-converged: raise --max-iterations"), "{said}");
    assert!(said.contains("`maille table maille-out/1.1 --where l1=none` shows"), "{said}");
    assert_eq!(
        done(folder.path(), "table maille-out/1.1 --where l1=none --columns status --format csv"),
        "status\nnot-converged\n"
    );
    done(folder.path(), &format!("{hard} --allow-incomplete"));
}

/// The limit along x of this weave is that of two rings in a row, pulled straight: 4 R − 4 r over the pitch, minus 1.
#[test]
fn a_parameter_is_varied_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/parameters/square.toml");
    fs::copy(example, folder.join("square.toml")).unwrap();
    let study = "directions = 0\nl2 = 0\ncell = \"1x1\"\n[[designs]]\ndesign = \"square.toml\"\n\
                 [designs.vary]\nplay = [0.95, 1, 1.3]\nwire = 1\n";
    fs::write(folder.join("play.toml"), study).unwrap();
    let some = maille(folder, "sweep play.toml -q");
    let said = String::from_utf8_lossy(&some.stderr).into_owned();
    assert_eq!(some.status.code(), Some(6), "{said}");
    assert!(said.contains("square-play1.3-wire1 could not be used"), "{said}");
    assert!(said.contains("parameters.play: 1.3 is above max = 1.2"), "{said}");
    let table = done(folder, "table play --columns record,play,wire,radius,l1 --format csv");
    let mut rows = 0;
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [play, wire, radius, l1] = [1, 2, 3, 4].map(|k: usize| cells[k].parse::<f64>().unwrap());
        assert_eq!((wire, radius), (1.0, 6.0));
        let expected = (4.0 * radius - 2.0 * wire) / (2.5 * play * radius) - 1.0;
        assert!((l1 - expected).abs() < 1e-8, "{row}: {expected}");
        rows += 1;
    }
    assert_eq!(rows, 2);
    assert_eq!(done(folder, "table play --where play<1 --columns play --format csv"), "play\n0.95\n");
    done(folder, "verify maille-out/play/records/square-play0.95-wire1");
    let wrong = maille(folder, "table play --columns playy");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("did you mean play?"));
}

/// A name that no element has keeps every variant from use: one error.
#[test]
fn one_mistake_is_said_once() {
    let folder = tempfile::tempdir().unwrap();
    let study = "directions = [0]\nl2 = [0]\n[[designs]]\ndesign = \"1.1\"\n[designs.vary]\n\
                 \"elements.nobody.rings.major_radius\" = [0.9, 1.0, 1.1]\n";
    fs::write(folder.path().join("study.toml"), study).unwrap();
    let ended = maille(folder.path(), "sweep study.toml");
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.code() == Some(6) && said.matches("could not be used").count() == 1, "{said}");
    assert!(said.contains("and 2 others could not be used") && said.matches("nobody").count() <= 2, "{said}");
}
