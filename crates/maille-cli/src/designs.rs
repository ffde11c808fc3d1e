//! `maille designs`: the built-in designs with a line each.

use maille_io::{builtin_designs, read_design};
use miette::Result;

/// The built-in designs, with a line each
#[derive(clap::Args)]
pub struct Args {}

/// Prints the list.
pub fn run(_: &Args) -> Result<()> {
    println!("{:<6} {:>8} {:>6}  title", "name", "elements", "rings");
    for entry in builtin_designs() {
        let design = read_design(entry.name, entry.toml)?;
        let rings: usize = design.elements.iter().map(|e| e.rings.len()).sum();
        println!("{:<6} {:>8} {rings:>6}  {}", design.name, design.elements.len(), design.title);
    }
    println!("\nmaille inspect NAME shows one; maille characterize NAME finds its limits.");
    Ok(())
}
