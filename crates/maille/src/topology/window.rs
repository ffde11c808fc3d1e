//! Near images of a rolled sheet.
//!
//! A rolled sheet that goes round more than once lies on itself. What is asked is how a piece can be rolled, so two elements count
//! where their places in the written sheet are at most half a turn apart: |k·v| ≤ π with v the way between them there and k the turn for each
//! unit of length; and at any turn where one link or two join them, as an element and those that are linked to it are a piece. This depends
//! neither on the basis of the lattice nor on the cell.

use crate::{
    lattice::{Shift, shifts_within},
    model::{Element, Model},
    state::{Pose, Roll, State, images::Image},
};
use maille_geometry::Vec3;
use std::{
    collections::BTreeSet,
    f64::consts::{PI, TAU},
};

/// What counts is at most this share of half a turn apart: rounding.
const HALF: f64 = 1.0 + 1e-12;

/// sin x / x.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-8 { 1.0 } else { x.sin() / x }
}

/// The cell of a rolled state as its images are listed.
pub(super) struct Window<'a> {
    pub model: &'a Model,
    state: &'a State,
    roll: &'a Roll,
    /// Places of the elements in the written sheet, in lattice coordinates.
    places: Vec<[f64; 2]>,
    /// Largest turn of a shift that counts.
    pub most_rad: f64,
    /// Largest distance of an element from where its cell is anchored.
    pub wide: f64,
    /// ϱ = |α/θ|, infinite where nothing turns.
    pub length_by_turn: f64,
}

impl<'a> Window<'a> {
    pub fn new(model: &'a Model, state: &'a State, roll: &'a Roll) -> Self {
        let place = |p: &Pose| (model.reference_inverse * p.position.xy()).into();
        let places: Vec<[f64; 2]> = model.start.poses.iter().map(place).collect();
        let turns = || places.iter().map(|at| roll.turn(*at));
        let spread = turns().fold(f64::NEG_INFINITY, f64::max) - turns().fold(f64::INFINITY, f64::min);
        let own = |(pose, e): (&Pose, &Element)| state.motion_to(e.anchor).back(&pose.position).norm();
        let wide = state.poses.iter().zip(&model.elements).map(own).fold(0.0, f64::max);
        let length: f64 = [state.a1, state.a2].iter().map(|a| a.dot(&roll.along).abs()).sum();
        let turn: f64 = roll.turn_rad.iter().map(|t| t.abs()).sum();
        let length_by_turn = if turn > 0.0 { length / turn } else { f64::INFINITY };
        Window { model, state, roll, places, most_rad: PI * HALF + spread, wide, length_by_turn }
    }

    /// (α, β), or (θ, β), of two lattice vectors with their turns.
    pub fn coordinates(&self, lattice: [Vec3; 2], turn_rad: [f64; 2]) -> [Vec3; 2] {
        let (u, w) = (self.roll.along, self.roll.axis());
        let along = |k: usize| if self.length_by_turn < 1.0 { turn_rad[k] } else { lattice[k].dot(&u) };
        [0, 1].map(|k| Vec3::new(along(k), lattice[k].dot(&w), 0.0))
    }

    /// sinc of half the largest turn; 0 where that is a full turn or more.
    pub fn least_sinc(&self) -> f64 {
        if self.most_rad < TAU { sinc(0.5 * self.most_rad).max(0.0) } else { 0.0 }
    }

    /// Whether the image of element `j` counts for element `i`.
    fn counts(&self, i: usize, j: usize, shift: Shift) -> bool {
        let between = [0, 1].map(|k| f64::from(shift[k]) + self.places[j][k] - self.places[i][k]);
        self.roll.turn(between).abs() <= PI * HALF
    }

    /// Shifts of which an image may be within `reach`, in lexicographic order.
    fn shifts(&self, reach: f64) -> Vec<Shift> {
        let [a1, a2] = self.coordinates([self.state.a1, self.state.a2], self.roll.turn_rad);
        let far = reach + 2.0 * self.wide;
        let by_chord = far / self.least_sinc();
        let by_turn = self.length_by_turn;
        let most = if by_turn < 1.0 { self.most_rad } else { by_chord.min(self.most_rad * by_turn) };
        let by_anchor = self.model.elements.iter().flat_map(|e| e.anchor).fold(0.0, |m: f64, c| m.max(c.abs()));
        let anchors = 2.0 * by_anchor * (a1.norm() + a2.norm());
        let mut shifts = shifts_within(&Vec3::zeros(), &a1, &a2, most.hypot(far) + anchors);
        // `most_rad` has the elements' own turns.
        shifts.retain(|shift| self.roll.turn(shift.map(f64::from)).abs() <= self.most_rad);
        shifts
    }
}

/// As [`super::broad_phase::neighbours`], of a rolled sheet.
pub(super) fn neighbours(
    model: &Model,
    state: &State,
    roll: &Roll,
    thickest: f64,
    margin: f64,
) -> Vec<Vec<(usize, Shift)>> {
    let n = model.elements.len();
    let window = Window::new(model, state, roll);
    let widest = model.elements.iter().map(|e| e.reach).fold(0.0, f64::max);
    let images: BTreeSet<Shift> = match model.periodic {
        true => {
            let joined = model.joined().iter().flatten().map(|(_, shift)| *shift);
            window.shifts(2.0 * (widest + thickest) + margin).into_iter().chain(joined).collect()
        }
        false => BTreeSet::from([[0, 0]]),
    };
    let images: Vec<_> = images.into_iter().map(|shift| (shift, state.image(shift))).collect();
    let of = |i: usize| {
        let mut out = Vec::new();
        for j in i..n {
            let reach = model.elements[i].reach + model.elements[j].reach + 2.0 * thickest + margin;
            let near = |shift: &Shift, image: &Image| {
                (i < j || *shift > [0, 0])
                    && (window.counts(i, j, *shift) || model.joined()[i].binary_search(&(j, *shift)).is_ok())
                    && image.way(&state.poses[i].position, &state.poses[j].position).norm_squared() <= reach * reach
            };
            out.extend(images.iter().filter(|(shift, image)| near(shift, image)).map(|(shift, _)| (j, *shift)));
        }
        out
    };
    (0..n).map(of).collect()
}
