//! The local minima of the distance between two circles: what they are, and how they are handed over.

use crate::circle::Vec3;
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
    pub(crate) fn from_base(
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
}
