//! Print help: which rings would fuse, and what would keep them apart.

use super::Tile;
use maille::{
    lattice::Shift,
    model::Model,
    state::State,
    topology::{self, RingPair},
};
use maille_geometry::{Vec3, circle_distance_minima};

/// Rings that are closer to each other than a printer can keep apart. Lengths in millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct TooClose {
    /// Gap of the closest pair; negative where the tori overlap.
    pub gap: f64,
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
}

/// The closest rings of the tile if they are closer than `clearance` millimetres, at `mm` millimetres a file unit.
///
/// Rings of one element are rigidly joined and may overlap; they are not looked at.
pub fn too_close(model: &Model, state: &State, tile: Tile, clearance: f64, mm: f64) -> Option<TooClose> {
    let to_mm = model.unit * mm;
    let wanted = clearance / to_mm;
    let mut close: Vec<(f64, RingPair)> = Vec::new();
    let mut factor = f64::INFINITY;
    for pair in topology::close_pairs(model, state, wanted) {
        if !tile.holds(pair.shift) {
            continue;
        }
        let distance = topology::core_distance(model, state, &pair);
        let radii = model.contact_distance(pair.ring_a, pair.ring_b);
        let gap = distance - radii;
        // A gap that lacks less than rounding is wide enough.
        if gap >= wanted - 1e-12 {
            continue;
        }
        factor = factor.min((distance - wanted) / radii);
        close.push((gap, pair));
    }
    let pairs = close.len();
    let (gap, pair) = topology::closest(close)?;
    // The first cells of the tile that hold both.
    let cell_a = pair.shift.map(|k| (-k).max(0));
    let cell_b = [0, 1].map(|k| cell_a[k] + pair.shift[k]);
    let a = state.circle(model, pair.ring_a, cell_a);
    let b = state.circle(model, pair.ring_b, cell_b);
    let minimum = *circle_distance_minima(&a, &b).closest();
    Some(TooClose {
        gap: gap * to_mm,
        pair,
        cells: [cell_a, cell_b],
        rings: [model.ring_label(pair.ring_a, cell_a), model.ring_label(pair.ring_b, cell_b)],
        place: (minimum.point_a + minimum.point_b) * (0.5 * to_mm),
        pairs,
        minor_radius_factor: (factor > 1e-6).then_some(factor),
        scale_factor: (gap > 1e-9).then_some(wanted / gap),
    })
}
