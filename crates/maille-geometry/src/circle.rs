//! A circle in space, and the distance of a point from it.

use crate::tolerance::{MAX_LENGTH, MIN_LENGTH};
use nalgebra::UnitVector3;

/// A vector or point in space.
pub type Vec3 = nalgebra::Vector3<f64>;

/// A circle in space, oriented: it runs counter-clockwise when its normal points at the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre `c`.
    pub center: Vec3,
    /// Unit normal `N` of its plane.
    pub normal: UnitVector3<f64>,
    /// Radius `R`, positive.
    pub radius: f64,
}

/// Whether the numbers of two circles are such that distances can be found: finite but for the place of both together.
pub(crate) fn are_valid(a: &Circle, b: &Circle) -> bool {
    let sized =
        |c: &Circle| (MIN_LENGTH..=MAX_LENGTH).contains(&c.radius) && (c.normal.norm_squared() - 1.0).abs() < 1e-6;
    sized(a) && sized(b) && (b.center - a.center).iter().all(|x| x.abs() <= MAX_LENGTH)
}

impl Circle {
    /// The circle with this centre, normal and radius (positive and finite, asserted in debug builds).
    pub fn new(center: Vec3, normal: UnitVector3<f64>, radius: f64) -> Self {
        debug_assert!(radius > 0.0 && radius.is_finite(), "the radius of a circle must be positive, not {radius}");
        Self { center, normal, radius }
    }

    /// Unit vectors `(U, V)` in the circle's plane with `U × V = N`; every angle on the circle is measured in them.
    ///
    /// They depend on `N` alone and are orthonormal to rounding (Duff et al. 2017, "Building an Orthonormal BernsteinBasis,
    /// Revisited"): `N = e_z` gives `(e_x, e_y)`. No continuous choice exists; this one jumps where `N_z` changes sign.
    pub fn frame(&self) -> (Vec3, Vec3) {
        let n = &self.normal;
        let sign = 1.0_f64.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
    }

    /// The point `P(θ) = c + R (cos θ U + sin θ V)` (equation 3.2.1).
    pub fn point(&self, angle_rad: f64) -> Vec3 {
        let (u, v) = self.frame();
        let (sin, cos) = angle_rad.sin_cos();
        self.center + (u * cos + v * sin) * self.radius
    }

    /// The angle in `(−π, π]` of the point of the circle nearest to `p`; 0 for points on the axis, which have no
    /// nearest point.
    pub fn angle_rad(&self, p: &Vec3) -> f64 {
        self.direction_angle_rad(&(p - self.center))
    }

    /// The angle of the projection of a direction on the circle's plane.
    pub(crate) fn direction_angle_rad(&self, direction: &Vec3) -> f64 {
        let (u, v) = self.frame();
        direction.dot(&v).atan2(direction.dot(&u))
    }
}

/// The point of a circle nearest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointOnCircle {
    /// Distance from the given point.
    pub distance: f64,
    /// The nearest point `K`.
    pub point: Vec3,
    /// Its angle in the circle's [frame](Circle::frame), in `(−π, π]`.
    pub angle_rad: f64,
    /// The given point lies exactly on the axis: every point of the circle is equally near, the one at angle 0 is given.
    pub on_axis: bool,
}

/// The distance of the point `P` from the circle (equation 3.1.2),
///
/// `d² = z² + (ρ − R)²`, `z = N·Δ`, `ρ = |Δ − zN|`, `Δ = P − c`, with the nearest point `K = c + R (Δ − zN)/ρ`.
///
/// Evaluated as `hypot(z, ρ − R)`: the expanded form `|Δ|² + R² − 2Rρ` loses half of the digits near the circle.
/// On the axis (`ρ = 0`) the distance is right and `K` is a representative, see [`PointOnCircle::on_axis`].
pub fn point_circle_distance(p: &Vec3, circle: &Circle) -> PointOnCircle {
    let delta = p - circle.center;
    let z = circle.normal.dot(&delta);
    let (u, v) = circle.frame();
    let (x, y) = (delta.dot(&u), delta.dot(&v));
    let rho = x.hypot(y);
    let on_axis = rho == 0.0;
    let radial = if on_axis { u } else { u * (x / rho) + v * (y / rho) };
    PointOnCircle {
        distance: z.hypot(rho - circle.radius),
        point: circle.center + radial * circle.radius,
        angle_rad: y.atan2(x),
        on_axis,
    }
}
