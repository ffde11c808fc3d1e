//! The largest and the smallest l1 over all directions, between those of a map.
//!
//! A limit l1(φ) is smooth but where one set of contacts takes over from another: there it has a corner, which a map of a few
//! directions cuts off. The derivative follows from the forces of the limit. With f the force of a contact for a unit pull, n its normal
//! and X = A s the shift of its image in the sheet of the file, the mean S = Σ f n Xᵀ is what the contacts do on F, and by the envelope
//! theorem, for F(φ) = (1 + l1) D Dᵀ + (1 + l2) T Tᵀ + γ (D Tᵀ + T Dᵀ) with D along the pull and T across it,
//!
//! ```text
//! dl1/dφ = S : ∂F/∂φ,   ∂F/∂φ = (l1 − l2) (D Tᵀ + T Dᵀ) + 2 γ (T Tᵀ − D Dᵀ)
//! ```
//!
//! Between two directions a largest l1 is sought where their tangents meet, and where the cubic through values and slopes is largest, by
//! turns: the one finds corners, the other smooth maxima. The place that promises most comes first, until none promises more than
//! `ENOUGH`. Each limit is solved and certified as any other; images of a direction under the symmetries of the design count as solved.
//! Towards a direction in which no state has the width, what has limits ends. While the height rises that way, the last limit's state is
//! followed to the end, each direction by one local search from the state before; the last of them is solved as any other.
//! What rises and falls again between two directions whose tangents do not tell of it is not found.

mod place;

use self::place::{CLOSE_DEG, END_DEG, Place, Point, end, place, rounded};
use super::{
    map::OneLimit,
    request::{Finished, MapQuestion, Method, Task, Work},
    row::Asked,
};
use crate::{
    answer::Answer,
    lattice::Direction,
    model::{Model, of_cell},
    record::{ContactRecord, LimitRow, StateRecord, Status},
    symmetry::mirrored,
};
use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// What a place must promise beyond the best l1 to be tried.
const ENOUGH: f64 = 1e-7;
/// An l1 that is no farther beyond the map's own is theirs.
const SAME: f64 = 1e-9;
/// Limits that are solved for one extreme, at most.
const MOST: usize = 40;
/// Directions to which a state is followed, at most.
const MOST_TURNS: usize = 60;
/// Which l1 over all directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    Largest,
    Smallest,
}

impl Which {
    fn sign(self) -> f64 {
        if self == Which::Largest { 1.0 } else { -1.0 }
    }

    fn name(self) -> &'static str {
        if self == Which::Largest { "largest" } else { "smallest" }
    }
}

/// The largest and the smallest l1 of each l2 between the directions of a map, where they go beyond those of its rows: a row each, and
/// one for each image. `known` are its rows with their states. Those that it has of an earlier run are not sought again. After `cancel` those that are not
/// finished are left out.
pub fn extremes(
    models: &[Model],
    minor_radius: Option<f64>,
    question: &MapQuestion,
    known: &[(LimitRow, StateRecord)],
    cancel: &AtomicBool,
    work: &(dyn Fn(Task, Work) + Sync),
    finished: &(dyn Fn(Finished) + Sync),
) {
    let Method::Exact(options) = &question.method else { return };
    let both = [Which::Largest, Which::Smallest];
    let sought = question.l2.iter().flat_map(|&l2| both.map(|which| (l2, which)));
    let sought: Vec<_> = sought.collect();
    if question.directions_deg.len() < 2 || cancel.load(Ordering::Relaxed) {
        return;
    }
    let one = OneLimit::new(models, options, cancel);
    sought.par_iter().with_max_len(1).for_each(|&(l2, which)| {
        let (points, states) = (Vec::new(), Vec::new());
        let mut search = Search { question, one: &one, minor_radius, l2, sign: which.sign(), points, states };
        let there = |row: &LimitRow| row.l2 == l2 && row.extreme.as_deref() == Some(which.name());
        let there: Vec<f64> = known.iter().filter(|(row, _)| there(row)).map(|(row, _)| row.direction_deg).collect();
        // A run can be stopped between images.
        if there.first().is_some_and(|deg| search.images(*deg).len() == there.len()) {
            return;
        }
        for (row, state) in known.iter().filter(|(row, _)| row.l2 == l2 && row.extreme.is_none()) {
            search.add(row, state);
            search.keep(row, state);
        }
        for Finished { mut row, state } in search.run(cancel, work) {
            row.extreme = Some(which.name().to_owned());
            if !there.contains(&row.direction_deg) {
                finished(Finished { row, state });
            }
        }
    });
}

struct Search<'a> {
    question: &'a MapQuestion,
    one: &'a OneLimit<'a>,
    minor_radius: Option<f64>,
    l2: f64,
    sign: f64,
    /// In the order of their angles.
    points: Vec<Point>,
    /// The limits with their states; images have their own.
    states: Vec<(f64, Answer)>,
}

impl Search<'_> {
    /// The best limit and its images, where it is none of the map's.
    fn run(&mut self, cancel: &AtomicBool, work: &(dyn Fn(Task, Work) + Sync)) -> Vec<Finished> {
        let Some(mut best) = self.points.iter().filter_map(|point| point.height).max_by(f64::total_cmp) else {
            return Vec::new();
        };
        // With free width no direction is without it.
        let held = matches!(&self.question.method, Method::Exact(options) if !options.across.any());
        let (own, mut found, mut followed) = (best, Vec::new(), Vec::new());
        for count in 0..MOST {
            let ends = self.ends().filter(|end| held && !followed.contains(&(end.from_deg, end.deg)));
            let promising = self.places(count % 2 == 1).chain(ends).max_by(|a, b| {
                // Of images, which differ by rounding, the first.
                let coarse = |place: &Place| (place.promise / (1e-3 * ENOUGH)).round();
                coarse(a).total_cmp(&coarse(b)).then(b.deg.total_cmp(&a.deg))
            });
            let Some(mut place) = promising.filter(|place| place.promise > best + ENOUGH) else { break };
            let mut near = None;
            if let Some(from_deg) = place.from_deg {
                followed.push((place.from_deg, place.deg));
                let Some((last_deg, state)) = self.follow(from_deg, place.deg, cancel) else { continue };
                near = Some(state);
                let beyond_deg = last_deg + END_DEG.copysign(place.deg - last_deg);
                self.insert_images(Point { deg: beyond_deg, height: None, ends: true, slope: None, mirrored: false });
                place.deg = last_deg;
            }
            let task = Task { direction_deg: place.deg, l2: self.l2 };
            work(task, Work::Begins);
            let tried = self.solve(task, near.as_ref());
            work(task, Work::Ends);
            if cancel.load(Ordering::Relaxed) {
                return Vec::new();
            }
            let Some(one) = tried.first() else { break };
            self.add(&one.row, &one.state);
            tried.iter().for_each(|image| self.keep(&image.row, &image.state));
            if let Some(height) = one.row.l1.map(|l1| self.sign * l1).filter(|height| *height > best) {
                best = height;
                found = tried;
            }
        }
        if best > own + SAME { found } else { Vec::new() }
    }

    /// A limit, along each image of its direction in the range of the map; searched from a state near by, where one is given.
    fn solve(&self, Task { direction_deg, l2 }: Task, near: Option<&Answer>) -> Vec<Finished> {
        let begun = Instant::now();
        let solved_deg = near.map_or_else(|| self.one.representative_deg(direction_deg), |_| direction_deg);
        let solved = match near {
            Some(near) => self.one.solve_near(solved_deg, l2, near),
            None => self.one.solve(solved_deg, l2),
        };
        let wall_s = begun.elapsed().as_secs_f64();
        let along = |direction_deg: f64| {
            let (model, answer) = self.one.along(&solved, solved_deg, direction_deg);
            let task = Task { direction_deg, l2 };
            let image_of_deg = Some(solved_deg).filter(|solved_deg| *solved_deg != direction_deg);
            let (method, minor_radius) = (&self.question.method, self.minor_radius);
            Asked { task: &task, method, minor_radius, image_of_deg }.finished(&model, &answer, wall_s)
        };
        self.images(direction_deg).into_iter().map(along).collect()
    }

    /// The images of a direction in the range of the map, itself among them, in order.
    fn images(&self, direction_deg: f64) -> Vec<f64> {
        let mut out: Vec<f64> = Vec::new();
        for operation in &self.one.operations {
            out.extend(self.turns(operation.direction_deg(direction_deg)));
        }
        out.sort_by(f64::total_cmp);
        out.dedup_by(|a, b| (*a - *b).abs() < CLOSE_DEG / 4.0);
        out
    }

    /// Adds a limit along a direction and along its images.
    fn add(&mut self, row: &LimitRow, state: &StateRecord) {
        let deg = row.direction_deg;
        let cell = row.cell.parse().unwrap_or_default();
        let slope = direction_slope(&of_cell(self.one.models, cell), state).map(|slope| self.sign * slope);
        let height = row.l1.map(|l1| self.sign * l1);
        let ends = matches!(row.status, Status::L2Unreachable | Status::L2NotReached);
        let mirrored = mirrored(&self.one.operations, deg);
        self.insert_images(Point { deg, height, ends, slope, mirrored });
    }

    /// Keeps the state of a limit.
    fn keep(&mut self, row: &LimitRow, record: &StateRecord) {
        let model = of_cell(self.one.models, row.cell.parse().unwrap_or_default());
        let (Some(_), Some(state)) = (row.l1, record.state(&model)) else { return };
        let [[xx, xy], [yx, yy]] = record.deformation_gradient;
        let gradient = Matrix2::new(xx, xy, yx, yy);
        let answer = Answer { value: row.l1, gradient, state, ..Answer::new(&model, Status::Local) };
        self.states.push((row.direction_deg, answer));
    }

    /// The last direction towards `end_deg` to which the state of the limit along `from_deg` can be followed, with the limit there; none where
    /// it cannot be.
    fn follow(&self, from_deg: f64, end_deg: f64, cancel: &AtomicBool) -> Option<(f64, Answer)> {
        let near = |deg: f64| (deg - from_deg).abs() <= CLOSE_DEG / 4.0;
        let mut at = self.states.iter().find(|(deg, _)| near(*deg))?.1.clone();
        let (mut deg, mut step_deg) = (from_deg, 0.5 * (end_deg - from_deg));
        for _ in 0..MOST_TURNS {
            step_deg = step_deg.abs().min(0.5 * (end_deg - deg).abs()).copysign(end_deg - deg);
            if step_deg.abs() < 0.5 * END_DEG || cancel.load(Ordering::Relaxed) {
                break;
            }
            let next_deg = rounded(deg + step_deg);
            match self.one.turned(next_deg, self.l2, &at) {
                Some(next) => (deg, at, step_deg) = (next_deg, next, 2.0 * step_deg),
                None => step_deg *= 0.5,
            }
        }
        (deg != from_deg).then_some((deg, at))
    }

    /// Adds a point and its images.
    fn insert_images(&mut self, point: Point) {
        for operation in &self.one.operations {
            let turned = if operation.mirrors() { -1.0 } else { 1.0 };
            let slope = point.slope.map(|slope| slope * turned);
            for deg in self.turns(operation.direction_deg(point.deg)) {
                self.insert(Point { deg, slope, ..point });
            }
        }
    }

    /// A direction and its opposite, which are one pull, in the range of the map.
    fn turns(&self, direction_deg: f64) -> Vec<f64> {
        let all = self.question.directions_deg.iter();
        let (least, most) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), deg| (least.min(*deg), most.max(*deg)));
        let first = ((least - direction_deg) / 180.0).ceil();
        let turns = (0..).map(|turn| direction_deg + 180.0 * (first + f64::from(turn)));
        turns.take_while(|deg| *deg <= most).collect()
    }

    /// Of two for one direction the higher stays.
    fn insert(&mut self, point: Point) {
        let place = self.points.partition_point(|other| other.deg < point.deg - CLOSE_DEG / 4.0);
        match self.points.get_mut(place).filter(|other| other.deg <= point.deg + CLOSE_DEG / 4.0) {
            Some(other) if other.height < point.height => *other = point,
            Some(_) => {}
            None => self.points.insert(place, point),
        }
    }

    /// Where a larger height may be, between each two neighbours.
    fn places(&self, smooth: bool) -> impl Iterator<Item = Place> {
        self.points.windows(2).filter_map(move |pair| place(&pair[0], &pair[1], smooth))
    }

    /// Directions without a state beside one with a limit, towards which the height rises.
    fn ends(&self) -> impl Iterator<Item = Place> {
        self.points.windows(2).filter_map(|pair| match pair[1].ends {
            true => end(&pair[0], &pair[1]),
            false => end(&pair[1], &pair[0]),
        })
    }
}

/// dl1/dφ per radian, from the forces of a limit in the model of its cell; none where it carries none.
#[doc(hidden)]
pub fn direction_slope(model: &Model, state: &StateRecord) -> Option<f64> {
    let [a1, a2] = [model.start.a1, model.start.a2].map(|a| a.xy());
    let part = |contact: &ContactRecord| {
        let [m, n] = contact.shift.map(f64::from);
        let normal = Vector2::new(contact.normal[0], contact.normal[1]);
        normal * (a1 * m + a2 * n).transpose() * contact.force
    };
    let mean: Matrix2<f64> = state.contacts.iter().map(part).sum();
    let direction = Direction::of_degrees(state.direction_deg);
    let (along, across) = (direction.along(), direction.across());
    let pull = along.dot(&(mean * along));
    if pull == 0.0 {
        return None;
    }
    let [[xx, xy], [yx, yy]] = state.deformation_gradient;
    let f = Matrix2::new(xx, xy, yx, yy);
    let part = |matrix: &Matrix2<f64>, p: &Vector2<f64>, q: &Vector2<f64>| p.dot(&(matrix * q));
    let shear = |matrix: &Matrix2<f64>| part(matrix, &along, &across) + part(matrix, &across, &along);
    let (l1, l2, gamma) = (part(&f, &along, &along), part(&f, &across, &across), 0.5 * shear(&f));
    let turned = (l1 - l2) * shear(&mean) + 2.0 * gamma * (part(&mean, &across, &across) - pull);
    // Forces are for a unit pull: S along it is −1, and of a compression 1.
    Some(-turned / pull)
}
