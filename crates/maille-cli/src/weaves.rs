//! `maille weaves`: which wire and which inner diameter suit which weave.

use crate::{
    output,
    units::{Gauge, Length, parse_length, parse_wire},
};
use maille::{lattice::Cell, model::Model, topology};
use maille_io::weave::{Rings, Weave};
use miette::Result;
use serde_json::{Value, json};

/// Which wire and which inner diameter suit which weave
///
/// Lists the named weaves with the smallest aspect ratio (inner diameter / wire diameter) of each, below which its rings
/// do not fit, the least demanding first: rings that suit one suit all above it. A larger ratio always fits; the weave is looser.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille weaves                             the smallest aspect ratio of each weave
  maille weaves --wire 16swg                the inner diameters that this wire takes
  maille weaves --id 5/16in                 the wires that this inner diameter takes
  maille weaves --wire 1.6mm --id 8mm       which weaves these rings make, and how near the rings are
  maille new shirt --weave european-4-in-1 --wire 16swg --id 5/16in

The ratios are those of the placement that `maille new` writes, for rigid round rings without a seam. Rings that are closed by hand \
need a little more. `maille tightest NAME` searches for the thickest wire in any placement.")]
pub struct Args {
    /// Wire, as 1.6mm, 0.064in, 16swg or 16awg
    #[arg(long, value_parser = parse_wire)]
    wire: Option<Length>,
    /// Inner diameter of the rings, as 8mm or 5/16in
    #[arg(long, value_parser = parse_length)]
    id: Option<Length>,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
}

/// A weave with what is known of it for the rings that were asked for. Lengths in millimetres.
struct Row {
    weave: Weave,
    smallest: f64,
    /// Smallest inner diameter for the wire.
    inner_above: Option<f64>,
    /// Thickest wire for the inner diameter.
    wire_below: Option<f64>,
    /// The smallest gap of rings of both; none where they do not fit.
    gap: Option<f64>,
}

/// Prints the table.
pub fn run(args: &Args) -> Result<()> {
    let mut rows: Vec<Row> = Weave::ALL.into_iter().map(|weave| row(args, weave)).collect();
    rows.sort_by(|a, b| a.smallest.total_cmp(&b.smallest));
    match args.json {
        true => output::print_json(&document(args, &rows)),
        false => output::print(text(args, &rows).as_bytes()),
    }
}

fn row(args: &Args, weave: Weave) -> Row {
    let smallest = weave.smallest_aspect_ratio();
    let gap = args.wire.zip(args.id).and_then(|(wire, id)| {
        let rings = Rings { major: (id.mm + wire.mm) / 2.0, minor: wire.mm / 2.0, unit: None };
        let model = Model::compile(&weave.design(weave.name(), &rings).ok()?, Cell::PRIMITIVE).ok()?;
        topology::smallest_gap(&model, &model.start).map(|(gap, _)| gap * model.unit)
    });
    Row {
        weave,
        smallest,
        inner_above: args.wire.map(|wire| smallest * wire.mm),
        wire_below: args.id.map(|id| id.mm / smallest),
        gap,
    }
}

fn document(args: &Args, rows: &[Row]) -> Value {
    let one = |row: &Row| {
        json!({
            "weave": row.weave.name(),
            "smallest_aspect_ratio": row.smallest,
            "inner_diameter_above_mm": row.inner_above,
            "wire_below_mm": row.wire_below,
            "fits": args.wire.zip(args.id).map(|_| row.gap.is_some()),
            "smallest_gap_mm": row.gap,
        })
    };
    json!({
        "wire_mm": args.wire.map(|wire| wire.mm),
        "inner_diameter_mm": args.id.map(|id| id.mm),
        "aspect_ratio": args.wire.zip(args.id).map(|(wire, id)| id.mm / wire.mm),
        "weaves": rows.iter().map(one).collect::<Vec<_>>(),
    })
}

fn text(args: &Args, rows: &[Row]) -> String {
    let wire = args.wire.map(|wire| format!("wire {:.4} mm", wire.mm));
    let id = args.id.map(|id| format!("inner diameter {:.4} mm", id.mm));
    let ratio = args.wire.zip(args.id).map(|(wire, id)| format!("aspect ratio {:.2}", id.mm / wire.mm));
    let title: Vec<String> = [wire, id, ratio].into_iter().flatten().collect();
    let mut out = if title.is_empty() { String::new() } else { format!("{}\n\n", title.join(", ")) };
    let mut head = format!("{:<18}{:>19}", "weave", "aspect ratio above");
    match (args.wire, args.id) {
        (Some(_), Some(_)) => head += &format!("{:>22}", "smallest gap"),
        (Some(_), None) => head += &format!("{:>24}{:>14}", "inner diameter above", "in 1/32 in"),
        (None, Some(_)) => head += &format!("{:>14}{:>22}{:>22}", "wire below", "gauge swg", "gauge awg"),
        (None, None) => {}
    }
    out += &format!("{head}\n");
    for row in rows {
        let mut line = format!("{:<18}{:>19.2}", row.weave.name(), row.smallest);
        match (row.inner_above, row.wire_below) {
            (Some(_), Some(_)) => {
                let gap = row.gap.map_or("does not fit".into(), |gap| format!("{gap:.3} mm"));
                line += &format!("{gap:>22}");
            }
            (Some(inner), None) => line += &format!("{:>24}{:>14}", format!("{inner:.2} mm"), next_fraction(inner)),
            (None, Some(wire)) => {
                let gauges = [Gauge::Swg, Gauge::Awg].map(|g| g.thinner(wire).unwrap_or_else(|| "none".into()));
                line += &format!("{:>14}{:>22}{:>22}", format!("{wire:.3} mm"), gauges[0], gauges[1]);
            }
            (None, None) => {}
        }
        out += &format!("{line}\n");
    }
    out + "\nRings that suit a weave suit all above it; the larger the ratio, the looser the weave.\n"
}

/// The first inner diameter above this one in thirty-seconds of an inch, as `9/32 in`.
fn next_fraction(mm: f64) -> String {
    let (mut count, mut parts) = ((mm / 25.4 * 32.0).floor() as u64 + 1, 32);
    while count.is_multiple_of(2) && parts > 1 {
        (count, parts) = (count / 2, parts / 2);
    }
    match (count / parts, count % parts) {
        (whole, 0) => format!("{whole} in"),
        (0, _) => format!("{count}/{parts} in"),
        (whole, rest) => format!("{whole} {rest}/{parts} in"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_the_next_above() {
        for (mm, expected) in
            [(4.85, "7/32 in"), (6.35, "9/32 in"), (6.34, "1/4 in"), (25.3, "1 in"), (25.4, "1 1/32 in")]
        {
            assert_eq!(next_fraction(mm), expected, "{mm}");
        }
    }
}
