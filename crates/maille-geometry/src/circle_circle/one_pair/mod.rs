//! All local minima of one pair: the choice between SIMD registers, the fast method in `f64` and the exhaustive
//! method.

mod simd;

use crate::circle::{Circle, Vec3, are_valid};
use crate::circle_circle::angle::Direction;
use crate::circle_circle::approach::{Approach, Approaches};
use crate::circle_circle::minimum::{Minima, Minimum, PairKind};
use crate::circle_circle::pair_frame::PairFrame;
use crate::circle_circle::{exhaustive, fast};
use arrayvec::ArrayVec;

/// Every local minimum of the distance between two circles (section 3.2), without exception.
///
/// A point runs along the circle of smaller radius (B, if they are equal) with angle θ. Half its squared distance
/// from the other circle, `h(θ) = ½ d² = ½ (z² + (ρ − R)²)` (equation 3.1.2; `z` and `ρ` are its height over the
/// plane of the other circle and its distance from the axis, `R` is the radius), is examined arc by arc: the
/// critical points on an arc are counted by Descartes' rule of signs, and the arc is bisected until the count
/// agrees with the signs of `h′` at its ends. Degenerate and nearly degenerate pairs are examined by bounds of `h‴`
/// instead. Either way no minimum is lost between samples.
///
/// **Accuracy.** Distances to about `1e-15` of the pair's largest length (radii and distance of the centres), in
/// degenerate positions too. Angles to about `1e-15` times the condition number of the 2×2 Hessian.
///
/// **Degenerate positions.**
/// - A distance that is constant up to [`ROUNDING`](crate::ROUNDING) (coaxial, Villarceau and meridian pairs, see
///   [`PairKind`]) gives one representative, with [`Minima::continuum`] set.
/// - At a point on the axis of the other circle `h` has a kink: a maximum or no extremum, hence never among the
///   minima. The meridian pair of equal circles is the exception; it is a continuum.
/// - Two minima closer than `2.4e-5` rad differ by rounding only and are merged.
///
/// **Invalid input.** If a number is not finite, a radius is not positive, a length is beyond `1e±90`, or a normal
/// is not a unit vector, a single minimum is returned in which all numbers are NaN.
///
/// **Cost.** About 0.3 µs for most pairs, no heap allocation (`cargo bench -p maille-geometry --bench pair`);
/// [`circle_distance_approaches`](crate::circle_distance_approaches) takes about a quarter of that per pair. Some
/// 100 µs for pairs within about `1e-3` of a constant distance without a common axis, where no cheap proof exists.
///
/// **Tested** on 120,000 pairs of six families against dense sampling: no minimum missed, no false one, never more
/// than two, and no distance more than `7e-16` above the sampled one.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, PairKind, Vec3, circle_distance_minima};
///
/// // Two unit circles with the same centre in perpendicular planes meet at two opposite points.
/// let a = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
/// let b = Circle::new(Vec3::zeros(), Vec3::y_axis(), 1.0);
/// let minima = circle_distance_minima(&a, &b);
/// assert_eq!((minima.kind, minima.as_slice().len()), (PairKind::Concentric, 2));
/// assert!(minima.closest().distance < 1e-15);
///
/// // On a common axis every point is a nearest one: a continuum, with one representative.
/// let c = Circle::new(Vec3::new(0.0, 0.0, 0.5), Vec3::z_axis(), 1.0);
/// let minima = circle_distance_minima(&a, &c);
/// assert!(minima.continuum && (minima.closest().distance - 0.5).abs() < 1e-15);
/// ```
pub fn circle_distance_minima(a: &Circle, b: &Circle) -> Minima {
    // Filled in place: copying it would take a noticeable part of the time.
    let mut minima = Minima { kind: PairKind::Generic, continuum: false, found: ArrayVec::new() };
    if !simd::minima(a, b, &mut minima) {
        enumerate(a, b, &mut minima);
    }
    minima
}

/// [`circle_distance_minima`] in plain `f64`, for any pair.
#[inline(never)]
fn enumerate(a: &Circle, b: &Circle, out: &mut Minima) {
    if !are_valid(a, b) {
        let nowhere = Vec3::repeat(f64::NAN);
        out.found.push(Minimum {
            distance: f64::NAN,
            point_a: nowhere,
            point_b: nowhere,
            direction_b: [f64::NAN; 2],
            gradient: [f64::NAN; 2],
            hessian: [[f64::NAN; 2]; 2],
        });
        return;
    }
    // Along the smaller circle `h` is smoother: where it comes near the axis of the other, it is far from the other
    // circle.
    let swapped = a.radius < b.radius;
    let pair = if swapped { PairFrame::new(b, a) } else { PairFrame::new(a, b) };
    *out = match fast::minima(&pair.normalized()) {
        Some((angles, count)) => pair.minima_at(angles[..count].iter().copied(), false, swapped),
        None => {
            let found = exhaustive::minima(&pair);
            pair.minima_at_angles(found.as_slice(), found.continuum, swapped)
        }
    };
}

/// The minima of one pair in the compact form of a batch, for pairs that the batch code does not handle in registers.
pub(crate) fn approaches(a: &Circle, b: &Circle) -> Approaches {
    let (mut out, mut continuum) = (Approaches::NONE, false);
    if !are_valid(a, b) {
        out.found[0] = Approach { distance: f64::NAN, direction_b: Vec3::repeat(f64::NAN) };
        out.count = 1;
        return out;
    }
    let mut add = |distance: f64, direction_b: Vec3| {
        out.found[out.count] = Approach { distance, direction_b };
        out.count += 1;
    };
    let swapped = a.radius < b.radius;
    let pair = if swapped { PairFrame::new(b, a) } else { PairFrame::new(a, b) };
    match fast::minima(&pair.normalized()) {
        Some((directions, count)) => {
            for Direction { cos, sin } in &directions[..count] {
                let (distance, [base, moving]) = pair.distance_and_directions(*cos, *sin);
                add(distance, if swapped { base } else { moving });
            }
        }
        None => {
            let minima = circle_distance_minima(a, b);
            continuum = minima.continuum;
            for minimum in minima.as_slice() {
                add(minimum.distance, (minimum.point_b - b.center) / b.radius);
            }
        }
    }
    out.continuum = continuum;
    let count = out.count;
    out.found[..count].sort_unstable_by(|p, q| p.distance.total_cmp(&q.distance));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// The results in SIMD registers and in plain `f64` agree up to rounding.
    #[test]
    fn registers_change_nothing_but_rounding() {
        let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(17);
        let mut in_registers = 0;
        for _ in 0..20_000 {
            let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
            let unit = nalgebra::UnitVector3::new_normalize;
            let a = Circle::new(Vec3::zeros(), unit(vector(1.0)), 1.0);
            let b = Circle::new(vector(1.5), unit(vector(1.0)), rng.random_range(0.3..1.5));
            let mut expected = Minima { kind: PairKind::Generic, continuum: false, found: ArrayVec::new() };
            let mut found = expected.clone();
            enumerate(&a, &b, &mut expected);
            if !simd::minima(&a, &b, &mut found) {
                continue;
            }
            in_registers += 1;
            assert_eq!((found.kind, found.found.len()), (expected.kind, expected.found.len()), "{a:?} {b:?}");
            for (p, q) in found.as_slice().iter().zip(expected.as_slice()) {
                assert!((p.distance - q.distance).abs() < 1e-13, "{p:?} {q:?}");
                // The positions, except at flat minima, where they are ill-conditioned.
                let [[aa, ab], [_, bb]] = q.hessian;
                if aa * bb - ab * ab > 1e-3 {
                    assert!((p.point_a - q.point_a).norm() < 1e-11, "{p:?} {q:?}");
                    assert!((p.point_b - q.point_b).norm() < 1e-11, "{p:?} {q:?}");
                    assert!((p.angle_b_rad() - q.angle_b_rad()).sin().abs() < 1e-11, "{p:?} {q:?}");
                    let second = p.hessian.as_flattened().iter().zip(q.hessian.as_flattened());
                    assert!(second.into_iter().all(|(x, y)| (x - y).abs() < 1e-10), "{p:?} {q:?}");
                }
            }
        }
        #[cfg(target_arch = "x86_64")]
        if pulp::x86::V3::try_new().is_some() {
            assert!(in_registers > 19_000, "{in_registers}");
        }
        let _ = in_registers;
    }
}
