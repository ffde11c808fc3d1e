//! Pairs side by side in registers: the structure of arrays, and the vectors that reduce a pair to six numbers.

use crate::Circle;
use crate::brackets::Angle;
use crate::circle::{LARGEST, SMALLEST};
use crate::lane::{Lane, Register};
use crate::reduced::Reduced;
use pulp::Simd;

/// Pairs side by side: several registers of the widest kind, for a register that is loaded from numbers just stored waits.
pub(crate) const WIDTH: usize = 32;
/// One number of each.
pub(crate) type Row = [f64; WIDTH];
/// Numbers of a pair: centre, normal and radius of A, then of B.
const NUMBERS: usize = 14;

/// Pairs as a structure of arrays.
pub(crate) struct Block {
    numbers: [Row; NUMBERS],
    pub index: [usize; WIDTH],
    pub count: usize,
}

impl Block {
    /// Full of one harmless pair.
    pub fn new() -> Self {
        let one = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0];
        Self { numbers: one.map(|x| [x; WIDTH]), index: [0; WIDTH], count: 0 }
    }

    #[inline(always)]
    pub fn push(&mut self, index: usize, (a, b): &(Circle, Circle)) {
        let lane = self.count % WIDTH;
        for (k, circle) in [(0, a), (7, b)] {
            let numbers = [
                circle.center.x,
                circle.center.y,
                circle.center.z,
                circle.normal.x,
                circle.normal.y,
                circle.normal.z,
                circle.radius,
            ];
            for (number, x) in self.numbers[k..].iter_mut().zip(numbers) {
                number[lane] = x;
            }
        }
        self.index[lane] = index;
        self.count = lane + 1;
    }

    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, from: usize) -> Placed<Register<S>> {
        Placed {
            between: minus(self.vector(simd, 7, from), self.vector(simd, 0, from)),
            normals: [self.vector(simd, 3, from), self.vector(simd, 10, from)],
            radii: [self.number(simd, 6, from), self.number(simd, 13, from)],
        }
    }

    #[inline(always)]
    fn number<S: Simd>(&self, simd: S, k: usize, from: usize) -> Register<S> {
        Register::load(simd, &self.numbers[k], from)
    }

    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, k: usize, from: usize) -> Vector<Register<S>> {
        [self.number(simd, k, from), self.number(simd, k + 1, from), self.number(simd, k + 2, from)]
    }
}

pub(crate) type Vector<T> = [T; 3];

#[inline(always)]
fn minus<T: Lane>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
pub(crate) fn dot<T: Lane>(p: Vector<T>, q: Vector<T>) -> T {
    p[0].fused(q[0], p[1].fused(q[1], p[2] * q[2]))
}

#[inline(always)]
fn cross<T: Lane>(p: Vector<T>, q: Vector<T>) -> Vector<T> {
    [p[2].taken(q[1], p[1] * q[2]), p[0].taken(q[2], p[2] * q[0]), p[1].taken(q[0], p[0] * q[1])]
}

#[inline(always)]
pub(crate) fn sum<T: Lane>(p: Vector<T>, by: T, q: Vector<T>, times: T) -> Vector<T> {
    [p[0].fused(by, q[0] * times), p[1].fused(by, q[1] * times), p[2].fused(by, q[2] * times)]
}

#[inline(always)]
fn choose<T: Lane>(mask: T::Mask, yes: Vector<T>, no: Vector<T>) -> Vector<T> {
    [T::pick(mask, yes[0], no[0]), T::pick(mask, yes[1], no[1]), T::pick(mask, yes[2], no[2])]
}

/// The pairs of a register: from the centre of A to that of B, normals and radii.
pub(crate) struct Placed<T> {
    between: Vector<T>,
    normals: [Vector<T>; 2],
    radii: [T; 2],
}

impl<S: Simd> Placed<Register<S>> {
    /// One pair in all lanes.
    #[inline(always)]
    pub fn one(simd: S, a: &Circle, b: &Circle) -> Self {
        let between = b.center - a.center;
        Placed {
            between: splat(simd, &between),
            normals: [splat(simd, &a.normal), splat(simd, &b.normal)],
            radii: [Register::all(simd, a.radius), Register::all(simd, b.radius)],
        }
    }
}

/// A vector in all lanes.
#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, v: &crate::Vec3) -> Vector<Register<S>> {
    [Register::all(simd, v.x), Register::all(simd, v.y), Register::all(simd, v.z)]
}

/// Of the largest square: more than a few roundings.
const SPARE: f64 = 1e-14;
/// Sines of the planes' angle below this go to the single kernel.
const LEAST_TILT: f64 = 1e-7;

/// Squared sines below this are taken from a cross product that is projected once more, see [`crate::relative::Relative`].
const STEEP_SQ: f64 = 1e-2;

impl<T: Lane> Placed<T> {
    /// The circles are certainly more than `reach` apart, as in [`crate::circle_distance_floor`], but without a root:
    /// the spheres round them are, or one lies above the other's slab, or inside of its ring as seen along its axis.
    #[inline(always)]
    pub fn is_beyond(&self, reach: T) -> T::Mask {
        let (zero, [a, b]) = (reach.like(0.0), self.radii);
        let apart_sq = dot(self.between, self.between);
        let cos = dot(self.normals[0], self.normals[1]);
        let sin_sq = cos.taken(cos, zero.like(1.0)).max(zero);
        let outer = a + b + reach;
        // What rounding could add to the squares.
        let spare = (apart_sq + a * a + b * b) * SPARE;
        let mut beyond = (outer * outer + spare).below(apart_sq);
        for (base, moving) in [(0, 1), (1, 0)] {
            let (base_radius, radius) = (self.radii[base], self.radii[moving]);
            let height = dot(self.normals[base], self.between);
            let over = (height.abs() - reach).max(zero);
            beyond = T::either(beyond, (radius * radius).fused(sin_sq, spare).below(over * over));
            let inner = (base_radius - radius - reach).max(zero);
            beyond = T::either(beyond, (height.taken(height, apart_sq) + spare).below(inner * inner));
        }
        beyond
    }

    /// The numbers of [`crate::relative::Relative`].
    #[inline(always)]
    pub fn framed(&self) -> Framed<T> {
        let one = self.radii[0].like(1.0);
        // The smaller circle moves; B, if they are equal.
        let swapped = self.radii[0].below(self.radii[1]);
        let ([mut base_normal, mut normal], [mut base_radius, mut radius]) = (self.normals, self.radii);
        let mut between = self.between;
        if T::any(swapped) {
            let [bx, by, bz] = between;
            between = choose(swapped, [-bx, -by, -bz], between);
            (base_normal, normal) = (choose(swapped, normal, base_normal), choose(swapped, base_normal, normal));
            (base_radius, radius) = (T::pick(swapped, radius, base_radius), T::pick(swapped, base_radius, radius));
        }
        let scale = dot(between, between).sqrt().max(base_radius).max(radius);
        let inverse = one / scale;
        let tilt = cross(normal, base_normal);
        let (mut flat, mut length_sq) = (tilt, dot(tilt, tilt));
        let shallow = length_sq.below(one * STEEP_SQ);
        if T::any(shallow) {
            flat = choose(shallow, sum(tilt, one, base_normal, -dot(base_normal, tilt)), tilt);
            length_sq = dot(flat, flat);
        }
        let length = length_sq.sqrt();
        let along = one / length;
        let y = [flat[0] * along, flat[1] * along, flat[2] * along];
        let x = cross(y, base_normal);
        let offset = [dot(x, between) * inverse, dot(y, between) * inverse, dot(base_normal, between) * inverse];
        let pair =
            Reduced::new(base_radius * inverse, radius * inverse, offset, dot(base_normal, normal), dot(y, tilt));
        Framed { pair, axes: [x, y], steepest: cross(y, normal), scale, swapped, least_radius: radius, length }
    }
}

/// Pairs of a register, reduced to six numbers each.
pub(crate) struct Framed<T: Lane> {
    pub pair: Reduced<T>,
    pub axes: [Vector<T>; 2],
    pub steepest: Vector<T>,
    pub scale: T,
    swapped: T::Mask,
    least_radius: T,
    /// Sine of the planes' angle.
    length: T,
}

impl<T: Lane> Framed<T> {
    /// The planes are not so nearly parallel that rounding turns the axes, and no square overflows or vanishes. Radii of 0
    /// or less and numbers that are not finite are not ordinary either.
    #[inline(always)]
    pub fn is_ordinary(&self) -> T::Mask {
        let like = |x| self.length.like(x);
        let sized = T::both(self.scale.below(like(LARGEST)), like(SMALLEST).below(self.least_radius));
        T::both(like(LEAST_TILT).below(self.length), sized)
    }

    /// The distance at an angle, and the direction on circle B.
    #[inline(always)]
    pub fn approach(&self, Angle { cos, sin }: Angle<T>) -> (T, Vector<T>) {
        let [x, y] = self.axes;
        let [ex, ey, rho] = self.pair.foot(cos, sin);
        let mut direction = sum(self.steepest, cos, y, sin);
        if T::any(self.swapped) {
            let foot = rho.like(1.0) / rho;
            direction = choose(self.swapped, sum(x, ex * foot, y, ey * foot), direction);
        }
        (self.pair.distance(cos, rho) * self.scale, direction)
    }
}
