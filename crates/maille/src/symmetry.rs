//! Symmetries of a design: the isometries that map the sheet, at its start, to itself.
//!
//! An operation is x ↦ M x + t, M orthogonal, and M maps the sheet's plane to itself: a turn or a mirror in the plane, and ±1
//! across it. It maps the lattice to itself, M A = A N with a matrix N of integers, and each element to an element or an
//! image of one, ring by ring. A ring is a circle with a wire, so that normals count up to their sign.
//!
//! **What it does to a state.** With e ↦ e′ + s the element and the shift that e goes to, and F the deformation,
//!
//! - A ↦ M A N⁻¹, so F ↦ M F Mᵀ: a pull along D becomes one along M D, with the same l1 and l2. Where M mirrors the plane
//!   the shear changes its sign. D and −D are one direction.
//! - The rotation Q of e becomes M Q Mᵀ of e′, a rotation also where M is none; its position x becomes M x + t − M Q Mᵀ c − A s,
//!   A being the mapped lattice and c the difference o′ − M o of the centres of the two elements' rings in the design.
//!
//! All distances stay. A mirror turns the sign of every linking number, here and at the start alike, and each linked pair goes to a
//! linked pair. So the image of a limit is a limit, and the image of a bound a bound.
//!
//! **Larger cells.** The sublattice of a larger cell goes to the sublattice of [`Operation::cell`], which may be another one.
//!
//! **Tolerance.** The design as it is written has the operation to `TOLERANCE`: what is symmetric only to the digits of its
//! file has it not.

use crate::{
    lattice::{Cell, Direction, Shift},
    model::Model,
    state::{Pose, Roll, State},
    topology::RingPair,
};
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Matrix3, Quaternion, UnitQuaternion};
use std::collections::BTreeSet;

/// How far an operation may miss, in reference radii: rounding of numbers that are written with all their digits.
pub(crate) const TOLERANCE: f64 = 1e-11;
/// Angles are rounded to this part of a degree, so that 180 − 179.9 is 0.1.
const STEPS_PER_DEGREE: f64 = 1e12;
/// Directions that differ by less are one, in degrees.
const SAME_DEG: f64 = 1e-9;

/// An isometry x ↦ M x + t that maps a design to itself.
#[derive(Clone, Debug)]
pub struct Operation {
    /// M, in blocks: of the plane, and ±1 across it.
    pub matrix: Matrix3<f64>,
    /// t, in reference radii.
    pub translation: Vec3,
    /// N, whose columns are the images of a1 and a2 in the basis of the design's lattice.
    integers: [[i32; 2]; 2],
    /// Turn of a rotation of the plane, or twice the angle of a mirror's line, in degrees.
    angle_deg: f64,
}

impl Operation {
    /// Whether it mirrors the plane: then a shear changes its sign.
    pub fn mirrors(&self) -> bool {
        self.matrix[(0, 0)] * self.matrix[(1, 1)] < self.matrix[(0, 1)] * self.matrix[(1, 0)]
    }

    /// Whether every deformation goes to itself: it turns the plane by 180° or not at all.
    pub(crate) fn keeps_deformations(&self) -> bool {
        let turns = self.matrix[(0, 0)].abs() == 1.0 && self.matrix[(0, 0)] == self.matrix[(1, 1)];
        turns && self.matrix[(0, 1)] == 0.0 && self.matrix[(1, 0)] == 0.0
    }

    /// Where a direction goes, in [0, 180): D and −D are one. Rounded to 10⁻¹² degrees.
    pub fn direction_deg(&self, direction_deg: f64) -> f64 {
        let sign = if self.mirrors() { -1.0 } else { 1.0 };
        let turned = self.angle_deg + sign * direction_deg;
        let rounded = (turned.rem_euclid(180.0) * STEPS_PER_DEGREE).round() / STEPS_PER_DEGREE;
        if rounded >= 180.0 { 0.0 } else { rounded }
    }

    /// The cell that `cell` goes to; `None` where its integers are too large.
    pub fn cell(&self, cell: Cell) -> Option<Cell> {
        let [first, second] = self.integers.map(|row| row.map(i64::from));
        let row = |[m, n]: [i32; 2]| {
            let row = [0, 1].map(|k| i64::from(m) * first[k] + i64::from(n) * second[k]);
            let row = if row < [0, 0] { row.map(|x| -x) } else { row };
            Some([i32::try_from(row[0]).ok()?, i32::try_from(row[1]).ok()?])
        };
        let [first, second] = cell.rows();
        Cell::new([row(first)?, row(second)?]).ok()
    }

    fn maps(&self, x: &Vec3) -> Vec3 {
        self.matrix * x + self.translation
    }
}

/// The operations of the design of a periodic `model` that map the lattice of its cell to itself, one for each M; the identity
/// comes first.
///
/// A finite sheet has the identity alone.
pub fn operations(model: &Model) -> Vec<Operation> {
    let mut out = all_operations(model);
    let mut seen = Vec::new();
    out.retain(|operation| {
        let first = !seen.contains(&operation.matrix);
        seen.push(operation.matrix);
        first
    });
    out
}

/// As [`operations`], with each translation of each M that is none of the lattice: a design whose elements are copies of each other
/// has several.
pub(crate) fn all_operations(model: &Model) -> Vec<Operation> {
    let own = model.primitive();
    let identity = Operation {
        matrix: Matrix3::identity(),
        translation: Vec3::zeros(),
        integers: [[1, 0], [0, 1]],
        angle_deg: 0.0,
    };
    if !model.periodic {
        return vec![identity];
    }
    let bodies = Bodies::new(&own);
    let mut out = vec![identity];
    for (integers, plane, angle_deg) in automorphisms(&own) {
        for up in [1.0, -1.0] {
            let mut matrix = Matrix3::from_diagonal_element(up);
            matrix.fixed_view_mut::<2, 2>(0, 0).copy_from(&plane);
            let operation = |translation| Operation { matrix, translation, integers, angle_deg };
            let found = bodies.translations(&matrix).map(operation).filter(|operation| bodies.kept(operation));
            // The identity itself is there.
            out.extend(found.filter(|o| o.matrix != Matrix3::identity() || o.translation.norm() > TOLERANCE));
        }
    }
    out.retain(|operation| operation.cell(model.cell).is_some_and(|cell| cell.same_lattice(&model.cell)));
    out
}

/// The maps of the plane lattice to itself: the images of a1 and a2 in its basis, the orthogonal matrix, and its angle (see
/// [`Operation`]).
fn automorphisms(own: &Model) -> Vec<([[i32; 2]; 2], Matrix2<f64>, f64)> {
    let (a1, a2) = (own.start.a1, own.start.a2);
    let short = own.short_basis;
    let basis = short.vectors(a1, a2).map(|b| b.xy());
    // In a shortest basis the vectors of the lengths of the two have coefficients −1, 0 and 1.
    let near: Vec<[i32; 2]> = (-1..=1).flat_map(|m| (-1..=1).map(move |n| [m, n])).collect();
    let vector = |[m, n]: [i32; 2]| basis[0] * f64::from(m) + basis[1] * f64::from(n);
    let square = basis[0].norm_squared().max(basis[1].norm_squared());
    let same = |x: f64, y: f64| (x - y).abs() <= TOLERANCE * square.sqrt();
    let mut out = Vec::new();
    for &first in &near {
        for &second in &near {
            let (v, w) = (vector(first), vector(second));
            let gram = same(v.norm_squared(), basis[0].norm_squared())
                && same(w.norm_squared(), basis[1].norm_squared())
                && same(v.dot(&w), basis[0].dot(&basis[1]));
            let det = first[0] * second[1] - first[1] * second[0];
            if !gram || det.abs() != 1 {
                continue;
            }
            // The exact angle: a lattice is turned by multiples of 60° or 90° alone.
            let measured = Matrix2::from_columns(&[v, w])
                * Matrix2::from_columns(&basis).try_inverse().unwrap_or_else(Matrix2::identity);
            let angle_deg = measured[(1, 0)].atan2(measured[(0, 0)]).to_degrees().rem_euclid(360.0);
            let angle_deg = if det > 0 {
                (angle_deg / 30.0).round() * 30.0
            } else {
                (angle_deg * STEPS_PER_DEGREE).round() / STEPS_PER_DEGREE
            };
            let angle_deg = angle_deg.rem_euclid(360.0);
            let d = Direction::of_degrees(angle_deg).along();
            let sign = f64::from(det);
            let plane = Matrix2::new(d.x, -sign * d.y, d.y, sign * d.x);
            out.extend(in_basis(short, first, second).map(|integers| (integers, plane, angle_deg)));
        }
    }
    out
}

/// The images of a1 and a2 in their own basis, from those of the short basis in the short basis; `None` where they are too
/// large for integers.
fn in_basis(short: Cell, first: [i32; 2], second: [i32; 2]) -> Option<[[i32; 2]; 2]> {
    // Rows: b = S a, b′ = G b, so a′ = S⁻¹ G S a.
    let wide = |rows: [[i32; 2]; 2]| rows.map(|row| row.map(i128::from));
    let [[p, q], [r, s]] = wide(short.rows());
    let det = p * s - q * r;
    let inverse = [[s * det, -q * det], [-r * det, p * det]];
    let product =
        |x: [[i128; 2]; 2], y: [[i128; 2]; 2]| x.map(|row| [0, 1].map(|k| row[0] * y[0][k] + row[1] * y[1][k]));
    let [a1, a2] = product(product(inverse, wide([first, second])), [[p, q], [r, s]]);
    let narrow = |[m, n]: [i128; 2]| Some([i32::try_from(m).ok()?, i32::try_from(n).ok()?]);
    Some([narrow(a1)?, narrow(a2)?])
}

/// The elements of a model at its start, by the centres of their rings.
struct Bodies<'a> {
    model: &'a Model,
    centers: Vec<Vec3>,
}

impl<'a> Bodies<'a> {
    fn new(model: &'a Model) -> Self {
        let centers = (0..model.elements.len()).map(|e| model.start.poses[e].position + middle(model, e)).collect();
        Bodies { model, centers }
    }

    /// The translations that take the first element to some element, turned by `matrix`.
    fn translations(&self, matrix: &Matrix3<f64>) -> impl Iterator<Item = Vec3> {
        let from = matrix * self.centers[0];
        let of = |e: usize| rings_to(self.model, 0, self.model, e, matrix).map(|_| self.centers[e] - from);
        (0..self.centers.len()).filter_map(of).collect::<Vec<_>>().into_iter()
    }

    fn kept(&self, operation: &Operation) -> bool {
        (0..self.centers.len())
            .all(|e| self.image(&operation.matrix, &operation.maps(&self.centers[e]), self.model, e).is_some())
    }

    /// The element here, with its shift and rings, that element `e` of `from` goes to, the centre of its rings to `center`.
    fn image(
        &self,
        matrix: &Matrix3<f64>,
        center: &Vec3,
        from: &Model,
        e: usize,
    ) -> Option<(usize, Shift, Vec<usize>)> {
        let State { a1, a2, .. } = self.model.start;
        (0..self.centers.len()).find_map(|to| {
            let away = center - self.centers[to];
            let steps = self.model.reference_inverse * away.xy();
            let shift = [steps.x.round() as i32, steps.y.round() as i32];
            let left = away - a1 * f64::from(shift[0]) - a2 * f64::from(shift[1]);
            if left.norm() > TOLERANCE {
                return None;
            }
            rings_to(from, e, self.model, to, matrix).map(|rings| (to, shift, rings))
        })
    }
}

/// Mean of the centres of an element's rings, from its reference point.
fn middle(model: &Model, element: usize) -> Vec3 {
    let rings = &model.rings[model.elements[element].rings.clone()];
    rings.iter().map(|ring| ring.offset).sum::<Vec3>() / rings.len() as f64
}

/// The rings of element `f` that those of `e` go to, turned by `matrix` about the middle of each.
fn rings_to(from: &Model, e: usize, to: &Model, f: usize, matrix: &Matrix3<f64>) -> Option<Vec<usize>> {
    let (mine, theirs) = (from.elements[e].rings.clone(), to.elements[f].rings.clone());
    if mine.len() != theirs.len() {
        return None;
    }
    let (own, other) = (middle(from, e), middle(to, f));
    let mut taken = vec![false; theirs.len()];
    mine.map(|k| {
        let ring = &from.rings[k];
        let (offset, normal) = (matrix * (ring.offset - own), matrix * ring.normal.into_inner());
        let fits = |m: &usize| {
            let there = &to.rings[*m];
            let close = |x: f64, y: f64| (x - y).abs() <= TOLERANCE;
            !taken[m - theirs.start]
                && close(there.major_radius, ring.major_radius)
                && close(there.minor_radius, ring.minor_radius)
                && (there.offset - other - offset).norm() <= TOLERANCE
                && match (&ring.curve, &there.curve) {
                    (None, None) => there.normal.cross(&normal).norm() <= TOLERANCE,
                    (Some(from), Some(to)) => from.maps_to(to, |p| matrix * (p - own) + other, TOLERANCE),
                    _ => false,
                }
        };
        let found = theirs.clone().find(fits)?;
        taken[found - theirs.start] = true;
        Some(found)
    })
    .collect()
}

/// Where an operation takes the elements of a model: to those of a model of the same design in the cell that its cell goes to.
#[derive(Clone, Debug)]
pub struct Image<'a> {
    operation: &'a Operation,
    to: &'a Model,
    /// Of each element: the one that it goes to, in which cell, and by how much the design's reference points miss.
    elements: Vec<(usize, Shift, Vec3)>,
    /// Of each ring: the one that it goes to, and in which cell.
    rings: Vec<(usize, Shift)>,
    /// The columns are the images of the lattice vectors in those of `to`.
    shifts: [[i32; 2]; 2],
}

impl<'a> Image<'a> {
    /// `None` where the two are not of one design that has the operation, or `to` is of another cell.
    pub fn new(operation: &'a Operation, from: &Model, to: &'a Model) -> Option<Self> {
        let bodies = Bodies::new(to);
        if from.elements.len() != to.elements.len() {
            return None;
        }
        let (mut elements, mut rings) = (Vec::new(), Vec::new());
        for e in 0..from.elements.len() {
            let center = from.start.poses[e].position + middle(from, e);
            let (image, shift, own) = bodies.image(&operation.matrix, &operation.maps(&center), from, e)?;
            elements.push((image, shift, middle(to, image) - operation.matrix * middle(from, e)));
            rings.extend(own.into_iter().map(|ring| (ring, shift)));
        }
        let column = |a: &Vec3| {
            let steps = to.reference_inverse * (operation.matrix * a).xy();
            let whole = steps.map(f64::round);
            ((steps - whole).norm() < 1e-6).then(|| [whole.x as i32, whole.y as i32])
        };
        let shifts = [column(&from.start.a1)?, column(&from.start.a2)?];
        let all: BTreeSet<usize> = elements.iter().map(|(image, ..)| *image).collect();
        let whole = all.len() == elements.len() && determinant(shifts).abs() == 1;
        whole.then_some(Image { operation, to, elements, rings, shifts })
    }

    /// The image of a shift.
    pub(crate) fn shift(&self, [m, n]: Shift) -> Shift {
        let [first, second] = self.shifts;
        [0, 1].map(|k| m * first[k] + n * second[k])
    }

    /// The image of a difference of positions, or of a force.
    pub(crate) fn vector(&self, v: &Vec3) -> Vec3 {
        self.operation.matrix * v
    }

    /// The image of an axis of a turn, an axial vector: a mirror turns it once more.
    pub(crate) fn axial(&self, v: &Vec3) -> Vec3 {
        self.operation.matrix * v * self.operation.matrix.determinant().signum()
    }

    /// The images M A N⁻¹ of two lattice vectors, or of their changes.
    pub(crate) fn lattice(&self, [a1, a2]: [&Vec3; 2]) -> [Vec3; 2] {
        // A N⁻¹, by columns; the determinant of N is its own inverse.
        let [[p, q], [r, s]] = self.shifts.map(|column| column.map(f64::from));
        let det = f64::from(determinant(self.shifts));
        [self.vector(&(a1 * s - a2 * q)) * det, self.vector(&(a2 * p - a1 * r)) * det]
    }

    /// The ring, with its cell, that `ring` in the cell `shift` goes to.
    pub(crate) fn ring(&self, ring: usize, shift: Shift) -> (usize, Shift) {
        let ((image, own), there) = (self.rings[ring], self.shift(shift));
        (image, [own[0] + there[0], own[1] + there[1]])
    }

    /// The image of a state.
    pub fn state(&self, state: &State) -> State {
        let [a1, a2] = self.lattice([&state.a1, &state.a2]);
        let roll = state.roll.map(|roll| self.roll(&roll));
        let mut out = State { poses: self.to.start.poses.clone(), a1, a2, roll };
        for (pose, (image, shift, miss)) in state.poses.iter().zip(&self.elements) {
            let q = pose.rotation.quaternion();
            let rotation = UnitQuaternion::new_normalize(Quaternion::from_parts(q.w, self.axial(&q.imag())));
            out.poses[*image] = if roll.is_some() {
                // The axis stays over the origin.
                let position = self.vector(&pose.position) - rotation * miss;
                out.image(*shift).back_pose(&Pose { position, rotation })
            } else {
                let position = self.operation.maps(&pose.position) - rotation * miss - out.translation(*shift);
                Pose { position, rotation }
            };
        }
        out.with_first_over_axis()
    }

    /// The image of a roll: a turn θ about w becomes one about the image of w. An operation that turns the sheet over leads the axis to its
    /// other side.
    fn roll(&self, roll: &Roll) -> Roll {
        let [[p, q], [r, s]] = self.shifts.map(|column| column.map(f64::from));
        let sign = f64::from(determinant(self.shifts)) * self.operation.matrix[(2, 2)];
        let [first, second] = roll.turn_rad;
        let turn_rad = [first * s - second * q, second * p - first * r].map(|turn| turn * sign);
        Roll { along: self.vector(&roll.along), turn_rad }
    }

    /// The image of a pair of rings and of a point on each; `state` is the image of the state that they are of. As pairs are listed,
    /// the lower element comes first, and of an element's own images that in the positive direction.
    pub fn contact(&self, pair: &RingPair, points: [Vec3; 2], state: &State) -> (RingPair, [Vec3; 2]) {
        let (ring_a, own) = self.ring(pair.ring_a, [0, 0]);
        let (ring_b, there) = self.ring(pair.ring_b, pair.shift);
        let shift = [there[0] - own[0], there[1] - own[1]];
        let points = points.map(|point| self.operation.maps(&point) - state.translation(own));
        let [a, b] = [ring_a, ring_b].map(|ring| self.to.rings[ring].element);
        if a < b || (a == b && shift > [0, 0]) {
            return (RingPair { ring_a, ring_b, shift }, points);
        }
        let [point_a, point_b] = points.map(|point| point - state.translation(shift));
        (RingPair { ring_a: ring_b, ring_b: ring_a, shift: shift.map(|x| -x) }, [point_b, point_a])
    }

    /// The model of the images.
    pub fn model(&self) -> &Model {
        self.to
    }

    /// Whether a shear changes its sign.
    pub(crate) fn mirrors(&self) -> bool {
        self.operation.mirrors()
    }
}

fn determinant([[a, b], [c, d]]: [[i32; 2]; 2]) -> i32 {
    a * d - b * c
}

/// Directions that are images of each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// The least of them all in [0, 180), whether it is asked for or not: the one that is solved.
    pub representative_deg: f64,
    /// Those that are asked for, in their order.
    pub directions_deg: Vec<f64>,
}

/// The directions, in degrees, by the orbits of `operations`, in the order of their first ones.
///
/// Which direction represents an orbit does not depend on which of its directions are asked for, but for rounding.
pub fn orbits(operations: &[Operation], directions_deg: &[f64]) -> Vec<Orbit> {
    let mut out: Vec<Orbit> = Vec::new();
    for &asked in directions_deg {
        let least = operations.iter().map(|o| o.direction_deg(asked)).fold(f64::INFINITY, f64::min);
        // Solved as it is asked for where rounding alone would make another of it.
        let own = (0.0..180.0).contains(&asked) && same_direction(asked, least);
        let representative_deg = if own { asked } else { least };
        match out.iter_mut().find(|orbit| same_direction(orbit.representative_deg, representative_deg)) {
            Some(orbit) => {
                if own && !orbit.directions_deg.contains(&orbit.representative_deg) {
                    orbit.representative_deg = asked;
                }
                orbit.directions_deg.push(asked);
            }
            None => out.push(Orbit { representative_deg, directions_deg: vec![asked] }),
        }
    }
    out
}

/// The operations that take a direction to another, both in degrees.
pub fn between(operations: &[Operation], from_deg: f64, to_deg: f64) -> impl Iterator<Item = &Operation> {
    operations.iter().filter(move |operation| same_direction(operation.direction_deg(from_deg), to_deg))
}

/// Whether two directions, in degrees, are one but for rounding: D and −D are.
pub(crate) fn same_direction(a_deg: f64, b_deg: f64) -> bool {
    let apart = (a_deg - b_deg).rem_euclid(180.0);
    apart.min(180.0 - apart) <= SAME_DEG
}

/// Whether an operation mirrors a direction, in degrees, to itself: then a shear γ along it and −γ are images.
pub(crate) fn mirrored(operations: &[Operation], direction_deg: f64) -> bool {
    between(operations, direction_deg, direction_deg).any(Operation::mirrors)
}
