//! A circle in space, and its distance from a point.
//!
//! Symbols: centre `c`, unit normal `N`, radius `R` (lengths in the caller's unit), angle `θ` on the circle in
//! radians.

use crate::tolerance::{MAX_LENGTH, MIN_LENGTH};
use nalgebra::UnitVector3;

/// A vector or point in space.
pub type Vec3 = nalgebra::Vector3<f64>;

/// An oriented circle in space.
///
/// Seen from the side to which its normal points, it runs counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre `c` (length).
    pub center: Vec3,
    /// Unit normal `N` of its plane.
    pub normal: UnitVector3<f64>,
    /// Radius `R` (length), positive and finite.
    pub radius: f64,
}

/// Are radii, normals and the difference of the centres finite and within the accepted range?
///
/// Only the relative position is checked: the pair may lie anywhere.
pub(crate) fn are_valid(a: &Circle, b: &Circle) -> bool {
    let has_valid_size =
        |c: &Circle| (MIN_LENGTH..=MAX_LENGTH).contains(&c.radius) && (c.normal.norm_squared() - 1.0).abs() < 1e-6;
    has_valid_size(a) && has_valid_size(b) && (b.center - a.center).iter().all(|x| x.abs() <= MAX_LENGTH)
}

impl Circle {
    /// The circle with this centre, unit normal and radius.
    ///
    /// # Panics
    ///
    /// In debug builds, if the radius is not positive and finite.
    ///
    /// # Examples
    ///
    /// ```
    /// use maille_geometry::{Circle, Vec3};
    ///
    /// let circle = Circle::new(Vec3::new(1.0, 0.0, 0.0), Vec3::z_axis(), 2.0);
    /// assert_eq!(circle.point(0.0), Vec3::new(3.0, 0.0, 0.0));
    /// ```
    pub fn new(center: Vec3, normal: UnitVector3<f64>, radius: f64) -> Self {
        debug_assert!(radius > 0.0 && radius.is_finite(), "the radius of a circle must be positive, not {radius}");
        Self { center, normal, radius }
    }

    /// Unit vectors `(U, V)` in the circle's plane with `U × V = N`. Angles on the circle are measured from `U`
    /// towards `V`.
    ///
    /// They depend on `N` alone and are orthonormal to rounding (Duff et al. 2017, "Building an Orthonormal Basis,
    /// Revisited"); `N = e_z` gives `(e_x, e_y)`. No choice is continuous on the whole sphere: this one jumps where
    /// `N_z` changes sign.
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

    /// The angle, in `(−π, π]`, of the point of the circle nearest to `p`.
    ///
    /// Points on the axis have no unique nearest point and give 0.
    pub fn angle_rad(&self, p: &Vec3) -> f64 {
        self.direction_angle_rad(&(p - self.center))
    }

    /// The angle of a direction after projection onto the circle's plane, in `(−π, π]`.
    pub(crate) fn direction_angle_rad(&self, direction: &Vec3) -> f64 {
        let (u, v) = self.frame();
        direction.dot(&v).atan2(direction.dot(&u))
    }
}

/// The point of a circle nearest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointOnCircle {
    /// Distance from the given point (length).
    pub distance: f64,
    /// The nearest point `K`.
    pub point: Vec3,
    /// Its angle in the circle's [frame](Circle::frame), in `(−π, π]`.
    pub angle_rad: f64,
    /// Whether the given point lies exactly on the axis. All points of the circle are then equally near; the one at
    /// angle 0 is returned.
    pub on_axis: bool,
}

/// The distance of a point `P` from a circle, and the nearest point of the circle (equation 3.1.2).
///
/// `d² = z² + (ρ − R)²` with `Δ = P − c`, height over the plane `z = N·Δ` and distance from the axis
/// `ρ = |Δ − zN|`. The nearest point is `K = c + R (Δ − zN)/ρ`.
///
/// Evaluated as `hypot(z, ρ − R)`: the expanded form `|Δ|² + R² − 2Rρ` loses half of the digits near the circle.
///
/// **Degenerate case.** On the axis (`ρ = 0`) the distance is exact and `K` is one of many nearest points, see
/// [`PointOnCircle::on_axis`].
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Vec3, point_circle_distance};
///
/// let circle = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
/// let nearest = point_circle_distance(&Vec3::new(4.0, 0.0, 4.0), &circle);
/// assert_eq!(nearest.distance, 5.0);
/// assert_eq!(nearest.point, Vec3::new(1.0, 0.0, 0.0));
/// ```
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
