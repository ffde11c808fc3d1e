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
        .args(["reproduce", "--designs", "1.1", "--quick", "--quiet", "--threads", "2", "--out"])
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
