//! From a design to its models.

use super::{Curve, Element, FAR, MANY, MEMORY_LIMIT_BYTES, Model, Ring};
use crate::{
    lattice::{self, Cell},
    state::{Pose, State},
    topology,
};
use maille_design::{CurveSpec, Design, InvalidInput, shape::CorePieces};
use maille_geometry::{Circle, Piece, Vec3, smallest_ball_center};
use nalgebra::{Matrix2, Unit, UnitQuaternion};
use std::sync::{Arc, OnceLock};

/// Elements further than this from the first one, and rings from their element's centre, are refused, in units of R: rounding
/// hides their gaps.
const FARTHEST: f64 = 1e4;
/// Images of an element that are looked for, and cells that it may lie from the first one.
const MOST_IMAGES: f64 = 1e5;
/// Memory that the search of a cell takes for each of its rings, in bytes: 2.9 GB for the 30,000 of `1.1` in 100x100. In a finite sheet:
/// that of a crumpled one.
const BYTES_OF_RING: [f64; 2] = [1e5, 3.6e4];
/// Rings that overlap by less touch, in R: a limit that is written out does so by rounding.
const ROUNDING: f64 = 1e-12;

/// The origin of a form is its centre if the curve reaches farther from it than from that of its smallest ball by no more than this share.
const CENTERED: f64 = 1e-12;
/// Arcs whose circles differ by less, in reference radii, are of one.
const ONE_CIRCLE: f64 = 1e-12;

/// The circle of which all pieces are arcs.
fn one_circle(pieces: &[Piece]) -> Option<Circle> {
    let circles: Option<Vec<Circle>> = pieces
        .iter()
        .map(|piece| match piece {
            Piece::Arc(arc) => Some(*arc.circle()),
            Piece::Segment(_) => None,
        })
        .collect();
    let circles = circles?;
    let first = *circles.first()?;
    let same = |c: &Circle| {
        (c.center - first.center).norm() < ONE_CIRCLE
            && (c.radius - first.radius).abs() < ONE_CIRCLE
            && (*c.normal - *first.normal).norm() < ONE_CIRCLE
    };
    circles.iter().all(same).then_some(first)
}

/// Largest distance of points of the pieces from `p`.
fn reach(pieces: &[Piece], p: &Vec3) -> f64 {
    pieces.iter().map(|piece| (piece.point(piece.farthest(p)) - p).norm()).fold(0.0, f64::max)
}

/// The centre of the smallest ball that holds the pieces.
fn center(pieces: &[Piece]) -> Vec3 {
    let middle = pieces.iter().map(|piece| piece.point(0.5)).sum::<Vec3>() / pieces.len() as f64;
    smallest_ball_center(middle, |p| {
        let far = pieces.iter().map(|piece| piece.point(piece.farthest(p)));
        far.max_by(|x, y| (x - p).norm().total_cmp(&(y - p).norm())).unwrap_or(middle)
    })
}

/// Squares of tiny numbers have few digits: the largest is made 1 first.
fn unit_normal(normal: [f64; 3]) -> Unit<Vec3> {
    let normal = Vec3::from(normal);
    Unit::new_normalize(normal / normal.amax())
}

/// The tubes of a curve, in units of the reference radius: one, or those of a frame. Where one is a torus it is a ring like any other.
fn rings_of(design: &Design, element: usize, spec: &CurveSpec) -> Vec<Ring> {
    let unit = design.reference_radius;
    let offset = Vec3::from(spec.offset) / unit;
    let rotation = spec.rotation().unwrap_or_default();
    let minor_radius = spec.minor_radius.or(design.minor_radius).unwrap_or(f64::NAN) / unit;
    let normal = unit_normal(spec.normal);
    // A circle in other words is that ring, to the last digit.
    if let Some(radius) = spec.shape.circle() {
        let major_radius = radius / unit;
        return vec![Ring { element, offset, normal, major_radius, minor_radius, curve: None }];
    }
    // The design has been checked.
    let cores = spec.shape.scaled(1.0 / unit).cores(design.tolerance_of_curves() / unit).unwrap_or_default();
    let moved = |piece: &Piece| piece.moved(&rotation, &offset);
    // The balls of all cycles of a frame have one centre: so links of the same two elements bound the same vector.
    let all: Vec<Piece> = cores.iter().flat_map(|core| core.pieces.iter().map(moved)).collect();
    // Most forms lie about their origin.
    let found = center(&all);
    let center = if reach(&all, &offset) <= reach(&all, &found) * (1.0 + CENTERED) { offset } else { found };
    let ring = |core: CorePieces| {
        let pieces: Vec<Piece> = core.pieces.iter().map(moved).collect();
        if let Some(Circle { center, normal, radius }) = one_circle(&pieces) {
            return Ring { element, offset: center, normal, major_radius: radius, minor_radius, curve: None };
        }
        let major_radius = reach(&pieces, &center);
        let curve = Curve::new(CorePieces { pieces, ..core });
        Ring { element, offset: center, normal, major_radius, minor_radius, curve: Some(Arc::new(curve)) }
    };
    cores.into_iter().map(ring).collect()
}

impl Model {
    /// Compiles `design` for `cell`, or returns everything that is wrong with it.
    pub fn compile(design: &Design, cell: Cell) -> Result<Model, Vec<InvalidInput>> {
        Self::compile_with(design, cell, true)
    }

    /// Compiles the cells of `tile` alone, a finite sheet with free edges.
    pub fn compile_sheet(design: &Design, tile: Cell) -> Result<Model, Vec<InvalidInput>> {
        Self::compile_with(design, tile, false)
    }

    fn compile_with(design: &Design, cell: Cell, periodic: bool) -> Result<Model, Vec<InvalidInput>> {
        let problems = design.problems();
        if !problems.is_empty() {
            return Err(problems);
        }
        let own = Self::first_cell(design, periodic)?;
        own.check_memory(cell)?;
        let model = own.tiled(cell);
        model.check_extent(design)?;
        let pairs = topology::close_pairs(&model, &model.start, 0.0);
        let overlaps = model.overlaps(&pairs, design);
        if !overlaps.is_empty() {
            return Err(overlaps);
        }
        Ok(model.with_links(&pairs))
    }

    /// The design's own cell, unchecked, without links and anchors.
    fn first_cell(design: &Design, periodic: bool) -> Result<Model, Vec<InvalidInput>> {
        let unit = design.reference_radius;
        let vector = |x: [f64; 3]| Vec3::from(x) / unit;
        let (a1, a2) = (vector(design.lattice.a1), vector(design.lattice.a2));
        let first = Vec3::from(design.elements[0].center);
        let origin = if first.norm() > FAR * unit { first } else { Vec3::zeros() };
        let reference_inverse = Matrix2::new(a1.x, a2.x, a1.y, a2.y).try_inverse().ok_or_else(|| {
            vec![InvalidInput::new("lattice.a2", "is parallel to a1", "give two independent translations")]
        })?;
        let (mut elements, mut rings, mut poses) = (Vec::new(), Vec::new(), Vec::new());
        for spec in &design.elements {
            let first = rings.len();
            for ring in &spec.rings {
                rings.push(Ring {
                    element: elements.len(),
                    offset: vector(ring.offset),
                    normal: unit_normal(ring.normal),
                    major_radius: ring.major_radius / unit,
                    minor_radius: ring.minor_radius.or(design.minor_radius).unwrap_or(f64::NAN) / unit,
                    curve: None,
                });
            }
            rings.extend(spec.curves.iter().flat_map(|curve| rings_of(design, elements.len(), curve)));
            let reach = rings[first..].iter().map(|r| r.offset.norm() + r.major_radius).fold(0.0, f64::max);
            let position = (Vec3::from(spec.center) - origin) / unit;
            elements.push(Element { name: spec.name.clone(), rings: first..rings.len(), reach, anchor: [0.0; 2] });
            poses.push(Pose { position, rotation: UnitQuaternion::identity() });
        }
        Ok(Model {
            name: design.name.clone(),
            cell: Cell::PRIMITIVE,
            periodic,
            single: design.lattice.single,
            unit,
            origin,
            largest_radius: rings.iter().map(|r| r.major_radius).fold(0.0, f64::max),
            elements,
            rings,
            start: State { poses, a1, a2, roll: None },
            reference_inverse,
            links: Vec::new(),
            short_basis: lattice::short_basis(a1, a2),
            neighbours: OnceLock::new(),
        })
    }

    /// Refuses cells and finite sheets that would take more memory than [`MEMORY_LIMIT_BYTES`].
    fn check_memory(&self, cell: Cell) -> Result<(), Vec<InvalidInput>> {
        let (field, bytes) = if self.periodic { ("cell", BYTES_OF_RING[0]) } else { ("tile", BYTES_OF_RING[1]) };
        let (rings, most) = (self.rings.len() * cell.copies(), MEMORY_LIMIT_BYTES / bytes);
        if rings as f64 <= most {
            return Ok(());
        }
        let memory = MEMORY_LIMIT_BYTES / 1e9;
        let problem = format!("has {rings} rings; {most:.0} are possible, which take {memory} GB of memory");
        let remedy = if cell.copies() > 1 { format!("take a smaller {field}") } else { "write fewer rings".into() };
        Err(vec![InvalidInput::new(field, problem, remedy)])
    }

    /// Refuses elements that lie or reach so far that gaps there are lost to rounding, and those of a periodic sheet that do so
    /// over so many cells that their images cannot be listed. Numbers that have overflowed are refused, too.
    fn check_extent(&self, design: &Design) -> Result<(), Vec<InvalidInput>> {
        let inverse = self.reference_inverse;
        let beyond = |x: f64, most: f64| x.is_nan() || x > most;
        let mut out = Vec::new();
        for (k, spec) in design.elements.iter().enumerate() {
            let (name, reach) = (&spec.name, self.elements[k].reach);
            let from_first = self.start.poses[k].position - self.start.poses[0].position;
            // As `lattice::shifts_within` lists them; rows of the inverse are the dual vectors.
            let images = (0..2).map(|row| 4.0 * reach * inverse.row(row).norm() + 1.0).product::<f64>();
            let cells = (inverse * from_first.xy()).amax();
            let nearer = "bring the rings nearer to the element's center, or take longer lattice vectors";
            let inwards = "move it by whole lattice vectors into the cell";
            let (field, problem, remedy) = if beyond(reach, FARTHEST) {
                let far = format!("reach {reach:.1e} R from its center; at most {FARTHEST:.0e} can be solved");
                ("rings", format!("the rings of \"{name}\" {far}"), nearer)
            } else if self.periodic && beyond(images, MOST_IMAGES) {
                let many = format!("reach over some {images:.1e} cells; at most {MOST_IMAGES:.0e} are tried");
                ("rings", format!("the rings of \"{name}\" {many}"), nearer)
            } else if beyond(from_first.norm(), FARTHEST) {
                let way = from_first.norm();
                let far = format!("lies {way:.1e} R from the first element; at most {FARTHEST:.0e} can be solved");
                ("center", format!("\"{name}\" {far}"), inwards)
            } else if self.periodic && beyond(cells, MOST_IMAGES) {
                let many =
                    format!("lies {cells:.1e} cells from the first element; at most {MOST_IMAGES:.0e} are tried");
                ("center", format!("\"{name}\" {many}"), inwards)
            } else {
                continue;
            };
            out.push(InvalidInput::new(format!("elements[{k}].{field}"), problem, remedy));
        }
        if out.is_empty() { Ok(()) } else { Err(out) }
    }

    /// The design's own cell of a periodic model.
    #[doc(hidden)]
    pub fn primitive(&self) -> Model {
        let copies = self.cell.copies();
        let mut out = self.clone();
        if self.cell == Cell::PRIMITIVE || !self.periodic {
            return out;
        }
        // The first copy is that of shift (0, 0).
        out.elements.truncate(self.elements.len() / copies);
        out.rings.truncate(self.rings.len() / copies);
        out.start.poses.truncate(out.elements.len());
        for element in out.elements.iter_mut().filter(|_| copies > 1) {
            element.name.truncate(element.name.rfind('@').unwrap_or(element.name.len()));
        }
        out.cell = Cell::PRIMITIVE;
        let [a1, a2] = self.cell.primitive(self.start.a1, self.start.a2);
        let cell = Matrix2::from_fn(|i, j| f64::from(self.cell.rows()[j][i]));
        (out.start.a1, out.start.a2, out.reference_inverse) = (a1, a2, cell * self.reference_inverse);
        let pairs = topology::close_pairs(&out, &out.start, 0.0);
        out.with_links(&pairs)
    }

    /// The same with the links among `pairs`.
    fn with_links(self, pairs: &[topology::RingPair]) -> Model {
        Model { links: topology::links(&self, &self.start, pairs), neighbours: OnceLock::new(), ..self }
    }

    /// The same design in the cell `cell` of a periodic model.
    #[doc(hidden)]
    pub fn in_cell(&self, cell: Cell) -> Model {
        let own = self.primitive();
        if cell == Cell::PRIMITIVE || !self.periodic {
            return own;
        }
        let out = own.tiled(cell);
        let pairs = topology::close_pairs(&out, &out.start, 0.0);
        out.with_links(&pairs)
    }

    /// Copies of this model's own cell fill `cell`; the links are not looked for.
    fn tiled(&self, cell: Cell) -> Model {
        let [a1, a2] = cell.vectors(self.start.a1, self.start.a2);
        // Dependent rows are no cell.
        let inverse = Matrix2::new(a1.x, a2.x, a1.y, a2.y).try_inverse().unwrap_or(self.reference_inverse);
        let start = State { poses: Vec::new(), a1, a2, roll: None };
        let (elements, rings, links) = (Vec::new(), Vec::new(), Vec::new());
        let mut out = Model { cell, start, reference_inverse: inverse, elements, rings, links, ..self.clone() };
        for coset in cell.cosets() {
            let shift = self.start.translation(coset);
            let (first, rings) = (out.elements.len(), out.rings.len());
            out.rings.extend(self.rings.iter().map(|ring| Ring { element: ring.element + first, ..ring.clone() }));
            for (element, pose) in self.elements.iter().zip(&self.start.poses) {
                let position = pose.position + shift;
                let copy = if self.elements.len() > MANY { position } else { shift };
                let name = match cell.copies() {
                    1 => element.name.clone(),
                    _ => format!("{}@{},{}", element.name, coset[0], coset[1]),
                };
                out.elements.push(Element {
                    name,
                    rings: element.rings.start + rings..element.rings.end + rings,
                    reach: element.reach,
                    anchor: (inverse * copy.xy()).into(),
                });
                out.start.poses.push(Pose { position, ..*pose });
            }
        }
        out
    }

    /// Smallest gap of the starting state in the design's unit, with its pair: 0 where rings touch, but for rounding.
    pub fn starting_gap(&self) -> Option<(f64, topology::RingPair)> {
        let (gap, pair) = topology::smallest_gap(self, &self.start)?;
        let touches = gap.abs() <= ROUNDING;
        Some((if touches { 0.0 } else { gap * self.unit }, pair))
    }

    /// What keeps the starting state from use: cores that meet, because then there is no topology to keep, and overlaps that
    /// the design does not allow; of each one entry, at the first or the deepest.
    fn overlaps(&self, pairs: &[topology::RingPair], design: &Design) -> Vec<InvalidInput> {
        let (mut out, mut deep) = (Vec::new(), Vec::new());
        // Elements, not rings: two cages that meet do so at many struts.
        let mut meeting: Vec<(String, String)> = Vec::new();
        let names = |pair: &topology::RingPair| {
            format!("{} and {}", self.ring_label(pair.ring_a, [0, 0]), self.ring_label(pair.ring_b, pair.shift))
        };
        let field = |pair: &topology::RingPair| {
            format!("elements[{}].center", self.rings[pair.ring_b].element % design.elements.len())
        };
        for pair in pairs {
            let distance = topology::core_distance(self, &self.start, pair);
            let gap = (distance - self.contact_distance(pair.ring_a, pair.ring_b)) * self.unit;
            if distance < 1e-9 {
                let elements = format!(
                    "{} and {}",
                    self.element_label(self.rings[pair.ring_a].element, [0, 0]),
                    self.element_label(self.rings[pair.ring_b].element, pair.shift)
                );
                if !meeting.iter().any(|(_, known)| *known == elements) {
                    meeting.push((field(pair), elements));
                }
            } else if gap < -ROUNDING * self.unit && !design.allow_initial_overlap {
                deep.push((-gap, pair));
            }
        }
        if let Some((field, _)) = meeting.first() {
            let named: Vec<&str> = meeting.iter().take(MOST_NAMED).map(|(_, names)| names.as_str()).collect();
            let problem = format!(
                "the core curves of {} meet in the starting state{}",
                named.join(", of "),
                others(meeting.len(), "meets", "meet")
            );
            let help = "move the elements apart: whether such elements are linked is undefined";
            out.push(InvalidInput::new(field.clone(), problem, help));
        }
        deep.sort_by(|a, b| b.0.total_cmp(&a.0));
        if let Some((depth, deepest)) = deep.first() {
            let words = |depth| match &design.unit {
                Some(unit) => format!("{} {unit}", depth_words(depth)),
                None => depth_words(depth),
            };
            let mut problem = format!("{} overlap by {} in the starting state", names(deepest), words(*depth));
            for (depth, pair) in deep.iter().take(MOST_NAMED).skip(1) {
                problem += &format!(", {} by {}", names(pair), words(*depth));
            }
            problem += &others(deep.len(), "overlaps", "overlap");
            let help = "move them apart or take a smaller minor_radius; or write allow_initial_overlap = true at the top of the file";
            out.push(InvalidInput::new(field(deepest), problem, help));
        }
        out
    }
}

/// Overlapping pairs that an error names.
const MOST_NAMED: usize = 3;

/// What is said of pairs beyond those that are named.
fn others(pairs: usize, does: &str, they_do: &str) -> String {
    match pairs.saturating_sub(MOST_NAMED) {
        0 => String::new(),
        1 => format!(", and 1 other pair {does}"),
        more => format!(", and {more} other pairs {they_do}"),
    }
}

/// Six decimals, or what is left of an overlap that they do not show.
fn depth_words(depth: f64) -> String {
    if depth < 5e-7 { format!("{depth:.1e}") } else { format!("{depth:.6}") }
}
