//! The forces of a rolled state: their balance, and the curvature of −Σ μ g on the motions that keep the loaded contacts.
//!
//! **Unknowns.** A translation and a turn of every element, and the rates of lattice and turns with what is free. g is the least distance of
//! the two rings next to the recorded point, found anew at every displaced state; its derivatives are differences of fourth order. Motions that change
//! nothing, about the axis and along it, and a change of height with l1, stay among the unknowns: their curvature is 0.

use crate::{
    apart::Arc,
    balance::{COMPLEMENTARITY, RESIDUAL, least, placed},
    curvature::{FLATTEST, ZERO_MODE, kept, turns},
    record::Contact,
    report::{Check, Finding, Verdict},
    rolled::Rolled,
    sheet::{Pair, Sheet, Vec3, frame},
};
use maille_geometry::Circle;
use nalgebra::{DMatrix, DVector, Point3, Unit, UnitQuaternion};

/// Step of first derivatives, in R and radians.
const STEP: f64 = 1e-4;
/// Step of second derivatives.
const LONG_STEP: f64 = 2e-3;
/// Contacts that carry more are kept.
const LOADED: f64 = 1e-8;
/// A curvature below this share of the largest, with a minus, is no rounding.
const SADDLE: f64 = 1e-6;
/// The matrices are dense.
const MOST_UNKNOWNS: usize = 400;

/// What is free: a rate of both lattice vectors, and of both turns. The first is what is maximised.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rate {
    pub lattice: [Vec3; 2],
    pub turn_rad: [f64; 2],
}

/// A motion that one unknown makes.
#[derive(Clone, Copy)]
enum Unknown {
    Shift(usize, Vec3),
    Turn(usize, Vec3),
    Rate(Rate),
}

/// A pair of rings next to a point at which they are closed.
struct Held<'a> {
    sheet: &'a Sheet,
    roll: &'a Rolled,
    pair: Pair,
    /// The point, in the frame of its element.
    point: Vec3,
    force: f64,
}

impl Held<'_> {
    /// The least distance, less the minor radii, when the unknowns have moved by these steps.
    fn gap(&self, steps: &[(Unknown, f64)]) -> f64 {
        let (arc_a, other, point) = self.moved(steps);
        let arc = Arc::new(&arc_a, &other);
        let (u, v) = frame(&other.normal);
        let angle = point.dot(&v).atan2(point.dot(&u));
        arc.at(least(&arc, angle)).distance - self.sheet.touching(self.pair.0, self.pair.1)
    }

    /// Both circles, and the way from the centre of the second to the point that was closed.
    fn moved(&self, steps: &[(Unknown, f64)]) -> (Circle, Circle, Vec3) {
        let (a, b, shift) = self.pair;
        let (mut lattice, mut roll) = (self.sheet.lattice, self.roll.clone());
        for (unknown, x) in steps {
            if let Unknown::Rate(rate) = unknown {
                for k in 0..2 {
                    lattice[k] += rate.lattice[k] * *x;
                    roll.turn_rad[k] += rate.turn_rad[k] * x;
                }
            }
        }
        let body = |ring: usize| {
            let (ring, body) = (&self.sheet.rings[ring], &self.sheet.bodies[self.sheet.rings[ring].element]);
            let (mut at, mut turn) = (body.position, Vec3::zeros());
            for (unknown, x) in steps {
                match unknown {
                    Unknown::Shift(e, by) if *e == ring.element => at += by * *x,
                    Unknown::Turn(e, by) if *e == ring.element => turn += by * *x,
                    _ => {}
                }
            }
            let turn = UnitQuaternion::from_scaled_axis(turn) * body.turn;
            (at + turn * ring.arm, turn, turn * ring.normal, ring.radius)
        };
        let (center, _, normal, radius) = body(a);
        let one = Circle::new(center, Unit::new_normalize(normal), radius);
        let (center, turn, normal, radius) = body(b);
        let image = roll.image(lattice, shift);
        let center = (image * Point3::from(center)).coords;
        let other = Circle::new(center, Unit::new_normalize(image.rotation * normal), radius);
        (one, other, image.rotation * (turn * self.point))
    }

    /// The unknowns that move the pair.
    fn own(&self, unknowns: &[Unknown]) -> Vec<usize> {
        let (a, b, shift) = self.pair;
        let elements = [self.sheet.rings[a].element, self.sheet.rings[b].element];
        let moves = |unknown: &Unknown| match unknown {
            Unknown::Shift(e, _) | Unknown::Turn(e, _) => elements.contains(e),
            Unknown::Rate(_) => shift != [0, 0],
        };
        (0..unknowns.len()).filter(|&k| moves(&unknowns[k])).collect()
    }
}

/// The rings of the state with their recorded contacts.
pub(crate) fn roll_forces(sheet: &Sheet, contacts: &[Contact], rates: &[Rate], unit: f64) -> [Finding; 2] {
    let both = |verdict, words: String| {
        [Check::Balance, Check::Curvature].map(|check| Finding::new(check, verdict, None, words.clone()))
    };
    let Some(roll) = &sheet.roll else { return both(Verdict::Open, "the sheet is flat".into()) };
    let mut held = Vec::new();
    for (k, contact) in contacts.iter().enumerate() {
        let pair = (contact.ring_a, contact.ring_b, contact.shift);
        let angle = match placed(sheet, contact, unit) {
            Ok(angle) => angle,
            Err(words) => return both(Verdict::False, format!("contact {k} {words}")),
        };
        let (one, other) = (sheet.circle(pair.0, [0, 0]), sheet.circle(pair.1, pair.2));
        let arc = Arc::new(&one, &other);
        let bend = (arc.at(angle + 1e-5).slope - arc.at(angle - 1e-5).slope) / 2e-5;
        if bend.is_nan() || bend <= FLATTEST {
            let words = format!("rings {} and {} at {:?} touch along an arc", pair.0, pair.1, pair.2);
            return both(Verdict::Open, words);
        }
        let (u, v) = frame(&other.normal);
        let out = (u * angle.cos() + v * angle.sin()) * other.radius;
        let image = roll.image(sheet.lattice, pair.2);
        let turn = image.rotation * sheet.bodies[sheet.rings[pair.1].element].turn;
        held.push(Held { sheet, roll, pair, point: turn.inverse() * out, force: contact.force });
    }
    let unknowns = unknowns(sheet, rates);
    if unknowns.len() > MOST_UNKNOWNS {
        let words = format!("{} unknowns; up to {MOST_UNKNOWNS} are looked at", unknowns.len());
        return both(Verdict::Open, words);
    }
    let first_rate = unknowns.len() - rates.len();
    let gradients: Vec<Vec<(usize, f64)>> = held.iter().map(|held| gradient(held, &unknowns)).collect();
    [balance(&held, &gradients, unknowns.len(), first_rate), curvature(&held, &gradients, &unknowns)]
}

fn unknowns(sheet: &Sheet, rates: &[Rate]) -> Vec<Unknown> {
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
    let of = |e: usize| {
        let shifts = axes.map(|axis| Unknown::Shift(e, axis));
        shifts.into_iter().chain(turns(sheet, e).into_iter().map(move |axis| Unknown::Turn(e, axis)))
    };
    let elements = (0..sheet.bodies.len()).flat_map(of);
    elements.chain(rates.iter().map(|rate| Unknown::Rate(*rate))).collect()
}

fn gradient(held: &Held<'_>, unknowns: &[Unknown]) -> Vec<(usize, f64)> {
    let slope = |k: usize| {
        let g = |x: f64| held.gap(&[(unknowns[k], x)]);
        (8.0 * (g(STEP) - g(-STEP)) - (g(2.0 * STEP) - g(-2.0 * STEP))) / (12.0 * STEP)
    };
    held.own(unknowns).into_iter().map(|k| (k, slope(k))).collect()
}

fn balance(held: &[Held<'_>], gradients: &[Vec<(usize, f64)>], n: usize, first_rate: usize) -> Finding {
    let mut residual = DVector::zeros(n);
    residual[first_rate] = 1.0;
    let (mut least_force, mut gap) = (f64::INFINITY, 0.0_f64);
    for (held, gradient) in held.iter().zip(gradients) {
        gradient.iter().for_each(|(k, slope)| residual[*k] += slope * held.force);
        least_force = least_force.min(held.force);
        gap = gap.max((held.force * held.gap(&[])).abs());
    }
    let wrong = |figure: f64, words: String| Finding::new(Check::Balance, Verdict::False, Some(figure), words);
    let left = residual.amax();
    match () {
        () if least_force < 0.0 => wrong(least_force, format!("a contact pulls: its force is {least_force:.3e}")),
        () if gap.is_nan() || gap > COMPLEMENTARITY => {
            wrong(gap, format!("a contact that carries is not closed: force times gap is {gap:.3e}"))
        }
        () if left.is_nan() || left > RESIDUAL => {
            wrong(left, format!("the recorded forces do not balance the roll: {left:.3e} is left"))
        }
        () => {
            let words = format!("the recorded forces push, on closed contacts, and balance the roll to {left:.1e}");
            Finding::new(Check::Balance, Verdict::Proved, Some(left), words)
        }
    }
}

fn curvature(held: &[Held<'_>], gradients: &[Vec<(usize, f64)>], unknowns: &[Unknown]) -> Finding {
    let n = unknowns.len();
    let (mut of_sum, mut gram) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for (held, gradient) in held.iter().zip(gradients).filter(|(held, _)| held.force > LOADED) {
        for (i, x) in gradient {
            gradient.iter().for_each(|(j, y)| gram[(*i, *j)] += x * y);
        }
        let own = held.own(unknowns);
        for (position, &i) in own.iter().enumerate() {
            for &j in &own[..=position] {
                // (4 D(h/2) − D(h))/3 has an error of fourth order.
                let at = |h: f64| mixed(held, [unknowns[i], unknowns[j]], i == j, h);
                let second = (4.0 * at(0.5 * LONG_STEP) - at(LONG_STEP)) / 3.0;
                of_sum[(i, j)] -= held.force * second;
                if i != j {
                    of_sum[(j, i)] -= held.force * second;
                }
            }
        }
    }
    let (values, _) = kept(&of_sum, &gram);
    let scale = values.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
    let say = |verdict, figure: f64, words: String| Finding::new(Check::Curvature, verdict, Some(figure), words);
    match values.first() {
        Some(lowest) if lowest.is_nan() => say(Verdict::Open, *lowest, "the curvature is not finite".into()),
        Some(lowest) if *lowest < -SADDLE * scale => {
            let words =
                format!("a motion that keeps the loaded contacts has the curvature {lowest:.3e}: it bends further");
            say(Verdict::False, *lowest, words)
        }
        Some(lowest) if *lowest < -ZERO_MODE * scale => {
            say(Verdict::Open, *lowest, format!("the least curvature, {lowest:.3e}, is too near to 0"))
        }
        _ => {
            let least = values.iter().copied().find(|v| *v > ZERO_MODE * scale).unwrap_or(0.0);
            let words =
                format!("no motion bends the sheet further, to second order: the least curvature is {least:.3e}");
            say(Verdict::Proved, least, words)
        }
    }
}

/// The second derivative along two unknowns by differences with the step h.
fn mixed(held: &Held<'_>, [one, other]: [Unknown; 2], same: bool, h: f64) -> f64 {
    if same {
        let g = |x: f64| held.gap(&[(one, x)]);
        return (g(h) - 2.0 * g(0.0) + g(-h)) / (h * h);
    }
    let g = |x: f64, y: f64| held.gap(&[(one, x), (other, y)]);
    (g(h, h) - g(h, -h) - g(-h, h) + g(-h, -h)) / (4.0 * h * h)
}
