//! Whether a rolled sheet goes round its axis as its lattice is turned.
//!
//! A turn is known from a state only up to whole turns: with a turn of 2π a cell is where it is without one, and lies flat. So a state
//! is a roll of its sheet where the way along links gives the turns of the lattice. From an element to one that is linked to it
//! the way about the axis is the lesser one, below half a turn; along links from an element to its image these must add up to the turn of
//! that image. Where they do not, the axis has passed through the sheet. While it passes through an element, nearer to its reference point
//! than its rings reach, it is on neither side.

use crate::{
    model::Model,
    state::{Roll, State},
};
use std::f64::consts::{PI, TAU};

/// Sums of turns that differ by less are one.
const SAME_RAD: f64 = 1e-6;

/// The same angle, in (−π, π].
fn lesser(angle_rad: f64) -> f64 {
    angle_rad - TAU * ((angle_rad - PI) / TAU).ceil()
}

/// Whether the sheet is flat, or goes round its axis as its lattice is turned.
pub(crate) fn winds(model: &Model, state: &State) -> bool {
    let Some((roll, height)) = state.roll.as_ref().and_then(|roll| Some((roll, state.axis_height(roll)?))) else {
        return true;
    };
    let across = |e: usize| [state.poses[e].position.dot(&roll.along), state.poses[e].position.z - height];
    if (0..state.poses.len()).any(|e| across(e)[0].hypot(across(e)[1]) <= model.elements[e].reach) {
        return true;
    }
    let angle = |e: usize| across(e)[0].atan2(across(e)[1]);
    let angles: Vec<f64> = (0..state.poses.len()).map(angle).collect();
    let mut at: Vec<Option<f64>> = vec![None; angles.len()];
    (0..angles.len()).all(|root| at[root].is_some() || winds_from(model, roll, &angles, root, &mut at))
}

/// The same of what links join to element `root`; `at` gets the angles about the axis that are reached along links.
fn winds_from(model: &Model, roll: &Roll, angles: &[f64], root: usize, at: &mut [Option<f64>]) -> bool {
    at[root] = Some(angles[root]);
    let mut queue = vec![root];
    while let Some(i) = queue.pop() {
        let Some(here) = at[i] else { unreachable!("it was reached") };
        for &(j, shift) in model.linked(i) {
            let turn = roll.turn(shift.map(f64::from));
            let there = here + lesser(angles[j] + turn - angles[i]) - turn;
            match at[j] {
                None => {
                    at[j] = Some(there);
                    queue.push(j);
                }
                Some(known) if (known - there).abs() > SAME_RAD => return false,
                Some(_) => {}
            }
        }
    }
    true
}
