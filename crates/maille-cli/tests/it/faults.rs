//! Runs that are killed, refused by the disk or meet another run: nothing is lost but what was in work, nothing is half
//! written, and the same command goes on. `validation/kills.py` does the first two hundred times.

use serde_json::{Map, Value};
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output, Stdio},
    thread::sleep,
    time::Duration,
};

const STUDY: &str = "directions = [0, 30, 45]\nl2 = [-0.125, 0]\ncell = \"1x1\"\n[[designs]]\ndesign = \"1.1\"\n\
                     minor_radius = [0.05, 0.1]\n";
/// Commands that go on where they were stopped.
const COMMANDS: [&str; 5] = [
    "characterize 1.1 --directions 0:90:10 --l2=-0.25,-0.125,0 --cell 1x1 --out out --quiet",
    "sweep study.toml --out out --quiet",
    "boundary european-4-in-1 --vertices 162 --tolerance 0.5 --starts 1 --out out --quiet",
    "roll european-4-in-1 --directions 0:90:30 --axis below --effort low --out out --quiet",
    "simulate 1.1 --tile 2x2 --fix left --pull right=3,0,0 --gravity 0,0,-1 --floor -3 --frames out/all --out out --quiet",
];

fn command(folder: &Path, line: &str) -> Command {
    fs::write(folder.join("study.toml"), STUDY).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_maille"));
    command.args(line.split_whitespace()).current_dir(folder).env("NO_COLOR", "1").env("COLUMNS", "400");
    command
}

fn maille(folder: &Path, line: &str) -> Output {
    command(folder, line).output().unwrap()
}

/// The exit code and what was said.
fn said(output: &Output) -> (i32, String) {
    let text = [&output.stderr[..], &output.stdout].map(String::from_utf8_lossy).concat();
    (output.status.code().unwrap_or_else(|| panic!("{text}")), text)
}

/// All files but for times: tables and rolls without `wall_s`, run.json and roll.json without checksums, boundary's journal in an order.
fn files(folder: &Path, below: &str, into: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = format!("{below}/{}", entry.file_name().into_string().unwrap());
        if entry.path().is_dir() {
            files(&entry.path(), &name, into);
            continue;
        }
        let text = String::from_utf8_lossy(&fs::read(entry.path()).unwrap()).into_owned();
        let text = match name.rsplit('/').next().unwrap() {
            "run.json" | "roll.json" => text.split("\"files\"").next().unwrap().to_owned(),
            "boundary.jsonl" => {
                let mut lines: Vec<_> = text.lines().collect();
                lines.sort_unstable();
                lines.join("\n")
            }
            "limits.csv" | "rolls.csv" => timeless(&text),
            "rolls.jsonl" => {
                let mut lines: Vec<_> = text.lines().map(timeless_line).collect();
                lines.sort_unstable();
                lines.join("\n")
            }
            _ => text,
        };
        into.insert(name, text);
    }
}

fn timeless(table: &str) -> String {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let at = reader.headers().unwrap().iter().position(|name| name == "wall_s").unwrap();
    let row = |row: csv::StringRecord| {
        row.iter().enumerate().filter(|(k, _)| *k != at).map(|c| c.1.to_owned() + ";").collect()
    };
    reader.records().map(|r| row(r.unwrap())).collect::<Vec<String>>().join("\n")
}

/// A line that was cut is itself.
fn timeless_line(line: &str) -> String {
    let Ok(mut object) = serde_json::from_str::<Map<String, Value>>(line) else { return line.to_owned() };
    object.retain(|key, _| key != "wall_s" && key != "sum");
    Value::from(object).to_string()
}

fn all(folder: &Path) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    files(&folder.join("out"), "", &mut found);
    found
}

fn same(found: &BTreeMap<String, String>, whole: &BTreeMap<String, String>, words: &str) {
    assert_eq!(found.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>(), "{words}");
    for (name, text) in found {
        assert!(*text == whole[name], "{words}: {name} differs");
    }
}

fn whole(line: &str) -> BTreeMap<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let (code, text) = said(&maille(folder.path(), line));
    assert!([0, 5].contains(&code), "{line}: {text}");
    all(folder.path())
}

#[test]
fn whatever_is_killed_goes_on_to_the_same_files() {
    for line in COMMANDS {
        let whole = whole(line);
        let folder = tempfile::tempdir().unwrap();
        for wait in [1, 10, 40, 90, 25] {
            let mut run = command(folder.path(), line).stderr(Stdio::inherit()).spawn().unwrap();
            sleep(Duration::from_millis(wait));
            run.kill().unwrap();
            run.wait().unwrap();
            if folder.path().join("out/run.json").exists() {
                let (code, text) = said(&maille(folder.path(), "verify out --quiet"));
                assert!([0, 5].contains(&code), "{line}: {text}");
            }
        }
        let (code, text) = said(&maille(folder.path(), line));
        assert!([0, 5].contains(&code), "{line}: {text}");
        same(&all(folder.path()), &whole, line);
    }
}

/// Steps of another simulation, or damaged ones, are neither gone on from nor lost, but with --overwrite.
#[test]
fn a_simulation_goes_on_from_its_own_steps_alone() {
    let line = "simulate 1.1 --tile 2x2 --fix left --pull right=3,0,0 --out out --quiet";
    let (whole, folder) = (whole(line), tempfile::tempdir().unwrap());
    let steps = folder.path().join("out/steps.jsonl");
    let lines = || fs::read_to_string(&steps).map_or(0, |text| text.lines().count());
    while lines() < 3 {
        let mut run = command(folder.path(), line).spawn().unwrap();
        while lines() < 3 && run.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(1));
        }
        run.kill().unwrap();
        run.wait().unwrap();
        if !steps.exists() {
            fs::remove_dir_all(folder.path().join("out")).unwrap(); // it was done before the kill
        }
    }
    let kept = fs::read_to_string(&steps).unwrap();
    let other = line.replace("right=3,0,0", "right=2,0,0");
    let (code, text) = said(&maille(folder.path(), &other));
    assert!(code == 4 && text.contains("other inputs") && text.contains("--overwrite"), "{code} {text}");
    fs::write(&steps, kept.replacen("\"iterations\":", "\"iterations\":1", 1)).unwrap();
    let (code, text) = said(&maille(folder.path(), line));
    assert!(code == 4 && text.contains("steps.jsonl:2") && text.contains("--overwrite"), "{code} {text}");
    let (code, text) = said(&maille(folder.path(), &format!("{line} --overwrite")));
    assert_eq!(code, 0, "{text}");
    same(&all(folder.path()), &whole, line);
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let reproduce = "reproduce --quick --only 1.1 --out out --quiet";
    for line in COMMANDS.into_iter().chain([reproduce]) {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("out")).unwrap();
        let lock = fs::File::create(folder.path().join("out/.maille.lock")).unwrap();
        lock.try_lock().unwrap();
        for overwrite in ["", " --overwrite"].into_iter().take(if line == reproduce { 1 } else { 2 }) {
            let (code, text) = said(&maille(folder.path(), &format!("{line}{overwrite}")));
            assert_eq!(code, 4, "{line}: {text}");
            assert!(
                text.contains("another run is writing to out") && text.contains("wait until it has ended"),
                "{text}"
            );
        }
        assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 1, "{line}: something was written");
        drop(lock);
        if line != reproduce {
            assert!([0, 5].contains(&said(&maille(folder.path(), line)).0), "{line}");
        }
    }
}

/// The lock of a run is gone when the run is, however it ended.
#[test]
fn a_killed_run_leaves_no_lock() {
    let folder = tempfile::tempdir().unwrap();
    let long = "boundary 1.1 --out out --quiet";
    let mut first = command(folder.path(), long).spawn().unwrap();
    while !folder.path().join("out/boundary.jsonl").exists() {
        assert!(first.try_wait().unwrap().is_none(), "it ended before it wrote");
        sleep(Duration::from_millis(5));
    }
    let (code, text) = said(&maille(folder.path(), long));
    assert_eq!((code, text.contains("another run is writing to out")), (4, true), "{text}");
    first.kill().unwrap();
    first.wait().unwrap();
    let mut again = command(folder.path(), long).spawn().unwrap();
    sleep(Duration::from_millis(300));
    assert!(again.try_wait().unwrap().is_none(), "it was refused");
    again.kill().unwrap();
    again.wait().unwrap();
}

/// Files can grow to some kB and no further, as on a full disk: writing fails within a file.
#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_after_which_a_run_goes_on() {
    for line in COMMANDS {
        let whole = whole(line);
        for blocks in [0, 4, 60] {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("study.toml"), STUDY).unwrap();
            let words = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$MAILLE\" {line}");
            let mut shell = Command::new("sh");
            shell.args(["-c", &words]).current_dir(folder.path()).env("NO_COLOR", "1").env("COLUMNS", "400");
            let (code, text) = said(&shell.env("MAILLE", env!("CARGO_BIN_EXE_maille")).output().unwrap());
            assert_eq!(code, 1, "{line}, {blocks} blocks: {text}");
            assert!(text.contains("cannot write out") && text.contains("File too large"), "{line}: {text}");
            for name in all(folder.path()).keys() {
                assert!(!name.ends_with(".tmp"), "{line}: {name} is left");
            }
            if folder.path().join("out/run.json").exists() {
                let (code, text) = said(&maille(folder.path(), "table out --format csv"));
                assert_eq!(code, 0, "{line}: {text}");
            }
            let (code, text) = said(&maille(folder.path(), line));
            assert!([0, 5].contains(&code), "{line}: {text}");
            same(&all(folder.path()), &whole, line);
        }
    }
}

/// Nothing can be created in /proc, whoever asks, and nothing below a file.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    for line in COMMANDS {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        for out in ["/proc/maille", "file/out"] {
            let (code, text) = said(&maille(folder.path(), &line.replace("--out out", &format!("--out {out}"))));
            assert_eq!(code, 1, "{line}: {text}");
            assert!(text.contains(&format!("cannot create {out}")), "{line}: {text}");
        }
    }
}

#[test]
fn a_record_that_was_cut_or_edited_is_refused_with_file_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(said(&maille(folder, COMMANDS[0])).0, 0);
    for name in ["limits.csv", "states.jsonl", "run.json"] {
        let path = folder.join("out").join(name);
        let text = fs::read_to_string(&path).unwrap();
        let digit = text.rfind(|c: char| ('1'..='8').contains(&c)).unwrap();
        let next = char::from(text.as_bytes()[digit] + 1).to_string();
        let edited = [&text[..digit], &next, &text[digit + 1..]].concat();
        let line = text[..text.len() / 2].rfind('\n').unwrap() + 1;
        let mut wrong: Vec<String> = vec![text[..text.len() - 2].into(), text[..line].into(), edited];
        if name == "run.json" {
            wrong.push(text.replacen("\"seed\": 1", "\"seed\": 2", 1));
            assert!(wrong[3] != text);
        }
        for part in [3, 100, 500, 900] {
            let at = (0..=text.len() * part / 1000).rev().find(|k| text.is_char_boundary(*k)).unwrap();
            wrong.push(text[..at].into());
        }
        for (k, wrong) in wrong.iter().enumerate() {
            // run.json ends with checksums: the digit is one of theirs, and a file is not what it says.
            fs::write(&path, wrong).unwrap();
            for reader in ["table out", "plot out -o plot.svg", COMMANDS[0]] {
                let (code, text) = said(&maille(folder, reader));
                assert_eq!(code, 4, "{reader}, {name}, {k}: {text}");
                assert!(text.contains("--overwrite"), "{reader}, {name}, {k}: {text}");
                assert!(text.contains(name), "{reader}, {name}, {k}: {text}");
            }
            let (code, text) = said(&maille(folder, "verify out --quiet"));
            assert_eq!(code, 4, "verify, {name}, {k}: {text}");
        }
        fs::write(&path, &text).unwrap();
        assert_eq!(said(&maille(folder, "verify out --quiet")).0, 0);
    }
}

/// Changes each digit of a text that stands at one of some places, one at a time.
fn digits_changed(text: &str, places: usize) -> impl Iterator<Item = String> {
    let digits: Vec<usize> = text.bytes().enumerate().filter(|(_, b)| b.is_ascii_digit()).map(|(at, _)| at).collect();
    let chosen: Vec<usize> = (0..places).map(|k| digits[k * digits.len() / places]).collect();
    chosen.into_iter().map(move |at| {
        let other = if text.as_bytes()[at] == b'7' { "8" } else { "7" };
        [&text[..at], other, &text[at + 1..]].concat()
    })
}

#[test]
fn a_surface_that_was_edited_is_refused_and_one_that_was_cut_goes_on() {
    let line = COMMANDS[2];
    let whole = whole(line);
    let folder = tempfile::tempdir().unwrap();
    assert!([0, 5].contains(&said(&maille(folder.path(), line)).0));
    let path = folder.path().join("out/boundary.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    for edited in digits_changed(&text, 12) {
        fs::write(&path, edited).unwrap();
        let (code, text) = said(&maille(folder.path(), line));
        assert_eq!(code, 4, "{text}");
        assert!(
            text.contains("boundary.jsonl:") && text.contains("checksum") && text.contains("--overwrite"),
            "{text}"
        );
    }
    for end in [0, 10, text.len() / 3, text.len() - 2] {
        fs::write(&path, &text[..end]).unwrap();
        let (code, text) = said(&maille(folder.path(), line));
        if end <= 10 {
            // Not even the first line: nothing says whose it is.
            assert_eq!((code, text.contains("the first line is missing")), (4, true), "{text}");
        } else {
            assert!([0, 5].contains(&code), "{text}");
            same(&all(folder.path()), &whole, line);
        }
    }
}

#[test]
fn a_simulation_that_was_cut_or_edited_is_refused_and_none_is_a_mixture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let simulate = "simulate 1.1 --tile 2x2 --fix left --pull right=3,0,0 --steps 4 --out out --overwrite --quiet";
    assert_eq!(said(&maille(folder, simulate)).0, 0);
    let read = "export --from out --out sheet.obj --overwrite";
    assert_eq!(said(&maille(folder, read)).0, 0);
    for name in ["simulation.json", "frames.jsonl", "forces.csv"] {
        let path = folder.join("out").join(name);
        let text = fs::read_to_string(&path).unwrap();
        let first = text[..text.len() - 1].rfind('\n').map_or(0, |at| at + 1);
        let cut = [&text[..text.len() - 2], &text[..text.len() / 2], &text[..first]].map(str::to_owned);
        // Another text of the same number.
        let longer = text.replacen(".0,", ".00,", 1);
        assert_ne!(longer, text, "{name}");
        // A checksum of another name is none.
        let renamed = (name == "simulation.json").then(|| text.replace("\"sha256\"", "\"sha276\""));
        for (k, wrong) in digits_changed(&text, 12).chain(cut).chain([longer]).chain(renamed).enumerate() {
            fs::write(&path, &wrong).unwrap();
            let (code, text) = said(&maille(folder, read));
            assert_eq!(code, 4, "{name}, {k}: {text}");
            assert!(text.contains(name), "{name}, {k}: {text}");
        }
        fs::write(&path, &text).unwrap();
        assert_eq!(said(&maille(folder, read)).0, 0);
    }
    // A table that was lost is missed, and the one of an earlier simulation is not left to another.
    let table = folder.join("out/forces.csv");
    let text = fs::read_to_string(&table).unwrap();
    fs::remove_file(&table).unwrap();
    let (code, lost) = said(&maille(folder, read));
    assert!(code == 4 && lost.contains("forces.csv"), "{lost}");
    fs::write(&table, text).unwrap();
    assert_eq!(said(&maille(folder, &simulate.replace("--out out", "--out new --frames out"))).0, 0);
    assert!(!table.exists() && said(&maille(folder, read)).0 == 0);
    assert_eq!(said(&maille(folder, simulate)).0, 0);
    // Another simulation into the folder, killed at any time: the old one, none, or the new one.
    let other = simulate.replace("--steps 4", "--steps 3");
    for wait in [5, 20, 40, 80] {
        let mut run = command(folder, &other).spawn().unwrap();
        sleep(Duration::from_millis(wait));
        run.kill().unwrap();
        run.wait().unwrap();
        let (code, text) = said(&maille(folder, read));
        assert!([0, 4].contains(&code) && !text.contains("was edited"), "{text}");
    }
}

#[test]
fn records_are_the_same_on_any_number_of_threads() {
    // A simulation takes no number of threads.
    for line in COMMANDS.into_iter().filter(|line| !line.starts_with("simulate")) {
        let one = whole(&format!("{line} --threads 1"));
        for threads in [2, 4] {
            same(&whole(&format!("{line} --threads {threads}")), &one, line);
        }
    }
}

/// Ctrl-C, and SIGTERM, which schedulers send, in the middle: what is said is what is on the disk; with -q nothing is said.
#[cfg(unix)]
#[test]
fn an_interrupted_run_counts_what_is_on_the_disk() {
    let study = "directions = \"0:179:1\"\nl2 = \"-0.25:0.25:0.05\"\ncell = \"1x1\"\n[[designs]]\n\
                 design = \"european-4-in-1\"\nminor_radius = [0.5, 0.6, 0.7]\n";
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut before = 0;
    for (signal, quiet) in [("-INT", ""), ("-TERM", ""), ("-INT", " -q"), ("-TERM", " -q")] {
        let line = &format!("sweep long.toml --out out --threads 2{quiet}");
        let mut child = command(folder, line);
        fs::write(folder.join("long.toml"), study).unwrap();
        let child = child.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let begun = std::time::Instant::now();
        while rows_kept(&folder.join("out/records")) < before + 5 {
            assert!(begun.elapsed() < Duration::from_secs(60), "no limit was found");
            sleep(Duration::from_millis(5));
        }
        let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert!(killed.success());
        let (code, text) = said(&child.wait_with_output().unwrap());
        assert_eq!(code, 130, "{text}");
        let mut table = csv::Reader::from_path(folder.join("out/limits.csv")).unwrap();
        let status = table.headers().unwrap().iter().position(|name| name == "status").unwrap();
        let there = table.records().filter(|row| row.as_ref().unwrap()[status] != *"interrupted").count();
        // 180 directions, 11 widths, 3 radii.
        assert!(before < there && there < 5940, "{there} limits");
        let counted = format!("{there} of 5940 limits in 3 records, {} of them now, in ", there - before);
        let resumes = "interrupted; the same command continues from here";
        match quiet {
            "" => assert!(text.contains(&counted) && text.contains(resumes), "not \"{counted}\": {text}"),
            _ => assert_eq!(text, ""),
        }
        before = there;
    }
}

/// Limits in the tables and journals below a folder, one a line; a table's head and what a stop cut short count for none.
#[cfg(unix)]
fn rows_kept(records: &Path) -> usize {
    let Ok(entries) = fs::read_dir(records) else { return 0 };
    let found = |text: String| text.lines().filter(|line| !line.contains("interrupted")).count();
    let lines = |path: std::path::PathBuf| fs::read_to_string(path).map_or(0, found);
    let of = |folder: std::path::PathBuf| {
        lines(folder.join("limits.csv")).saturating_sub(1) + lines(folder.join("limits.journal"))
    };
    entries.map(|entry| of(entry.unwrap().path())).sum()
}
