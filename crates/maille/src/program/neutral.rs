//! The radius of the neutral surface as a row: the mean distance ρ of the elements' reference points from the axis is not linear in the
//! unknowns, so a parameter t that it bounds is maximised.
//!
//! g = σ Σ_e ρ_e / n − t ≥ 0, with σ = 1 for the largest radius and −1 for the least. Its turns are held. An element that is anchored at c lies
//! at q in its own cell, ρ = √(X² + Y²), X = q·u, Y = q·e_z − H, with H the height of the axis, which is affine in the parameters. A shift δ
//! of the element moves q by R⁻¹ δ, R the turn of c. So X and Y are linear, and with their rates X_v, Y_v
//!
//! ∂ρ/∂v = (X X_v + Y Y_v)/ρ,  ∂²ρ/∂v ∂w = (X_v X_w + Y_v Y_w)/ρ − (∂ρ/∂v)(∂ρ/∂w)/ρ.

use super::{Posed, SheetProgram, key::bound_key};
use crate::solver::constraints::Row;
use maille_geometry::Vec3;
use nalgebra::{Unit, UnitQuaternion};

impl SheetProgram<'_> {
    /// The row of each parameter that the radius bounds; none where nothing turns.
    pub(super) fn neutral_rows(&self, x: &Posed) -> Vec<Row> {
        let bounded = self.pull.parameters.iter().enumerate();
        bounded
            .filter(|(_, p)| p.radius_sign != 0.0)
            .filter_map(|(m, p)| self.neutral_row(x, m, p.radius_sign))
            .collect()
    }

    fn neutral_row(&self, x: &Posed, own: usize, sign: f64) -> Option<Row> {
        let roll = x.state.roll?;
        let height = x.state.axis_height(&roll)?;
        let k = usize::from(roll.turn_rad[1].abs() > roll.turn_rad[0].abs());
        let rises = self.pull.parameters.iter().map(|p| -p.rate[k].dot(&roll.along) / roll.turn_rad[k]);
        let rises: Vec<f64> = rises.collect();
        let n = self.model.elements.len();
        let mut columns: Vec<usize> = (0..rises.len()).map(|m| self.first_parameter + m).collect();
        columns.extend(self.columns.iter().filter_map(|(shift, _)| *shift).flat_map(|t| t..t + 3));
        let size = columns.len();
        let (mut gradient, mut hessian, mut sum) = (vec![0.0; size], vec![0.0; size * size], 0.0);
        let mut next = rises.len();
        for (e, element) in self.model.elements.iter().enumerate() {
            let q = x.state.motion_to(element.anchor).back(&x.state.poses[e].position);
            let (along, up) = (q.dot(&roll.along), q.z - height);
            let radius = along.hypot(up);
            sum += radius / n as f64;
            let turn = UnitQuaternion::from_axis_angle(&Unit::new_unchecked(roll.axis()), roll.turn(element.anchor));
            let (u, z) = (turn * roll.along, turn * Vec3::z());
            // (place, X_v, Y_v)
            let mut rates: Vec<(usize, f64, f64)> = rises.iter().enumerate().map(|(m, rise)| (m, 0.0, -rise)).collect();
            if self.columns[e].0.is_some() {
                rates.extend((0..3).map(|axis| (next + axis, u[axis], z[axis])));
                next += 3;
            }
            let weight = sign / n as f64;
            let first = |(_, x, y): &(usize, f64, f64)| (along * x + up * y) / radius;
            for v in &rates {
                gradient[v.0] += weight * first(v);
                for w in &rates {
                    let second = (v.1 * w.1 + v.2 * w.2 - first(v) * first(w)) / radius;
                    hessian[v.0 * size + w.0] += weight * second;
                }
            }
        }
        gradient[own] -= 1.0;
        Some(Row { columns, gradient, hessian, ..Row::value(bound_key(own), 0.0, sign * sum - x.p[own]) })
    }
}
