//! The local minima of the distance between two circles: what they are, and how they are handed over.

use crate::circle::are_sound;
use crate::grid::Direction;
use crate::relative::Relative;
use crate::{Circle, Vec3, quick, search, single};
use arrayvec::ArrayVec;

/// The most minima that are kept of a pair.
///
/// Isolated ones are at most three (see the `count` module), and more than two have never been observed, over millions of
/// pairs; the fourth place is for what rounding makes of nearly constant distances.
pub const MAX_MINIMA: usize = 4;

/// Special positions of a pair of circles, each met within [`ROUNDING`](crate::ROUNDING).
///
/// A report for people and tests: the answers do not branch on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairKind {
    /// None of the following.
    Generic,
    /// A common axis, so parallel planes: the distance is constant. Includes circles around one centre in one plane.
    Coaxial,
    /// One plane, different centres: nested, touching, crossing (two minima, both 0) or apart.
    Coplanar,
    /// One centre, different planes: the two minima lie opposite each other.
    Concentric,
    /// A constant distance without a common axis. Either a meridian (one circle goes round a point of the other, in its
    /// normal plane there, with a radius that is not larger), or a **Villarceau** pair: equal radii `R`, distance `ϱ`,
    /// centres `ϱ` apart along a line in both planes, which are tilted by `asin(ϱ/R)`.
    Equidistant,
}

/// A local minimum of the distance between circle A and circle B.
///
/// With `g(α, β) = ½ |A(α) − B(β)|²` in the two angles; `gradient` and `hessian` are those of `g`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// The distance, right to rounding: about `1e-15` of the largest of the radii and the distance of the centres.
    pub distance: f64,
    /// The point on circle A.
    pub point_a: Vec3,
    /// The point on circle B.
    pub point_b: Vec3,
    /// Cosine and sine of the angle of `point_b` in the [frame](Circle::frame) of B.
    pub direction_b: [f64; 2],
    /// `(g_α, g_β)`, length². Zero but for the rounding of the angle: the residual of the search.
    pub gradient: [f64; 2],
    /// `((g_αα, g_αβ), (g_αβ, g_ββ))`, length². Positive semidefinite; singular where minima merge, for continua, and
    /// where a point of one circle lies on the axis of the other.
    pub hessian: [[f64; 2]; 2],
}

impl Minimum {
    /// The angle of `point_b` in the [frame](Circle::frame) of B, in `(−π, π]`.
    pub fn angle_b_rad(&self) -> f64 {
        let [cos, sin] = self.direction_b;
        sin.atan2(cos)
    }

    /// From the points on the base and on the moving circle, `g_αα, g_αθ, g_θθ` with α the angle on the base, and `g_θ`. The base is
    /// circle A, or B if `swapped`.
    #[inline(always)]
    pub(crate) fn of_base(
        distance: f64,
        [base_point, moving_point]: [Vec3; 2],
        direction_b: [f64; 2],
        slope: f64,
        [base, mixed, moving]: [f64; 3],
        swapped: bool,
    ) -> Self {
        if swapped {
            let (gradient, hessian) = ([slope, 0.0], [[moving, mixed], [mixed, base]]);
            return Minimum { distance, point_a: moving_point, point_b: base_point, direction_b, gradient, hessian };
        }
        let (gradient, hessian) = ([0.0, slope], [[base, mixed], [mixed, moving]]);
        Minimum { distance, point_a: base_point, point_b: moving_point, direction_b, gradient, hessian }
    }
}

/// All local minima of the distance between two circles, ascending; at least one, at most [`MAX_MINIMA`].
#[derive(Clone, Debug)]
pub struct Minima {
    /// The special position of the pair, if any.
    pub kind: PairKind,
    /// The distance is constant along a whole circle, to [`ROUNDING`](crate::ROUNDING): the minima are not isolated, and one
    /// representative is given.
    pub continuum: bool,
    pub(crate) found: ArrayVec<Minimum, MAX_MINIMA>,
}

impl Minima {
    /// The minima, in ascending order of distance.
    pub fn as_slice(&self) -> &[Minimum] {
        &self.found
    }

    /// The minimum of smallest distance, which is the distance of the circles.
    pub fn closest(&self) -> &Minimum {
        &self.found[0]
    }

    /// The distances alone.
    pub(crate) fn into_distances(self) -> impl ExactSizeIterator<Item = f64> {
        self.found.into_iter().map(|minimum| minimum.distance)
    }

    /// The minima at these angles of the moving circle (at least one, at most [`MAX_MINIMA`]), put in order.
    /// `swapped` says that the moving circle is A.
    pub(crate) fn at_angles(pair: &Relative<'_>, angles_rad: &[f64], continuum: bool, swapped: bool) -> Self {
        Self::at(pair, angles_rad.iter().map(|&angle_rad| Direction::at(angle_rad)), continuum, swapped)
    }

    /// [`Self::at_angles`] by cosines and sines.
    pub(crate) fn at(
        pair: &Relative<'_>,
        directions: impl ExactSizeIterator<Item = Direction>,
        continuum: bool,
        swapped: bool,
    ) -> Self {
        let kind = match pair.kind() {
            PairKind::Coaxial => PairKind::Coaxial,
            _ if continuum => PairKind::Equidistant,
            kind => kind,
        };
        let mut found: ArrayVec<_, _> =
            directions.map(|Direction { cos, sin }| pair.minimum(cos, sin, swapped)).collect();
        found.sort_unstable_by(|p, q| p.distance.total_cmp(&q.distance));
        Self { kind, continuum, found }
    }
}

/// Every local minimum of the distance between two circles (section 3.2), by complete enumeration.
///
/// The circle of smaller radius (B, if they are equal) is followed by its angle θ, and `h(θ) = ½ d²`, half the squared
/// distance of its point from the other circle (equation 3.1.2), is examined arc by arc: the critical points on an arc are
/// counted, and the arc is halved where the count and the signs of `h′` at the ends do not agree (the `count` module). Pairs
/// that are degenerate or nearly so are examined by bounds of `h‴` (the `search` module). Either way no minimum is lost
/// between samples.
///
/// **Accuracy.** Distances to about `1e-15` of the pair's largest length, in every position, degenerate or near to
/// it. Angles to about `1e-15` over the condition of the 2×2 Hessian.
///
/// **Degenerate positions.** A distance that is constant to [`ROUNDING`](crate::ROUNDING) (coaxial, Villarceau and meridian pairs, see
/// [`PairKind`]) gives one representative with `continuum` set. A point on the other circle's axis, where `h` has a
/// kink, is a maximum or no extremum and never among the answers, except for equal circles' meridian, a continuum.
/// Two minima closer than `2.4e-5` rad, which differ by rounding only, are one.
///
/// **Wrong input.** Where a number is not finite, a radius is not positive, a length is beyond `1e±90`, or a normal is no unit
/// vector, there is one minimum, and all its numbers are NaN.
///
/// **Cost.** No heap; times are those of `cargo bench -p maille-geometry --bench pair`, some in the repository's
/// `docs/decisions/0010-batch-kernel.md`; [`circle_distance_approaches`](crate::circle_distance_approaches) takes many pairs
/// at a quarter of it. Pairs that are close to an equidistant one without a common axis (within
/// about `1e-3`), where nothing can be proven cheaply, some 100 µs.
///
/// **Tested** on 120,000 pairs of six families against dense sampling: no minimum missed, none too many, never more than
/// two, and no distance more than `7e-16` above the sampled one.
pub fn circle_distance_minima(a: &Circle, b: &Circle) -> Minima {
    // Written where it is returned: it is too large to be moved about.
    let mut minima = Minima { kind: PairKind::Generic, continuum: false, found: ArrayVec::new() };
    if !single::minima(a, b, &mut minima) {
        enumerate(a, b, &mut minima);
    }
    minima
}

/// [`circle_distance_minima`] without registers, for every pair.
#[inline(never)]
fn enumerate(a: &Circle, b: &Circle, out: &mut Minima) {
    if !are_sound(a, b) {
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
    // Along the smaller circle `h` is the smoother: it comes near the other's axis only far from the other circle.
    let swapped = a.radius < b.radius;
    let pair = if swapped { Relative::new(b, a) } else { Relative::new(a, b) };
    *out = match quick::minima(&pair.reduced()) {
        Some((angles, count)) => Minima::at(&pair, angles[..count].iter().copied(), false, swapped),
        None => {
            let found = search::minima(&pair);
            Minima::at_angles(&pair, found.as_slice(), found.continuum, swapped)
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// What a machine without registers finds is the same, to rounding.
    #[test]
    fn registers_change_nothing_but_rounding() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(17);
        let mut in_registers = 0;
        for _ in 0..20_000 {
            let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
            let unit = nalgebra::UnitVector3::new_normalize;
            let a = Circle::new(Vec3::zeros(), unit(vector(1.0)), 1.0);
            let b = Circle::new(vector(1.5), unit(vector(1.0)), rng.random_range(0.3..1.5));
            let mut expected = Minima { kind: PairKind::Generic, continuum: false, found: ArrayVec::new() };
            let mut found = expected.clone();
            enumerate(&a, &b, &mut expected);
            if !single::minima(&a, &b, &mut found) {
                continue;
            }
            in_registers += 1;
            assert_eq!((found.kind, found.found.len()), (expected.kind, expected.found.len()), "{a:?} {b:?}");
            for (p, q) in found.as_slice().iter().zip(expected.as_slice()) {
                assert!((p.distance - q.distance).abs() < 1e-13, "{p:?} {q:?}");
                // Where the minimum is, flat ones excepted: there the distance says little about the place.
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
