//! The common frame of a pair, computed on SIMD registers: one pair per lane, or one pair in all lanes.
//!
//! The counterpart of `pair_frame.rs` for the fast method. Pairs that it cannot treat accurately are reported by
//! [`PairFrames::is_regular`].

use crate::circle::{Circle, Vec3};
use crate::circle_circle::angle::Angle;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::{Register, SimdReal};
use crate::tolerance::{MAX_LENGTH, MIN_LENGTH};
use pulp::Simd;

/// Three coordinates; the functions below are vector algebra on them.
pub(crate) type Vector<T> = [T; 3];

/// `p − q`.
#[inline(always)]
pub(crate) fn sub<T: SimdReal>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

/// `p·q`.
#[inline(always)]
pub(crate) fn dot<T: SimdReal>(p: Vector<T>, q: Vector<T>) -> T {
    p[0].mul_add(q[0], p[1].mul_add(q[1], p[2] * q[2]))
}

/// `p × q`.
#[inline(always)]
fn cross<T: SimdReal>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[2].neg_mul_add(q[1], p[1] * q[2]), p[0].neg_mul_add(q[2], p[2] * q[0]), p[1].neg_mul_add(q[0], p[0] * q[1])]
}

/// `a p + b q`.
#[inline(always)]
pub(crate) fn linear_combination<T: SimdReal>(p: Vector<T>, a: T, q: Vector<T>, b: T) -> Vector<T> {
    [p[0].mul_add(a, q[0] * b), p[1].mul_add(a, q[1] * b), p[2].mul_add(a, q[2] * b)]
}

/// `yes` where the mask is true, `no` elsewhere.
#[inline(always)]
fn select_vector<T: SimdReal>(mask: T::Mask, yes: Vector<T>, no: Vector<T>) -> Vector<T> {
    [T::select(mask, yes[0], no[0]), T::select(mask, yes[1], no[1]), T::select(mask, yes[2], no[2])]
}

/// Pairs of circles as given: one per lane, lengths in the caller's unit.
pub(crate) struct PairVectors<T> {
    /// From the centre of A to the centre of B.
    pub between: Vector<T>,
    /// Unit normals of A and B.
    pub normals: [Vector<T>; 2],
    /// Radii of A and B.
    pub radii: [T; 2],
}

impl<S: Simd> PairVectors<Register<S>> {
    /// The same pair in every lane.
    #[inline(always)]
    pub fn broadcast(simd: S, a: &Circle, b: &Circle) -> Self {
        let between = b.center - a.center;
        PairVectors {
            between: broadcast_vector(simd, &between),
            normals: [broadcast_vector(simd, &a.normal), broadcast_vector(simd, &b.normal)],
            radii: [Register::broadcast(simd, a.radius), Register::broadcast(simd, b.radius)],
        }
    }
}

/// The same vector in every lane.
#[inline(always)]
pub(crate) fn broadcast_vector<S: Simd>(simd: S, v: &Vec3) -> Vector<Register<S>> {
    [Register::broadcast(simd, v.x), Register::broadcast(simd, v.y), Register::broadcast(simd, v.z)]
}

/// Margin for rounding, relative to the sum of the squares in a comparison.
const ROUNDING_MARGIN: f64 = 1e-14;
/// If the sine of the angle between the planes is smaller, the pair is left to the `f64` code.
const MIN_TILT_SIN: f64 = 1e-7;

/// If the squared sine is smaller, the cross product of the normals is projected once more, as in `PairFrame::new`.
const REPROJECT_SIN_SQ: f64 = 1e-2;

impl<T: SimdReal> PairVectors<T> {
    /// Are the circles certainly more than `reach` apart?
    ///
    /// The bounds of `lower_bound.rs`, compared as squares to avoid roots: the bounding spheres are too far apart,
    /// or one circle lies too high above the plane of the other, or too far inside the cylinder through it.
    #[inline(always)]
    pub fn is_beyond(&self, reach: T) -> T::Mask {
        let (zero, [a, b]) = (reach.splat(0.0), self.radii);
        let distance_sq = dot(self.between, self.between);
        let cos = dot(self.normals[0], self.normals[1]);
        let sin_sq = cos.neg_mul_add(cos, zero.splat(1.0)).max(zero);
        // What rounding could add to the squares.
        let margin = (distance_sq + a * a + b * b) * ROUNDING_MARGIN;
        // Bounding spheres.
        let outer = a + b + reach;
        let mut beyond = (outer * outer + margin).lt(distance_sq);
        for (base, moving) in [(0, 1), (1, 0)] {
            let (base_radius, radius) = (self.radii[base], self.radii[moving]);
            let height = dot(self.normals[base], self.between);
            // Height over the plane of the base.
            let above = (height.abs() - reach).max(zero);
            beyond = T::or(beyond, (radius * radius).mul_add(sin_sq, margin).lt(above * above));
            // Distance from the axis of the base, for a small circle inside.
            let inner = (base_radius - radius - reach).max(zero);
            beyond = T::or(beyond, (height.neg_mul_add(height, distance_sq) + margin).lt(inner * inner));
        }
        beyond
    }

    /// The frames of the pairs, as in `PairFrame::new`. The smaller circle moves; B, if the radii are equal.
    #[inline(always)]
    pub fn frames(&self) -> PairFrames<T> {
        let one = self.radii[0].splat(1.0);
        // Base and moving circle.
        let swapped = self.radii[0].lt(self.radii[1]);
        let ([mut base_normal, mut normal], [mut base_radius, mut radius]) = (self.normals, self.radii);
        let mut between = self.between;
        if T::any(swapped) {
            let [bx, by, bz] = between;
            between = select_vector(swapped, [-bx, -by, -bz], between);
            (base_normal, normal) =
                (select_vector(swapped, normal, base_normal), select_vector(swapped, base_normal, normal));
            (base_radius, radius) = (T::select(swapped, radius, base_radius), T::select(swapped, base_radius, radius));
        }
        // Axes; see PairFrame::new for the second projection at small tilts.
        let scale = dot(between, between).sqrt().max(base_radius).max(radius);
        let inverse = one / scale;
        let tilt = cross(normal, base_normal);
        let (mut flat, mut tilt_sin_sq) = (tilt, dot(tilt, tilt));
        let shallow = tilt_sin_sq.lt(one * REPROJECT_SIN_SQ);
        if T::any(shallow) {
            flat = select_vector(shallow, linear_combination(tilt, one, base_normal, -dot(base_normal, tilt)), tilt);
            tilt_sin_sq = dot(flat, flat);
        }
        let tilt_sin = tilt_sin_sq.sqrt();
        let along = one / tilt_sin;
        let y = [flat[0] * along, flat[1] * along, flat[2] * along];
        let x = cross(y, base_normal);
        // The six numbers.
        let offset = [dot(x, between) * inverse, dot(y, between) * inverse, dot(base_normal, between) * inverse];
        let pair = NormalizedPair::new(
            base_radius * inverse,
            radius * inverse,
            offset,
            dot(base_normal, normal),
            dot(y, tilt),
        );
        PairFrames { pair, axes: [x, y], steepest: cross(y, normal), scale, swapped, min_radius: radius, tilt_sin }
    }
}

/// Pairs reduced to six numbers each, one per lane, with the axes that they refer to.
pub(crate) struct PairFrames<T: SimdReal> {
    /// The six numbers.
    pub pair: NormalizedPair<T>,
    /// `X` and `Y`.
    pub axes: [Vector<T>; 2],
    /// `U`, the direction of steepest ascent of the moving circle.
    pub steepest: Vector<T>,
    /// The unit of length.
    pub scale: T,
    /// Whether circle A moves.
    swapped: T::Mask,
    /// The smaller radius, in the caller's unit.
    min_radius: T,
    /// Sine of the angle between the planes.
    tilt_sin: T,
}

impl<T: SimdReal> PairFrames<T> {
    /// Can the pair be treated in registers? False if the planes are so nearly parallel that rounding would turn
    /// the axes, if a square could overflow or underflow, and for invalid radii and non-finite numbers.
    #[inline(always)]
    pub fn is_regular(&self) -> T::Mask {
        let splat = |x| self.tilt_sin.splat(x);
        let has_valid_size = T::and(self.scale.lt(splat(MAX_LENGTH)), splat(MIN_LENGTH).lt(self.min_radius));
        T::and(splat(MIN_TILT_SIN).lt(self.tilt_sin), has_valid_size)
    }

    /// The distance at an angle (caller's unit), and the unit vector from the centre of B to its nearest point.
    #[inline(always)]
    pub fn distance_and_direction(&self, Angle { cos, sin }: Angle<T>) -> (T, Vector<T>) {
        let [x, y] = self.axes;
        let [ex, ey, rho] = self.pair.position_and_rho(cos, sin);
        let mut direction = linear_combination(self.steepest, cos, y, sin);
        if T::any(self.swapped) {
            let inverse = rho.splat(1.0) / rho;
            direction = select_vector(self.swapped, linear_combination(x, ex * inverse, y, ey * inverse), direction);
        }
        (self.pair.distance(cos, rho) * self.scale, direction)
    }
}
