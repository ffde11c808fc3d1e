//! `maille verify` proves what `characterize` certifies, of every built-in design, and finds what is planted.

mod curves;
mod specimen;
mod waves;

use crate::common::{code, done, maille};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use specimen::{Specimen, all_proved, said, verified};
use std::fs;

#[test]
fn a_sample_of_every_design_is_proved() {
    let dir = tempfile::tempdir().unwrap();
    let designs: Value = serde_json::from_slice(&maille(dir.path(), "designs --json").stdout).unwrap();
    let designs = designs["designs"].as_array().unwrap_or_else(|| designs.as_array().unwrap());
    assert!(designs.len() >= 33);
    for design in designs {
        let name = design["name"].as_str().unwrap();
        // 5 where a limit is not found: what is certified is verified all the same.
        let pulls = if design["single"] == true { "" } else { "--directions 0,37.5 --l2=-0.125,0" };
        // What few starts find is verified as what many do. A knot of 672 arcs takes long.
        let starts = if name == "torus-knots" { 1 } else { 2 };
        let line = format!("characterize {name} {pulls} --starts {starts} --cell 1x1 --out {name} --quiet");
        assert!([0, 5].contains(&code(&maille(dir.path(), &line))), "{line}");
        all_proved(dir.path(), name);
    }
}

#[test]
fn what_is_free_larger_cells_and_the_least_l1_are_proved() {
    let dir = tempfile::tempdir().unwrap();
    for (name, rest) in [
        ("free", "1.1 --directions 20 --lateral free --shear free"),
        ("wide", "1.1 --directions 20 --lateral free"),
        ("cell", "3.1 --directions 30 --l2=-0.25 --cell 2x1"),
        ("matrix", "1.1 --directions 20 --l2 0 --cell 1,0;-1,2"),
        ("least", "european-4-in-1 --directions 0 --l2 0 --compression --starts 1 --cell 1x1"),
    ] {
        let line = format!("characterize {rest} --out {name} --quiet");
        assert!([0, 5].contains(&code(&maille(dir.path(), &line))), "{line}");
        all_proved(dir.path(), name);
    }
}

#[test]
fn the_energy_method_claims_no_certificate_and_its_states_are_verified() {
    let dir = tempfile::tempdir().unwrap();
    maille(dir.path(), "characterize 1.1 --directions 0 --l2=-0.25,0 --method energy --out record --quiet");
    let (code, found) = verified(dir.path(), "record");
    assert_eq!((code, found["certified"].as_u64()), (0, Some(0)), "{found:#}");
    assert_eq!(said(&found, "links", "proved").len(), 2);
    // With l2 = −0.25 the cell is left 1e-8 R out of its plane.
    assert_eq!(said(&found, "deformation", "proved").len(), 2, "{found:#}");
}

/// F of the cell's four corners is not that of the lattice: what the lattice fixes of it is compared, the rest left open.
#[test]
fn strains_of_corners_are_left_open_and_false_ones_found() {
    let dir = tempfile::tempdir().unwrap();
    let line =
        "characterize 3.1 --directions 30 --l2 0 --method energy --protocol corners --tau 0.1 --out record --quiet";
    maille(dir.path(), line);
    let (code, found) = verified(dir.path(), "record");
    assert_eq!(code, 5, "{found:#}");
    assert!(said(&found, "deformation", "open")[0].contains("of the fourth corner"), "{found:#}");
    let specimen = Specimen { dir };
    let l1: f64 = specimen.cell("l1").parse().unwrap();
    specimen.forge_row(&[("l1", &(l1 + 1e-6).to_string())]);
    specimen.found_by(4, "deformation", "l1 is");
    specimen.forge_row(&[("l1", &l1.to_string())]);
    specimen.forge_state(|state| state["a1"][0] = json!(state["a1"][0].as_f64().unwrap() + 1e-6));
    specimen.found_by(4, "deformation", "along a diagonal of the cell");
}

/// Two chains of rings along x, not linked with each other.
const CHAINS: &str = "schema = 1\nname = \"chains\"\nminor_radius = 0.1\nreference_radius = 1.0\n\
    [lattice]\na1 = [2.5, 0.0, 0.0]\na2 = [0.0, 2.5, 0.0]\n\
    [[elements]]\nname = \"flat\"\ncenter = [0.0, 0.0, 0.0]\nrings = [{ major_radius = 1.0, normal = [0.0, 0.0, 1.0] }]\n\
    [[elements]]\nname = \"standing\"\ncenter = [1.25, 0.0, 0.0]\nrings = [{ major_radius = 1.0, normal = [0.0, 1.0, 0.0] }]\n";

#[test]
fn that_a_sheet_comes_apart_is_proved_and_a_state_that_does_not_show_it_found() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("chains.toml"), CHAINS).unwrap();
    let line = "characterize chains.toml --directions 90 --l2=-0.125,0 --cell 1x1 --out record --quiet";
    assert_eq!(code(&maille(dir.path(), line)), 0);
    let (outcome, found) = verified(dir.path(), "record");
    assert_eq!(outcome, 0, "{found:#}");
    assert_eq!(said(&found, "bound", "proved"), ["from this state l1 can grow for ever"; 2], "{found:#}");
    // So does the energy method's state.
    let line = "characterize chains.toml --directions 90 --l2 0 --method energy --cell 1x1 --out energy --quiet";
    assert_eq!(code(&maille(dir.path(), line)), 0);
    let (outcome, found) = verified(dir.path(), "energy");
    assert_eq!(outcome, 0, "{found:#}");
    assert_eq!(said(&found, "bound", "proved"), ["from this state l1 can grow for ever"], "{found:#}");
    let specimen = Specimen { dir };
    // The rows of rings so near that one of them could still hold the next.
    specimen.forge_state(|state| state["a2"] = json!([0.0, 2.1, 0.0]));
    let (outcome, found) = specimen.verified();
    assert_eq!(outcome, 4, "{found:#}");
    assert!(said(&found, "bound", "false")[0].contains("could meet where l1 grows on"), "{found:#}");
}

fn heaviest(state: &Value) -> Value {
    let contacts = state["contacts"].as_array().unwrap();
    let force = |c: &&Value| c["force"].as_f64().unwrap();
    (*contacts.iter().max_by(|a, b| force(a).total_cmp(&force(b))).unwrap()).clone()
}

#[test]
fn a_loaded_element_that_was_moved_by_a_millionth_is_found() {
    for sign in [1e-6, -1e-6] {
        let specimen = Specimen::new();
        specimen.forge_state(|state| {
            // Each element of 1.1 has one ring.
            let contact = heaviest(state);
            let ring = contact["ring_b"].as_u64().unwrap() as usize;
            for k in 0..3 {
                let at = &mut state["poses"][ring]["position"][k];
                *at = json!(at.as_f64().unwrap() + sign * contact["normal"][k].as_f64().unwrap());
            }
        });
        specimen.refuted_by("overlap", "overlap by 1.000e-6 R");
    }
}

#[test]
fn an_element_that_was_passed_through_another_is_found() {
    let specimen = Specimen::new();
    specimen.forge_state(|state| {
        let at = &mut state["poses"][1]["position"][2];
        *at = json!(at.as_f64().unwrap() + 4.0);
    });
    specimen.refuted_by("links", "have linking number 0, ");
}

/// A half turn changes no circle but its orientation, and with it the sign of each of its links.
#[test]
fn an_element_that_was_turned_over_is_found() {
    let specimen = Specimen::new();
    specimen.forge_state(|state| {
        let q: Vec<f64> =
            state["poses"][1]["rotation"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        // q times a half turn about x, an axis in the plane of the ring, whose normal is y.
        state["poses"][1]["rotation"] = json!([-q[1], q[0], q[3], -q[2]]);
    });
    specimen.refuted_by("links", "have linking number");
}

#[test]
fn a_force_whose_sign_or_size_was_changed_is_found() {
    for (factor, words) in [(-1.0, "a contact pulls"), (1.001, "do not balance")] {
        let specimen = Specimen::new();
        specimen.forge_state(|state| {
            let heaviest = heaviest(state);
            let contacts = state["contacts"].as_array_mut().unwrap();
            let contact = contacts.iter_mut().find(|c| **c == heaviest).unwrap();
            contact["force"] = json!(factor * contact["force"].as_f64().unwrap());
        });
        specimen.refuted_by("balance", words);
    }
}

/// Adds `more` to a cell of the first row.
fn edited(text: &str, column: &str, more: f64) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = lines[0].split(',').position(|name| name == column).unwrap();
    let mut cells: Vec<String> = lines[1].split(',').map(str::to_owned).collect();
    cells[at] = format!("{:?}", cells[at].parse::<f64>().unwrap() + more);
    lines[1] = cells.join(",");
    lines.join("\n") + "\n"
}

#[test]
fn a_number_that_was_edited_is_found_by_the_checksum_and_without_it() {
    for (column, check) in [
        ("l1", "deformation"),
        ("lambda1", "deformation"),
        ("stretch2", "deformation"),
        ("a2_y", "deformation"),
        ("min_gap", "overlap"),
        ("own_image_force", "balance"),
        ("bound_l1", "bound"),
    ] {
        let specimen = Specimen::new();
        let text = edited(&specimen.text("limits.csv"), column, 1e-5);
        fs::write(specimen.path("limits.csv"), &text).unwrap();
        let (code, found) = specimen.verified();
        assert_eq!(code, 4);
        assert!(said(&found, "files", "false")[0].contains("limits.csv was edited or cut off"), "{found:#}");
        let table = maille(specimen.dir.path(), "table record");
        assert_eq!(self::code(&table), 4);
        assert!(String::from_utf8_lossy(&table.stderr).contains("limits.csv was edited or cut off"));
        specimen.forge("limits.csv", &text);
        specimen.refuted_by(check, "");
    }
}

#[test]
fn parameters_that_were_edited_are_found() {
    let specimen = Specimen::new();
    let run = specimen.text("run.json");
    fs::write(specimen.path("run.json"), run.replacen("\"seed\": 1", "\"seed\": 2", 1)).unwrap();
    let (code, found) = specimen.verified();
    assert_eq!(code, 4);
    assert!(said(&found, "files", "false")[0].contains("design or parameters"), "{found:#}");
}

#[test]
fn files_that_were_cut_off_are_found() {
    for name in ["limits.csv", "states.jsonl", "run.json"] {
        let specimen = Specimen::new();
        let text = specimen.text(name);
        // Within a line, and where one ends.
        fs::write(specimen.path(name), &text[..text.len() - 7]).unwrap();
        let output = maille(specimen.dir.path(), "verify record");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(code(&output), 4, "{name}: {said}");
        assert!(said.contains(name) && said.contains("damaged or was edited"), "{name}: {said}");
        let end = text.trim_end().rfind('\n').unwrap() + 1;
        fs::write(specimen.path(name), &text[..end]).unwrap();
        let output = maille(specimen.dir.path(), "verify record --quiet");
        assert_eq!(code(&output), 4, "{name}");
        if name != "run.json" {
            assert!(String::from_utf8_lossy(&output.stdout).contains(&format!("{name} was edited or cut off")));
        }
    }
}

#[test]
fn a_record_without_checksums_is_proved_and_says_so() {
    let specimen = Specimen::new();
    let mut run: Value = serde_json::from_str(&specimen.text("run.json")).unwrap();
    run.as_object_mut().unwrap().remove("files");
    fs::write(specimen.path("run.json"), run.to_string() + "\n").unwrap();
    all_proved(specimen.dir.path(), "record");
    assert_eq!(said(&specimen.verified().1, "files", "consistent").len(), 2);
    assert_eq!(code(&maille(specimen.dir.path(), "table record")), 0);
}

#[test]
fn a_run_that_was_killed_between_two_files_is_open_not_false() {
    let specimen = Specimen::new();
    // As it was when one limit was known: a table of one row, and the checksums of both.
    let (limits, mut run): (String, Value) =
        (specimen.text("limits.csv"), serde_json::from_str(&specimen.text("run.json")).unwrap());
    let first: String = limits.split_inclusive('\n').take(2).collect();
    let sum: String = Sha256::digest(&first).iter().map(|byte| format!("{byte:02x}")).collect();
    let now = run["files"]["limits.csv"][0].clone();
    run["files"]["limits.csv"] = json!([now, sum]);
    fs::write(specimen.path("limits.csv"), first).unwrap();
    fs::write(specimen.path("run.json"), run.to_string() + "\n").unwrap();
    let (code, found) = specimen.verified();
    assert_eq!((code, &found["outcome"]), (5, &json!("open")), "{found:#}");
    let line = "characterize 1.1 --directions 0,25 --l2=-0.125,0 --cell 1x1 --out record --quiet";
    assert_eq!(self::code(&maille(specimen.dir.path(), line)), 0);
    all_proved(specimen.dir.path(), "record");
}

/// What a row without a limit leaves empty.
const LIMIT: [&str; 33] = [
    "l1",
    "lambda1",
    "lambda2",
    "stretch1",
    "stretch2",
    "max_overlap",
    "min_gap",
    "bound_l1",
    "bound_kind",
    "bound_gap",
    "dual_residual",
    "complementarity",
    "min_multiplier",
    "min_curvature",
    "zero_modes",
    "links_ok",
    "n_distinct",
    "better_chance",
    "own_image_force",
    "l1_uncertified",
    "l2_min",
    "l2_max",
    "shear_min",
    "shear_max",
    "a1_x",
    "a1_y",
    "a2_x",
    "a2_y",
    "by_cell",
    "wave_curvature",
    "wave_q1",
    "wave_q2",
    "extreme",
];

fn without_limit(status: &'static str) -> Vec<(&'static str, &'static str)> {
    LIMIT.iter().map(|column| (*column, "")).chain([("status", status)]).collect()
}

#[test]
fn a_limit_that_was_rewritten_as_unreachable_is_found() {
    // The numbers left; emptied, with the state left; with the design's state, whose l2 is 0; without the chain, too.
    let specimen = Specimen::new();
    specimen.forge_row(&[("status", "l2-unreachable")]);
    specimen.found_by(4, "status", "a row that is l2-unreachable has l1");
    let specimen = Specimen::new();
    specimen.forge_row(&without_limit("l2-unreachable"));
    specimen.found_by(4, "bound", "the state has this l2");
    specimen.forge_state(|state| {
        (state["a1"], state["a2"]) = (json!([2.5, 0.0, 0.0]), json!([0.0, 2.5, 0.0]));
        state["deformation_gradient"] = json!([[1.0, 0.0], [0.0, 1.0]]);
    });
    specimen.found_by(5, "bound", "a chain of links allows this l2");
    specimen.forge_state(|state| {
        state.as_object_mut().unwrap().remove("chain");
    });
    specimen.found_by(5, "bound", "nothing in the state proves that no state has this l2");
}

/// A row whose limit stays below its bound, claimed to attain it.
#[test]
fn a_local_limit_that_was_lifted_to_global_is_found() {
    let local = || {
        let specimen = Specimen::of("2 --directions 0 --l2 0 --cell 1x1 --starts 1");
        assert_eq!(specimen.cell("status"), "local");
        specimen
    };
    let bound = |specimen: &Specimen, kind: &'static str| {
        let l1 = specimen.cell("l1");
        let wave = ["wave_curvature", "wave_q1", "wave_q2"].map(|column| (column, ""));
        let bound = [("status", "global"), ("bound_l1", &l1[..]), ("bound_gap", "0.0"), ("bound_kind", kind)];
        specimen.forge_row(&[&bound[..], &wave].concat());
    };
    // The chain that the solver wrote proves its own bound and no lower one; so do the forces by the normals of the rings.
    let specimen = local();
    bound(&specimen, "chain");
    specimen.forge_state(|state| drop(state.as_object_mut().unwrap().remove("dual")));
    specimen.found_by(4, "bound", "a chain of links proves l1 ≤");
    let specimen = local();
    bound(&specimen, "link");
    specimen.found_by(4, "bound", "a balance of forces in the links proves l1 ≤");
    for kind in ["link", "chain"] {
        let specimen = local();
        bound(&specimen, kind);
        specimen.forge_state(|state| {
            state.as_object_mut().unwrap().remove("chain");
            state.as_object_mut().unwrap().remove("dual");
        });
        specimen.found_by(5, "bound", "nothing in the state proves the bound");
    }
}

#[test]
fn a_link_bound_that_its_forces_do_not_prove_is_found() {
    let global = || {
        let specimen = Specimen::of("5.1 --directions 0 --l2 0 --cell 1x1 --starts 1");
        assert_eq!((specimen.cell("status"), specimen.cell("bound_kind")), ("global".into(), "link".into()));
        specimen
    };
    let of_forces = "a balance of forces in the links";
    let higher = (global().cell("bound_l1").parse::<f64>().unwrap() + 0.1).to_string();
    // Another bound; forces that balance no more; rings that are not linked; no forces.
    let specimen = global();
    specimen.forge_row(&[("status", "local"), ("bound_l1", &higher), ("bound_gap", "0.1")]);
    let (code, found) = specimen.verified();
    assert_eq!((code, said(&found, "bound", "false").len()), (4, 1), "{found:#}");
    let specimen = global();
    specimen.forge_state(|state| {
        let force = &mut state["dual"][0]["force"][0];
        *force = json!(force.as_f64().unwrap() + 1e-3);
    });
    specimen.found_by(4, "bound", of_forces);
    // Forces whose squares vanish would prove anything.
    let specimen = global();
    specimen.forge_state(|state| {
        for dual in state["dual"].as_array_mut().unwrap() {
            let force = dual["force"].as_array_mut().unwrap();
            force.iter_mut().for_each(|y| *y = json!(y.as_f64().unwrap() * 1e-170));
        }
    });
    specimen.found_by(4, "bound", "a force of the bound is");
    let specimen = global();
    specimen.forge_state(|state| state["dual"][0]["rings"][0][1] = json!([7, 0]));
    specimen.found_by(4, "bound", "which are not linked");
    let specimen = global();
    specimen.forge_state(|state| {
        state.as_object_mut().unwrap().remove("dual");
        state.as_object_mut().unwrap().remove("chain");
    });
    specimen.found_by(5, "bound", "nothing in the state proves the bound");
}

#[test]
fn certificates_that_were_emptied_or_invented_are_found() {
    for (cells, check, words) in [
        (vec![("min_multiplier", "0.9")], "balance", "min_multiplier is 0.9"),
        (vec![("min_curvature", "0.5")], "curvature", "min_curvature is Some(0.5)"),
        (vec![("min_curvature", "")], "curvature", "min_curvature is None"),
        (vec![("min_curvature", "-0.1")], "status", "min_curvature of a certified row"),
        (vec![("zero_modes", "99")], "curvature", "Some(99) zero modes"),
        (vec![("n_distinct", "999")], "status", "n_distinct is 999"),
        (vec![("n_distinct", "0")], "status", "n_distinct is 0"),
        (vec![("dual_residual", "")], "status", "has no dual_residual"),
        (vec![("complementarity", "")], "status", "has no complementarity"),
        (vec![("min_multiplier", "")], "status", "has no min_multiplier"),
        (vec![("zero_modes", "")], "status", "has no zero_modes"),
        (vec![("links_ok", "")], "status", "has no links_ok"),
        (vec![("links_ok", "false")], "status", "links_ok of a certified row is false"),
        (vec![("own_image_force", "")], "status", "has no own_image_force"),
        (vec![("min_gap", "")], "status", "has no min_gap"),
        (vec![("bound_l1", "")], "status", "has no bound_l1"),
        (vec![("l1", "")], "status", "has no l1"),
        (vec![("l2_min", "")], "status", "has no l2_min"),
        (vec![("dual_residual", "0.1")], "status", "dual_residual of a certified row"),
        (vec![("status", "threshold-reached")], "status", "the exact method has no status threshold-reached"),
        (vec![("status", "l2-not-reached")], "status", "a row that is l2-not-reached has l1"),
    ] {
        let specimen = Specimen::new();
        specimen.forge_row(&cells);
        specimen.found_by(4, check, words);
    }
}

#[test]
fn a_certificate_of_the_energy_method_is_found() {
    let specimen = Specimen::of("1.1 --directions 0 --l2 0 --cell 1x1");
    specimen.forge_run(|run| run["parameters"]["method"] = json!("energy"));
    specimen.forge_row(&[("method", "energy")]);
    specimen.found_by(4, "status", "the energy method has no status global");
}

#[test]
fn rows_that_are_all_of_larger_cells_are_proved() {
    let dir = tempfile::tempdir().unwrap();
    let line = "characterize 3.1 --directions 30 --l2=-0.25 --out record --quiet";
    assert_eq!(code(&maille(dir.path(), line)), 0);
    let row = verified(dir.path(), "record").1["rows"][0].clone();
    assert_eq!(row["status"], "local");
    let cell = fs::read_to_string(dir.path().join("record/limits.csv")).unwrap();
    assert!(!cell.lines().nth(1).unwrap().contains(",1x1,"), "{cell}");
    all_proved(dir.path(), "record");
}

/// Beside the direction across a chain nothing is unbounded, and what is left of the pull is no fault of the record.
#[test]
fn next_to_the_direction_across_a_chain_nothing_is_unbounded() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("chains.toml"), CHAINS).unwrap();
    for direction in ["90.00000001", "90.0001"] {
        let line = format!(
            "characterize chains.toml --directions {direction} --l2 0 --starts 4 --cell 1x1 --out {direction} --quiet"
        );
        assert!([0, 5].contains(&code(&maille(dir.path(), &line))), "{line}");
        let (outcome, found) = verified(dir.path(), direction);
        assert_ne!(found["rows"][0]["status"], "unbounded", "{found:#}");
        assert_ne!(outcome, 4, "{found:#}");
    }
}

/// Images of a gyroscope would be linked: shown by translations. Without what bounds l1 nothing is shown.
#[test]
fn that_images_would_be_too_near_is_proved() {
    let specimen = Specimen { dir: tempfile::tempdir().unwrap() };
    let line = "characterize 1.3-small --directions 22.5 --l2 0.125 --cell 1x1 --starts 1 --out record --quiet";
    assert!([0, 5].contains(&code(&maille(specimen.dir.path(), line))), "{line}");
    let (outcome, found) = specimen.verified();
    assert_eq!((outcome, &found["rows"][0]["status"]), (0, &json!("l2-unreachable")), "{found:#}");
    assert!(said(&found, "bound", "proved")[0].contains("would overlap its image"), "{found:#}");
    specimen.forge_state(|state| {
        state.as_object_mut().unwrap().remove("chain");
    });
    specimen.found_by(5, "bound", "nothing in the state proves");
}

/// The smallest l1 of this sheet is at a corner near 58.67°: the row is solved again by itself, and one that is not what it is called is
/// found.
#[test]
fn an_extreme_between_the_directions_is_one() {
    let specimen = Specimen::of("2-oblong --directions 45,60,75 --l2 0 --extremes yes");
    let lines: Vec<String> = specimen.text("limits.csv").lines().map(str::to_owned).collect();
    let extremes: Vec<&String> = lines.iter().filter(|line| line.ends_with(",smallest")).collect();
    assert!(lines.len() == 5 && extremes.len() == 1 && lines[2] == *extremes[0], "{lines:?}");
    let at: f64 = extremes[0].split(',').nth(2).unwrap().parse().unwrap();
    assert!((at - 58.67).abs() < 0.01, "{at}");
    let replayed = done(specimen.dir.path(), &format!("replay record --at direction={at}"));
    assert!(replayed.contains("recorded") && !replayed.contains("DIFFERS"), "{replayed}");
    // A finished record stays as it is.
    done(specimen.dir.path(), "characterize 2-oblong --directions 45,60,75 --l2 0 --extremes yes --out record --quiet");
    assert_eq!(specimen.text("limits.csv").lines().collect::<Vec<_>>(), lines);
    specimen.forge("limits.csv", &specimen.text("limits.csv").replace(",smallest", ",largest"));
    let (code, found) = specimen.verified();
    let words = "is called the largest l1 of its l2, and another row goes beyond it";
    assert!(code == 4 && said(&found, "files", "false").iter().any(|w| w.ends_with(words)), "{found:#}");
    specimen.forge("limits.csv", &(lines.join("\n") + "\n"));
    specimen.forge_row(&[("extreme", "largest")]);
    let (code, found) = specimen.verified();
    assert!(
        code == 4 && said(&found, "files", "false").iter().any(|w| w.contains("was asked for, and is")),
        "{found:#}"
    );
    specimen.forge("limits.csv", &(lines.join("\n") + "\n"));
    specimen.forge_run(|run| run["parameters"]["extremes"] = json!(false));
    let (code, found) = specimen.verified();
    assert!(code == 4 && said(&found, "files", "false").iter().any(|w| w.contains("was not asked for")), "{found:#}");
}
