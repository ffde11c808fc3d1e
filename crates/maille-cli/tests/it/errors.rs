//! Wrong input, as text: every file of `tests/errors/cli/` is a command line, its exit code and what it says.
//!
//! `MAILLE_BLESS=1` writes exit codes and texts anew; a new case is a file with the one line `$ maille …`.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

const PROGRAM: &str = env!("CARGO_BIN_EXE_maille");

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn maille(folder: &Path, arguments: &[String], input: &str) -> Output {
    let mut child = Command::new(PROGRAM)
        .args(arguments)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("COLUMNS", "100")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A program that ends before it reads is no failure here.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

/// Words of a command line; double quotes hold one together.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().unwrap().push(c),
        }
    }
    words.retain(|w| !w.is_empty());
    words
}

/// What the commands find: designs, a record, damaged records, a folder, a file.
fn prepare(folder: &Path) {
    let copy = |from: &str, to: &str| fs::copy(repository().join(from), folder.join(to)).unwrap();
    copy("tests/errors/negative-minor-radius.toml", "negative.toml");
    copy("tests/errors/syntax-decimal-comma.toml", "comma.toml");
    copy("crates/maille-io/designs/1.1.toml", "mine.toml");
    copy("crates/maille-io/designs/1.2.toml", "other.toml");
    copy("examples/parameters/square.toml", "square.toml");
    let overlapping =
        fs::read_to_string(folder.join("mine.toml")).unwrap().replace("minor_radius = 0.1", "minor_radius = 0.3");
    fs::write(folder.join("overlap.toml"), overlapping).unwrap();
    fs::write(folder.join("no-text.toml"), [0xff, 0xfe, 0x00]).unwrap();
    fs::write(folder.join("a-file"), "not mine\n").unwrap();
    fs::write(folder.join("there.stl"), "not mine\n").unwrap();
    fs::write(folder.join("wrong-study.toml"), "angles = 3\n[[designs]]\ndesign = \"1.1\"\n").unwrap();
    fs::write(folder.join("twice.toml"), "[[designs]]\ndesign = \"1.1\"\n[[designs]]\ndesign = \"mine.toml\"\n")
        .unwrap();
    let apart = fs::read_to_string(folder.join("mine.toml")).unwrap().replace("2.5", "25.0").replace("1.25", "12.5");
    fs::write(folder.join("apart.toml"), apart).unwrap();
    fs::write(folder.join("wanted.csv"), "direction_deg,l1\n0,0.4\n").unwrap();
    fs::write(folder.join("wrong-wanted.csv"), "# a profile\ndirection_deg,l1\n0,0.4\n45,0,6\n").unwrap();
    fs::write(folder.join("column-wanted.csv"), "direction,l1\n0,0.4\n").unwrap();
    fs::write(folder.join("cut.proof"), "{\"maille_proof\":1}\n/ 3\n").unwrap();
    fs::create_dir(folder.join("a-folder")).unwrap();
    fs::write(folder.join("a-folder/letter.txt"), "dear reader\n").unwrap();
    fs::create_dir(folder.join("empty-folder")).unwrap();
    let solve = "characterize mine.toml --directions 0,45 --l2 0 --out record --quiet";
    let done = maille(folder, &words(solve), "");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let sheet = "simulate mine.toml --tile 1x1 --gravity 0,0,-1 --floor -3 --out sheet --frames sheet-frames --quiet";
    let done = maille(folder, &words(sheet), "");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    for (damaged, file) in [("cut-record", "states.jsonl"), ("edited-record", "run.json")] {
        fs::create_dir(folder.join(damaged)).unwrap();
        for entry in fs::read_dir(folder.join("record")).unwrap() {
            let entry = entry.unwrap();
            fs::copy(entry.path(), folder.join(damaged).join(entry.file_name())).unwrap();
        }
        let path = folder.join(damaged).join(file);
        let text = fs::read_to_string(&path).unwrap();
        let text = match file {
            "run.json" => text.replace("\"exact\"", "\"guess\""),
            _ => text[..text.len() / 2].to_owned(),
        };
        fs::write(&path, text).unwrap();
    }
}

#[test]
fn wrong_input_says_what_to_do_next() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let cases = repository().join("tests/errors/cli");
    let mut names: Vec<PathBuf> = fs::read_dir(&cases).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    // With the viewer, its command serves until it is stopped.
    names.retain(|path| !(cfg!(feature = "view") && path.ends_with("view-without-viewer.txt")));
    assert!(names.len() >= 40, "{}", names.len());
    let mut wrong = Vec::new();
    for path in &names {
        let expected = fs::read_to_string(path).unwrap();
        let command =
            expected.lines().next().unwrap().strip_prefix("$ maille ").expect("the first line is the command");
        let (arguments, input) = command.split_once(" < ").unwrap_or((command, ""));
        let ran = maille(folder.path(), &words(arguments), &input.replace("\\n", "\n"));
        let said = String::from_utf8(ran.stderr).unwrap();
        let lines: Vec<&str> = said.lines().map(str::trim_end).collect();
        let code = ran.status.code().unwrap();
        let found = format!("$ maille {command}\nexit code {code}\n\n{}\n", lines.join("\n").trim_matches('\n'));
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(code != 0 && code != 1 || name.starts_with("unwritable"), "{name}: exit code {code}");
        assert!(!found.contains('\u{1b}'), "{name} has colours");
        if std::env::var_os("MAILLE_BLESS").is_some() {
            fs::write(path, &found).unwrap();
        } else if found != expected {
            eprintln!("--- {name}: expected\n{expected}--- found\n{found}");
            wrong.push(name.to_owned());
        }
    }
    assert!(wrong.is_empty(), "{wrong:?} differ; if the new texts are better, run again with MAILLE_BLESS=1");
    // Nothing that failed has left a file behind.
    let left: Vec<String> =
        fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    assert!(left.iter().all(|name| !name.starts_with(".maille") && !name.starts_with("new-")), "{left:?}");
    assert_eq!(fs::read_to_string(folder.path().join("a-file")).unwrap(), "not mine\n");
}
