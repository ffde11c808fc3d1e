//! Print help: how far apart the meshes of a sheet are, which rings would fuse, and what would keep them apart.
//!
//! What is printed is the mesh, and the mesh is not inside the torus: chords across the bore of a ring lie in its hole. So
//! distances are those of the triangles that are written. A mesh lies at most p, its protrusion, outside its torus, and the torus at most e,
//! its chordal error, from the mesh ([`TorusMesh`](super::TorusMesh)). So the distance of two meshes is at least the gap of their
//! tori less p_a + p_b, and at most that gap and e_a + e_b: pairs that are farther apart need no triangles, and advice that
//! keeps to p holds for the mesh.

use super::{
    distance::{Triangle, least_distance},
    scene::Scene,
    torus::{Fineness, MOST, Segments, polygon},
};
use maille::{
    lattice::Shift,
    model::Model,
    state::State,
    topology::{self, RingPair},
};
use maille_geometry::Vec3;
use maille_io::Tile;

/// Rings whose meshes are closer to each other than a printer can keep apart. Lengths in millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct TooClose {
    /// Distance of the meshes of the closest pair: 0 where they meet, negative, as the gap of the tori, where those overlap.
    pub gap: f64,
    /// Gap of the tori of that pair.
    pub torus_gap: f64,
    /// The closest pair.
    pub pair: RingPair,
    /// Cells of the tile where it occurs first.
    pub cells: [Shift; 2],
    /// Names of its rings.
    pub rings: [String; 2],
    /// Middle between the closest points of its core circles.
    pub place: Vec3,
    /// Pairs of the cell that are too close.
    pub pairs: usize,
    /// Factor on every minor radius that would leave the clearance in this state; `None` if no wire is thin enough.
    pub minor_radius_factor: Option<f64>,
    /// Factor on the whole sheet that would leave the clearance; `None` where rings touch, at any size.
    pub scale_factor: Option<f64>,
    /// Segments that would leave the clearance; `None` where the tori are too close themselves.
    pub segments: Option<Segments>,
}

/// The smallest distance of the meshes of two elements in the tile, in millimetres: 0 where they meet; `None` where no two
/// are near.
pub fn smallest_clearance(scene: &Scene, model: &Model, state: &State, tile: Tile) -> Option<f64> {
    let meshes = Meshes::new(scene, model, state);
    let mut pairs = meshes.pairs(tile, model.largest_radius);
    pairs.sort_by(|a, b| a.least().total_cmp(&b.least()));
    let mut smallest = f64::INFINITY;
    for pair in pairs {
        if pair.least() >= smallest {
            break;
        }
        smallest = smallest.min(meshes.distance(&pair, smallest));
    }
    smallest.is_finite().then_some(smallest)
}

/// The closest rings of the tile if their meshes are closer than `clearance` millimetres. `fineness` is that of the scene.
///
/// Rings of one element are rigidly joined and may overlap; they are not looked at.
pub fn too_close(
    scene: &Scene,
    model: &Model,
    state: &State,
    tile: Tile,
    fineness: Fineness,
    clearance: f64,
) -> Option<TooClose> {
    let meshes = Meshes::new(scene, model, state);
    let to_mm = meshes.to_mm;
    // A gap that lacks less than rounding is wide enough.
    let enough = clearance - 1e-12 * to_mm;
    let (mut close, mut factor, mut tori) = (Vec::new(), f64::INFINITY, f64::INFINITY);
    let worst = 2.0 * meshes.protrusions.iter().copied().fold(0.0, f64::max);
    for pair in meshes.pairs(tile, (clearance + worst) / to_mm).into_iter().filter(|pair| pair.least() < enough) {
        tori = tori.min(pair.gap);
        let distance = meshes.distance(&pair, clearance);
        if distance >= enough {
            continue;
        }
        // Thinner wire can have other chords; this bounds them all.
        let outside = |ring: usize| match model.rings[ring].is_round() {
            true => fineness.protrusion(model.rings[ring].major_radius * model.unit) * scene.mm,
            false => meshes.protrusions[ring],
        };
        let outside = outside(pair.rings.ring_a) + outside(pair.rings.ring_b);
        factor = factor.min((pair.gap + pair.radii - clearance - outside) / pair.radii);
        close.push((if pair.gap < 0.0 { pair.gap } else { distance }, pair));
    }
    let pairs = close.len();
    // In reference radii, in which pairs count as equally close.
    let (_, rings) = topology::closest(close.iter().map(|(gap, pair)| (gap / to_mm, pair.rings)))?;
    let (gap, pair) = close.into_iter().find(|(_, pair)| pair.rings == rings)?;
    // The first cells of the tile that hold both.
    let cell_a = rings.shift.map(|k| (-k).max(0));
    let cell_b = [0, 1].map(|k| cell_a[k] + rings.shift[k]);
    let [point_a, point_b] = topology::closest_points(model, state, [(rings.ring_a, cell_a), (rings.ring_b, cell_b)]);
    Some(TooClose {
        gap,
        torus_gap: pair.gap,
        pair: rings,
        cells: [cell_a, cell_b],
        rings: [model.ring_label(rings.ring_a, cell_a), model.ring_label(rings.ring_b, cell_b)],
        place: (point_a + point_b) * (0.5 * to_mm),
        pairs,
        minor_radius_factor: (factor > 1e-6).then_some(factor),
        scale_factor: (gap > 1e-9 * to_mm).then_some(clearance / gap),
        segments: finer(scene, 0.5 * (tori - clearance)),
    })
}

/// Segments with which no mesh of the scene lies farther than `most` millimetres outside its torus; as many across as now.
fn finer(scene: &Scene, most: f64) -> Option<Segments> {
    let mut segments = Segments { around: 3, across: 3 };
    for shape in &scene.shapes {
        // Never coarser than now: pairs that are far enough apart stay so.
        let around = (most > 0.0).then(|| polygon(shape.major_radius, most))?.max(shape.segments.around);
        segments.around = segments.around.max(around);
        segments.across = segments.across.max(shape.segments.across);
    }
    (segments.around <= MOST).then_some(segments)
}

/// Two rings of different elements. Lengths in millimetres.
struct Near {
    rings: RingPair,
    /// Gap of the tori.
    gap: f64,
    /// Sum of the minor radii.
    radii: f64,
    /// p_a + p_b.
    outside: f64,
    /// e_a + e_b.
    errors: f64,
}

impl Near {
    /// The meshes are no closer than this.
    fn least(&self) -> f64 {
        self.gap - self.outside
    }
}

/// The meshes of one cell.
struct Meshes<'a> {
    model: &'a Model,
    state: &'a State,
    to_mm: f64,
    /// Triangles of each ring.
    triangles: Vec<Vec<Triangle>>,
    /// Protrusion and chordal error of each ring.
    protrusions: Vec<f64>,
    errors: Vec<f64>,
}

impl<'a> Meshes<'a> {
    fn new(scene: &Scene, model: &'a Model, state: &'a State) -> Self {
        let mut triangles = vec![Vec::new(); model.rings.len()];
        let mut protrusions = vec![0.0; model.rings.len()];
        let mut errors = protrusions.clone();
        for ring in scene.rings().filter(|ring| ring.placed.cell == [0, 0]) {
            let shape = &scene.shapes[ring.shape];
            let corner = |k: usize| (ring.pose * nalgebra::Point3::from(shape.vertices[k])).coords;
            triangles[ring.ring] = shape.triangles().map(|corners| corners.map(corner)).collect();
            protrusions[ring.ring] = shape.protrusion();
            errors[ring.ring] = shape.chordal_error();
        }
        Meshes { model, state, to_mm: model.unit * scene.mm, triangles, protrusions, errors }
    }

    /// Pairs of rings of different elements in the tile whose tori are nearer than `margin` reference radii.
    fn pairs(&self, tile: Tile, margin: f64) -> Vec<Near> {
        let pairs = match self.state.roll {
            Some(_) => topology::close_pairs_within(self.model, self.state, tile.0, margin),
            None => topology::close_pairs(self.model, self.state, margin),
        };
        let near = |rings: RingPair| {
            let radii = self.model.contact_distance(rings.ring_a, rings.ring_b) * self.to_mm;
            let gap = topology::core_distance(self.model, self.state, &rings) * self.to_mm - radii;
            let sum = |of: &[f64]| of[rings.ring_a] + of[rings.ring_b];
            Near { rings, gap, radii, outside: sum(&self.protrusions), errors: sum(&self.errors) }
        };
        pairs.into_iter().filter(|pair| tile.holds(pair.shift)).map(near).collect()
    }

    /// The distance of the two meshes where it is less than `most`, else `most`.
    fn distance(&self, pair: &Near, most: f64) -> f64 {
        let RingPair { ring_a, ring_b, shift } = pair.rings;
        let image = self.state.image(shift);
        let moved = |p: Vec3| image.vector(&p) + image.point(&Vec3::zeros()) * self.to_mm;
        let mut a = self.triangles[ring_a].clone();
        let mut b: Vec<Triangle> = self.triangles[ring_b].iter().map(|t| t.map(moved)).collect();
        // Rounding of the bound must not hide the distance.
        let bound = (pair.gap + pair.errors) * (1.0 + 1e-9) + 1e-9 * self.to_mm;
        let found = least_distance(&mut a, &mut b, most.min(bound.max(0.0)));
        if found < most { found } else { most }
    }
}
