//! What is exported: the tori of a finite piece of the sheet, in millimetres.

use super::{
    curve::curve_mesh,
    error::MeshError,
    torus::{Fineness, TorusMesh},
};
use maille::{
    model::{MEMORY_LIMIT_BYTES, Model, Ring},
    record::{ContactRecord, StateRecord},
    state::{Pose, Roll, State},
};
use maille_geometry::Vec3;
use maille_io::Tile;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Most rings of one export.
const MOST_RINGS: usize = (MEMORY_LIMIT_BYTES / BYTES_OF_RING) as usize;
/// Memory that a ring takes, in bytes: 0.13 GB for a glTF file of 43,200; other formats take less.
const BYTES_OF_RING: f64 = 2500.0;

/// A ring of a kind of element.
#[derive(Clone, Debug)]
pub struct KindRing {
    /// Its mesh in [`Scene::shapes`].
    pub shape: usize,
    /// From the mesh's frame (axis z) to the element's.
    pub local: Isometry3<f64>,
}

/// A kind of element: one element of the design, of which every cell has a copy.
#[derive(Clone, Debug)]
pub struct Kind {
    /// Name in the design.
    pub name: String,
    /// Its rings.
    pub rings: Vec<KindRing>,
}

/// An element of the tile.
#[derive(Clone, Debug)]
pub struct Placed {
    /// Its kind in [`Scene::kinds`].
    pub kind: usize,
    /// Element of the solved cell that it is a copy of.
    pub member: usize,
    /// Its cell.
    pub cell: [u32; 2],
    /// From the element's frame to the sheet's.
    pub pose: Isometry3<f64>,
}

/// A ring of the tile.
#[derive(Clone, Debug)]
pub struct PlacedRing<'a> {
    /// Index of its element in [`Scene::elements`].
    pub element: usize,
    /// The element.
    pub placed: &'a Placed,
    /// Ring of the solved cell that it is a copy of, counted through all elements.
    pub ring: usize,
    /// Its mesh in [`Scene::shapes`].
    pub shape: usize,
    /// From the mesh's frame to the sheet's.
    pub pose: Isometry3<f64>,
}

/// A contact of a locked state in the tile.
#[derive(Clone, Debug)]
pub struct PlacedContact {
    /// Where the tori touch.
    pub point: Vec3,
    /// Force on ring B, per unit of pull; on ring A the opposite.
    pub force: Vec3,
    /// Ring A of the solved cell, and its cell.
    pub ring_a: usize,
    /// Ring B of the solved cell.
    pub ring_b: usize,
    /// Cell of ring A.
    pub cell: [u32; 2],
    /// Whether ring B is in the tile too.
    pub inside: bool,
}

/// A piece of the sheet in one state, in millimetres; its meshes are shared by all rings of the same radii.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the design.
    pub name: String,
    /// What it shows, for the metadata of the file.
    pub description: String,
    /// Millimetres of one unit of the design file.
    pub mm: f64,
    /// One mesh for each pair of radii, and each other curve.
    pub shapes: Vec<TorusMesh>,
    /// The kinds of elements, in the design's order.
    pub kinds: Vec<Kind>,
    /// The elements of the tile, cell by cell.
    pub elements: Vec<Placed>,
    /// Contacts of a locked state.
    pub contacts: Vec<PlacedContact>,
    /// Sum of the contact forces' magnitudes on each element of the solved cell, where a state has contacts.
    pub loads: Option<Vec<f64>>,
    /// The point that becomes the origin of files for printing and showing: [`Scene::corner`] of a new scene, so that
    /// what is printed stands on the bed. VTK files keep the coordinates of the state.
    pub origin: Vec3,
    /// Whether images are turned.
    rolled: bool,
    /// First ring of every element of the solved cell.
    first_ring: Vec<usize>,
}

impl Scene {
    /// The tile of `model` in `state`; `fineness` counts in the design file's unit, of `mm` millimetres.
    pub fn new(model: &Model, state: &State, tile: Tile, fineness: Fineness, mm: f64) -> Result<Scene, MeshError> {
        let [columns, rows] = tile.0.map(|n| n as usize);
        let rings = columns.saturating_mul(rows).saturating_mul(model.rings.len());
        if rings > MOST_RINGS {
            return Err(MeshError::TooManyRings { rings, most: MOST_RINGS });
        }
        let to_mm = model.unit * mm;
        let kind_count = model.elements.len() / model.cell.copies();
        let mut shapes = Vec::new();
        let mut known: Vec<&Ring> = Vec::new();
        let mut kinds = Vec::new();
        for element in &model.elements[..kind_count] {
            let mut rings = Vec::new();
            for ring in &model.rings[element.rings.clone()] {
                let pair = [ring.major_radius, ring.minor_radius];
                let same = |other: &&Ring| {
                    let radii = [other.major_radius, other.minor_radius];
                    radii.map(f64::to_bits) == pair.map(f64::to_bits) && other.curve == ring.curve
                };
                let shape = match known.iter().position(same) {
                    Some(shape) => shape,
                    None => {
                        let [big, small] = pair.map(|x| x * model.unit);
                        shapes.push(match &ring.curve {
                            None => TorusMesh::new(big * mm, small * mm, fineness.segments(big, small)?),
                            Some(curve) => curve_mesh(curve, pair, fineness, model.unit, mm)?,
                        });
                        known.push(ring);
                        shapes.len() - 1
                    }
                };
                let local = match ring.is_round() {
                    true => {
                        let offset = Translation3::from(ring.offset * to_mm);
                        Isometry3::from_parts(offset, turn_of_axis(&ring.normal))
                    }
                    false => Isometry3::identity(),
                };
                rings.push(KindRing { shape, local });
            }
            // In a supercell the model adds the copy to the name.
            let name = match element.name.rsplit_once('@') {
                Some((name, _)) if model.cell.copies() > 1 => name,
                _ => &element.name,
            };
            kinds.push(Kind { name: name.to_owned(), rings });
        }
        let mut elements = Vec::with_capacity(columns * rows * model.elements.len());
        for i in 0..tile.0[0] {
            for j in 0..tile.0[1] {
                let image = state.image([i as i32, j as i32]);
                for (member, pose) in state.poses.iter().enumerate() {
                    let pose = image.pose(pose);
                    let translation = Translation3::from(pose.position * to_mm);
                    let pose = Isometry3::from_parts(translation, pose.rotation);
                    elements.push(Placed { kind: member % kind_count, member, cell: [i, j], pose });
                }
            }
        }
        let mut scene = Scene {
            name: model.name.clone(),
            description: String::new(),
            mm,
            shapes,
            kinds,
            elements,
            contacts: Vec::new(),
            loads: None,
            origin: Vec3::zeros(),
            rolled: state.roll.is_some(),
            first_ring: model.elements.iter().map(|e| e.rings.start).collect(),
        };
        scene.origin = scene.corner();
        Ok(scene)
    }

    /// Adds the contacts of a locked state to the tile, and the loads on its elements.
    pub fn add_contacts(&mut self, model: &Model, state: &State, tile: Tile, contacts: &[ContactRecord]) {
        self.add_loads(model, contacts);
        for contact in contacts {
            let normal = Vec3::from(contact.normal);
            let inner = model.rings[contact.ring_a].minor_radius * model.unit;
            let outer = model.rings[contact.ring_b].minor_radius * model.unit;
            // The middle between the two surfaces: the same point where they touch.
            let on_a = Vec3::from(contact.point_a) + normal * inner;
            let on_b = Vec3::from(contact.point_b) - normal * outer;
            for i in 0..tile.0[0] {
                for j in 0..tile.0[1] {
                    let image = state.image([i as i32, j as i32]);
                    let middle = image.point(&((on_a + on_b) * (0.5 / model.unit))) * model.unit;
                    let there = [i as i32 + contact.shift[0], j as i32 + contact.shift[1]];
                    self.contacts.push(PlacedContact {
                        point: middle * self.mm,
                        force: image.vector(&normal) * contact.force,
                        ring_a: contact.ring_a,
                        ring_b: contact.ring_b,
                        cell: [i, j],
                        inside: (0..2).all(|k| (0..tile.0[k] as i32).contains(&there[k])),
                    });
                }
            }
        }
    }

    /// Adds the loads on the elements alone.
    pub fn add_loads(&mut self, model: &Model, contacts: &[ContactRecord]) {
        if contacts.is_empty() {
            return;
        }
        let mut loads = vec![0.0; model.elements.len()];
        for contact in contacts {
            for ring in [contact.ring_a, contact.ring_b] {
                loads[model.rings[ring].element] += contact.force;
            }
        }
        self.loads = Some(loads);
    }

    /// The rings of the tile, element by element.
    pub fn rings(&self) -> impl Iterator<Item = PlacedRing<'_>> {
        self.elements.iter().enumerate().flat_map(move |(element, placed)| {
            let first = self.first_ring[placed.member];
            self.kinds[placed.kind].rings.iter().enumerate().map(move |(k, ring)| PlacedRing {
                element,
                placed,
                ring: first + k,
                shape: ring.shape,
                pose: placed.pose * ring.local,
            })
        })
    }

    /// Number of rings.
    pub fn ring_count(&self) -> usize {
        self.elements.iter().map(|e| self.kinds[e.kind].rings.len()).sum()
    }

    /// Number of triangles where every ring has its own.
    pub fn triangle_count(&self) -> usize {
        let of_kind = |k: &Kind| k.rings.iter().map(|r| self.shapes[r.shape].triangle_count()).sum::<usize>();
        let of_kinds: Vec<usize> = self.kinds.iter().map(of_kind).collect();
        self.elements.iter().map(|e| of_kinds[e.kind]).sum()
    }

    /// Largest bound of the distance between a mesh and its torus.
    pub fn chordal_error(&self) -> f64 {
        self.shapes.iter().map(TorusMesh::chordal_error).fold(0.0, f64::max)
    }

    /// The corner of the box around the meshes with the smallest x, y and z.
    pub fn corner(&self) -> Vec3 {
        self.mesh_box(|_| true)[0]
    }

    /// Least and largest corner of the box around the meshes of those shapes that `counts`.
    fn mesh_box(&self, counts: impl Fn(&TorusMesh) -> bool) -> [Vec3; 2] {
        // Copies of a ring in other cells are translated, but turned in a rolled sheet.
        let mut reaches = vec![None; self.first_ring.last().map_or(0, |last| last + self.largest_kind())];
        let nothing = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
        self.rings().filter(|ring| counts(&self.shapes[ring.shape])).fold(nothing, |[least, largest], ring| {
            if self.rolled {
                reaches[ring.ring] = None;
            }
            let reach: &mut Option<[Vec3; 2]> = &mut reaches[ring.ring];
            let [below, above] = reach.get_or_insert_with(|| {
                let turned = self.shapes[ring.shape].vertices.iter().map(|v| ring.pose.rotation * v);
                turned.fold(nothing, |[least, largest], v| [least.inf(&v), largest.sup(&v)])
            });
            let at = ring.pose.translation.vector;
            [least.inf(&(at + *below)), largest.sup(&(at + *above))]
        })
    }

    /// Most rings of an element.
    fn largest_kind(&self) -> usize {
        self.kinds.iter().map(|kind| kind.rings.len()).max().unwrap_or(0)
    }

    /// A point of a ring's mesh, measured from the origin of a file.
    pub(super) fn in_file(&self, ring: &PlacedRing<'_>, vertex: &Vec3) -> Vec3 {
        ring.pose.rotation * vertex + (ring.pose.translation.vector - self.origin)
    }

    /// Least and largest corner of the box around the tori, and the meshes of other curves.
    ///
    /// A circle of radius R and normal n reaches R √(1 − n_k²) along axis k.
    pub fn bounds(&self) -> [Vec3; 2] {
        let [mut least, mut largest] = self.mesh_box(|shape| shape.chords.is_some());
        for ring in self.rings() {
            let shape = &self.shapes[ring.shape];
            if shape.chords.is_some() {
                continue;
            }
            let normal = ring.pose.rotation * Vec3::z();
            let reach = normal.map(|n| shape.major_radius * (1.0 - n * n).max(0.0).sqrt() + shape.minor_radius);
            least = least.inf(&(ring.pose.translation.vector - reach));
            largest = largest.sup(&(ring.pose.translation.vector + reach));
        }
        [least, largest]
    }
}

/// A rotation that takes the z axis to `normal`.
fn turn_of_axis(normal: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), normal)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

/// The state of a record's line, for the model that was solved.
pub fn state_of(model: &Model, record: &StateRecord) -> Result<State, MeshError> {
    record.state(model).ok_or(MeshError::OtherElements { state: record.poses.len(), cell: model.elements.len() })
}

/// A state of a record in words, or the start.
pub fn state_words(record: Option<&StateRecord>) -> String {
    match record {
        None => "starting state".into(),
        Some(r) if r.roll.is_some() => format!("rolled along {}°, {}", r.direction_deg, r.status.name()),
        Some(r) => format!("direction {}°, l2 {}, {}", r.direction_deg, r.l2, r.status.name()),
    }
}

/// The state a part `t` (0 to 1) of the way from `start` to `end`.
///
/// Lattice vectors and positions move along straight lines, rotations turn at a constant rate about one axis, the short
/// way. It is a picture of the change, no motion that the rings could make: in between they may overlap.
pub fn between(start: &State, end: &State, t: f64) -> State {
    let mix = |a: &Vec3, b: &Vec3| a * (1.0 - t) + b * t;
    let poses = start.poses.iter().zip(&end.poses).map(|(a, b)| Pose {
        position: mix(&a.position, &b.position),
        rotation: UnitQuaternion::from_scaled_axis((b.rotation * a.rotation.inverse()).scaled_axis() * t) * a.rotation,
    });
    // A sheet that is not rolled is one whose turns are 0, along any direction.
    let turns = |state: &State| state.roll.map_or([0.0; 2], |roll| roll.turn_rad);
    let turn_rad = [0, 1].map(|k| turns(start)[k] * (1.0 - t) + turns(end)[k] * t);
    let roll = end.roll.or(start.roll).map(|roll| Roll { turn_rad, ..roll });
    State { poses: poses.collect(), a1: mix(&start.a1, &end.a1), a2: mix(&start.a2, &end.a2), roll }
}
