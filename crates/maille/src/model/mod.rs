//! The model: a design compiled for one cell. Validated, indexed, in units of the reference radius, immutable.

mod compile;
pub mod curve;

use crate::{
    lattice::{Cell, Shift},
    state::{NeutralSurface, State},
};
use maille_design::Design;
use maille_geometry::{Circle, Vec3};
use nalgebra::{Matrix2, Unit, UnitVector3};
use std::{
    borrow::Cow,
    collections::BTreeSet,
    ops::Range,
    sync::{Arc, OnceLock},
};

pub use curve::{Core, Curve};

/// Memory that a cell, a picture or a mesh may take, in bytes: what would take more is refused before it is begun.
pub const MEMORY_LIMIT_BYTES: f64 = 4e9;

/// A tube of an element round a circle or another curve, in the element's frame at the starting state.
#[derive(Clone, Debug)]
pub struct Ring {
    /// Index of the element that it belongs to.
    pub element: usize,
    /// Centre relative to the element's reference point.
    pub offset: Vec3,
    /// Normal of the core circle.
    pub normal: UnitVector3<f64>,
    /// Major radius R; of another curve the radius of a ball about the centre that holds the core.
    pub major_radius: f64,
    /// Minor radius r.
    pub minor_radius: f64,
    /// The core curve where it is no circle, in the element's frame.
    pub curve: Option<Arc<Curve>>,
}

impl Ring {
    /// Whether its core is a circle.
    pub fn is_round(&self) -> bool {
        self.curve.is_none()
    }
}

/// A rigid element of the cell.
#[derive(Clone, Debug)]
pub struct Element {
    /// Name in the design, with the copy in a supercell: `flat@1,0`.
    pub name: String,
    /// Its rings, as indices into [`Model::rings`].
    pub rings: Range<usize>,
    /// Radius about the reference point that holds all core circles: max |offset| + R.
    pub reach: f64,
    /// Where its copy of the design's cell stands in a larger one, in lattice vectors: that part of a strain it can follow. In a
    /// design of more than `MANY` elements, where it stands itself.
    pub anchor: [f64; 2],
}

/// A design compiled for one cell.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name of the design.
    pub name: String,
    /// The cell that is solved; of a finite sheet, the whole sheet.
    pub cell: Cell,
    /// Whether the cell has images. A finite sheet has none: the only shift is (0, 0), and its lattice vectors, which
    /// nothing moves, only say where the cells were.
    pub periodic: bool,
    /// Whether the first lattice vector is the only one: a chain, whose copies aside are too far to touch.
    pub single: bool,
    /// Length of one unit of the model, in the file's unit: the reference radius R.
    pub unit: f64,
    /// Where the file has the model's origin, in the file's unit: its own origin, or the first element's centre where that
    /// lies more than `FAR` from it, so that positions keep their digits.
    pub origin: Vec3,
    /// Elements of the cell.
    pub elements: Vec<Element>,
    /// Rings of all elements.
    pub rings: Vec<Ring>,
    /// The starting state; its lattice is the reference of F.
    pub start: State,
    /// Inverse of the reference lattice [a1 a2] (columns), in the plane.
    pub reference_inverse: Matrix2<f64>,
    /// Links of the starting state: the topology that every state keeps.
    pub links: Vec<Link>,
    /// Largest major radius.
    pub largest_radius: f64,
    /// A short basis of the design's lattice, as a cell of one copy.
    pub short_basis: Cell,
    /// See [`Model::linked`] and [`Model::joined`].
    neighbours: OnceLock<Neighbours>,
}

/// A design of more elements is taken for a large cell written out.
pub(crate) const MANY: usize = 32;
/// A design whose first element lies further than this from the origin is moved there, in units of R.
pub(crate) const FAR: f64 = 1e3;
/// Ring `ring_a` of the main cell and ring `ring_b` of the image `shift`; each pair of the sheet stands once per cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RingPair {
    /// Ring of the main cell.
    pub ring_a: usize,
    /// Ring of the image.
    pub ring_b: usize,
    /// The image's shift.
    pub shift: Shift,
}

impl RingPair {
    /// The pair seen from either ring, as the ring of the main cell.
    pub(crate) fn both_ways(&self) -> [RingPair; 2] {
        let back = RingPair { ring_a: self.ring_b, ring_b: self.ring_a, shift: self.shift.map(|s| -s) };
        [*self, back]
    }
}

/// Two linked rings with their signed linking number (the signs follow the normals given in the design).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Link {
    /// The rings.
    pub pair: RingPair,
    /// Signed linking number, never 0.
    pub number: i32,
}

/// Elements that are joined by links, by element.
#[derive(Clone, Debug)]
struct Neighbours {
    linked: Vec<Vec<(usize, Shift)>>,
    joined: Vec<Vec<(usize, Shift)>>,
}

/// The one of `models` in this cell, or the same design compiled for it.
pub(crate) fn of_cell(models: &[Model], cell: Cell) -> Cow<'_, Model> {
    let known = models.iter().find(|model| model.cell == cell);
    known.map_or_else(|| Cow::Owned(models[0].in_cell(cell)), Cow::Borrowed)
}

impl Model {
    /// Sum of the minor radii of two rings: the core distance r̂ at which their tori touch.
    #[doc(hidden)]
    pub fn contact_distance(&self, ring_a: usize, ring_b: usize) -> f64 {
        self.rings[ring_a].minor_radius + self.rings[ring_b].minor_radius
    }

    fn neighbours(&self) -> &Neighbours {
        self.neighbours.get_or_init(|| {
            let mut linked = vec![BTreeSet::new(); self.elements.len()];
            for pair in self.links.iter().flat_map(|link| link.pair.both_ways()) {
                linked[self.rings[pair.ring_a].element].insert((self.rings[pair.ring_b].element, pair.shift));
            }
            let joined = |i: usize| {
                let second = |&(j, [m, n]): &(usize, Shift)| {
                    linked[j].iter().map(move |&(k, [p, q])| (k, [m + p, n + q])).collect::<Vec<_>>()
                };
                let all: BTreeSet<_> = linked[i].iter().copied().chain(linked[i].iter().flat_map(second)).collect();
                all.into_iter().filter(|(j, shift)| *j > i || *j == i && *shift > [0, 0]).collect()
            };
            let joined = (0..linked.len()).map(joined).collect();
            Neighbours { linked: linked.into_iter().map(|of| of.into_iter().collect()).collect(), joined }
        })
    }

    /// Whether all rings are circles.
    pub fn is_round(&self) -> bool {
        self.rings.iter().all(Ring::is_round)
    }

    /// The elements that are linked to element `e` of the main cell, each with its shift.
    pub(crate) fn linked(&self, e: usize) -> &[(usize, Shift)] {
        &self.neighbours().linked[e]
    }

    /// For each element those that one link or two join to it, each pair once: the lower element first, and for an element's own images
    /// the lexicographically positive shift; in the order of element and shift.
    pub(crate) fn joined(&self) -> &[Vec<(usize, Shift)>] {
        &self.neighbours().joined
    }

    /// A name for a ring of an image: `"gyroscope" ring 2 in cell (+1,+0)`.
    pub fn ring_label(&self, ring: usize, shift: Shift) -> String {
        let element = &self.elements[self.rings[ring].element];
        let mut label = format!("\"{}\"", element.name);
        if element.rings.len() > 1 {
            label += &format!(" ring {}", ring - element.rings.start);
        }
        label + &in_cell(shift)
    }

    /// A name for an image of an element: `"gyroscope" in cell (+1,+0)`.
    pub(crate) fn element_label(&self, element: usize, shift: Shift) -> String {
        format!("\"{}\"", self.elements[element].name) + &in_cell(shift)
    }
}

/// Of which cell an image is, where it is not the first.
fn in_cell(shift: Shift) -> String {
    match shift {
        [0, 0] => String::new(),
        [m, n] => format!(" in cell ({m:+},{n:+})"),
    }
}

/// What of a state depends on its model.
impl State {
    /// Arm from its element's reference point to the centre of ring `ring`.
    pub(crate) fn arm(&self, model: &Model, ring: usize) -> Vec3 {
        let r = &model.rings[ring];
        self.poses[r.element].rotation * r.offset
    }

    /// Core of ring `ring` in the image `shift`.
    pub fn core(&self, model: &Model, ring: usize, shift: Shift) -> Core {
        match &model.rings[ring].curve {
            None => Core::Circle(self.circle(model, ring, shift)),
            Some(curve) => {
                let pose = &self.poses[model.rings[ring].element];
                let pose = if shift == [0, 0] { *pose } else { self.image(shift).pose(pose) };
                Core::Curve(Arc::clone(curve), pose)
            }
        }
    }

    /// Core circle of ring `ring` in the image `shift`; of another curve the circle about its centre with its normal, and with the radius of
    /// its ball.
    pub fn circle(&self, model: &Model, ring: usize, shift: Shift) -> Circle {
        let r = &model.rings[ring];
        let pose = &self.poses[r.element];
        let center = pose.position + pose.rotation * r.offset;
        let normal = Unit::new_normalize(pose.rotation * r.normal.into_inner());
        match self.roll {
            // The energy method asks for each circle at each point: no motion is made where a translation is enough.
            None => Circle::new(center + self.translation(shift), normal, r.major_radius),
            Some(_) => self.image(shift).circle(&Circle::new(center, normal, r.major_radius)),
        }
    }

    /// A piece of the sheet in this state of the cell of `model`: the state of the finite sheet `piece` of the same design. The model of `piece` says which
    /// cells it has.
    pub fn of_piece(&self, model: &Model, piece: &Model) -> State {
        let of_cell = model.elements.len() / model.cell.copies();
        let places = piece.cell.cosets().into_iter().flat_map(|place| {
            let (copy, shift) = model.cell.copy_at(place);
            (0..of_cell).map(move |e| (copy * of_cell + e, shift))
        });
        let poses = places.map(|(e, shift)| self.image(shift).pose(&self.poses[e])).collect();
        State { poses, ..piece.start.clone() }
    }

    /// The neutral surface of a rolled state; `None` where nothing turns.
    pub fn neutral_surface_of(&self, model: &Model) -> Option<NeutralSurface> {
        let anchors: Vec<[f64; 2]> = model.elements.iter().map(|e| e.anchor).collect();
        self.neutral_surface(&anchors, &model.reference_inverse)
    }

    /// In-plane deformation gradient F of the lattice vectors, F a_k(reference) = a_k (eq. 5.2.1).
    pub fn deformation_gradient(&self, model: &Model) -> Matrix2<f64> {
        let deformed = Matrix2::new(self.a1.x, self.a2.x, self.a1.y, self.a2.y);
        deformed * model.reference_inverse
    }

    /// `design` as it stands in this state of its own cell: centres, normals, offsets and lattice in the design's unit.
    pub fn design(&self, design: &Design, model: &Model) -> Design {
        let mut out = design.clone();
        out.lattice.a1 = (self.a1 * model.unit).into();
        out.lattice.a2 = (self.a2 * model.unit).into();
        for (element, pose) in out.elements.iter_mut().zip(&self.poses) {
            element.center = (pose.position * model.unit + model.origin).into();
            for ring in &mut element.rings {
                ring.normal = (pose.rotation * Vec3::from(ring.normal)).into();
                ring.offset = (pose.rotation * Vec3::from(ring.offset)).into();
            }
            for curve in &mut element.curves {
                for vector in [&mut curve.normal, &mut curve.along, &mut curve.offset] {
                    *vector = (pose.rotation * Vec3::from(*vector)).into();
                }
            }
        }
        out.settled()
    }
}
