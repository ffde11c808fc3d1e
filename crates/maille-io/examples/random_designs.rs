//! Random designs as files, always the same ones for a seed.
//!
//!     cargo run -p maille-io --example random_designs -- --seed 1 --count 100 --doubled 30 FOLDER
//!
//! `random-001.toml` …: two to six elements of one to three rings each, concentric or not, in an oblique cell.
//! `doubled-001.toml` …: each ring lies on a second one, parallel to it and a little more than two minor radii away, half
//! of them shifted in their plane. In both, chains of links join all elements and hold the sheet; every fifth random design is
//! held in one direction alone. No two rings overlap. All numbers have two to four decimals.

use maille::{
    design::{DESIGN_SCHEMA, Design, ElementSpec, LatticeSpec, RingSpec, Source},
    lattice::Cell,
    model::Model,
    topology::{binding_vectors, neighbours},
};
use maille_geometry::Vec3;
use maille_io::write_design;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::{path::Path, process::ExitCode};

const USAGE: &str = "random_designs [--seed N] [--count N] [--doubled N] FOLDER";
/// Major radii in units of the reference radius.
const MAJOR: [f64; 2] = [0.5, 1.2];
/// Minor radii alike.
const MINOR: [f64; 2] = [0.02, 0.12];
/// Angle between the lattice vectors.
const ANGLE_DEG: [f64; 2] = [40.0, 140.0];
/// Draws of an element before the design is begun anew.
const DRAWS: usize = 300;
/// Streams of the generator: one a design, so that a larger count leaves the first designs as they are.
const DOUBLED_STREAM: u64 = 1 << 32;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Elements of one to three rings.
    Random,
    /// The same, held in one direction alone.
    Chain,
    /// Single rings, each lying on a second one.
    Doubled,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("random_designs: {problem}\nusage: {USAGE}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<(), String> {
    let (mut seed, mut count, mut doubled, mut folder) = (1, 100, 30, None);
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        let mut number = || -> Result<u64, String> {
            let text = arguments.next().ok_or_else(|| format!("{argument} lacks its number"))?;
            text.parse().map_err(|_| format!("{argument} {text}: give a whole number, as 100"))
        };
        match argument.as_str() {
            "--seed" => seed = number()?,
            "--count" => count = number()?,
            "--doubled" => doubled = number()?,
            option if option.starts_with("--") => return Err(format!("{option} is no option")),
            path if folder.is_none() => folder = Some(path),
            path => return Err(format!("{path}: there is a folder already")),
        }
    }
    let folder = Path::new(folder.ok_or("there is no folder")?);
    std::fs::create_dir_all(folder).map_err(|e| format!("{} cannot be made: {e}", folder.display()))?;
    for (name, design) in designs(seed, count, doubled) {
        let path = folder.join(format!("{name}.toml"));
        std::fs::write(&path, write_design(&design)).map_err(|e| format!("{} is not written: {e}", path.display()))?;
    }
    Ok(())
}

/// The designs of a seed with their names.
fn designs(seed: u64, count: u64, doubled: u64) -> impl Iterator<Item = (String, Design)> {
    let random =
        (1..=count).map(|k| (format!("random-{k:03}"), k, if k % 5 == 0 { Kind::Chain } else { Kind::Random }));
    let doubled = (1..=doubled).map(|k| (format!("doubled-{k:03}"), DOUBLED_STREAM + k, Kind::Doubled));
    random.chain(doubled).map(move |(name, stream, kind)| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        let design = design(&name, kind, &mut rng);
        (name, design)
    })
}

/// A design that holds; begun anew until there is one.
fn design(name: &str, kind: Kind, rng: &mut ChaCha8Rng) -> Design {
    loop {
        if let Some(design) = attempt(name, kind, rng) {
            return design;
        }
    }
}

/// What all elements of a design share.
struct Style {
    /// Reference radius in the file's unit.
    reference: f64,
    decimals: usize,
    /// Major radius of all rings, where they have one.
    major: Option<f64>,
    minor: f64,
    /// Whether rings have minor radii of their own.
    own_minor: bool,
    /// Shift of a ring from its twin in their plane, at most.
    aside: f64,
}

impl Style {
    fn draw(kind: Kind, rng: &mut ChaCha8Rng) -> Style {
        let alike = kind == Kind::Doubled || rng.random_bool(0.3);
        Style {
            reference: [1.0, 1.0, 2.5, 8.0][rng.random_range(0..4)],
            decimals: rng.random_range(2..5),
            major: alike.then(|| rng.random_range(0.8..MAJOR[1])),
            minor: rng.random_range(MINOR[0]..MINOR[1]),
            own_minor: kind != Kind::Doubled && rng.random_bool(0.25),
            aside: if rng.random_bool(0.5) { 0.15 } else { 0.0 },
        }
    }

    fn rounded(&self, x: f64) -> f64 {
        // No −0.
        format!("{x:.*}", self.decimals).parse::<f64>().unwrap_or(x) + 0.0
    }

    /// A length given in reference radii.
    fn length(&self, x: f64) -> f64 {
        self.rounded(x * self.reference)
    }

    fn vector(&self, v: Vec3) -> [f64; 3] {
        [v.x, v.y, v.z].map(|x| self.length(x))
    }

    fn ring(&self, normal: Vec3, offset: Vec3, rng: &mut ChaCha8Rng) -> RingSpec {
        RingSpec {
            major_radius: self.length(self.major.unwrap_or_else(|| rng.random_range(MAJOR[0]..MAJOR[1]))),
            normal: [normal.x, normal.y, normal.z].map(|x| self.rounded(x)),
            offset: self.vector(offset),
            minor_radius: self.own_minor.then(|| self.length(rng.random_range(MINOR[0]..MINOR[1]))),
        }
    }
}

fn attempt(name: &str, kind: Kind, rng: &mut ChaCha8Rng) -> Option<Design> {
    let style = Style::draw(kind, rng);
    let groups = if kind == Kind::Doubled { rng.random_range(2..4) } else { rng.random_range(2..7) };
    let mut design = Design {
        schema: DESIGN_SCHEMA,
        name: name.into(),
        title: if kind == Kind::Doubled { "Random, doubled" } else { "Random" }.into(),
        source: Source::Own,
        unit: None,
        minor_radius: Some(style.length(style.minor)),
        reference_radius: style.reference,
        curve_tolerance: None,
        allow_initial_overlap: false,
        lattice: lattice(groups, kind, &style, rng),
        elements: Vec::new(),
        varied: std::collections::BTreeMap::new(),
        parameters: Vec::new(),
        formulas: std::collections::BTreeMap::new(),
    };
    for _ in 0..groups {
        grow(&mut design, kind, &style, rng)?;
    }
    let model = Model::compile(&design, Cell::PRIMITIVE).ok()?;
    let rank = rank(&model);
    (rank == if kind == Kind::Chain { 1 } else { 2 }).then_some(design)
}

fn lattice(groups: usize, kind: Kind, style: &Style, rng: &mut ChaCha8Rng) -> LatticeSpec {
    let angle_rad = rng.random_range(ANGLE_DEG[0]..ANGLE_DEG[1]).to_radians();
    let turn_rad = rng.random_range(0.0..std::f64::consts::TAU);
    let area = groups as f64 * rng.random_range(0.9..2.4);
    let ratio: f64 = rng.random_range(-0.9_f64..0.9).exp();
    let mut lengths = [(area / angle_rad.sin() * ratio).sqrt(), (area / angle_rad.sin() / ratio).sqrt()];
    if kind == Kind::Chain {
        lengths = [groups as f64 * rng.random_range(0.5..1.3), rng.random_range(2.4..4.0)];
    }
    let at = |length: f64, angle: f64| style.vector(Vec3::new(length * angle.cos(), length * angle.sin(), 0.0));
    LatticeSpec { a1: at(lengths[0], turn_rad), a2: at(lengths[1], turn_rad + angle_rad), single: false }
}

/// Adds an element, or a ring with its twin, that overlaps no other and, but for the first, is linked with one.
fn grow(design: &mut Design, kind: Kind, style: &Style, rng: &mut ChaCha8Rng) -> Option<()> {
    let before = design.elements.len();
    let [a1, a2] = [design.lattice.a1, design.lattice.a2].map(|a| Vec3::from(a) / style.reference);
    for _ in 0..DRAWS {
        let (p, q) = (rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
        let center = a1 * p + a2 * q + Vec3::z() * rng.random_range(-0.4..0.4);
        let normal = direction(rng);
        let mut element = |center: Vec3, rings: Vec<RingSpec>| {
            let name = format!("e{}", design.elements.len());
            design.elements.push(ElementSpec { name, center: style.vector(center), rings, curves: Vec::new() });
        };
        if kind == Kind::Doubled {
            let ring = style.ring(normal, Vec3::zeros(), rng);
            let across = normal.cross(&direction(rng)).normalize();
            let apart = 2.0 * style.minor * rng.random_range(1.02..1.4);
            let twin = center + normal * apart + across * (style.aside * rng.random_range(0.0..1.0));
            element(center, vec![ring.clone()]);
            element(twin, vec![ring]);
        } else {
            let extra = [0, 0, 0, 1, 1, 2][rng.random_range(0..6)];
            let concentric = rng.random_bool(0.5);
            let mut rings = vec![style.ring(normal, Vec3::zeros(), rng)];
            for _ in 0..extra {
                let offset = if concentric { Vec3::zeros() } else { direction(rng) * rng.random_range(0.2..1.0) };
                rings.push(style.ring(direction(rng), offset, rng));
            }
            element(center, rings);
        }
        let fits = Model::compile(design, Cell::PRIMITIVE).is_ok_and(|model| before == 0 || linked(&model, before));
        if fits {
            return Some(());
        }
        design.elements.truncate(before);
    }
    None
}

/// A unit vector, all directions alike.
fn direction(rng: &mut ChaCha8Rng) -> Vec3 {
    let (height, angle) = (rng.random_range(-1.0..1.0_f64), rng.random_range(0.0..std::f64::consts::TAU));
    let flat = (1.0 - height * height).sqrt();
    Vec3::new(flat * angle.cos(), flat * angle.sin(), height)
}

/// Whether each element from `first` on is joined by links with the elements before.
fn linked(model: &Model, first: usize) -> bool {
    let mut reached = vec![false; model.elements.len()];
    let mut open: Vec<usize> = (0..first).collect();
    while let Some(element) = open.pop() {
        if !std::mem::replace(&mut reached[element], true) {
            open.extend(neighbours(model, element).iter().map(|n| n.element));
        }
    }
    reached.into_iter().all(|yes| yes)
}

/// In how many independent directions chains of links hold the sheet.
fn rank(model: &Model) -> usize {
    let vectors = binding_vectors(model);
    let Some([m, n]) = vectors.first().copied() else { return 0 };
    if vectors.iter().any(|[p, q]| m * q != n * p) { 2 } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maille::topology::smallest_gap;
    use maille_io::read_design;
    use std::collections::BTreeSet;

    #[test]
    fn designs_hold_and_read_back() {
        let mut one_way = 0;
        for (name, design) in designs(1, 20, 6) {
            let text = write_design(&design);
            assert_eq!(read_design(&name, &text).unwrap(), design, "{name}");
            let model = Model::compile(&design, Cell::PRIMITIVE).unwrap();
            assert!(smallest_gap(&model, &model.start).is_none_or(|(gap, _)| gap >= 0.0), "{name}");
            assert!(linked(&model, 1), "{name}");
            assert!(rank(&model) > 0, "{name}");
            one_way += usize::from(rank(&model) == 1);
            assert!((2..=6).contains(&design.elements.len()), "{name}");
            let rings = design.elements.iter().flat_map(|e| &e.rings);
            for ring in rings {
                let size = ring.major_radius / design.reference_radius;
                assert!((MAJOR[0] - 0.01..=MAJOR[1] + 0.01).contains(&size), "{name}: {size}");
            }
            let numbers = text.split(|c: char| !"0123456789.".contains(c)).filter_map(|word| word.split_once('.'));
            assert!(numbers.into_iter().all(|(_, decimals)| decimals.len() <= 4), "{name}:\n{text}");
        }
        assert_eq!(one_way, 4);
    }

    #[test]
    fn a_seed_gives_the_same_designs_whatever_their_number() {
        let few: Vec<_> = designs(7, 3, 2).collect();
        let many: Vec<_> = designs(7, 5, 3).collect();
        assert!(few.iter().all(|pair| many.contains(pair)));
        let other: Vec<_> = designs(8, 3, 2).map(|(_, design)| design).collect();
        assert!(few.iter().all(|(_, design)| !other.contains(design)));
    }

    #[test]
    fn twins_are_parallel_and_touch_almost() {
        for (name, design) in designs(3, 0, 5) {
            for pair in design.elements.chunks_exact(2) {
                let [a, b] = [&pair[0], &pair[1]];
                assert_eq!(a.rings, b.rings, "{name}");
                let apart = Vec3::from(b.center) - Vec3::from(a.center);
                let height = apart.dot(&Vec3::from(a.rings[0].normal).normalize()).abs();
                let wires = height / (2.0 * design.minor_radius.unwrap());
                assert!((0.8..1.6).contains(&wires), "{name}: {wires}");
            }
        }
        let shifted: BTreeSet<bool> = designs(3, 0, 12)
            .map(|(_, design)| {
                let [a, b] = [&design.elements[0], &design.elements[1]];
                let apart = Vec3::from(b.center) - Vec3::from(a.center);
                let normal = Vec3::from(a.rings[0].normal).normalize();
                (apart - normal * apart.dot(&normal)).norm() > 0.03 * design.reference_radius
            })
            .collect();
        assert_eq!(shifted.len(), 2);
    }
}
