//! A pair of circles reduced to six numbers, and what the fast method evaluates of it.
//!
//! In the frame of `pair_frame.rs`, with lengths divided by the pair's scale, the moving circle is
//!
//! `P(θ) = (x₀ + r c cos θ, y₀ + r sin θ, z₀ + r s cos θ)`
//!
//! and the base circle has radius `R`, centre 0 and axis z. Let `e = (x, y)` be the part of `P` in the base plane,
//! `ρ = |e|` the distance from the axis, `w = P` the vector from the base centre, and a prime the derivative in θ.
//! Half the squared distance from the base, `h = ½ (z² + (ρ − R)²)`, has the derivative
//!
//! `h′ = w·w′ − R ρ′ = p − q/ρ`, `p = w·w′ = p₀ cos θ + p₁ sin θ`, `q = R e·e′ = q₀ cos θ + q₁ sin θ + q₂ sin 2θ`.
//!
//! All quantities are dimensionless. `T` is an `f64` or a SIMD register with one pair per lane.

use crate::simd::SimdReal;

/// The six numbers of a pair (`x₀, y₀, z₀`, `r`, `R` and the tilt), with the harmonics of `p` and `q`.
#[derive(Clone, Copy)]
pub(crate) struct NormalizedPair<T> {
    /// `R`, radius of the base circle.
    pub base_radius: T,
    /// `r`, radius of the moving circle.
    pub radius: T,
    pub x0: T,
    pub y0: T,
    pub z0: T,
    /// `c`, cosine of the angle between the planes.
    pub tilt_cos: T,
    /// `s`, sine of the angle between the planes.
    pub tilt_sin: T,
    /// `p₀, p₁` of `p = w·w′`.
    pub p: [T; 2],
    /// `q₀, q₁, q₂` of `q = R e·e′`.
    pub q: [T; 3],
    /// `1/R`.
    pub inverse_base_radius: T,
}

impl<T: SimdReal> NormalizedPair<T> {
    /// From the six numbers, the tilt given by cosine and sine.
    #[inline(always)]
    pub fn new(base_radius: T, radius: T, [x0, y0, z0]: [T; 3], tilt_cos: T, tilt_sin: T) -> Self {
        let (cx0, rise) = (tilt_cos * x0, radius * tilt_sin);
        let p = [radius * y0, -(radius * tilt_sin.mul_add(z0, cx0))];
        let q = [base_radius * p[0], -(base_radius * (radius * cx0)), base_radius * (rise * rise) * 0.5];
        Self {
            base_radius,
            radius,
            x0,
            y0,
            z0,
            tilt_cos,
            tilt_sin,
            p,
            q,
            inverse_base_radius: radius.splat(1.0) / base_radius,
        }
    }

    /// The arguments of [`Self::new`], for storing in memory.
    #[inline(always)]
    pub fn parameters(&self) -> [T; 7] {
        [self.base_radius, self.radius, self.x0, self.y0, self.z0, self.tilt_cos, self.tilt_sin]
    }

    /// The inverse of [`Self::parameters`].
    #[inline(always)]
    pub fn from_parameters([base_radius, radius, x0, y0, z0, tilt_cos, tilt_sin]: [T; 7]) -> Self {
        Self::new(base_radius, radius, [x0, y0, z0], tilt_cos, tilt_sin)
    }

    /// `p`, `q` and `ρ²` at an angle, the terms of `ρ h′ = pρ − q`.
    #[inline(always)]
    pub fn terms(&self, cos: T, sin: T) -> [T; 3] {
        let [x, y] = self.position(cos, sin);
        let p = self.p[0].mul_add(cos, self.p[1] * sin);
        let q = (self.q[2] * sin).mul_add(cos + cos, self.q[0].mul_add(cos, self.q[1] * sin));
        [p, q, x.mul_add(x, y * y)]
    }

    /// `ρ h′ = pρ − q`.
    #[inline(always)]
    pub fn rho_slope(&self, cos: T, sin: T) -> T {
        let [p, q, rho_sq] = self.terms(cos, sin);
        p.mul_add(rho_sq.sqrt(), -q)
    }

    /// `e`, the position in the base plane.
    #[inline(always)]
    fn position(&self, cos: T, sin: T) -> [T; 2] {
        [(self.radius * self.tilt_cos).mul_add(cos, self.x0), self.radius.mul_add(sin, self.y0)]
    }

    /// `h′`, `h″` and `ρ`.
    ///
    /// Evaluated by the products that keep `h′` accurate, see `PairFrame::sample`.
    pub fn slope_and_curvature(&self, cos: T, sin: T) -> [T; 3] {
        let (r, c) = (self.radius, self.tilt_cos);
        let rise = r * self.tilt_sin;
        let rho = self.position_and_rho(cos, sin)[2];
        let inverse = rho.splat(1.0) / rho;
        let (z, z1, z2) = (self.z0 + rise * cos, -(rise * sin), -(rise * cos));
        let ee2 = rise * rise * ((cos - sin) * (cos + sin)) - r * (self.y0 * sin + c * self.x0 * cos);
        let rho1 = (r * (self.y0 * cos - c * self.x0 * sin) + rise * rise * (sin * cos)) * inverse;
        let rho2 = (ee2 - rho1 * rho1) * inverse;
        let radial = rho - self.base_radius;
        [z * z1 + radial * rho1, z1 * z1 + z * z2 + rho1 * rho1 + radial * rho2, rho]
    }

    /// One step δ of Halley's iteration for `f = ρ h′`; returns `tan(δ/2)` as numerator and denominator, then `ρ`
    /// and `ρ f′`.
    ///
    /// Halley's step is `δ = −2 f f′ / (2 f′² − f f″)`. Half of it is used as `tan(δ/2)`, which differs by `O(δ³)`
    /// and so keeps the cubic convergence. Both terms of the fraction are multiplied by `ρ³`, so that no division
    /// is needed.
    ///
    /// `f = ρ z z′ + (ρ − R) e·e′` is evaluated by products that keep it accurate, see `PairFrame::sample`; its
    /// derivatives are those of `pρ − q`, with `e·e′ = q/R`.
    #[inline(always)]
    pub fn halley_step(&self, cos: T, sin: T) -> ([T; 2], [T; 2]) {
        // Height, position in the base plane and ρ.
        let rise = self.radius * self.tilt_sin;
        let [x, y] = self.position(cos, sin);
        let (z, z1) = (rise.mul_add(cos, self.z0), -(rise * sin));
        let rho_sq = x.mul_add(x, y * y);
        let rho = rho_sq.sqrt();
        // p, q and their derivatives.
        let (twice_sin, twice_cos) = ((sin + sin) * cos, (cos - sin) * (cos + sin));
        let (p, p1) = (self.p[0].mul_add(cos, self.p[1] * sin), self.p[0].neg_mul_add(sin, self.p[1] * cos));
        let odd = self.q[0].mul_add(cos, self.q[1] * sin);
        let even = self.q[2] * twice_sin;
        let q = odd + even;
        let q1 = (self.q[2] + self.q[2]).mul_add(twice_cos, self.q[0].neg_mul_add(sin, self.q[1] * cos));
        // −q″
        let minus_q2 = even.mul_add(even.splat(4.0), odd);
        let (ee, ee1) = (q * self.inverse_base_radius, q1 * self.inverse_base_radius);
        // f, ρ f′ and ρ³ f″.
        let f = rho.mul_add(z * z1, (rho - self.base_radius) * ee);
        let rho_f1 = q1.neg_mul_add(rho, p1.mul_add(rho_sq, p * ee));
        let inner = minus_q2.mul_add(rho, p.neg_mul_add(rho_sq, p.mul_add(ee1, (p1 + p1) * ee)));
        let rho3_f2 = (p * ee).neg_mul_add(ee, rho_sq * inner);
        let denominator = (rho_f1 * rho).neg_mul_add(rho_f1 + rho_f1, f * rho3_f2);
        ([f * rho_f1 * rho_sq, denominator], [rho, rho_f1])
    }

    /// `g_αα = R ρ`, `g_αθ`, `g_θθ` and `h′`, where `g(α, θ) = ½ |A(α) − P(θ)|²` and `α` is the angle of the foot,
    /// the point of the base nearest to `P`.
    ///
    /// `x, y` is the unit vector to the foot. Same formulas as `PairFrame::minimum`.
    #[inline(always)]
    pub fn distance_derivatives(&self, cos: T, sin: T, [x, y, rho]: [T; 3]) -> [T; 4] {
        let (r, rise) = (self.radius, self.radius * self.tilt_sin);
        let radial = rho - self.base_radius;
        let z = rise.mul_add(cos, self.z0);
        let across = self.tilt_cos * cos;
        let mixed = -(self.base_radius * r) * x.mul_add(cos, y * (self.tilt_cos * sin));
        let moving = r * (z * self.tilt_sin).neg_mul_add(cos, radial.neg_mul_add(x.mul_add(across, y * sin), r));
        let [_, q, _] = self.terms(cos, sin);
        let slope = (radial * (q * self.inverse_base_radius) / rho) - z * (rise * sin);
        [self.base_radius * rho, mixed, moving, slope]
    }

    /// An upper bound of `|p| + |q|`: the sum of the coefficients of their harmonics.
    #[inline(always)]
    pub fn slope_bound(&self) -> T {
        self.p[0].abs() + self.p[1].abs() + self.q[0].abs() + self.q[1].abs() + self.q[2]
    }

    /// `x`, `y` and `ρ`: the position in the base plane and its distance from the axis.
    #[inline(always)]
    pub fn position_and_rho(&self, cos: T, sin: T) -> [T; 3] {
        let [x, y] = self.position(cos, sin);
        [x, y, x.mul_add(x, y * y).sqrt()]
    }

    /// The distance from the base circle at an angle, given `ρ` there.
    #[inline(always)]
    pub fn distance(&self, cos: T, rho: T) -> T {
        let radial = rho - self.base_radius;
        let z = (self.radius * self.tilt_sin).mul_add(cos, self.z0);
        z.mul_add(z, radial * radial).sqrt()
    }
}
