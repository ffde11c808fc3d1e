//! The image bound: how near an element's own image can come.
//!
//! In a cell every image of an element has the element's orientation, so the two differ by a translation w alone. The
//! set of all w at which they overlap, or have links that the design does not have, depends on the element's shape
//! only. Let m be the radius of the largest ball around 0 within it. Then a lattice vector v that joins no linked images
//! obeys |F v| ≥ m, and since |F v| grows with l1, a v with |F v| < m at l1 = u proves that no l1 ≤ u is reached.
//!
//! **Proof of m.** Let d be the core distance of one ring of the element and one ring of its image at w, δ the sum of
//! their minor radii. A translation by t changes d by at most t. So all translations nearer to w than δ − d overlap. If
//! the two are linked at w, those nearer than d + δ are out too: the link lasts until the cores meet, and from there
//! they have to come apart by δ. A cube around w within that ball is out. Cubes are taken in the order of their
//! distance from 0 and cut into eight, until one is left that is as small as the wanted accuracy: its distance is m.
//!
//! A gyroscope (three unit circles across each other) shows what this is good for: nearer than 2/√3 any two of them
//! are linked, however thin the wire. For a single ring m = 2r: it can lie flat on its image. For an element with other curves m = 2r of its thickest tube, too.
//!
//! The proof holds for the solved cell only. In a larger one the copies of an element turn independently.

use crate::{
    lattice::{Shift, shifts_within},
    model::{Element, Model, Ring},
    state::State,
};
use maille_geometry::{Circle, Torus, Vec3, circle_distance_minima, linking_number};
use std::{cmp::Ordering, collections::BinaryHeap};

/// The least distance of own images, for each element of a model.
#[derive(Clone, Debug)]
pub struct ImageBound {
    least: Vec<f64>,
}

/// Two images that would be too near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearImages {
    /// The element.
    pub element: usize,
    /// Shift of its image.
    pub shift: Shift,
    /// |F v|, in reference radii.
    pub distance: f64,
    /// m, in reference radii.
    pub least: f64,
}

/// Accuracy of m, from below, in reference radii.
const ACCURACY: f64 = 0.02;
/// Relative to rounding.
const MARGIN: f64 = 1e-9;

impl ImageBound {
    /// Finds m for each element of `model`.
    pub fn new(model: &Model) -> Self {
        let least = |e: &Element| {
            let rings = &model.rings[e.rings.clone()];
            match rings.iter().all(Ring::is_round) {
                true => least_distance(&tori(model, e)),
                // A point of a tube and its image are w apart.
                false => 2.0 * rings.iter().map(|ring| ring.minor_radius).fold(0.0, f64::max),
            }
        };
        ImageBound { least: model.elements.iter().map(least).collect() }
    }

    /// m of an element, in reference radii.
    pub fn least(&self, element: usize) -> f64 {
        self.least[element]
    }

    /// Images of `model`'s elements that are too near in the lattice of `state`; `None` proves nothing.
    ///
    /// With the lattice of a proven bound of l1, a pair proves that this l2 is out of reach.
    pub(crate) fn too_near(&self, model: &Model, state: &State) -> Option<NearImages> {
        (0..model.elements.len()).find_map(|element| {
            let least = self.least[element];
            let shifts = shifts_within(&Vec3::zeros(), &state.a1, &state.a2, least);
            shifts.into_iter().filter(|s| *s > [0, 0]).find_map(|shift| {
                let linked = model.links.iter().any(|link| {
                    let [a, b] = [link.pair.ring_a, link.pair.ring_b].map(|ring| model.rings[ring].element);
                    a == element && b == element && link.pair.shift == shift
                });
                let distance = state.translation(shift).norm();
                (!linked && distance < least - MARGIN).then_some(NearImages { element, shift, distance, least })
            })
        })
    }
}

/// The rings of an element in its own frame.
fn tori(model: &Model, element: &Element) -> Vec<Torus> {
    let ring = |k: usize| {
        let ring = &model.rings[k];
        let circle = Circle::new(ring.offset, ring.normal, ring.major_radius);
        Torus { circle, minor_radius: ring.minor_radius }
    };
    element.rings.clone().map(ring).collect()
}

/// A cube of translations, nearest to 0 first.
struct Cube {
    center: Vec3,
    half: f64,
    nearest: f64,
}

impl Cube {
    fn new(center: Vec3, half: f64) -> Self {
        let nearest = center.map(|x| (x.abs() - half).max(0.0)).norm();
        Cube { center, half, nearest }
    }
}

impl PartialEq for Cube {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cube {}

impl PartialOrd for Cube {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cube {
    /// The nearest is the greatest; of equally near ones the larger.
    fn cmp(&self, other: &Self) -> Ordering {
        other.nearest.total_cmp(&self.nearest).then(self.half.total_cmp(&other.half))
    }
}

fn least_distance(tori: &[Torus]) -> f64 {
    let reach = tori.iter().map(|t| t.circle.center.norm() + t.circle.radius + t.minor_radius).fold(0.0, f64::max);
    if let [ring] = tori {
        return 2.0 * ring.minor_radius;
    }
    let mut heap = BinaryHeap::from([Cube::new(Vec3::zeros(), 2.0 * reach)]);
    let mut free = 2.0 * reach;
    while let Some(cube) = heap.pop() {
        if cube.nearest > free - ACCURACY || cube.half < ACCURACY / 8.0 {
            return cube.nearest;
        }
        let out = ruled_out(tori, &cube.center, cube.half * 3f64.sqrt());
        if out >= cube.half * 3f64.sqrt() {
            continue;
        }
        if out < 0.0 {
            free = free.min(cube.center.norm());
        }
        let half = cube.half / 2.0;
        for corner in 0..8 {
            let sign = |bit: u32| if corner >> bit & 1 == 1 { half } else { -half };
            let center = cube.center + Vec3::new(sign(0), sign(1), sign(2));
            // −w is out where w is.
            if center.z > 0.0 {
                heap.push(Cube::new(center, half));
            }
        }
    }
    free
}

/// Radius of a ball around the translation `w` in which all are ruled out; below 0 where `w` itself is possible. Stops
/// at `enough`.
fn ruled_out(tori: &[Torus], w: &Vec3, enough: f64) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for a in tori {
        for b in tori {
            let image = Circle { center: b.circle.center + w, ..b.circle };
            let apart = a.minor_radius + b.minor_radius;
            let between = (image.center - a.circle.center).norm();
            // Too far to overlap or link.
            if between > a.circle.radius + image.radius + apart {
                continue;
            }
            let minima = circle_distance_minima(&a.circle, &image);
            let distance = minima.closest().distance;
            let linked = linking_number(&a.circle, &image) != 0;
            most = most.max(if linked { distance + apart } else { apart - distance });
            if most >= enough {
                return most;
            }
        }
    }
    most
}
