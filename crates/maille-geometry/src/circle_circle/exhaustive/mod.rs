//! The exhaustive method: all minima of `h(θ) = ½ d²` along the moving circle by bisection, for any pair.
//!
//! The circle is divided into intervals. For each, the tests of `interval_bounds.rs` prove that it holds no
//! minimum, or that `h` is convex, so that it holds one if `h′` goes from − to + between its ends; otherwise it is
//! bisected. The sign of `h′` at an end is computed from the same numbers for both neighbours, so that each change
//! of sign counts once. Bisection ends at intervals of width `2π · 2⁻²⁴`, where the signs alone decide.
//!
//! **Nearly constant distances.** Near an equidistant pair (but not a coaxial one) the bounds are much larger than
//! `h′`, and bisection would go on everywhere. After [`MAX_SAMPLES`] samples the search restarts in a coarse mode:
//! intervals of width `2π/256` are decided by the signs of `h′` at their ends and centre. There `h` is a constant
//! plus a small smooth function, so the signs show all minima. The exception is the neighbourhood of the axis of
//! the base circle, where `h` can vary within an arbitrarily small angle and bisection continues. Intervals on
//! which `h` is constant up to rounding form a plateau. It is the answer, a continuum, unless a lower minimum
//! exists elsewhere.

mod grid;
mod interval_bounds;

use crate::circle_circle::angle::{Direction, START_RAD};
use crate::circle_circle::exhaustive::grid::{GRID, Grid, INTERVALS, MAX_LEVEL, half_width};
use crate::circle_circle::exhaustive::interval_bounds::{IntervalBounds, Verdict};
use crate::circle_circle::minimum::MAX_MINIMA;
use crate::circle_circle::pair_frame::{PairFrame, Sample};
use crate::tolerance::ROUNDING;
use std::f64::consts::TAU;

/// Number of samples after which the search becomes coarse. Of 300,000 random, linked and nearly touching pairs,
/// half took 18 to 28 samples, one in a thousand more than 110, and none more than 194.
const MAX_SAMPLES: usize = 400;
/// Bisections after which the signs decide in the coarse mode: width `2π/256`.
const COARSE_LEVEL: usize = 4;
/// Coarse mode: an interval is far from the axis if ρ is more than this many times its change over half the interval.
const FAR_FROM_AXIS: f64 = 16.0;
/// Minima closer than this are merged: `2π · 2⁻¹⁸ = 2.4e-5`. Their distances differ by its fourth power, which is
/// rounding.
const MERGE_RAD: f64 = TAU / (1 << 18) as f64;

/// An interval of θ that is still undecided.
#[derive(Clone, Copy, Default)]
struct Interval {
    /// Centre, in radians.
    center_rad: f64,
    /// The same as cosine and sine.
    center: Direction,
    /// Both ends.
    ends: [Direction; 2],
    /// Number of bisections so far.
    level: usize,
}

impl Interval {
    /// Right and left half.
    fn halves(&self, grid: &Grid) -> [Self; 2] {
        let quarter = half_width(self.level) / 2.0;
        let [left, right] = self.center.rotated_both_ways(grid.quarters[self.level]);
        let level = self.level + 1;
        [
            Self { center_rad: self.center_rad + quarter, center: right, ends: [self.center, self.ends[1]], level },
            Self { center_rad: self.center_rad - quarter, center: left, ends: [self.ends[0], self.center], level },
        ]
    }
}

/// The angles of the minima on the moving circle, unordered.
#[derive(Default)]
pub(crate) struct MinimumAngles {
    angles_rad: [f64; MAX_MINIMA],
    count: usize,
    /// Whether the distance is constant; then there is one angle.
    pub continuum: bool,
}

impl MinimumAngles {
    /// The angles, in radians.
    pub fn as_slice(&self) -> &[f64] {
        &self.angles_rad[..self.count]
    }

    /// A continuum, given by a representative.
    fn continuum(angle_rad: f64) -> Self {
        Self { angles_rad: [angle_rad, 0.0, 0.0, 0.0], count: 1, continuum: true }
    }

    /// Adds a minimum. If it is within [`MERGE_RAD`] of a known one, the one of smaller distance is kept.
    ///
    /// If there are too many, `h` is constant up to rounding, and the lowest one is kept as a continuum.
    pub fn add(&mut self, pair: &PairFrame<'_>, angle_rad: f64) {
        let distance = |angle_rad: f64| pair.sample_at_angle(angle_rad).distance();
        for known in &mut self.angles_rad[..self.count] {
            let difference = (angle_rad - *known).rem_euclid(TAU);
            if difference.min(TAU - difference) < MERGE_RAD {
                if distance(angle_rad) < distance(*known) {
                    *known = angle_rad;
                }
                return;
            }
        }
        if self.count < MAX_MINIMA {
            self.angles_rad[self.count] = angle_rad;
            self.count += 1;
        } else {
            let best = self.angles_rad.into_iter().chain([angle_rad]);
            let best = best.min_by(|p, q| distance(*p).total_cmp(&distance(*q)));
            *self = Self::continuum(best.unwrap_or(angle_rad));
        }
    }
}

/// The angles of all minima of `h`; one representative if `h` is constant.
pub(crate) fn minima(pair: &PairFrame<'_>) -> MinimumAngles {
    let constancy = constancy(pair);
    if let Constancy::Everywhere(angle_rad) = constancy {
        return MinimumAngles::continuum(angle_rad);
    }
    // Bisection with bounds; if it is too long or finds nothing, once more in the coarse mode.
    let mut search = Search { pair, bounds: IntervalBounds::new(pair), samples: 0, coarse: false, plateau: None };
    let mut angles = MinimumAngles::default();
    if constancy == Constancy::No && search.run(&mut angles) {
        return angles;
    }
    search.coarse = true;
    angles = MinimumAngles::default();
    search.run(&mut angles);
    // A plateau is the answer unless a minimum is lower.
    let distance = |angle_rad: f64| pair.sample_at_angle(angle_rad).distance();
    let by_distance = |p: &f64, q: &f64| distance(*p).total_cmp(&distance(*q));
    let lowest = angles.as_slice().iter().map(|&angle_rad| distance(angle_rad)).fold(f64::INFINITY, f64::min);
    match search.plateau {
        Some((plateau, angle_rad)) if plateau <= lowest + ROUNDING => MinimumAngles::continuum(angle_rad),
        _ if angles.count > 0 => angles,
        // Rounding hides every minimum: the lowest of many samples is better than none.
        _ => {
            let samples = (0..1024).map(|i| START_RAD + f64::from(i) * TAU / 1024.0);
            angles.add(pair, samples.min_by(by_distance).unwrap_or(START_RAD));
            angles
        }
    }
}

/// Is `h` constant up to rounding?
#[derive(PartialEq)]
enum Constancy {
    /// No.
    No,
    /// At all samples; but the circle passes near the axis of the base, where `h` can vary between them.
    AwayFromAxis,
    /// Yes. Holds the angle of the lowest sample.
    Everywhere(f64),
}

/// Is `h` constant up to rounding?
///
/// Sixteen samples suffice: `ρ h′` divides a trigonometric polynomial of degree four, which has at most eight roots
/// unless it is zero. So, unless ρ is small, `h′` is small between the samples too.
fn constancy(pair: &PairFrame<'_>) -> Constancy {
    let mut best = (f64::INFINITY, 0);
    let mut near_axis = false;
    for (index, center) in GRID.centers.iter().enumerate() {
        let sample = pair.sample(center.cos, center.sin);
        if !sample.is_stationary() {
            return Constancy::No;
        }
        near_axis |= sample.rho < half_width(0) * pair.radius;
        if sample.distance() < best.0 {
            best = (sample.distance(), index);
        }
    }
    if near_axis {
        return Constancy::AwayFromAxis;
    }
    Constancy::Everywhere(START_RAD + (best.1 as f64 + 0.5) * TAU / INTERVALS as f64)
}

/// One pass over the circle.
struct Search<'a> {
    pair: &'a PairFrame<'a>,
    bounds: IntervalBounds,
    /// Number of samples taken.
    samples: usize,
    /// Whether signs decide intervals of width `2π/256`, see the module documentation.
    coarse: bool,
    /// Smallest distance on intervals where it is constant, and its angle.
    plateau: Option<(f64, f64)>,
}

impl Search<'_> {
    /// Adds all minima. False if [`MAX_SAMPLES`] is exceeded or nothing is found.
    fn run(&mut self, angles: &mut MinimumAngles) -> bool {
        let (grid, pair) = (&*GRID, self.pair);
        // Depth first: the stack holds at most one undecided half per level, and the current interval.
        let mut stack = [Interval::default(); MAX_LEVEL + 2];
        for index in 0..INTERVALS {
            stack[0] = Interval {
                center_rad: START_RAD + (index as f64 + 0.5) * TAU / INTERVALS as f64,
                center: grid.centers[index],
                ends: [grid.ends[index], grid.ends[index + 1]],
                level: 0,
            };
            let mut open = 1;
            while open > 0 {
                open -= 1;
                let interval = &stack[open];
                self.samples += 1;
                if self.samples > MAX_SAMPLES && !self.coarse {
                    return false;
                }
                let sample = pair.sample(interval.center.cos, interval.center.sin);
                let half_width = half_width(interval.level);
                match self.bounds.verdict(pair, &sample, half_width) {
                    Verdict::NoMinimum => {}
                    Verdict::Convex => self.add_by_signs(interval, &sample, angles),
                    Verdict::Unknown if self.is_smallest(interval.level, &sample) => {
                        self.add_by_signs(interval, &sample, angles);
                    }
                    Verdict::Unknown => {
                        [stack[open], stack[open + 1]] = interval.halves(grid);
                        open += 2;
                    }
                }
            }
        }
        angles.count > 0
    }

    /// Is an interval small enough for the signs to decide?
    fn is_smallest(&self, level: usize, sample: &Sample) -> bool {
        let half_width = half_width(level);
        let rate = sample.ee[0].abs() / sample.rho;
        let away = sample.rho > FAR_FROM_AXIS * half_width * (rate + half_width * self.pair.radius);
        level == MAX_LEVEL || self.coarse && level >= COARSE_LEVEL && away
    }

    /// Adds the minima shown by the signs of `h′` at the ends and the centre of an interval.
    fn add_by_signs(&mut self, interval: &Interval, sample: &Sample, angles: &mut MinimumAngles) {
        let [first, last] = interval.ends.map(|end| self.pair.sample(end.cos, end.sin));
        if self.coarse && sample.is_stationary() && first.is_stationary() && last.is_stationary() {
            let here = (sample.distance(), interval.center_rad);
            self.plateau = self.plateau.filter(|plateau| plateau.0 <= here.0).or(Some(here));
            return;
        }
        let half_width = half_width(interval.level);
        let (left, right) = (interval.center_rad - half_width, interval.center_rad + half_width);
        // Both halves use the same sign at the centre, so that one minimum gives one bracket.
        let mut add = |bracket| {
            let angle_rad = safeguarded_newton(self.pair, bracket, sample, interval.center_rad);
            // By rounding, a kink on the axis can look like a minimum; the second derivatives show that it is not.
            let Direction { cos, sin } = Direction::at(angle_rad);
            let root = self.pair.sample(cos, sin);
            if root.curvature >= -ROUNDING && self.pair.second_derivative_at_fixed_foot(cos, sin, &root) >= -ROUNDING {
                angles.add(self.pair, angle_rad);
            }
        };
        if first.slope < 0.0 && sample.slope >= 0.0 {
            add([left, interval.center_rad]);
        }
        if sample.slope < 0.0 && last.slope >= 0.0 {
            add([interval.center_rad, right]);
        }
    }
}

/// The root of `h′` in a bracket where it goes from − to +, by Newton's method safeguarded by bisection (radians).
fn safeguarded_newton(pair: &PairFrame<'_>, mut bracket: [f64; 2], start: &Sample, start_rad: f64) -> f64 {
    let (mut angle_rad, mut slope, mut curvature) = (start_rad, start.slope, start.curvature);
    let mut last_step = 2.0 * (bracket[1] - bracket[0]);
    for _ in 0..64 {
        bracket[usize::from(slope >= 0.0)] = angle_rad;
        let newton = angle_rad - slope / curvature;
        let inside = newton >= bracket[0] && newton <= bracket[1];
        // Newton steps must at least halve each time. At quartic minima and in rounding noise they do not: bisect.
        let next = if inside && (newton - angle_rad).abs() < 0.5 * last_step {
            newton
        } else {
            0.5 * (bracket[0] + bracket[1])
        };
        last_step = (next - angle_rad).abs();
        angle_rad = next;
        // Newton converges quadratically: after a step of this size the next is below rounding, close to the axis
        // too.
        if last_step < 1e-11 && next == newton || last_step < 1e-16 {
            break;
        }
        let sample = pair.sample_at_angle(angle_rad);
        (slope, curvature) = (sample.slope, sample.curvature);
        if slope == 0.0 {
            break;
        }
    }
    angle_rad
}
