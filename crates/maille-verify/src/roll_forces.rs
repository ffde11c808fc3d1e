//! The forces of a rolled state: their balance, and the curvature of −Σ μ g on the motions that keep the loaded contacts.
//!
//! **Unknowns.** A translation and a turn of every element, and the rates of lattice and turns with what is free. Motions that change
//! nothing, about the axis and along it, and a change of height with l1, stay among them: their curvature is 0.
//!
//! **A contact.** The distance d(y, θ) of the point θ of ring b from the circle of ring a, as the unknowns move by y; derivatives are
//! differences of fourth order. The least distance over θ has ∇²g = d_yy − d_yθ d_θy/d_θθ. Where one of the cores is no circle, slopes are those at
//! points that stay, and second derivatives are differences of slopes at points that are found anew.

use crate::{
    apart::Arc,
    balance::{COMPLEMENTARITY, RESIDUAL, least, placed, placed_on_curves},
    curvature::{CURVATURE, Curvature, FLATTEST, ZERO_MODE, kept, turns},
    curve_pair::CurveContact,
    record::Contact,
    report::{Check, Finding, Verdict},
    rolled::Motions,
    sheet::{Pair, Sheet, Vec3, distance, frame},
};
use maille_geometry::Circle;
use nalgebra::{DMatrix, DVector, Point3, Unit, UnitQuaternion};

/// Step of first derivatives, in core distances and radians.
const STEP: f64 = 1e-3;
/// Shares of the step of slopes of curves that are tried where its rounding, or what it leaves out, hides the sign of a curvature.
const OTHER_STEPS: [f64; 2] = [0.3, 3.0];
/// Step of second derivatives.
const LONG_STEP: f64 = 1e-2;
/// Contacts that carry more are kept.
const LOADED: f64 = 1e-8;
/// A curvature below this share of the largest, with a minus, is no rounding.
const SADDLE: f64 = 1e-6;
/// The matrices are dense.
const MOST_UNKNOWNS: usize = 400;

/// What is free: a rate of both lattice vectors, and of both turns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rate {
    pub lattice: [Vec3; 2],
    pub turn_rad: [f64; 2],
}

/// What is maximised.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Objective {
    /// The first rate.
    FirstRate,
    /// The gap that all pairs keep; it is this in the state.
    Gap(f64),
    /// This sign times the mean distance of the elements from the axis.
    Radius(f64),
}

/// What the roll says of its certificate.
pub(crate) struct Written {
    pub min_multiplier: Option<f64>,
    pub min_curvature: Option<f64>,
    pub zero_modes: u64,
}

/// A motion that one unknown makes.
#[derive(Clone, Copy)]
enum Unknown {
    /// The point along ring b.
    Point,
    Shift(usize, Vec3),
    Turn(usize, Vec3),
    Rate(Rate),
    /// The gap that all pairs keep.
    Gap,
}

impl Unknown {
    fn name(&self) -> String {
        match self {
            Unknown::Point => "a point".into(),
            Unknown::Gap => "the gap".into(),
            Unknown::Shift(e, _) => format!("a shift of element {e}"),
            Unknown::Turn(e, _) => format!("a turn of element {e}"),
            Unknown::Rate(rate) if rate.turn_rad != [0.0; 2] => "the curvature".into(),
            Unknown::Rate(_) => "a strain that is free".into(),
        }
    }
}

/// Where two cores are closed.
enum Closed {
    /// A point of ring b, in the frame of its element.
    Point(Vec3),
    /// Of curves.
    Curves(Box<CurveContact>),
}

/// A pair of rings next to a point at which they are closed.
struct Held<'a> {
    sheet: &'a Sheet,
    roll: Motions,
    pair: Pair,
    /// What is closed.
    at: Closed,
    force: f64,
    /// The gap that it keeps.
    keeps: f64,
}

impl Held<'_> {
    /// The distance of the point, less the minor radii, when the unknowns have moved by these steps; of two curves that of the points where they
    /// are closed.
    fn gap(&self, steps: &[(Unknown, f64)]) -> f64 {
        self.gap_of(steps, if let Closed::Curves(contact) = &self.at { contact.arc_lengths() } else { [0.0; 2] })
    }

    /// The slope along an unknown when others have moved by these steps, at the points of two curves that are then nearest: these do not count for
    /// it, as the distance is least there.
    fn slope_after(&self, contact: &CurveContact, along: Unknown, steps: &[(Unknown, f64)]) -> f64 {
        let Ok(s) = contact.least(&self.poses(steps)) else { return f64::NAN };
        let g = |x: f64| {
            let all: Vec<(Unknown, f64)> = steps.iter().copied().chain([(along, x)]).collect();
            self.gap_of(&all, s)
        };
        // Of sixth order, with a long step: its rounding is divided by a short one.
        let h = self.step(LONG_STEP);
        let odd = |k: f64| g(k * h) - g(-k * h);
        (45.0 * odd(1.0) - 9.0 * odd(2.0) + odd(3.0)) / (60.0 * h)
    }

    /// Where the elements of both rings stand when the unknowns have moved by these steps; the second in its image.
    fn poses(&self, steps: &[(Unknown, f64)]) -> [(Vec3, UnitQuaternion<f64>); 2] {
        let (a, b, shift) = self.pair;
        let (mut lattice, mut roll) = (self.sheet.lattice, self.roll);
        for (unknown, x) in steps {
            if let Unknown::Rate(rate) = unknown {
                for k in 0..2 {
                    lattice[k] += rate.lattice[k] * *x;
                    roll.turn_rad[k] += rate.turn_rad[k] * x;
                }
            }
        }
        let body = |ring: usize| {
            let (element, body) = (self.sheet.rings[ring].element, &self.sheet.bodies[self.sheet.rings[ring].element]);
            let (mut at, mut turn) = (body.position, Vec3::zeros());
            for (unknown, x) in steps {
                match unknown {
                    Unknown::Shift(e, by) if *e == element => at += by * *x,
                    Unknown::Turn(e, by) if *e == element => turn += by * *x,
                    _ => {}
                }
            }
            (at, UnitQuaternion::from_scaled_axis(turn) * body.turn)
        };
        let (image, (at, turn)) = (roll.image(lattice, shift), body(b));
        [body(a), ((image * Point3::from(at)).coords, image.rotation * turn)]
    }

    /// As [`Self::gap`], at two arc lengths of curves.
    fn gap_of(&self, steps: &[(Unknown, f64)], s: [f64; 2]) -> f64 {
        let (a, b, _) = self.pair;
        let sum = |of: fn(&Unknown) -> bool| steps.iter().filter(|(u, _)| of(u)).map(|(_, x)| x).sum::<f64>();
        let beyond = self.keeps + sum(|unknown| matches!(unknown, Unknown::Gap));
        let poses = self.poses(steps);
        let point = match &self.at {
            Closed::Point(point) => point,
            Closed::Curves(contact) => return contact.gap_at(&poses, s) - beyond,
        };
        let ([first, second], [one, other]) = (poses, [a, b].map(|ring| &self.sheet.rings[ring]));
        let circle = Circle::new(first.0 + first.1 * one.arm, Unit::new_normalize(first.1 * one.normal), one.radius);
        let along = sum(|unknown| matches!(unknown, Unknown::Point));
        let forward = UnitQuaternion::from_axis_angle(&Unit::new_normalize(second.1 * other.normal), along);
        let point = second.0 + second.1 * other.arm + forward * (second.1 * point);
        distance(&point, &circle) - self.sheet.touching(a, b) - beyond
    }

    /// A step of this share of the core distance.
    fn step(&self, share: f64) -> f64 {
        share * self.sheet.touching(self.pair.0, self.pair.1)
    }

    /// The unknowns that move the pair.
    fn own(&self, unknowns: &[Unknown]) -> Vec<usize> {
        let (a, b, shift) = self.pair;
        let elements = [self.sheet.rings[a].element, self.sheet.rings[b].element];
        let moves = |unknown: &Unknown| match unknown {
            Unknown::Shift(e, _) | Unknown::Turn(e, _) => elements.contains(e),
            Unknown::Rate(_) => shift != [0, 0],
            Unknown::Gap => true,
            Unknown::Point => false,
        };
        (0..unknowns.len()).filter(|&k| moves(&unknowns[k])).collect()
    }
}

/// The rings of the state with their recorded contacts.
pub(crate) fn roll_forces(
    sheet: &Sheet,
    contacts: &[Contact],
    (objective, rates): (Objective, &[Rate]),
    unit: f64,
    written: Option<&Written>,
) -> [Finding; 2] {
    let both = |verdict, words: String| {
        [Check::Balance, Check::Curvature].map(|check| Finding::new(check, verdict, None, words.clone()))
    };
    let Some(roll) = &sheet.roll else { return both(Verdict::Open, "the sheet is flat".into()) };
    let keeps = if let Objective::Gap(gap) = objective { gap } else { 0.0 };
    let mut held = Vec::new();
    for (k, contact) in contacts.iter().enumerate() {
        let pair = (contact.ring_a, contact.ring_b, contact.shift);
        if pair.0.max(pair.1) >= sheet.rings.len() {
            return both(Verdict::False, format!("contact {k} is of ring {}", pair.0.max(pair.1)));
        }
        if !roll.counts([pair.0, pair.1].map(|ring| sheet.rings[ring].element), pair.2) {
            return both(Verdict::False, format!("contact {k} is of elements that do not count for each other"));
        }
        let force = contact.force;
        if !sheet.is_round(pair) {
            match placed_on_curves(sheet, contact, unit) {
                Ok(found) if (force * found.slope()).abs() > RESIDUAL => {
                    let words = format!("contact {k} is not where its curves are nearest, by {:.1e}", found.slope());
                    return both(Verdict::False, words);
                }
                Ok(found) => {
                    let at = Closed::Curves(Box::new(found));
                    held.push(Held { sheet, roll: roll.motions, pair, at, force, keeps });
                }
                Err(words) => return both(Verdict::False, format!("contact {k} {words}")),
            }
            continue;
        }
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
        let angle = least(&arc, angle);
        let (u, v) = frame(&other.normal);
        let out = (u * angle.cos() + v * angle.sin()) * other.radius;
        let image = roll.motions.image(sheet.lattice, pair.2);
        let turn = image.rotation * sheet.bodies[sheet.rings[pair.1].element].turn;
        let at = Closed::Point(turn.inverse() * out);
        held.push(Held { sheet, roll: roll.motions, pair, at, force, keeps });
    }
    let mut unknowns = unknowns(sheet, rates);
    let first_rate = unknowns.len() - rates.len();
    unknowns.extend(matches!(objective, Objective::Gap(_)).then_some(Unknown::Gap));
    let radius =
        if let Objective::Radius(sign) = objective { Some(Radius { sheet, roll: roll.motions, sign }) } else { None };
    if unknowns.len() > MOST_UNKNOWNS {
        let words = format!("{} unknowns; up to {MOST_UNKNOWNS} are looked at", unknowns.len());
        return both(Verdict::Open, words);
    }
    let mut aim = DVector::zeros(unknowns.len());
    match objective {
        Objective::FirstRate => aim[first_rate] = 1.0,
        Objective::Gap(_) => aim[unknowns.len() - 1] = 1.0,
        Objective::Radius(_) => {}
    }
    if let Some(radius) = &radius {
        (0..unknowns.len()).for_each(|k| aim[k] = radius.slope(unknowns[k]));
    }
    let gradients: Vec<Vec<(usize, f64)>> = held.iter().map(|held| gradient(held, &unknowns)).collect();
    let bends = radius.map(|radius| radius.bends(&unknowns));
    let bends = bends.unwrap_or_else(|| DMatrix::zeros(unknowns.len(), unknowns.len()));
    let judged = |share: f64| curvature(&held, &gradients, &unknowns, &bends, (written, share));
    let first = judged(1.0);
    let is_open = first.verdict == Verdict::Open && held.iter().any(|held| matches!(held.at, Closed::Curves(_)));
    let shares = if is_open { &OTHER_STEPS[..] } else { &[] };
    let proved = |finding: &Finding| finding.verdict == Verdict::Proved;
    let curvature = shares.iter().map(|share| judged(*share)).find(proved).unwrap_or(first);
    [balance(&held, &gradients, &unknowns, aim, written), curvature]
}

/// The mean distance of the elements from the axis, as what is maximised.
struct Radius<'a> {
    sheet: &'a Sheet,
    roll: Motions,
    sign: f64,
}

impl Radius<'_> {
    fn at(&self, steps: &[(Unknown, f64)]) -> f64 {
        let (mut lattice, axis) = (self.sheet.lattice, self.roll.axis());
        let mut places: Vec<Vec3> = self.sheet.bodies.iter().map(|body| body.position).collect();
        for (unknown, x) in steps {
            match unknown {
                Unknown::Shift(e, by) => places[*e] += by * *x,
                Unknown::Rate(rate) => (0..2).for_each(|k| lattice[k] += rate.lattice[k] * *x),
                _ => {}
            }
        }
        let height = self.roll.axis_distance(lattice);
        let away = |place: &Vec3| (place + Vec3::z() * height).cross(&axis).norm();
        self.sign * places.iter().map(away).sum::<f64>() / places.len() as f64
    }

    fn slope(&self, unknown: Unknown) -> f64 {
        let (f, h) = (|x: f64| self.at(&[(unknown, x)]), STEP);
        (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
    }

    /// Its second derivatives.
    fn bends(&self, unknowns: &[Unknown]) -> DMatrix<f64> {
        let n = unknowns.len();
        let (f, h) = (|steps: &[(Unknown, f64)]| self.at(steps), LONG_STEP);
        let second = |i: usize, j: usize, h: f64| match i == j {
            true => (f(&[(unknowns[i], h)]) - 2.0 * f(&[]) + f(&[(unknowns[i], -h)])) / (h * h),
            false => {
                let g = |x: f64, y: f64| f(&[(unknowns[i], x), (unknowns[j], y)]);
                (g(h, h) - g(h, -h) - g(-h, h) + g(-h, -h)) / (4.0 * h * h)
            }
        };
        let moves = |k: usize| matches!(unknowns[k], Unknown::Shift(..) | Unknown::Rate(_));
        DMatrix::from_fn(n, n, |i, j| match moves(i) && moves(j) {
            true => (second(i, j, h) - 20.0 * second(i, j, 0.5 * h) + 64.0 * second(i, j, 0.25 * h)) / 45.0,
            false => 0.0,
        })
    }
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
        let (g, h) = (|x: f64| held.gap(&[(unknowns[k], x)]), held.step(STEP));
        (8.0 * (g(h) - g(-h)) - (g(2.0 * h) - g(-2.0 * h))) / (12.0 * h)
    };
    held.own(unknowns).into_iter().map(|k| (k, slope(k))).collect()
}

fn balance(
    held: &[Held<'_>],
    gradients: &[Vec<(usize, f64)>],
    unknowns: &[Unknown],
    aim: DVector<f64>,
    written: Option<&Written>,
) -> Finding {
    let mut residual = aim;
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
            let what = unknowns[residual.iamax()].name();
            wrong(left, format!("the recorded forces do not balance the roll: {left:.3e} is left on {what}"))
        }
        // Contacts that carry next to nothing are not in the state: the least can be below all that are.
        () if written.and_then(|w| w.min_multiplier).is_some_and(|least| least > least_force + RESIDUAL) => {
            let least = written.and_then(|w| w.min_multiplier);
            wrong(least_force, format!("min_multiplier is {least:?}, the least force of the state {least_force:?}"))
        }
        () => {
            let words = format!("the recorded forces push, on closed contacts, and balance the roll to {left:.1e}");
            Finding::new(Check::Balance, Verdict::Proved, Some(left), words)
        }
    }
}

fn curvature(
    held: &[Held<'_>],
    gradients: &[Vec<(usize, f64)>],
    unknowns: &[Unknown],
    bends: &DMatrix<f64>,
    (written, share): (Option<&Written>, f64),
) -> Finding {
    let n = unknowns.len();
    let (mut of_sum, mut gram) = (-bends, DMatrix::zeros(n, n));
    for (held, gradient) in held.iter().zip(gradients).filter(|(held, _)| held.force > LOADED) {
        for (i, x) in gradient {
            gradient.iter().for_each(|(j, y)| gram[(*i, *j)] += x * y);
        }
        let own = held.own(unknowns);
        let (bend, aside) = match held.at {
            Closed::Point(_) => {
                let aside = own.iter().map(|&i| second(held, unknowns[i], Some(Unknown::Point), share));
                (second(held, Unknown::Point, None, share), aside.collect())
            }
            Closed::Curves(_) => (1.0, vec![0.0; own.len()]),
        };
        for (p, &i) in own.iter().enumerate() {
            for (q, &j) in own[..=p].iter().enumerate() {
                let other = (i != j).then_some(unknowns[j]);
                let term = held.force * (second(held, unknowns[i], other, share) - aside[p] * aside[q] / bend);
                of_sum[(i, j)] -= term;
                if i != j {
                    of_sum[(j, i)] -= term;
                }
            }
        }
    }
    let all = of(&of_sum, &gram);
    let say = |verdict, figure: Option<f64>, words: String| Finding::new(Check::Curvature, verdict, figure, words);
    let scale = all.scale();
    match all.values.first() {
        Some(lowest) if lowest.is_nan() => return say(Verdict::Open, None, "the curvature is not finite".into()),
        Some(&lowest) if lowest < -SADDLE * scale => {
            let words =
                format!("a motion that keeps the loaded contacts has the curvature {lowest:.3e}: it bends further");
            return say(Verdict::False, Some(lowest), words);
        }
        Some(&lowest) if lowest < -ZERO_MODE * scale => {
            return say(Verdict::Open, Some(lowest), format!("the least curvature, {lowest:.3e}, is too near to 0"));
        }
        _ => {}
    }
    // The roll's own figures are those with the first element at its place.
    let free: Vec<usize> = (0..n).filter(|&k| !matches!(unknowns[k], Unknown::Shift(0, _))).collect();
    let block = |of: &DMatrix<f64>| DMatrix::from_fn(free.len(), free.len(), |i, j| of[(free[i], free[j])]);
    let own = of(&block(&of_sum), &block(&gram));
    let (least, modes) = (own.least(), own.zero_modes());
    if let Some(written) = written {
        let apart = match (written.min_curvature, least) {
            (Some(written), Some(found)) => (written - found).abs() > CURVATURE * found.abs().max(written.abs()),
            (None, None) => false,
            _ => true,
        };
        if apart || written.zero_modes != modes {
            let words = format!(
                "min_curvature is {:?} with {} zero modes, {least:?} with {modes} in the state",
                written.min_curvature, written.zero_modes
            );
            // An eigenvalue about the size that counts as zero is none in one computation and one in another.
            let verdict = if own.near_zero() { Verdict::Open } else { Verdict::False };
            return say(verdict, least, words);
        }
    }
    let words = match least {
        Some(least) => {
            format!("no motion bends the sheet further, to second order: the least curvature is {least:.3e}")
        }
        None => "no motion that keeps the loaded contacts has a curvature".into(),
    };
    say(Verdict::Proved, least, words)
}

fn of(of_sum: &DMatrix<f64>, gram: &DMatrix<f64>) -> Curvature {
    let (values, idle) = kept(of_sum, gram);
    Curvature { values, idle, flat: false }
}

/// The second derivative of the distance along one unknown, or mixed along two. With D(h) the usual difference of second order,
/// (D(h) − 20 D(h/2) + 64 D(h/4))/45 has an error of sixth order.
///
/// Of two curves it is a difference of fourth order of slopes, with this share of the usual step.
fn second(held: &Held<'_>, one: Unknown, other: Option<Unknown>, share: f64) -> f64 {
    if let Closed::Curves(contact) = &held.at {
        let (g, h) = (|x: f64| held.slope_after(contact, one, &[(other.unwrap_or(one), x)]), share * contact.step());
        return (8.0 * (g(h) - g(-h)) - (g(2.0 * h) - g(-2.0 * h))) / (12.0 * h);
    }
    let at = |h: f64| match other {
        None => {
            let g = |x: f64| held.gap(&[(one, x)]);
            (g(h) - 2.0 * g(0.0) + g(-h)) / (h * h)
        }
        Some(other) => {
            let g = |x: f64, y: f64| held.gap(&[(one, x), (other, y)]);
            (g(h, h) - g(h, -h) - g(-h, h) + g(-h, -h)) / (4.0 * h * h)
        }
    };
    let h = held.step(LONG_STEP);
    (at(h) - 20.0 * at(0.5 * h) + 64.0 * at(0.25 * h)) / 45.0
}
