//! `maille inspect`: what a design is made of, before anything is solved.

use crate::{input::Input, numbers::positive};
use maille::{
    bound::{ChainBound, LinkBound, best_bound},
    design::Design,
    lattice::Cell,
    model::Model,
    topology,
};
use miette::Result;

/// Directions of the bounds that are shown, degrees.
const BOUND_DIRECTIONS: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

/// Elements, rings, links, gaps and the cell of a design
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille inspect 1.1
  maille inspect my-weave.toml --minor-radius 0.08")]
pub struct Args {
    /// A built-in design (see `maille designs`) or a TOML file
    design: String,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive)]
    minor_radius: Option<f64>,
    /// Cell: 1x1, 2x1, … or an integer matrix as "1,0;-1,2"
    #[arg(long, default_value = "1x1")]
    cell: Cell,
}

/// Prints the inspection.
pub fn run(args: &Args) -> Result<()> {
    let input = Input::read(&args.design, args.minor_radius)?;
    // Overlaps are shown here, not refused.
    let tolerant = Design { allow_initial_overlap: true, ..input.design.clone() };
    let model = input.compile(&tolerant, args.cell)?;
    let design = &input.design;
    let unit = design.unit.as_deref().map_or(String::new(), |u| format!(" {u}"));
    println!("{}", format!("{}  {}", design.name, design.title).trim_end());
    let length = |v: maille_geometry::Vec3| format!("({:.4}, {:.4})", v.x * model.unit, v.y * model.unit);
    println!("cell {}: a1 = {}, a2 = {}{unit}", model.cell, length(model.start.a1), length(model.start.a2));
    let (a1, a2) = (model.start.a1, model.start.a2);
    println!(
        "area {:.4}{}, angle {:.2}°, reference radius {}{unit}",
        a1.cross(&a2).norm() * model.unit * model.unit,
        design.unit.as_deref().map_or(String::new(), |u| format!(" {u}²")),
        a1.angle(&a2).to_degrees(),
        design.reference_radius,
    );
    println!("{} elements, {} rings, {} links a cell\n", model.elements.len(), model.rings.len(), model.links.len());
    for (e, element) in model.elements.iter().enumerate() {
        println!("\"{}\"", element.name);
        for ring in element.rings.clone() {
            let r = &model.rings[ring];
            let (big, small) = (r.major_radius * model.unit, r.minor_radius * model.unit);
            let n = r.normal;
            print!("  ring R = {big:.4}, r = {small:.4}{unit}, normal ({:.4}, {:.4}, {:.4})", n.x, n.y, n.z);
            match r.offset.norm() > 0.0 {
                true => {
                    let o = r.offset * model.unit;
                    println!(", offset ({:.4}, {:.4}, {:.4})", o.x, o.y, o.z)
                }
                false => println!(),
            }
        }
        let neighbours = topology::neighbours(&model, e);
        let list: Vec<String> = neighbours
            .iter()
            .map(|n| {
                let cell = match n.shift {
                    [0, 0] => String::new(),
                    [p, q] => format!(" in cell ({p:+},{q:+})"),
                };
                let numbers: Vec<String> = n.numbers.iter().map(|k| format!("{k:+}")).collect();
                format!("    \"{}\"{cell}: {}", model.elements[n.element].name, numbers.join(", "))
            })
            .collect();
        println!("  {} interlocking neighbours, with linking numbers", neighbours.len());
        list.iter().for_each(|line| println!("{line}"));
    }
    println!();
    match topology::smallest_gap(&model, &model.start) {
        None => println!("no two rings are near each other"),
        Some((gap, pair)) => {
            let (a, b) = (model.ring_label(pair.ring_a, [0, 0]), model.ring_label(pair.ring_b, pair.shift));
            if gap < 0.0 {
                let allowed = if design.allow_initial_overlap { "allowed by the file" } else { "an error when solved" };
                println!(
                    "overlap of the starting state ({allowed}): {:.6}{unit} between {a} and {b}",
                    -gap * model.unit
                );
            } else {
                println!("smallest gap {:.6}{unit} between {a} and {b}", gap * model.unit);
            }
        }
    }
    let binding = topology::binding_vectors(&model);
    if binding.is_empty() {
        println!("warning: no chain of links joins the cells; every limit is unbounded");
    } else {
        let list: Vec<String> = binding.iter().map(|[p, q]| format!("({p}, {q})")).collect();
        println!("chains of links join lattice vectors {}", list.join(", "));
        bounds(&model);
    }
    Ok(())
}

/// What the links alone prove: the chains that can bind, and bounds of l1 with l2 = 0.
fn bounds(model: &Model) {
    let chain = ChainBound::new(model);
    let link = LinkBound::new(model, &chain);
    println!("\nchains that can bind: |F v| is at most");
    for binding in chain.chains() {
        let [p, q] = binding.vector;
        let rings: Vec<String> = binding.rings.iter().map(|(ring, shift)| model.ring_label(*ring, *shift)).collect();
        println!("  v = ({p}, {q}): {:.6} by {}", binding.length * model.unit, rings.join(" - "));
    }
    println!("\nproven bounds of l1 with l2 = 0");
    for direction in BOUND_DIRECTIONS {
        let bound = best_bound(&chain, Some(&link), direction, 0.0);
        match bound.l1().zip(bound.kind()) {
            Some((l1, kind)) => println!("  {direction:>4}°  {l1:>12.9}  {kind}"),
            None if bound.kind().is_some() => println!("  {direction:>4}°  l2 = 0 is unreachable"),
            None => println!("  {direction:>4}°  unbounded"),
        }
    }
}
