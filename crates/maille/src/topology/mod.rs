//! Which rings are near, which are linked, and in which directions chains of links bind the sheet.

pub(crate) mod broad_phase;
pub(crate) mod motion;
pub mod near_pairs;
mod rolled_step;
pub mod separation;
pub mod side_signs;
pub mod step_bound;
mod warnings;
pub(crate) mod winding;
mod window;

pub use crate::model::{Link, RingPair};
use crate::{
    lattice::Shift,
    model::{
        Model,
        curve::{Core, curve_distance, curve_distance_minima},
    },
    state::State,
};
use maille_geometry::{Vec3, circle_distance_minima, curve_linking_number, linking_number};
use std::collections::{BTreeMap, BTreeSet};
pub use warnings::warnings;

/// All pairs of rings of different elements whose tori may be within `margin` of each other.
///
/// An element's images are other elements; rings of one element make no pair. Of (a, b, s) and (b, a, −s) one is
/// listed: the lower element first, and for an element's own images the lexicographically positive shift.
pub fn close_pairs(model: &Model, state: &State, margin: f64) -> Vec<RingPair> {
    let thickest = model.rings.iter().map(|r| r.minor_radius).fold(0.0, f64::max);
    let neighbours = broad_phase::neighbours(model, state, thickest, margin);
    ring_pairs(model, state, &neighbours, margin)
}

/// As [`close_pairs`], of the pairs within a tile of `cells` cells, however far around a roll: an endless roll counts no pair
/// beyond half a turn, a piece of it has them.
pub fn close_pairs_within(model: &Model, state: &State, cells: [u32; 2], margin: f64) -> Vec<RingPair> {
    let [m, n] = cells.map(|cells| cells as i32 - 1);
    let thickest = model.rings.iter().map(|r| r.minor_radius).fold(0.0, f64::max);
    let mut neighbours = vec![Vec::new(); model.elements.len()];
    for shift in (-m..=m).flat_map(|i| (-n..=n).map(move |j| [i, j])) {
        let image = state.image(shift);
        for (i, near) in neighbours.iter_mut().enumerate() {
            for j in i..model.elements.len() {
                let way = image.way(&state.poses[i].position, &state.poses[j].position).norm();
                let reach = model.elements[i].reach + model.elements[j].reach + 2.0 * thickest + margin;
                if (j > i || shift > [0, 0]) && way <= reach {
                    near.push((j, shift));
                }
            }
        }
    }
    ring_pairs(model, state, &neighbours, margin)
}

/// The pairs of rings that may be within `margin`, of each element and its `neighbours`.
fn ring_pairs(model: &Model, state: &State, neighbours: &[Vec<(usize, Shift)>], margin: f64) -> Vec<RingPair> {
    let arms: Vec<_> = (0..model.rings.len()).map(|ring| state.arm(model, ring)).collect();
    let elements: Vec<usize> = (0..model.elements.len()).collect();
    broad_phase::in_chunks(&elements, |some| {
        let mut out = Vec::new();
        for &i in some {
            for &(j, shift) in &neighbours[i] {
                let image = state.image(shift);
                let offset = image.way(&state.poses[i].position, &state.poses[j].position);
                for ring_a in model.elements[i].rings.clone() {
                    for ring_b in model.elements[j].rings.clone() {
                        let (ra, rb) = (&model.rings[ring_a], &model.rings[ring_b]);
                        let centers = offset + image.vector(&arms[ring_b]) - arms[ring_a];
                        let near = ra.major_radius + rb.major_radius + ra.minor_radius + rb.minor_radius + margin;
                        if centers.norm_squared() <= near * near {
                            out.push(RingPair { ring_a, ring_b, shift });
                        }
                    }
                }
            }
        }
        out
    })
}

/// The cores of a pair.
fn cores(model: &Model, state: &State, pair: &RingPair) -> (Core, Core) {
    (state.core(model, pair.ring_a, [0, 0]), state.core(model, pair.ring_b, pair.shift))
}

/// Least distance of the pair's cores.
pub fn core_distance(model: &Model, state: &State, pair: &RingPair) -> f64 {
    let (a, b) = cores(model, state, pair);
    match (&a, &b) {
        (Core::Circle(a), Core::Circle(b)) => circle_distance_minima(a, b).closest().distance,
        _ => curve_distance(&a, &b),
    }
}

/// The closest points of the cores of two rings in their cells.
pub fn closest_points(model: &Model, state: &State, [(a, cell_a), (b, cell_b)]: [(usize, Shift); 2]) -> [Vec3; 2] {
    let (a, b) = (state.core(model, a, cell_a), state.core(model, b, cell_b));
    match (&a, &b) {
        (Core::Circle(a), Core::Circle(b)) => {
            let minimum = *circle_distance_minima(a, b).closest();
            [minimum.point_a, minimum.point_b]
        }
        _ => {
            let minima = curve_distance_minima(&a, &b, 0.0);
            minima.first().map_or([Vec3::repeat(f64::NAN); 2], |m| [m.a.point, m.b.point])
        }
    }
}

/// Smallest gap of all pairs (negative where tori overlap), with its pair; `None` where no two rings are near.
pub fn smallest_gap(model: &Model, state: &State) -> Option<(f64, RingPair)> {
    let pairs = close_pairs(model, state, model.largest_radius);
    let gap = |p: &RingPair| core_distance(model, state, p) - model.contact_distance(p.ring_a, p.ring_b);
    closest(pairs.into_iter().map(|pair| (gap(&pair), pair)))
}

/// Pairs whose gaps differ by less, in reference radii, are as close: rounding would choose between them.
const AS_CLOSE: f64 = 1e-9;

/// The smallest of `gaps`; of the pairs that are as close the one in the nearest cells, then the first.
pub fn closest(gaps: impl IntoIterator<Item = (f64, RingPair)>) -> Option<(f64, RingPair)> {
    let gaps: Vec<(f64, RingPair)> = gaps.into_iter().collect();
    let least = gaps.iter().map(|(gap, _)| *gap).min_by(f64::total_cmp)?;
    let near = gaps.into_iter().filter(|(gap, _)| *gap <= least + AS_CLOSE).map(|(_, pair)| pair);
    let order = |pair: &RingPair| {
        let [m, n] = pair.shift.map(i32::unsigned_abs);
        (m + n, pair.ring_a, pair.ring_b, pair.shift)
    };
    near.min_by_key(order).map(|pair| (least, pair))
}

/// The links among `pairs`, sorted.
pub fn links(model: &Model, state: &State, pairs: &[RingPair]) -> Vec<Link> {
    let mut out: Vec<Link> = pairs
        .iter()
        .map(|&pair| {
            let (a, b) = cores(model, state, &pair);
            let number = match (&a, &b) {
                (Core::Circle(a), Core::Circle(b)) => linking_number(a, b),
                // Where it cannot be told the two are too near to be kept apart.
                _ => curve_linking_number(&a.pieces(), &b.pieces(), curve_distance(&a, &b)).unwrap_or(0),
            };
            Link { pair, number }
        })
        .filter(|link| link.number != 0)
        .collect();
    out.sort_unstable();
    out
}

/// Whether `state` has exactly the links of the starting state.
pub fn links_kept(model: &Model, state: &State) -> bool {
    links(model, state, &close_pairs(model, state, 0.0)) == model.links
}

/// An element linked to another, with the linking numbers of the linked ring pairs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Neighbour {
    /// The other element.
    pub element: usize,
    /// The cell that it is in.
    pub shift: Shift,
    /// Signed linking numbers of all linked pairs of rings of the two.
    pub numbers: Vec<i32>,
}

/// The interlocking neighbours (Definition 3.4.1) of one element of the main cell, sorted by element and cell.
pub fn neighbours(model: &Model, element: usize) -> Vec<Neighbour> {
    let mut found = BTreeMap::<(usize, Shift), Vec<i32>>::new();
    for link in &model.links {
        for pair in link.pair.both_ways().into_iter().filter(|pair| model.rings[pair.ring_a].element == element) {
            found.entry((model.rings[pair.ring_b].element, pair.shift)).or_default().push(link.number);
        }
    }
    found.into_iter().map(|((element, shift), numbers)| Neighbour { element, shift, numbers }).collect()
}

/// Elements that chains of links join, images included, with the lattice vectors by which such chains return to an element.
pub(crate) struct LinkedPart {
    /// Its elements, ascending.
    pub elements: Vec<usize>,
    /// Generators of the group of lattice vectors that chains of links join.
    pub vectors: BTreeSet<Shift>,
}

/// The connected components of the periodic link graph (the elements are its nodes, the links its edges with shifts).
///
/// Spanning trees give every element an offset; an edge that closes a loop gives the lattice vector by which it misses.
pub(crate) fn linked_parts(model: &Model) -> Vec<LinkedPart> {
    let n = model.elements.len();
    let mut edges = vec![Vec::new(); n];
    for pair in model.links.iter().flat_map(|link| link.pair.both_ways()) {
        edges[model.rings[pair.ring_a].element].push((model.rings[pair.ring_b].element, pair.shift));
    }
    let mut offset: Vec<Option<Shift>> = vec![None; n];
    let mut out = Vec::new();
    for root in 0..n {
        if offset[root].is_some() {
            continue;
        }
        offset[root] = Some([0, 0]);
        let mut part = LinkedPart { elements: Vec::new(), vectors: BTreeSet::new() };
        let mut queue = vec![(root, [0, 0])];
        while let Some((i, at)) = queue.pop() {
            part.elements.push(i);
            for &(j, [p, q]) in &edges[i] {
                let here = [at[0] + p, at[1] + q];
                match offset[j] {
                    None => {
                        offset[j] = Some(here);
                        queue.push((j, here));
                    }
                    Some(there) => {
                        let loop_shift = [here[0] - there[0], here[1] - there[1]];
                        if loop_shift > [0, 0] {
                            part.vectors.insert(loop_shift);
                        }
                    }
                }
            }
        }
        part.elements.sort_unstable();
        out.push(part);
    }
    out
}

/// How the links bind the sheet: a direction D is bound iff some of these lattice vectors v has v·D ≠ 0.
pub fn binding_vectors(model: &Model) -> Vec<Shift> {
    let all: BTreeSet<Shift> = linked_parts(model).into_iter().flat_map(|part| part.vectors).collect();
    all.into_iter().collect()
}

/// Whether a chain of links binds a pull along `direction` (a unit vector in the plane).
pub(crate) fn binds(model: &Model, direction: [f64; 2]) -> bool {
    binding_vectors(model).into_iter().any(|s| {
        let v = model.start.translation(s);
        (v.x * direction[0] + v.y * direction[1]).abs() > 1e-9 * v.norm()
    })
}
