//! Pairs of circles of any 14 floats.

use maille_geometry::{
    Approaches, Circle, MAX_MINIMA, Vec3, circle_distance_approaches, circle_distance_lower_bound,
    circle_distance_minima, linking_number, point_circle_distance,
};
use nalgebra::UnitVector3;

/// Distances of sound pairs are right to this part of the size.
pub(crate) const CLOSE: f64 = 1e-9;

/// Bytes as two circles: centre, normal, radius of each, little-endian; missing bytes are 0. Normals are made unit vectors as
/// a caller would, which leaves 0 or NaN of some.
pub fn circles(bytes: &[u8]) {
    let mut numbers = [0.0; 14];
    for (number, chunk) in numbers.iter_mut().zip(bytes.chunks(8)) {
        let mut eight = [0; 8];
        eight[..chunk.len()].copy_from_slice(chunk);
        *number = f64::from_le_bytes(eight);
    }
    let circle = |x: &[f64]| {
        // Squares of tiny numbers have few digits: the largest is made 1 first, as for designs.
        let normal = Vec3::new(x[3], x[4], x[5]);
        let normal = UnitVector3::new_normalize(normal / normal.amax());
        Circle { center: Vec3::new(x[0], x[1], x[2]), normal, radius: x[6] }
    };
    let (a, b) = (circle(&numbers[..7]), circle(&numbers[7..]));
    let minima = circle_distance_minima(&a, &b);
    let mut batch = [Approaches::NONE];
    circle_distance_approaches(&[(a, b)], &[f64::INFINITY], &mut batch);
    let (linking, floor) = (linking_number(&a, &b), circle_distance_lower_bound(&a, &b));
    assert!((1..=MAX_MINIMA).contains(&minima.as_slice().len()), "{minima:?}");
    let distance = minima.closest().distance;
    let between = b.center - a.center;
    if !is_sound(&a) || !is_sound(&b) || !between.iter().all(|x| x.abs() <= 1e90) {
        let batched = batch[0].as_slice().first().map(|approach| approach.distance);
        assert!(distance.is_nan() && batched.is_none_or(f64::is_nan), "{distance} and {batched:?} of no circles");
        return;
    }
    let size = between.norm().max(a.radius).max(b.radius);
    let close = CLOSE * size + 16.0 * f64::EPSILON * (a.center.norm() + b.center.norm());
    assert!(minima.as_slice().is_sorted_by(|p, q| p.distance <= q.distance), "{minima:?}");
    assert!(floor <= distance + close, "{floor} is no floor of {minima:?}");
    assert!((-1..=1).contains(&linking), "{linking}");
    for m in minima.as_slice() {
        assert!(((m.point_a - m.point_b).norm() - m.distance).abs() <= close, "{m:?}");
        assert!(point_circle_distance(&m.point_a, &a).distance <= close, "{m:?}");
        assert!(point_circle_distance(&m.point_b, &b).distance <= close, "{m:?}");
    }
    for k in 0..32 {
        let sampled = point_circle_distance(&a.point(f64::from(k) * std::f64::consts::TAU / 32.0), &b).distance;
        assert!(distance <= sampled + close, "{distance} is above {sampled}");
    }
    let batched = batch[0].as_slice().iter().map(|approach| approach.distance).fold(f64::INFINITY, f64::min);
    assert!((batched - distance).abs() <= close, "the batch has {batched}, not {distance}");
}

/// A unit normal, and a radius whose square is an ordinary number.
fn is_sound(c: &Circle) -> bool {
    (c.normal.norm() - 1.0).abs() < 1e-12 && (1e-90..=1e90).contains(&c.radius)
}
