//! A quick lower bound of the distance between two circles.

use crate::circle::Circle;

/// A distance that no point of one circle comes nearer than to the other: what spheres and slabs show in some 20 ns.
///
/// From the middle of A every point of B is between |w| − r and |w| + r away (w between the centres), and A's points
/// are R away. Over A's plane the points of B are at heights z₀ ± r s (s the sine of the tilt), and at |e₀| ± r from
/// A's axis; so d² ≥ (|z₀| − r s)₊² + (||e₀| − R| − r)₊². The same with the circles exchanged. The largest counts, less
/// what rounding could add. Linked circles get 0, or near it.
pub fn circle_distance_lower_bound(a: &Circle, b: &Circle) -> f64 {
    let between = b.center - a.center;
    let (apart_sq, apart) = (between.norm_squared(), between.norm());
    let tilt_cos = a.normal.dot(&b.normal);
    let tilt_sin = (1.0 - tilt_cos * tilt_cos).max(0.0).sqrt();
    let over = |base: &Circle, moving: &Circle| {
        let height = base.normal.dot(&between);
        let from_axis = (apart_sq - height * height).max(0.0).sqrt();
        let rise = (height.abs() - moving.radius * tilt_sin).max(0.0);
        let radial = ((from_axis - base.radius).abs() - moving.radius).max(0.0);
        rise * rise + radial * radial
    };
    let spheres = (apart - a.radius - b.radius).max((a.radius - b.radius).abs() - apart).max(0.0);
    let slabs = over(a, b).max(over(b, a)).sqrt();
    // Roots of differences of squares lose half of the digits where they are small.
    (slabs - 1e-7 * (apart + a.radius + b.radius)).max(spheres - 1e-14 * (apart + a.radius + b.radius)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Vec3, circle_distance_minima};
    use rand::{RngExt, SeedableRng};

    /// Never above the distance, on random pairs and on coplanar, coaxial and parallel ones; and often of use.
    #[test]
    fn stays_below_the_distance() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(11);
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
            let (floor, distance) =
                (circle_distance_lower_bound(&a, &b), circle_distance_minima(&a, &b).closest().distance);
            assert!(floor <= distance, "{a:?} {b:?}: {floor} {distance}");
            tight += usize::from(floor > 0.5 * distance);
        }
        assert!(tight > 20_000, "{tight}");
    }
}
