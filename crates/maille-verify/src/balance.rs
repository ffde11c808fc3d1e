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
    record::Contact,
    sheet::{Sheet, Vec3, distance, frame},
};
use maille_geometry::Circle;
use nalgebra::{Unit, UnitQuaternion};

/// Step of the differences, in core distances.
const STEP: f64 = 1e-3;
/// A minimum is sought as far as this from the recorded point.
const NEXT_RAD: f64 = 1e-3;
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

/// A closed point: of the ring `b` in its image, with the force there.
struct Closed<'a> {
    sheet: &'a Sheet,
    a: usize,
    b: usize,
    shift: [i32; 2],
    /// From the centre of b to the point.
    out: Vec3,
}

impl Closed<'_> {
    /// Distance of the point from circle a when the elements and the image's translation have moved.
    fn distance(&self, of_a: &Motion, of_b: &Motion, image: &Vec3) -> f64 {
        let turned = |ring: usize, motion: &Motion| {
            let (ring, body) = (&self.sheet.rings[ring], &self.sheet.bodies[self.sheet.rings[ring].element]);
            let turn = UnitQuaternion::from_scaled_axis(motion.turn);
            (body.position + motion.shift, turn * (body.turn * ring.arm), turn, turn * (body.turn * ring.normal))
        };
        let (at, arm, _, normal) = turned(self.a, of_a);
        let a = Circle::new(at + arm, Unit::new_normalize(normal), self.sheet.rings[self.a].radius);
        let (at, arm, turn, _) = turned(self.b, of_b);
        let point = at + self.sheet.translation(self.shift) + image + arm + turn * self.out;
        distance(&point, &a)
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
        if !(bend > 0.0 && (x + step - angle).abs() <= NEXT_RAD) {
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
    let n = 6 * sheet.bodies.len();
    let mut residual = vec![0.0; n + free.0.len()];
    residual[n] = 1.0;
    let mut out = Balance { least_force: f64::INFINITY, ..Balance::default() };
    for (k, contact) in contacts.iter().enumerate() {
        let (a, b, shift) = (contact.ring_a, contact.ring_b, contact.shift);
        if a.max(b) >= sheet.rings.len() {
            return Err(format!("contact {k} is of ring {}, of {} rings", a.max(b), sheet.rings.len()));
        }
        let (i, j) = (sheet.rings[a].element, sheet.rings[b].element);
        if i == j && shift == [0, 0] {
            return Err(format!("contact {k} is of an element with itself"));
        }
        let (one, other) = (sheet.circle(a, [0, 0]), sheet.circle(b, shift));
        let recorded = Vec3::from(contact.point_b) / unit - other.center;
        let (u, v) = frame(&other.normal);
        let angle = recorded.dot(&v).atan2(recorded.dot(&u));
        let arc = Arc::new(&one, &other);
        let near = |angle: f64| {
            let out = (u * angle.cos() + v * angle.sin()) * other.radius;
            let x = other.center + out - one.center;
            let across = x - one.normal.into_inner() * x.dot(&one.normal);
            (out, one.center + across.normalize() * one.radius)
        };
        let (out_b, point_a) = near(angle);
        let point_b = other.center + out_b;
        let off = |written: [f64; 3], found: Vec3| (Vec3::from(written) / unit - found).norm();
        let away = off(contact.point_a, point_a).max(off(contact.point_b, point_b));
        let away = away.max((Vec3::from(contact.normal) - (point_b - point_a).normalize()).norm());
        let allowed = PLACED + sheet.slack((a, b, shift)) / sheet.touching(a, b);
        if away.is_nan() || away > allowed {
            return Err(format!("contact {k}, of rings {a} and {b} at {shift:?}, is off its rings by {away:.1e} R"));
        }
        let angle = least(&arc, angle);
        let at = arc.at(angle);
        let closed = Closed { sheet, a, b, shift, out: near(angle).0 };
        let (touching, force) = (sheet.touching(a, b), contact.force);
        out.least_force = out.least_force.min(force);
        out.complementarity = out.complementarity.max((force * (at.distance - touching)).abs());
        out.slope = out.slope.max((force * at.slope / (2.0 * at.distance)).abs());
        if i == j {
            out.own_image = out.own_image.max(force);
        }
        let h = STEP * touching;
        let size = |ring: usize| sheet.rings[ring].arm.norm() + sheet.rings[ring].radius;
        let turn = h / size(a).max(size(b)).max(1.0);
        for m in 0..6 {
            let h = if m < 3 { h } else { turn };
            let moved = |x: f64| Motion::unit(m, x);
            let (none, still) = (Motion::NONE, Vec3::zeros());
            if i == j {
                // An element and its image shift together, and turn each about its own place.
                residual[6 * i + m] += force * difference(|x| closed.distance(&moved(x), &moved(x), &still), h);
            } else {
                residual[6 * i + m] += force * difference(|x| closed.distance(&moved(x), &none, &still), h);
                residual[6 * j + m] += force * difference(|x| closed.distance(&none, &moved(x), &still), h);
            }
        }
        for (m, rate) in free.0.iter().enumerate() {
            let image = rate[0] * f64::from(shift[0]) + rate[1] * f64::from(shift[1]);
            if image.norm() > 0.0 {
                let of = |x: f64| closed.distance(&Motion::NONE, &Motion::NONE, &(image * x));
                residual[n + m] += force * difference(of, h / image.norm());
            }
        }
    }
    out.residual = residual.iter().fold(0.0, |most, r| most.max(r.abs()));
    Ok(out)
}
