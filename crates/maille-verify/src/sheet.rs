//! Rings in space: a design's start or a recorded state in one cell, in units of the reference radius R.

use crate::{
    ball,
    curve::Curve,
    record::{CurveSpec, Design, Pose, State},
    rolled::Rolled,
};
use maille_geometry::Circle;
use nalgebra::{Matrix2, Quaternion, Unit, UnitQuaternion, Vector3};
use std::sync::Arc;

pub(crate) type Vec3 = Vector3<f64>;

/// Half a unit in the last place of 1: the relative error of one operation.
pub(crate) const ROUNDING: f64 = f64::EPSILON / 2.0;
/// Operations whose errors add up in a point of a circle or a distance, with plenty to spare.
const OPERATIONS: f64 = 100.0;
/// A recorded quaternion may be that far from unit length.
const QUATERNION: f64 = 1e-9;

/// A ring of an element, at the pose of the design.
#[derive(Clone, Debug)]
pub(crate) struct Ring {
    pub element: usize,
    pub arm: Vec3,
    pub normal: Vec3,
    /// Major radius; of another curve that of the ball about its centre that holds the core.
    pub radius: f64,
    pub wire: f64,
    /// The core in the element's frame, where it is no circle.
    pub curve: Option<Arc<Curve>>,
}

/// Where an element is.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub position: Vec3,
    pub turn: UnitQuaternion<f64>,
}

/// The elements of a cell, their rings, and the lattice.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    pub rings: Vec<Ring>,
    pub bodies: Vec<Body>,
    pub lattice: [Vec3; 2],
    /// Where the copy of the design's cell lies that each element is of, at the start.
    pub copies: Vec<Vec3>,
    /// How the images are turned; none where they are translations.
    pub roll: Option<Rolled>,
}

/// Rows of integers: the cell's lattice vectors in those of the design.
pub(crate) type Cell = [[i32; 2]; 2];

/// A pair of rings: the second in the cell `shift`.
pub(crate) type Pair = (usize, usize, [i32; 2]);

/// `2x1` or `1,0;-1,2`.
pub(crate) fn cell(text: &str) -> Option<Cell> {
    let number = |t: &str| t.trim().parse::<i32>().ok();
    let rows = if let Some((m, n)) = text.split_once('x') {
        [[number(m)?, 0], [0, number(n)?]]
    } else {
        let (first, second) = text.split_once(';')?;
        let row = |t: &str| t.split_once(',').and_then(|(a, b)| Some([number(a)?, number(b)?]));
        [row(first)?, row(second)?]
    };
    (determinant(&rows) != 0).then_some(rows)
}

/// Copies of the design's cell.
pub(crate) fn copies(cell: &Cell) -> u64 {
    determinant(cell).unsigned_abs()
}

fn determinant(m: &Cell) -> i64 {
    i64::from(m[0][0]) * i64::from(m[1][1]) - i64::from(m[0][1]) * i64::from(m[1][0])
}

/// The vectors of `cell` for those of the design.
pub(crate) fn vectors(cell: &Cell, [a1, a2]: [Vec3; 2]) -> [Vec3; 2] {
    cell.map(|[m, n]| a1 * f64::from(m) + a2 * f64::from(n))
}

/// The vectors of the design's cell for those of `cell`: what [`vectors`] undoes.
pub(crate) fn of_design(cell: &Cell, [a1, a2]: [Vec3; 2]) -> [Vec3; 2] {
    let [[p, q], [r, s]] = cell.map(|row| row.map(f64::from));
    let determinant = p * s - q * r;
    [(a1 * s - a2 * q) / determinant, (a2 * p - a1 * r) / determinant]
}

/// The design's lattice vectors in units of R.
pub(crate) fn primitive(design: &Design) -> [Vec3; 2] {
    [design.lattice.a1, design.lattice.a2].map(|a| Vec3::from(a) / design.reference_radius)
}

/// The columns of two vectors of the plane.
pub(crate) fn columns([a1, a2]: [Vec3; 2]) -> Matrix2<f64> {
    Matrix2::new(a1.x, a2.x, a1.y, a2.y)
}

/// Which element of the design a pose is of, and which copy: `flat@1,0` in a cell of several copies.
pub(crate) fn named(design: &Design, cell: &Cell, name: &str) -> Result<(usize, [i32; 2]), String> {
    let unknown = || format!("pose of \"{name}\", which the design does not have");
    let (base, copy) = match name.rsplit_once('@') {
        Some((base, copy)) if determinant(cell).abs() > 1 => {
            let (p, q) = copy.split_once(',').ok_or_else(unknown)?;
            (base, [p, q].map(|x| x.parse().unwrap_or(i32::MIN)))
        }
        _ => (name, [0, 0]),
    };
    let element = design.elements.iter().position(|e| e.name == base).ok_or_else(unknown)?;
    if copy.contains(&i32::MIN) { Err(unknown()) } else { Ok((element, copy)) }
}

/// Whether two copies are one: their difference is a vector of the cell's lattice.
fn same_copy(cell: &Cell, a: [i32; 2], b: [i32; 2]) -> bool {
    let [p, q] = [0, 1].map(|k| i64::from(a[k]) - i64::from(b[k]));
    let m = cell.map(|row| row.map(i64::from));
    let det = determinant(cell);
    (p * m[1][1] - q * m[1][0]) % det == 0 && (q * m[0][0] - p * m[0][1]) % det == 0
}

/// Share of R within which biarcs stand for a smooth curve, where a design does not say.
const CURVE_TOLERANCE: f64 = 1e-6;

/// Share of its reach by which a ball about the origin may be larger than the smallest.
const CENTERED: f64 = 1e-12;

/// The tubes of a curve of element `element`.
fn tubes(design: &Design, spec: &CurveSpec, element: usize) -> Result<Vec<Ring>, String> {
    let unit = design.reference_radius;
    let wire = spec.minor_radius.or(design.minor_radius).ok_or("a curve without a minor radius")? / unit;
    let tolerance = design.curve_tolerance.map_or(CURVE_TOLERANCE, |tolerance| tolerance / unit);
    let (normal, along) = (Vec3::from(spec.normal).normalize(), Vec3::from(spec.along).normalize());
    let x = (along - normal * normal.dot(&along)).normalize();
    let turn = UnitQuaternion::from_basis_unchecked(&[x, normal.cross(&x), normal]);
    let origin = Vec3::from(spec.offset) / unit;
    let moved = |curve: Curve| curve.moved(&turn, &origin);
    let curves: Vec<Curve> = Curve::all_of(&spec.shape, unit, tolerance)?.into_iter().map(moved).collect();
    // Any ball that holds the curves bounds their links; that of the program is the smallest, or as small about the origin.
    let pieces = || curves.iter().flat_map(|curve| &curve.pieces);
    let center = ball::center(origin, |p| ball::farthest(pieces().map(|piece| piece.farthest(p)), p));
    let reach = |p: &Vec3| curves.iter().map(|curve| curve.reach(p)).fold(0.0, f64::max);
    let arm = if reach(&origin) <= reach(&center) * (1.0 + CENTERED) { origin } else { center };
    let ring = |curve: Curve| match curve.circle() {
        Some((arm, normal, radius)) => Ring { element, arm, normal, radius, wire, curve: None },
        None => Ring { element, arm, normal, radius: curve.reach(&arm), wire, curve: Some(Arc::new(curve)) },
    };
    Ok(curves.iter().cloned().map(ring).collect())
}

impl Sheet {
    /// Whether both rings of a pair are circles.
    pub fn is_round(&self, (a, b, _): Pair) -> bool {
        self.rings[a].curve.is_none() && self.rings[b].curve.is_none()
    }

    /// The core of a ring in its element's frame, as a curve.
    pub fn own_curve(&self, ring: usize) -> Curve {
        let ring = &self.rings[ring];
        ring.curve
            .as_ref()
            .map_or_else(|| Curve::ring(ring.arm, frame(&ring.normal), ring.radius), |curve| (**curve).clone())
    }

    /// The core of a ring in the cell `shift`, as a curve.
    pub fn curve(&self, ring: usize, shift: [i32; 2]) -> Curve {
        let (position, turn) = self.place(ring, shift);
        self.own_curve(ring).moved(&turn, &position)
    }

    /// Where the element of a ring stands in the cell `shift`.
    pub fn place(&self, ring: usize, shift: [i32; 2]) -> (Vec3, UnitQuaternion<f64>) {
        let body = &self.bodies[self.rings[ring].element];
        match &self.roll {
            None => (body.position + self.translation(shift), body.turn),
            Some(roll) => {
                let image = roll.motions.image(self.lattice, shift);
                ((image * nalgebra::Point3::from(body.position)).coords, image.rotation * body.turn)
            }
        }
    }

    /// The start of `design` in `cell`, with the elements in the order of `names`.
    pub fn start(design: &Design, cell: &Cell, names: &[&str]) -> Result<Sheet, String> {
        let unit = design.reference_radius;
        let [p1, p2] = primitive(design);
        let mut out = Sheet {
            rings: Vec::new(),
            bodies: Vec::new(),
            lattice: vectors(cell, [p1, p2]),
            copies: Vec::new(),
            roll: None,
        };
        let mut seen: Vec<(usize, [i32; 2])> = Vec::new();
        for name in names {
            let (element, copy) = named(design, cell, name)?;
            if seen.iter().any(|(e, c)| *e == element && same_copy(cell, *c, copy)) {
                return Err(format!("two poses of \"{name}\""));
            }
            seen.push((element, copy));
            let spec = &design.elements[element];
            for ring in &spec.rings {
                let wire = ring.minor_radius.or(design.minor_radius).ok_or("a ring without a minor radius")?;
                let normal = Vec3::from(ring.normal);
                out.rings.push(Ring {
                    element: out.bodies.len(),
                    arm: Vec3::from(ring.offset) / unit,
                    normal: (normal / normal.amax()).normalize(),
                    radius: ring.major_radius / unit,
                    wire: wire / unit,
                    curve: None,
                });
            }
            for curve in &spec.curves {
                out.rings.extend(tubes(design, curve, out.bodies.len())?);
            }
            let way = p1 * f64::from(copy[0]) + p2 * f64::from(copy[1]);
            let position = Vec3::from(spec.center) / unit + way;
            out.copies.push(way);
            out.bodies.push(Body { position, turn: UnitQuaternion::identity() });
        }
        let expected = design.elements.len() as u64 * determinant(cell).unsigned_abs();
        if seen.len() as u64 == expected {
            Ok(out)
        } else {
            Err(format!("{} poses; the cell has {expected} elements", seen.len()))
        }
    }

    /// The rings of this start where the state says they are.
    pub fn at(&self, state: &State, unit: f64) -> Result<Sheet, String> {
        let body = |pose: &Pose| {
            let [w, i, j, k] = pose.rotation;
            let q = Quaternion::new(w, i, j, k);
            if (q.norm() - 1.0).abs() > QUATERNION {
                return Err(format!("the rotation of \"{}\" has length {}", pose.element, q.norm()));
            }
            Ok(Body { position: Vec3::from(pose.position) / unit, turn: Unit::new_normalize(q) })
        };
        let bodies = state.poses.iter().map(body).collect::<Result<_, _>>()?;
        let lattice = [state.a1, state.a2].map(|a| Vec3::from(a) / unit);
        Ok(Sheet { rings: self.rings.clone(), bodies, lattice, copies: self.copies.clone(), roll: None })
    }

    /// The places of the elements in lattice vectors of this start.
    pub fn places(&self) -> Vec<[f64; 2]> {
        let inverse = columns(self.lattice).try_inverse().unwrap_or_default();
        self.bodies.iter().map(|body| (inverse * body.position.xy()).into()).collect()
    }

    /// Where the copy that each element is of lies, in lattice vectors of this start.
    pub fn carried(&self) -> Vec<[f64; 2]> {
        let inverse = columns(self.lattice).try_inverse().unwrap_or_default();
        self.copies.iter().map(|way| (inverse * way.xy()).into()).collect()
    }

    /// How far the circles of each element reach from its reference point.
    pub fn reaches(&self) -> Vec<f64> {
        let of = |e: usize| self.rings.iter().filter(move |ring| ring.element == e);
        (0..self.bodies.len()).map(|e| of(e).map(|ring| ring.arm.norm() + ring.radius).fold(0.0, f64::max)).collect()
    }

    /// Translation of the image `shift`.
    pub fn translation(&self, shift: [i32; 2]) -> Vec3 {
        self.lattice[0] * f64::from(shift[0]) + self.lattice[1] * f64::from(shift[1])
    }

    /// Core circle of a ring in the cell `shift`.
    pub fn circle(&self, ring: usize, shift: [i32; 2]) -> Circle {
        let (ring, body) = (&self.rings[ring], &self.bodies[self.rings[ring].element]);
        let (center, normal) = (body.position + body.turn * ring.arm, body.turn * ring.normal);
        match &self.roll {
            None => Circle::new(center + self.translation(shift), Unit::new_normalize(normal), ring.radius),
            Some(roll) => {
                let image = roll.motions.image(self.lattice, shift);
                let center = (image * nalgebra::Point3::from(center)).coords;
                Circle::new(center, Unit::new_normalize(image.rotation * normal), ring.radius)
            }
        }
    }

    /// Error of a coordinate of a point of the pair's circles: a bound of what rounding can do.
    pub fn slack(&self, (a, b, shift): Pair) -> f64 {
        let size = |ring: usize| {
            let ring = &self.rings[ring];
            self.bodies[ring.element].position.norm() + ring.arm.norm() + ring.radius
        };
        let [m, n] = [0, 1].map(|k| f64::from(shift[k]).abs() * self.lattice[k].norm());
        // A turn about a far axis.
        let axis = self.roll.as_ref().map_or(0.0, |roll| 2.0 * roll.motions.axis_distance(self.lattice).abs());
        OPERATIONS * ROUNDING * (size(a) + size(b) + m + n + axis)
    }

    /// Core distance at which the rings touch.
    pub fn touching(&self, a: usize, b: usize) -> f64 {
        self.rings[a].wire + self.rings[b].wire
    }

    /// All pairs of rings of different elements, images included, whose centres are nearer than the sum of their major radii
    /// and `more`; each pair once. All others are at least `more` apart: a circle lies in the ball around its centre.
    ///
    /// With dual vectors b_k (b_k · a_l = δ_kl), a shift s with |x + s₁ a₁ + s₂ a₂| ≤ d has |s_k + b_k · x| ≤ d |b_k|.
    pub fn pairs(&self, more: impl Fn(usize, usize) -> f64) -> Result<Vec<Pair>, String> {
        if let Some(roll) = &self.roll {
            return self.rolled_pairs(roll, more);
        }
        let [a1, a2] = self.lattice;
        let area = a1.cross(&a2);
        let (b1, b2) = (a2.cross(&area) / area.norm_squared(), area.cross(&a1) / area.norm_squared());
        if !(b1.norm().is_finite() && b2.norm().is_finite()) {
            return Err("the lattice vectors are parallel".into());
        }
        let center = |ring: usize| self.circle(ring, [0, 0]).center;
        let centers: Vec<Vec3> = (0..self.rings.len()).map(center).collect();
        let mut out = Vec::new();
        for a in 0..centers.len() {
            for b in a..centers.len() {
                let x = centers[b] - centers[a];
                // Rounding is far below a thousandth of the reach.
                let reach = 1.001 * (self.rings[a].radius + self.rings[b].radius + more(a, b));
                let range = |dual: &Vec3| {
                    let (mid, half) = (-dual.dot(&x), reach * dual.norm() * 1.001 + 1e-6);
                    (mid - half).ceil()..=(mid + half).floor()
                };
                let ((m, n), same) = ((range(&b1), range(&b2)), self.rings[a].element == self.rings[b].element);
                if (m.end() - m.start()) * (n.end() - n.start()) > 1e7 {
                    return Err("more than ten million images are in range".into());
                }
                for i in *m.start() as i32..=*m.end() as i32 {
                    for j in *n.start() as i32..=*n.end() as i32 {
                        // A ring and its own image at s and at −s are one pair; rings of one element move as one.
                        if (a == b && [i, j] <= [0, 0]) || (same && [i, j] == [0, 0]) {
                            continue;
                        }
                        if (x + self.translation([i, j])).norm() <= reach {
                            out.push((a, b, [i, j]));
                        }
                    }
                }
            }
        }
        Ok(out)
    }

    fn rolled_pairs(&self, roll: &Rolled, more: impl Fn(usize, usize) -> f64) -> Result<Vec<Pair>, String> {
        let center = |ring: usize| self.circle(ring, [0, 0]).center;
        let centers: Vec<Vec3> = (0..self.rings.len()).map(center).collect();
        let mut out = Vec::new();
        for a in 0..centers.len() {
            for b in a..centers.len() {
                let elements = [a, b].map(|ring| self.rings[ring].element);
                let reach = 1.001 * (self.rings[a].radius + self.rings[b].radius + more(a, b));
                let beside = (centers[b] - centers[a]).dot(&roll.motions.axis());
                for shift in roll.shifts(self.lattice, elements, beside, reach)? {
                    // As in `pairs`.
                    let same = elements[0] == elements[1];
                    let counted = !((a == b && shift <= [0, 0]) || (same && shift == [0, 0]));
                    if counted && (self.circle(b, shift).center - centers[a]).norm() <= reach {
                        out.push((a, b, shift));
                    }
                }
            }
        }
        Ok(out)
    }
}

/// Unit vectors u, v in the plane of a circle, u × v along its normal.
pub(crate) fn frame(normal: &Vec3) -> (Vec3, Vec3) {
    let least = normal.iamin();
    let mut axis = Vec3::zeros();
    axis[least] = 1.0;
    let u = (axis - normal * normal[least]).normalize();
    (u, normal.cross(&u))
}

/// Distance of a point from a circle: √(z² + (ρ − R)²), z and ρ its height over the circle's plane and its distance from the axis.
pub(crate) fn distance(point: &Vec3, circle: &Circle) -> f64 {
    let x = point - circle.center;
    let z = x.dot(&circle.normal);
    z.hypot((x - circle.normal.into_inner() * z).norm() - circle.radius)
}
