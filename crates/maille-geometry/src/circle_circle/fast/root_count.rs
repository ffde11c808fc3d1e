//! ArcTables of the moving circle with one minimum each: what the count ([`crate::count`]) proves of eight arcs.
//!
//! Where it proves nothing, [`crate::halving`] goes on.

use crate::circle_circle::angle::Angle;
use crate::circle_circle::fast::arc_tables::{ARCS, ArcTables};
use crate::circle_circle::fast::bernstein::{Harmonics, sign_changes};
use crate::circle_circle::fast::bracket::{Bracket, MAX_SIMD_MINIMA};
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::SimdReal;

/// The slope and its parts must be larger than this, in units of the pair's scale.
const MIN_SLOPE: f64 = 1e-10;

/// H = G₋ G₊ at an angle, and numbers with the signs of G₋ and of G₊, without a root: where H > 0 both have the sign of p,
/// where H < 0 they have those of −q and q. Near H = 0 rounding may choose; there the coefficients count as doubtful.
#[derive(Clone, Copy)]
pub(crate) struct FactorSigns<T> {
    pub product: T,
    pub minus: T,
    pub plus: T,
}

impl<T: SimdReal> FactorSigns<T> {
    #[inline(always)]
    pub fn from_terms([p, q, square]: [T; 3]) -> Self {
        let product = (p * p).mul_add(square, -(q * q));
        let outer = product.splat(0.0).lt(product);
        FactorSigns { product, minus: T::select(outer, p, -q), plus: T::select(outer, p, q) }
    }

    #[inline(always)]
    pub fn at(pair: &NormalizedPair<T>, cos: T, sin: T) -> Self {
        Self::from_terms(pair.terms(cos, sin))
    }

    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        FactorSigns {
            product: T::select(mask, yes.product, no.product),
            minus: T::select(mask, yes.minus, no.minus),
            plus: T::select(mask, yes.plus, no.plus),
        }
    }

    /// How many of G₋ and G₊ change sign on the way to another angle.
    #[inline(always)]
    pub fn sign_changes(self, next: Self) -> T {
        let zero = self.product.splat(0.0);
        zero.add_one_if((self.minus * next.minus).lt(zero)).add_one_if((self.plus * next.plus).lt(zero))
    }

    /// G₋ rises through 0 on the way.
    #[inline(always)]
    pub fn rises(self, next: Self) -> T::Mask {
        let zero = self.product.splat(0.0);
        T::and(self.minus.lt(zero), zero.lt(next.minus))
    }
}

/// The count of a pair, or of a register of pairs.
pub(crate) struct RootCounts<T> {
    /// How many more critical points than known an arc could have.
    pub excess: [T; ARCS],
    /// At the first ends of the arcs.
    pub signs: [FactorSigns<T>; ARCS],
}

impl<T: SimdReal> RootCounts<T> {
    #[inline(always)]
    pub fn new(pair: &NormalizedPair<T>, harmonics: &Harmonics<T>, tables: &ArcTables) -> Self {
        let signs = signs_at_ends(pair, tables);
        let doubt = harmonics.product_threshold();
        let mut counted = Self { excess: [doubt; ARCS], signs };
        counted.count_arcs::<0>(harmonics, tables, doubt);
        counted.count_arcs::<1>(harmonics, tables, doubt);
        counted.count_arcs::<2>(harmonics, tables, doubt);
        counted.count_arcs::<3>(harmonics, tables, doubt);
        counted
    }

    /// The excess of an arc and of the opposite one.
    #[inline(always)]
    fn count_arcs<const M: usize>(&mut self, harmonics: &Harmonics<T>, tables: &ArcTables, doubt: T) {
        let both = harmonics.on_opposite_arcs::<M>(&self.end_products(), tables);
        for half in 0..2 {
            let k = M + half * (ARCS / 2);
            let known = self.signs[k].sign_changes(self.signs[(k + 1) % ARCS]);
            self.excess[k] = sign_changes(&both[half], doubt) - known;
        }
    }

    /// H at the first ends of the arcs.
    #[inline(always)]
    pub fn end_products(&self) -> [T; ARCS] {
        let mut ends = [self.signs[0].product; ARCS];
        for k in 1..ARCS {
            ends[k] = self.signs[k].product;
        }
        ends
    }

    /// 0 if the count is known.
    #[inline(always)]
    pub fn total_excess(&self) -> T {
        let mut sums = [self.excess[0].abs(), self.excess[1].abs()];
        for k in 2..ARCS {
            sums[k % 2] = sums[k % 2] + self.excess[k].abs();
        }
        sums[0] + sums[1]
    }

    /// The first and the last arc on which G₋ rises through 0, and how many there are.
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

/// At the first ends of the arcs; opposite ends share their odd parts.
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
        out[k] = FactorSigns::from_terms([p, even + odd, x.mul_add(x, y * y)]);
        let square = x_opposite.mul_add(x_opposite, y_opposite * y_opposite);
        out[k + ARCS / 2] = FactorSigns::from_terms([-p, even - odd, square]);
    }
    out
}

/// The pair is steep enough for the count to mean something.
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

    /// The coefficients of each arc, and of halves of it, are those of H: summed up they give its signs.
    #[test]
    fn coefficients_are_those_of_the_product() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
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
