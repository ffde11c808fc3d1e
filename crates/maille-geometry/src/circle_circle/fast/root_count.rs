//! How many critical points the distance has on an arc: the proof that the fast method misses no minimum.
//!
//! Symbols as in `normalized_pair.rs`: `h′ = p − q/ρ`, so the sign of `h′` is that of `G₋ = pρ − q`.
//!
//! **The polynomial.** Let `G₊ = pρ + q`; its roots are critical points of the distance to the far side of the base
//! circle. The product `H = G₋ G₊ = p²ρ² − q²` is a trigonometric polynomial of degree 4 (that of Appendix A before
//! it is squared once more), hence on an arc a polynomial of degree 8 in `t = tan((θ − centre)/2)`.
//!
//! **Upper bound.** By Descartes' rule of signs, the Bernstein coefficients of H on the arc change sign at least as
//! often as H has roots there, counted with multiplicity.
//!
//! **Lower bound.** If `G₋` has different signs at the two ends of the arc, it has a root between them; likewise
//! `G₊`.
//!
//! **Conclusion.** Where the two bounds agree, all roots are known: `G₋` has exactly one root if its sign changes
//! between the ends, and none otherwise. On every arc the first bound is at least the second, so it is enough to
//! compare the sums over all arcs.
//!
//! **Rounding.** If rounding could change the sign of a coefficient, both neighbouring pairs count as sign changes.
//! The upper bound can then only become too large, and the arc counts as undecided.
//!
//! **At most three minima.** Where `ρ > 0`, `G₊` is smooth and changes sign at least twice, because the distance to
//! the far side has a maximum and a minimum. H has at most eight roots, so `G₋` has at most six, and the distance
//! at most three minima.

use crate::circle_circle::angle::Angle;
use crate::circle_circle::fast::arc_tables::{ARCS, ArcTables};
use crate::circle_circle::fast::bernstein::{Harmonics, sign_changes};
use crate::circle_circle::fast::bracket::{Bracket, MAX_SIMD_MINIMA};
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// Pairs with smaller `|p| + |q|`, relative to the radius of the moving circle, are left to the exhaustive method.
const MIN_SLOPE: f64 = 1e-10;

/// `H = G₋ G₊` at an angle, and two numbers with the signs of `G₋` and `G₊`.
///
/// The signs need no square root: where `H > 0` both are that of `p`; where `H < 0` they are those of `−q` and `q`.
/// Near `H = 0` rounding may decide, but there the Bernstein coefficients have no certain sign either.
#[derive(Clone, Copy)]
pub(crate) struct FactorSigns<T> {
    /// H.
    pub product: T,
    /// Has the sign of `G₋`.
    pub minus: T,
    /// Has the sign of `G₊`.
    pub plus: T,
}

impl<T: SimdReal> FactorSigns<T> {
    /// From `p`, `q` and `ρ²`.
    #[inline(always)]
    pub fn from_terms([p, q, rho_sq]: [T; 3]) -> Self {
        let product = (p * p).mul_add(rho_sq, -(q * q));
        let is_positive = product.splat(0.0).lt(product);
        FactorSigns { product, minus: T::select(is_positive, p, -q), plus: T::select(is_positive, p, q) }
    }

    /// At the angle with this cosine and sine.
    #[inline(always)]
    pub fn at(pair: &NormalizedPair<T>, cos: T, sin: T) -> Self {
        Self::from_terms(pair.terms(cos, sin))
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        FactorSigns {
            product: T::select(mask, yes.product, no.product),
            minus: T::select(mask, yes.minus, no.minus),
            plus: T::select(mask, yes.plus, no.plus),
        }
    }

    /// How many of `G₋` and `G₊` have another sign at the next angle: 0, 1 or 2.
    #[inline(always)]
    pub fn sign_changes(self, next: Self) -> T {
        let zero = self.product.splat(0.0);
        zero.add_one_if((self.minus * next.minus).lt(zero)).add_one_if((self.plus * next.plus).lt(zero))
    }

    /// Does `G₋`, and with it `h′`, go from negative to positive? Then there is a minimum in between.
    #[inline(always)]
    pub fn rises(self, next: Self) -> T::Mask {
        let zero = self.product.splat(0.0);
        T::and(self.minus.lt(zero), zero.lt(next.minus))
    }
}

/// Signs at the ends of the eight arcs, and the difference of the two bounds on each.
pub(crate) struct RootCounts<T> {
    /// Upper minus lower bound of the number of roots of H, by arc: 0 if all roots are known.
    pub excess: [T; ARCS],
    /// Signs at the first end of each arc.
    pub signs: [FactorSigns<T>; ARCS],
}

impl<T: SimdReal> RootCounts<T> {
    /// Of a pair.
    #[inline(always)]
    pub fn new(pair: &NormalizedPair<T>, harmonics: &Harmonics<T>, tables: &ArcTables) -> Self {
        let signs = signs_at_ends(pair, tables);
        let threshold = harmonics.product_threshold();
        let mut counts = Self { excess: [threshold; ARCS], signs };
        counts.count_arcs::<0>(harmonics, tables, threshold);
        counts.count_arcs::<1>(harmonics, tables, threshold);
        counts.count_arcs::<2>(harmonics, tables, threshold);
        counts.count_arcs::<3>(harmonics, tables, threshold);
        counts
    }

    /// Sets the excess of arc `M` and of the opposite one.
    #[inline(always)]
    fn count_arcs<const M: usize>(&mut self, harmonics: &Harmonics<T>, tables: &ArcTables, threshold: T) {
        let coefficients = harmonics.on_opposite_arcs::<M>(&self.end_products(), tables);
        for half in 0..2 {
            let k = M + half * (ARCS / 2);
            let lower_bound = self.signs[k].sign_changes(self.signs[(k + 1) % ARCS]);
            self.excess[k] = sign_changes(&coefficients[half], threshold) - lower_bound;
        }
    }

    /// H at the first end of each arc.
    #[inline(always)]
    pub fn end_products(&self) -> [T; ARCS] {
        let mut ends = [self.signs[0].product; ARCS];
        for k in 1..ARCS {
            ends[k] = self.signs[k].product;
        }
        ends
    }

    /// Sum of the excesses: 0 if the roots on all arcs are known.
    #[inline(always)]
    pub fn total_excess(&self) -> T {
        let mut sums = [self.excess[0].abs(), self.excess[1].abs()];
        for k in 2..ARCS {
            sums[k % 2] = sums[k % 2] + self.excess[k].abs();
        }
        sums[0] + sums[1]
    }

    /// The first and the last arc on which `G₋` rises through 0, and the number of such arcs.
    #[inline(always)]
    pub fn rising_arcs(&self, tables: &ArcTables) -> ([Bracket<T>; MAX_SIMD_MINIMA], T) {
        let (zero, one) = (self.excess[0].splat(0.0), self.excess[0].splat(1.0));
        let mut middles = [Angle { cos: one, sin: zero }; MAX_SIMD_MINIMA];
        let mut count = zero;
        for k in 0..ARCS {
            let rises = self.signs[k].rises(self.signs[(k + 1) % ARCS]);
            let center = Angle::splat(middles[0], tables.centers[k]);
            middles[0] = Angle::select(T::and(rises, count.lt(one)), center, middles[0]);
            middles[1] = Angle::select(rises, center, middles[1]);
            count = count.add_one_if(rises);
        }
        ([Bracket::on_arc(&tables.levels[0], middles[0]), Bracket::on_arc(&tables.levels[0], middles[1])], count)
    }
}

/// The signs at the first end of each arc. Opposite ends share their even and odd parts.
#[inline(always)]
fn signs_at_ends<T: SimdReal>(pair: &NormalizedPair<T>, tables: &ArcTables) -> [FactorSigns<T>; ARCS] {
    let across = pair.radius * pair.tilt_cos;
    let zero = across.splat(0.0);
    let mut out = [FactorSigns { product: zero, minus: zero, plus: zero }; ARCS];
    for k in 0..ARCS / 2 {
        let (cos, sin) = (zero.splat(tables.ends[k].cos), zero.splat(tables.ends[k].sin));
        let p = pair.p[0].mul_add(cos, pair.p[1] * sin);
        let odd = pair.q[0].mul_add(cos, pair.q[1] * sin);
        let even = pair.q[2] * zero.splat(2.0 * tables.ends[k].sin * tables.ends[k].cos);
        let (x, y) = (across.mul_add(cos, pair.x0), pair.radius.mul_add(sin, pair.y0));
        let (x_opposite, y_opposite) = (across.neg_mul_add(cos, pair.x0), pair.radius.neg_mul_add(sin, pair.y0));
        // The end of arc k, then the opposite one.
        out[k] = FactorSigns::from_terms([p, even + odd, x.mul_add(x, y * y)]);
        let rho_sq_opposite = x_opposite.mul_add(x_opposite, y_opposite * y_opposite);
        out[k + ARCS / 2] = FactorSigns::from_terms([-p, even - odd, rho_sq_opposite]);
    }
    out
}

/// Does the distance vary enough along the circle for the count to be meaningful?
#[inline(always)]
pub(crate) fn is_steep<T: SimdReal>(pair: &NormalizedPair<T>) -> T::Mask {
    pair.radius.splat(MIN_SLOPE).lt(pair.slope_bound())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circle::{Circle, Vec3};
    use crate::circle_circle::angle::Direction;
    use crate::circle_circle::fast::arc_tables::ARC_TABLES;
    use crate::circle_circle::fast::bernstein::split;
    use crate::circle_circle::pair_frame::PairFrame;
    use rand::{RngExt, SeedableRng};
    use std::f64::consts::TAU;

    /// The coefficients on each arc and on its halves are those of H: the Bernstein sums give its values.
    #[test]
    fn coefficients_are_those_of_the_product() {
        let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(5);
        for _ in 0..200 {
            let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
            let unit = nalgebra::UnitVector3::new_normalize;
            let a = Circle::new(Vec3::zeros(), unit(vector(1.0)), 1.0);
            let b = Circle::new(vector(2.0), unit(vector(1.0)), rng.random_range(0.1..1.0));
            let pair = PairFrame::new(&a, &b).normalized();
            let harmonics = Harmonics::new(&pair, &ARC_TABLES);
            let ends: [f64; ARCS] =
                std::array::from_fn(|k| FactorSigns::at(&pair, ARC_TABLES.ends[k].cos, ARC_TABLES.ends[k].sin).product);
            for (k, center) in ARC_TABLES.centers.into_iter().enumerate() {
                let Direction { cos, sin } = Direction::at(k as f64 * TAU / ARCS as f64);
                let arc = harmonics.on_arc([cos, sin], [ends[k], ends[(k + 1) % ARCS]], &ARC_TABLES);
                let both = [
                    harmonics.on_opposite_arcs::<0>(&ends, &ARC_TABLES),
                    harmonics.on_opposite_arcs::<1>(&ends, &ARC_TABLES),
                    harmonics.on_opposite_arcs::<2>(&ends, &ARC_TABLES),
                    harmonics.on_opposite_arcs::<3>(&ends, &ARC_TABLES),
                ];
                for (p, q) in arc.iter().zip(&both[k % 4][k / 4]) {
                    assert!((p - q).abs() < 1e-14 * harmonics.size);
                }
                let whole: [f64; 9] = std::array::from_fn(|i| arc[i] * ARC_TABLES.bernstein_weights[i]);
                let [left, right] = split(&whole);
                for (b, from, to) in [(whole, -1.0, 1.0), (left, -1.0, 0.0), (right, 0.0, 1.0)] {
                    for u in [0.0, 0.1, 0.37, 0.8, 1.0] {
                        let choose = |k: usize| (0..k).fold(1.0, |c, i| c * (8 - i) as f64 / (i + 1) as f64);
                        let term =
                            |k: usize| b[k] * choose(k) * f64::powi(u, k as i32) * f64::powi(1.0 - u, 8 - k as i32);
                        let value: f64 = (0..9).map(term).sum();
                        let t = ARC_TABLES.levels[0].quarter_tan * (from + (to - from) * u);
                        let at = center.rotated_by_half_tan(t);
                        let [p, q, square] = pair.terms(at.cos, at.sin);
                        let expected = (p * square.sqrt() - q) * (p * square.sqrt() + q) * (1.0 + t * t).powi(4);
                        assert!((value - expected).abs() < 1e-14 * harmonics.size, "{value} {expected}");
                        assert!(expected.abs() <= harmonics.size * (1.0 + t * t).powi(4));
                    }
                }
            }
        }
    }
}
