//! The shorter commands, and the steps of `test` that are more than a call of cargo.

use crate::{circles, crates, features, layers, paths, repository::Finding, site, view, wheel::Environment};
use std::{path::Path, process::ExitCode, time::Instant};

/// A step failed and has said why.
#[derive(Debug)]
pub struct Failed;

/// A step of `test`, which starts it as a process of its own.
pub fn one(root: &Path, name: &str) -> Result<(), String> {
    match name {
        "Python environment" => Environment::there(root, false).map(drop),
        "wheel" => Environment::new(root, false).map(drop),
        "Python tests" => Environment::there(root, false)?.test(),
        "page" => view::page(root),
        "Chromium" => view::installed_browser().map(drop),
        "types of the page" => view::check_types(root),
        "browser tests" => view::test(root),
        _ => Err(format!("there is no step `{name}`")),
    }
}

/// The exit code of a run that has one.
pub fn code(done: Result<ExitCode, String>) -> ExitCode {
    done.unwrap_or_else(|problem| {
        eprintln!("xtask: {problem}");
        ExitCode::FAILURE
    })
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

fn timed(name: &str, step: impl FnOnce() -> Result<(), Failed>) -> Result<(), Failed> {
    println!("── {name}");
    let begun = Instant::now();
    let done = step();
    let outcome = if done.is_ok() { "ok" } else { "FAILED" };
    println!("── {name}: {outcome} in {:.1} s", begun.elapsed().as_secs_f64());
    done
}
