//! `maille schema`: the JSON Schema of design files.

use crate::output;
use maille_io::DESIGN_JSON_SCHEMA;
use miette::Result;
use std::path::PathBuf;

/// The JSON Schema of design files, for editors
///
/// With a first line `#:schema maille.schema.json` in a design, taplo and editors that use it complete and check fields.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille schema
  maille schema -o maille.schema.json
  taplo lint --schema file://$PWD/maille.schema.json my-weave.toml")]
pub struct Args {
    /// The file, or - for standard output
    #[arg(long, short, default_value = "-")]
    out: PathBuf,
    #[command(flatten)]
    replace: output::Replace,
}

/// Writes the schema.
pub fn run(args: &Args) -> Result<()> {
    args.replace.check(&args.out)?;
    output::write(&args.out, DESIGN_JSON_SCHEMA.as_bytes())
}
