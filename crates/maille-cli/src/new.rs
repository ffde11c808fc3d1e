//! `maille new`: a design file for a weave with a name.

use crate::{
    exit::{self, wrong},
    extreme,
    input::{Input, file_name},
    numbers::positive,
    output,
    units::{Length, parse_length, parse_wire, without_rounding},
};
use maille::{design::Design, lattice::Cell, model::Model, topology};
use maille_io::{
    DESIGN_JSON_SCHEMA, millimetres,
    weave::{Rings, Weave, WeaveError},
};
use miette::{Report, Result, miette};
use std::path::PathBuf;

/// Name of the schema beside a new design.
const SCHEMA: &str = "maille.schema.json";

/// A design file for a weave with a name
///
/// Writes a TOML file with comments, to be changed at will. All rings are alike; they are placed so that the smallest
/// gap is as large as it can be. Proportions that do not assemble are refused, with the wire that would do.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille new shirt --weave european-4-in-1 --major 4.9 --minor 1.15
  maille new shirt --weave european-6-in-1 --wire 16swg --id 3/8in
  maille new cuff --weave japanese-12-in-2 --wire 0.8mm --id 6mm -o designs/cuff.toml
  maille new cuff --weave kings-mail --wire 16awg --id 7/16in -o - | maille inspect -
  maille new swatch --weave european-4-in-1 --wire 1.6mm --id 8mm --min-gap 0.3mm

Wires: a diameter as 1.6mm or 0.064in, or a gauge: 16swg (British), 16awg (American).

A schema for editors, maille.schema.json, is written beside the file if it is not there yet: with taplo, or an editor
that uses it, fields are completed and checked. --no-schema leaves it out.")]
pub struct Args {
    /// Name of the design, and of its file without .toml
    #[arg(value_parser = without_ending)]
    name: String,
    /// The weave
    #[arg(long, value_enum)]
    weave: WeaveArg,
    /// Major radius R, from the centre of a ring to the middle of its wire
    #[arg(long, value_parser = positive, requires = "minor")]
    major: Option<f64>,
    /// Minor radius r, half of the wire's diameter
    #[arg(long, value_parser = positive, requires = "major")]
    minor: Option<f64>,
    /// Unit of --major and --minor, and of the file
    #[arg(long, default_value = "mm")]
    unit: String,
    /// Wire, as 1.6mm, 0.064in, 16swg or 16awg; the file is in mm
    #[arg(long, value_parser = parse_wire, requires = "id", conflicts_with_all = ["major", "minor", "unit"])]
    wire: Option<Length>,
    /// Inner diameter of the rings, as 8mm or 5/16in
    #[arg(long, value_parser = parse_length, requires = "wire")]
    id: Option<Length>,
    /// Place the rings in the closest cell with every gap at least this, as 0.3mm, and not with the largest gaps
    #[arg(long, value_name = "LENGTH", value_parser = parse_length)]
    min_gap: Option<Length>,
    /// The file, or - for standard output [default: NAME.toml]
    #[arg(long, short)]
    out: Option<PathBuf>,
    #[command(flatten)]
    replace: output::Replace,
    /// Neither a schema beside the file nor a line that names it
    #[arg(long)]
    no_schema: bool,
    /// No word on what was written
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum WeaveArg {
    #[value(name = "european-4-in-1")]
    European4In1,
    #[value(name = "european-6-in-1")]
    European6In1,
    #[value(name = "japanese-4-in-1")]
    Japanese4In1,
    #[value(name = "japanese-6-in-1")]
    Japanese6In1,
    #[value(name = "japanese-8-in-2")]
    Japanese8In2,
    #[value(name = "japanese-12-in-2")]
    Japanese12In2,
    #[value(name = "kings-mail", alias = "european-8-in-2")]
    KingsMail,
}

impl WeaveArg {
    fn weave(self) -> Weave {
        match self {
            WeaveArg::European4In1 => Weave::European4In1,
            WeaveArg::European6In1 => Weave::European6In1,
            WeaveArg::Japanese4In1 => Weave::Japanese4In1,
            WeaveArg::Japanese6In1 => Weave::Japanese6In1,
            WeaveArg::Japanese8In2 => Weave::Japanese8In2,
            WeaveArg::Japanese12In2 => Weave::Japanese12In2,
            WeaveArg::KingsMail => Weave::KingsMail,
        }
    }
}

/// A design's name; whoever gives that of the file means the same.
fn without_ending(text: &str) -> Result<String, std::convert::Infallible> {
    Ok(text.strip_suffix(".toml").unwrap_or(text).to_owned())
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let rings = rings(args)?;
    let weave = args.weave.weave();
    let design = weave.design(&args.name, &rings).map_err(|e| refused(args, e))?;
    if let Some(problem) = design.problems().first() {
        return Err(wrong(exit::USAGE, problem.to_string(), &problem.help));
    }
    let (design, placed) = match args.min_gap {
        Some(gap) => closest(design, gap)?,
        None => (design, None),
    };
    let model =
        Model::compile(&design, Cell::PRIMITIVE).map_err(|p| miette!("the new design cannot be used: {}", p[0]))?;

    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", file_name(&args.name))));
    let to_file = !output::is_standard(&out);
    args.replace.check(&out)?;
    // On standard output no path of a schema would be true.
    let schema = (to_file && !args.no_schema).then(|| out.with_file_name(SCHEMA));
    let text = weave.file(&design, placed.as_deref(), schema.is_some().then_some(SCHEMA));
    output::write(&out, text.as_bytes())?;
    if let Some(schema) = schema.filter(|path| !path.exists()) {
        output::write(&schema, DESIGN_JSON_SCHEMA.as_bytes())?;
    }
    if to_file && !args.quiet {
        let gap = topology::smallest_gap(&model, &model.start).map_or(String::new(), |(gap, _)| {
            format!(", smallest gap {:.4} {}", gap * model.unit, rings.unit.as_deref().unwrap_or_default())
        });
        let (place, file) = (out.display(), output::quoted(&out.display().to_string()));
        output::say!(
            "{place}  {}: {} and {} per cell{gap}",
            design.title,
            output::counted(model.rings.len(), "ring"),
            output::counted(model.links.len(), "link")
        );
        output::say!("see it with   maille render {file}\nits limits    maille characterize {file}");
    }
    Ok(())
}

/// The same design in its closest cell with this gap, and what to say of the placement.
fn closest(design: Design, gap: Length) -> Result<(Design, Option<String>)> {
    let Some(mm) = design.unit.as_deref().and_then(millimetres) else {
        let problem =
            format!("--min-gap needs a unit of length, and \"{}\" is not known", design.unit.unwrap_or_default());
        return Err(wrong(exit::USAGE, problem, "--unit takes mm, cm, m, um, in and ft"));
    };
    let input = Input::of(design);
    let what = extreme::closest(&input.design, gap.mm / mm);
    let (found, _) = extreme::as_design(&input, what, None, None)?;
    let placement = format!(
        "The placement is the closest cell: the smallest area that was found where every gap is at least {} mm",
        gap.mm
    );
    let Design { name, title, .. } = input.design;
    Ok((Design { name, title, ..found }, Some(placement)))
}

fn rings(args: &Args) -> Result<Rings> {
    let (major, minor, unit) = match (args.wire.zip(args.id), args.major.zip(args.minor)) {
        (Some((wire, id)), _) => {
            // The rounding of sums alone, so that the inner diameter is the one that was asked for.
            (without_rounding((id.mm + wire.mm) / 2.0), without_rounding(wire.mm / 2.0), "mm")
        }
        (None, Some((major, minor))) => (major, minor, args.unit.as_str()),
        (None, None) => {
            let help = "give --major and --minor, or --wire and --id";
            return Err(wrong(exit::USAGE, "the size of the rings is missing", help));
        }
    };
    Ok(Rings { major, minor, unit: Some(unit.into()) })
}

/// Where wire and inner diameter are given, the help speaks of them.
fn refused(args: &Args, error: WeaveError) -> Report {
    let WeaveError::TooThick { major, thickest, .. } = &error else {
        let help = miette::Diagnostic::help(&error).map_or(String::new(), |h| h.to_string());
        return wrong(exit::USAGE, error.to_string(), help);
    };
    let help = match args.wire.zip(args.id) {
        None => miette::Diagnostic::help(&error).map_or(String::new(), |h| h.to_string()),
        Some((wire, id)) => {
            // The rings touch where wire = d (id + wire)/2, with d the least distance of core circles by R.
            let d = 2.0 * thickest / major;
            let (thin, wide) = (d * id.mm / (2.0 - d), wire.mm * (2.0 - d) / d);
            let gauge = wire.gauge.and_then(|g| g.thinner(thin)).map_or(String::new(), |g| format!(", as {g}"));
            format!(
                "an inner diameter of {:.4} mm takes wire thinner than {thin:.3} mm{gauge}; wire of {:.4} mm takes inner \
                 diameters above {wide:.3} mm",
                id.mm, wire.mm
            )
        }
    };
    wrong(exit::USAGE, error.to_string(), help)
}
