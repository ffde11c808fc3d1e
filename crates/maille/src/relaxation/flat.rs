//! Contacts of flat pairs: rings that are parallel and coaxial, or nearly so, and touch along the whole circle.
//!
//! There the distance has no isolated minimum. The angle of the one that is found turns by 1/tilt for each radian of
//! tilt, a second one is born where the axes part, and the force of points beside them (eq. 4.3.6) has no limit. So the
//! contacts of such a pair are points at fixed angles around both circles, each of which counts as one non-minimal
//! point does (eq. 4.1.4). Their energy is smooth in the pose. How flat a pair is, is measured by
//!
//!   κ² = |N_A × N_B|² + (o⁴ + (R_A − R_B)² o²) / (r̂² R_A R_B),
//!
//! o the distance of the axes, r̂ = r_A + r_B: κ is about the change of the distance's slope along the circle, ∂²d/∂θ²
//! over R. The pair has the energy (1 − w) E_minima + w E_circle, where w falls from 1 at κ = 0.01 to 0 at κ = 0.02. It
//! is twice continuously differentiable, and within that range minima that overlap are isolated.

use super::barrier::ContactLaw;
use crate::{
    model::Model,
    program::gap_kernel::{Grad, Hess, Jet, PairFrame},
    state::State,
};
use maille_geometry::{Circle, Vec3};
use std::f64::consts::TAU;

/// κ from which on a pair is not flat; at half of it its minima no longer count.
pub(crate) const FLAT_CURVATURE: f64 = 0.02;

/// One of the two rings of a pair: its core circle, the reference point of its element, and the angle on the circle of a
/// point that is fixed on the ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Core circle.
    pub circle: Circle,
    /// Reference point of the ring's element.
    pub reference: Vec3,
    /// Angle of the fixed point, radians.
    pub angle_rad: f64,
}

impl Side {
    /// Ring `ring` in `state`, moved by `shift`.
    pub(crate) fn new(model: &Model, state: &State, ring: usize, shift: Vec3) -> Self {
        let (of, at) = (&model.rings[ring], state.circle(model, ring, [0, 0]));
        let pose = &state.poses[of.element];
        let fixed = pose.rotation * Circle::new(Vec3::zeros(), of.normal, of.major_radius).frame().0;
        let (u, v) = at.frame();
        let circle = Circle { center: at.center + shift, ..at };
        Side { circle, reference: pose.position + shift, angle_rad: fixed.dot(&v).atan2(fixed.dot(&u)) }
    }
}

/// κ² of two circles that touch at the core distance `touching`.
pub(crate) fn curvature_sq(a: &Circle, b: &Circle, touching: f64) -> f64 {
    let between = b.center - a.center;
    let heights_sq = 0.5 * (between.dot(&a.normal).powi(2) + between.dot(&b.normal).powi(2));
    let apart_sq = between.norm_squared() - heights_sq;
    let unequal = (a.radius - b.radius).powi(2);
    let scale = touching * touching * a.radius * b.radius;
    a.normal.cross(&b.normal).norm_squared() + apart_sq * (apart_sq + unequal) / scale
}

/// A pair that is flat at least in part.
pub(crate) struct FlatPair {
    /// Points of B seen from A, and points of A seen from B.
    views: [PairFrame; 2],
    angles_rad: [f64; 2],
    /// Squared difference of the radii, and r̂² R_A R_B.
    unequal: f64,
    scale: f64,
    touching: f64,
    points: usize,
}

impl FlatPair {
    /// The pair with `points` points on each circle.
    pub(crate) fn new(a: &Side, b: &Side, touching: f64, points: usize) -> Self {
        let view = |a: &Side, b: &Side| PairFrame::new(&a.circle, &a.reference, &b.circle, &b.reference);
        let (ra, rb) = (a.circle.radius, b.circle.radius);
        FlatPair {
            views: [view(a, b), view(b, a)],
            angles_rad: [b.angle_rad, a.angle_rad],
            unequal: (ra - rb).powi(2),
            scale: touching * touching * ra * rb,
            touching,
            points,
        }
    }

    fn angles(&self, view: usize) -> impl Iterator<Item = f64> + use<'_> {
        (0..self.points).map(move |k| self.angles_rad[view] + TAU * k as f64 / self.points as f64)
    }

    /// E_circle, the sum of ψ over the points of both circles.
    pub(crate) fn energy(&self, law: ContactLaw, alpha: f64) -> f64 {
        let of = |view: usize| -> f64 {
            self.angles(view).map(|angle| law.at(self.views[view].distance(angle), self.touching, alpha)[0]).sum()
        };
        of(0) + of(1)
    }

    /// E_circle with gradient and Hessian in y = (x, α, β).
    pub(crate) fn jet(&self, law: ContactLaw, alpha: f64) -> Jet {
        let [mut seen, other] = [0, 1].map(|view| {
            let mut sum = Jet::ZERO;
            for angle in self.angles(view).filter(|angle| self.views[view].distance(*angle) < self.touching) {
                let point = self.views[view].jet(angle);
                let (grad, hess) = point.distance_derivatives_fixed();
                sum.add_of(law.at(point.distance, self.touching, alpha), &grad, &hess);
            }
            sum
        });
        seen.add(1.0, &exchanged(&other));
        seen
    }

    /// The weight w with gradient and Hessian.
    pub(crate) fn weight(&self) -> Jet {
        let [distance_sq, height_a, cosine] = self.views[0].center_jets();
        let height_b = exchanged(&self.views[1].center_jets()[1]);
        let apart_sq = sum(&[(1.0, &distance_sq), (-0.5, &square(&height_a)), (-0.5, &square(&height_b))]);
        let (fourth, over) = (square(&apart_sq), 1.0 / self.scale);
        let mut curvature_sq = sum(&[(-1.0, &square(&cosine)), (over, &fourth), (over * self.unequal, &apart_sq)]);
        curvature_sq.value += 1.0;
        Jet::of(share(curvature_sq.value), &curvature_sq.grad, &curvature_sq.hess)
    }
}

/// w, w′ and w″ at κ²: 1 up to (κ_flat / 2)², 0 from κ_flat² on, between them the polynomial of degree 5 that has
/// neither slope nor curvature at its ends.
pub(crate) fn share(curvature_sq: f64) -> [f64; 3] {
    const FULL: f64 = 0.25 * FLAT_CURVATURE * FLAT_CURVATURE;
    const WIDTH: f64 = 0.75 * FLAT_CURVATURE * FLAT_CURVATURE;
    let x = (curvature_sq - FULL) / WIDTH;
    if x <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if x >= 1.0 {
        return [0.0; 3];
    }
    let value = 1.0 - x * x * x * (10.0 + x * (6.0 * x - 15.0));
    let first = -30.0 * x * x * (1.0 - x) * (1.0 - x) / WIDTH;
    let second = -60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (WIDTH * WIDTH);
    [value, first, second]
}

fn square(j: &Jet) -> Jet {
    Jet::of([j.value * j.value, 2.0 * j.value, 2.0], &j.grad, &j.hess)
}

fn sum(terms: &[(f64, &Jet)]) -> Jet {
    let mut out = Jet::ZERO;
    terms.iter().for_each(|(factor, jet)| out.add(*factor, jet));
    out
}

/// A jet in the variables (−x, β, α) of the pair seen from its other ring, in (x, α, β).
fn exchanged(j: &Jet) -> Jet {
    let from = |k: usize| match k {
        0..3 => (k, -1.0),
        3..6 => (k + 3, 1.0),
        _ => (k - 3, 1.0),
    };
    let grad = Grad::from_fn(|k, _| from(k).1 * j.grad[from(k).0]);
    let hess = Hess::from_fn(|p, q| from(p).1 * from(q).1 * j.hess[(from(p).0, from(q).0)]);
    Jet { value: j.value, grad, hess }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SVector, Unit, UnitQuaternion};
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    const TOUCHING: f64 = 0.2;

    /// Two rings, each with an arm from its element's reference point, that can be moved by y.
    struct Pair {
        normals: [Vec3; 2],
        arms: [Vec3; 2],
        references: [Vec3; 2],
        radii: [f64; 2],
    }

    impl Pair {
        /// A pair with κ about `size`, in contact, turned as a whole at random.
        fn random(rng: &mut ChaCha8Rng, size: f64, radii: [f64; 2]) -> Self {
            let mut vector = || Vec3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            let turn = UnitQuaternion::from_scaled_axis(vector() * 2.0);
            let (tilt, offset, arms) = (vector() * size, vector() * (size * TOUCHING).sqrt(), [vector(), vector()]);
            let unequal: f64 = radii[0] - radii[1];
            let height = (0.98 * TOUCHING * TOUCHING - unequal * unequal).sqrt();
            let center = Vec3::new(0.3 * offset.x, 0.3 * offset.y, height);
            let normal = UnitQuaternion::from_scaled_axis(Vec3::new(tilt.x, tilt.y, 0.0)) * Vec3::z();
            let centers = [Vec3::zeros(), turn * center];
            let normals = [turn * Vec3::z(), turn * normal];
            Pair { normals, arms, references: [centers[0] - arms[0], centers[1] - arms[1]], radii }
        }

        fn sides(&self, y: &SVector<f64, 9>) -> [Side; 2] {
            let part = |k: usize| Vec3::new(y[k], y[k + 1], y[k + 2]);
            [0, 1].map(|ring| {
                let turn = UnitQuaternion::from_scaled_axis(part(3 + 3 * ring));
                let reference = self.references[ring] + part(0) * ring as f64;
                let circle = |normal: Vec3| {
                    Circle::new(reference + turn * self.arms[ring], Unit::new_normalize(normal), self.radii[ring])
                };
                let (at, fixed) = (circle(turn * self.normals[ring]), turn * circle(self.normals[ring]).frame().0);
                let (u, v) = at.frame();
                Side { circle: at, reference, angle_rad: fixed.dot(&v).atan2(fixed.dot(&u)) }
            })
        }

        fn flat(&self, y: &SVector<f64, 9>) -> FlatPair {
            let [a, b] = self.sides(y);
            FlatPair::new(&a, &b, TOUCHING, 24)
        }
    }

    const LAW: ContactLaw = ContactLaw::Barrier;

    #[test]
    fn derivatives_match_differences() {
        let (mut rng, mut between) = (ChaCha8Rng::seed_from_u64(7), 0);
        for round in 0..40 {
            let pair = Pair::random(&mut rng, 0.025, if round % 2 == 0 { [1.0, 1.0] } else { [1.0, 0.97] });
            let zero = SVector::<f64, 9>::zeros();
            let here = pair.flat(&zero);
            let [a, b] = pair.sides(&zero);
            assert!((share(curvature_sq(&a.circle, &b.circle, TOUCHING))[0] - here.weight().value).abs() < 1e-9);
            between += usize::from(here.weight().value > 0.0 && here.weight().value < 1.0);
            let jets: [fn(&FlatPair) -> Jet; 2] = [FlatPair::weight, |flat| flat.jet(LAW, 30.0)];
            for (jet, step) in jets.into_iter().zip([1e-6, 1e-6]) {
                let at = jet(&here);
                for k in 0..9 {
                    let moved = |sign: f64| jet(&pair.flat(&(SVector::<f64, 9>::ith(k, sign * step))));
                    let (plus, minus) = (moved(1.0), moved(-1.0));
                    let slope = (plus.value - minus.value) / (2.0 * step);
                    assert!((at.grad[k] - slope).abs() < 1e-5 * at.grad.amax() + 1e-7, "{} {slope}", at.grad[k]);
                    for q in 0..9 {
                        let both = |s: f64, t: f64| {
                            let y = SVector::<f64, 9>::ith(k, s * 1e-4) + SVector::<f64, 9>::ith(q, t * 1e-4);
                            jet(&pair.flat(&y)).value
                        };
                        let second = (both(1.0, 1.0) - both(1.0, -1.0) - both(-1.0, 1.0) + both(-1.0, -1.0)) / 4e-8;
                        let error = (at.hess[(k, q)] - second).abs();
                        assert!(error < 2e-2 * at.hess.amax() + 1e-4, "{k} {q}: {} {second}", at.hess[(k, q)]);
                    }
                }
            }
            assert!((here.energy(LAW, 30.0) - here.jet(LAW, 30.0).value).abs() < 1e-15);
            // Seen from the other ring it is the same pair.
            let exchanged_pair = FlatPair::new(&b, &a, TOUCHING, 24);
            let other = exchanged(&exchanged_pair.jet(LAW, 30.0));
            assert!((other.grad - here.jet(LAW, 30.0).grad).amax() < 1e-12 && other.value > 0.0);
            assert!((exchanged(&exchanged_pair.weight()).hess - here.weight().hess).amax() < 1e-6);
        }
        assert!(between >= 5, "{between} poses within the switch");
    }

    #[test]
    fn the_share_is_twice_continuously_differentiable() {
        let flat_sq = FLAT_CURVATURE * FLAT_CURVATURE;
        for (at, expected) in [(0.25, 1.0), (1.0, 0.0)] {
            for side in [-1e-9, 1e-9] {
                let [value, first, second] = share((at + side) * flat_sq);
                assert!((value - expected).abs() < 1e-8);
                assert!((first * flat_sq).abs() < 1e-6 && (second * flat_sq * flat_sq).abs() < 1e-6);
            }
        }
        for k in 1..40 {
            let at = (0.2 + 0.022 * f64::from(k)) * flat_sq;
            let h = 1e-5 * flat_sq;
            let ([minus, ..], [_, first, _], [plus, ..]) = (share(at - h), share(at), share(at + h));
            assert!(((plus - minus) / (2.0 * h) - first).abs() * flat_sq < 1e-6);
        }
    }
}
