//! The program as scripts and people use it: pipes, JSON, exit codes, `--watch`, completions and manual pages.

use serde_json::Value;
use std::{
    collections::BTreeSet,
    fs,
    io::Write,
    path::Path,
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};

fn maille(folder: &Path, line: &str, input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_maille"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    child.wait_with_output().unwrap()
}

fn done(folder: &Path, line: &str, input: &[u8]) -> Vec<u8> {
    let output = maille(folder, line, input);
    assert_eq!(output.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_slice(&done(folder, line, b"")).unwrap()
}

#[test]
fn a_new_design_goes_through_pipes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let design = done(folder, "new shirt --weave european-6-in-1 --wire 16swg --id 3/8in -o -", b"");
    assert!(!String::from_utf8_lossy(&design).contains("#:schema"), "there is no schema beside standard output");
    assert!(done(folder, "check -", &design).starts_with(b"-: OK; 2 rings, 6 links per cell"));
    assert!(String::from_utf8_lossy(&done(folder, "inspect -", &design)).contains("6 interlocking neighbours"));
    let stl = done(folder, "export - --tile 1x1 --format stl --out - --quiet", &design);
    let triangles = u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize;
    assert_eq!(stl.len(), 84 + 50 * triangles);
    assert!(done(folder, "export - --tile 1x1 --out - --quiet", &design).starts_with(b"PK"));
    let png = done(folder, "render - --tile 1x1 --size 64x48 --out -", &design);
    assert!(png.starts_with(b"\x89PNG"));
    assert_eq!(fs::read_dir(folder).unwrap().count(), 0, "nothing was written");
}

#[test]
fn a_new_design_names_the_schema_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, "new cuff --weave japanese-8-in-2 --wire 1.2mm --id 8mm -o sub/cuff.toml", b"");
    let text = fs::read_to_string(folder.join("sub/cuff.toml")).unwrap();
    let schema = text.lines().next().unwrap().strip_prefix("#:schema ").unwrap();
    assert_eq!(fs::read(folder.join("sub").join(schema)).unwrap(), done(folder, "schema", b""));
    done(folder, "new cuff --weave kings-mail --major 6 --minor 0.5 --no-schema", b"");
    assert!(fs::read_to_string(folder.join("cuff.toml")).unwrap().starts_with("# King's mail"));
    assert_eq!(maille(folder, "new cuff --weave kings-mail --major 6 --minor 0.5", b"").status.code(), Some(2));
    done(folder, "new cuff --weave kings-mail --major 6 --minor 0.4 --overwrite --quiet", b"");
}

/// The rings that are written have the wire and the inner diameter that were asked for.
#[test]
fn a_new_design_has_the_inner_diameter_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("--wire 16swg --id 5/16in", 1.6256, 7.9375),
        ("--wire 1.6mm --id 17/64in", 1.6, 6.746875),
        ("--wire 0.041in --id 1/4in", 1.0414, 6.35),
        ("--wire 18awg --id 6mm", 1.0237, 6.0),
    ];
    for (size, wire, inner) in cases {
        let text = done(folder.path(), &format!("new shirt --weave european-4-in-1 {size} -o -"), b"");
        let text = String::from_utf8(text).unwrap();
        let value = |key: &str| -> f64 {
            let line = text.lines().find(|line| line.starts_with(&format!("{key} = "))).unwrap();
            line.rsplit(' ').next().unwrap().parse().unwrap()
        };
        let (major, minor) = (value("reference_radius"), value("minor_radius"));
        assert!((2.0 * minor - wire).abs() < 1e-12, "{size}: {text}");
        assert!((2.0 * (major - minor) - inner).abs() < 1e-12, "{size}: {text}");
    }
}

/// 1.1 in steel: three rings of R = 1 mm and r = 0.1 mm on 2.5 mm by 2.5 mm.
#[test]
fn wire_and_weight_are_those_of_tori() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../maille-io/designs/1.1.toml")).unwrap();
    fs::write(folder.path().join("mm.toml"), text.replace("minor_radius = 0.1", "minor_radius = 0.1\nunit = \"mm\""))
        .unwrap();
    let found = json(folder.path(), "inspect mm.toml --json --density 7.85g/cm3");
    let number = |key: &str| found["wire"][key].as_f64().unwrap();
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    let pi = std::f64::consts::PI;
    near(number("length"), 6.0 * pi);
    near(number("length_per_area"), 6.0 * pi / 6.25);
    near(number("metres_per_square_metre"), 6.0 * pi / 6.25 * 1000.0);
    // 2 π² R r² of metal a ring, in cubic millimetres, on 6.25 square millimetres.
    near(number("kilograms_per_square_metre"), 3.0 * 2.0 * pi * pi * 0.01 / 6.25 * 7.85);
    assert!(json(folder.path(), "inspect 1.1 --json")["wire"]["metres_per_square_metre"].is_null());
}

fn keys(value: &Value, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| {
            into.insert(key.clone());
            keys(value, into);
        }),
        Value::Array(list) => list.iter().for_each(|value| keys(value, into)),
        _ => {}
    }
}

#[test]
fn every_key_of_the_json_output_is_documented() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let documented = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/json.md")).unwrap();
    let summary = json(folder, "characterize 1.1 --directions 0,45 --l2 0 --json");
    assert_eq!(summary["statuses"]["global"], 2);
    assert!((summary["limits"][0]["largest"]["l1"].as_f64().unwrap() - 0.774_034_949).abs() < 1e-8);
    let check = maille(folder, "check 1.1 missing.toml --json", b"");
    assert_eq!(check.status.code(), Some(3));
    let check: Value = serde_json::from_slice(&check.stdout).unwrap();
    assert_eq!((&check["files"][0]["ok"], &check["files"][1]["ok"]), (&Value::Bool(true), &Value::Bool(false)));
    let mut found = BTreeSet::new();
    keys(&json(folder, "designs --json"), &mut found);
    keys(&json(folder, "inspect 1.1 --json"), &mut found);
    keys(&json(folder, "roll european-4-in-1 --directions 0 --axis below --json"), &mut found);
    keys(&check, &mut found);
    keys(&json(folder, "verify 1.1 --json --quiet"), &mut found);
    let mut summary = summary;
    summary["statuses"] = Value::Null; // its keys are the statuses of docs/record.md
    keys(&summary, &mut found);
    let missing: Vec<&String> = found.iter().filter(|key| !documented.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn limits_that_are_not_found_have_an_exit_code_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    // Proved not to be there: an answer.
    let proved = maille(folder.path(), "characterize 1.1 --directions 45 --l2 2 --quiet --out proved", b"");
    assert_eq!(proved.status.code(), Some(0), "{}", String::from_utf8_lossy(&proved.stderr));
    assert!(fs::read_to_string(folder.path().join("proved/limits.csv")).unwrap().contains("l2-unreachable"));
    // Beyond what the sheet can do: the energy method fails to reach it, and proves nothing.
    let open =
        maille(folder.path(), "characterize 1.1 --method energy --directions 0 --l2 1.5 --quiet --out open", b"");
    let table = fs::read_to_string(folder.path().join("open/limits.csv")).unwrap();
    assert_eq!(open.status.code(), Some(5), "{table}");
    let replayed = maille(folder.path(), "replay open", b"");
    assert_eq!(replayed.status.code(), Some(0), "{}", String::from_utf8_lossy(&replayed.stdout));
}

/// One of the usual l2 may be more than a sheet can reach; one that was asked for is a hole in the table.
#[test]
fn an_l2_that_nobody_asked_for_may_be_out_of_reach() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, "new shirt --weave european-4-in-1 --wire 16swg --id 5/16in", b"");
    let said = done(folder, "characterize shirt.toml --cell 1x1 --directions 90", b"");
    assert!(String::from_utf8_lossy(&said).contains("1 l2-not-reached"));
    let asked = maille(folder, "characterize shirt.toml --cell 1x1 --directions 90 --l2 0.25 --out asked", b"");
    assert_eq!(asked.status.code(), Some(5));
    // A free width is no l2 of the usual list. Along 30° the search finds a state, and no certificate.
    let line = "characterize european-4-in-1 --lateral free --directions 30 --cell 1x1 --starts 1 --out free";
    let free = maille(folder, line, b"");
    assert_eq!(free.status.code(), Some(5));
    assert!(String::from_utf8_lossy(&free.stdout).contains("1 uncertified"), "{free:?}");
    let table = String::from_utf8(done(folder, "table free --columns l1_uncertified --format csv", b"")).unwrap();
    let l1: f64 = table.lines().nth(1).unwrap().parse().unwrap();
    assert!((l1 - 0.063837).abs() < 1e-5, "{table}");
}

#[test]
fn watch_runs_again_when_the_file_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../maille-io/designs/1.1.toml")).unwrap();
    fs::write(&path, &text).unwrap();
    let log = folder.path().join("log");
    let mut child = Command::new(env!("CARGO_BIN_EXE_maille"))
        .args(["check", "--watch", "mine.toml"])
        .current_dir(folder.path())
        .stdout(fs::File::create(&log).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let wait_for = |runs: usize| {
        while fs::read_to_string(&log).unwrap().matches("mine.toml: OK").count() < runs {
            assert!(begun.elapsed() < Duration::from_secs(60), "{}", fs::read_to_string(&log).unwrap());
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    wait_for(1);
    // As editors save: under another name, then renamed.
    let other = folder.path().join("mine.toml~");
    fs::write(&other, text.replace("minor_radius = 0.1", "minor_radius = 0.12")).unwrap();
    fs::rename(&other, &path).unwrap();
    wait_for(2);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(fs::read_to_string(&log).unwrap().contains("smallest gap 0.113553"));
}

#[test]
fn shells_and_man_know_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let help = String::from_utf8(done(folder.path(), "--help", b"")).unwrap();
    let commands: Vec<&str> = help
        .lines()
        .skip_while(|l| *l != "Designs:")
        .take_while(|l| *l != "Options:")
        .filter(|l| l.starts_with("  "))
        .filter_map(|l| l.split_whitespace().next())
        .filter(|c| *c != "help")
        .collect();
    assert!(commands.len() >= 11, "{commands:?}");
    done(folder.path(), "man pages", b"");
    let again = maille(folder.path(), "man pages", b"");
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("is there already"));
    done(folder.path(), "man pages --overwrite", b"");
    let bash = String::from_utf8(done(folder.path(), "completions bash", b"")).unwrap();
    for shell in ["zsh", "fish", "elvish", "powershell"] {
        assert!(!done(folder.path(), &format!("completions {shell}"), b"").is_empty());
    }
    for command in commands {
        assert!(bash.contains(command), "{command}");
        let page = fs::read_to_string(folder.path().join(format!("pages/maille-{command}.1"))).unwrap();
        assert!(page.contains(".SH NAME"), "{command}");
        let text = String::from_utf8(done(folder.path(), &format!("{command} --help"), b"")).unwrap();
        assert!(text.contains("Examples:"), "{command} --help has no examples");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    for line in ["designs", "inspect 5.2", "check 1.1 1.2 1.3", "schema", "completions bash"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_maille"))
            .args(line.split_whitespace())
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), output.stderr.is_empty()), (Some(0), true), "{line}");
    }
}

/// Along a chain of Japanese 4-in-1 and 6-in-1 a period holds two rings, pulled until each touches the next inside:
/// 4 (R − r).
#[test]
fn japanese_weaves_lock_along_their_chains_where_the_closed_form_says() {
    let folder = tempfile::tempdir().unwrap();
    for weave in ["japanese-4-in-1", "japanese-6-in-1"] {
        let design = json(folder.path(), &format!("inspect {weave} --json"));
        let ring = &design["elements"][0]["rings"][0];
        let [major, minor] = ["major_radius", "minor_radius"].map(|key| ring[key].as_f64().unwrap());
        let expected = 4.0 * (major - minor) / design["a1"][0].as_f64().unwrap() - 1.0;
        let found = json(folder.path(), &format!("characterize {weave} --directions 0 --l2 0 --json"));
        let l1 = found["limits"][0]["largest"]["l1"].as_f64().unwrap();
        assert!((l1 - expected).abs() < 1e-9, "{weave}: {l1}, not {expected}");
        assert_eq!(found["statuses"]["global"], 1);
    }
}

/// A finite sheet is pulled until it locks; its frames are exported and drawn.
#[test]
fn a_simulated_sheet_is_exported_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = "simulate 1.1 --tile 2x1 --fix left --pull right=3,0,0 --steps 3 -o run --frames all --json";
    let said = json(folder, line);
    assert_eq!((said["outcome"]["end"].as_str(), said["elements"].as_u64()), (Some("locked"), Some(6)));
    // Three links of 1.8 where 3.75 was: 1.65 of the 3.
    let share = said["outcome"]["share"].as_f64().unwrap();
    assert!((3.0 * share - 1.65).abs() < 0.01, "{share}");
    assert_eq!(said["outcome"]["links_ok"], Value::Bool(true));
    let lines = |name: &str| fs::read_to_string(folder.join(name)).unwrap().lines().count();
    // A row for each frame; the two edges pull against each other.
    assert_eq!(lines("run/forces.csv"), 1 + lines("run/frames.jsonl"));
    assert!(!folder.join("all/forces.csv").exists());
    let table = fs::read_to_string(folder.join("run/forces.csv")).unwrap();
    let (header, last) = (table.lines().next().unwrap(), table.lines().last().unwrap());
    let cell = |name: &str| -> f64 {
        let at = header.split(',').position(|column| column == name).unwrap();
        last.split(',').nth(at).unwrap().parse().unwrap()
    };
    assert!((cell("stretch") - 1.44).abs() < 1e-3 && said["stretch"] == cell("stretch"));
    assert!(cell("mean_force") > 0.1 && said["mean_force"] == cell("mean_force"), "{table}");
    assert_eq!(said["reactions"]["right"][0], cell("force_right_x"));
    assert!((cell("force_left_x") + cell("force_right_x")).abs() < 1e-2);
    assert!(lines("all/frames.jsonl") > lines("run/frames.jsonl") && lines("run/frames.jsonl") >= 3);
    done(folder, "export --from all --format vtk --frames 5 --out vtk/ --quiet", b"");
    let series = fs::read_dir(folder.join("vtk")).unwrap().map(|e| e.unwrap().path());
    let pvd: Vec<_> = series.filter(|p| p.extension().is_some_and(|e| e == "pvd")).collect();
    assert_eq!(pvd.len(), 2);
    assert_eq!(fs::read_to_string(&pvd[0]).unwrap().matches("<DataSet").count(), 5);
    let draw = |frame: usize| done(folder, &format!("render --from run --at frame={frame} --size 96x72 --out -"), b"");
    assert!(draw(0).starts_with(b"\x89PNG") && draw(0) != draw(2));
    // A film of all states is not named after one of them.
    done(folder, "render --from run --frames 3 --size 48x36 --quiet", b"");
    assert!(folder.join("maille-out/1.1-simulate.gif").is_file());
    // Six rings, not a tile of the periodic sheet.
    let text = String::from_utf8(done(folder, "export --from run --format obj --out -", b"")).unwrap();
    assert_eq!(text.lines().filter(|l| l.starts_with("g ") || l.starts_with("o ")).count(), 6, "{}", &text[..400]);
}

/// The thickest wire is a design again, and there is no room left in it.
#[test]
fn the_tightest_state_is_saved_as_a_design() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let answer = json(folder, "tightest european-4-in-1 --starts 2 --save tight.toml --json");
    let ratio = answer["sizes"][0]["aspect_ratio"].as_f64().unwrap();
    assert!((ratio - 2.980927).abs() < 1e-6, "{ratio}");
    assert_eq!((answer["status"].as_str(), answer["links_ok"].as_bool()), (Some("local"), Some(true)));
    let gap = json(folder, "roomiest tight.toml --lattice free --starts 2 --json")["gap"].as_f64().unwrap();
    assert!((0.0..1e-6).contains(&gap), "{gap}");
    assert!(done(folder, "render tight.toml --tile 2x2 --size 64x48 --out -", b"").starts_with(b"\x89PNG"));
}

/// The mesh of `--at roomiest` has the smallest gap that `roomiest` prints, measured between the mesh's own vertices.
#[test]
fn the_roomiest_state_is_exported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for lattice in ["fixed", "free"] {
        let told = json(folder, &format!("roomiest 1.1 --lattice {lattice} --json"))["gap"].as_f64().unwrap();
        let line = format!(
            "export 1.1 --at roomiest --lattice {lattice} --tile 2x2 --segments 64x24 --format obj --out - --quiet"
        );
        let obj = String::from_utf8(done(folder, &line, b"")).unwrap();
        let gap = smallest_distance(&rings(&obj));
        // Vertices next to the closest points are at most half a facet away: 0.055 around either ring, 0.013 across.
        let (coarse, aside) = (2.0 * (1.1 * 1.2e-3 + 0.1 * 8.6e-3), 2.0 * 0.057);
        let most = (told + coarse).hypot(aside);
        assert!(gap >= told - coarse && gap <= most, "{lattice}: {gap} of {told}");
        // Clearly wider than the start, so it is another state.
        let start =
            String::from_utf8(done(folder, &line.replace(&format!("--at roomiest --lattice {lattice} "), ""), b""));
        assert!(smallest_distance(&rings(&start.unwrap())) < 0.9 * told);
    }
    // The same state, by the exporter's own measure of fine meshes: 1 mm a unit.
    let told = json(folder, "roomiest european-4-in-1 --json")["gap"].as_f64().unwrap();
    let export = |clearance: f64| {
        let line = format!(
            "export european-4-in-1 --at roomiest --tile 2x2 --tolerance 0.001 --out e.stl --overwrite --min-clearance {clearance:.12}"
        );
        maille(folder, &line, b"").status.code()
    };
    assert_eq!((export(told - 2.1e-3), export(told + 2.1e-3)), (Some(0), Some(2)));
    done(folder, "render 1.1 --at roomiest --tile 1x1 --size 64x48 --out r.png --quiet", b"");
    assert!(folder.join("r.png").is_file());
}

/// What is printed is the mesh: chords across the bore of a ring lie outside its torus. The distances are those that another
/// program (manifold3d) measured on the files.
#[test]
fn the_clearance_is_that_of_the_mesh_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, "new thr --weave european-4-in-1 --wire 1.6mm --id 6.1mm --quiet", b"");
    let export = |more: &str| {
        let line = format!("export thr.toml --tile 2x2 --out thr.stl --overwrite --quiet {more}");
        let output = maille(folder, &line, b"");
        let said = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        (output.status.code(), said)
    };
    for (segments, least, shown) in
        [("", 0.3249, "0.325 mm"), ("--segments 12x6", 0.204, "0.204 mm"), ("--segments 8", 0.073, "0.0")]
    {
        assert_eq!(export(&format!("{segments} --min-clearance {}", least - 6e-4)).0, Some(0), "{segments}");
        assert_eq!(export(&format!("{segments} --min-clearance {}", least + 6e-4)).0, Some(2), "{segments}");
        let (code, said) = export(&format!("{segments} --min-clearance 0.334"));
        assert_eq!(code, Some(2));
        assert!(said.contains(&format!("are {shown}")) && said.contains("as meshes, 0.334 mm as tori"), "{said}");
        // What is said to help does; of a clearance that is not asked to the last facet.
        let (_, said) = export(&format!("{segments} --min-clearance 0.33"));
        let advised = said.split("--segments ").nth(1).unwrap().split(' ').next().unwrap();
        assert_eq!(export(&format!("--segments {advised} --min-clearance 0.33")).0, Some(0), "{advised}");
        let scale = said.split("--scale ").nth(1).unwrap().split(' ').next().unwrap();
        assert_eq!(export(&format!("{segments} --scale {scale} --min-clearance 0.33")).0, Some(0), "{scale}");
    }
    let said =
        String::from_utf8(done(folder, "export thr.toml --tile 2x2 --out thr.stl --overwrite --scale 2", b"")).unwrap();
    assert!(said.contains("clearance 0.650 mm between the meshes"), "{said}");
}

/// Vertices of each ring of an OBJ file.
fn rings(obj: &str) -> Vec<Vec<[f64; 3]>> {
    let mut rings: Vec<Vec<[f64; 3]>> = Vec::new();
    for line in obj.lines() {
        match line.split_once(' ') {
            Some(("o" | "g", _)) => rings.push(Vec::new()),
            Some(("v", numbers)) => {
                let mut numbers = numbers.split_whitespace().map(|x| x.parse().unwrap());
                rings.last_mut().unwrap().push(std::array::from_fn(|_| numbers.next().unwrap()));
            }
            _ => {}
        }
    }
    assert!(rings.len() > 2);
    rings
}

/// By one walk over all vertices in the order of x.
fn smallest_distance(rings: &[Vec<[f64; 3]>]) -> f64 {
    let mut all: Vec<(usize, [f64; 3])> =
        rings.iter().enumerate().flat_map(|(ring, vertices)| vertices.iter().map(move |v| (ring, *v))).collect();
    all.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
    let mut least_sq = f64::INFINITY;
    for (k, (ring, a)) in all.iter().enumerate() {
        for (other, b) in &all[k + 1..] {
            let along_sq = (b[0] - a[0]).powi(2);
            if along_sq >= least_sq {
                break;
            }
            if other != ring {
                least_sq = least_sq.min(along_sq + (b[1] - a[1]).powi(2) + (b[2] - a[2]).powi(2));
            }
        }
    }
    least_sq.sqrt()
}
