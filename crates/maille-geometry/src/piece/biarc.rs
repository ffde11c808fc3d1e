//! Two arcs between two points with given tangents: what a span of a smooth curve is replaced by.

use super::shape::{Arc, Piece, Segment};
use crate::circle::Vec3;

/// Two pieces from `start`, which they leave along `start_tangent`, to `end`, where they arrive along `end_tangent`. They
/// have one tangent where they meet. Straight ones are segments.
///
/// With unit tangents t₀, t₁ and v = end − start, the control polygon start, start + d t₀, end − d t₁, end has a middle
/// leg of 2d: `2 (1 − t₀·t₁) d² + 2 v·(t₀ + t₁) d − v·v = 0`, and the pieces meet in its middle. Of the two roots
/// the positive one is taken (Bolton 1975, "Biarc curves", in space).
///
/// None if the points are one, a tangent is zero, or no such arcs exist: equal tangents that point back, against v.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Vec3, biarc};
///
/// // Half of a circle: two quarters.
/// let [a, b] = biarc(Vec3::x(), Vec3::y(), -Vec3::x(), -Vec3::y()).unwrap();
/// assert!((a.point(1.0) - Vec3::y()).norm() < 1e-15 && (b.point(0.0) - Vec3::y()).norm() < 1e-15);
/// assert!((a.length() + b.length() - std::f64::consts::PI).abs() < 1e-14);
/// ```
pub fn biarc(start: Vec3, start_tangent: Vec3, end: Vec3, end_tangent: Vec3) -> Option<[Piece; 2]> {
    let (t0, t1) = (start_tangent.try_normalize(0.0)?, end_tangent.try_normalize(0.0)?);
    let v = end - start;
    // a d² + 2 b d − c = 0, without cancellation for either sign of b; 1 − t₀·t₁ likewise.
    let (a, b, c) = ((t0 - t1).norm_squared(), v.dot(&(t0 + t1)), v.norm_squared());
    let root = (b * b + a * c).sqrt();
    let d = if b >= 0.0 { c / (b + root) } else { (root - b) / a };
    if !(d > 0.0 && d.is_finite()) {
        return None;
    }
    let (from, to) = (start + t0 * d, end - t1 * d);
    let (joint, along) = ((from + to) * 0.5, to - from);
    let piece = |p: Vec3, tangent: Vec3, q: Vec3| {
        let arc = Arc::from_tangent(p, tangent, q).map(Piece::Arc);
        // On one line with the tangent, and ahead: straight.
        arc.or_else(|| ((q - p).dot(&tangent) > 0.0).then(|| Segment::new(p, q).map(Piece::Segment))?)
    };
    Some([piece(start, t0, joint)?, piece(joint, along, end)?])
}
