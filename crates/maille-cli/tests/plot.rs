//! `maille plot` on records that the program has made.

use std::{path::Path, process::Command};

fn maille(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_maille")).current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let (code, out, err) = maille(folder, arguments);
    assert_eq!(code, Some(0), "{arguments:?}: {err}");
    out
}

#[test]
fn every_kind_is_drawn_from_records() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (design, out) in [("1.1", "a"), ("1.2", "maille-out/1.2")] {
        let map = ["characterize", design, "--directions", "0,45,90", "--l2=-0.25,0", "--quiet", "--out", out];
        done(folder, &map);
    }
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();

    // Of one record, the plot that the record has already.
    assert_eq!(done(folder, &["plot", "a"]), "maille-out/polar-1.1.svg\nmaille-out/polar-1.1.png\n");
    assert_eq!(text("maille-out/polar-1.1.svg"), text("a/polar.svg"));
    for kind in ["polar", "difference", "steps", "times"] {
        let png = format!("new/{kind}.png");
        done(folder, &["plot", "a", "1.2", "--kind", kind, "--overwrite", "-o", "x.svg", "-o", &png]);
        assert!(text("x.svg").contains(">1.1 and 1.2<") && text("x.svg").contains(">1.2<"), "{kind}");
        assert!(std::fs::read(folder.join(png)).unwrap().starts_with(b"\x89PNG"));
    }
    done(folder, &["plot", "a", "--where", "l2=0", "--quantity", "l1", "--overwrite", "-o", "x.svg"]);
    assert!(!text("x.svg").contains(">−0.25<"));

    let wrong = |arguments: &[&str]| {
        let (code, _, err) = maille(folder, arguments);
        assert_eq!(code, Some(2), "{err}");
        err
    };
    assert!(wrong(&["plot", "a", "-o", "x.pdf"]).contains(".svg or .png"));
    assert!(wrong(&["plot", "a", "--where", "l2=7"]).contains("no row is left"));
    assert!(wrong(&["plot", "a", "--kind", "steps", "--quantity", "l1"]).contains("have a --quantity"));
}

/// Stretches from the largest cell: a record that knows the wide limits of 1.1 measures from one of them, another from its start.
#[test]
fn a_reference_cell_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (out, l2) in [("a", "--l2=0,0.4"), ("b", "--l2=0")] {
        done(folder, &["characterize", "1.1", "--directions", "0,45,90", l2, "--quiet", "--out", out]);
    }
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    for (reference, word) in
        [("largest-cell", "Largest cell"), ("smallest-cell", "Smallest cell"), ("tightest", "Smallest cell")]
    {
        done(
            folder,
            &["plot", "a", "--reference", reference, "--where", "l2=0", "--overwrite", "-o", "r.svg", "-o", "r.png"],
        );
        assert!(text("r.svg").contains(word) && text("r.svg").contains('λ'), "{reference}");
        assert!(std::fs::read(folder.join("r.png")).unwrap().starts_with(b"\x89PNG"));
    }
    let curve = |record: &str, reference: &str| {
        done(folder, &["plot", record, "--reference", reference, "--where", "l2=0", "--overwrite", "-o", "c.svg"]);
        text("c.svg")
    };
    assert!(
        curve("a", "largest-cell") != curve("b", "largest-cell") && curve("a", "start") != curve("a", "largest-cell")
    );
    done(folder, &["plot", "a", "b", "--reference", "largest-cell", "--where", "l2=0", "-o", "both.svg"]);
    assert_eq!(text("both.svg").matches("Largest cell").count(), 2);
}

/// Largest and least stretch of a sheet in one figure: the range.
#[test]
fn a_range_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let directions = ["--directions", "0,45,90", "--lateral", "free", "--cell", "1x1", "--quiet"];
    for out in ["most", "least"] {
        let end: &[&str] = if out == "least" { &["--compression"] } else { &[] };
        done(folder, &[&["characterize", "european-4-in-1", "--out", out], end, &directions[..]].concat());
    }
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    assert!(text("least/polar.svg").contains("Least stretch") && text("most/polar.svg").contains("Largest stretch"));
    done(folder, &["plot", "most", "least", "-o", "range.svg"]);
    assert!(text("range.svg").contains("Largest and least stretch") && text("range.svg").contains(">least<"));
    let replayed = done(folder, &["replay", "least", "--at", "direction=45"]);
    assert!(replayed.contains("local") && !replayed.contains("DIFFERS"), "{replayed}");
}

/// Force against stretch: of one sheet and of two, as SVG and PNG, under the names that are chosen for them.
#[test]
fn forces_are_drawn_from_simulations() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (design, by) in [("1.1", "right=3,0,0"), ("1.2", "right=4,0,0")] {
        let sheet = ["simulate", design, "--tile", "2x1", "--fix", "left", "--pull", by, "--steps", "6", "--quiet"];
        done(folder, &sheet);
    }
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let usual = done(folder, &["plot", "1.1-simulate", "--kind", "force"]);
    assert_eq!(usual, "maille-out/force-1.1.svg\nmaille-out/force-1.1.png\n");
    let one = text("maille-out/force-1.1.svg");
    assert!(one.contains(">stops at 1.440<") && one.contains("Force against stretch"), "{one}");
    assert!(std::fs::read(folder.join("maille-out/force-1.1.png")).unwrap().starts_with(b"\x89PNG"));
    done(folder, &["plot", "1.1-simulate", "maille-out/1.2-simulate/forces.csv", "--kind", "force", "-o", "two.svg"]);
    assert!(text("two.svg").contains(">1.1 and 1.2<") && text("two.svg").contains(">stops at 1.440<"));
}
