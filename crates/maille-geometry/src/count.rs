//! How many critical points the distance has on an arc: the proof behind the quick kernel that none is missed.
//!
//! With p = w·w′ and q = R e·e′ ([`crate::relative`]) the slope is h′ = p − q/ρ, so its sign is that of
//!
//! `G₋ = pρ − q`; and `H = G₋ G₊ = p²ρ² − q²`, `G₊ = pρ + q` (whose roots are critical points of the distance to the far
//! side of the base), is a trigonometric polynomial of degree 4, the polynomial of Appendix A before it is squared once
//! more. On an arc of half width 2 atan T around m, with t = tan((θ − m)/2), `H (1 + t²)⁴` is a polynomial of degree 8.
//! By Descartes' rule of signs its Bernstein coefficients on `[−T, T]` change sign at least as often as it has roots in
//! there, counted with multiplicity. On the other hand a change of sign of G₋ between the ends is a root, and so is one
//! of G₊. Where the two numbers agree, every root is known: G₋ has one where it changes sign, else none. Since no arc
//! can have fewer changes of its coefficients than of G₋ and G₊, it is enough to compare the sums over all arcs.
//!
//! A coefficient so small that rounding could change its sign counts as changing it on both sides, so that a doubt leads
//! to more changes, and the numbers do not agree.
//!
//! G₊ is smooth where ρ > 0 and changes sign at least twice (the distance to the far side has a maximum and a
//! minimum), H has at most eight roots: so G₋ has at most six, and the distance at most three minima.

use crate::grid::Direction;
use crate::lane::Lane;
use crate::relative::Reduced;
use std::{
    f64::consts::{FRAC_1_SQRT_2, TAU},
    sync::LazyLock,
};

/// Arcs around the circle.
pub(crate) const ARCS: usize = 8;
/// A coefficient is certain from this on, relative to the largest that H's terms could make.
const CERTAIN: f64 = 1e-14;

/// What does not depend on the pair.
pub(crate) struct Arcs {
    /// Ends of the arcs, the first again at the end.
    pub ends: [Direction; ARCS + 1],
    /// Centres of the arcs.
    pub centers: [Direction; ARCS],
    /// T: tan of a quarter of the width.
    pub edge: f64,
    /// tan of an eighth of the width.
    pub half_edge: f64,
    /// A quarter of the width.
    pub half_turn: Direction,
    /// cos and sin of the turns from the first arc to each.
    pub eighths: [[f64; 2]; ARCS],
    /// cos and sin of k times the angle of the first centre, k = 1 … 4.
    turn: [Direction; 4],
    /// Bernstein coefficients of 1, divided out of the next two.
    pub weights: [f64; 9],
    /// Coefficients 0 … 4 of cos kθ, k = 1 … 4 (the others by symmetry), around the centre of an arc.
    cosines: [[f64; 4]; 5],
    /// Coefficients 0 … 3 of sin kθ; number 4 is 0, the others by antisymmetry.
    sines: [[f64; 4]; 4],
}

/// The first arc begins at an angle that no symmetric design singles out.
const START_RAD: f64 = crate::grid::START_RAD;

pub(crate) static TABLE: LazyLock<Arcs> = LazyLock::new(|| {
    let width = TAU / ARCS as f64;
    let at = |i: f64| Direction::at(START_RAD + (i % ARCS as f64) * width);
    let edge = (width / 4.0).tan();
    let weights = bernstein(&modes(0, edge)[0]);
    let part = |k: usize, sine: usize, i: usize| bernstein(&modes(k, edge)[sine])[i] / weights[i];
    Arcs {
        ends: std::array::from_fn(|i| at(i as f64)),
        centers: std::array::from_fn(|i| at(i as f64 + 0.5)),
        edge,
        half_edge: (width / 8.0).tan(),
        half_turn: Direction::at(width / 4.0),
        eighths: std::array::from_fn(|k| {
            let Direction { cos, sin } = Direction::at(k as f64 * width);
            [cos, sin]
        }),
        turn: std::array::from_fn(|k| Direction::at((k as f64 + 1.0) * (START_RAD + 0.5 * width))),
        weights,
        cosines: std::array::from_fn(|i| std::array::from_fn(|k| part(k + 1, 0, i))),
        sines: std::array::from_fn(|i| std::array::from_fn(|k| part(k + 1, 1, i))),
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

/// A harmonic's cosine and sine part an eighth of a turn further.
#[inline(always)]
fn eighth<T: Lane>(cosine: T, sine: T) -> [T; 2] {
    [(cosine + sine) * FRAC_1_SQRT_2, (sine - cosine) * FRAC_1_SQRT_2]
}

/// H around the centre of the first arc: `mean + Σ (cosine_k cos kθ + sine_k sin kθ)`, k = 1 … 4.
pub(crate) struct Harmonics<T> {
    mean: T,
    cosine: [T; 4],
    sine: [T; 4],
    /// A bound of what the terms of H could add up to.
    size: T,
}

impl<T: Lane> Harmonics<T> {
    #[inline(always)]
    pub fn new(pair: &Reduced<T>, table: &Arcs) -> Self {
        let (r, s) = (pair.radius, pair.tilt_sin);
        let [pc, ps] = pair.p;
        let [qc, qs, q2] = pair.q;
        let [x0, y0] = [pair.x0, pair.y0];
        // ρ² = a0 + a1·(cos, sin) + a2 cos 2θ
        let rise_sq = r * r * s * s;
        let a0 = x0 * x0 + y0 * y0 + r * r - rise_sq * 0.5;
        let a1 = [r * pair.tilt_cos * x0 * 2.0, r * y0 * 2.0];
        let a2 = rise_sq * -0.5;
        // p² = b0 + b2·(cos 2θ, sin 2θ)
        let b0 = (pc * pc + ps * ps) * 0.5;
        let b2 = [(pc * pc - ps * ps) * 0.5, pc * ps];
        // q = qc cos θ + qs sin θ + q2 sin 2θ
        let mean = b0 * a0 + b2[0] * a2 * 0.5 - (qc * qc + qs * qs + q2 * q2) * 0.5;
        let half = [b2[0] * 0.5, b2[1] * 0.5];
        let modes = [
            [
                b0 * a1[0] + half[0] * a1[0] + half[1] * a1[1] - q2 * qs,
                b0 * a1[1] + half[1] * a1[0] - half[0] * a1[1] - q2 * qc,
            ],
            [b0 * a2 + b2[0] * a0 - (qc * qc - qs * qs) * 0.5, b2[1] * a0 - qc * qs],
            [half[0] * a1[0] - half[1] * a1[1] + q2 * qs, half[1] * a1[0] + half[0] * a1[1] - q2 * qc],
            [half[0] * a2 + q2 * q2 * 0.5, half[1] * a2],
        ];
        let (mut cosine, mut sine) = ([mean; 4], [mean; 4]);
        for k in 0..4 {
            let ([c, s], by) = (modes[k], table.turn[k]);
            cosine[k] = c * by.cos + s * by.sin;
            sine[k] = s * by.cos - c * by.sin;
        }
        let slope = qc.abs() + qs.abs() + q2.abs();
        let size = b0 * 2.0 * (a0 + a1[0].abs() + a1[1].abs() - a2) + slope * slope;
        Self { mean, cosine, sine, size }
    }

    /// Turned to the centres of the first four arcs.
    ///
    /// From an arc to the next the harmonics turn by 45°, 90°, 135° and 180°.
    #[inline(always)]
    pub fn turned(&self) -> Turned<T> {
        let ([c1, c2, c3, c4], [s1, s2, s3, s4]) = (self.cosine, self.sine);
        let (t1, t3) = (eighth(c1, s1), eighth(c3, s3));
        Turned {
            mean: self.mean,
            modes: [
                [[c1, s1], t1, [s1, -c1], [t1[1], -t1[0]]],
                [[c2, s2], [s2, -c2], [-c2, -s2], [-s2, c2]],
                [[c3, s3], [t3[1], -t3[0]], [-s3, c3], t3],
                [[c4, s4], [-c4, -s4], [c4, s4], [-c4, -s4]],
            ],
        }
    }

    /// The coefficients of the arc that is turned by an angle from the first one, divided by [`Arcs::weights`], with the
    /// values of H at its ends.
    #[inline(always)]
    pub fn around(&self, turn: [T; 2], ends: [T; 2], table: &Arcs) -> [T; 9] {
        let [cos, sin] = turn;
        let mut by = turn;
        let mut modes = [[self.mean; 2]; 4];
        for k in 0..4 {
            modes[k] = [self.cosine[k] * by[0] + self.sine[k] * by[1], self.sine[k] * by[0] - self.cosine[k] * by[1]];
            by = [by[0] * cos - by[1] * sin, by[1] * cos + by[0] * sin];
        }
        let mut out = [ends[0]; 9];
        out[8] = ends[1];
        for i in 1..5 {
            let a = &table.cosines[i];
            let even =
                self.mean + (modes[0][0] * a[0] + modes[1][0] * a[1] + (modes[2][0] * a[2] + modes[3][0] * a[3]));
            if i == 4 {
                out[4] = even;
                continue;
            }
            let b = &table.sines[i];
            let odd = modes[0][1] * b[0] + modes[1][1] * b[1] + (modes[2][1] * b[2] + modes[3][1] * b[3]);
            (out[i], out[8 - i]) = (even + odd, even - odd);
        }
        out
    }

    /// A coefficient is certain if it is larger than this.
    #[inline(always)]
    pub fn certain(&self) -> T {
        self.size * CERTAIN
    }

    /// The products of neighbouring coefficients below which they count as a change of sign.
    #[inline(always)]
    pub fn doubt(&self) -> T {
        self.size * self.size * CERTAIN
    }
}

/// H around the centres of the first four arcs: cosine and sine part by harmonic and arc.
pub(crate) struct Turned<T> {
    mean: T,
    modes: [[[T; 2]; ARCS / 2]; 4],
}

impl<T: Lane> Turned<T> {
    /// The coefficients of an arc `m < ARCS / 2` and of the opposite one, divided by [`Arcs::weights`]. The two differ in
    /// the sign of the odd harmonics. The first and the last are the values of H at the ends, given by arc.
    #[inline(always)]
    pub fn coefficients(&self, m: usize, ends: &[T; ARCS], table: &Arcs) -> [[T; 9]; 2] {
        let [first, second, third, fourth] = [self.modes[0][m], self.modes[1][m], self.modes[2][m], self.modes[3][m]];
        let mut out = [[self.mean; 9]; 2];
        (out[0][0], out[0][8]) = (ends[m], ends[m + 1]);
        (out[1][0], out[1][8]) = (ends[m + ARCS / 2], ends[(m + ARCS / 2 + 1) % ARCS]);
        for i in 1..5 {
            let a = &table.cosines[i];
            let even = self.mean + second[0] * a[1] + fourth[0] * a[3];
            let odd = first[0] * a[0] + third[0] * a[2];
            if i == 4 {
                (out[0][4], out[1][4]) = (even + odd, even - odd);
                continue;
            }
            let b = &table.sines[i];
            let even_sine = second[1] * b[1] + fourth[1] * b[3];
            let odd_sine = first[1] * b[0] + third[1] * b[2];
            let (left, right) = (even + even_sine, even - even_sine);
            let (odd_left, odd_right) = (odd + odd_sine, odd - odd_sine);
            (out[0][i], out[0][8 - i]) = (left + odd_left, right + odd_right);
            (out[1][i], out[1][8 - i]) = (left - odd_left, right - odd_right);
        }
        out
    }
}

/// Changes of sign in the coefficients of an arc, doubtful ones counted as changes.
#[inline(always)]
pub(crate) fn changes<T: Lane>(coefficients: &[T; 9], doubt: T) -> T {
    let (zero, one) = (doubt.like(0.0), doubt.like(1.0));
    let mut sums = [zero; 2];
    for i in 0..8 {
        let product = coefficients[i] * coefficients[i + 1];
        sums[i % 2] = sums[i % 2] + T::pick(product.below(doubt), one, zero);
    }
    sums[0] + sums[1]
}

/// The coefficients of the two halves of an arc (de Casteljau).
#[inline(always)]
pub(crate) fn halves<T: Lane>(coefficients: &[T; 9]) -> [[T; 9]; 2] {
    let (mut row, mut left) = (*coefficients, *coefficients);
    for k in 1..9 {
        // In place, of constant length: what lies behind 8 − k is the right half.
        for i in 0..9 - k {
            row[i] = (row[i] + row[i + 1]) * 0.5;
        }
        left[k] = row[0];
    }
    [left, row]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Circle, Vec3, relative::Relative};
    use rand::{RngExt, SeedableRng};

    /// The coefficients of each arc, and of halves of it, are those of H: summed up they give its values.
    #[test]
    fn coefficients_are_those_of_the_product() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        for _ in 0..200 {
            let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
            let unit = nalgebra::UnitVector3::new_normalize;
            let a = Circle::new(Vec3::zeros(), unit(vector(1.0)), 1.0);
            let b = Circle::new(vector(2.0), unit(vector(1.0)), rng.random_range(0.1..1.0));
            let pair = Relative::new(&a, &b).reduced();
            let harmonics = Harmonics::new(&pair, &TABLE);
            let turned = harmonics.turned();
            let ends: [f64; ARCS] = std::array::from_fn(|k| {
                let [minus, plus] = pair.factors(TABLE.ends[k].cos, TABLE.ends[k].sin);
                minus * plus
            });
            for (k, center) in TABLE.centers.into_iter().enumerate() {
                let arc = turned.coefficients(k % 4, &ends, &TABLE)[k / 4];
                let whole: [f64; 9] = std::array::from_fn(|i| arc[i] * TABLE.weights[i]);
                let [left, right] = halves(&whole);
                for (b, from, to) in [(whole, -1.0, 1.0), (left, -1.0, 0.0), (right, 0.0, 1.0)] {
                    for u in [0.0, 0.1, 0.37, 0.8, 1.0] {
                        let choose = |k: usize| (0..k).fold(1.0, |c, i| c * (8 - i) as f64 / (i + 1) as f64);
                        let term =
                            |k: usize| b[k] * choose(k) * f64::powi(u, k as i32) * f64::powi(1.0 - u, 8 - k as i32);
                        let value: f64 = (0..9).map(term).sum();
                        let t = TABLE.edge * (from + (to - from) * u);
                        let at = center.ahead(t);
                        let [minus, plus] = pair.factors(at.cos, at.sin);
                        let expected = minus * plus * (1.0 + t * t).powi(4);
                        assert!((value - expected).abs() < 1e-14 * harmonics.size, "{value} {expected}");
                        assert!(expected.abs() <= harmonics.size * (1.0 + t * t).powi(4));
                    }
                }
            }
        }
    }
}
