//! The steps of `ci`, each announced and timed.

use crate::{
    certify, circles, crates, features, layers, paths, program, repository::Finding, site, view, wheel::Environment,
};
use std::{
    path::Path,
    process::{Command, Stdio},
    time::Instant,
};

/// A step failed and has said why.
#[derive(Debug)]
pub struct Failed;

/// Everything that must hold before a change lands; the cheap steps first, the tests last.
pub fn ci(root: &Path) -> Result<(), Failed> {
    timed("format", || cargo(root, &["fmt", "--all", "--check"], &[]))?;
    timed("clippy", || cargo(root, &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"], &[]))?;
    timed("layers", || self::layers(root))?;
    timed("features", || self::features(root))?;
    timed("paths", || self::paths(root))?;
    timed("rustdoc", || cargo(root, &["doc", "--workspace", "--no-deps"], &[("RUSTDOCFLAGS", "-D warnings")]))?;
    test(root)
}

/// Every test there is. The runner's own summary is the last thing printed, so nothing is timed after it.
pub fn test(root: &Path) -> Result<(), Failed> {
    let python = timed("Python package", || failed(Environment::new(root, false).and_then(|python| python.test())));
    let viewer = timed("viewer", || failed(view::test(root)));
    let certify = timed("certify --quick", || failed(certify::run(root, &["--quick"])));
    let tests = rust_tests(root);
    for (of, done) in [("the Python package", &python), ("the viewer", &viewer), ("certify --quick", &certify)] {
        if done.is_err() {
            eprintln!("\nxtask: the tests of {of} failed, see above");
        }
    }
    python.and(viewer).and(certify).and(tests)
}

fn rust_tests(root: &Path) -> Result<(), Failed> {
    if !has_nextest(root) {
        announce("tests");
        return cargo(root, &["test", "--workspace", "--no-fail-fast"], &[]);
    }
    // Nextest runs no documentation examples. Both runs happen, whatever the first one finds.
    let examples =
        timed("documentation examples", || cargo(root, &["test", "--workspace", "--doc", "--no-fail-fast"], &[]));
    announce("tests");
    let tests = cargo(root, &["nextest", "run", "--workspace", "--no-fail-fast"], &[]);
    if examples.is_err() {
        eprintln!("\nxtask: documentation examples failed, see above");
    }
    examples.and(tests)
}

/// The viewer's page, and the program with it.
pub fn view(root: &Path) -> Result<(), Failed> {
    timed("viewer", || failed(view::build(root).map(|program| println!("   {}", program.display()))))
}

/// The Python package from its wheel, in a new environment.
pub fn wheel(root: &Path) -> Result<(), Failed> {
    timed("wheel and examples", || failed(Environment::new(root, true).and_then(|python| python.examples())))
}

/// The site.
pub fn site(root: &Path, program: Option<&str>) -> Result<(), Failed> {
    timed("site", || failed(site::write(root, program)))
}

/// Says what went wrong.
pub fn failed(done: Result<(), String>) -> Result<(), Failed> {
    done.map_err(|problem| {
        eprintln!("xtask: {problem}");
        Failed
    })
}

/// The checks of layers and of circles; prints the order that they hold the code to.
pub fn layers(root: &Path) -> Result<(), Failed> {
    println!("{}", layers::order_of_crates());
    println!("{}", layers::order_of_modules());
    let crates = crates::read(root);
    report([layers::check(root, &crates), circles::check(&crates)].concat())
}

/// The check that libraries are compiled once.
pub fn features(root: &Path) -> Result<(), Failed> {
    report(features::check(root))
}

/// The checks of the paths named in the documents, and of the site's table of contents.
pub fn paths(root: &Path) -> Result<(), Failed> {
    report([paths::check(root), site::check(root)].concat())
}

fn report(findings: Vec<Finding>) -> Result<(), Failed> {
    for finding in &findings {
        eprintln!("{finding}");
    }
    if findings.is_empty() { Ok(()) } else { Err(Failed) }
}

fn announce(name: &str) {
    println!("── {name}");
}

fn timed(name: &str, step: impl FnOnce() -> Result<(), Failed>) -> Result<(), Failed> {
    announce(name);
    let begun = Instant::now();
    let done = step();
    let outcome = if done.is_ok() { "ok" } else { "FAILED" };
    println!("── {name}: {outcome} in {:.1} s", begun.elapsed().as_secs_f64());
    done
}

fn command(root: &Path) -> Command {
    let mut command = Command::new(program::cargo());
    command.current_dir(root);
    command
}

fn cargo(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), Failed> {
    let status = command(root).args(arguments).envs(environment.iter().copied()).status();
    let problem = match status {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("ended with {status}"),
        Err(e) => format!("did not start: {e}"),
    };
    failed(Err(format!("`cargo {}` {problem}", arguments.join(" "))))
}

fn has_nextest(root: &Path) -> bool {
    let probe = command(root).args(["nextest", "--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    probe.is_ok_and(|status| status.success())
}
