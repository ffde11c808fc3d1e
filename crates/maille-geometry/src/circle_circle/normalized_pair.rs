//! The relative position of two circles in six numbers, for a pair or for a register of pairs.

use crate::simd::SimdReal;

/// The six numbers of a pair, or of a register of pairs, with the harmonics that the quick kernel works on.
#[derive(Clone, Copy)]
pub(crate) struct NormalizedPair<T> {
    /// `R`, radius of the base.
    pub base_radius: T,
    /// `r`, radius of the moving circle.
    pub radius: T,
    pub x0: T,
    pub y0: T,
    pub z0: T,
    /// `c`.
    pub tilt_cos: T,
    /// `s`.
    pub tilt_sin: T,
    /// `w·w′ = p₀ cos θ + p₁ sin θ`, w from the centre of the base.
    pub p: [T; 2],
    /// `R e·e′ = q₀ cos θ + q₁ sin θ + q₂ sin 2θ`.
    pub q: [T; 3],
    /// `1/R`.
    pub inverse_base_radius: T,
}

impl<T: SimdReal> NormalizedPair<T> {
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

    /// What it is made of.
    #[inline(always)]
    pub fn to_array(&self) -> [T; 7] {
        [self.base_radius, self.radius, self.x0, self.y0, self.z0, self.tilt_cos, self.tilt_sin]
    }

    #[inline(always)]
    pub fn from_array([base_radius, radius, x0, y0, z0, tilt_cos, tilt_sin]: [T; 7]) -> Self {
        Self::new(base_radius, radius, [x0, y0, z0], tilt_cos, tilt_sin)
    }

    /// p, q and ρ² at an angle: what `ρ h′ = pρ − q` is made of.
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
        let [p, q, square] = self.terms(cos, sin);
        p.mul_add(square.sqrt(), -q)
    }

    /// The position in the base plane.
    #[inline(always)]
    fn position(&self, cos: T, sin: T) -> [T; 2] {
        [(self.radius * self.tilt_cos).mul_add(cos, self.x0), self.radius.mul_add(sin, self.y0)]
    }

    /// `h′`, `h″` and ρ, from the products that keep `h′` accurate, see [`crate::relative::PairFrame::sample`].
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

    /// Halley's step for `f = ρ h′ = ρ z z′ + (ρ − R) e·e′`, as a fraction that is the tangent of half of it:
    /// `−f f′ / (2 f′² − f f″)` times ρ³ above and below, so that it takes no division; ρ, and `ρ f′`.
    ///
    /// The products keep f accurate, see [`crate::relative::PairFrame::sample`]; its derivatives are those of `pρ − q`, with `R e·e′ = q`.
    #[inline(always)]
    pub fn halley_step(&self, cos: T, sin: T) -> ([T; 2], [T; 2]) {
        let rise = self.radius * self.tilt_sin;
        let [x, y] = self.position(cos, sin);
        let (z, z1) = (rise.mul_add(cos, self.z0), -(rise * sin));
        let square = x.mul_add(x, y * y);
        let rho = square.sqrt();
        let (twice_sin, twice_cos) = ((sin + sin) * cos, (cos - sin) * (cos + sin));
        let (p, p1) = (self.p[0].mul_add(cos, self.p[1] * sin), self.p[0].neg_mul_add(sin, self.p[1] * cos));
        let odd = self.q[0].mul_add(cos, self.q[1] * sin);
        let even = self.q[2] * twice_sin;
        let q = odd + even;
        let q1 = (self.q[2] + self.q[2]).mul_add(twice_cos, self.q[0].neg_mul_add(sin, self.q[1] * cos));
        // −q″
        let bend = even.mul_add(even.splat(4.0), odd);
        let (ee, ee1) = (q * self.inverse_base_radius, q1 * self.inverse_base_radius);
        let f = rho.mul_add(z * z1, (rho - self.base_radius) * ee);
        // ρ f′ and ρ³ f″
        let first = q1.neg_mul_add(rho, p1.mul_add(square, p * ee));
        let inner = bend.mul_add(rho, p.neg_mul_add(square, p.mul_add(ee1, (p1 + p1) * ee)));
        let second = (p * ee).neg_mul_add(ee, square * inner);
        let denominator = (first * rho).neg_mul_add(first + first, f * second);
        ([f * first * square, denominator], [rho, first])
    }

    /// With `g(α, θ) = ½ |A(α) − P(θ)|²` and α the angle of the foot, whose direction in the base plane is given with ρ:
    /// `g_αα = R ρ`, `g_αθ`, `g_θθ` at the foot held fixed, and `h′`. See [`crate::relative::PairFrame::minimum`].
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

    /// How large the slope could be: the sum of its harmonics' amplitudes.
    #[inline(always)]
    pub fn slope_bound(&self) -> T {
        self.p[0].abs() + self.p[1].abs() + self.q[0].abs() + self.q[1].abs() + self.q[2]
    }

    /// The position in the base plane, and its distance from the axis.
    #[inline(always)]
    pub fn position_and_rho(&self, cos: T, sin: T) -> [T; 3] {
        let [x, y] = self.position(cos, sin);
        [x, y, x.mul_add(x, y * y).sqrt()]
    }

    /// The distance at an angle, given ρ there.
    #[inline(always)]
    pub fn distance(&self, cos: T, rho: T) -> T {
        let radial = rho - self.base_radius;
        let z = (self.radius * self.tilt_sin).mul_add(cos, self.z0);
        z.mul_add(z, radial * radial).sqrt()
    }
}
