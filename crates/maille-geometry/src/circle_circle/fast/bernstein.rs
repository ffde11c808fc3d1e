//! The trigonometric polynomial `H = p²ρ² − q²` of degree 4 and its Bernstein coefficients on an arc.
//!
//! `p`, `q` and `ρ` are those of `normalized_pair.rs`; `root_count.rs` shows what the roots of `H` mean. On an arc,
//! `H (1 + t²)⁴` is a polynomial of degree 8, `t = tan((θ − centre)/2)`; the number of sign changes in its nine
//! Bernstein coefficients bounds its number of roots there (Descartes' rule of signs). Coefficients are divided by
//! those of `(1 + t²)⁴`, which are positive, unless stated otherwise.

use crate::circle_circle::fast::arc_tables::{ARCS, ArcTables, BernsteinBasis};
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;
use std::f64::consts::FRAC_1_SQRT_2;

/// Relative to the largest possible value of H: smaller coefficients have no certain sign.
const SIGN_TOLERANCE: f64 = 1e-14;

/// The cosine and sine parts of a harmonic about an origin 45° further in its phase.
#[inline(always)]
fn rotate_by_eighth<T: SimdReal>(cosine: T, sine: T) -> [T; 2] {
    [(cosine + sine) * FRAC_1_SQRT_2, (sine - cosine) * FRAC_1_SQRT_2]
}

/// The cosine and sine parts of a harmonic about an origin further in its phase by the given angle.
#[inline(always)]
pub(crate) fn rotate_harmonic<T: SimdReal>([cosine, sine]: [T; 2], [cos, sin]: [T; 2]) -> [T; 2] {
    [cosine.mul_add(cos, sine * sin), cosine.neg_mul_add(sin, sine * cos)]
}

/// The Fourier coefficients of H about the centre of the first arc: `H = mean + Σ (cosine_k cos kφ + sine_k sin kφ)`,
/// `k = 1 … 4`, with φ measured from that centre.
pub(crate) struct Harmonics<T> {
    /// Mean value of H.
    pub mean: T,
    /// Cosine parts.
    pub cosine: [T; 4],
    /// Sine parts.
    pub sine: [T; 4],
    /// An upper bound of the sum of the absolute values of the terms of H.
    pub size: T,
}

impl<T: SimdReal> Harmonics<T> {
    /// Of a pair.
    #[inline(always)]
    pub fn new(pair: &NormalizedPair<T>, tables: &ArcTables) -> Self {
        let (r, s) = (pair.radius, pair.tilt_sin);
        let [pc, ps] = pair.p;
        let [qc, qs, q2] = pair.q;
        let [x0, y0] = [pair.x0, pair.y0];
        // ρ² = a0 + a1·(cos θ, sin θ) + a2 cos 2θ
        let rise_sq = r * r * s * s;
        let a2 = rise_sq * -0.5;
        let a0 = x0.mul_add(x0, y0.mul_add(y0, r.mul_add(r, a2)));
        let double = r + r;
        let a1 = [double * pair.tilt_cos * x0, double * y0];
        // p² = b0 + b2·(cos 2θ, sin 2θ)
        let b0 = pc.mul_add(pc, ps * ps) * 0.5;
        let b2 = [ps.neg_mul_add(ps, pc * pc) * 0.5, pc * ps];
        // q = qc cos θ + qs sin θ + q2 sin 2θ
        let (qc_sq, qs_sq, q2_sq) = (qc * qc, qs * qs, q2 * q2);
        // Harmonics 0 to 4 of p²ρ² − q², about θ = 0.
        let half = [b2[0] * 0.5, b2[1] * 0.5];
        let mean = b0.mul_add(a0, half[0].mul_add(a2, (qc_sq + qs_sq + q2_sq) * -0.5));
        let modes = [
            [
                b0.mul_add(a1[0], half[0].mul_add(a1[0], half[1].mul_add(a1[1], -(q2 * qs)))),
                b0.mul_add(a1[1], half[1].mul_add(a1[0], -half[0].mul_add(a1[1], q2 * qc))),
            ],
            [b0.mul_add(a2, b2[0].mul_add(a0, (qs_sq - qc_sq) * 0.5)), b2[1].mul_add(a0, -(qc * qs))],
            [
                half[0].mul_add(a1[0], half[1].neg_mul_add(a1[1], q2 * qs)),
                half[1].mul_add(a1[0], half[0].mul_add(a1[1], -(q2 * qc))),
            ],
            [half[0].mul_add(a2, q2_sq * 0.5), half[1] * a2],
        ];
        // Move the origin to the centre of the first arc.
        let (mut cosine, mut sine) = ([mean; 4], [mean; 4]);
        for k in 0..4 {
            let ([c, s], by) = (modes[k], tables.center_turns[k]);
            let (cos, sin) = (mean.splat(by.cos), mean.splat(by.sin));
            cosine[k] = c.mul_add(cos, s * sin);
            sine[k] = c.neg_mul_add(sin, s * cos);
        }
        // Upper bound of |p²ρ²| + |q²|.
        let q_max = qc.abs() + qs.abs() + q2.abs();
        let size = (b0 + b0).mul_add(a0 + a1[0].abs() + a1[1].abs() - a2, q_max * q_max);
        Self { mean, cosine, sine, size }
    }

    /// Cosine and sine parts of the four harmonics about the centre of arc `M < ARCS / 2`. From one arc to the next
    /// their phases advance by 45°, 90°, 135° and 180°.
    #[inline(always)]
    fn rotated_by_eighths<const M: usize>(&self) -> [[T; 2]; 4] {
        let ([c1, c2, c3, c4], [s1, s2, s3, s4]) = (self.cosine, self.sine);
        match M {
            0 => [[c1, s1], [c2, s2], [c3, s3], [c4, s4]],
            1 => {
                let ([a, b], [c, d]) = (rotate_by_eighth(c1, s1), rotate_by_eighth(c3, s3));
                [[a, b], [s2, -c2], [d, -c], [-c4, -s4]]
            }
            2 => [[s1, -c1], [-c2, -s2], [-s3, c3], [c4, s4]],
            _ => {
                let ([a, b], [c, d]) = (rotate_by_eighth(c1, s1), rotate_by_eighth(c3, s3));
                [[b, -a], [-s2, c2], [c, d], [-c4, -s4]]
            }
        }
    }

    /// The Bernstein coefficients on arc `M < ARCS / 2` and on the opposite one. The two differ in the sign of the
    /// odd harmonics. The first and the last coefficient are the values of H at the ends of the arc, taken from
    /// `ends`.
    #[inline(always)]
    pub fn on_opposite_arcs<const M: usize>(&self, ends: &[T; ARCS], tables: &ArcTables) -> [[T; 9]; 2] {
        let [first, second, third, fourth] = self.rotated_by_eighths::<M>();
        let mut out = [[self.mean; 9]; 2];
        (out[0][0], out[0][8]) = (ends[M], ends[M + 1]);
        (out[1][0], out[1][8]) = (ends[M + ARCS / 2], ends[(M + ARCS / 2 + 1) % ARCS]);
        for i in 1..5 {
            let a = splat4(self.mean, &tables.basis.cosines[i]);
            let even = second[0].mul_add(a[1], fourth[0].mul_add(a[3], self.mean));
            let odd = first[0].mul_add(a[0], third[0] * a[2]);
            if i == 4 {
                (out[0][4], out[1][4]) = (even + odd, even - odd);
                continue;
            }
            let b = splat4(self.mean, &tables.basis.sines[i]);
            let even_sine = second[1].mul_add(b[1], fourth[1] * b[3]);
            let odd_sine = first[1].mul_add(b[0], third[1] * b[2]);
            let (left, right) = (even + even_sine, even - even_sine);
            let (odd_left, odd_right) = (odd + odd_sine, odd - odd_sine);
            (out[0][i], out[0][8 - i]) = (left + odd_left, right + odd_right);
            (out[1][i], out[1][8 - i]) = (left - odd_left, right - odd_right);
        }
        out
    }

    /// Cosine and sine parts of the four harmonics about an origin rotated from the first centre by an angle.
    #[inline(always)]
    pub fn rotated_by(&self, turn: [T; 2]) -> [[T; 2]; 4] {
        let [cos, sin] = turn;
        let mut by = turn;
        let mut modes = [[self.mean; 2]; 4];
        for k in 0..4 {
            modes[k] = rotate_harmonic([self.cosine[k], self.sine[k]], by);
            by = [by[1].neg_mul_add(sin, by[0] * cos), by[0].mul_add(sin, by[1] * cos)];
        }
        modes
    }

    /// The Bernstein coefficients on the arc whose centre is rotated from the first by an angle, given H at its ends.
    #[inline(always)]
    pub fn on_arc(&self, turn: [T; 2], ends: [T; 2], tables: &ArcTables) -> [T; 9] {
        bernstein_on_arc(self.mean, &self.rotated_by(turn), ends, &tables.basis)
    }

    /// Coefficients of smaller absolute value have no certain sign.
    #[inline(always)]
    pub fn coefficient_threshold(&self) -> T {
        self.size * SIGN_TOLERANCE
    }

    /// If the product of two neighbouring coefficients is smaller, they count as a sign change.
    #[inline(always)]
    pub fn product_threshold(&self) -> T {
        self.size * self.size * SIGN_TOLERANCE
    }
}

/// Four constants in every lane. Not a closure, see `simd.rs`.
#[inline(always)]
fn splat4<T: SimdReal>(model: T, values: &[f64; 4]) -> [T; 4] {
    [model.splat(values[0]), model.splat(values[1]), model.splat(values[2]), model.splat(values[3])]
}

/// The Bernstein coefficients on an arc from the mean of H, its harmonics about the centre of the arc (cosine and
/// sine parts) and its values at the ends.
#[inline(always)]
pub(crate) fn bernstein_on_arc<T: SimdReal>(
    mean: T,
    modes: &[[T; 2]; 4],
    ends: [T; 2],
    basis: &BernsteinBasis,
) -> [T; 9] {
    let mut out = [ends[0]; 9];
    out[8] = ends[1];
    for i in 1..5 {
        let (a, mut even) = (&basis.cosines[i], mean);
        for k in 0..4 {
            even = modes[k][0].mul_add(mean.splat(a[k]), even);
        }
        if i == 4 {
            out[4] = even;
            continue;
        }
        let (b, mut odd) = (&basis.sines[i], modes[0][1] * basis.sines[i][0]);
        for k in 1..4 {
            odd = modes[k][1].mul_add(mean.splat(b[k]), odd);
        }
        (out[i], out[8 - i]) = (even + odd, even - odd);
    }
    out
}

/// The number of sign changes in the coefficients; pairs of coefficients with uncertain signs count as changes.
#[inline(always)]
pub(crate) fn sign_changes<T: SimdReal>(coefficients: &[T; 9], threshold: T) -> T {
    let mut sums = [threshold.splat(0.0); 4];
    for i in 0..8 {
        sums[i % 4] = sums[i % 4].add_one_if((coefficients[i] * coefficients[i + 1]).lt(threshold));
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// The Bernstein coefficients on the two halves of an arc, by de Casteljau's algorithm. These are undivided
/// coefficients.
///
/// Sums are formed first and scaled by powers of ½ at the end, which is exact and saves multiplications.
#[inline(always)]
pub(crate) fn split<T: SimdReal>(coefficients: &[T; 9]) -> [[T; 9]; 2] {
    let (mut row, mut left) = (*coefficients, *coefficients);
    let mut share = 1.0;
    for k in 1..9 {
        // In place, with constant bounds: entries beyond 8 − k already belong to the right half.
        for i in 0..9 - k {
            row[i] = row[i] + row[i + 1];
        }
        share *= 0.5;
        left[k] = row[0] * share;
    }
    let mut share = 1.0;
    for i in (0..8).rev() {
        share *= 0.5;
        row[i] = row[i] * share;
    }
    [left, row]
}
