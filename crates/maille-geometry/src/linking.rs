//! Are two circles linked, and in which sense?

use crate::circle::{Circle, Vec3};
use crate::tolerance::ROUNDING;

/// Where circle B crosses the plane of circle A, if it does: at `t = atan2(b, a) ± acos(−k/A)`, the roots of
///
/// `z(t) = N_A·(P_B(t) − c_A) = k + a cos t + b sin t`, `A = hypot(a, b)`, which exist if and only if `|k| < A`.
///
/// With the unit vectors `m` (steepest rise of B over the plane of A) and `h = N_B × m` the two points are
/// `c_B + R_B (κ m ± √(1 − κ²) h)`, `κ = −k/A`, without a trigonometric function. Returned are their distances from
/// the centre of A, first that of `+`, where B goes down through the plane (`z′ = −A √(1 − κ²)`), then that of `−`,
/// where it comes up.
///
/// None for planes that are parallel to [`ROUNDING`], for circles apart from the plane and for those that touch it.
fn plane_crossings(a: &Circle, b: &Circle) -> Option<[f64; 2]> {
    let offset = b.center - a.center;
    let k = a.normal.dot(&offset);
    let rise = *a.normal - *b.normal * a.normal.dot(&b.normal);
    let tilt_sin = a.normal.cross(&b.normal).norm();
    let amplitude = b.radius * tilt_sin;
    if tilt_sin <= ROUNDING || k.abs() >= amplitude {
        return None;
    }
    // At small tilts the rounding of `rise` is a large part of it: project once more, to stay in the plane of B.
    let m = rise / tilt_sin;
    let m = (m - *b.normal * b.normal.dot(&m)).normalize();
    let h = b.normal.cross(&m);
    let along = -k / amplitude;
    let across = ((1.0 - along) * (1.0 + along)).sqrt();
    let distance = |side: f64| {
        let e: Vec3 = offset + (m * along + h * (side * across)) * b.radius;
        (e - *a.normal * a.normal.dot(&e)).norm()
    };
    Some([distance(1.0), distance(-1.0)])
}

/// The linking number of two circles, each oriented counter-clockwise about its normal: −1, 0 or 1.
///
/// It is the number of times B crosses the disc of A in the direction of `N_A`, less the number of times it crosses
/// against it, and equals the Gauss integral `1/4π ∮∮ (A − B)·(dA × dB)/|A − B|³`. Symmetric, `lk(A, B) = lk(B, A)`;
/// turning one normal round changes the sign.
///
/// Circles that meet have no linking number; they give 0 when the meeting is exact in doubles. Parallel planes give 0.
pub fn linking_number(a: &Circle, b: &Circle) -> i32 {
    let Some([down, up]) = plane_crossings(a, b) else { return 0 };
    if up < a.radius && a.radius < down {
        1
    } else if down < a.radius && a.radius < up {
        -1
    } else {
        0
    }
}

/// Do the circles interlock? B has two points in the plane of A, one nearer to the centre of A than `R_A`, the other
/// farther (Definition 3.4.2). The relation is symmetric, and equivalent to a linking number of ±1.
pub fn interlocks(a: &Circle, b: &Circle) -> bool {
    plane_crossings(a, b).is_some_and(|[p, q]| p.min(q) < a.radius && a.radius < p.max(q))
}
