//! The commands in the code blocks of README, the guide and the other pages run, one after the other, as for a reader
//! who follows a page from its first line to its last in an empty folder.
//!
//! A command ends with 0, or with 5: done, but some limits were not found. Comments that the reader does not see say what
//! else belongs to the next block:
//!
//!     <!-- file: my-weave.toml -->              the block is this file
//!     <!-- excerpt: designs/1.1.toml -->        its lines are lines of this file of the repository
//!     <!-- before: maille designs -->           a command whose results the page takes as given
//!     <!-- with: NAME=1.1 -->                   what stands for a word
//!     <!-- slow: 40 s -->                       not run in each test; it takes about so long
//!     <!-- ends: 3 -->                          with an error, as the page says
//!
//! Slow blocks, and with them all others of their page, are run by
//!
//!     cargo nextest run --release -p maille-cli --test it blocks:: --run-ignored all
//!
//! `--watch` and `view` do not end or need the viewer: `src/docs.rs` parses them, as it does slow ones, and the site's check in a
//! browser opens what `view --bundle` writes. Blocks of Python are run by the tests of the Python package, blocks of Rust by
//! `cargo test --doc`.

use std::{
    collections::BTreeMap,
    fs,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

/// A code block with what the comments before it say.
#[derive(Debug, Default, PartialEq)]
struct Block {
    /// Number of its first line.
    line: usize,
    language: String,
    lines: Vec<String>,
    file: Option<String>,
    excerpt: Option<String>,
    before: Vec<String>,
    with: BTreeMap<String, String>,
    slow: bool,
    ends: Option<i32>,
}

/// The blocks of a page, fenced or indented.
fn blocks(page: &str) -> Vec<Block> {
    let (mut out, mut next) = (Vec::new(), Block::default());
    let mut lines = page.lines().enumerate().peekable();
    while let Some((index, line)) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            (next.line, next.language) = (index + 2, language.trim().to_owned());
            next.lines = lines.by_ref().map(|(_, line)| line.to_owned()).take_while(|line| line != "```").collect();
            next = push(&mut out, next);
        } else if let Some(first) = line.strip_prefix("    ") {
            next.line = index + 1;
            next.lines.push(first.to_owned());
            while let Some((_, line)) = lines.next_if(|(_, line)| line.is_empty() || line.starts_with("    ")) {
                next.lines.push(line.get(4..).unwrap_or_default().to_owned());
            }
            next = push(&mut out, next);
        } else if let Some(mark) = line.strip_prefix("<!-- ").and_then(|line| line.strip_suffix(" -->")) {
            next.read(mark);
        }
    }
    out
}

/// Puts a block where it is done, without empty lines at its end; an empty one for what follows.
fn push(out: &mut Vec<Block>, mut block: Block) -> Block {
    while block.lines.last().is_some_and(String::is_empty) {
        block.lines.pop();
    }
    out.push(block);
    Block::default()
}

impl Block {
    fn read(&mut self, mark: &str) {
        match mark.split_once(": ") {
            Some(("file", name)) => self.file = Some(name.to_owned()),
            Some(("excerpt", name)) => self.excerpt = Some(name.to_owned()),
            Some(("before", command)) => self.before.push(command.to_owned()),
            Some(("with", words)) => {
                for word in words.split_whitespace() {
                    let (name, value) = word.split_once('=').expect("with: NAME=value");
                    self.with.insert(name.to_owned(), value.to_owned());
                }
            }
            Some(("slow", _)) => self.slow = true,
            Some(("ends", code)) => self.ends = Some(code.parse().expect("ends: an exit code")),
            _ => {}
        }
    }

    /// The commands to run, each with the number of its line. Words are put in; lines that go on are joined, and so are
    /// those of a file that the shell writes.
    fn commands(&self) -> Vec<(usize, String)> {
        let mut out = Vec::new();
        if !matches!(self.language.as_str(), "" | "bash" | "sh") || self.file.is_some() {
            return out;
        }
        let mut lines = self.lines.iter().enumerate();
        while let Some((index, line)) = lines.next() {
            let mut command = line.trim().split("  ").next().unwrap_or_default().to_owned();
            while command.ends_with('\\') {
                command.pop();
                command += lines.next().map_or("", |(_, line)| line.trim());
            }
            if command.ends_with("<<END") {
                let rest = lines.by_ref().map(|(_, line)| line.as_str());
                command = [command.as_str()]
                    .into_iter()
                    .chain(rest.take_while(|line| *line != "END"))
                    .chain(["END"])
                    .collect::<Vec<_>>()
                    .join("\n");
            }
            for (name, value) in &self.with {
                command = command.replace(name, value);
            }
            command = command.replace("cargo run --release -- ", "maille ");
            let endless = command.contains("--watch") || command.starts_with("maille view");
            if ["maille ", "cat > ", "printf "].iter().any(|start| command.starts_with(start)) && !endless {
                out.push((self.line + index, command));
            }
        }
        out
    }
}

/// The command, with a small picture if it draws one: most of its time goes into pixels.
fn small(command: String) -> String {
    if !command.starts_with("maille render ") {
        return command;
    }
    let mut words: Vec<&str> = command.split(' ').collect();
    if let Some(at) = words.iter().position(|word| *word == "--size") {
        words.drain(at..(at + 2).min(words.len()));
    }
    words.extend(["--size", "320x240"]);
    words.join(" ")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the repository")
}

/// Runs a page's blocks; without `slow`, only those before and beside the slow ones.
fn run(page: &str, slow: bool) {
    let root = root();
    let blocks = blocks(&fs::read_to_string(root.join(page)).unwrap());
    if slow && !blocks.iter().any(|block| block.slow) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let programs = tempfile::tempdir().unwrap();
    symlink(env!("CARGO_BIN_EXE_maille"), programs.path().join("maille")).unwrap();
    // The reader stands in the repository, or in the folder of the example.
    let given = match page.starts_with("examples/") {
        true => fs::read_dir(root.join(page).parent().unwrap()).unwrap().map(|entry| entry.unwrap().path()).collect(),
        false => vec![root.join("examples"), root.join("designs")],
    };
    for path in given {
        symlink(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let path = format!("{}:{}", programs.path().display(), std::env::var("PATH").unwrap());
    let mut wrong = Vec::new();
    for block in blocks.iter().filter(|block| slow || !block.slow) {
        if let Some(name) = &block.file {
            fs::write(folder.path().join(name), block.lines.join("\n") + "\n").unwrap();
        }
        let before = block.before.iter().map(|command| (block.line, command.clone(), None));
        let shown = block.commands().into_iter().map(|(line, command)| (line, command, block.ends));
        for (line, command, ends) in before.chain(shown) {
            let command = small(command);
            let begun = Instant::now();
            let mut shell = Command::new("sh");
            shell.args(["-c", &command]).current_dir(folder.path()).env("PATH", &path).env("NO_COLOR", "1");
            let output = shell.output().unwrap();
            let code = output.status.code();
            println!("{page}:{line}: {:.1} s, {code:?}: {command}", begun.elapsed().as_secs_f64());
            let right = match ends {
                Some(wanted) => code == Some(wanted),
                None => matches!(code, Some(0 | 5)),
            };
            if !right {
                let said = [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).concat();
                wrong.push(format!("{page}:{line}: `{command}` ends with {code:?}:\n{said}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A test for each page, and one for those with slow blocks.
macro_rules! pages {
    ($($name:ident $page:literal,)*) => {
        const PAGES: &[&str] = &[$($page),*];
        $(#[test] fn $name() { run($page, false) })*
        mod slow {
            $(#[test] #[ignore = "minutes"] fn $name() { super::run($page, true) })*
        }
    };
}

pages! {
    readme "README.md",
    contributing "CONTRIBUTING.md",
    program "crates/maille-cli/README.md",
    gallery "docs/gallery/README.md",
    commands "docs/guide/README.md",
    aspect_ratio "docs/guide/aspect-ratio.md",
    certificates "docs/guide/certificates.md",
    choices "docs/guide/choices.md",
    clusters "docs/guide/clusters.md",
    curves "docs/guide/curves.md",
    finite_sheets "docs/guide/finite-sheets.md",
    first_limit "docs/guide/first-limit.md",
    fit "docs/guide/fit.md",
    makers "docs/guide/makers.md",
    own_weave "docs/guide/own-weave.md",
    printing "docs/guide/printing.md",
    python "docs/guide/python.md",
    questions "docs/guide/questions.md",
    reading_plots "docs/guide/reading-plots.md",
    rolling "docs/guide/rolling.md",
    view "docs/guide/view.md",
    json "docs/json.md",
    record "docs/record.md",
    reliability "docs/reliability.md",
    reproduction "docs/reproduction.md",
    comparison "docs/theory/comparison.md",
    energy "docs/theory/energy.md",
    pull_and_fold "examples/pull-and-fold/README.md",
    round_profile "examples/round-profile/README.md",
}

/// Decisions quote measurements of their day; the others have no command of the program.
#[test]
fn every_page_with_a_command_is_run() {
    let root = root();
    let mut left_out = Vec::new();
    for folder in ["", "docs", "docs/gallery", "docs/guide", "docs/theory", "paper", "site", "validation"] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
            if path.extension().is_some_and(|extension| extension == "md") && !PAGES.contains(&name.as_str()) {
                let found = blocks(&fs::read_to_string(&path).unwrap());
                left_out.extend(
                    found.iter().flat_map(Block::commands).map(|(line, command)| format!("{name}:{line}: {command}")),
                );
            }
        }
    }
    assert!(left_out.is_empty(), "{}", left_out.join("\n"));
}

/// A block of TOML is a file that the commands of its page read, or lines of one in the repository.
#[test]
fn every_file_of_a_page_is_read() {
    for page in PAGES {
        let blocks = blocks(&fs::read_to_string(root().join(page)).unwrap());
        for block in &blocks {
            let place = format!("{page}:{}", block.line);
            if let Some(name) = &block.excerpt {
                let without_comment = |line: &str| line.split(" #").next().unwrap_or_default().trim().to_owned();
                let whole = fs::read_to_string(root().join(name)).unwrap();
                let mut whole = whole.lines().map(without_comment);
                for line in block.lines.iter().map(|line| without_comment(line)).filter(|line| !line.is_empty()) {
                    assert!(whole.any(|other| other == line), "{place}: {name} has no line `{line}`, or another order");
                }
            } else if let Some(name) = &block.file {
                let shown = blocks.iter().flat_map(Block::commands).map(|(_, command)| command);
                let mut commands = shown.chain(blocks.iter().flat_map(|block| block.before.clone()));
                assert!(commands.any(|command| command.contains(name)), "{place}: no command reads {name}");
            } else {
                assert!(block.language != "toml", "{place}: of which file?");
            }
        }
    }
}

#[test]
fn blocks_are_found() {
    let page = "maille prose\n\n<!-- with: NAME=1.1 X=2 -->\n<!-- before: a b -->\n<!-- before: c -->\n\n    maille d NAME   its X\n\n    maille e X\\\n      f\ntext\n\
        <!-- file: x.toml -->\n```toml\nmaille = 1\n\n    a\n```\n<!-- slow: 9 s -->\n```bash\n# g\nmaille g && h\nmaille view 1.1\n```\n\
        <!-- ends: 3 -->\n    $ other\n    maille z --watch\n";
    let found = blocks(page);
    assert_eq!(found.iter().map(|block| block.line).collect::<Vec<_>>(), [7, 14, 20, 25]);
    assert_eq!(found[0].before, ["a b", "c"]);
    let expected = [
        vec![(7, "maille d 1.1".to_owned()), (9, "maille e 2f".to_owned())],
        vec![],
        vec![(21, "maille g && h".to_owned())],
        vec![],
    ];
    assert_eq!(found.iter().map(Block::commands).collect::<Vec<_>>(), expected);
    assert_eq!((found[1].file.as_deref(), found[1].lines.join("\n").as_str()), (Some("x.toml"), "maille = 1\n\n    a"));
    assert_eq!(
        found.iter().map(|block| (block.slow, block.ends)).collect::<Vec<_>>(),
        [(false, None), (false, None), (true, None), (false, Some(3))]
    );
}
