//! Derivatives of limits: beside a solve, in a record, in its plot, and as `verify` derives them.

use serde_json::Value;
use std::{fs, path::Path, process::Command};

fn maille(folder: &Path, line: &str) -> (Option<i32>, String, String) {
    let arguments = line.split_whitespace();
    let output = Command::new(env!("CARGO_BIN_EXE_maille")).current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn done(folder: &Path, line: &str) -> String {
    let (code, out, err) = maille(folder, line);
    assert_eq!(code, Some(0), "{line}: {err}");
    out
}

/// Along 0° the limit of 1.1 is l1 = 0.48 − 0.4 r: what is solved is what is forecast, and both stand in one row.
#[test]
fn forecasts_stand_beside_what_is_solved() {
    let folder = tempfile::tempdir().unwrap();
    let found = done(folder.path(), "sensitivity 1.1 --step 0.01 --solve 2 --json");
    let found: Value = serde_json::from_str(&found).unwrap();
    let numbers = found["numbers"].as_array().unwrap();
    assert!(numbers[..2].iter().all(|row| row["solved"]["status"] == "global"), "{numbers:#?}");
    assert!(numbers[2..].iter().all(|row| row["solved"].is_null()));
    let spacing = &numbers.iter().find(|row| row["number"] == "spacing").unwrap();
    let (forecast, solved) = (spacing["change"].as_f64().unwrap(), spacing["solved"]["change"].as_f64().unwrap());
    // 1.44/1.01 − 1.44 is solved, −0.0144 forecast.
    assert!((forecast + 0.0144).abs() < 1e-9 && (solved - (1.44 / 1.01 - 1.44)).abs() < 1e-8, "{forecast} {solved}");
    let text = done(folder.path(), "sensitivity 1.1 --step 0.01 --solve 2");
    assert!(text.contains("solved anew") && text.contains("-0.014257"), "{text}");
    assert!(done(folder.path(), "sensitivity 1.1 --step 0.01").contains("--solve N"));
}

/// Along the axes the wire of 1.1 costs 0.4: four radii of 0.1 on 2.5 and 4 contacts. A finished record gets its derivatives without a
/// solve, image rows included; one that goes on keeps them up to date.
#[test]
fn a_record_has_derivatives_and_its_plot_a_band() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let map = "characterize 1.1 --directions 0,30,60,90 --l2 0,-0.125 --out a --quiet";
    done(folder, map);
    let table = folder.join("a/sensitivities.csv");
    assert!(!table.exists());
    let (limits, none) =
        (fs::read(folder.join("a/limits.csv")).unwrap(), maille(folder, "plot a --tolerance minor_radius=0.05"));
    assert!(none.0 == Some(4) && none.2.contains("--sensitivities"), "{none:?}");
    done(folder, &format!("{map} --sensitivities"));
    assert_eq!(fs::read(folder.join("a/limits.csv")).unwrap(), limits, "solved again");
    let text = fs::read_to_string(&table).unwrap();
    let slope = |direction: &str, l2: &str, number: &str| -> [f64; 2] {
        let row = text.lines().find_map(|line| line.strip_prefix(&format!("{direction},{l2},{number},"))).unwrap();
        let cells: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
        [cells[0], cells[1]]
    };
    let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8);
    assert_eq!(text.lines().count(), 1 + 8 * 2, "{text}");
    // The closed forms of the chain: l1 = (4 − 4 r)/2.5 − 1 at R = 1, by the spacing −1.44.
    assert!(close(slope("0.0", "0.0", "minor_radius"), [-1.6; 2]), "{text}");
    assert!(close(slope("90.0", "0.0", "spacing"), [-1.44; 2]), "{text}");
    // A row and its image under the symmetry of the design.
    assert!(close(slope("30.0", "-0.125", "minor_radius"), slope("60.0", "-0.125", "minor_radius")), "{text}");

    let verified = done(folder, "verify a --json");
    assert!(
        verified.contains("16 derivatives by minor_radius and spacing")
            && verified.contains("sensitivities.csv has the checksum"),
        "{verified}"
    );
    fs::write(&table, text.replace("0.0,0.0,minor_radius,-1.6", "0.0,0.0,minor_radius,-1.5")).unwrap();
    assert_ne!(fs::read_to_string(&table).unwrap(), text);
    let (code, found, _) = maille(folder, "verify a --json");
    assert!(code == Some(4) && found.contains("the forces at 0°, l2 = 0 sum up to -1.6"), "{found}");
    let spaced = text.lines().find(|line| line.starts_with("30.0,-0.125,spacing,")).unwrap();
    fs::write(&table, text.replace(spaced, "30.0,-0.125,spacing,-1.5,-1.5")).unwrap();
    let (code, found, _) = maille(folder, "verify a --json");
    assert!(code == Some(4) && found.contains("-1.5 back by spacing, where the forces at 30°, l2 = -0.125"), "{found}");
    let (code, _, err) = maille(folder, "table a");
    assert!(code == Some(4) && err.contains("sensitivities.csv was edited or cut off"), "{err}");
    let short: String = text.lines().take(9).map(|line| format!("{line}\n")).collect();
    fs::write(&table, short).unwrap();
    let (code, found, _) = maille(folder, "verify a --json");
    assert!(code == Some(4) && found.contains("4 certified limits have no derivatives"), "{found}");
    // The next run of the same inputs writes all of them again.
    done(folder, map);
    assert_eq!(fs::read_to_string(&table).unwrap(), text);

    // As columns beside the limits.
    let columns = "direction,l1,dl1/minor_radius,dl1_back/minor_radius,dl1/spacing";
    let rows = done(
        folder,
        &format!("table a --format csv --where l2=0,dl1/spacing<-1.43,dl1/spacing>-1.5 --columns {columns}"),
    );
    let mut rows = rows.lines();
    assert_eq!(rows.next().unwrap().split_once(",l1").unwrap().1, columns.split_once(",l1").unwrap().1);
    for (direction, row) in [0.0, 90.0].iter().zip(&mut rows) {
        let cells: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(cells.iter().zip([*direction, 0.44, -1.6, -1.6, -1.44]).all(|(a, b)| (a - b).abs() < 1e-8), "{row}");
    }
    let all = done(folder, "table a --format csv");
    assert!(
        all.lines().next().unwrap().ends_with("dl1/minor_radius,dl1_back/minor_radius,dl1/spacing,dl1_back/spacing")
    );
    let (code, _, err) = maille(folder, "table a --columns dl1/wire");
    assert!(code == Some(2) && err.contains("there are dl1/minor_radius"), "{err}");

    done(folder, "plot a --tolerance minor_radius=0.05 --where l2=0 -o band.svg -o band.png");
    let band = fs::read_to_string(folder.join("band.svg")).unwrap();
    assert!(band.contains("minor_radius ± 0.05") && band.contains("within the tolerance"), "{band}");
    for (line, words) in [
        ("plot a --tolerance wire=0.05", "there are those by minor_radius, spacing"),
        ("plot a --tolerance minor_radius=0", "amount above 0"),
        ("plot a --tolerance minor_radius=0.05 --kind steps", "polar plots"),
        ("plot a --tolerance minor_radius=0.05 --quantity lambda1", "polar plots"),
        ("characterize 1.1 --method energy --sensitivities --out b", "no derivatives"),
    ] {
        let (code, _, err) = maille(folder, line);
        assert!(code == Some(2) && err.contains(words), "{line}: {err}");
    }
}

/// Larger cells, free widths, the least l1, and rings with radii of their own.
#[test]
fn derivatives_of_other_records_are_those_of_their_forces() {
    let folder = tempfile::tempdir().unwrap();
    for (name, rest) in [
        ("free", "1.1 --directions 20 --lateral free --shear free"),
        ("cell", "3.1 --directions 30 --l2=-0.25 --cell 2x1"),
        ("least", "european-4-in-1 --directions 0 --l2 0 --compression --starts 1 --cell 1x1"),
    ] {
        done(folder.path(), &format!("characterize {rest} --out {name} --quiet --sensitivities"));
        let found = done(folder.path(), &format!("verify {name} --json"));
        assert!(found.contains("2 derivatives by minor_radius and spacing"), "{name}: {found}");
    }
}
