//! Derivatives beside differences of limits that are solved anew.
//!
//! A number is compared by central differences where one choice of forces balances, else by differences to each side. A derivative that
//! agrees with the differences of one step agrees: the solves' rounding spoils short steps, curvature and other contacts long ones. One
//! that agrees at no step is wrong, unless other contacts carry within each step, or a limit within it is not found: those are counted.
//!
//! A changed design is solved from the state of the limit. Where the difference does not agree, it is solved from starts of its own: where
//! several states tie, the change chooses between them.

use super::{builtin, solved, solved_near, stretch};
use maille::{
    Answer, Design, Question, Status,
    sensitivity::{DesignVector, RingVector, Sensitivity},
};
use std::collections::BTreeSet;

/// Derivatives agree with differences to this, relative to the difference or to [`LEAST`] where that is larger.
const AGREE: f64 = 1e-5;
/// With lengths in reference radii.
const LEAST: f64 = 0.01;
/// Steps of differences, in reference radii or radians, in the order in which they are tried.
const STEPS: [f64; 7] = [1e-4, 1e-5, 1e-3, 1e-6, 3e-7, 1e-7, 3e-8];
/// A number is given up after so many steps in which a limit is not found, in the first of them also from starts of its own.
const HOPELESS: usize = 3;
/// Forces that carry, of a pull of 1.
const CARRIES: f64 = 1e-6;

/// Counts and the largest error of compared derivatives.
#[derive(Debug, Default)]
pub struct Tally {
    pub limits: usize,
    /// Derivatives that agree with central differences.
    pub central: usize,
    /// One-sided derivatives that agree with differences to their side.
    pub sides: usize,
    /// Numbers with different derivatives to both sides.
    pub kinks: usize,
    /// One-sided derivatives that agree at no step, where other contacts carry within each.
    pub changed: usize,
    /// The same, where a limit is not found within each step.
    pub no_limit: usize,
    /// One-sided derivatives that agree at no step, for no such reason.
    pub wrong: usize,
    pub worst: f64,
    pub where_worst: String,
}

/// What differences say of a derivative.
enum Found {
    Agrees(f64),
    Changed,
    NoLimit,
    /// The nearest difference, and its error.
    Wrong(f64, f64),
}

/// A limit with its derivatives.
pub struct Case<'a> {
    pub design: &'a Design,
    pub question: &'a Question,
    pub answer: &'a Answer,
    pub found: &'a Sensitivity,
    pub label: String,
}

/// One unit change for each raw number of the design, by its name.
pub fn raw_numbers(design: &Design) -> Vec<(String, DesignVector)> {
    let rings = design.elements.iter().map(|element| element.rings.len()).sum();
    let zeros = || DesignVector::zeros(rings);
    let mut out = Vec::new();
    for k in 0..4 {
        let mut change = zeros();
        change.lattice[k / 2][k % 2] = 1.0;
        out.push((format!("a{}.{}", k / 2 + 1, ["x", "y"][k % 2]), change));
    }
    for ring in 0..rings {
        let mut add = |what: &str, set: &dyn Fn(&mut RingVector)| {
            let mut change = zeros();
            set(&mut change.rings[ring]);
            out.push((format!("ring {ring} {what}"), change));
        };
        add("R", &|r| r.major_radius = 1.0);
        add("r", &|r| r.minor_radius = 1.0);
        for k in 0..3 {
            add(&format!("offset {k}"), &|r| r.offset[k] = 1.0);
            add(&format!("tilt {k}"), &|r| r.tilt[k] = 1.0);
        }
    }
    out
}

/// Pairs that carry.
pub fn loaded(answer: &Answer) -> BTreeSet<(usize, usize, [i32; 2])> {
    let carrying = answer.contacts.iter().filter(|contact| contact.force > CARRIES);
    carrying.map(|contact| (contact.pair.ring_a, contact.pair.ring_b, contact.pair.shift)).collect()
}

/// The limit. One that attains its bound can stay 1e-10 below it, which differences would multiply.
pub fn limit(answer: &Answer) -> Option<f64> {
    if answer.status == Status::Global { answer.bound } else { answer.limit() }
}

impl Case<'_> {
    fn unit(&self, number: &str) -> f64 {
        if number.contains("tilt") { 1.0 } else { self.design.reference_radius }
    }

    /// The derivative `derivative` against the differences that `of` makes of the limits at the multiples `at` of a step.
    fn judge<const N: usize>(
        &self,
        (number, change): (&str, &DesignVector),
        derivative: f64,
        at: [f64; N],
        of: impl Fn([f64; N]) -> f64,
    ) -> Found {
        let unit = self.unit(number);
        let (mut best, mut changed, mut not_found) = (None, false, 0);
        for step in STEPS {
            if not_found == HOPELESS {
                break;
            }
            let beside = |k: f64| change.applied(self.design, k * step * unit);
            let judged = |answers: &[Answer; N]| {
                let values: Option<Vec<f64>> = answers.iter().map(limit).collect();
                let difference = of(values?.try_into().expect("one for each answer")) / (step * unit);
                let error = (derivative - difference).abs() * unit / (difference.abs() * unit).max(LEAST);
                Some((difference, error))
            };
            let near = judged(&at.map(|k| solved_near(&beside(k), self.question, self.answer)));
            if let Some((_, error)) = near.filter(|(_, error)| *error <= AGREE) {
                return Found::Agrees(error);
            }
            if near.is_none() && not_found > 0 {
                not_found += 1;
                continue;
            }
            let answers = at.map(|k| solved(&beside(k), self.question).1);
            let Some((difference, error)) = judged(&answers) else {
                not_found += 1;
                continue;
            };
            if error <= AGREE {
                return Found::Agrees(error);
            }
            let same = |answer: &Answer| loaded(answer) == loaded(&answers[0]);
            if !answers.iter().all(same) {
                changed = true;
            } else if best.is_none_or(|(_, least)| error < least) {
                best = Some((difference, error));
            }
        }
        match best {
            Some((difference, error)) => Found::Wrong(difference, error),
            None if changed => Found::Changed,
            None => Found::NoLimit,
        }
    }

    /// By central differences of fourth order; where other contacts carry to one side, by each side.
    pub fn central(&self, number: &str, change: &DesignVector, tally: &mut Tally) {
        let derivative = self.found.along(change);
        let of = |[f0, f1, f2, f3]: [f64; 4]| (f0 - 8.0 * f1 + 8.0 * f2 - f3) / 12.0;
        match self.judge((number, change), derivative, [-2.0, -1.0, 1.0, 2.0], of) {
            Found::Agrees(error) => {
                tally.central += 1;
                tally.worst(error, || format!("{} {number}", self.label));
            }
            _ => self.sides(number, change, tally),
        }
    }

    /// By differences of third order to each side.
    pub fn sides(&self, number: &str, change: &DesignVector, tally: &mut Tally) {
        let both = self.found.one_sided(change);
        tally.kinks += usize::from(both.is_kink());
        let f0 = limit(self.answer).expect("a limit");
        for (slope, sign) in [(both.backward, -1.0), (both.forward, 1.0)] {
            let derivative = slope.finite().unwrap_or(f64::NAN);
            let of = |[f1, f2, f3]: [f64; 3]| sign * (-11.0 * f0 + 18.0 * f1 - 9.0 * f2 + 2.0 * f3) / 6.0;
            let label = || format!("{} {number} {sign}: {both:?}", self.label);
            match self.judge((number, change), derivative, [1.0, 2.0, 3.0].map(|k| k * sign), of) {
                Found::Agrees(error) => {
                    tally.sides += 1;
                    tally.worst(error, label);
                }
                Found::Changed => {
                    println!("  other contacts: {}", label());
                    tally.changed += 1;
                }
                Found::NoLimit => {
                    println!("  no limit: {}", label());
                    tally.no_limit += 1;
                }
                Found::Wrong(difference, error) => {
                    println!("  wrong: {} {difference} {error:.1e}", label());
                    tally.wrong += 1;
                }
            }
        }
    }
}

impl Tally {
    fn worst(&mut self, error: f64, words: impl Fn() -> String) {
        if error > self.worst {
            (self.worst, self.where_worst) = (error, words());
        }
    }
}

/// All numbers of a built-in design.
pub fn compare(name: &str, directions: &[f64], l2: &[f64], tally: &mut Tally) {
    let design = &builtin(name);
    for (&direction, &l2) in directions.iter().flat_map(|d| l2.iter().map(move |l2| (d, l2))) {
        let question = &stretch(direction, l2);
        let (sheet, answer) = &solved(design, question);
        if !answer.is_limit() {
            continue;
        }
        tally.limits += 1;
        let found = &Sensitivity::of(&sheet.model_of(answer), question, answer).unwrap();
        let case = Case { design, question, answer, found, label: format!("{name} {direction}° l2 {l2}") };
        for (number, change) in raw_numbers(design) {
            match found.forces_are_unique() && !found.images_tie(&change) {
                true => case.central(&number, &change, tally),
                false => case.sides(&number, &change, tally),
            }
        }
    }
}
