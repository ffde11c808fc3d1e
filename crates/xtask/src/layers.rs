//! The layer check: dependencies point one way, between the crates and between the modules of `maille`.
//!
//! The tables here are the one place where the order is stated. `ARCHITECTURE.md` quotes the two lines that
//! `cargo xtask layers` prints, and the check compares them. A crate or module without a row fails: its room is drawn
//! first, in `ARCHITECTURE.md` and here.

use crate::{
    repository::{Finding, files, read},
    source::{self, NamedPath, Source},
};
use std::path::Path;

/// The crates, lowest first. A crate depends only on crates of the rows before its own; dev-dependencies are free.
const CRATES: &[&[&str]] = &[
    &["maille-geometry"],
    &["maille", "maille-verify"],
    &["maille-io"],
    &["maille-chapter6", "maille-view", "maille-fuzz"],
    &["maille-cli", "maille-py"],
    &["xtask"],
];

/// The modules of `maille`, lowest first. A module uses its own row and the rows before it. The check covers unit
/// tests as well: a test that needs a later module belongs into the crate's `tests` folder.
const MODULES: &[&[&str]] = &[
    &["error"],
    &["design"],
    &["lattice"],
    &["model", "state", "topology", "symmetry"],
    &["program", "bound"],
    &["record"],
    &["question", "answer"],
    &["search", "relaxation"],
    &["survey"],
    &["sheet"],
];

/// Stands aside from the order: it uses no other module and no ring, and only [`ASIDE_USERS`] use it.
const ASIDE: &str = "solver";
const ASIDE_USERS: &[&str] = &["program", "bound", "answer", "search", "relaxation", "survey"];

/// Where the modules of [`MODULES`] live.
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
pub fn check(root: &Path) -> Vec<Finding> {
    let mut out = check_drawing(&read(root, DRAWING).unwrap_or_default());
    out.extend(check_crates(root));
    match files(root, SOURCES, "rs") {
        Err(e) => out.push(Finding::new(SOURCES, 0, format!("cannot be read: {e}"))),
        Ok(sources) => {
            for file in sources {
                match read(root, &file) {
                    Ok(source) => out.extend(check_module(&file, &source)),
                    Err(finding) => out.push(finding),
                }
            }
        }
    }
    out.sort_unstable();
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

fn check_crates(root: &Path) -> Vec<Finding> {
    let folders = match std::fs::read_dir(root.join("crates")) {
        Ok(folders) => folders.flatten().map(|f| f.file_name().to_string_lossy().into_owned()),
        Err(e) => return vec![Finding::new("crates", 0, format!("cannot be read: {e}"))],
    };
    let mut out = Vec::new();
    for folder in folders {
        let file = format!("crates/{folder}/Cargo.toml");
        match read(root, &file) {
            Ok(manifest) => out.extend(check_manifest(&file, &folder, &manifest)),
            Err(finding) => out.push(finding),
        }
    }
    out
}

/// Checks one manifest. Dependencies are read line by line: `[dependencies]` and its kin for builds and targets, as
/// keys, as headers (`[dependencies.maille]`) or renamed (`package = "maille"`).
fn check_manifest(file: &str, name: &str, manifest: &str) -> Vec<Finding> {
    let Some(own) = row(CRATES, name) else {
        return vec![Finding::new(file, 0, no_room("crate", name))];
    };
    let mut out = Vec::new();
    let mut judge = |line: usize, dependency: &str| {
        if row(CRATES, dependency).is_some_and(|row| row >= own) {
            let order = order_of_crates();
            out.push(Finding::new(file, line, format!("{name} depends on {dependency} against the order {order}")));
        }
    };
    let mut inside = false;
    for (index, text) in manifest.lines().enumerate() {
        let text = text.split('#').next().unwrap_or_default().trim();
        if let Some(header) = text.strip_prefix('[') {
            let parts: Vec<&str> = header.trim_end_matches(']').split('.').map(str::trim).collect();
            let kind = parts.iter().position(|part| matches!(*part, "dependencies" | "build-dependencies"));
            inside = kind.is_some();
            if let Some(dependency) = kind.and_then(|at| parts.get(at + 1)) {
                judge(index + 1, unquoted(dependency));
            }
        } else if inside && let Some((key, value)) = text.split_once('=') {
            let key = unquoted(key.split('.').next().unwrap_or_default());
            judge(index + 1, key);
            let renamed = if key == "package" { Some(value) } else { value.split_once("package").map(|v| v.1) };
            let package = renamed.and_then(|text| text.split('"').nth(1));
            if let Some(package) = package.filter(|package| *package != key) {
                judge(index + 1, package);
            }
        }
    }
    out
}

fn unquoted(text: &str) -> &str {
    text.trim().trim_matches('"')
}

/// Checks one source file of `maille`; `file` is its path from the repository's root.
fn check_module(file: &str, source: &str) -> Vec<Finding> {
    let path = file.strip_prefix(SOURCES).unwrap_or(file).trim_start_matches('/').trim_end_matches(".rs");
    let mut module: Vec<String> = path.split('/').map(str::to_string).collect();
    if matches!(module.last().map(String::as_str), Some("mod")) || module == ["lib"] {
        module.pop();
    }
    let Source { modules, paths, .. } = match source::read(source) {
        Ok(source) => source,
        Err(e) => return vec![Finding::new(file, e.span().start().line, format!("cannot be read: {e}"))],
    };
    let mut out = Vec::new();
    match module.first() {
        Some(own) if !has_room(own) => out.push(Finding::new(file, 0, no_room("module", own))),
        Some(_) => {}
        // The root: every module that it declares has a room, inline ones too.
        None => {
            for (name, line) in modules.iter().flat_map(|(path, line)| Some((path.last()?, *line))) {
                if !has_room(name) {
                    out.push(Finding::new(file, line, no_room("module", name)));
                }
            }
        }
    }
    for path in &paths {
        let from = [module.as_slice(), &path.module].concat();
        // The crate's root stands above all modules.
        let Some(own) = from.first() else { continue };
        if let Some((name, line)) = from_root(path, from.len())
            && let Some(problem) = judge_use(own, name)
        {
            out.push(Finding::new(file, line, problem));
        }
        if own == ASIDE && path.names()[0] == "maille_geometry" {
            let problem = format!("{ASIDE} stands aside and knows no ring: no maille_geometry");
            out.push(Finding::new(file, path.line(), problem));
        }
    }
    // A group of imports names its module more than once.
    out.dedup();
    out
}

/// The name that a path takes from the crate's root, or what stands in its place (`*`, `as`): by `crate::…` and by
/// chains of `self::` and `super::` that are `depth` modules high.
fn from_root(path: &NamedPath, depth: usize) -> Option<(&str, usize)> {
    let names = path.names();
    let up = names.iter().take_while(|name| matches!(**name, "crate" | "self" | "super")).count();
    let supers = names[..up].iter().filter(|name| **name == "super").count();
    if names[0] != "crate" && (supers == 0 || supers < depth) {
        return None;
    }
    match path.segments.get(up) {
        Some((name, line)) => Some((name, *line)),
        None => path.import.is_some().then(|| ("as", path.line())),
    }
}

/// What is wrong with a use of module `name` in module `own`.
fn judge_use(own: &str, name: &str) -> Option<String> {
    if !has_room(name) {
        return Some(if name.starts_with(|c: char| c.is_lowercase()) && name != "as" {
            format!("{own} uses {name}: {}", no_room("module", name))
        } else {
            format!("`{name}` straight from the crate's root hides its module: name the module in the path")
        });
    }
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

    fn problems(file: &str, source: &str) -> Vec<(usize, String)> {
        check_module(&format!("{SOURCES}/{file}"), source).into_iter().map(|f| (f.line, f.problem)).collect()
    }

    fn only(file: &str, source: &str) -> (usize, String) {
        let found = problems(file, source);
        assert_eq!(found.len(), 1, "{found:?}");
        found.into_iter().next().unwrap()
    }

    #[test]
    fn a_backward_use_is_found_with_its_line() {
        let (line, problem) =
            only("state.rs", "//! State.\n\nuse crate::{\n    model::Model,\n    relaxation::SheetEnergy,\n};\n");
        assert_eq!(line, 5);
        assert!(problem.starts_with("state uses relaxation, which stands after it: error ← design ←"), "{problem}");
        assert_eq!(only("program/gap_kernel.rs", "fn f() -> crate::search::Search {}").0, 1);
        assert_eq!(only("design.rs", "use super::lattice::Cell;").0, 1);
        assert_eq!(only("design.rs", "\nmod tests {\n use super::super::lattice::Cell;\n}").0, 3);
    }

    #[test]
    fn forward_uses_and_uses_within_a_row_are_fine() {
        let source = "use crate::{error::InvalidInput, lattice, model::Model, state::State, topology};";
        assert_eq!(problems("model.rs", source), []);
        assert_eq!(problems("topology/links.rs", source), []);
        assert_eq!(
            problems("search.rs", "use crate::{relaxation::target, record::Status, solver::newton, search::Search};"),
            []
        );
        assert_eq!(problems("lib.rs", "pub mod search; pub use crate::search::Search;"), []);
    }

    #[test]
    fn the_solver_stands_aside() {
        assert_eq!(problems("solver/newton.rs", "use super::eigen; use crate::solver::eigen::symmetric_eigen;"), []);
        assert!(only("solver/newton.rs", "use crate::error::InvalidInput;").1.contains("uses no other module"));
        assert!(only("solver/newton.rs", "\nuse maille_geometry::Vec3;").1.contains("knows no ring"));
        assert!(only("topology.rs", "use crate::solver::newton;").1.contains("survey use it"));
        assert_eq!(problems("relaxation/mod.rs", "use crate::solver::newton::Objective;"), []);
    }

    #[test]
    fn a_module_without_a_room_is_found() {
        assert!(only("shear.rs", "").1.contains("module shear has no room"));
        assert!(only("search.rs", "use crate::shear::Shear;").1.contains("module shear has no room"));
        assert_eq!(only("lib.rs", "pub mod search;\nmod shear { use super::search::Search; }").0, 2);
    }

    #[test]
    fn a_path_that_hides_its_module_is_found() {
        for source in ["use crate::*;", "use crate::Vec3;", "use crate as root;", "use super::{self as root};"] {
            assert!(only("search.rs", source).1.contains("name the module"), "{source}");
        }
    }

    #[test]
    fn a_manifest_against_the_order_is_found() {
        let lines = |name: &str, manifest: &str| -> Vec<usize> {
            check_manifest("Cargo.toml", name, manifest).iter().map(|f| f.line).collect()
        };
        let backward =
            "[package]\nname = \"maille\"\n[dependencies]\nserde = \"1\"\nmaille-io.workspace = true # why\n";
        assert_eq!(lines("maille", backward), [5]);
        assert_eq!(lines("maille-cli", backward), [] as [usize; 0]);
        assert_eq!(
            lines("maille", "[dev-dependencies]\nmaille-io.workspace = true\n[dev-dependencies.xtask]\n"),
            [] as [usize; 0]
        );
        assert_eq!(lines("maille", "[dependencies.maille-io]\npath = \"../maille-io\"\n"), [1]);
        assert_eq!(lines("maille", "[dependencies.io]\npackage = \"maille-io\"\n"), [2]);
        assert_eq!(lines("maille", "[dependencies]\nio = { package = \"maille-io\", path = \"x\" }\n"), [2]);
        assert_eq!(lines("maille", "[target.'cfg(unix)'.build-dependencies]\n\"maille-cli\" = \"1\"\n"), [2]);
        assert_eq!(
            lines("maille-cli", "[dependencies]\nmaille-view = { workspace = true, optional = true }\n"),
            [] as [usize; 0]
        );
        assert_eq!(lines("maille-view", "[dependencies]\nmaille-cli.workspace = true\n"), [2]);
        assert_eq!(lines("maille-shear", ""), [0]);
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
