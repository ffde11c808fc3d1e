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
        done(folder, &["plot", "a", "1.2", "--kind", kind, "-o", "x.svg", "-o", &png]);
        assert!(text("x.svg").contains(">1.1 and 1.2<") && text("x.svg").contains(">1.2<"), "{kind}");
        assert!(std::fs::read(folder.join(png)).unwrap().starts_with(b"\x89PNG"));
    }
    done(folder, &["plot", "a", "--where", "l2=0", "--quantity", "l1", "-o", "x.svg"]);
    assert!(!text("x.svg").contains(">−0.25<"));

    let wrong = |arguments: &[&str]| {
        let (code, _, err) = maille(folder, arguments);
        assert_eq!(code, Some(2), "{err}");
        err
    };
    assert!(wrong(&["plot", "a", "-o", "x.pdf"]).contains(".svg or .png"));
    assert!(wrong(&["plot", "a", "--where", "l2=7"]).contains("no row is left"));
    assert!(wrong(&["plot", "a", "--kind", "steps", "--quantity", "l1"]).contains("no --quantity"));
}
