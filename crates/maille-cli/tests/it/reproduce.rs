//! `maille reproduce`, killed and started again.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Child, Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

fn start(out: &Path) -> Child {
    Command::new(env!("CARGO_BIN_EXE_maille"))
        .args(["reproduce", "--only", "1.1", "--quick", "--quiet", "--threads", "2", "--out"])
        .arg(out)
        .stderr(Stdio::inherit())
        .spawn()
        .unwrap()
}

/// Rows that are in the records.
fn rows(out: &Path) -> usize {
    let tables = fs::read_dir(out.join("records")).into_iter().flatten().map(|e| e.unwrap().path().join("limits.csv"));
    tables.filter_map(|table| fs::read_to_string(table).ok()).map(|text| text.lines().count() - 1).sum()
}

/// Every file by its name, tables without wall times and run.json without their checksums; what shows times is left out.
fn files(folder: &Path, below: &str, into: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{below}/{}", entry.file_name().into_string().unwrap());
        let path = entry.path();
        if path.is_dir() {
            files(&path, &name, into);
        } else if !["index.html", "6.1-times"].iter().any(|times| name.contains(times)) {
            let content = match name.rsplit('/').next() {
                Some("run.json") => text(&path).split("\"files\"").next().unwrap().to_owned(),
                _ if name.ends_with(".csv") => without_times(&path),
                _ if name.contains("-steps/") => continue,
                _ => text(&path),
            };
            into.insert(name, content);
        }
    }
}

fn text(path: &Path) -> String {
    let bytes = fs::read(path).unwrap();
    String::from_utf8(bytes).unwrap_or_else(|e| format!("{:?}", e.as_bytes()))
}

fn without_times(table: &Path) -> String {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let at = reader.headers().unwrap().iter().position(|name| name == "wall_s").unwrap();
    let row = |row: csv::StringRecord| {
        row.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, c)| format!("{c};")).collect()
    };
    reader.records().map(|r| row(r.unwrap())).collect::<Vec<String>>().join("\n")
}

#[test]
fn killed_runs_go_on_to_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, killed) = (folder.path().join("whole"), folder.path().join("killed"));
    assert_eq!(start(&whole).wait().unwrap().code(), Some(0));
    let all = rows(&whole);
    let mut kept = 0;
    for _ in 0..3 {
        let mut run = start(&killed);
        let begun = Instant::now();
        while rows(&killed) <= kept && begun.elapsed() < Duration::from_secs(60) && run.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(5));
        }
        run.kill().unwrap();
        run.wait().unwrap();
        let left = rows(&killed);
        assert!(left >= kept, "{left} of {kept} rows are left");
        kept = left;
    }
    assert!(0 < kept && kept < all, "the runs were killed with {kept} of {all} limits");
    assert!(!killed.join("index.html").exists());
    // A run that is killed while it writes leaves this.
    fs::create_dir(killed.join("figures")).unwrap();
    fs::write(killed.join("figures/.maille-1.tmp"), "half").unwrap();
    assert_eq!(start(&killed).wait().unwrap().code(), Some(0));
    assert_eq!(rows(&killed), all);
    let (mut a, mut b) = (BTreeMap::new(), BTreeMap::new());
    files(&whole, "", &mut a);
    files(&killed, "", &mut b);
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, text) in &a {
        assert!(*text == b[name], "{name} differs");
    }
    // The page fetches nothing, and has what it shows in itself.
    let page = fs::read_to_string(killed.join("index.html")).unwrap();
    for foreign in ["src=\"http", "href=\"http", "<script", "<link", "url(", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    assert!(
        page.contains("Statement 9") && page.contains("data:image/png;base64,") && page.matches("<svg").count() > 5
    );
    assert!(fs::read_to_string(killed.join("statements.json")).unwrap().contains("\"holds\""));
}

/// A folder of one's own coordinates: those are taken, the others are built in, and the page says which.
#[test]
fn own_coordinates_take_the_place_of_ours() {
    let folder = tempfile::tempdir().unwrap();
    let (own, out) = (folder.path().join("own"), folder.path().join("out"));
    fs::create_dir(&own).unwrap();
    let text = maille_io::builtin("1.1").unwrap().replace("name = \"1.1\"", "name = \"mine\"");
    fs::write(own.join("1.1.toml"), &text).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_maille"));
        command.args(["reproduce", "--quick", "--quiet", "--threads", "2", "--designs"]).arg(&own);
        command.args(arguments).output().unwrap()
    };
    let done = run(&["--only", "1.1,1.2", "--out", out.to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let spacing = |name: &str| {
        let run = text_of(&out.join("records").join(name).join("run.json"));
        let run: serde_json::Value = serde_json::from_str(&run).unwrap();
        (run["design"]["name"].clone(), run["design"]["lattice"]["a1"][0].as_f64().unwrap())
    };
    assert_eq!(spacing("1.1-R10-exact"), ("1.1".into(), 2.5));
    assert_eq!(spacing("1.2-R20-exact"), ("1.2".into(), 2.06));
    let page = text_of(&out.join("index.html"));
    assert!(page.contains("Given were 1.1; the coordinates of the others are ours."));
    assert!(page.contains(&format!("given: {}", own.join("1.1.toml").display())));
    // What is no design of the chapter is refused before anything is solved.
    fs::write(own.join("1.4.toml"), &text).unwrap();
    let refused = run(&[]);
    let words = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && words.contains("1.4.toml is not a design of chapter 6"), "{words}");
    fs::remove_file(own.join("1.4.toml")).unwrap();
    fs::remove_file(own.join("1.1.toml")).unwrap();
    let refused = run(&[]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("has no design of chapter 6"));
}

fn text_of(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}
