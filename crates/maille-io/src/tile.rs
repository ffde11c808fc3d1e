//! Cells along the two lattice vectors.

use maille::{
    lattice::Shift,
    model::{Core, Model},
    state::State,
};
use maille_geometry::Vec3;
use std::{fmt, str::FromStr};

/// Cells along a1 and a2 that are shown, exported or simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile(pub [u32; 2]);

impl FromStr for Tile {
    type Err = String;

    fn from_str(text: &str) -> Result<Tile, String> {
        let count = |t: &str| t.parse::<u32>().ok().filter(|n| (1..=MOST).contains(n));
        match text.split_once('x').map(|(m, n)| (count(m), count(n))) {
            Some((Some(m), Some(n))) => Ok(Tile([m, n])),
            _ => Err(format!("\"{text}\" is not a tile; give the cells along a1 and a2, as 8x8")),
        }
    }
}

impl fmt::Display for Tile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.0[0], self.0[1])
    }
}

/// Most cells along one lattice vector.
const MOST: u32 = 100_000;

impl Tile {
    /// The tile whose [`size`](Tile::size) is nearest to this one, at least one cell; of a chain always one beside the other.
    pub fn nearest(model: &Model, state: &State, size: [f64; 2]) -> Tile {
        let (first, step) = extents(model, state);
        Tile(std::array::from_fn(|k| {
            if k == 1 && model.single {
                return 1;
            }
            let more = ((size[k] - first[k]) / step[k]).round();
            more.clamp(0.0, f64::from(MOST - 1)) as u32 + 1
        }))
    }

    /// Width along a1 and height across it with the wire, in reference radii. Where a2 is not at right angles to a1, that is the
    /// width of one row of cells: each row stands beside the one below it.
    pub fn size(&self, model: &Model, state: &State) -> [f64; 2] {
        let (first, step) = extents(model, state);
        std::array::from_fn(|k| first[k] + f64::from(self.0[k] - 1) * step[k])
    }

    /// Whether the pair of a ring and a ring `shift` cells away occurs within the tile.
    pub fn holds(&self, shift: Shift) -> bool {
        (0..2).all(|k| shift[k].unsigned_abs() < self.0[k])
    }
}

/// Along a1 and across it: the extent of the tori of one cell, and the step to the next one.
fn extents(model: &Model, state: &State) -> ([f64; 2], [f64; 2]) {
    let along = state.a1.normalize();
    let across = Vec3::z().cross(&along);
    let extent = |axis: Vec3| {
        let ends = (0..model.rings.len()).map(|ring| {
            let wire = model.rings[ring].minor_radius;
            match state.core(model, ring, [0, 0]) {
                Core::Circle(circle) => {
                    let tilt = circle.normal.dot(&axis);
                    let half = circle.radius * (1.0 - tilt * tilt).max(0.0).sqrt() + wire;
                    let middle = circle.center.dot(&axis);
                    [middle - half, middle + half]
                }
                curve => {
                    let [low, high] = curve.extent(&axis);
                    [low - wire, high + wire]
                }
            }
        });
        let ends = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or_default();
        ends[1] - ends[0]
    };
    ([along, across].map(extent), [state.a1.norm(), state.a2.dot(&across).abs()])
}
