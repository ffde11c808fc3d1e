//! Half the squared distance h from a point of ring B to ring A's core circle, with derivatives in the pose of the
//! pair and in the point's angle θ (Appendix B, derived anew).
//!
//! The pair's nine pose variables are y = (x, α, β): x the vector from element A's reference point to element B's,
//! α and β small rotation vectors of A and B. With the arms a (to A's centre) and b(θ) = o_B + R_B (U cos θ + V sin θ)
//!
//!   W = x + e^β b − e^α a,  s = |W|²,  z = (e^α N)·W,  ρ² = Q = s − z²,  h = ½ (z² + (ρ − R_A)²).
//!
//! s and z are at most quadratic in each rotation to the order needed, and linear in b but for |b|²; so every
//! θ-derivative of s and z is the same formula with b′, b″, b‴ in the place of b.

use maille_geometry::{Circle, Vec3};
use nalgebra::{Matrix3, SMatrix, SVector};

/// Gradient in y = (x, α, β).
pub type Grad = SVector<f64, 9>;
/// Hessian in y.
pub type Hess = SMatrix<f64, 9, 9>;

/// The pair as it stands: circle A, the arm to its centre, and the point's arm on B with its θ-derivatives.
#[derive(Clone, Copy, Debug)]
pub struct PairFrame {
    x: Vec3,
    arm_a: Vec3,
    normal_a: Vec3,
    radius_a: f64,
    arm_b: Vec3,
    u: Vec3,
    v: Vec3,
    radius_b: f64,
}

/// h and its derivatives at one θ.
#[derive(Clone, Copy, Debug)]
pub struct PointJet {
    /// Distance √(2h) of the point from circle A.
    pub distance: f64,
    /// ∂h/∂θ, the thesis's g (halved).
    pub h_t: f64,
    /// ∂²h/∂θ².
    pub h_tt: f64,
    /// ∂³h/∂θ³.
    pub h_ttt: f64,
    /// ∂h/∂y.
    pub h_y: Grad,
    /// ∂²h/∂θ∂y.
    pub h_ty: Grad,
    /// ∂³h/∂θ²∂y.
    pub h_tty: Grad,
    /// ∂²h/∂y².
    pub h_yy: Hess,
    /// ∂³h/∂θ∂y².
    pub h_tyy: Hess,
}

/// A number of the pair with gradient and Hessian in y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    /// Value.
    pub value: f64,
    /// Gradient.
    pub grad: Grad,
    /// Hessian.
    pub hess: Hess,
}

impl Jet {
    /// The number 0.
    pub(crate) const ZERO: Jet = Jet {
        value: 0.0,
        grad: Grad::from_array_storage(nalgebra::ArrayStorage([[0.0; 9]])),
        hess: Hess::from_array_storage(nalgebra::ArrayStorage([[0.0; 9]; 9])),
    };

    /// f of a number with these derivatives, by f, f′ and f″.
    pub(crate) fn of([value, first, second]: [f64; 3], grad: &Grad, hess: &Hess) -> Jet {
        Jet { value, grad: grad * first, hess: hess * first + grad * grad.transpose() * second }
    }

    /// Adds [`Self::of`], in one pass.
    pub(crate) fn add_of(&mut self, [value, first, second]: [f64; 3], grad: &Grad, hess: &Hess) {
        self.value += value;
        self.grad += grad * first;
        for q in 0..9 {
            for p in 0..9 {
                self.hess[(p, q)] += hess[(p, q)] * first + grad[p] * grad[q] * second;
            }
        }
    }

    /// Adds the multiple `factor` of `other`.
    pub(crate) fn add(&mut self, factor: f64, other: &Jet) {
        self.value += factor * other.value;
        self.grad += other.grad * factor;
        self.hess += other.hess * factor;
    }
}

fn cross_matrix(a: &Vec3) -> Matrix3<f64> {
    a.cross_matrix()
}

/// Hessian of ω ↦ v·(ω × (ω × p)): v pᵀ + p vᵀ − 2 (v·p) I.
pub(super) fn turn_hessian(v: &Vec3, p: &Vec3) -> Matrix3<f64> {
    v * p.transpose() + p * v.transpose() - Matrix3::identity() * (2.0 * v.dot(p))
}

pub(super) fn blocks(
    xx: f64,
    xa: Matrix3<f64>,
    xb: Matrix3<f64>,
    aa: Matrix3<f64>,
    ab: Matrix3<f64>,
    bb: Matrix3<f64>,
) -> Hess {
    let mut h = Hess::zeros();
    h.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() * xx));
    h.fixed_view_mut::<3, 3>(0, 3).copy_from(&xa);
    h.fixed_view_mut::<3, 3>(3, 0).copy_from(&xa.transpose());
    h.fixed_view_mut::<3, 3>(0, 6).copy_from(&xb);
    h.fixed_view_mut::<3, 3>(6, 0).copy_from(&xb.transpose());
    h.fixed_view_mut::<3, 3>(3, 3).copy_from(&aa);
    h.fixed_view_mut::<3, 3>(3, 6).copy_from(&ab);
    h.fixed_view_mut::<3, 3>(6, 3).copy_from(&ab.transpose());
    h.fixed_view_mut::<3, 3>(6, 6).copy_from(&bb);
    h
}

pub(super) fn stack(x: Vec3, a: Vec3, b: Vec3) -> Grad {
    Grad::from_iterator(x.iter().chain(a.iter()).chain(b.iter()).copied())
}

impl PairFrame {
    /// The pair (A, B): the circles as they stand, and the reference points of their elements.
    pub fn new(a: &Circle, reference_a: &Vec3, b: &Circle, reference_b: &Vec3) -> Self {
        let (u, v) = b.frame();
        PairFrame {
            x: reference_b - reference_a,
            arm_a: a.center - reference_a,
            normal_a: a.normal.into_inner(),
            radius_a: a.radius,
            arm_b: b.center - reference_b,
            u,
            v,
            radius_b: b.radius,
        }
    }

    /// Distance of B's point at `angle_rad` from circle A (eq. 3.1.2).
    pub(crate) fn distance(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = angle_rad.sin_cos();
        let w = self.x + self.arm_b + (self.u * cos + self.v * sin) * self.radius_b - self.arm_a;
        let z = self.normal_a.dot(&w);
        z.hypot((w - self.normal_a * z).norm() - self.radius_a)
    }

    /// That distance and its gradient at the fixed angle. The nearest point of A may be taken as fixed on A (it is a
    /// minimum), so only the direction e from it to B's point counts: (e, −foot × e, b × e).
    pub(crate) fn distance_gradient(&self, angle_rad: f64) -> (f64, Grad) {
        let (sin, cos) = angle_rad.sin_cos();
        let b = self.arm_b + (self.u * cos + self.v * sin) * self.radius_b;
        let w = self.x + b - self.arm_a;
        let z = self.normal_a.dot(&w);
        let across = w - self.normal_a * z;
        let rho = across.norm().max(1e-12 * self.radius_a);
        let outwards = across / rho;
        let lack = rho - self.radius_a;
        let distance = z.hypot(lack);
        let e = (self.normal_a * z + outwards * lack) / distance.max(1e-12);
        let foot = self.arm_a + outwards * self.radius_a;
        (distance, stack(e, e.cross(&foot), b.cross(&e)))
    }

    /// s of b (with `own`: its b-free terms too) or of a θ-derivative of b.
    fn s_jet(&self, b: &Vec3, value: f64, own: bool) -> Jet {
        let (x, a) = (self.x, self.arm_a);
        let p = if own { x + b } else { *b };
        let grad = stack((p - if own { a } else { Vec3::zeros() }) * 2.0, p.cross(&a) * 2.0, b.cross(&(x - a)) * 2.0);
        let (xx, xa) = if own { (2.0, cross_matrix(&a) * 2.0) } else { (0.0, Matrix3::zeros()) };
        let ab = (b * a.transpose() - Matrix3::identity() * a.dot(b)) * 2.0;
        let hess = blocks(xx, xa, cross_matrix(b) * -2.0, turn_hessian(&-p, &a), ab, turn_hessian(&(x - a), b));
        Jet { value, grad, hess }
    }

    /// z of b or of a θ-derivative of b.
    fn z_jet(&self, b: &Vec3, own: bool) -> Jet {
        let (n, x) = (self.normal_a, if own { self.x } else { Vec3::zeros() });
        let p = x + b;
        let value = n.dot(&(p - if own { self.arm_a } else { Vec3::zeros() }));
        let grad = stack(if own { n } else { Vec3::zeros() }, n.cross(&p), b.cross(&n));
        let xa = if own { -cross_matrix(&n) } else { Matrix3::zeros() };
        let ab = Matrix3::identity() * n.dot(b) - b * n.transpose();
        let hess = blocks(0.0, xa, Matrix3::zeros(), turn_hessian(&n, &p) * 0.5, ab, turn_hessian(&n, b) * 0.5);
        Jet { value, grad, hess }
    }

    /// Height z of B's point at `angle_rad` over A's plane, with gradient and Hessian at that fixed angle.
    pub(crate) fn height(&self, angle_rad: f64) -> (f64, Grad, Hess) {
        let (sin, cos) = angle_rad.sin_cos();
        let z = self.z_jet(&(self.arm_b + (self.u * cos + self.v * sin) * self.radius_b), true);
        (z.value, z.grad, z.hess)
    }

    /// Of B's centre: s, the squared distance from A's, and z, the height over A's plane; and the cosine N_A·N_B.
    pub(crate) fn center_jets(&self) -> [Jet; 3] {
        let s = (self.x + self.arm_b - self.arm_a).norm_squared();
        let normal_b = self.u.cross(&self.v);
        [self.s_jet(&self.arm_b, s, true), self.z_jet(&self.arm_b, true), self.z_jet(&normal_b, false)]
    }

    /// All derivatives at `angle_rad`. On A's axis (ρ = 0), where h has a kink, ρ is floored at 1e-12 R_A.
    pub fn jet(&self, angle_rad: f64) -> PointJet {
        let (sin, cos) = angle_rad.sin_cos();
        let r = (self.u * cos + self.v * sin) * self.radius_b;
        let b1 = (self.v * cos - self.u * sin) * self.radius_b;
        let b = self.arm_b + r;
        let w = self.x + b - self.arm_a;
        // s, s′, s″, s‴ with b″ = −r, b‴ = −b′.
        let s = self.s_jet(&b, w.norm_squared(), true);
        let s1 = self.s_jet(&b1, 2.0 * w.dot(&b1), false);
        let s2 = self.s_jet(&-r, 2.0 * (b1.norm_squared() - w.dot(&r)), false);
        let s3 = 2.0 * (-3.0 * b1.dot(&r) - w.dot(&b1));
        let z = self.z_jet(&b, true);
        let z1 = self.z_jet(&b1, false);
        let z2 = self.z_jet(&-r, false);
        let z3 = -z1.value;

        // ρ² = Q: differentiate Q/2 = ρ²/2 as often as needed and solve for ρ's derivative.
        let rho = (w - self.normal_a * z.value).norm().max(1e-12 * self.radius_a);
        let q_y = s.grad - z.grad * (2.0 * z.value);
        let q_yy = s.hess - (z.grad * z.grad.transpose() + z.hess * z.value) * 2.0;
        let q_t = s1.value - 2.0 * z.value * z1.value;
        let q_tt = s2.value - 2.0 * (z1.value * z1.value + z.value * z2.value);
        let q_ttt = s3 - 6.0 * z1.value * z2.value - 2.0 * z.value * z3;
        let q_ty = s1.grad - (z.grad * z1.value + z1.grad * z.value) * 2.0;
        let q_tty = s2.grad - (z.grad * z2.value + z1.grad * (2.0 * z1.value) + z2.grad * z.value) * 2.0;
        let q_tyy = s1.hess - (z.hess * z1.value + z1.hess * z.value + symmetric(&z.grad, &z1.grad)) * 2.0;

        let rho_y = q_y / (2.0 * rho);
        let rho_t = q_t / (2.0 * rho);
        let rho_tt = (0.5 * q_tt - rho_t * rho_t) / rho;
        let rho_ttt = (0.5 * q_ttt - 3.0 * rho_t * rho_tt) / rho;
        let rho_ty = (q_ty * 0.5 - rho_y * rho_t) / rho;
        let rho_tty = (q_tty * 0.5 - rho_y * rho_tt - rho_ty * (2.0 * rho_t)) / rho;
        let rho_yy = (q_yy * 0.5 - rho_y * rho_y.transpose()) / rho;
        let rho_tyy = (q_tyy * 0.5 - rho_yy * rho_t - symmetric(&rho_y, &rho_ty)) / rho;

        let lack = rho - self.radius_a;
        PointJet {
            distance: z.value.hypot(lack),
            h_t: z.value * z1.value + lack * rho_t,
            h_tt: z1.value * z1.value + z.value * z2.value + rho_t * rho_t + lack * rho_tt,
            h_ttt: 3.0 * (z1.value * z2.value + rho_t * rho_tt) + z.value * z3 + lack * rho_ttt,
            h_y: z.grad * z.value + rho_y * lack,
            h_ty: z.grad * z1.value + z1.grad * z.value + rho_y * rho_t + rho_ty * lack,
            h_tty: z.grad * z2.value
                + z1.grad * (2.0 * z1.value)
                + z2.grad * z.value
                + rho_y * rho_tt
                + rho_ty * (2.0 * rho_t)
                + rho_tty * lack,
            h_yy: z.grad * z.grad.transpose() + z.hess * z.value + rho_y * rho_y.transpose() + rho_yy * lack,
            h_tyy: symmetric(&z.grad, &z1.grad)
                + z.hess * z1.value
                + z1.hess * z.value
                + symmetric(&rho_y, &rho_ty)
                + rho_yy * rho_t
                + rho_tyy * lack,
        }
    }
}

/// a bᵀ + b aᵀ.
pub(crate) fn symmetric(a: &Grad, b: &Grad) -> Hess {
    a * b.transpose() + b * a.transpose()
}

/// How the root angle θ(y), where h_t = 0 with h_tt > 0, moves with the pose (eq. 4.3.5 and its derivative).
#[derive(Clone, Copy, Debug)]
pub struct RootMotion {
    /// ∂θ/∂y = −h_ty / h_tt.
    pub first: Grad,
    /// ∂²θ/∂y².
    pub second: Hess,
}

impl RootMotion {
    /// From the jet at the root; h_tt is floored (a minimum that is about to merge moves ever faster).
    pub fn at(root: &PointJet) -> Self {
        let curvature = root.h_tt.max(1e-6);
        let first = -root.h_ty / curvature;
        let second =
            -(root.h_tyy + symmetric(&root.h_tty, &first) + first * first.transpose() * root.h_ttt) / curvature;
        RootMotion { first, second }
    }
}

impl PointJet {
    /// Gradient and Hessian of the distance d = √(2h) in y, where the point's angle is θ(y) + constant.
    pub fn distance_derivatives(&self, root: &RootMotion) -> (Grad, Hess) {
        let half_grad = self.h_y + root.first * self.h_t;
        let half_hess = self.h_yy
            + symmetric(&self.h_ty, &root.first)
            + root.first * root.first.transpose() * self.h_tt
            + root.second * self.h_t;
        self.to_distance(half_grad, half_hess)
    }

    /// Gradient and Hessian of d at a fixed angle on B.
    pub(crate) fn distance_derivatives_fixed(&self) -> (Grad, Hess) {
        self.to_distance(self.h_y, self.h_yy)
    }

    fn to_distance(self, half_grad: Grad, half_hess: Hess) -> (Grad, Hess) {
        let d = self.distance.max(1e-12);
        let grad = half_grad / d;
        (grad, (half_hess - grad * grad.transpose()) / d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gradient_is_that_of_the_jet() {
        let normal = |x, y, z| nalgebra::UnitVector3::new_normalize(Vec3::new(x, y, z));
        let a = Circle::new(Vec3::new(0.3, -0.2, 0.1), normal(0.1, 0.4, 1.0), 1.0);
        let b = Circle::new(Vec3::new(0.9, 0.5, -0.4), normal(1.0, -0.3, 0.2), 0.8);
        let frame = PairFrame::new(&a, &Vec3::new(0.1, 0.0, 0.3), &b, &Vec3::new(1.0, 0.2, -0.1));
        for k in 0..20 {
            let angle = 0.31 * f64::from(k);
            let (jet, (distance, gradient)) = (frame.jet(angle), frame.distance_gradient(angle));
            assert!((distance - jet.distance).abs() < 1e-14);
            assert!((gradient - jet.distance_derivatives_fixed().0).amax() < 1e-13, "{angle}");
        }
    }
}
