//! Complete enumeration of the minima of `h(θ) = ½ d²` along the moving circle.
//!
//! The circle is cut into intervals, and each is put to the tests of [`IntervalBounds::verdict`]: it holds no minimum, or it is
//! convex and holds one if h′ goes from − to + between its ends, or it is halved. Every end has one sign of h′,
//! computed from the same numbers by both neighbours, so that each change of sign counts once. Halving ends at width
//! `2π · 2⁻²⁴`, where the signs alone decide.
//!
//! **Nearly constant distances.** For pairs close to an equidistant one (not a coaxial one) the bounds are far larger
//! than h′, and halving would go on everywhere. After [`MAX_SAMPLES`] it starts anew, coarsely: intervals of `2π/256`
//! are decided by the signs of h′ at their ends and centre, except near the axis of the base, where `h` can vary
//! within any small angle and halving goes on. There `h` is a constant plus a small smooth function, so the signs show
//! what there is. Intervals that are level to rounding are no minima but a plateau; it is the answer, a continuum, unless
//! a minimum below it was found beside it.

mod grid;
mod interval_bounds;

use crate::circle_circle::angle::{Direction, START_RAD};
use crate::circle_circle::exhaustive::grid::{GRID, Grid, INTERVALS, MAX_LEVEL, half_width};
use crate::circle_circle::exhaustive::interval_bounds::{IntervalBounds, Verdict};
use crate::circle_circle::minimum::MAX_MINIMA;
use crate::circle_circle::pair_frame::{PairFrame, Sample};
use crate::tolerance::ROUNDING;
use std::f64::consts::TAU;

/// Samples after which halving is given up. Over 300,000 random, linked and nearly touching pairs half took 18 to 28,
/// one in a thousand more than 110, none more than 194.
const MAX_SAMPLES: usize = 400;
/// Halvings after which the signs decide in the coarse search: width 2π/256.
const COARSE_LEVEL: usize = 4;
/// Away from the axis, there: ρ over its change in half an interval.
const FAR_FROM_AXIS: f64 = 16.0;
/// Minima nearer to each other than this are one: at `2π · 2⁻¹⁸` two differ by the fourth power, rounding.
const MERGE_RAD: f64 = TAU / (1 << 18) as f64;

/// An interval still to be decided.
#[derive(Clone, Copy, Default)]
struct Interval {
    center_rad: f64,
    center: Direction,
    ends: [Direction; 2],
    level: usize,
}

impl Interval {
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

/// The angles of the minima, unordered.
#[derive(Default)]
pub(crate) struct MinimumAngles {
    angles_rad: [f64; MAX_MINIMA],
    count: usize,
    pub continuum: bool,
}

impl MinimumAngles {
    pub fn as_slice(&self) -> &[f64] {
        &self.angles_rad[..self.count]
    }

    /// A continuum, by its representative.
    fn continuum(angle_rad: f64) -> Self {
        Self { angles_rad: [angle_rad, 0.0, 0.0, 0.0], count: 1, continuum: true }
    }

    /// Adds a minimum unless it is there already, in which case the smaller of the two stays. More minima than can
    /// exist are rounding around a constant.
    pub fn add(&mut self, pair: &PairFrame<'_>, angle_rad: f64) {
        let distance = |angle_rad: f64| pair.sample_at_angle(angle_rad).distance();
        for known in &mut self.angles_rad[..self.count] {
            let apart = (angle_rad - *known).rem_euclid(TAU);
            if apart.min(TAU - apart) < MERGE_RAD {
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

/// All minima of `h`; one representative if `h` is constant.
pub(crate) fn minima(pair: &PairFrame<'_>) -> MinimumAngles {
    let constancy = constancy(pair);
    if let Constancy::Everywhere(angle_rad) = constancy {
        return MinimumAngles::continuum(angle_rad);
    }
    let mut search = Search { pair, bounds: IntervalBounds::new(pair), samples: 0, coarse: false, plateau: None };
    let mut angles = MinimumAngles::default();
    if constancy == Constancy::No && search.run(&mut angles) {
        return angles;
    }
    search.coarse = true;
    angles = MinimumAngles::default();
    search.run(&mut angles);
    let distance = |angle_rad: f64| pair.sample_at_angle(angle_rad).distance();
    let by_distance = |p: &f64, q: &f64| distance(*p).total_cmp(&distance(*q));
    let lowest = angles.as_slice().iter().map(|&angle_rad| distance(angle_rad)).fold(f64::INFINITY, f64::min);
    match search.plateau {
        Some((plateau, angle_rad)) if plateau <= lowest + ROUNDING => MinimumAngles::continuum(angle_rad),
        _ if angles.count > 0 => angles,
        // Rounding hides every minimum: give the lowest of many samples rather than none.
        _ => {
            let samples = (0..1024).map(|i| START_RAD + f64::from(i) * TAU / 1024.0);
            angles.add(pair, samples.min_by(by_distance).unwrap_or(START_RAD));
            angles
        }
    }
}

#[derive(PartialEq)]
enum Constancy {
    No,
    /// At all samples, but the circle passes near the axis of the base, where anything can be between them.
    AwayFromAxis,
    /// With the angle of the smallest sample.
    Everywhere(f64),
}

/// Is `h` constant?
///
/// Sixteen samples suffice: ρ h′ divides a trigonometric polynomial of degree four, which has eight roots at most
/// unless it is zero; so where ρ is no small divisor, h′ is small between the samples too.
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

/// One walk around the circle.
struct Search<'a> {
    pair: &'a PairFrame<'a>,
    bounds: IntervalBounds,
    samples: usize,
    coarse: bool,
    /// Smallest distance of the level intervals, and its angle.
    plateau: Option<(f64, f64)>,
}

impl Search<'_> {
    /// Adds all minima; false if the samples were used up or nothing was found.
    fn run(&mut self, angles: &mut MinimumAngles) -> bool {
        let (grid, pair) = (&*GRID, self.pair);
        // Depth first: at most one undecided right half a level, and the interval at hand.
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

    fn is_smallest(&self, level: usize, sample: &Sample) -> bool {
        let half_width = half_width(level);
        let rate = sample.ee[0].abs() / sample.rho;
        let away = sample.rho > FAR_FROM_AXIS * half_width * (rate + half_width * self.pair.radius);
        level == MAX_LEVEL || self.coarse && level >= COARSE_LEVEL && away
    }

    /// Adds the minima that the signs of h′ show at the ends and the centre of an interval.
    fn add_by_signs(&mut self, interval: &Interval, sample: &Sample, angles: &mut MinimumAngles) {
        let [first, last] = interval.ends.map(|end| self.pair.sample(end.cos, end.sin));
        if self.coarse && sample.is_stationary() && first.is_stationary() && last.is_stationary() {
            let here = (sample.distance(), interval.center_rad);
            self.plateau = self.plateau.filter(|plateau| plateau.0 <= here.0).or(Some(here));
            return;
        }
        let half_width = half_width(interval.level);
        let (left, right) = (interval.center_rad - half_width, interval.center_rad + half_width);
        // One bracket where there is one minimum: the halves share the centre's sign.
        let mut add = |bracket| {
            let angle_rad = safeguarded_newton(self.pair, bracket, sample, interval.center_rad);
            // A kink on the axis can look like a minimum, by rounding: not in the second derivatives.
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

/// The root of `h′` in a bracket where it goes from − to +: Newton's method, kept inside by bisection.
fn safeguarded_newton(pair: &PairFrame<'_>, mut bracket: [f64; 2], start: &Sample, start_rad: f64) -> f64 {
    let (mut angle_rad, mut slope, mut curvature) = (start_rad, start.slope, start.curvature);
    let mut last_step = 2.0 * (bracket[1] - bracket[0]);
    for _ in 0..64 {
        bracket[usize::from(slope >= 0.0)] = angle_rad;
        let newton = angle_rad - slope / curvature;
        let inside = newton >= bracket[0] && newton <= bracket[1];
        // Steps that do not halve belong to bisection: quartic minima, and the noise around them.
        let next = if inside && (newton - angle_rad).abs() < 0.5 * last_step {
            newton
        } else {
            0.5 * (bracket[0] + bracket[1])
        };
        last_step = (next - angle_rad).abs();
        angle_rad = next;
        // After a quadratic step of this size the next one is below rounding, close to the axis too.
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
