//! The common frame of two circles, and the distance from one circle along the other.
//!
//! [`PairFrame`] reduces a pair to six numbers in `f64` and evaluates half the squared distance `h(θ)` with its
//! derivatives. The exhaustive method and the polynomial work on it; the fast method takes its numbers as a
//! [`NormalizedPair`].

use crate::circle::{Circle, Vec3};
use crate::circle_circle::angle::Direction;
use crate::circle_circle::minimum::{Minima, Minimum, PairKind};
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::tolerance::ROUNDING;
use arrayvec::ArrayVec;

/// Lengths below this, relative to the pair's scale, are set to 0.
const NEGLIGIBLE: f64 = 1e-100;

/// A pair of circles: the **base** circle, and the **moving** circle, along which a point `P(θ)` runs.
///
/// Let `Y` be the unit vector along `N_moving × N_base`, which lies in both planes, `X = Y × N_base`, and
/// `U = Y × N_moving`, the direction in which the moving circle ascends most steeply over the base plane. In the
/// axes `(X, Y, N_base)` around the base centre the moving circle is
///
/// `P(θ) = (x₀ + r c cos θ, y₀ + r sin θ, z₀ + r s cos θ)`, `c = N_base·N_moving`, `s = |N_base × N_moving|`.
///
/// Lengths are divided by `scale`, the largest of the radii and the distance of the centres.
///
/// **Degenerate case.** For parallel planes any `Y` in them will do; the second axis of the base's own frame is
/// taken.
pub(crate) struct PairFrame<'a> {
    pub base: &'a Circle,
    pub moving: &'a Circle,
    /// The unit of length, in the caller's unit.
    pub scale: f64,
    /// `R`, radius of the base circle.
    pub base_radius: f64,
    /// `r`, radius of the moving circle.
    pub radius: f64,
    /// `x₀, y₀, z₀`.
    pub offset: [f64; 3],
    /// `c`.
    pub tilt_cos: f64,
    /// `s`, with an absolute error of rounding size at small tilts too.
    pub tilt_sin: f64,
    /// `X` and `Y`.
    axes: [Vec3; 2],
    /// `U`.
    steepest: Vec3,
    /// For ρ below this, `e·e′` is more accurate as a scalar product than from its harmonics.
    direct_product_below: f64,
}

/// Half the squared distance `h(θ) = ½ d²`, `d² = z² + (ρ − R)²`, and its derivatives at one angle of the moving
/// circle.
///
/// Lengths in units of the pair's scale, derivatives in θ.
#[derive(Clone, Copy)]
pub(crate) struct Sample {
    /// Height `z` above the base plane.
    pub z: f64,
    /// `z′`.
    pub z1: f64,
    /// `z″`.
    pub z2: f64,
    /// Distance `ρ = |e|` from the axis of the base circle.
    pub rho: f64,
    /// `ρ − R`.
    pub radial: f64,
    /// `e = (x, y)`, the position in the base plane.
    pub e: [f64; 2],
    /// `e·e′ = ρρ′` and its derivative.
    pub ee: [f64; 2],
    /// `h′`.
    pub slope: f64,
    /// `h″`.
    pub curvature: f64,
}

impl Sample {
    /// The distance `d`.
    pub fn distance(&self) -> f64 {
        (self.z * self.z + self.radial * self.radial).sqrt()
    }

    /// The unit vector `e/ρ` towards the foot, the nearest point of the base; an arbitrary one on the axis.
    pub fn foot(&self) -> [f64; 2] {
        if self.rho > 0.0 { self.e.map(|e| e / self.rho) } else { [1.0, 0.0] }
    }

    /// Is the derivative of the distance at most [`ROUNDING`] per radian?
    pub fn is_stationary(&self) -> bool {
        self.slope.abs() <= ROUNDING * (self.distance() + ROUNDING)
    }
}

impl<'a> PairFrame<'a> {
    /// The frame of a pair.
    pub fn new(base: &'a Circle, moving: &'a Circle) -> Self {
        let offset = moving.center - base.center;
        let scale = offset.norm().max(base.radius).max(moving.radius);
        let (n, m) = (&*base.normal, &*moving.normal);
        let cross = m.cross(n);
        // Axes. At small tilts the rounding error of the cross product is relatively large. After a second
        // projection onto the base plane, its remaining part along `m` is that error times the tilt, which is
        // negligible. Below 1e-150 the squared norm would underflow.
        let y = (cross - n * n.dot(&cross)).try_normalize(1e-150).unwrap_or_else(|| base.frame().1);
        let x = y.cross(n);
        let tilt_cos = n.dot(m);
        let tilt_sin = y.dot(&cross);
        // Lengths far below rounding would underflow when squared: such a circle is a point.
        let normalize = |length: f64| if length.abs() < NEGLIGIBLE * scale { 0.0 } else { length / scale };
        let offset = [x.dot(&offset), y.dot(&offset), n.dot(&offset)].map(normalize);
        let radius = normalize(moving.radius);
        let (across, along) = (tilt_cos * offset[0], offset[1]);
        Self {
            base,
            moving,
            scale,
            base_radius: normalize(base.radius),
            radius,
            offset,
            tilt_cos,
            tilt_sin,
            axes: [x, y],
            steepest: y.cross(m),
            direct_product_below: (across * across + along * along).sqrt() + radius * tilt_sin * tilt_sin,
        }
    }

    /// `h` and its derivatives at the angle with this cosine and sine:
    ///
    /// `h′ = z z′ + (ρ − R) ρ′`, `h″ = z′² + z z″ + ρ′² + (ρ − R) ρ″`, `ρ′ = e·e′/ρ`, `ρ″ = ((e·e′)′ − ρ′²)/ρ`.
    ///
    /// For nearly coaxial pairs all factors of these products are small, so that `h′` is accurate *relative to its
    /// own size*. To keep it so, `e·e′ = r (y₀ cos θ − c x₀ sin θ) + r² s² sin θ cos θ` is evaluated from its
    /// harmonics, except near the axis of the base, where the scalar product of the two vectors is more accurate.
    ///
    /// **Degenerate case.** On the axis (`ρ = 0`) `h` has an upward kink, possibly a maximum but never a minimum;
    /// `ρ′ = ρ″ = 0` are used.
    #[inline]
    pub fn sample(&self, cos: f64, sin: f64) -> Sample {
        let [x0, y0, z0] = self.offset;
        let (r, c, s) = (self.radius, self.tilt_cos, self.tilt_sin);
        // Position, height and ρ.
        let e = [x0 + r * c * cos, y0 + r * sin];
        let z = z0 + r * s * cos;
        let (z1, z2) = (-r * s * sin, -r * s * cos);
        let rho = (e[0] * e[0] + e[1] * e[1]).sqrt();
        // e·e′ and its derivative.
        let ee1 = if rho < self.direct_product_below {
            r * (e[1] * cos - e[0] * c * sin)
        } else {
            r * (y0 * cos - c * x0 * sin) + (r * s) * (r * s) * sin * cos
        };
        let ee2 = -r * (y0 * sin + c * x0 * cos) + (r * s) * (r * s) * (cos - sin) * (cos + sin);
        // Derivatives of ρ.
        let inverse = if rho > 0.0 { 1.0 / rho } else { 0.0 };
        let rho1 = ee1 * inverse;
        let rho2 = (ee2 - rho1 * rho1) * inverse;
        let radial = rho - self.base_radius;
        Sample {
            z,
            z1,
            z2,
            rho,
            radial,
            e,
            ee: [ee1, ee2],
            slope: z * z1 + radial * rho1,
            curvature: z1 * z1 + z * z2 + rho1 * rho1 + radial * rho2,
        }
    }

    /// The six numbers, for the fast method.
    pub fn normalized(&self) -> NormalizedPair<f64> {
        NormalizedPair::new(self.base_radius, self.radius, self.offset, self.tilt_cos, self.tilt_sin)
    }

    /// [`Self::sample`] at an angle in radians.
    pub fn sample_at_angle(&self, angle_rad: f64) -> Sample {
        let (sin, cos) = angle_rad.sin_cos();
        self.sample(cos, sin)
    }

    /// The angle of `θ = 0` in the moving circle's own frame, in radians.
    pub fn moving_frame_angle_rad(&self) -> f64 {
        self.moving.direction_angle_rad(&self.steepest)
    }

    /// The amplitude `r |(c x₀ + s z₀, y₀)|` of `w·w′ = ½ (|w|²)′`, `w = P − c_base`, which is a harmonic of degree
    /// one.
    pub fn half_distance_sq_amplitude(&self) -> f64 {
        let [x0, y0, z0] = self.offset;
        self.radius * (self.tilt_cos * x0 + self.tilt_sin * z0).hypot(y0)
    }

    /// The special position of the pair, up to [`ROUNDING`]. Never [`PairKind::Equidistant`]: that shows only along
    /// the circle.
    pub fn kind(&self) -> PairKind {
        let [x0, y0, z0] = self.offset.map(f64::abs);
        let parallel = self.tilt_sin <= ROUNDING;
        if parallel && x0.max(y0) <= ROUNDING {
            PairKind::Coaxial
        } else if parallel && z0 <= ROUNDING {
            PairKind::Coplanar
        } else if x0.max(y0).max(z0) <= ROUNDING {
            PairKind::Concentric
        } else {
            PairKind::Generic
        }
    }

    /// `g_θθ = |P′|² + (P − A)·P″`, the second derivative of half the squared distance from the foot `A` held fixed.
    ///
    /// Accurate on the axis of the base too, where `h″` is not. Non-negative at minima.
    pub fn second_derivative_at_fixed_foot(&self, cos: f64, sin: f64, at: &Sample) -> f64 {
        let (r, foot) = (self.radius, at.foot());
        let radial = at.radial * (foot[0] * self.tilt_cos * cos + foot[1] * sin);
        r * (r - radial - at.z * self.tilt_sin * cos)
    }

    /// The distance at an angle, in the caller's unit, and the unit vectors from the centres to the two nearest
    /// points: base first, then moving circle.
    pub fn distance_and_directions(&self, cos: f64, sin: f64) -> (f64, [Vec3; 2]) {
        let sample = self.sample(cos, sin);
        let (foot, [x, y]) = (sample.foot(), self.axes);
        (self.scale * sample.distance(), [x * foot[0] + y * foot[1], self.steepest * cos + y * sin])
    }

    /// The minimum at an angle of the moving circle, in the caller's unit. The base is circle A, or B if `swapped`.
    ///
    /// With `g(α, θ) = ½ |A(α) − P(θ)|²` and `α` the angle of the foot, `g_α = 0` by construction, `g_θ = h′`,
    /// `g_αα = R ρ`, `g_αθ = −A′·P′ = −R (e × e′)/ρ`, `g_θθ = h″ + g_αθ²/g_αα = |P′|² + (P − A)·P″`.
    pub fn minimum(&self, cos: f64, sin: f64, swapped: bool) -> Minimum {
        let sample = self.sample(cos, sin);
        let Sample { rho, slope, .. } = sample;
        // Directions from the centres to the points.
        let [x, y] = self.axes;
        let foot = sample.foot();
        let base_direction = x * foot[0] + y * foot[1];
        let moving_direction = self.steepest * cos + y * sin;
        // Derivatives of g, and lengths in the caller's unit.
        let mixed = -self.base_radius * self.radius * (foot[0] * cos + foot[1] * self.tilt_cos * sin);
        let unit_sq = self.scale * self.scale;
        let distance = self.scale * sample.distance();
        let base_point = self.base.center + base_direction * self.base.radius;
        let moving_point = self.moving.center + moving_direction * self.moving.radius;
        let base = self.base_radius * rho * unit_sq;
        let moving = self.second_derivative_at_fixed_foot(cos, sin, &sample) * unit_sq;
        let (mixed, slope) = (mixed * unit_sq, slope * unit_sq);
        // Direction in B's own frame.
        let (circle_b, direction) = if swapped { (self.base, base_direction) } else { (self.moving, moving_direction) };
        let (u, v) = circle_b.frame();
        let direction_b = [direction.dot(&u), direction.dot(&v)];
        Minimum::from_base(distance, [base_point, moving_point], direction_b, slope, [base, mixed, moving], swapped)
    }

    /// The minima at these angles of the moving circle (at least one, at most `MAX_MINIMA`), sorted by distance.
    /// The base is circle A, or B if `swapped`.
    pub fn minima_at_angles(&self, angles_rad: &[f64], continuum: bool, swapped: bool) -> Minima {
        self.minima_at(angles_rad.iter().map(|&angle_rad| Direction::at(angle_rad)), continuum, swapped)
    }

    /// [`Self::minima_at_angles`] with angles given by cosine and sine.
    pub fn minima_at(
        &self,
        directions: impl ExactSizeIterator<Item = Direction>,
        continuum: bool,
        swapped: bool,
    ) -> Minima {
        let kind = match self.kind() {
            PairKind::Coaxial => PairKind::Coaxial,
            _ if continuum => PairKind::Equidistant,
            kind => kind,
        };
        let mut found: ArrayVec<_, _> =
            directions.map(|Direction { cos, sin }| self.minimum(cos, sin, swapped)).collect();
        found.sort_unstable_by(|p, q| p.distance.total_cmp(&q.distance));
        Minima { kind, continuum, found }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let normal = |x, y, z| nalgebra::UnitVector3::new_normalize(Vec3::new(x, y, z));
        let a = Circle::new(Vec3::new(0.3, -0.2, 0.1), normal(0.1, 0.4, 1.0), 1.0);
        let b = Circle::new(Vec3::new(0.9, 0.5, -0.4), normal(1.0, -0.3, 0.2), 0.8);
        let pair = PairFrame::new(&a, &b);
        let half_sq = |angle: f64| 0.5 * pair.sample_at_angle(angle).distance().powi(2);
        for i in 0..100 {
            let (angle, step) = (f64::from(i) * 0.0628, 1e-4);
            let sample = pair.sample_at_angle(angle);
            let slope = (half_sq(angle + step) - half_sq(angle - step)) / (2.0 * step);
            let curvature = (half_sq(angle + step) - 2.0 * half_sq(angle) + half_sq(angle - step)) / (step * step);
            assert!((sample.slope - slope).abs() < 1e-7, "{angle}: {} {slope}", sample.slope);
            assert!((sample.curvature - curvature).abs() < 1e-5, "{angle}: {} {curvature}", sample.curvature);
        }
    }
}
