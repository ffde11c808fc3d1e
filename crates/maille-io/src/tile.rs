//! Cells along the two lattice vectors.

use maille::lattice::Shift;
use std::{fmt, str::FromStr};

/// Cells along a1 and a2 that are shown, exported or simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile(pub [u32; 2]);

impl FromStr for Tile {
    type Err = String;

    fn from_str(text: &str) -> Result<Tile, String> {
        let count = |t: &str| t.parse::<u32>().ok().filter(|n| (1..=100_000).contains(n));
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

impl Tile {
    /// Whether the pair of a ring and a ring `shift` cells away occurs within the tile.
    pub fn holds(&self, shift: Shift) -> bool {
        (0..2).all(|k| shift[k].unsigned_abs() < self.0[k])
    }
}
