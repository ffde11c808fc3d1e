//! Chores of the repository: `cargo xtask test`, `cargo xtask ci`, and the checks that `ci` is made of.
//!
//! It depends on little and has a profile of its own, so that the first command after a clone starts soon.

mod atlas;
mod bench;
mod certify;
mod circles;
mod crates;
mod features;
mod folder;
mod gallery;
mod layers;
mod package;
mod paths;
mod program;
mod repository;
mod site;
mod steps;
mod suite;
mod uses;
mod view;
mod wheel;

use package::Recipes;
use std::process::ExitCode;
use suite::Kind;

const HELP: &str = "\
cargo xtask COMMAND

  test     every test there is: of Rust, of the Python package, of the viewer in a browser; first says what it will
           install, and what it skips. Ends with 0 if all ran and passed, 1 if something failed, 3 if some were skipped
           --all           those that take minutes as well: ignored tests, certify --quick; keeps their results in
                           validation/long-tests.md
  view     build the viewer's page, and the program with it (target/release/maille); needs Node.js
  wheel    build the Python package, install it into a new environment below target, run its examples
  ci       format, layers, features, paths, clippy, rustdoc, then test; what is skipped has failed
  layers   no `use` points backward in the order of crates and modules, or in a circle
  features all builds of the tests ask for the same features of each library
  paths    every path named in the documents exists
  gallery  write docs/gallery: pictures, plots and numbers of every built-in design, by the program
           --quick         few directions, into maille-out/gallery
           --program PATH  this program; otherwise it is built
  certify  maps of all built-in designs and of random ones, each row verified, as validation/certified.csv; a quarter
           of an hour; goes on where it was stopped
           --quick         few designs and directions, in minutes, beside their records in maille-out/certify
           --program PATH  this program; otherwise it is built
           --limit-s N     time for one map and for its verification, each [default: 1800]
           --threads N     threads of the program [default: all cores]
  atlas    limits of every built-in weave with 31 wires and 19 spacings, as site/atlas.parquet; half an hour; goes on where
           it was stopped
           --quick         few of them, into maille-out/atlas-quick.parquet
           --program PATH  this program; otherwise it is built
  site     write target/site/book: documents, viewers of all designs, notebooks and reference as static pages, and check
           them in a browser; installs mdBook below target
           --program PATH  this program, with the viewer; otherwise it is built
  package  build what a release consists of, into target/release-files: archive, Debian package, wheel, source, installer,
           checksums
           --try           install that into a Debian without Rust, and run it there; needs root
  recipes  fill in the recipes for conda-forge and Homebrew, after `package`, into target/recipes
           --repository URL --maintainer NAME  the project's address and an account, which they name
           --try             with an example's address; build and test by them, without conda-forge and Homebrew; needs Ruby
  publish  try to publish every crate, in order, without doing so
  bench    every bench, and docs/performance.md from it; close other programs first
           --from FILE     from what `cargo bench` has printed to FILE
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let root = match repository::root() {
        Ok(root) => root,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::FAILURE;
        }
    };
    let done = match words[..] {
        ["test"] => return steps::code(suite::run(&root, Kind::Test)),
        ["test", "--all"] => return steps::code(suite::run(&root, Kind::All)),
        ["ci"] => return steps::code(suite::run(&root, Kind::Ci)),
        // A step of these, which they start.
        ["step", name] => steps::failed(steps::one(&root, name)),
        ["view"] => steps::view(&root),
        ["wheel"] => steps::wheel(&root),
        ["layers"] => steps::layers(&root),
        ["features"] => steps::features(&root),
        ["paths"] => steps::paths(&root),
        ["gallery"] => steps::failed(gallery::write(&root, false, None)),
        ["gallery", "--quick"] => steps::failed(gallery::write(&root, true, None)),
        ["gallery", "--program", program] => steps::failed(gallery::write(&root, false, Some(program))),
        ["gallery", "--quick", "--program", program] => steps::failed(gallery::write(&root, true, Some(program))),
        ["atlas"] => steps::failed(atlas::write(&root, false, None)),
        ["atlas", "--quick"] => steps::failed(atlas::write(&root, true, None)),
        ["atlas", "--program", program] => steps::failed(atlas::write(&root, false, Some(program))),
        ["atlas", "--quick", "--program", program] => steps::failed(atlas::write(&root, true, Some(program))),
        ["site"] => steps::site(&root, None),
        ["site", "--program", program] => steps::site(&root, Some(program)),
        ["package"] => steps::failed(package::write(&root)),
        ["package", "--try"] => steps::failed(package::try_clean(&root)),
        ["recipes", "--repository", repository, "--maintainer", maintainer] => {
            steps::failed(package::recipes(&root, Recipes::Of { repository, maintainer }))
        }
        ["recipes", "--try"] => steps::failed(package::recipes(&root, Recipes::Try)),
        ["publish"] => steps::failed(package::publish(&root)),
        ["bench"] => steps::failed(bench::write(&root, None)),
        ["bench", "--from", file] => steps::failed(bench::write(&root, Some(file))),
        ["certify", ref options @ ..] => steps::failed(certify::run(&root, options)),
        [] | ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprintln!("xtask: unknown command `{}`\n\n{HELP}", words.join(" "));
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // The step has said why.
        Err(steps::Failed) => ExitCode::FAILURE,
    }
}
