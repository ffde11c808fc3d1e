//! The result types: one local minimum of the distance between two circles, and all minima of a pair.
//!
//! Symbols: angles `α` on circle A and `β` on circle B (radians), half the squared distance
//! `g(α, β) = ½ |A(α) − B(β)|²` (length²).

use crate::circle::Vec3;
use arrayvec::ArrayVec;

/// The largest number of minima stored for a pair.
///
/// There are at most three isolated minima (proof in `circle_circle/fast/root_count.rs`), and no more than two have
/// been observed in millions of pairs. The fourth place is a reserve for nearly constant distances, where rounding
/// can create more.
pub const MAX_MINIMA: usize = 4;

/// Special positions of a pair of circles, each up to [`ROUNDING`](crate::ROUNDING).
///
/// For diagnostics and tests: the computed minima do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairKind {
    /// None of the following.
    Generic,
    /// A common axis, hence parallel planes: the distance is constant. Includes circles in one plane with the same
    /// centre.
    Coaxial,
    /// One plane, different centres: nested, touching, crossing (two minima, both 0) or apart.
    Coplanar,
    /// The same centre, different planes: the two minima are diametrically opposite.
    Concentric,
    /// A constant distance without a common axis. Either a **meridian** pair: one circle is centred on a point of
    /// the other, lies in the normal plane there, and is not larger. Or a **Villarceau** pair: equal radii `R`,
    /// distance `ϱ`, centres `ϱ` apart along the line common to both planes, which are tilted by `asin(ϱ/R)`.
    Equidistant,
}

/// A local minimum of the distance between circle A and circle B.
///
/// `gradient` and `hessian` are those of half the squared distance, `g(α, β) = ½ |A(α) − B(β)|²`, in the angles `α`
/// on A and `β` on B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// The distance (length), accurate to about `1e-15` of the largest of the radii and the distance of the centres.
    pub distance: f64,
    /// The point on circle A.
    pub point_a: Vec3,
    /// The point on circle B.
    pub point_b: Vec3,
    /// Cosine and sine of the angle of `point_b` in the [frame](crate::Circle::frame) of B.
    pub direction_b: [f64; 2],
    /// `(g_α, g_β)`, length². Zero up to the rounding of the angle: the residual of the search.
    pub gradient: [f64; 2],
    /// `((g_αα, g_αβ), (g_αβ, g_ββ))`, length². Positive semidefinite; singular where minima merge, on continua,
    /// and where a point of one circle lies on the axis of the other.
    pub hessian: [[f64; 2]; 2],
}

impl Minimum {
    /// The angle of `point_b` in the [frame](crate::Circle::frame) of B, in `(−π, π]`.
    pub fn angle_b_rad(&self) -> f64 {
        let [cos, sin] = self.direction_b;
        sin.atan2(cos)
    }

    /// From the points on the base and the moving circle, `slope = g_θ` and `g_αα, g_αθ, g_θθ`, where here `α` is
    /// the angle on the base and `θ` that on the moving circle. The base is circle A, or B if `swapped`.
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

/// All local minima of the distance between two circles, in ascending order: at least one, at most [`MAX_MINIMA`].
#[derive(Clone, Debug)]
pub struct Minima {
    /// The special position of the pair, if any.
    pub kind: PairKind,
    /// Whether the distance is constant along a whole circle, up to [`ROUNDING`](crate::ROUNDING). The minima are
    /// then not isolated, and one representative is returned.
    pub continuum: bool,
    pub(crate) found: ArrayVec<Minimum, MAX_MINIMA>,
}

impl Minima {
    /// The minima, in ascending order of distance.
    pub fn as_slice(&self) -> &[Minimum] {
        &self.found
    }

    /// The minimum with the smallest distance, which is the distance of the circles.
    pub fn closest(&self) -> &Minimum {
        &self.found[0]
    }

    /// The distances, in ascending order.
    pub(crate) fn into_distances(self) -> impl ExactSizeIterator<Item = f64> {
        self.found.into_iter().map(|minimum| minimum.distance)
    }
}
