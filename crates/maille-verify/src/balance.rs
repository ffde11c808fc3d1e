//! The forces of a locked state balance the pull: the conditions of first order, from differences of gaps.
//!
//! The program is: the largest l1 under g(θ) ≥ 0 for each pair of rings and each point θ of the one, g(θ) being the point's distance
//! from the other core circle less the sum of the minor radii. It is critical where there are forces μ ≥ 0 at closed
//! points, g = 0, with
//!
//! c + Σ μ ∇g = 0,  c = 1 for l1, else 0,
//!
//! in all unknowns: a translation and a turn of every element, l1, and where they are free l2 and the shear. What is closed where
//! nothing overlaps is a least distance. So the point is sought anew, as the minimum next to the recorded one; and by the
//! envelope theorem ∇g of a minimum is that of the distance of the point fixed in its ring, which exists where the minimum does not
//! stand alone, too.
//!
//! **Pairs that touch nearly along their whole circle.** Where two equal rings lie parallel, their axes a little apart, the record spreads
//! their force over sixteen heights of the one over the other's plane, which imply the gap; of those points two short arcs alone are
//! closed. Then two things are shown: the recorded forces balance the pull as forces on heights; and there are forces ≥ 0 on points
//! of the sheet that are closed to 1e-9 R, found anew, that do.
//!
//! ∇g is a difference of fourth order, [8 (g(h) − g(−h)) − (g(2h) − g(−2h))]/12h, with h a thousandth of the core distance for
//! all motions: g varies with the core distance as its length, so the error is of the order of 1e-12 in the derivative,
//! and rounding adds some 1e-16/h.

use crate::{
    apart::Arc,
    record::Contact,
    sheet::{Pair, Sheet, Vec3, distance, frame},
};
use maille_geometry::Circle;
use nalgebra::{DMatrix, DVector, Unit, UnitQuaternion};
use std::collections::BTreeSet;

/// Residual of the balance that is allowed, for a unit pull.
pub const RESIDUAL: f64 = 1e-6;
/// Product of a force and its gap that is allowed, in reference radii.
pub const COMPLEMENTARITY: f64 = 1e-8;
/// Step of the differences, in core distances.
const STEP: f64 = 1e-3;
/// A minimum is sought as far as this from the recorded point.
const NEXT_RAD: f64 = 1e-3;
/// Second derivative of the squared distance below which a minimum has no place of its own, and the recorded point counts.
const FLATTEST: f64 = 1e-6;
/// Tilt, distance of the axes and difference of the radii, in radii, below which a pair can lie flat.
const FLAT: f64 = 0.1;
/// Recorded points lie on their rings, and normals join them, within this.
const PLACED: f64 = 1e-9;
/// A recorded point that is open by more may stand for a flat pair.
const SPREAD: f64 = 1e-11;
/// What is closed.
const CLOSED: f64 = 1e-9;
/// See [`pushes`].
const APART: f64 = 1e-8;
/// Angles at which closed points of a pair are looked for.
const SCAN: usize = 72;

/// What of a pull is free, as rates of the solved cell's lattice vectors; the first is that of what is maximised.
pub(crate) struct Free(pub Vec<[Vec3; 2]>);

/// The figures of a balance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Balance {
    /// Largest entry of c + Σ μ ∇g.
    pub residual: f64,
    /// Least force.
    pub least_force: f64,
    /// Largest |μ g|.
    pub complementarity: f64,
    /// Largest |μ ∂g/∂θ|: how far a closed point is from being a minimum.
    pub slope: f64,
    /// Largest force between an element and its own image.
    pub own_image: f64,
    /// The forces were found anew: the recorded ones are spread over flat pairs.
    pub anew: bool,
}

impl Balance {
    /// Whether the forces push on closed contacts and balance the pull.
    pub fn holds(&self) -> bool {
        self.least_force >= 0.0
            && self.complementarity <= COMPLEMENTARITY
            && self.residual <= RESIDUAL
            && self.slope <= RESIDUAL
    }
}

/// A rigid motion: translation, and turn as a rotation vector.
#[derive(Clone, Copy)]
struct Motion {
    shift: Vec3,
    turn: Vec3,
}

impl Motion {
    const NONE: Motion = Motion { shift: Vec3::new(0.0, 0.0, 0.0), turn: Vec3::new(0.0, 0.0, 0.0) };

    fn unit(k: usize, h: f64) -> Motion {
        let mut out = Motion::NONE;
        if k < 3 {
            out.shift[k] = h
        } else {
            out.turn[k - 3] = h
        }
        out
    }
}

/// A point of the ring `b` in its image, a least distance from ring `a`.
struct Closed<'a> {
    sheet: &'a Sheet,
    pair: Pair,
    /// From the centre of b to the point.
    out: Vec3,
    /// Distance less the sum of the minor radii.
    gap: f64,
    /// Derivative of the distance along the ring.
    slope: f64,
}

impl<'a> Closed<'a> {
    /// The least distance next to `angle`.
    fn next_to(sheet: &'a Sheet, pair: Pair, angle: f64) -> Self {
        let (one, other) = (sheet.circle(pair.0, [0, 0]), sheet.circle(pair.1, pair.2));
        Closed::at(sheet, pair, least(&Arc::new(&one, &other), angle))
    }

    /// The point of ring b at `angle`.
    fn at(sheet: &'a Sheet, pair: Pair, angle: f64) -> Self {
        let (one, other) = (sheet.circle(pair.0, [0, 0]), sheet.circle(pair.1, pair.2));
        let at = Arc::new(&one, &other).at(angle);
        let (u, v) = frame(&other.normal);
        let out = (u * angle.cos() + v * angle.sin()) * other.radius;
        let gap = at.distance - sheet.touching(pair.0, pair.1);
        Closed { sheet, pair, out, gap, slope: at.slope / (2.0 * at.distance) }
    }

    /// Closed points of a pair: its least distances; where it lies flat, points of the closed arcs about them, and of a grid.
    fn all(sheet: &'a Sheet, pair: Pair) -> Vec<Self> {
        let (one, other) = (sheet.circle(pair.0, [0, 0]), sheet.circle(pair.1, pair.2));
        let arc = Arc::new(&one, &other);
        let touching = sheet.touching(pair.0, pair.1);
        let open = |angle: f64| (arc.at(angle).distance - touching).abs() > CLOSED;
        let width = std::f64::consts::TAU / SCAN as f64;
        let flat = lie_flat(sheet, pair);
        let mut angles: Vec<f64> = (0..SCAN).filter(|_| flat).map(|k| width * k as f64).collect();
        let slopes: Vec<f64> = (0..=SCAN).map(|k| arc.at(width * k as f64).slope).collect();
        for k in (0..SCAN).filter(|&k| slopes[k] < 0.0 && slopes[k + 1] >= 0.0) {
            let (mut low, mut high) = (width * k as f64, width * (k + 1) as f64);
            for _ in 0..60 {
                let mid = 0.5 * (low + high);
                if arc.at(mid).slope < 0.0 { low = mid } else { high = mid }
            }
            let least = 0.5 * (low + high);
            angles.push(least);
            for side in [-1.0, 1.0].into_iter().filter(|_| flat) {
                let mut reach = width;
                while reach > 1e-9 && open(least + side * reach) {
                    reach *= 0.5;
                }
                angles.extend([0.5, 1.0].map(|part| least + part * side * reach));
            }
        }
        angles.into_iter().filter(|&angle| !open(angle)).map(|angle| Closed::at(sheet, pair, angle)).collect()
    }

    /// Distance of the point from circle a, or its height over a's plane, when the elements and the image's translation have moved.
    fn moved(&self, of_a: &Motion, of_b: &Motion, image: &Vec3, height: bool) -> f64 {
        let (a, b, shift) = self.pair;
        let turned = |ring: usize, motion: &Motion| {
            let (ring, body) = (&self.sheet.rings[ring], &self.sheet.bodies[self.sheet.rings[ring].element]);
            let turn = UnitQuaternion::from_scaled_axis(motion.turn);
            (body.position + motion.shift, turn * (body.turn * ring.arm), turn, turn * (body.turn * ring.normal))
        };
        let (at, arm, _, normal) = turned(a, of_a);
        let one = Circle::new(at + arm, Unit::new_normalize(normal), self.sheet.rings[a].radius);
        let (at, arm, turn, _) = turned(b, of_b);
        let point = at + self.sheet.translation(shift) + image + arm + turn * self.out;
        if height { (point - one.center).dot(&one.normal).abs() } else { distance(&point, &one) }
    }

    /// The derivatives of its distance or height in all unknowns: six for each element, then those of the lattice.
    fn gradient(&self, free: &Free, height: bool) -> DVector<f64> {
        let (a, b, shift) = self.pair;
        let n = 6 * self.sheet.bodies.len();
        let mut out = DVector::zeros(n + free.0.len());
        let (i, j) = (self.sheet.rings[a].element, self.sheet.rings[b].element);
        let size = |ring: usize| self.sheet.rings[ring].arm.norm() + self.sheet.rings[ring].radius;
        let h = STEP * self.sheet.touching(a, b);
        let turn = h / size(a).max(size(b)).max(1.0);
        let (none, still) = (Motion::NONE, Vec3::zeros());
        let g = |of_a: &Motion, of_b: &Motion, image: &Vec3| self.moved(of_a, of_b, image, height);
        for m in 0..6 {
            let h = if m < 3 { h } else { turn };
            let moved = |x: f64| Motion::unit(m, x);
            if i == j {
                // An element and its image shift together, and turn each about its own place.
                out[6 * i + m] = difference(|x| g(&moved(x), &moved(x), &still), h);
            } else {
                out[6 * i + m] = difference(|x| g(&moved(x), &none, &still), h);
                out[6 * j + m] = difference(|x| g(&none, &moved(x), &still), h);
            }
        }
        for (m, rate) in free.0.iter().enumerate() {
            let image = rate[0] * f64::from(shift[0]) + rate[1] * f64::from(shift[1]);
            if image.norm() > 0.0 {
                out[n + m] = difference(|x| g(&none, &none, &(image * x)), h / image.norm());
            }
        }
        out
    }
}

fn difference(g: impl Fn(f64) -> f64, h: f64) -> f64 {
    (8.0 * (g(h) - g(-h)) - (g(2.0 * h) - g(-2.0 * h))) / (12.0 * h)
}

/// The angle of the least distance next to `angle` by Newton's method on its slope; `angle` itself where there is none.
fn least(arc: &Arc<'_>, angle: f64) -> f64 {
    let (mut x, h) = (angle, 1e-5);
    for _ in 0..30 {
        let bend = (arc.at(x + h).slope - arc.at(x - h).slope) / (2.0 * h);
        let step = -arc.at(x).slope / bend;
        if !(bend > FLATTEST && (x + step - angle).abs() <= NEXT_RAD) {
            return angle;
        }
        x += step;
        if step.abs() < 1e-14 {
            break;
        }
    }
    if arc.at(x).distance <= arc.at(angle).distance + 1e-13 { x } else { angle }
}

/// The balance of `contacts`, whose lengths are in `unit`; or what makes them no contacts of this sheet.
pub(crate) fn balance(sheet: &Sheet, contacts: &[Contact], unit: f64, free: &Free) -> Result<Balance, String> {
    let mut points = Vec::new();
    let (mut least_force, mut own_image) = (f64::INFINITY, 0.0_f64);
    for (k, contact) in contacts.iter().enumerate() {
        let pair = (contact.ring_a, contact.ring_b, contact.shift);
        let angle = placed(sheet, contact, unit).map_err(|words| format!("contact {k} {words}"))?;
        points.push((Closed::next_to(sheet, pair, angle), contact.force));
        least_force = least_force.min(contact.force);
        if sheet.rings[pair.0].element == sheet.rings[pair.1].element {
            own_image = own_image.max(contact.force);
        }
    }
    let measured = |points: &[(Closed<'_>, f64)], spread: &BTreeSet<Pair>| {
        let n = 6 * sheet.bodies.len();
        let mut out = Balance { least_force, own_image, ..Balance::default() };
        let mut residual = DVector::zeros(n + free.0.len());
        residual[n] = 1.0;
        for (closed, force) in points {
            let height = spread.contains(&closed.pair);
            residual += closed.gradient(free, height) * *force;
            if !height {
                out.complementarity = out.complementarity.max((force * closed.gap).abs());
                out.slope = out.slope.max((force * closed.slope).abs());
            }
        }
        out.residual = residual.amax();
        out
    };
    let recorded = measured(&points, &BTreeSet::new());
    let open = points.iter().filter(|(closed, _)| closed.gap.abs() > SPREAD && lie_flat(sheet, closed.pair));
    let spread: BTreeSet<Pair> = open.map(|(closed, _)| closed.pair).collect();
    if recorded.holds() || spread.is_empty() {
        return Ok(recorded);
    }
    // First what is recorded: heights of flat pairs, which imply their gaps. Then forces on closed points.
    let as_heights = measured(&points, &spread);
    if !as_heights.holds() {
        return Ok(recorded);
    }
    let pairs = sheet.pairs(|a, b| sheet.touching(a, b) + CLOSED)?;
    let closed: Vec<Closed<'_>> = pairs.into_iter().flat_map(|pair| Closed::all(sheet, pair)).collect();
    let columns: Vec<DVector<f64>> = closed.iter().map(|closed| closed.gradient(free, false)).collect();
    let mut wanted = DVector::zeros(6 * sheet.bodies.len() + free.0.len());
    wanted[6 * sheet.bodies.len()] = -1.0;
    let forces = pushes(&columns, &wanted);
    let anew: Vec<(Closed<'_>, f64)> = closed.into_iter().zip(forces).collect();
    Ok(Balance { anew: true, ..measured(&anew, &BTreeSet::new()) })
}

/// Whether two rings are equal, nearly parallel and nearly coaxial.
fn lie_flat(sheet: &Sheet, (a, b, shift): Pair) -> bool {
    let (one, other) = (sheet.circle(a, [0, 0]), sheet.circle(b, shift));
    let x = other.center - one.center;
    let apart = (x - one.normal.into_inner() * x.dot(&one.normal)).norm();
    let tilt = one.normal.cross(&other.normal).norm();
    (one.radius - other.radius).abs() < FLAT * one.radius && tilt < FLAT && apart < FLAT * one.radius
}

/// The angle of a recorded contact on its ring b, if the record's points and normal are where they should be.
fn placed(sheet: &Sheet, contact: &Contact, unit: f64) -> Result<f64, String> {
    let (a, b, shift) = (contact.ring_a, contact.ring_b, contact.shift);
    if a.max(b) >= sheet.rings.len() {
        return Err(format!("is of ring {}, of {} rings", a.max(b), sheet.rings.len()));
    }
    if sheet.rings[a].element == sheet.rings[b].element && shift == [0, 0] {
        return Err("is of an element with itself".into());
    }
    let (one, other) = (sheet.circle(a, [0, 0]), sheet.circle(b, shift));
    let recorded = Vec3::from(contact.point_b) / unit - other.center;
    let (u, v) = frame(&other.normal);
    let angle = recorded.dot(&v).atan2(recorded.dot(&u));
    let point_b = other.center + (u * angle.cos() + v * angle.sin()) * other.radius;
    let x = point_b - one.center;
    let across = x - one.normal.into_inner() * x.dot(&one.normal);
    let point_a = one.center + across.normalize() * one.radius;
    let off = |written: [f64; 3], found: Vec3| (Vec3::from(written) / unit - found).norm();
    let away = off(contact.point_a, point_a).max(off(contact.point_b, point_b));
    let away = away.max((Vec3::from(contact.normal) - (point_b - point_a).normalize()).norm());
    let allowed = PLACED + sheet.slack((a, b, shift)) / sheet.touching(a, b);
    if away <= allowed {
        Ok(angle)
    } else {
        Err(format!("of rings {a} and {b} at {shift:?} is off its rings by {away:.1e} R"))
    }
}

/// Forces y ≥ 0 with the least |Σ y c − w|² + ε² |y|² (Lawson, Hanson 1974); ε keeps neighbours on a flat arc, which are nearly
/// dependent, apart. However good they are, the balance that they leave is measured.
fn pushes(columns: &[DVector<f64>], wanted: &DVector<f64>) -> Vec<f64> {
    let rows = wanted.len();
    let own = |(k, column): (usize, &DVector<f64>)| {
        let mut column = column.clone().resize_vertically(rows + columns.len(), 0.0);
        column[rows + k] = APART;
        column
    };
    let columns: Vec<DVector<f64>> = columns.iter().enumerate().map(own).collect();
    let wanted = &wanted.clone().resize_vertically(rows + columns.len(), 0.0);
    let mut y = vec![0.0; columns.len()];
    let mut used: Vec<usize> = Vec::new();
    for _ in 0..3 * columns.len() {
        let carried = columns.iter().zip(&y).fold(wanted.clone(), |left, (column, force)| left - column * *force);
        let idle = (0..columns.len()).filter(|k| !used.contains(k));
        let best = idle.map(|k| (columns[k].dot(&carried), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, k)) = best.filter(|(gain, _)| *gain > 1e-15) else { break };
        used.push(k);
        while !used.is_empty() {
            let chosen: Vec<DVector<f64>> = used.iter().map(|&k| columns[k].clone()).collect();
            let Ok(solved) = DMatrix::from_columns(&chosen).svd(true, true).solve(wanted, 0.0) else { return y };
            if solved.min() > 0.0 {
                used.iter().zip(solved.iter()).for_each(|(&k, &force)| y[k] = force);
                break;
            }
            // As far towards it as all push; those that push no more are let go.
            let falling = used.iter().zip(solved.iter()).filter(|(_, to)| **to <= 0.0);
            let part = falling.map(|(&k, &to)| y[k] / (y[k] - to)).fold(1.0, f64::min);
            let part = if part.is_finite() { part } else { 0.0 };
            used.iter().zip(solved.iter()).for_each(|(&k, &to)| y[k] += part * (to - y[k]));
            let released: Vec<usize> = used.iter().copied().filter(|&k| y[k] <= 1e-15).collect();
            if released.is_empty() {
                break;
            }
            released.iter().for_each(|&k| y[k] = 0.0);
            used.retain(|k| !released.contains(k));
        }
    }
    y
}
