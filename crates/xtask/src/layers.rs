//! The layer check: dependencies point one way, between the crates and between the modules of `maille`.
//!
//! The tables here are the one place where the order is stated. `ARCHITECTURE.md` quotes the two lines that
//! `cargo xtask layers` prints, and the check compares them. A crate or module without a row fails: its room is drawn
//! first, in `ARCHITECTURE.md` and here.

use crate::{
    crates::Crates,
    program::cargo,
    repository::{Finding, read},
    uses::Use,
};
use serde_json::Value;
use std::{collections::BTreeMap, path::Path, process::Command};

/// The crates, lowest first. A crate depends only on crates of the rows before its own; dev-dependencies are free.
const CRATES: &[&[&str]] = &[
    &["maille-geometry", "maille-svg"],
    &["maille-design"],
    &["maille", "maille-verify"],
    &["maille-io", "maille-prove"],
    &["maille-mesh", "maille-render"],
    &["maille-chapter6", "maille-view", "maille-fuzz", "maille-features"],
    &["maille-cli", "maille-py"],
    &["xtask"],
];

/// The modules of `maille`, lowest first. A module uses its own row and the rows before it. The check covers unit
/// tests as well: a test that needs a later module belongs into the crate's `tests` folder.
const MODULES: &[&[&str]] = &[
    &["lattice"],
    &["model", "state", "topology", "symmetry"],
    &["program", "bound"],
    &["record"],
    &["question", "answer"],
    &["search", "relaxation"],
    &["sensitivity"],
    &["survey"],
    &["sheet"],
    &["fit"],
];

/// Stands aside from the order: it uses no other module and no ring, and only [`ASIDE_USERS`] use it.
const ASIDE: &str = "solver";
const ASIDE_USERS: &[&str] = &["program", "bound", "answer", "search", "relaxation", "sensitivity", "survey", "fit"];

/// The crate of [`MODULES`], and where they live.
const OWNER: &str = "maille";
const SOURCES: &str = "crates/maille/src";
/// Quotes the order.
const DRAWING: &str = "ARCHITECTURE.md";

/// The order of the crates in one line.
pub fn order_of_crates() -> String {
    line(CRATES)
}

/// The order of the modules of `maille` in one line.
pub fn order_of_modules() -> String {
    format!("{}; {ASIDE} aside, used by {}", line(MODULES), ASIDE_USERS.join(", "))
}

fn line(rows: &[&[&str]]) -> String {
    rows.iter().map(|row| row.join(", ")).collect::<Vec<_>>().join(" ← ")
}

fn row(rows: &[&[&str]], name: &str) -> Option<usize> {
    rows.iter().position(|row| row.contains(&name))
}

/// Everything that breaks the order, sorted.
pub fn check(root: &Path, crates: &Crates) -> Vec<Finding> {
    let mut out = check_drawing(&read(root, DRAWING).unwrap_or_default());
    out.extend(manifests(root).map_or_else(|e| vec![Finding::new("Cargo.toml", 0, e)], |all| check_crates(&all)));
    match crates.get(OWNER) {
        Some(Ok(sources)) => out.extend(check_modules(&sources.files, &sources.uses)),
        // The check of circles reports it.
        Some(Err(_)) => {}
        None => out.push(Finding::new(SOURCES, 0, "is not there")),
    }
    out.sort_unstable();
    // A group of imports names its module more than once.
    out.dedup();
    out
}

/// The drawing says what the tables say, however its lines are broken.
fn check_drawing(drawing: &str) -> Vec<Finding> {
    let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let drawing = flat(&drawing.replace('`', ""));
    [("crates", order_of_crates()), ("modules", order_of_modules())]
        .into_iter()
        .filter(|(_, order)| !drawing.contains(&flat(order)))
        .map(|(of, order)| Finding::new(DRAWING, 0, format!("does not quote the order of the {of}: {order}")))
        .collect()
}

/// What cargo reads in the manifests of the workspace.
fn manifests(root: &Path) -> Result<Value, String> {
    let mut command = Command::new(cargo());
    command.args(["metadata", "--no-deps", "--format-version", "1"]).current_dir(root);
    let output = command.output().map_err(|e| format!("cargo did not start: {e}"))?;
    serde_json::from_slice(&output.stdout).map_err(|_| String::from_utf8_lossy(&output.stderr).into_owned())
}

fn check_crates(manifests: &Value) -> Vec<Finding> {
    let all = |list: &Value| list.as_array().cloned().unwrap_or_default();
    let name = |of: &Value| of["name"].as_str().unwrap_or_default().to_string();
    let mut out = Vec::new();
    for package in all(&manifests["packages"]) {
        let file = format!("crates/{}/Cargo.toml", name(&package));
        let Some(own) = row(CRATES, &name(&package)) else {
            out.push(Finding::new(file, 0, no_room("crate", &name(&package))));
            continue;
        };
        let dependencies = all(&package["dependencies"]).into_iter().filter(|of| of["kind"] != "dev");
        for dependency in dependencies.filter(|of| row(CRATES, &name(of)).is_some_and(|row| row >= own)) {
            let (user, used, order) = (name(&package), name(&dependency), order_of_crates());
            out.push(Finding::new(&file, 0, format!("{user} depends on {used} against the order {order}")));
        }
    }
    out
}

/// The module of `maille` that a file below `src` belongs to; none for the crate's root.
fn module(file: &str) -> Option<&str> {
    let top = file.split('/').next().unwrap_or(file).trim_end_matches(".rs");
    (top != "lib").then_some(top)
}

/// Checks the sources of `maille`, by their paths below `src`.
fn check_modules(files: &BTreeMap<String, String>, uses: &[Use]) -> Vec<Finding> {
    let found = |file: &str, line, problem| Finding::new(format!("{SOURCES}/{file}"), line, problem);
    let mut out = Vec::new();
    for (file, text) in files {
        let Some(own) = module(file) else { continue };
        if !has_room(own) {
            out.push(found(file, 0, no_room("module", own)));
        }
        let code = text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
        for (index, _) in code.filter(|(_, line)| own == ASIDE && line.contains("maille_geometry")) {
            let problem = format!("{ASIDE} stands aside and knows no ring: no maille_geometry");
            out.push(found(file, index + 1, problem));
        }
    }
    for u in uses {
        // The crate's root stands above all modules.
        let Some(own) = module(&u.from) else { continue };
        let problem = match module(&u.to) {
            Some(name) => judge_use(own, name),
            None => Some(format!("{own} uses what stands in the crate's root: name its module in the path")),
        };
        out.extend(problem.map(|problem| found(&u.from, u.line, problem)));
    }
    out
}

/// What is wrong with a use of module `name` in module `own`.
fn judge_use(own: &str, name: &str) -> Option<String> {
    if own == name {
        return None;
    }
    if own == ASIDE {
        return Some(format!("{own} uses {name}: {ASIDE} stands aside and uses no other module"));
    }
    if name == ASIDE {
        let allowed = ASIDE_USERS.contains(&own);
        return (!allowed).then(|| format!("{own} uses {name}: only {} use it", ASIDE_USERS.join(", ")));
    }
    // A module without a room is reported by itself.
    let backward = row(MODULES, name) > Some(row(MODULES, own)?);
    backward.then(|| format!("{own} uses {name}, which stands after it: {}", line(MODULES)))
}

fn has_room(module: &str) -> bool {
    module == ASIDE || row(MODULES, module).is_some()
}

fn no_room(what: &str, name: &str) -> String {
    let table = "crates/xtask/src/layers.rs";
    format!("{what} {name} has no room: draw it in {DRAWING} first, then give it a row in {table}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Findings on a source of `maille` beside one file for each module.
    fn problems(file: &str, source: &str) -> Vec<(usize, String)> {
        let modules = || MODULES.concat().into_iter().chain([ASIDE]);
        let mut files: BTreeMap<String, String> =
            modules().map(|name| (format!("{name}.rs"), "pub struct Thing; pub fn run() {}".into())).collect();
        let root: String = modules().map(|name| format!("pub mod {name};\n")).collect();
        files.insert("lib.rs".into(), root + "pub use state::Thing as Passed; pub use outside::Other;");
        if let Some((top, name)) = file.split_once('/') {
            let (name, _) = name.split_once('.').unwrap();
            files.insert(format!("{top}.rs"), format!("mod {name};"));
        }
        files.insert(file.into(), source.into());
        let uses = crate::uses::uses(&files).unwrap();
        check_modules(&files, &uses).into_iter().map(|f| (f.line, f.problem)).collect()
    }

    fn only(file: &str, source: &str) -> (usize, String) {
        let found = problems(file, source);
        assert_eq!(found.len(), 1, "{found:?}");
        found.into_iter().next().unwrap()
    }

    #[test]
    fn a_backward_use_is_found_with_its_line() {
        let (line, problem) =
            only("state.rs", "//! State.\n\nuse crate::{\n    model::Thing,\n    relaxation::Thing as Other,\n};\n");
        assert_eq!(line, 5);
        assert!(problem.starts_with("state uses relaxation, which stands after it: lattice ←"), "{problem}");
        assert_eq!(only("program/gap_kernel.rs", "fn f() -> crate::search::Thing {}").0, 1);
        assert_eq!(only("lattice.rs", "use super::model::Thing;").0, 1);
        assert_eq!(only("lattice.rs", "\nmod tests {\n use super::super::model::Thing;\n}").0, 3);
        assert_eq!(only("lattice.rs", "#[cfg(test)]\nmod tests {\n use crate::model::run;\n}").0, 3);
        assert_eq!(only("lattice.rs", "use crate::Passed;").0, 1, "what the root passes on is its module's");
    }

    #[test]
    fn forward_uses_and_uses_within_a_row_are_fine() {
        let source = "use crate::{lattice, lattice::Thing, model::Thing as A, state::Thing as B, topology};";
        assert_eq!(problems("model.rs", source), []);
        assert_eq!(problems("topology/links.rs", source), []);
        assert_eq!(problems("search.rs", "use crate::{relaxation::run, record::Thing, solver::Thing as A};"), []);
        assert_eq!(problems("search.rs", "use crate::Passed; use crate as root; use super::{self as top};"), []);
        assert_eq!(problems("search.rs", "use crate::solver; fn f() { solver::run() }"), []);
    }

    #[test]
    fn the_solver_stands_aside() {
        assert_eq!(problems("solver/newton.rs", "use super::eigen; use crate::solver::newton::run; fn run() {}"), []);
        assert!(only("solver/newton.rs", "use crate::lattice::Thing;").1.contains("uses no other module"));
        assert!(only("solver/newton.rs", "\nuse maille_geometry::Vec3;").1.contains("knows no ring"));
        assert!(only("topology.rs", "use crate::solver::Thing;").1.contains("fit use it"));
        assert_eq!(problems("relaxation/limit.rs", "use crate::solver::Thing;"), []);
    }

    #[test]
    fn a_module_without_a_room_is_found() {
        assert!(only("shear.rs", "").1.contains("module shear has no room"));
    }

    #[test]
    fn a_path_that_hides_its_module_is_found() {
        for source in ["use crate::*;", "use crate::Other;", "fn f(x: super::Unknown) {}"] {
            assert!(only("search.rs", source).1.contains("name its module"), "{source}");
        }
    }

    #[test]
    fn a_manifest_against_the_order_is_found() {
        let found = |name: &str, dependencies: &[(&str, Option<&str>)]| {
            let dependencies: Vec<Value> =
                dependencies.iter().map(|(name, kind)| json!({ "name": name, "kind": kind })).collect();
            let manifests = json!({ "packages": [{ "name": name, "dependencies": dependencies }] });
            check_crates(&manifests).into_iter().map(|f| f.problem).collect::<Vec<_>>()
        };
        let backward = [("serde", None), ("maille-io", None)];
        assert!(found("maille", &backward)[0].starts_with("maille depends on maille-io against the order maille-geo"));
        assert_eq!(found("maille-cli", &backward), [""; 0]);
        assert_eq!(found("maille", &[("maille-io", Some("dev"))]), [""; 0]);
        assert_eq!(found("maille", &[("maille-cli", Some("build"))]).len(), 1);
        assert_eq!(found("maille-view", &[("maille-cli", None)]).len(), 1);
        assert!(found("maille-shear", &[])[0].starts_with("crate maille-shear has no room"));
    }

    #[test]
    fn the_drawing_quotes_the_order() {
        let drawing =
            format!("# Rooms\n\n    {}\n\n`{}`\n", order_of_crates(), order_of_modules().replacen(" ← ", " ←\n", 3));
        assert_eq!(check_drawing(&drawing), []);
        assert_eq!(check_drawing("").len(), 2);
        assert_eq!(check_drawing(&drawing.replace("lattice ←", "")).len(), 1);
    }

    #[test]
    fn the_tables_name_everything_once() {
        for rows in [CRATES, MODULES] {
            let mut names: Vec<&str> = rows.concat();
            names.sort_unstable();
            let all = names.len();
            names.dedup();
            assert_eq!(names.len(), all);
        }
        assert!(row(MODULES, ASIDE).is_none());
        assert!(ASIDE_USERS.iter().all(|user| row(MODULES, user).is_some()));
    }
}
