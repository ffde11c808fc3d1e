//! The thesis's side signs (§4.3.3): on which side of the other rings of its element a neighbour passes through a ring.
//!
//! A rule of the thesis for circles, for comparison. It is no invariant: a sign can flip while nothing is crossed. What keeps the
//! topology is the step bound ([`super::step_bound`]).

use super::links;
use crate::{lattice::Shift, model::Model, state::State, topology::RingPair};
use maille_geometry::{Circle, Vec3};

/// A plane counts where the neighbour passes at least this far from it at the start, in the ring's major radii.
const CLEAR: f64 = 0.05;

/// The neighbour's ring `neighbour`, in the cell `shift`, passes through the ring `through`; `plane` is another ring of
/// the same element, which it does not link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Ring that is passed through.
    pub through: usize,
    /// The neighbour's ring.
    pub neighbour: usize,
    /// The neighbour's cell.
    pub shift: Shift,
    /// Ring whose plane has the sides.
    pub plane: usize,
    /// Whether the neighbour passes on the side of the plane's normal.
    pub positive: bool,
}

/// All side signs of a starting state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideSigns {
    /// The signs.
    pub sides: Vec<Side>,
}

/// Where circle B passes through the disc of A, if at just one of its two crossings of the plane.
fn passage(a: &Circle, b: &Circle) -> Option<Vec3> {
    let rise = *a.normal - *b.normal * a.normal.dot(&b.normal);
    let m = rise.try_normalize(1e-12)?;
    let along = -a.normal.dot(&(b.center - a.center)) / (b.radius * rise.norm());
    if along.abs() >= 1.0 {
        return None;
    }
    let across = b.normal.cross(&m) * (1.0 - along * along).sqrt();
    let points = [1.0, -1.0].map(|side| b.center + (m * along + across * side) * b.radius);
    match points.map(|p| (p - a.center).norm() < a.radius) {
        [true, false] => Some(points[0]),
        [false, true] => Some(points[1]),
        _ => None,
    }
}

/// (p − c)·n for the plane of ring `plane`, p where the neighbour passes.
fn height(model: &Model, state: &State, side: &Side) -> Option<f64> {
    let through = state.circle(model, side.through, [0, 0]);
    let point = passage(&through, &state.circle(model, side.neighbour, side.shift))?;
    let plane = state.circle(model, side.plane, [0, 0]);
    Some(plane.normal.dot(&(point - plane.center)))
}

impl SideSigns {
    /// Of the starting state of `model`.
    pub fn new(model: &Model) -> Self {
        let mut sides = Vec::new();
        for link in &model.links {
            for RingPair { ring_a: through, ring_b: neighbour, shift } in link.pair.both_ways() {
                for plane in model.elements[model.rings[through].element].rings.clone() {
                    let pair = RingPair { ring_a: plane, ring_b: neighbour, shift };
                    let round = [through, neighbour, plane].iter().all(|ring| model.rings[*ring].is_round());
                    if !round || plane == through || !links(model, &model.start, &[pair]).is_empty() {
                        continue;
                    }
                    let mut side = Side { through, neighbour, shift, plane, positive: true };
                    if let Some(height) = height(model, &model.start, &side)
                        && height.abs() > CLEAR * model.rings[plane].major_radius
                    {
                        side.positive = height > 0.0;
                        sides.push(side);
                    }
                }
            }
        }
        SideSigns { sides }
    }

    /// Whether `state` has them all.
    pub fn kept(&self, model: &Model, state: &State) -> bool {
        self.sides.iter().all(|s| height(model, state, s).is_some_and(|h| h != 0.0 && (h > 0.0) == s.positive))
    }
}
