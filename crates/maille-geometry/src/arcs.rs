//! Arcs of the circle, and what of the count ([`crate::count`]) does not depend on the pair.

use crate::grid::Direction;
use std::{f64::consts::TAU, sync::LazyLock};

/// Arcs around the circle.
pub(crate) const ARCS: usize = 8;
/// Times an arc can be halved, and one.
pub(crate) const LEVELS: usize = 5;

/// An arc halved so many times.
pub(crate) struct Level {
    /// tan of a quarter of its width.
    pub edge: f64,
    /// Half of its width.
    pub half: Direction,
    /// The turn whose half has the tangent `edge / 2`.
    pub part: Direction,
}

/// What does not depend on the pair.
pub(crate) struct Arcs {
    /// Ends of the arcs, the first again at the end.
    pub ends: [Direction; ARCS + 1],
    /// Centres of the arcs.
    pub centers: [Direction; ARCS],
    /// Of the arcs, of their halves, and so on.
    pub levels: [Level; LEVELS],
    /// cos and sin of k times the angle of the first centre, k = 1 … 4.
    pub turn: [Direction; 4],
    /// Bernstein coefficients of 1, divided out of those of the basis.
    pub weights: [f64; 9],
    pub basis: Basis,
    /// The arcs side by side, from the centre of the first.
    pub whole: Fan,
    /// The parts of an arc side by side, from its centre.
    pub parts: Fan,
}

/// Bernstein coefficients around the centre of an arc, divided by those of 1.
pub(crate) struct Basis {
    /// Coefficients 0 … 4 of cos kθ, k = 1 … 4 (the others by symmetry).
    pub cosines: [[f64; 4]; 5],
    /// Coefficients 0 … 3 of sin kθ; number 4 is 0, the others by antisymmetry.
    pub sines: [[f64; 4]; 4],
}

impl Basis {
    fn new(edge: f64) -> Self {
        let weights = bernstein(&modes(0, edge)[0]);
        let part = |k: usize, sine: usize, i: usize| bernstein(&modes(k, edge)[sine])[i] / weights[i];
        Self {
            cosines: std::array::from_fn(|i| std::array::from_fn(|k| part(k + 1, 0, i))),
            sines: std::array::from_fn(|i| std::array::from_fn(|k| part(k + 1, 1, i))),
        }
    }
}

/// As many arcs side by side, one in each lane, with the turns from an origin to them.
pub(crate) struct Fan {
    /// cos and sin of k times the turn to the centre, k = 1 … 4.
    pub turns: [[[f64; ARCS]; 2]; 4],
    /// The turns to the first end, and to the other.
    pub ends: [[[f64; ARCS]; 2]; 2],
    /// What the arcs are halvings of.
    pub level: usize,
    pub basis: Basis,
}

impl Fan {
    /// From the centre of arc `origin`, a whole number or not.
    fn new(width: f64, origin: f64, level: usize) -> Self {
        let turns = |k: f64, shift: f64| {
            let at = |i: usize| Direction::at(k * (i as f64 - origin + shift) * width);
            [std::array::from_fn(|i| at(i).cos), std::array::from_fn(|i| at(i).sin)]
        };
        Self {
            turns: std::array::from_fn(|k| turns(k as f64 + 1.0, 0.0)),
            ends: [turns(1.0, -0.5), turns(1.0, 0.5)],
            level,
            basis: Basis::new((width / 4.0).tan()),
        }
    }
}

/// The first arc begins at an angle that no symmetric design singles out.
const START_RAD: f64 = crate::grid::START_RAD;

pub(crate) static TABLE: LazyLock<Arcs> = LazyLock::new(|| {
    let width = TAU / ARCS as f64;
    let at = |i: f64| Direction::at(START_RAD + (i % ARCS as f64) * width);
    let edge = (width / 4.0).tan();
    let weights = bernstein(&modes(0, edge)[0]);
    Arcs {
        ends: std::array::from_fn(|i| at(i as f64)),
        centers: std::array::from_fn(|i| at(i as f64 + 0.5)),
        levels: std::array::from_fn(|level| {
            let width = width / f64::from(1u8 << level);
            let edge = (width / 4.0).tan();
            Level { edge, half: Direction::at(width / 2.0), part: Direction::at(0.0).ahead(0.5 * edge) }
        }),
        turn: std::array::from_fn(|k| Direction::at((k as f64 + 1.0) * (START_RAD + 0.5 * width))),
        weights,
        basis: Basis::new(edge),
        whole: Fan::new(width, 0.0, 0),
        parts: Fan::new(width / ARCS as f64, (ARCS as f64 - 1.0) / 2.0, ARCS.ilog2() as usize),
    }
});

/// Powers of t/T in `(1 + t²)⁴ cos kθ` and `(1 + t²)⁴ sin kθ`, θ = 2 atan t: real and imaginary part of
/// `(1 + i t)^2k (1 + t²)^(4 − k)`.
fn modes(k: usize, edge: f64) -> [[f64; 9]; 2] {
    let mut value = [[0.0; 9], [0.0; 9]];
    value[0][0] = 1.0;
    for factor in 0..4 {
        let [re, im] = value;
        // times (1 + t²), or (1 + i t)² = 1 − t² + 2 i t.
        let sign = if factor < k { -1.0 } else { 1.0 };
        let double = if factor < k { 2.0 } else { 0.0 };
        for j in 0..9 {
            let before = |v: &[f64; 9], by: usize| if j >= by { v[j - by] } else { 0.0 };
            value[0][j] = re[j] + sign * before(&re, 2) - double * before(&im, 1);
            value[1][j] = im[j] + sign * before(&im, 2) + double * before(&re, 1);
        }
    }
    value.map(|powers| std::array::from_fn(|j| powers[j] * edge.powi(j as i32)))
}

/// Bernstein coefficients on [−1, 1] of a polynomial given by its powers.
fn bernstein(powers: &[f64; 9]) -> [f64; 9] {
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
    // t = u − v and 1 = u + v for u + v = 1: t^j = (u − v)^j (u + v)^(8 − j).
    std::array::from_fn(|i| {
        let of = |j: usize| -> f64 {
            let terms = (0..=j.min(i)).filter(|m| i - m <= 8 - j);
            terms.map(|m| (-1f64).powi((j - m) as i32) * choose(j, m) * choose(8 - j, i - m)).sum()
        };
        (0..9).map(|j| powers[j] * of(j)).sum::<f64>() / choose(8, i)
    })
}
