//! The area of the cell as a row: the least area is not linear in the unknowns, so a parameter t that it bounds is maximised.
//!
//! g = 1 − t − A/A₀ ≥ 0 with A = a₁ × a₂ (its z component) and A₀ that of the lattice where all parameters are 0. At a maximum of t
//! the row is closed: t = 1 − A/A₀. The lattice is affine in the parameters, a_k = base_k + Σ p_m rate_mk, so A is quadratic:
//!
//! ∂A/∂p_m = rate_m1 × a₂ + a₁ × rate_m2,  ∂²A/∂p_m ∂p_n = rate_m1 × rate_n2 + rate_n1 × rate_m2.
//!
//! A/A₀ stays positive: a cell without area has copies of an element at one place, and no step lets core circles cross.

use super::{LatticeFamily, Posed, SheetProgram, key::bound_key};
use crate::{solver::constraints::Row, state::State};
use maille_geometry::Vec3;

/// z component of u × v.
fn cross(u: &Vec3, v: &Vec3) -> f64 {
    u.x * v.y - u.y * v.x
}

impl LatticeFamily {
    /// A/A₀ of a state's lattice.
    pub(crate) fn area_share(&self, state: &State) -> f64 {
        cross(&state.a1, &state.a2) / cross(&self.base[0], &self.base[1])
    }
}

impl SheetProgram<'_> {
    /// The row of each parameter that saves area; families of metrics have none.
    pub(super) fn area_rows(&self, x: &Posed) -> Vec<Row> {
        let (pull, [a1, a2]) = (self.pull, [x.state.a1, x.state.a2]);
        let moving: Vec<usize> =
            (0..pull.parameters.len()).filter(|&m| pull.parameters[m].rate != [Vec3::zeros(); 2]).collect();
        let whole = cross(&pull.base[0], &pull.base[1]);
        let rate = |m: usize| &pull.parameters[m].rate;
        let saving = pull.parameters.iter().enumerate().filter(|(_, parameter)| parameter.saves_area);
        let row = |(saving, _): (usize, _)| {
            let first = moving.iter().map(|&m| (cross(&rate(m)[0], &a2) + cross(&a1, &rate(m)[1])) / whole);
            let second =
                |m: usize, n: usize| (cross(&rate(m)[0], &rate(n)[1]) + cross(&rate(n)[0], &rate(m)[1])) / whole;
            let k = moving.len() + 1;
            let mut hessian = vec![0.0; k * k];
            for (i, &m) in moving.iter().enumerate() {
                for (j, &n) in moving.iter().enumerate() {
                    hessian[(i + 1) * k + j + 1] = -second(m, n);
                }
            }
            Row {
                columns: std::iter::once(saving)
                    .chain(moving.iter().copied())
                    .map(|m| self.first_parameter + m)
                    .collect(),
                gradient: std::iter::once(-1.0).chain(first.map(|d| -d)).collect(),
                hessian,
                ..Row::value(bound_key(saving), 0.0, 1.0 - x.p[saving] - pull.area_share(&x.state))
            }
        };
        saving.map(row).collect()
    }
}
