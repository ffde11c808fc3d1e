//! `cargo xtask test` and `cargo xtask ci`: what they consist of, and what depends on what.
//!
//! Each step is a process of its own, this program or cargo, and prints into its log. What waits for the network starts
//! at once, beside the one build of all tests. Cargo lets only one build into a folder at a time, so builds stand one
//! after the other; all have one profile and one choice of features (`cargo xtask features`): nothing is compiled twice.

mod counts;
mod found;
mod long;
mod plan;
mod progress;
mod schedule;
mod step;
mod summary;

use crate::program::{cargo, target};
use counts::Runner;
use found::Found;
use progress::Progress;
use std::{
    path::Path,
    process::{Command, ExitCode},
};
pub use step::Kind;
use step::{Outcome, Step};

/// Steps of `test --all` alone; their results are kept.
const LONG: &[&str] = &["all Rust tests", "certify"];

/// Says what it will do, does it, and sums up. Cheap checks end it if they fail; nothing else does.
pub fn run(root: &Path, kind: Kind) -> Result<ExitCode, String> {
    let own = std::env::current_exe().map_err(|e| format!("this program does not know its own path: {e}"))?;
    let logs = target(root).join("xtask");
    let found = Found::look(root);
    let (mut steps, checks) = match kind {
        Kind::Ci => (cheap(root, &own), checks(root)),
        Kind::Test | Kind::All => (Vec::new(), Vec::new()),
    };
    let first = steps.len();
    steps.extend(checks.into_iter().chain(tests(root, &own, &found, kind)));
    print!("{}", plan::text(&found, &steps, &target(root), &logs, kind));
    let rest = steps.split_off(first);
    let mut progress = Progress::new();
    let mut ended = schedule::run(steps, &logs, &mut progress);
    if ended.iter().all(|step| step.outcome == Outcome::Ok) {
        ended.extend(schedule::run(rest, &logs, &mut progress));
    } else {
        progress.say("what compiles is not started");
    }
    if kind == Kind::All {
        ended.extend(long::write(root, &ended, LONG).err());
    }
    let strict = kind == Kind::Ci;
    print!("{}", summary::text(&ended, strict));
    Ok(ExitCode::from(summary::code(&ended, strict)))
}

fn command(root: &Path, program: impl AsRef<std::ffi::OsStr>, words: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(words).current_dir(root);
    command
}

/// Checks of seconds.
fn cheap(root: &Path, own: &Path) -> Vec<Step> {
    let check = |name: &'static str| Step::new(name, command(root, own, &[name]));
    let format = Step::new("format", command(root, cargo(), &["fmt", "--all", "--check"]));
    vec![format, check("layers"), check("features"), check("paths")]
}

/// Checks that compile. Both read libraries' metadata, which the first of them makes.
fn checks(root: &Path) -> Vec<Step> {
    let all = ["clippy", "--workspace", "--all-targets", "--features", "maille-cli/view", "--", "-D", "warnings"];
    let clippy = command(root, cargo(), &all);
    let mut rustdoc = command(root, cargo(), &["doc", "--workspace", "--no-deps"]);
    rustdoc.env("RUSTDOCFLAGS", "-D warnings");
    vec![Step::new("clippy", clippy).cores(2), Step::new("rustdoc", rustdoc).cores(2)]
}

/// The steps of `test`; of those that may start, the first does.
fn tests(root: &Path, own: &Path, found: &Found, kind: Kind) -> Vec<Step> {
    let cargo = |name, parts: &[&[&str]]| Step::new(name, command(root, cargo(), &parts.concat()));
    let own_step = |name| Step::new(name, command(root, own, &["step", name]));
    // Nextest runs no documentation examples; neither does cargo here.
    let (build, run, runner): (&[&str], &[&str], _) = match found.nextest {
        true => (&["nextest", "run"], &["nextest", "run", "--failure-output", "final"], Runner::Nextest),
        false => (&["test"], &["test"], Runner::Cargo),
    };
    let (rust_tests, ignored): (_, &[&str]) = match (kind, found.nextest) {
        (Kind::Ci | Kind::Test, _) => ("Rust tests", &[]),
        (Kind::All, true) => ("all Rust tests", &["--run-ignored", "all"]),
        (Kind::All, false) => ("all Rust tests", &["--", "--include-ignored"]),
    };
    // Without examples, which are programs of their own: clippy compiles them. Without this program: cargo compiles a library
    // of macros once more where a program uses it too, and with it all that is made by macros.
    let all: &[&str] = match found.node.is_ok() {
        true => &["--workspace", "--exclude", "xtask", "--features", "maille-cli/view"],
        false => &["--workspace", "--exclude", "xtask"],
    };
    let own_profile: &[&str] = match found.nextest {
        true => &["--package", "xtask", "--cargo-profile", "xtask"],
        false => &["--package", "xtask", "--profile", "xtask"],
    };
    let mut out = vec![
        own_step("Python environment").cores(0).lacking(&found.python),
        own_step("page").cores(0).lacking(&found.node),
        own_step("Chromium").cores(0).lacking(&found.browser),
        // The viewer has the page inside.
        cargo("build", &[build, all, &["--tests", "--no-run"]]).cores(2).after(&["page"]),
        own_step("wheel").cores(2).needs(&["Python environment"]).after(&["build"]),
        // Not before the wheel, which takes both cores and would wait for what takes the other.
        cargo("tests of xtask", &[run, own_profile, &["--no-fail-fast"]]).after(&["build", "wheel"]).tests(runner),
        own_step("types of the page").cores(0).needs(&["page"]),
        own_step("Python tests").needs(&["wheel", "build"]).tests(Runner::Pytest),
        cargo("documentation examples", &[&["test"], all, &["--doc", "--no-fail-fast"]])
            .needs(&["build"])
            .tests(Runner::Cargo),
        own_step("browser tests").needs(&["page", "build", "Chromium"]).tests(Runner::Playwright),
        cargo(rust_tests, &[run, all, &["--tests", "--no-fail-fast"], ignored])
            .cores(2)
            .needs(&["build"])
            .tests(runner),
    ];
    // Without Node.js nothing drives a browser: none is installed.
    if found.browser == Ok(true) || found.browser == Ok(false) && found.node.is_err() {
        out.retain(|step| step.name != "Chromium");
    }
    if kind == Kind::All {
        out.push(Step::new("certify", command(root, own, &["certify", "--quick"])).cores(2).needs(&["build"]));
    }
    out
}
