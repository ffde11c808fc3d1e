//! The closed points of a locked state: all through which its forces can act.

use super::{Contact, Posed, SheetProgram, key::pair_key, pair::height_angles_rad};
use crate::{solver::constraints::Row, topology::near_pairs::NearPair};
use std::f64::consts::TAU;

/// Gap of a closed point, in units of the reference radius.
const CLOSED: f64 = 1e-9;
/// A closed point nearer than this to a contact of its pair is that contact.
const SAME_RAD: f64 = 0.01;
/// A pair with so many closed points beside its minima touches along its circle.
const ALONG: usize = 3;

impl SheetProgram<'_> {
    /// Rows at the points of `contacts`, in their order, then at all other closed points of the pairs at `x`, with first
    /// derivatives. `None` where a contact belongs to no near pair of circles.
    pub(crate) fn closed_points(&self, x: &Posed, contacts: &[Contact]) -> Option<Vec<Row>> {
        let (turns, factored) = (self.all_turns(&x.state), self.pull.factored(&x.p));
        let rows = |near: &NearPair, angles: &[f64]| self.gaps_at(x, near, (&turns, factored.as_ref()), angles);
        let mut out = Vec::new();
        for contact in contacts {
            let near = self.near(x).iter().find(|near| near.pair == contact.pair)?;
            let (_, b) = near.circles()?;
            out.extend(rows(near, &[b.angle_rad(&contact.point_b)]));
        }
        for near in
            self.near(x).iter().filter(|near| near.within(CLOSED + self.required(x, near.touching) - near.touching))
        {
            let closed = |angles: Vec<f64>| rows(near, &angles).into_iter().filter(|row| row.gap < CLOSED);
            let mut points: Vec<Row> = closed(near.minima().iter().map(|m| m.angle_b_rad()).collect()).collect();
            let around: Vec<Row> = closed(height_angles_rad().collect()).collect();
            if around.len() >= ALONG {
                points.extend(around);
            }
            let key = pair_key(&near.pair);
            for row in points {
                let apart = |other: &Row| {
                    let turn = (other.angle - row.angle).rem_euclid(TAU);
                    turn.min(TAU - turn)
                };
                if !out.iter().any(|other| other.key == key && apart(other) < SAME_RAD) {
                    out.push(row);
                }
            }
        }
        Some(out)
    }
}
