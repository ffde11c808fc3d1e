//! Constants of the arcs into which the circle of θ is divided. They do not depend on the pair.
//!
//! On an arc of half width `2 atan T` around its centre, `t = tan((θ − centre)/2)` runs over `[−T, T]`. Multiplied by
//! `(1 + t²)⁴`, a trigonometric polynomial of degree 4 becomes a polynomial of degree 8 in `t`, with nine Bernstein
//! coefficients on `[−T, T]`. The tables hold those of the basis functions `cos kθ` and `sin kθ`.

use crate::circle_circle::angle::{Direction, START_RAD};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Number of arcs of equal width.
pub(crate) const ARCS: usize = 8;
/// Number of arc widths in the tables: a full arc, and arcs bisected one to four times.
pub(crate) const LEVELS: usize = 5;

/// Constants of arcs of one width.
pub(crate) struct ArcLevel {
    /// `T`, the tangent of a quarter of the width.
    pub quarter_tan: f64,
    /// Half of the width.
    pub half_width: Direction,
    /// The rotation by δ with `tan(δ/2) = T/2`, to the third sample of the initial guess.
    pub seed_turn: Direction,
}

/// All constants of the fast method.
pub(crate) struct ArcTables {
    /// Ends of the arcs; the last equals the first.
    pub ends: [Direction; ARCS + 1],
    /// Centres of the arcs.
    pub centers: [Direction; ARCS],
    /// Widths: of the arcs, of their halves, and so on.
    pub levels: [ArcLevel; LEVELS],
    /// `k` times the angle of the first centre, `k = 1 … 4`.
    pub center_turns: [Direction; 4],
    /// Bernstein coefficients of the constant 1, i.e. of `(1 + t²)⁴`. Those of the basis are divided by them.
    pub bernstein_weights: [f64; 9],
    /// Basis on a full arc.
    pub basis: BernsteinBasis,
    /// The eight arcs, relative to the centre of the first.
    pub all_arcs: ArcFan,
    /// The eight parts of one arc, relative to its centre.
    pub sub_arcs: ArcFan,
}

/// Bernstein coefficients of `cos kθ` and `sin kθ` on an arc centred at `θ = 0`, divided by those of 1.
pub(crate) struct BernsteinBasis {
    /// Coefficients 0 … 4 of `cos kθ`, `k = 1 … 4`; the others follow by symmetry.
    pub cosines: [[f64; 4]; 5],
    /// Coefficients 0 … 3 of `sin kθ`; number 4 is 0, the others follow by antisymmetry.
    pub sines: [[f64; 4]; 4],
}

impl BernsteinBasis {
    /// For arcs with this tangent of a quarter of the width.
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

/// Eight arcs side by side, to be loaded into lanes, given by rotations from an origin.
pub(crate) struct ArcFan {
    /// Cosine and sine of `k` times the rotation to each centre, `k = 1 … 4`.
    pub turns: [[[f64; ARCS]; 2]; 4],
    /// Cosine and sine of the rotations to the first and to the second end.
    pub ends: [[[f64; ARCS]; 2]; 2],
    /// How often a full arc must be bisected to give these arcs; index into [`ArcTables::levels`].
    pub level: usize,
    /// Basis on one of the arcs.
    pub basis: BernsteinBasis,
}

impl ArcFan {
    /// Arcs of a width, relative to the centre of arc number `origin` (which may lie between two arcs).
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

/// The tables, computed at the first use.
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

/// Coefficients of `(1 + t²)⁴ cos kθ` and `(1 + t²)⁴ sin kθ` in powers of `t/T`, `θ = 2 atan t`.
///
/// They are the real and the imaginary part of `(1 + i t)^2k (1 + t²)^(4 − k)`.
fn modes(k: usize, quarter_tan: f64) -> [[f64; 9]; 2] {
    let mut value = [[0.0; 9], [0.0; 9]];
    value[0][0] = 1.0;
    for factor in 0..4 {
        let [re, im] = value;
        // Multiply by (1 + i t)² = 1 − t² + 2 i t, k times, then by (1 + t²).
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

/// Bernstein coefficients on `[−1, 1]` of a polynomial given by its power coefficients.
fn bernstein_coefficients(powers: &[f64; 9]) -> [f64; 9] {
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
    // With t = u − v and u + v = 1: t^j = (u − v)^j (u + v)^(8 − j).
    std::array::from_fn(|i| {
        let of = |j: usize| -> f64 {
            let terms = (0..=j.min(i)).filter(|m| i - m <= 8 - j);
            terms.map(|m| (-1f64).powi((j - m) as i32) * choose(j, m) * choose(8 - j, i - m)).sum()
        };
        (0..9).map(|j| powers[j] * of(j)).sum::<f64>() / choose(8, i)
    })
}
