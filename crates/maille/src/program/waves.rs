//! Motions that repeat over the sheet as a wave: in the cell s each element moves by Re(u e^{i q·s}), with one complex u for
//! every element and a wave vector q, the phases from a cell to the next along a1 and a2 (Bloch's theorem).
//!
//! The periodic motions of a larger cell are sums of such waves, those of the q that fit into it. The Lagrangian of a
//! limit is a sum over cells, so its second derivative is a block for each q, and a limit of the small cell, repeated, is one of the
//! larger cell to second order if and only if no block has a negative curvature on the waves that keep the loaded contacts. The
//! lattice takes no part where q ≠ 0.
//!
//! Unknowns of a block, as real numbers: Re u of all elements, then Im u; of each element a translation and turns.

use super::{Posed, SheetProgram, key::pair_key};
use crate::{
    solver::{
        certificate::{BAND, loaded_hessian},
        constraints::{Derivatives, Loads, Multiplier, Row},
        reduced_hessian::least_mode,
    },
    topology::{RingPair, step_bound::Motion},
};
use maille_geometry::Vec3;

/// Where the unknowns of a wave stand.
pub(super) struct WaveUnknowns {
    /// First unknown of each element in Re u, and the number of all.
    starts: Vec<usize>,
}

impl WaveUnknowns {
    pub fn new(turns: &[Vec<Vec3>]) -> Self {
        let mut starts = vec![0];
        turns.iter().for_each(|axes| starts.push(starts[starts.len() - 1] + 3 + axes.len()));
        WaveUnknowns { starts }
    }

    /// First unknown of an element; `part` is 0 for Re u, 1 for Im u.
    pub fn first(&self, element: usize, part: usize) -> usize {
        self.starts[element] + part * self.half()
    }

    fn half(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }
}

/// The wave of least curvature with one q.
pub struct WaveMode {
    /// Phases from a cell to the next along a1 and a2.
    pub phases_rad: [f64; 2],
    /// Curvature of the Lagrangian for a unit u.
    pub curvature: f64,
    /// Re and Im of each element's translation and turn.
    elements: Vec<[(Vec3, Vec3); 2]>,
}

impl WaveMode {
    /// The wave as motions of the copies of `cosets`, the elements of each one after the other; the largest component is `size`.
    pub fn motion(&self, cosets: &[[i32; 2]], size: f64) -> Motion {
        let components = self.elements.iter().flatten().flat_map(|(shift, turn)| [shift.amax(), turn.amax()]);
        let scale = size / components.fold(f64::MIN_POSITIVE, f64::max);
        let elements = cosets.iter().flat_map(|s| {
            let phase = self.phases_rad[0] * f64::from(s[0]) + self.phases_rad[1] * f64::from(s[1]);
            let (sin, cos) = phase.sin_cos();
            let part = move |re: Vec3, im: Vec3| (re * cos - im * sin) * scale;
            self.elements.iter().map(move |[re, im]| (part(re.0, im.0), part(re.1, im.1)))
        });
        Motion { elements: elements.collect(), lattice: [Vec3::zeros(); 2], carried: false }
    }
}

impl SheetProgram<'_> {
    /// The wave with these phases of least curvature on those that keep the loaded contacts; `None` where all are zero modes.
    pub fn least_wave(&self, x: &Posed, multipliers: &[Multiplier], phases_rad: [f64; 2]) -> Option<WaveMode> {
        let turns = self.all_turns(&x.state);
        let layout = WaveUnknowns::new(&turns);
        let n = 2 * layout.half();
        let loads = Loads::new(multipliers);
        let maps = |pair: &RingPair| {
            let phase = phases_rad[0] * f64::from(pair.shift[0]) + phases_rad[1] * f64::from(pair.shift[1]);
            [false, true].map(|imaginary| self.wave_map(pair, &turns, phase, imaginary)).into()
        };
        let mut rows: Vec<Row> = Vec::new();
        for near in self.near(x).iter().filter(|near| loads.carries(pair_key(&near.pair))) {
            for map in maps(&near.pair) {
                self.pair_rows(x, near, BAND, &map, Derivatives::Second(&loads), &mut rows);
            }
        }
        let hidden = self.curvature_of_flat_pairs(x, multipliers, n, &maps);
        let (hessian, loaded) = loaded_hessian(n, &rows, &loads, &hidden);
        let (curvature, mode) = least_mode(&hessian, &loaded)?;
        let of = |element: usize, part: usize| {
            let at = layout.first(element, part);
            let turn = turns[element].iter().enumerate().map(|(k, axis)| axis * mode[at + 3 + k]).sum();
            (Vec3::new(mode[at], mode[at + 1], mode[at + 2]), turn)
        };
        let elements = (0..turns.len()).map(|e| [of(e, 0), of(e, 1)]).collect();
        Some(WaveMode { phases_rad, curvature, elements })
    }
}
