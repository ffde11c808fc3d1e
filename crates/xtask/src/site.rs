//! `cargo xtask site`: the documents, the viewers of all built-in designs, the notebooks and the reference pages as one
//! folder of static pages, which opens from the disk.

mod link;
mod source;

use crate::{
    atlas::TABLE,
    folder::{copy, copy_file, remove},
    package,
    program::{self, cargo, done, installed, target},
    repository::Finding,
    view,
    wheel::Environment,
};
use source::{FOLDER, Source};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// The program that makes pages of Markdown, with the version that is installed below the build folder.
const MDBOOK: &str = "mdbook@0.5.4";
/// What the reference pages and notebooks are made with, beside what the Python package is tested with.
const LOCK: &str = "site/requirements.lock";
/// Packed crates without a reference page: they are no libraries.
const NO_LIBRARIES: [&str; 2] = ["maille-features", "maille-cli"];

/// Limits of the viewers; of one cell and few starts, as the gallery of all designs must be made in minutes.
const PULLS: &str =
    "--directions 0:180:15 --l2=-0.1,0,0.1 --cell 1x1 --effort low --allow-incomplete --overwrite --quiet";
const CHAIN: &str = "--cell 1x1 --effort low --allow-incomplete --overwrite --quiet";

/// Makes the site below the build folder, and checks its links and pages. `program` has the viewer; it is built if none is given.
pub fn write(root: &Path, program: Option<&str>) -> Result<(), String> {
    if let Some(finding) = check(root).first() {
        return Err(finding.to_string());
    }
    let folder = target(root).join("site");
    let book = folder.join("src");
    let program = match program {
        Some(program) => PathBuf::from(program),
        None => view::build(root)?,
    };
    let python = Environment::new(root, false)?;
    python.add(LOCK)?;
    remove(&book)?;
    Source::read(root)?.write(&book)?;
    notebooks(root, &python, &book)?;
    viewers(&program, &folder.join("viewers"))?;
    copy(&folder.join("viewers"), &book.join("viewer"))?;
    atlas(root, &program, &python, &book)?;
    for name in ["book.toml", "maille.css"] {
        copy_file(&root.join(FOLDER).join(name), &folder.join(name))?;
    }
    remove(&folder.join("book"))?;
    done(Command::new(installed(root, MDBOOK)?).arg("build").arg(&folder), "make the pages")?;
    reference(root, &python, &folder.join("book"))?;
    view::check_site(root, &folder.join("book"))?;
    println!("   {}", folder.join("book/index.html").display());
    Ok(())
}

/// Documents that the table of contents lacks, or that it names and are not there.
pub fn check(root: &Path) -> Vec<Finding> {
    source::check(root)
}

/// One file for each built-in design with its sheet, map and locked states; one that is there already is made anew
/// only for a newer program.
fn viewers(program: &Path, folder: &Path) -> Result<(), String> {
    let program = fs::canonicalize(program).map_err(|e| format!("{} is not there: {e}", program.display()))?;
    fs::create_dir_all(folder).map_err(|e| format!("{} cannot be made: {e}", folder.display()))?;
    let age = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    for design in program::designs(&program)? {
        let name = design["name"].as_str().ok_or("a design has no name")?;
        let file = folder.join(format!("{name}.html"));
        if age(&file).is_some_and(|made| age(&program).is_some_and(|built| built < made)) {
            continue;
        }
        // A chain is pulled along itself alone.
        let pulls = if design["single"] == true { CHAIN } else { PULLS };
        // The page shows the record's path as it is given here.
        let record = format!("records/{name}");
        let run = |arguments: &[&str]| {
            let mut command = Command::new(&program);
            command.args(arguments).current_dir(folder.parent().unwrap_or(folder));
            command
        };
        let mut solve = run(&["characterize", name, "--out", &record]);
        done(solve.args(pulls.split_whitespace()), &format!("compute the limits of {name}"))?;
        let mut view = run(&["view", &record, "--overwrite", "--bundle"]);
        done(view.arg(&file), &format!("make the viewer of {name}"))?;
    }
    Ok(())
}

/// The atlas's table, and the script of its page with the table in it.
fn atlas(root: &Path, program: &Path, python: &Environment, book: &Path) -> Result<(), String> {
    let table = root.join(TABLE);
    copy_file(&table, &book.join("atlas.parquet"))?;
    let file = target(root).join("site/designs.json");
    let designs = serde_json::Value::from(program::designs(program)?).to_string();
    fs::write(&file, designs).map_err(|e| format!("{} cannot be written: {e}", file.display()))?;
    let mut command = python.python();
    command.arg(root.join(FOLDER).join("atlas.py")).arg(table).arg(file).arg(book.join("atlas-data.js"));
    python.run(&mut command, "read the atlas")?;
    view::atlas(root, book)
}

/// Runs the notebooks and makes pages of them.
fn notebooks(root: &Path, python: &Environment, book: &Path) -> Result<(), String> {
    // Copies: what they write stays out of the repository.
    let copies = target(root).join("site/notebooks");
    remove(&copies)?;
    for file in crate::repository::files(root, "examples/notebooks", "ipynb").map_err(|e| e.to_string())? {
        let file = root.join(file);
        copy_file(&file, &copies.join(file.file_name().unwrap_or_default()))?;
    }
    let notebooks = fs::read_dir(&copies).map_err(|e| format!("{} cannot be read: {e}", copies.display()))?;
    let convert = ["-m", "nbconvert", "--to", "markdown", "--execute", "--log-level", "ERROR", "--output-dir"];
    let mut command = python.python();
    command.args(convert).arg(book.join("examples/notebooks")).args(notebooks.flatten().map(|file| file.path()));
    python.run(&mut command, "run the notebooks")
}

/// Reference pages of the Python package and of the crates.
fn reference(root: &Path, python: &Environment, site: &Path) -> Result<(), String> {
    let pdoc = ["-m", "pdoc", "maille", "!maille._native", "--docformat", "numpy", "-o"];
    python.run(python.python().args(pdoc).arg(site.join("python")), "make the reference of the Python package")?;
    let mut command = Command::new(cargo());
    let documented = package::CRATES.iter().filter(|name| !NO_LIBRARIES.contains(name));
    command.args(["doc", "--no-deps", "--locked"]).args(documented.flat_map(|name| ["--package", name]));
    // A folder of its own: the other one may have pages of what is gone.
    let built = target(root).join("site/rust");
    remove(&built)?;
    command.current_dir(root).args(["--target-dir"]).arg(&built);
    done(&mut command, "make the reference of the crates")?;
    copy(&built.join("doc"), &site.join("rust"))
}
