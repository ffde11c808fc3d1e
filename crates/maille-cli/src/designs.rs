//! `maille designs`: the built-in designs with a line each.

use crate::{input::built_in_file, output};
use maille_io::{builtin_designs, read_design};
use miette::Result;
use serde_json::json;

/// The built-in designs, with a line each
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille designs
  maille designs --file byzantine > mine.toml       the file of one, as a start for your own
  maille designs --json | jq -r '.designs[].name'")]
pub struct Args {
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// Print the file of one
    #[arg(long, value_name = "NAME", conflicts_with = "json")]
    file: Option<String>,
}

/// Prints the list.
pub fn run(args: &Args) -> Result<()> {
    if let Some(name) = &args.file {
        return output::print(built_in_file(name)?.as_bytes());
    }
    let designs: Vec<_> =
        builtin_designs().iter().map(|entry| read_design(entry.name, entry.toml)).collect::<Result<_, _>>()?;
    let rings =
        |design: &maille::design::Design| design.elements.iter().map(|e| e.rings.len() + e.curves.len()).sum::<usize>();
    if args.json {
        let list: Vec<_> = designs
            .iter()
            .map(|d| {
                json!({
                    "name": d.name,
                    "title": d.title,
                    "source": d.source,
                    "unit": d.unit,
                    "single": d.lattice.single,
                    "elements": d.elements.len(),
                    "rings": rings(d),
                    "curves": d.elements.iter().map(|e| e.curves.len()).sum::<usize>(),
                    "minor_radius": d.minor_radius,
                    "reference_radius": d.reference_radius,
                })
            })
            .collect();
        return output::print_json(&json!({ "designs": list }));
    }
    let mut text = format!("{:<16} {:>8} {:>6}  title\n", "name", "elements", "rings");
    for design in &designs {
        let (elements, rings) = (design.elements.len(), rings(design));
        text += &format!("{:<16} {elements:>8} {rings:>6}  {}\n", design.name, design.title);
    }
    text += "\nmaille inspect NAME shows one; maille characterize NAME finds its limits.\n";
    output::print(text.as_bytes())
}
