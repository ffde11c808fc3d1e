//! `maille inspect`: what a design is made of, before anything is solved.

use crate::{
    exit,
    input::{DesignArgs, Input},
    inspect_piece::{OfCell, Piece, other_states},
    numbers::read,
    output,
    piece::known_millimetres,
    source::tolerant,
    units::{parse_density, parse_size},
    watch::watch,
};
use maille::{
    bound::{ChainBound, LinkBound, best_bound},
    design::{CurveKind, Source},
    lattice::{Cell, Direction, Shift},
    model::Model,
    topology,
};
use maille_io::millimetres;
use miette::Result;
use serde::Serialize;
use std::{f64::consts::TAU, process::ExitCode};

/// Directions of the bounds that are shown, degrees.
const BOUND_DIRECTIONS: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

/// Elements, rings, links, gaps, wire and the cell of a design
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille inspect 1.1
  maille inspect my-weave.toml --minor-radius 0.08
  maille inspect european-4-in-1 --density steel                    its weight per square metre
  maille inspect european-4-in-1 --density steel --size 40x60cm     rings, wire and weight of a piece
  maille inspect european-4-in-1 --density steel --size 40x60cm --states    also of a sheet that is stretched
  maille inspect kings-mail --json | jq .smallest_gap
  maille inspect my-weave.toml --watch")]
pub struct Args {
    #[command(flatten)]
    design: DesignArgs,
    /// Cell: 1x1, 2x1, … or an integer matrix as "1,0;-1,2"
    #[arg(long, default_value = "1x1", value_parser = read::<Cell>)]
    cell: Cell,
    /// Density of the wire, as 7.85g/cm3 or 7850kg/m3, or a material: steel, stainless, aluminium, brass, pla, …: adds the weight
    #[arg(long, value_parser = parse_density)]
    density: Option<f64>,
    /// Width along a1 and height across it of a piece, as 400x600mm or 16x24in, measured with the wire: adds the whole cells that come
    /// nearest, with rings, wire and weight
    #[arg(long, value_parser = parse_size, conflicts_with = "cell")]
    size: Option<[f64; 2]>,
    /// With --size: the same piece also of the roomiest sheet, and of one stretched across its rows until it locks; both states are
    /// searched for
    #[arg(long, requires = "size")]
    states: bool,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
    /// Inspect again whenever the design file is saved
    #[arg(long)]
    watch: bool,
}

/// What is known of a design without solving; docs/json.md describes the keys. Lengths in the file's unit.
#[derive(Serialize)]
struct Inspection {
    design: String,
    title: String,
    source: Source,
    unit: Option<String>,
    cell: String,
    a1: [f64; 2],
    a2: [f64; 2],
    /// Whether a1 is the only lattice vector: a chain.
    single: bool,
    area: f64,
    angle_deg: f64,
    reference_radius: f64,
    rings: usize,
    links: usize,
    elements: Vec<Element>,
    smallest_gap: Option<Gap>,
    overlap_allowed: bool,
    wire: Wire,
    #[serde(skip_serializing_if = "Option::is_none")]
    piece: Option<Piece>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    piece_of_other_states: Vec<Piece>,
    binding_vectors: Vec<Shift>,
    chains: Vec<Chain>,
    bounds: Vec<Bound>,
}

#[derive(Serialize)]
struct Element {
    name: String,
    rings: Vec<Ring>,
    neighbours: Vec<Neighbour>,
}

#[derive(Serialize)]
struct Ring {
    major_radius: f64,
    minor_radius: f64,
    normal: [f64; 3],
    offset: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    curve: Option<CoreCurve>,
}

/// A core that is no circle.
#[derive(Serialize)]
struct CoreCurve {
    length: f64,
    segments: usize,
    arcs: usize,
    /// Least radius of an arc.
    least_radius: Option<f64>,
    /// How far the form is from its segments and arcs.
    deviation: f64,
    /// Whether it is one of the cycles of a frame, as counts and length are of the struts that belong to it then, or open.
    #[serde(skip)]
    kind: CurveKind,
}

impl Ring {
    /// Its curve, if that is one of the cycles of a frame.
    fn of_frame(&self) -> Option<&CoreCurve> {
        self.curve.as_ref().filter(|curve| curve.kind == CurveKind::Frame)
    }
}

impl CoreCurve {
    fn new(curve: &maille::model::Curve, unit: f64) -> Self {
        let radii = curve.arc_radii();
        CoreCurve {
            length: curve.own_length() * unit,
            segments: curve.own_pieces().count() - radii.len(),
            arcs: radii.len(),
            least_radius: radii.into_iter().map(|r| r * unit).min_by(f64::total_cmp),
            deviation: curve.deviation * unit,
            kind: curve.kind,
        }
    }

    /// For people; `unit` with a space before it.
    fn words(&self, unit: &str) -> String {
        let CoreCurve { length, segments, arcs, least_radius, deviation, .. } = self;
        let made = [(*segments, "segment"), (*arcs, "arc")].map(|(count, what)| output::counted(count, what));
        let bends = least_radius.map_or(String::new(), |r| format!(" of radius {r:.4} and more"));
        let strays = match *deviation > 0.0 {
            true => format!(" that are within {deviation:.1e}{unit} of it"),
            false => String::new(),
        };
        let open = if self.kind == CurveKind::Open { "open " } else { "" };
        format!("{open}curve of length {length:.4}{unit}, {} and {}{bends}{strays}", made[0], made[1])
    }
}

#[derive(Serialize)]
struct Neighbour {
    element: String,
    cell: Shift,
    linking_numbers: Vec<i32>,
}

#[derive(Serialize)]
struct Gap {
    gap: f64,
    rings: [String; 2],
}

/// Core circles of all rings, as wire; square metres and weights where the unit is known.
#[derive(Serialize)]
struct Wire {
    length: f64,
    length_per_area: f64,
    metres_per_square_metre: Option<f64>,
    kilograms_per_square_metre: Option<f64>,
}

#[derive(Serialize)]
struct Chain {
    vector: Shift,
    length: f64,
    rings: Vec<String>,
}

/// Without `kind` the direction is unbounded; with it and no `l1`, l2 = 0 cannot be reached.
#[derive(Serialize)]
struct Bound {
    direction_deg: f64,
    l2: f64,
    l1: Option<f64>,
    kind: Option<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    match args.watch {
        true => watch(std::slice::from_ref(&args.design.design), || once(args)),
        false => once(args),
    }
}

fn once(args: &Args) -> Result<ExitCode> {
    let input = args.design.read()?;
    // Overlaps are shown here, not refused.
    let model = input.compile(&tolerant(&input.design), args.cell)?;
    let found = inspection(&input, &model, args)?;
    if args.json {
        output::print_json(&found)?;
    } else {
        output::print(found.text().as_bytes())?;
    }
    Ok(ExitCode::from(exit::DONE))
}

/// A ring as JSON names it: without the quotes that set its element off in a sentence.
fn ring_name(model: &Model, ring: usize, shift: Shift) -> String {
    model.ring_label(ring, shift).replace('"', "")
}

fn inspection(input: &Input, model: &Model, args: &Args) -> Result<Inspection> {
    let design = &input.design;
    let (a1, a2) = (model.start.a1, model.start.a2);
    let area = a1.cross(&a2).norm() * model.unit * model.unit;
    let element = |e: usize| Element {
        name: model.elements[e].name.clone(),
        rings: model.rings[model.elements[e].rings.clone()]
            .iter()
            .map(|r| Ring {
                major_radius: r.major_radius * model.unit,
                minor_radius: r.minor_radius * model.unit,
                normal: r.normal.into_inner().into(),
                offset: (r.offset * model.unit).into(),
                curve: r.curve.as_ref().map(|curve| CoreCurve::new(curve, model.unit)),
            })
            .collect(),
        neighbours: topology::neighbours(model, e)
            .into_iter()
            .map(|n| Neighbour {
                element: model.elements[n.element].name.clone(),
                cell: n.shift,
                linking_numbers: n.numbers,
            })
            .collect(),
    };
    let gap = model.starting_gap().map(|(gap, pair)| Gap {
        gap,
        rings: [ring_name(model, pair.ring_a, [0, 0]), ring_name(model, pair.ring_b, pair.shift)],
    });
    let binding_vectors = topology::binding_vectors(model);
    let (chains, bounds) = if binding_vectors.is_empty() { Default::default() } else { bounds(model) };
    let metres = metres(design.unit.as_deref(), args)?;
    let wire = wire(model, metres, area, args.density);
    let of_cell = metres.map(|metres| OfCell {
        rings: model.rings.len(),
        wire_metres: wire.length * metres,
        kilograms: wire.kilograms_per_square_metre.map(|weight| weight * area * metres * metres),
    });
    let asked = args.size.zip(metres).zip(of_cell).map(|((size, metres), cell)| (size, metres * 1000.0, cell));
    let piece = asked.map(|(size, mm, cell)| Piece::new(model, &model.start, mm, size, cell));
    let piece_of_other_states = match asked.filter(|_| args.states) {
        Some((size, mm, cell)) => other_states(input, mm, size, cell)?,
        None => Vec::new(),
    };
    Ok(Inspection {
        design: design.name.clone(),
        title: design.title.clone(),
        source: design.source,
        unit: design.unit.clone(),
        cell: model.cell.to_string(),
        a1: [a1.x * model.unit, a1.y * model.unit],
        a2: [a2.x * model.unit, a2.y * model.unit],
        single: model.single,
        area,
        angle_deg: a1.angle(&a2).to_degrees(),
        reference_radius: design.reference_radius,
        rings: model.rings.len(),
        links: model.links.len(),
        elements: (0..model.elements.len()).map(element).collect(),
        smallest_gap: gap,
        overlap_allowed: design.allow_initial_overlap,
        wire,
        piece,
        piece_of_other_states,
        binding_vectors,
        chains,
        bounds,
    })
}

/// Metres in one unit of the file, where it is known; an error if it is not, and is needed.
fn metres(unit: Option<&str>, args: &Args) -> Result<Option<f64>> {
    let asked = [("a weight", "--density", args.density.is_some()), ("a size", "--size", args.size.is_some())];
    match asked.into_iter().find(|(.., given)| *given) {
        Some((what, option, _)) => known_millimetres(unit, what, option).map(Some),
        None => Ok(unit.and_then(millimetres)),
    }
    .map(|mm| mm.map(|mm| mm / 1000.0))
}

/// A core of length L is as much wire, and π L r² of metal: of a ring L = 2 π R.
fn wire(model: &Model, metres: Option<f64>, area: f64, density: Option<f64>) -> Wire {
    let core = |r: &maille::model::Ring| r.curve.as_ref().map_or(TAU * r.major_radius, |curve| curve.own_length());
    let length: f64 = model.rings.iter().map(|r| core(r) * model.unit).sum();
    let of_ring = |r: &maille::model::Ring| core(r) * (TAU / 2.0) * r.minor_radius * r.minor_radius;
    let volume = model.rings.iter().map(of_ring).sum::<f64>() * model.unit.powi(3);
    Wire {
        length,
        length_per_area: length / area,
        metres_per_square_metre: metres.map(|m| length / area / m),
        kilograms_per_square_metre: density.zip(metres).map(|(density, m)| density * volume / area * m),
    }
}

/// What the links alone prove: the chains that can bind, and bounds of l1 with l2 = 0.
fn bounds(model: &Model) -> (Vec<Chain>, Vec<Bound>) {
    let chain = ChainBound::new(model);
    let link = LinkBound::new(model, &chain);
    let chains = chain.chains().map(|binding| Chain {
        vector: binding.vector,
        length: binding.length * model.unit,
        rings: binding.rings.iter().map(|(ring, shift)| ring_name(model, *ring, *shift)).collect(),
    });
    let directions_deg = match model.single {
        true => vec![model.start.a1.y.atan2(model.start.a1.x).to_degrees()],
        false => BOUND_DIRECTIONS.to_vec(),
    };
    let bounds = directions_deg.into_iter().map(|direction_deg| {
        let bound = best_bound(&chain, Some(&link), Direction::of_degrees(direction_deg), 0.0);
        Bound { direction_deg, l2: 0.0, l1: bound.l1(), kind: bound.kind().map(|k| k.to_string()) }
    });
    (chains.collect(), bounds.collect())
}

impl Element {
    /// For people; `unit` with a space before it.
    fn lines(&self, unit: &str) -> Vec<String> {
        let mut lines = vec![format!("\"{}\"", self.name)];
        let wire = |ring: &Ring| ring.of_frame().map(|_| (ring.minor_radius, ring.offset));
        for cage in self.rings.chunk_by(|one, next| wire(one).is_some() && wire(one) == wire(next)) {
            let cycles: Vec<&CoreCurve> = cage.iter().filter_map(Ring::of_frame).collect();
            let ring = &cage[0];
            let ([x, y, z], offset) = (ring.normal, ring.offset);
            let offset = match offset == [0.0; 3] {
                true => String::new(),
                false => format!(", offset ({:.4}, {:.4}, {:.4})", offset[0], offset[1], offset[2]),
            };
            let (big, small) = (ring.major_radius, ring.minor_radius);
            if !cycles.is_empty() {
                let struts = output::counted(cycles.iter().map(|cycle| cycle.segments).sum(), "strut");
                let length: f64 = cycles.iter().map(|cycle| cycle.length).sum();
                let counted = output::counted(cycles.len(), "curve");
                lines.push(format!(
                    "  cage of {struts}, {length:.4}{unit} long in all, r = {small:.4}{unit}{offset}; counted as {counted}, a basis of its cycles"
                ));
                continue;
            }
            if let Some(curve) = &ring.curve {
                let what = curve.words(unit);
                lines.push(format!("  {what}, r = {small:.4}{unit}, within {big:.4}{unit} of its centre{offset}"));
                continue;
            }
            lines.push(format!("  ring R = {big:.4}, r = {small:.4}{unit}, normal ({x:.4}, {y:.4}, {z:.4}){offset}"));
        }
        lines.push(format!("  {} interlocking neighbours, with linking numbers", self.neighbours.len()));
        for n in &self.neighbours {
            let cell = match n.cell {
                [0, 0] => String::new(),
                [p, q] => format!(" in cell ({p:+},{q:+})"),
            };
            let numbers: Vec<String> = n.linking_numbers.iter().map(|k| format!("{k:+}")).collect();
            lines.push(format!("    \"{}\"{cell}: {}", n.element, numbers.join(", ")));
        }
        lines
    }
}

impl Inspection {
    /// For people.
    fn text(&self) -> String {
        let unit = self.unit.as_deref().map_or(String::new(), |u| format!(" {u}"));
        let square = self.unit.as_deref().map_or(String::new(), |u| format!(" {u}²"));
        let mut out = String::new();
        let mut line = |text: String| {
            out.push_str(&text);
            out.push('\n');
        };
        line(format!("{}  {}", self.design, self.title).trim_end().into());
        let vector = |v: [f64; 2]| format!("({:.4}, {:.4})", v[0], v[1]);
        let radius = format!("reference radius {}{unit}", self.reference_radius);
        if self.single {
            line(format!("a chain: cell {}, a1 = {}{unit}, {radius}", self.cell, vector(self.a1)));
        } else {
            line(format!("cell {}: a1 = {}, a2 = {}{unit}", self.cell, vector(self.a1), vector(self.a2)));
            line(format!("area {:.4}{square}, angle {:.2}°, {radius}", self.area, self.angle_deg));
        }
        let all_rings = self.elements.iter().flat_map(|element| &element.rings).all(|ring| ring.curve.is_none());
        let cores = if all_rings { "ring" } else { "core curve" };
        let counts = [(self.elements.len(), "element"), (self.rings, cores), (self.links, "link")];
        let [elements, rings, links] = counts.map(|(count, what)| output::counted(count, what));
        line(format!("{elements}, {rings}, {links} per cell\n"));
        for element in &self.elements {
            element.lines(&unit).into_iter().for_each(&mut line);
        }
        line(String::new());
        match &self.smallest_gap {
            None => line("no two rings are near each other".into()),
            Some(Gap { gap, rings: [a, b] }) if *gap < 0.0 => {
                let allowed = if self.overlap_allowed { "allowed by the file" } else { "an error when solved" };
                line(format!("overlap of the starting state ({allowed}): {:.6}{unit} between {a} and {b}", -gap));
            }
            Some(Gap { gap, rings: [a, b] }) => line(format!("smallest gap {gap:.6}{unit} between {a} and {b}")),
        }
        let Wire { length, length_per_area, metres_per_square_metre, kilograms_per_square_metre } = &self.wire;
        let per_area = match metres_per_square_metre {
            _ if self.single => format!("{:.4} times its length", length / self.a1[0].hypot(self.a1[1])),
            Some(metres) => format!("{metres:.1} m per square metre of sheet"),
            None => format!("{length_per_area:.4} per unit of area"),
        };
        line(format!("wire {length:.4}{unit} per cell, {per_area}"));
        if let Some(weight) = kilograms_per_square_metre.filter(|_| !self.single) {
            line(format!("weight {weight:.3} kg per square metre"));
        }
        for piece in self.piece.iter().chain(&self.piece_of_other_states) {
            line(piece.words());
        }
        if self.piece.is_some() {
            line("export, render and simulate take the same --size".into());
        }
        if self.binding_vectors.is_empty() {
            line("warning: no chain of links joins the cells; no pull has a bound".into());
            return out;
        }
        let list: Vec<String> = self.binding_vectors.iter().map(|[p, q]| format!("({p}, {q})")).collect();
        line(format!("chains of links join lattice vectors {}", list.join(", ")));
        line("\nchains that can bind: |F v| is at most".into());
        for Chain { vector: [p, q], length, rings } in &self.chains {
            line(format!("  v = ({p}, {q}): {length:.6} by {}", rings.join(" - ")));
        }
        line("\nproven bounds of l1 with l2 = 0".into());
        for Bound { direction_deg, l1, kind, .. } in &self.bounds {
            line(match (l1, kind) {
                (Some(l1), Some(kind)) => format!("  {direction_deg:>4}°  {l1:>12.9}  {kind}"),
                (None, Some(_)) => format!("  {direction_deg:>4}°  l2 = 0 is unreachable"),
                (_, None) => format!("  {direction_deg:>4}°  none: no chain of links"),
            });
        }
        out
    }
}
