//! Files of others are never replaced, whatever command writes, with `--overwrite` neither where it writes a folder.

use crate::common::{code, maille, outcome};
use std::fs;

/// A command of each kind of folder, written to `d`.
const FOLDERS: [&str; 9] = [
    "characterize 1.1 --directions 0 --l2 0 --cell 1x1 --out d",
    "sweep study.toml --out d",
    "roll 1.1 --directions 0 --axis below --out d",
    "roll european-4-in-1 --wrap 8 --axis below --out d",
    "boundary european-4-in-1 --vertices 162 --tolerance 0.5 --starts 1 --out d",
    "simulate 1.1 --tile 2x1 --fix left --pull right=3,0,0 --steps 3 --out d",
    "simulate 1.1 --tile 2x1 --fix left --pull right=3,0,0 --steps 3 --out e --frames d",
    "fit 1.1 --target profile.csv --free minor_radius=0.05:0.15 --out d",
    "reproduce --only 1.1 --quick --out d",
];

/// A file's name and what it holds.
type NamedText = (&'static str, &'static str);

/// What looks like a mark of a run and is none, and a file that the command would replace.
const LOOKS_LIKE: [(&str, &[NamedText], &str); 5] = [
    ("sweep study.toml --out d", &[("records/mine.txt", "x\n")], "limits.csv"),
    ("reproduce --only 1.1 --quick --out d", &[("records/mine/run.json", "{\"schema\": 7}")], "index.html"),
    ("roll 1.1 --directions 0 --axis below --out d --overwrite", &[("roll.json", "")], "rolls.csv"),
    (
        "simulate 1.1 --tile 2x1 --fix left --pull right=3,0,0 --steps 3 --out d --overwrite",
        &[("frames.jsonl", "{\"robot\": 3, \"poses\": []}\n")],
        "forces.csv",
    ),
    (
        "boundary european-4-in-1 --vertices 162 --tolerance 0.5 --starts 1 --out d",
        &[("surface.json", "{}")],
        "boundary.csv",
    ),
];

/// A command of each kind of file, written to `d/notes`. Without a format it is none, or that of its name.
const FILES: [&str; 11] = [
    "new swatch --weave european-4-in-1 --wire 1.6mm --id 6.5mm --out d/notes",
    "tightest 1.1 --starts 1 --save d/notes",
    "roomiest 1.1 --starts 1 --save d/notes",
    "prove 2 --direction 45 --out d/notes",
    "table record --format csv --output d/notes",
    "plot record --output d/notes.svg",
    "render 1.1 --size 64x48 --out d/notes.png",
    "export 1.1 --tile 1x1 --out d/notes.stl",
    "view 1.1 --directions 0 --l2 0 --bundle d/notes.html",
    "schema --out d/notes",
    "man d",
];

const STUDY: &str = "directions = [0]\nl2 = [0]\ncell = \"1x1\"\n[[designs]]\ndesign = \"1.1\"\n";
const TARGETS: &str = "direction_deg,l1\n0,0.44\n";

/// Every name that one of these commands writes in its folder, and one that none does.
const NAMES: [&str; 23] = [
    "run.json",
    "limits.csv",
    "limits.journal",
    "states.jsonl",
    "sensitivities.csv",
    "polar.svg",
    "polar.png",
    "roll.json",
    "rolls.jsonl",
    "rolls.csv",
    "roll.svg",
    "surface.json",
    "surface.jsonl",
    "boundary.jsonl",
    "boundary.csv",
    "boundary.obj",
    "simulation.json",
    "frames.jsonl",
    "forces.csv",
    "fit.json",
    "fitted.toml",
    "index.html",
    "thesis.docx",
];

fn prepared() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    fs::write(folder.path().join("profile.csv"), TARGETS).unwrap();
    fs::create_dir(folder.path().join("d")).unwrap();
    folder
}

#[test]
fn folders_of_others_are_refused() {
    let folder = prepared();
    let d = folder.path().join("d");
    for line in FOLDERS {
        for name in NAMES {
            fs::write(d.join(name), "x\n").unwrap();
            for overwrite in ["", " --overwrite"] {
                if line.starts_with("reproduce") && !overwrite.is_empty() {
                    continue;
                }
                let (code, _, text) = outcome(folder.path(), &format!("{line}{overwrite} --quiet"));
                assert_eq!(code, 4, "{line}{overwrite}, {name}: {text}");
                assert!(text.contains("holds ") && text.contains("name a"), "{line}, {name}: {text}");
                assert_eq!(fs::read_to_string(d.join(name)).unwrap(), "x\n", "{line}{overwrite}");
                assert_eq!(fs::read_dir(&d).unwrap().count(), 1, "{line}{overwrite}, {name}");
            }
            fs::remove_file(d.join(name)).unwrap();
        }
    }
}

#[test]
fn what_looks_like_a_run_is_none() {
    for (line, marks, name) in LOOKS_LIKE {
        let folder = prepared();
        let d = folder.path().join("d");
        for (mark, text) in marks.iter().chain([&(name, "mine\n")]) {
            fs::create_dir_all(d.join(mark).parent().unwrap()).unwrap();
            fs::write(d.join(mark), text).unwrap();
        }
        let (code, _, text) = outcome(folder.path(), &format!("{line} --quiet"));
        assert_eq!(code, 4, "{line}: {text}");
        assert_eq!(fs::read_to_string(d.join(name)).unwrap(), "mine\n", "{line}");
        assert_eq!(fs::read_dir(&d).unwrap().count(), 2, "{line}");
    }
}

/// As a run is left that was killed in its first moment: nothing but folders and locks.
#[test]
fn a_folder_without_a_file_is_taken() {
    let folder = prepared();
    fs::create_dir_all(folder.path().join("d/records/1.1")).unwrap();
    for lock in ["d/.maille.lock", "d/records/1.1/.maille.lock"] {
        fs::write(folder.path().join(lock), "").unwrap();
    }
    let (code, _, text) = outcome(folder.path(), "sweep study.toml --out d --quiet");
    assert_eq!(code, 0, "{text}");
    assert!(folder.path().join("d/limits.csv").is_file());
}

#[test]
fn files_of_others_are_refused() {
    let folder = prepared();
    let d = folder.path().join("d");
    let line = "characterize 1.1 --directions 0 --l2 0 --cell 1x1 --out record --quiet";
    assert_eq!(code(&maille(folder.path(), line)), 0);
    for line in FILES {
        let name = match line.rsplit("d/").next() {
            Some(name) if line.contains("d/") => name,
            _ => "maille.1",
        };
        fs::write(d.join(name), "x\n").unwrap();
        let (code, _, text) = outcome(folder.path(), line);
        assert_eq!(code, 2, "{line}: {text}");
        assert!(text.contains("is there already"), "{line}: {text}");
        assert_eq!(fs::read_to_string(d.join(name)).unwrap(), "x\n", "{line}");
        assert_eq!(fs::read_dir(&d).unwrap().count(), 1, "{line}");
        fs::remove_file(d.join(name)).unwrap();
    }
}

/// A command with an option for what it writes has a line above.
#[test]
fn no_command_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let (_, help, _) = outcome(folder.path(), "--help");
    let commands: Vec<&str> = help
        .lines()
        .filter_map(|line| line.strip_prefix("  ").filter(|line| line.starts_with(|c: char| c.is_ascii_lowercase())))
        .filter_map(|line| line.split_once("  ").map(|(name, _)| name))
        .collect();
    assert!(commands.len() > 20, "{commands:?}");
    let writes = |command: &&&str| {
        let (_, help, _) = outcome(folder.path(), &format!("{command} --help"));
        ["--out", "--output", "--save", "--bundle", "--overwrite"]
            .iter()
            .any(|option| help.contains(&format!("{option} ")) || help.contains(&format!("{option}\n")))
    };
    for command in commands.iter().filter(writes) {
        let named = FOLDERS.iter().chain(&FILES).any(|line| line.split(' ').next() == Some(command));
        assert!(named, "{command}");
    }
}
