//! The numbers that the guide quotes are those that the program prints.
//!
//! A page says so in comments that its reader does not see, below the text that quotes the numbers:
//!
//!     <!-- check: limit 1.1 --maximize exx --free eyy => 0.536800000 -->
//!     <!-- check, not run, 40 s: characterize 1.1 ; table 1.1 => 0.7740 -->
//!
//! Commands are those of the program without its name, `;` between them; a `!` before one says that it ends with an error. Each
//! number must stand in the page's text, and one that the commands print must round to it. The checks of a page run one after
//! the other in one folder. Those that take more than about 5 s in the dev profile say `not run` and how long; they are run by
//!
//!     cargo nextest run -p maille-cli --test it guide:: --run-ignored all

use std::{fs, path::Path, process::Command};

/// A check of a page.
#[derive(Debug, PartialEq)]
struct Check {
    line: usize,
    run: bool,
    commands: Vec<Vec<String>>,
    numbers: Vec<String>,
}

/// The checks of a page, and its text without comments.
fn checks(page: &str) -> (Vec<Check>, String) {
    let (mut checks, mut text, mut rest, mut line) = (Vec::new(), String::new(), page, 1);
    while let Some((before, after)) = rest.split_once("<!--") {
        let (comment, after) = after.split_once("-->").expect("a comment has an end");
        text += before;
        line += before.matches('\n').count();
        if let Some(check) = comment.trim().strip_prefix("check") {
            let (how, what) = check.split_once(':').expect("check: commands => numbers");
            let (commands, numbers) = what.split_once("=>").expect("check: commands => numbers");
            assert!(how.is_empty() || how.starts_with(", not run, ") && how.ends_with(" s"), "line {line}: check{how}");
            checks.push(Check {
                line,
                run: how.is_empty(),
                commands: commands.split(';').map(words).collect(),
                numbers: numbers.split_whitespace().map(str::to_owned).collect(),
            });
        }
        line += comment.matches('\n').count();
        rest = after;
    }
    (checks, text + rest)
}

/// Words between blanks; quotes keep blanks.
fn words(command: &str) -> Vec<String> {
    let (mut out, mut word, mut quoted) = (Vec::new(), String::new(), false);
    for c in command.chars().chain([' ']) {
        match c {
            '\'' | '"' => quoted = !quoted,
            c if c.is_whitespace() && !quoted => {
                if !word.is_empty() {
                    out.push(std::mem::take(&mut word));
                }
            }
            c => word.push(c),
        }
    }
    out
}

/// Every number in a text, a minus sign of the typesetter's too.
fn numbers(text: &str) -> Vec<f64> {
    let text = text.replace('\u{2212}', "-");
    let parts = text.split(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)));
    parts.filter_map(|part| part.trim_end_matches('.').parse().ok()).collect()
}

/// Whether `x` rounds to the number as it is written.
fn rounds_to(x: f64, written: &str) -> bool {
    let written = written.replace('\u{2212}', "-");
    let decimals = written.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
    let number: f64 = written.parse().expect("a number");
    (x - number).abs() <= 0.5 * 10f64.powi(-decimals) * (1.0 + 1e-9)
}

/// Runs the checks of all pages, those that are `run` in each test, or the others.
fn check(run: bool) {
    let guide = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide");
    let (mut wrong, mut done) = (Vec::new(), 0);
    let mut pages: Vec<_> = fs::read_dir(guide).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.sort();
    for page in pages {
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        let (checks, text) = checks(&fs::read_to_string(&page).unwrap());
        let folder = tempfile::tempdir().unwrap();
        for check in checks {
            for number in check.numbers.iter().filter(|number| !text.contains(number.as_str())) {
                wrong.push(format!("{name}:{}: {number} is not in the text", check.line));
            }
            if check.run != run {
                continue;
            }
            let mut printed = String::new();
            for command in &check.commands {
                let fails = command[0] == "!";
                // The reader stands in the repository, where the examples are.
                let of_repository = |word: &String| match word.starts_with("examples/") {
                    true => format!("{}/../../{word}", env!("CARGO_MANIFEST_DIR")),
                    false => word.clone(),
                };
                let output = Command::new(env!("CARGO_BIN_EXE_maille"))
                    .args(command[usize::from(fails)..].iter().map(of_repository))
                    .current_dir(folder.path())
                    .env("NO_COLOR", "1")
                    .output()
                    .unwrap();
                let said = [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).concat();
                if output.status.success() == fails {
                    wrong.push(format!("{name}:{}: {command:?} ends with {}: {said}", check.line, output.status));
                }
                printed += &said;
            }
            let found = numbers(&printed);
            for number in check.numbers.iter().filter(|number| !found.iter().any(|x| rounds_to(*x, number))) {
                wrong.push(format!("{name}:{}: {number} is not in what is printed:\n{printed}", check.line));
            }
            done += 1;
        }
    }
    assert!(done > 0, "no check was run");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_numbers_of_the_guide_are_those_of_the_program() {
    check(true);
}

#[test]
#[ignore = "minutes"]
fn the_numbers_of_the_guide_that_take_long_are_those_of_the_program() {
    check(false);
}

#[test]
fn checks_are_read() {
    let page =
        "a 0.5\n<!-- other -->\n<!-- check: x 'a b' ; ! y\n--z => 0.50 -1 -->\nb<!-- check, not run, 9 s: x => 2 -->";
    let (found, text) = checks(page);
    assert_eq!(text, "a 0.5\n\n\nb");
    assert_eq!((found[0].line, found[1].line, found[0].run, found[1].run), (3, 5, true, false));
    assert_eq!(found[0].commands, [vec!["x", "a b"], vec!["!", "y", "--z"]]);
    assert_eq!(found[0].numbers, ["0.50", "-1"]);
    assert_eq!(numbers("l1=0.25, (-1e-3) 4x4 at 90°: \u{2212}0.5."), [1.0, 0.25, -1e-3, 4.0, 4.0, 90.0, -0.5]);
    assert!(rounds_to(0.604_565_6, "0.604566") && !rounds_to(0.605_026, "0.604566") && rounds_to(-0.5, "\u{2212}0.5"));
}
