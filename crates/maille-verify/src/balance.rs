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
//! ∇g is a difference of fourth order, [8 (g(h) − g(−h)) − (g(2h) − g(−2h))]/12h, with h a thousandth of the core distance for
//! all motions: g varies with the core distance as its length, so the error is of the order of 1e-12 in the derivative,
//! and rounding adds some 1e-16/h.

use crate::{
    apart::Arc,
    curve_pair::CurveContact,
    record::Contact,
    sheet::{Pair, Sheet, Vec3, distance, frame},
};
use maille_geometry::Circle;
use nalgebra::{DVector, Unit, UnitQuaternion};

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
/// Recorded points lie on their rings, and normals join them, within this.
const PLACED: f64 = 1e-9;
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
pub(crate) struct Closed<'a> {
    pub sheet: &'a Sheet,
    pub pair: Pair,
    /// Its angle in the [`frame`] of ring b.
    pub angle: f64,
    /// From the centre of b to the point.
    out: Vec3,
    /// Distance less the sum of the minor radii.
    pub gap: f64,
    /// Derivative of the distance along the ring.
    slope: f64,
    /// The contact, where one of the two is no circle.
    pub curve: Option<CurveContact>,
}

impl<'a> Closed<'a> {
    /// A contact of which one is no circle.
    pub fn of_curves(sheet: &'a Sheet, pair: Pair, contact: CurveContact) -> Self {
        let (gap, slope) = (contact.gap(), contact.slope());
        Closed { sheet, pair, angle: 0.0, out: Vec3::zeros(), gap, slope, curve: Some(contact) }
    }

    /// The least distance next to `angle`.
    pub fn next_to(sheet: &'a Sheet, pair: Pair, angle: f64) -> Self {
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
        Closed { sheet, pair, angle, out, gap, slope: at.slope / (2.0 * at.distance), curve: None }
    }

    /// Distance of the point from circle a, when the elements and the image's translation have moved.
    fn moved(&self, of_a: &Motion, of_b: &Motion, image: &Vec3) -> f64 {
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
        distance(&point, &one)
    }

    /// The derivatives of its distance in all unknowns: six for each element, then those of the lattice.
    pub fn gradient(&self, free: &Free) -> DVector<f64> {
        let (a, b, shift) = self.pair;
        let n = 6 * self.sheet.bodies.len();
        let mut out = DVector::zeros(n + free.0.len());
        if let Some(contact) = &self.curve {
            let local = contact.gradient();
            for (ring, first) in [(a, 0), (b, 6)] {
                let element = self.sheet.rings[ring].element;
                (0..6).for_each(|k| out[6 * element + k] += local[first + k]);
            }
            for (m, rate) in free.0.iter().enumerate() {
                let image = rate[0] * f64::from(shift[0]) + rate[1] * f64::from(shift[1]);
                out[n + m] = (0..3).map(|k| local[6 + k] * image[k]).sum();
            }
            return out;
        }
        let (i, j) = (self.sheet.rings[a].element, self.sheet.rings[b].element);
        let size = |ring: usize| self.sheet.rings[ring].arm.norm() + self.sheet.rings[ring].radius;
        let h = STEP * self.sheet.touching(a, b);
        let turn = h / size(a).max(size(b)).max(1.0);
        let (none, still) = (Motion::NONE, Vec3::zeros());
        let g = |of_a: &Motion, of_b: &Motion, image: &Vec3| self.moved(of_a, of_b, image);
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
pub(crate) fn least(arc: &Arc<'_>, angle: f64) -> f64 {
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

/// The recorded contacts as points of this sheet with their forces, lengths in `unit`; or what makes them none.
pub(crate) fn points<'a>(sheet: &'a Sheet, contacts: &[Contact], unit: f64) -> Result<Vec<(Closed<'a>, f64)>, String> {
    let point = |(k, contact): (usize, &Contact)| {
        let pair = (contact.ring_a, contact.ring_b, contact.shift);
        if pair.0.max(pair.1) < sheet.rings.len() && !sheet.is_round(pair) {
            let found = placed_on_curves(sheet, contact, unit).map_err(|words| format!("contact {k} {words}"))?;
            return Ok((Closed::of_curves(sheet, pair, found), contact.force));
        }
        let angle = placed(sheet, contact, unit).map_err(|words| format!("contact {k} {words}"))?;
        Ok((Closed::next_to(sheet, pair, angle), contact.force))
    };
    contacts.iter().enumerate().map(point).collect()
}

/// The balance of forces at points of `sheet`.
pub(crate) fn balance(sheet: &Sheet, points: &[(Closed<'_>, f64)], free: &Free) -> Balance {
    let n = 6 * sheet.bodies.len();
    let mut out = Balance { least_force: f64::INFINITY, ..Balance::default() };
    let mut residual = DVector::zeros(n + free.0.len());
    residual[n] = 1.0;
    for (closed, force) in points {
        residual += closed.gradient(free) * *force;
        out.least_force = out.least_force.min(*force);
        out.complementarity = out.complementarity.max((force * closed.gap).abs());
        out.slope = out.slope.max((force * closed.slope).abs());
        if sheet.rings[closed.pair.0].element == sheet.rings[closed.pair.1].element {
            out.own_image = out.own_image.max(*force);
        }
    }
    out.residual = residual.amax();
    out
}

/// A recorded contact of which one is no circle, if the record's points and normal are where they should be.
pub(crate) fn placed_on_curves(sheet: &Sheet, contact: &Contact, unit: f64) -> Result<CurveContact, String> {
    let (a, b, shift) = (contact.ring_a, contact.ring_b, contact.shift);
    if sheet.rings[a].element == sheet.rings[b].element && shift == [0, 0] {
        return Err("is of an element with itself".into());
    }
    let written = [contact.point_a, contact.point_b].map(|p| Vec3::from(p) / unit);
    let found = CurveContact::new(sheet, (a, b, shift), written);
    let points = found.points();
    let normal = (points[1] - points[0]).normalize();
    let away = (0..2).map(|k| (points[k] - written[k]).norm()).fold(0.0, f64::max);
    let away = away.max((Vec3::from(contact.normal) - normal).norm());
    if away <= PLACED + sheet.slack((a, b, shift)) / sheet.touching(a, b) {
        Ok(found)
    } else {
        Err(format!("of rings {a} and {b} at {shift:?} is off its curves by {away:.1e} R"))
    }
}

/// The angle of a recorded contact on its ring b, if the record's points and normal are where they should be.
pub(crate) fn placed(sheet: &Sheet, contact: &Contact, unit: f64) -> Result<f64, String> {
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
