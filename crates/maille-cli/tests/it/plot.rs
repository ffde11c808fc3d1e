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
    assert!(wrong(&["plot", "a", "-o", "x.eps"]).contains(".svg, .pdf or .png"));
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

/// The folder of a surface is a record: drawn for print, tabulated, derived anew; an edit is seen.
#[test]
fn a_surface_is_plotted_tabulated_and_verified() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let surface = ["boundary", "european-4-in-1", "--vertices", "162", "--starts", "1", "--quiet", "--out", "s"];
    let (_, _, err) = maille(folder, &surface);
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    assert!(folder.join("s/surface.json").is_file(), "{err}");
    done(folder, &["plot", "s", "--style", "paper", "-o", "s.svg", "-o", "s.pdf"]);
    assert!(text("s.svg").contains("width=\"89mm\"") && text("s.svg").contains("Attainable strains"));
    assert!(std::fs::read(folder.join("s.pdf")).unwrap().starts_with(b"%PDF"));
    let table = done(folder, &["table", "s", "--rows", "3"]);
    assert!(table.lines().count() == 4 && table.contains("distance"), "{table}");
    assert_eq!(done(folder, &["table", "s", "--format", "csv"]), text("s/boundary.csv"));

    // Of what is derived nothing is false, and nearly all is proved.
    let (code, out, err) = maille(folder, &["verify", "s", "--json", "--quiet"]);
    let found: serde_json::Value = serde_json::from_str(&out).unwrap();
    let found = &found["surfaces"][0];
    let certified = found["certified"].as_u64().unwrap();
    let findings = found["vertices"].as_array().unwrap().iter().flat_map(|v| v["findings"].as_array().unwrap());
    let of = |check: &str, verdict: &str| {
        findings.clone().filter(|f| f["check"] == check && f["verdict"] == verdict).count() as u64
    };
    assert!(matches!(code, Some(0 | 5)) && certified > 100, "{certified} {err}");
    for (check, tenths) in [("overlap", 10), ("links", 10), ("balance", 9), ("curvature", 9), ("bound", 8)] {
        let proved = of(check, "proved");
        assert!(of(check, "false") == 0 && 10 * proved >= tenths * certified, "{check}: {proved} of {certified}");
    }
    // More starts than were made.
    let (states, head) = (text("s/surface.jsonl"), text("s/surface.json"));
    assert!(head.contains("\"starts\":1,"));
    std::fs::write(folder.join("s/surface.json"), head.replacen("\"starts\":1,", "\"starts\":64,", 1)).unwrap();
    let (code, out, _) = maille(folder, &["verify", "s", "--quiet"]);
    assert!(code == Some(4) && out.contains("design or parameters of surface.json were edited"), "{out}");
    // What decides nothing about a ray, and the mesh.
    for (from, to) in
        [("\"tolerance\":", "\"tolerance\":1"), ("\"arch\":", "\"arch\":1"), ("\"triangles\":[[", "\"triangles\":[[1")]
    {
        assert!(head.contains(from), "{from}");
        std::fs::write(folder.join("s/surface.json"), head.replacen(from, to, 1)).unwrap();
        let (code, out, _) = maille(folder, &["verify", "s", "--quiet"]);
        assert!(code == Some(4) && out.contains("surface.json was edited"), "{from}: {out}");
    }
    std::fs::write(folder.join("s/surface.json"), &head).unwrap();
    let mesh = text("s/boundary.obj");
    std::fs::write(folder.join("s/boundary.obj"), mesh.replacen("\nf ", "\nf 1", 1)).unwrap();
    let (code, out, _) = maille(folder, &["verify", "s", "--quiet"]);
    assert!(code == Some(4) && out.contains("boundary.obj was edited"), "{out}");
    std::fs::write(folder.join("s/boundary.obj"), &mesh).unwrap();
    // A ring moved by a tenth of R: its state, whose checksum is made right again, is refuted.
    std::fs::write(folder.join("s/surface.json"), &head).unwrap();
    let first = states.lines().next().unwrap();
    let mut vertex: serde_json::Value = serde_json::from_str(first).unwrap();
    let x = vertex["poses"][0][0].as_f64().unwrap();
    vertex["poses"][0][0] = (x + 0.1).into();
    let edited = states.replacen(first, &vertex.to_string(), 1);
    std::fs::write(folder.join("s/surface.jsonl"), &edited).unwrap();
    let (code, out, _) = maille(folder, &["verify", "s", "--quiet"]);
    assert!(code == Some(4) && out.contains("surface.jsonl was edited"), "{out}");
    let sum = |text: &str| -> String {
        use sha2::Digest;
        sha2::Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
    };
    let mut forged: serde_json::Value = serde_json::from_str(&head).unwrap();
    forged["files"]["surface.jsonl"] = sum(&edited).into();
    forged.as_object_mut().unwrap().remove("checksum");
    std::fs::write(folder.join("s/surface.json"), forged.to_string()).unwrap();
    let (code, out, _) = maille(folder, &["verify", "s", "--quiet"]);
    assert!(code == Some(4) && !out.contains("was edited") && out.contains("FALSE: rings"), "{out}");
}

/// Limits against the radius, of the records of a study; with one radius there is nothing to draw.
#[test]
fn a_radius_study_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for radius in ["0.05", "0.1"] {
        let map = [
            "characterize",
            "1.1",
            "--minor-radius",
            radius,
            "--directions",
            "0,45",
            "--l2",
            "0",
            "--quiet",
            "--out",
            radius,
        ];
        done(folder, &map);
    }
    done(folder, &["plot", "0.1", "0.05", "--kind", "radius", "-o", "r.svg", "-o", "r.pdf"]);
    let svg = std::fs::read_to_string(folder.join("r.svg")).unwrap();
    assert!(svg.contains(">45°<") && svg.contains("Limit 1 + l₁ against the minor radius"), "{svg}");
    let (code, _, err) = maille(folder, &["plot", "0.1", "--kind", "radius"]);
    assert!(code == Some(2) && err.contains("differ in the minor radius"), "{err}");
    let (code, _, err) = maille(folder, &["plot", "0.1", "--width", "183mm"]);
    assert!(code == Some(2) && err.contains("--style paper"), "{err}");
}
