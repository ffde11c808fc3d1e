//! Linking of two circles: how often one crosses the disc of the other.
//!
//! Circle B crosses the plane of circle A at two points or none. The circles are linked if exactly one of the two
//! lies inside A. Symbols: `N_A`, `c_A`, `R_A` are normal, centre and radius of A, likewise for B; `t` is the angle
//! on B in radians.

use crate::circle::{Circle, Vec3};
use crate::tolerance::ROUNDING;

/// Distances from the centre of A to the two points where circle B crosses the plane of A, if it does: first the
/// point where B crosses downwards (against `N_A`), then the one where it crosses upwards.
///
/// The height of B over the plane is `z(t) = N_A·(P_B(t) − c_A) = k + a cos t + b sin t` with amplitude
/// `A = hypot(a, b)`. Its roots `t = atan2(b, a) ± acos(−k/A)` exist if and only if `|k| < A`. With the unit
/// vectors `m` (steepest ascent of B over the plane of A) and `h = N_B × m`, and with `κ = −k/A`, the points are
/// `c_B + R_B (κ m ± √(1 − κ²) h)`, which takes no trigonometric function; `+` is the downward crossing,
/// `z′ = −A √(1 − κ²)`.
///
/// `None` if the planes are parallel to [`ROUNDING`], or if B lies on one side of the plane or touches it.
fn plane_crossings(a: &Circle, b: &Circle) -> Option<[f64; 2]> {
    let offset = b.center - a.center;
    let k = a.normal.dot(&offset);
    let rise = *a.normal - *b.normal * a.normal.dot(&b.normal);
    let tilt_sin = a.normal.cross(&b.normal).norm();
    let amplitude = b.radius * tilt_sin;
    if tilt_sin <= ROUNDING || k.abs() >= amplitude {
        return None;
    }
    // At small tilts the rounding error of `rise` is relatively large: project once more, to stay in the plane of B.
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
/// It counts how often B crosses the disc of A in the direction of `N_A`, minus how often it crosses in the opposite
/// direction, and equals the Gauss integral `1/4π ∮∮ (A − B)·(dA × dB)/|A − B|³`. It is symmetric,
/// `lk(A, B) = lk(B, A)`, and reversing one normal changes its sign.
///
/// **Degenerate cases.** Parallel planes give 0. Circles that intersect have no linking number; the result is 0 if
/// the intersection is exact in `f64`.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Vec3, linking_number};
///
/// let a = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
/// let b = Circle::new(Vec3::new(1.0, 0.0, 0.0), Vec3::y_axis(), 0.5);
/// let reversed = Circle::new(b.center, -b.normal, b.radius);
/// assert_eq!((linking_number(&a, &b), linking_number(&a, &reversed)), (1, -1));
/// ```
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

/// Whether two circles interlock: B crosses the plane of A at two points, one inside A and one outside (Definition
/// 3.4.2).
///
/// The relation is symmetric and equivalent to a linking number of ±1, with the degenerate cases of
/// [`linking_number`].
pub fn interlocks(a: &Circle, b: &Circle) -> bool {
    plane_crossings(a, b).is_some_and(|[p, q]| p.min(q) < a.radius && a.radius < p.max(q))
}
