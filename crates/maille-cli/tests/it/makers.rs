//! What makers ask for: pieces of a size, weaves for a wire, warnings of odd designs, files that are not replaced unasked.

use maille::{lattice::Cell, model::Model};
use serde_json::Value;
use std::{fs, path::Path, process::Command};

struct Ran {
    code: Option<i32>,
    out: String,
    err: String,
}

fn maille(folder: &Path, line: &str) -> Ran {
    let output = Command::new(env!("CARGO_BIN_EXE_maille"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    Ran { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

fn done(folder: &Path, line: &str) -> Ran {
    let ran = maille(folder, line);
    assert_eq!(ran.code, Some(0), "{line}: {}", ran.err);
    ran
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&done(folder, line).out).unwrap()
}

const SHIRT: &str = "new shirt --weave european-4-in-1 --wire 16swg --id 5/16in --quiet";

/// All commands take a size for the same cells, and the print has about that size.
#[test]
fn a_piece_of_a_size_is_the_same_in_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, SHIRT);
    let found = json(folder, "inspect shirt.toml --density steel --size 10x10cm --states --json");
    let piece = &found["piece"];
    assert_eq!((piece["cells"][0].as_u64(), piece["cells"][1].as_u64()), (Some(8), Some(16)));
    assert_eq!(piece["rings"], 256);
    // 256 tori of steel: 2 π² R r² each.
    let (major, minor) = ((7.9375 + 1.6256) / 2.0, 0.8128_f64);
    let kilograms = 256.0 * 2.0 * std::f64::consts::PI.powi(2) * major * minor * minor * 7850e-9;
    assert!((piece["kilograms"].as_f64().unwrap() / kilograms - 1.0).abs() < 1e-9);

    let export = done(folder, "export shirt.toml --size 100x100mm --out s.3mf");
    assert!(export.err.contains("8x16 cells, 100.9 x 101.9 mm with the wire"), "{}", export.err);
    // The box around the tori.
    assert!(export.out.contains("256 rings") && export.out.contains("100.9 × 101.9 × 7.0 mm"), "{}", export.out);
    // Rings of twice the size: 7 rows of cells are 96.6 mm high, 8 would be 108.7.
    let export = done(folder, "export shirt.toml --size 4x4in --scale 2 --out t.3mf");
    assert!(export.out.contains("56 rings") && export.out.contains("106.1 × 96.6"), "{}", export.out);
    let render = done(folder, "render shirt.toml --size 100x100mm --size 64x48 --out s.png");
    assert!(render.out.contains("64 × 48, 256 rings"), "{}", render.out);
    let line = "simulate shirt.toml --size 30x20mm --fix left --pull right=1,0,0 --steps 1 --json";
    assert_eq!(json(folder, line)["tile"], "2x2");

    // Stretched across its rows, the same size needs fewer rings; the width is kept.
    let others = found["piece_of_other_states"].as_array().unwrap();
    let named = |state: &str| others.iter().find(|piece| piece["state"] == state).unwrap();
    let locked = named("locked across the rows");
    assert_eq!((&locked["status"], &locked["cells"][0]), (&Value::from("local"), &Value::from(8)));
    assert!(locked["rings"].as_u64().unwrap() < 200, "{locked}");
    assert!((locked["size_mm"][0].as_f64().unwrap() - 100.0).abs() < 7.0);
    assert!((named("roomiest")["size_mm"][1].as_f64().unwrap() - 100.0).abs() < 4.0);
}

/// The inner diameter that `weaves` names is where `new` begins to accept.
#[test]
fn weaves_names_the_rings_that_new_accepts() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let found = json(folder, "weaves --wire 16swg --json");
    let weaves = found["weaves"].as_array().unwrap();
    assert_eq!(weaves.len(), 7);
    let ratios: Vec<f64> = weaves.iter().map(|w| w["smallest_aspect_ratio"].as_f64().unwrap()).collect();
    assert!(ratios.is_sorted() && (ratios[0] - (1.0 + 2.0_f64.sqrt())).abs() < 1e-4, "{ratios:?}");
    for weave in weaves {
        let (name, above) = (weave["weave"].as_str().unwrap(), weave["inner_diameter_above_mm"].as_f64().unwrap());
        let code = |id: f64| maille(folder, &format!("new x --weave {name} --wire 16swg --id {id}mm -o -")).code;
        assert_eq!((code(above * 0.999), code(above * 1.001)), (Some(2), Some(0)), "{name}");
        // And the other way round.
        let back = json(folder, &format!("weaves --id {above}mm --json"));
        let row = back["weaves"].as_array().unwrap().iter().find(|w| w["weave"] == name).unwrap();
        assert!((row["wire_below_mm"].as_f64().unwrap() - 1.6256).abs() < 1e-9, "{row}");
    }
    let both = json(folder, "weaves --wire 1.6mm --id 7mm --json");
    let fits: Vec<bool> = both["weaves"].as_array().unwrap().iter().map(|w| w["fits"].as_bool().unwrap()).collect();
    assert_eq!(fits, [true, true, true, true, true, false, false]);
    let gap = |weave: &Value| weave["smallest_gap_mm"].as_f64();
    let new = done(folder, "new x --weave european-4-in-1 --wire 1.6mm --id 7mm");
    let written = gap(&both["weaves"][1]).unwrap();
    assert!(new.out.contains(&format!("smallest gap {written:.4} mm")), "{} {written}", new.out);
    assert!(gap(&both["weaves"][6]).is_none());
}

/// Every command that writes a file leaves one that is there as it is, unless it is told to replace it.
#[test]
fn no_file_is_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, SHIRT);
    done(folder, "characterize 1.1 --directions 0 --l2 0 --cell 1x1 --quiet");
    for (line, file) in [
        ("new shirt --weave european-4-in-1 --wire 16swg --id 3/8in", "shirt.toml"),
        ("export 1.1 --tile 1x1 --segments 8 --out a6", "a6.3mf"),
        ("export 1.1 --tile 1x1 --segments 8 --format stl,vtk --out b", "b-poses.vtp"),
        ("render 1.1 --tile 1x1 --size 32x32", "maille-out/1.1.png"),
        ("plot 1.1", "maille-out/polar-1.1.svg"),
        ("table 1.1 -o t.csv", "t.csv"),
        ("schema -o s.json", "s.json"),
        ("roomiest 1.1 --starts 1 --save r.toml", "r.toml"),
        ("tightest european-4-in-1 --starts 2 --save w.toml", "w.toml"),
        ("prove 2 --direction 0 --at-most 9 --out p.proof", "p.proof"),
    ] {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "mine").unwrap();
        let refused = maille(folder, line);
        assert_eq!(refused.code, Some(2), "{line}: {}", refused.err);
        assert!(refused.err.contains(" is there already") && refused.err.contains("--overwrite"), "{}", refused.err);
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine", "{line}");
        done(folder, &format!("{line} --overwrite"));
        assert_ne!(fs::read(&path).unwrap(), b"mine", "{line}");
    }
}

/// Nothing is written of an export that is too large, and a name of another program's format is refused.
#[test]
fn large_exports_and_unknown_endings_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let large = maille(folder, "export 1.1 --tile 200x200 --format stl --out big.stl");
    assert_eq!(large.code, Some(2), "{}", large.err);
    // 120,000 rings of 660 triangles, 50 bytes each.
    assert!(large.err.contains("about 3.96 GB") && large.err.contains("--allow-large"), "{}", large.err);
    done(folder, "export 1.1 --tile 200x200 --out big.3mf --quiet");
    let step = maille(folder, "export 1.1 --out a.step");
    assert!(step.code == Some(2) && step.err.contains("3mf, stl, obj, glb, vtk, ply"), "{}", step.err);
    done(folder, "export 1.1 --tile 1x1 --out wire-1.5mm --quiet");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["big.3mf", "wire-1.5mm.3mf"]);
}

/// The smallest gap in the design's unit and in millimetres, and the clearance of the meshes below it.
#[test]
fn an_export_tells_its_gaps_in_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    let gap = json(folder.path(), "roomiest 1.1 --json")["gap"].as_f64().unwrap();
    let said = done(folder.path(), "export 1.1 --at roomiest --tile 2x2 --scale 5 --out r.3mf");
    let expected = format!("smallest gap between rings: {gap:.6} of the file's unit, here {:.6} mm", 5.0 * gap);
    assert!(said.out.contains(&expected), "{}", said.out);
    let mesh = said.out.lines().find_map(|line| line.strip_prefix("clearance ")).unwrap();
    let mesh: f64 = mesh.split(' ').next().unwrap().parse().unwrap();
    assert!(mesh < 5.0 * gap && mesh > 4.8 * gap, "{mesh}");
    assert!(!said.err.contains("gap 0"), "it is said once: {}", said.err);
    let told = done(folder.path(), "roomiest 1.1").out;
    assert_eq!(told.matches("gap").count(), 2, "as a title and once: {told}");
}

const WEAVE: &str = "name = \"w\"\nunit = \"mm\"\nminor_radius = 0.6\nreference_radius = 6.0\n\
[lattice]\na1 = [15.0, 0.0, 0.0]\na2 = [0.0, 14.0, 0.0]\n\
[[elements]]\nname = \"flat\"\ncenter = [0.0, 0.0, 0.0]\nrings = [{ major_radius = 6.0, normal = [0.0, 0.0, 1.0] }]\n\
[[elements]]\nname = \"along-x\"\ncenter = [7.5, 0.0, 0.0]\nrings = [{ major_radius = 6.0, normal = [0.0, 1.0, 0.0] }]\n";
const ALONG_Y: &str = "[[elements]]\nname = \"along-y\"\ncenter = [0.0, 7.0, 0.0]\nrings = [{ major_radius = 5.0, normal = [1.0, 0.0, 0.0] }]\n";

/// Each odd design has its warning, with the line, and exit code 0; the built-in designs have none.
#[test]
fn check_warns_of_what_is_odd() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = format!("{WEAVE}{ALONG_Y}");
    let far = "[[elements]]\nname = \"far\"\ncenter = [3.0, 3.0, 490.0]\nrings = [{ major_radius = 6.0, normal = [0.0, 0.0, 1.0] }]\n";
    // Two cells, of which one lacks the ring along y: the flat rings have unequal numbers of neighbours.
    let second = WEAVE[WEAVE.find("[[elements]]").unwrap()..]
        .replace("\"flat\"", "\"flat-2\"")
        .replace("\"along-x\"", "\"along-x-2\"")
        .replace("[0.0, 0.0, 0.0]", "[15.0, 0.0, 0.0]")
        .replace("[7.5, 0.0, 0.0]", "[22.5, 0.0, 0.0]");
    let dropped = format!("{whole}{second}").replace("a1 = [15.0", "a1 = [30.0");
    for (name, text, line, words) in [
        ("furlong", whole.replace("\"mm\"", "\"furlong\""), 2, "\"furlong\" is not a known unit"),
        (
            "far",
            format!("{whole}{far}"),
            22,
            "nothing is linked to \"far\"; the nearest ring of another element is 482.8",
        ),
        ("one", WEAVE.to_owned(), 5, "in one direction only, 0.0°"),
        (
            "dropped",
            dropped,
            22,
            "\"flat-2\" has 2 linked neighbours, another element of the same or the mirrored shape has 4",
        ),
    ] {
        fs::write(folder.join(format!("{name}.toml")), &text).unwrap();
        let found = json(folder, &format!("check {name}.toml --json"));
        let warnings = found["files"][0]["warnings"].as_array().unwrap();
        assert_eq!((warnings.len(), &found["files"][0]["ok"]), (1, &Value::Bool(true)), "{name}: {warnings:?}");
        assert!(warnings[0]["problem"].as_str().unwrap().contains(words), "{name}: {warnings:?}");
        assert_eq!(warnings[0]["line"], line, "{name}: {warnings:?}");
        let said = done(folder, &format!("check {name}.toml"));
        assert!(said.err.contains(words) && said.out.contains("OK with 1 warning"), "{} {}", said.err, said.out);
    }
    let names: Vec<&str> = maille_io::builtin_designs().iter().map(|design| design.name).collect();
    let found = json(folder, &format!("check --json {}", names.join(" ")));
    for file in found["files"].as_array().unwrap() {
        assert_eq!(file["warnings"].as_array().unwrap().len(), 0, "{file}");
    }
}

/// The commands whose files one would print say so too, unless they are to be quiet.
#[test]
fn commands_warn_of_a_sheet_that_falls_apart() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("w.toml"), WEAVE).unwrap();
    for line in ["export w.toml --out w.stl", "characterize w.toml --directions 0 --l2 0 --out w"] {
        let said = done(folder, &format!("{line} --overwrite"));
        assert!(said.err.contains("warning: ") && said.err.contains("in one direction only, 0.0°"), "{}", said.err);
        let said = done(folder, &format!("{line} --overwrite --quiet"));
        assert!(!said.err.contains("warning"), "{}", said.err);
    }
}

/// The file of a built-in design is a file like any other: it is the design itself.
#[test]
fn the_file_of_a_built_in_design_is_that_design() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for design in maille_io::builtin_designs() {
        let file = done(folder, &format!("designs --file {}", design.name)).out;
        assert_eq!(file, design.toml);
        fs::write(folder.join("own.toml"), file).unwrap();
        let [own, built_in] = ["own.toml", design.name].map(|of| json(folder, &format!("inspect {of} --json")));
        assert_eq!(own["links"], built_in["links"], "{}", design.name);
    }
}

/// A chain has cells in one direction: it is as long as asked, and one cell wide.
#[test]
fn a_chain_of_a_size_is_one_cell_wide() {
    let folder = tempfile::tempdir().unwrap();
    let said = done(folder.path(), "export cable --size 10x10cm --out c.stl");
    assert!(said.err.contains("x1 cells"), "{}", said.err);
}

/// A number alone is one of millimetres.
#[test]
fn a_clearance_has_a_unit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // The name of the file is as good as that of the design.
    done(folder, "new w.toml --weave european-4-in-1 --wire 1.6mm --id 8mm --quiet");
    let line = "export w.toml --tile 2x2 --out w.stl --overwrite --min-clearance";
    let asked = |clearance: &str| maille(folder, &format!("{line} {clearance}")).code;
    // The gap of the meshes is 0.8 mm.
    assert_eq!(["0.7", "0.7mm", "0.07cm"].map(asked), [Some(0); 3]);
    assert_eq!(["0.9", "0.9mm", "0.09cm"].map(asked), [Some(2); 3]);
    // Pairs of far cells are not looked for: 3 GB, before.
    let far = maille(folder, &format!("{line} 1e308 --warn"));
    let said = "--min-clearance 1e308 mm is more than the largest ring's radius, 4.800 mm";
    assert!(far.code == Some(2) && far.err.contains(said), "{}", far.err);
}

/// Squares whose corners are rounded less than the thickest wire needs: no pair of elements shows it.
#[test]
fn a_wire_that_is_too_thick_for_a_bend_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let said = maille(folder.path(), "tightest squares --set fillet=0.13 --starts 1");
    assert!(
        said.err.contains("elements[0].curves[0].square") && said.err.contains("least radius 0.13"),
        "{}",
        said.err
    );
    let said = maille(folder.path(), "tightest stadium-sheet --starts 1");
    assert!(!said.err.contains("cannot have it"), "{}", said.err);
}

/// An overlap is said once, with a cure, and the cure works.
#[test]
fn rings_that_overlap_are_placed_by_the_cure_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = format!("{WEAVE}{ALONG_Y}").replace("name = \"w\"", "name = \"w\"\nallow_initial_overlap = false");
    let text = text.replace("minor_radius = 0.6", "minor_radius = 1.1").replace("name = \"w\"", "name = \"my w\"");
    fs::write(folder.join("w.toml"), &text).unwrap();
    let refused = maille(folder, "check w.toml");
    assert_eq!((refused.code, refused.err.matches("overlap by").count()), (Some(3), 1), "{}", refused.err);
    assert!(refused.err.contains(" mm in the starting state"), "{}", refused.err);
    assert!(refused.err.contains("maille roomiest w.toml --lattice free --save NEW.toml"), "{}", refused.err);
    fs::write(folder.join("w.toml"), text.replace("overlap = false", "overlap = true")).unwrap();
    done(folder, "roomiest w.toml --lattice free --save new.toml");
    assert!(done(folder, "check new.toml").out.contains("OK;"));
    let saved = fs::read_to_string(folder.join("new.toml")).unwrap();
    assert!(!saved.contains("allow_initial_overlap"), "{saved}");
    assert!(saved.contains("name = \"my-w-roomiest\"") && saved.contains("title = \"my w, widest gaps\""), "{saved}");
    // Of 6: 13 decimals of lengths and 14 of normals, and no -0 or 3e-16.
    let digits = |word: &str| word.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let numbers = saved.split(|c: char| !(c.is_ascii_digit() || ".-e".contains(c)));
    assert!(numbers.clone().all(|n| digits(n) <= 14 && !n.starts_with("-0.0e") && n != "-0.0"), "{saved}");
    let design = maille_io::read_design("new.toml", &saved).unwrap();
    let model = Model::compile(&design, Cell::PRIMITIVE).unwrap();
    assert_eq!(model.links.len(), 4);
}
