//! What pulls the sheet: energies on the lattice (eq. 4.1.6, 4.1.8), and how far the target is missed (§5.1).
//!
//! Both protocols are sums of weighted squares of linear functions of four points: the first element's centre x1,
//! the lattice vectors a1, a2, and the fourth corner's x4 − x1.

use crate::{model::Model, solver::curvature::Curvature, state::State};
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

/// How a deformation is imposed and judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// Energy and threshold on F − F_target, the fourth corner eliminated.
    Strain,
    /// The thesis's: corner targets (eq. 5.1.1), E_b (eq. 4.1.6), threshold on the corners' distance. Its metric
    /// depends on the cell's shape, so sheared cells get biased limits.
    Corners,
}

/// One weighted square |Σ c_n Y_n − t|², Y = (x1, a1, a2, x4 − x1).
struct Square {
    weight: f64,
    coefficients: [f64; 4],
    target: Vec3,
}

/// The target energy of one run.
pub struct Target {
    protocol: Protocol,
    gradient: Matrix2<f64>,
    squares: Vec<Square>,
}

impl Target {
    /// For the deformation `gradient`, with the weights β (targets) and k_b (the fourth corner).
    pub fn new(model: &Model, protocol: Protocol, gradient: Matrix2<f64>, beta: f64, corner_weight: f64) -> Self {
        let in_plane = |v: Vector2<f64>| Vec3::new(v.x, v.y, 0.0);
        let squares = match protocol {
            // β |cell area| |F − F_target|², a sum over the two columns of F.
            Protocol::Strain => {
                let inverse = model.reference_inverse;
                (0..2)
                    .map(|k| Square {
                        weight: beta / inverse.determinant().abs(),
                        coefficients: [0.0, inverse[(0, k)], inverse[(1, k)], 0.0],
                        target: in_plane(gradient.column(k).into()),
                    })
                    .collect()
            }
            Protocol::Corners => {
                let start = &model.start;
                let center = start.poses.iter().map(|p| p.position).sum::<Vec3>() / start.poses.len() as f64;
                let corners = [Vec3::zeros(), start.a1, start.a2, start.a1 + start.a2];
                let mut squares: Vec<Square> = (0..4)
                    .map(|k| {
                        let arm = start.poses[0].position + corners[k] - center;
                        let mut coefficients = [1.0, 0.0, 0.0, 0.0];
                        if k > 0 {
                            coefficients[k] = 1.0;
                        }
                        let target = center + in_plane(gradient * arm.xy()) + Vec3::new(0.0, 0.0, arm.z);
                        Square { weight: beta, coefficients, target }
                    })
                    .collect();
                squares.push(Square {
                    weight: corner_weight,
                    coefficients: [0.0, -1.0, -1.0, 1.0],
                    target: Vec3::zeros(),
                });
                squares
            }
        };
        Target { protocol, gradient, squares }
    }

    /// Unknowns beyond the elements' six each: the lattice's six, and the fourth corner's three where it is free.
    pub(crate) fn lattice_unknowns(&self) -> usize {
        match self.protocol {
            Protocol::Strain => 6,
            Protocol::Corners => 9,
        }
    }

    fn misses<'a>(&'a self, state: &'a State, corner: &'a Vec3) -> impl Iterator<Item = (&'a Square, Vec3)> {
        let points = [state.poses[0].position, state.a1, state.a2, *corner];
        self.squares.iter().map(move |square| {
            let value: Vec3 = points.iter().zip(square.coefficients).map(|(p, c)| p * c).sum();
            (square, value - square.target)
        })
    }

    /// Energy.
    pub fn energy(&self, state: &State, corner: &Vec3) -> f64 {
        self.misses(state, corner).map(|(square, miss)| square.weight * miss.norm_squared()).sum()
    }

    /// Adds the derivatives; `first_lattice` is the index of a1's x among the unknowns.
    pub(crate) fn add_derivatives(
        &self,
        state: &State,
        corner: &Vec3,
        first_lattice: usize,
        gradient: &mut [f64],
        hessian: &mut Curvature,
    ) {
        let columns = [0, first_lattice, first_lattice + 3, first_lattice + 6];
        for (square, miss) in self.misses(state, corner) {
            for (p, cp) in square.coefficients.iter().enumerate().filter(|c| *c.1 != 0.0) {
                for axis in 0..3 {
                    gradient[columns[p] + axis] += 2.0 * square.weight * cp * miss[axis];
                }
            }
            for axis in 0..3 {
                let entries: Vec<(usize, usize, f64)> = (0..4)
                    .filter(|&p| square.coefficients[p] != 0.0)
                    .map(|p| (0, columns[p] + axis, square.coefficients[p]))
                    .collect();
                hessian.add(&entries, 1, |_, _| 2.0 * square.weight);
            }
        }
    }

    /// How far the target is missed: |F − F_target| (Frobenius), or the largest distance of a corner from its target,
    /// in units of the reference radius.
    pub(crate) fn residual(&self, model: &Model, state: &State, corner: &Vec3) -> f64 {
        match self.protocol {
            Protocol::Strain => (self.measured(model, state, corner) - self.gradient).norm(),
            Protocol::Corners => self.misses(state, corner).take(4).map(|(_, miss)| miss.norm()).fold(0.0, f64::max),
        }
    }

    /// The measured F (eq. 5.2.1). With a free fourth corner ∇u varies over the quadrilateral: taken at its centroid.
    pub(crate) fn measured(&self, model: &Model, state: &State, corner: &Vec3) -> Matrix2<f64> {
        match self.protocol {
            Protocol::Strain => state.deformation_gradient(model),
            Protocol::Corners => {
                let (first, second) = ((state.a1 + corner - state.a2) / 2.0, (state.a2 + corner - state.a1) / 2.0);
                Matrix2::new(first.x, second.x, first.y, second.y) * model.reference_inverse
            }
        }
    }
}
