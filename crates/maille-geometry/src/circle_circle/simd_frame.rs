//! Pairs side by side in registers: the structure of arrays, and the vectors that reduce a pair to six numbers.

use crate::circle::{Circle, Vec3};
use crate::circle_circle::angle::Angle;
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::simd::{Register, SimdReal};
use crate::tolerance::{MAX_LENGTH, MIN_LENGTH};
use pulp::Simd;

pub(crate) type Vector<T> = [T; 3];

#[inline(always)]
pub(crate) fn sub<T: SimdReal>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
pub(crate) fn dot<T: SimdReal>(p: Vector<T>, q: Vector<T>) -> T {
    p[0].mul_add(q[0], p[1].mul_add(q[1], p[2] * q[2]))
}

#[inline(always)]
fn cross<T: SimdReal>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[2].neg_mul_add(q[1], p[1] * q[2]), p[0].neg_mul_add(q[2], p[2] * q[0]), p[1].neg_mul_add(q[0], p[0] * q[1])]
}

#[inline(always)]
pub(crate) fn linear_combination<T: SimdReal>(p: Vector<T>, by: T, q: Vector<T>, times: T) -> Vector<T> {
    [p[0].mul_add(by, q[0] * times), p[1].mul_add(by, q[1] * times), p[2].mul_add(by, q[2] * times)]
}

#[inline(always)]
fn select_vector<T: SimdReal>(mask: T::Mask, yes: Vector<T>, no: Vector<T>) -> Vector<T> {
    [T::select(mask, yes[0], no[0]), T::select(mask, yes[1], no[1]), T::select(mask, yes[2], no[2])]
}

/// The pairs of a register: from the centre of A to that of B, normals and radii.
pub(crate) struct PairVectors<T> {
    pub between: Vector<T>,
    pub normals: [Vector<T>; 2],
    pub radii: [T; 2],
}

impl<S: Simd> PairVectors<Register<S>> {
    /// One pair in all lanes.
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

/// A vector in all lanes.
#[inline(always)]
pub(crate) fn broadcast_vector<S: Simd>(simd: S, v: &Vec3) -> Vector<Register<S>> {
    [Register::broadcast(simd, v.x), Register::broadcast(simd, v.y), Register::broadcast(simd, v.z)]
}

/// Of the largest square: more than a few roundings.
const ROUNDING_MARGIN: f64 = 1e-14;
/// Sines of the planes' angle below this go to the single kernel.
const MIN_TILT_SIN: f64 = 1e-7;

/// Squared sines below this are taken from a cross product that is projected once more, see [`crate::relative::PairFrame`].
const REPROJECT_SIN_SQ: f64 = 1e-2;

impl<T: SimdReal> PairVectors<T> {
    /// The circles are certainly more than `reach` apart, as in [`crate::circle_distance_lower_bound`], but without a root:
    /// the spheres round them are, or one lies above the other's slab, or inside of its ring as seen along its axis.
    #[inline(always)]
    pub fn is_beyond(&self, reach: T) -> T::Mask {
        let (zero, [a, b]) = (reach.splat(0.0), self.radii);
        let apart_sq = dot(self.between, self.between);
        let cos = dot(self.normals[0], self.normals[1]);
        let sin_sq = cos.neg_mul_add(cos, zero.splat(1.0)).max(zero);
        let outer = a + b + reach;
        // What rounding could add to the squares.
        let spare = (apart_sq + a * a + b * b) * ROUNDING_MARGIN;
        let mut beyond = (outer * outer + spare).lt(apart_sq);
        for (base, moving) in [(0, 1), (1, 0)] {
            let (base_radius, radius) = (self.radii[base], self.radii[moving]);
            let height = dot(self.normals[base], self.between);
            let over = (height.abs() - reach).max(zero);
            beyond = T::or(beyond, (radius * radius).mul_add(sin_sq, spare).lt(over * over));
            let inner = (base_radius - radius - reach).max(zero);
            beyond = T::or(beyond, (height.neg_mul_add(height, apart_sq) + spare).lt(inner * inner));
        }
        beyond
    }

    /// The numbers of [`crate::relative::PairFrame`].
    #[inline(always)]
    pub fn frames(&self) -> PairFrames<T> {
        let one = self.radii[0].splat(1.0);
        // The smaller circle moves; B, if they are equal.
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
        let scale = dot(between, between).sqrt().max(base_radius).max(radius);
        let inverse = one / scale;
        let tilt = cross(normal, base_normal);
        let (mut flat, mut length_sq) = (tilt, dot(tilt, tilt));
        let shallow = length_sq.lt(one * REPROJECT_SIN_SQ);
        if T::any(shallow) {
            flat = select_vector(shallow, linear_combination(tilt, one, base_normal, -dot(base_normal, tilt)), tilt);
            length_sq = dot(flat, flat);
        }
        let length = length_sq.sqrt();
        let along = one / length;
        let y = [flat[0] * along, flat[1] * along, flat[2] * along];
        let x = cross(y, base_normal);
        let offset = [dot(x, between) * inverse, dot(y, between) * inverse, dot(base_normal, between) * inverse];
        let pair = NormalizedPair::new(
            base_radius * inverse,
            radius * inverse,
            offset,
            dot(base_normal, normal),
            dot(y, tilt),
        );
        PairFrames { pair, axes: [x, y], steepest: cross(y, normal), scale, swapped, least_radius: radius, length }
    }
}

/// Pairs of a register, reduced to six numbers each.
pub(crate) struct PairFrames<T: SimdReal> {
    pub pair: NormalizedPair<T>,
    pub axes: [Vector<T>; 2],
    pub steepest: Vector<T>,
    pub scale: T,
    swapped: T::Mask,
    least_radius: T,
    /// Sine of the planes' angle.
    length: T,
}

impl<T: SimdReal> PairFrames<T> {
    /// The planes are not so nearly parallel that rounding turns the axes, and no square overflows or vanishes. Radii of 0
    /// or less and numbers that are not finite are not ordinary either.
    #[inline(always)]
    pub fn is_regular(&self) -> T::Mask {
        let splat = |x| self.length.splat(x);
        let sized = T::and(self.scale.lt(splat(MAX_LENGTH)), splat(MIN_LENGTH).lt(self.least_radius));
        T::and(splat(MIN_TILT_SIN).lt(self.length), sized)
    }

    /// The distance at an angle, and the direction on circle B.
    #[inline(always)]
    pub fn distance_and_direction(&self, Angle { cos, sin }: Angle<T>) -> (T, Vector<T>) {
        let [x, y] = self.axes;
        let [ex, ey, rho] = self.pair.position_and_rho(cos, sin);
        let mut direction = linear_combination(self.steepest, cos, y, sin);
        if T::any(self.swapped) {
            let foot = rho.splat(1.0) / rho;
            direction = select_vector(self.swapped, linear_combination(x, ex * foot, y, ey * foot), direction);
        }
        (self.pair.distance(cos, rho) * self.scale, direction)
    }
}
