//! A cheap lower bound of the distance between two circles, from bounding spheres and slabs.
//!
//! Broad-phase code uses it to discard pairs before their minima are computed.

use crate::circle::Circle;

/// A lower bound of the distance between two circles, in about 20 ns.
///
/// The largest of three bounds, with `(x)₊ = max(x, 0)`, radii `R` of A and `r` of B and `w = c_B − c_A`:
///
/// - **Spheres**: the points of B are at distances from `|w| − r` to `|w| + r` from the centre of A, those of A at
///   `R`, so `d ≥ |w| − R − r` and `d ≥ |R − r| − |w|`.
/// - **Slab of A**: B lies at heights `z₀ ± r s` over the plane of A and at `|e₀| ± r` from its axis, where `z₀`
///   and `|e₀|` are those of the centre of B and `s` is the sine of the tilt:
///   `d² ≥ (|z₀| − r s)₊² + (||e₀| − R| − r)₊²`.
/// - **Slab of B**: the same with the circles exchanged.
///
/// A margin for rounding is subtracted, so that the result never exceeds the true distance. For linked circles it
/// is 0 or close to 0.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Vec3, circle_distance_lower_bound, circle_distance_minima};
///
/// let a = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
/// let b = Circle::new(Vec3::new(3.0, 0.0, 1.0), Vec3::z_axis(), 1.0);
/// let bound = circle_distance_lower_bound(&a, &b);
/// assert!(1.4 < bound && bound <= circle_distance_minima(&a, &b).closest().distance);
/// ```
pub fn circle_distance_lower_bound(a: &Circle, b: &Circle) -> f64 {
    let between = b.center - a.center;
    let (center_distance_sq, center_distance) = (between.norm_squared(), between.norm());
    let tilt_cos = a.normal.dot(&b.normal);
    let tilt_sin = (1.0 - tilt_cos * tilt_cos).max(0.0).sqrt();
    let slab_sq = |base: &Circle, moving: &Circle| {
        let height = base.normal.dot(&between);
        let from_axis = (center_distance_sq - height * height).max(0.0).sqrt();
        let rise = (height.abs() - moving.radius * tilt_sin).max(0.0);
        let radial = ((from_axis - base.radius).abs() - moving.radius).max(0.0);
        rise * rise + radial * radial
    };
    let spheres = (center_distance - a.radius - b.radius).max((a.radius - b.radius).abs() - center_distance).max(0.0);
    let slabs = slab_sq(a, b).max(slab_sq(b, a)).sqrt();
    // Small roots of differences of squares lose half of their digits, hence the larger margin of the slabs.
    (slabs - 1e-7 * (center_distance + a.radius + b.radius))
        .max(spheres - 1e-14 * (center_distance + a.radius + b.radius))
        .max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Vec3, circle_distance_minima};
    use rand::{RngExt, SeedableRng};

    /// Never above the distance, on random, coplanar, coaxial and parallel pairs; and often more than half of it.
    #[test]
    fn stays_below_the_distance() {
        let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(11);
        let mut tight = 0;
        for k in 0..40_000 {
            let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
            let (n, mut m, mut center) = (vector(1.0).normalize(), vector(1.0).normalize(), vector(3.0));
            match k % 4 {
                0 => m = n,
                1 => (m, center) = (n, center - n * n.dot(&center)),
                2 => (m, center) = (n, n * n.dot(&center)),
                _ => {}
            }
            let unit = nalgebra::UnitVector3::new_normalize;
            let a = Circle::new(Vec3::zeros(), unit(n), 1.0);
            let b = Circle::new(center, unit(m), rng.random_range(0.1..1.5));
            let (bound, distance) =
                (circle_distance_lower_bound(&a, &b), circle_distance_minima(&a, &b).closest().distance);
            assert!(bound <= distance, "{a:?} {b:?}: {bound} {distance}");
            tight += usize::from(bound > 0.5 * distance);
        }
        assert!(tight > 20_000, "{tight}");
    }
}
