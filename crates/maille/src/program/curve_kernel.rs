//! The distance of two curves at a contact, with derivatives in the pose of the pair: for cores that are not both circles.
//!
//! As in [`super::gap_kernel`] the pose variables are y = (x, α, β). A point of A stands at the arm a from its element's reference point, one
//! of B at b; W = x + e^β b − e^α a is the way from the first to the second, and h = ½|W|². A contact moves along the curves as the
//! pose changes: with s and t the arc lengths of its points, t_a, t_b the tangents and k_a, k_b their derivatives,
//!
//! h_ss = 1 − W·k_a,  h_tt = 1 + W·k_b,  h_st = −t_a·t_b,
//!
//! and where s and t are at a minimum, the distance d = √2h has h_yy − (h_ys h_yt) H⁻¹ (h_ys h_yt)ᵀ in place of h_yy, H being the
//! matrix above. A point at a corner, or one that is held, does not move: its row and column are left out.

use super::gap_kernel::{Grad, Hess, blocks, stack, turn_hessian};
use crate::model::curve::CurvePoint;
use maille_geometry::Vec3;
use nalgebra::{Matrix2, SymmetricEigen};

/// Second derivatives along the curves are not taken for smaller than this: a minimum that is about to vanish moves ever faster.
const LEAST: f64 = 1e-6;

/// A contact of two curves: a point of each, and whether it moves along its curve to where the distance is least.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveContact {
    /// From element A's reference point to element B's.
    pub x: Vec3,
    /// From element A's reference point to the point of A.
    pub arm_a: Vec3,
    /// From element B's reference point to the point of B.
    pub arm_b: Vec3,
    /// The points.
    pub points: [CurvePoint; 2],
    /// Whether each moves.
    pub moves: [bool; 2],
}

impl CurveContact {
    /// A contact at a minimum of the distance; the elements' reference points are given.
    pub fn of(points: [CurvePoint; 2], reference_a: &Vec3, reference_b: &Vec3) -> Self {
        CurveContact {
            x: reference_b - reference_a,
            arm_a: points[0].point - reference_a,
            arm_b: points[1].point - reference_b,
            points,
            moves: points.map(|point| point.smooth),
        }
    }

    fn way(&self) -> Vec3 {
        self.x + self.arm_b - self.arm_a
    }

    /// The distance and its gradient in y.
    pub fn gradient(&self) -> (f64, Grad) {
        let way = self.way();
        let distance = way.norm();
        let e = way / distance.max(1e-12);
        (distance, stack(e, e.cross(&self.arm_a), self.arm_b.cross(&e)))
    }

    /// Second derivatives of h along the two curves.
    pub fn along(&self) -> Matrix2<f64> {
        let (way, [a, b]) = (self.way(), self.points);
        let across = -a.tangent.dot(&b.tangent);
        Matrix2::new(1.0 - way.dot(&a.curvature), across, across, 1.0 + way.dot(&b.curvature))
    }

    /// The Hessian of the distance in y.
    pub fn hessian(&self) -> Hess {
        let (way, a, b) = (self.way(), self.arm_a, self.arm_b);
        let distance = way.norm().max(1e-12);
        let [along_a, along_b] = self.points.map(|point| point.tangent);
        let (cross_a, cross_b) = (a.cross_matrix(), b.cross_matrix());
        let mut out = blocks(
            1.0,
            cross_a,
            -cross_b,
            cross_a.transpose() * cross_a - turn_hessian(&way, &a) * 0.5,
            -cross_a.transpose() * cross_b,
            cross_b.transpose() * cross_b + turn_hessian(&way, &b) * 0.5,
        );
        // ∂h_y/∂s and ∂h_y/∂t.
        let of_s = stack(-along_a, a.cross(&along_a) - along_a.cross(&way), along_a.cross(&b));
        let of_t = stack(along_b, -a.cross(&along_b), along_b.cross(&way) + b.cross(&along_b));
        let along = self.along();
        match self.moves {
            [true, true] => {
                let eigen = SymmetricEigen::new(along);
                for k in 0..2 {
                    let v = eigen.eigenvectors.column(k);
                    let moved = of_s * v[0] + of_t * v[1];
                    out -= moved * moved.transpose() / eigen.eigenvalues[k].max(LEAST);
                }
            }
            [true, false] => out -= of_s * of_s.transpose() / along[(0, 0)].max(LEAST),
            [false, true] => out -= of_t * of_t.transpose() / along[(1, 1)].max(LEAST),
            [false, false] => {}
        }
        let grad = self.gradient().1;
        (out - grad * grad.transpose()) / distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maille_geometry::{Circle, Piece};
    use nalgebra::UnitQuaternion;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    /// A circle near the origin of its frame.
    fn circle(rng: &mut ChaCha8Rng) -> Piece {
        let mut vector = || Vec3::from_fn(|_, _| rng.random_range(-0.5..0.5));
        let (center, normal) = (vector(), vector());
        Piece::circle(Circle::new(center, nalgebra::Unit::new_normalize(normal), 0.8))
    }

    /// The point at `t` of a piece as a rotation and a place have it.
    fn point(piece: &Piece, t: f64) -> CurvePoint {
        let (point, tangent, curvature) = (piece.point(t), piece.tangent(t), piece.curvature(t));
        CurvePoint { point, angle_rad: 0.0, tangent, curvature, smooth: true, piece: 0 }
    }

    /// Where points move and where they are held: the Hessian is the derivative of the gradient at the points that are then nearest.
    #[test]
    fn hessians_are_those_of_gradients() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for case in 0..60 {
            let pieces = [circle(&mut rng), circle(&mut rng)];
            let between = Vec3::new(3.0, 0.0, 0.0) + Vec3::from_fn(|_, _| rng.random_range(-0.5..0.5));
            let moves = [case % 2 == 0, case / 2 % 2 == 0];
            // Places on the pieces, from which those that move go to where they are nearest.
            let held = [0, 1].map(|_| rng.random_range(0.0..1.0));
            let at = |y: &Grad| {
                let [x, turn_a, turn_b] = [0, 3, 6].map(|k| Vec3::new(y[k], y[k + 1], y[k + 2]));
                let turned =
                    |piece: &Piece, turn: Vec3, to: Vec3| piece.moved(&UnitQuaternion::from_scaled_axis(turn), &to);
                let a = turned(&pieces[0], turn_a, Vec3::zeros());
                let b = turned(&pieces[1], turn_b, between + x);
                let mut t = held;
                for _ in 0..400 {
                    for k in 0..2 {
                        if moves[k] {
                            let [from, to] = if k == 0 { [&a, &b] } else { [&b, &a] };
                            t[k] = from.nearest(&to.point(t[1 - k]));
                        }
                    }
                }
                let points = [point(&a, t[0]), point(&b, t[1])];
                CurveContact { moves, ..CurveContact::of(points, &Vec3::zeros(), &(between + x)) }
            };
            let here = at(&Grad::zeros());
            if moves == [true, true] && here.along().symmetric_eigenvalues().min() < 0.3 {
                continue;
            }
            let hessian = here.hessian();
            let h = 1e-5;
            for k in 0..9 {
                let mut step = Grad::zeros();
                step[k] = h;
                // The arms turn with the pose: derivatives by α and β are those at the pose from which they turn, to first order.
                let slope = (at(&step).gradient().1 - at(&-step).gradient().1) / (2.0 * h);
                for c in 0..3 {
                    let error = (slope[c] - hessian[(c, k)]).abs();
                    assert!(error < 1e-6, "{case} {moves:?} {c} {k}: {} {}", slope[c], hessian[(c, k)]);
                }
                let distance = |f: f64| at(&(step * f)).gradient().0;
                let (far, gap) = (200.0, distance(0.0));
                let bend = (distance(far) - 2.0 * gap + distance(-far)) / (far * h).powi(2);
                assert!((bend - hessian[(k, k)]).abs() < 1e-4, "{case} {moves:?} {k}: {bend} {}", hessian[(k, k)]);
            }
        }
    }
}
