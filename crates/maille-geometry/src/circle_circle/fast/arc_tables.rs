//! ArcTables of the circle, and what of the count ([`crate::count`]) does not depend on the pair.

use crate::circle_circle::angle::{Direction, START_RAD};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// ArcTables around the circle.
pub(crate) const ARCS: usize = 8;
/// Times an arc can be halved, and one.
pub(crate) const LEVELS: usize = 5;

/// An arc halved so many times.
pub(crate) struct ArcLevel {
    /// tan of a quarter of its width.
    pub quarter_tan: f64,
    /// Half of its width.
    pub half_width: Direction,
    /// The turn whose half has the tangent `quarter_tan / 2`.
    pub seed_turn: Direction,
}

/// What does not depend on the pair.
pub(crate) struct ArcTables {
    /// Ends of the arcs, the first again at the end.
    pub ends: [Direction; ARCS + 1],
    /// Centres of the arcs.
    pub centers: [Direction; ARCS],
    /// Of the arcs, of their halves, and so on.
    pub levels: [ArcLevel; LEVELS],
    /// cos and sin of k times the angle of the first centre, k = 1 … 4.
    pub center_turns: [Direction; 4],
    /// Bernstein coefficients of 1, divided out of those of the basis.
    pub bernstein_weights: [f64; 9],
    pub basis: BernsteinBasis,
    /// The arcs side by side, from the centre of the first.
    pub all_arcs: ArcFan,
    /// The parts of an arc side by side, from its centre.
    pub sub_arcs: ArcFan,
}

/// Bernstein coefficients around the centre of an arc, divided by those of 1.
pub(crate) struct BernsteinBasis {
    /// Coefficients 0 … 4 of cos kθ, k = 1 … 4 (the others by symmetry).
    pub cosines: [[f64; 4]; 5],
    /// Coefficients 0 … 3 of sin kθ; number 4 is 0, the others by antisymmetry.
    pub sines: [[f64; 4]; 4],
}

impl BernsteinBasis {
    fn new(quarter_tan: f64) -> Self {
        let bernstein_weights = bernstein_coefficients(&modes(0, quarter_tan)[0]);
        let part = |k: usize, sine: usize, i: usize| {
            bernstein_coefficients(&modes(k, quarter_tan)[sine])[i] / bernstein_weights[i]
        };
        Self {
            cosines: std::array::from_fn(|i| std::array::from_fn(|k| part(k + 1, 0, i))),
            sines: std::array::from_fn(|i| std::array::from_fn(|k| part(k + 1, 1, i))),
        }
    }
}

/// As many arcs side by side, one in each lane, with the turns from an origin to them.
pub(crate) struct ArcFan {
    /// cos and sin of k times the turn to the centre, k = 1 … 4.
    pub turns: [[[f64; ARCS]; 2]; 4],
    /// The turns to the first end, and to the other.
    pub ends: [[[f64; ARCS]; 2]; 2],
    /// What the arcs are halvings of.
    pub level: usize,
    pub basis: BernsteinBasis,
}

impl ArcFan {
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
            basis: BernsteinBasis::new((width / 4.0).tan()),
        }
    }
}

pub(crate) static ARC_TABLES: LazyLock<ArcTables> = LazyLock::new(|| {
    let width = TAU / ARCS as f64;
    let at = |i: f64| Direction::at(START_RAD + (i % ARCS as f64) * width);
    let quarter_tan = (width / 4.0).tan();
    let bernstein_weights = bernstein_coefficients(&modes(0, quarter_tan)[0]);
    ArcTables {
        ends: std::array::from_fn(|i| at(i as f64)),
        centers: std::array::from_fn(|i| at(i as f64 + 0.5)),
        levels: std::array::from_fn(|level| {
            let width = width / f64::from(1u8 << level);
            let quarter_tan = (width / 4.0).tan();
            ArcLevel {
                quarter_tan,
                half_width: Direction::at(width / 2.0),
                seed_turn: Direction::at(0.0).rotated_by_half_tan(0.5 * quarter_tan),
            }
        }),
        center_turns: std::array::from_fn(|k| Direction::at((k as f64 + 1.0) * (START_RAD + 0.5 * width))),
        bernstein_weights,
        basis: BernsteinBasis::new(quarter_tan),
        all_arcs: ArcFan::new(width, 0.0, 0),
        sub_arcs: ArcFan::new(width / ARCS as f64, (ARCS as f64 - 1.0) / 2.0, ARCS.ilog2() as usize),
    }
});

/// Powers of t/T in `(1 + t²)⁴ cos kθ` and `(1 + t²)⁴ sin kθ`, θ = 2 atan t: real and imaginary part of
/// `(1 + i t)^2k (1 + t²)^(4 − k)`.
fn modes(k: usize, quarter_tan: f64) -> [[f64; 9]; 2] {
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
    value.map(|powers| std::array::from_fn(|j| powers[j] * quarter_tan.powi(j as i32)))
}

/// Bernstein coefficients on [−1, 1] of a polynomial given by its powers.
fn bernstein_coefficients(powers: &[f64; 9]) -> [f64; 9] {
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
