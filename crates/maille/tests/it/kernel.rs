//! Derivatives of the point–circle distance and of the moving minimum, against finite differences.

use maille::program::gap_kernel::{Grad, Hess, PairFrame, PointJet, RootMotion};
use maille_geometry::{Circle, Vec3, circle_distance_minima};
use nalgebra::{Unit, UnitQuaternion};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// Two rings with offsets in their elements, at poses that can be moved by y = (x, α, β).
struct Pair {
    reference_a: Vec3,
    reference_b: Vec3,
    a: Circle,
    b: Circle,
}

impl Pair {
    fn random(rng: &mut ChaCha8Rng) -> Pair {
        let mut v = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
        let circle = |center: Vec3, normal: Vec3, radius: f64| Circle::new(center, Unit::new_normalize(normal), radius);
        let (reference_a, reference_b) = (v(1.0), v(1.0));
        let (center_a, center_b) = (reference_a + v(0.5), reference_b + v(0.5));
        let (a, b) = (circle(center_a, v(1.0), 1.0), circle(center_b, v(1.0), 0.7));
        Pair { reference_a, reference_b, a, b }
    }

    /// Moves A by α, and B by x and β about their reference points.
    fn moved(&self, y: &Grad) -> Pair {
        let turn = |c: &Circle, about: &Vec3, w: Vec3, shift: Vec3| {
            let q = UnitQuaternion::from_scaled_axis(w);
            Circle::new(
                about + q * (c.center - about) + shift,
                Unit::new_normalize(q * c.normal.into_inner()),
                c.radius,
            )
        };
        let (x, alpha, beta) = (Vec3::new(y[0], y[1], y[2]), Vec3::new(y[3], y[4], y[5]), Vec3::new(y[6], y[7], y[8]));
        Pair {
            reference_a: self.reference_a,
            reference_b: self.reference_b + x,
            a: turn(&self.a, &self.reference_a, alpha, Vec3::zeros()),
            b: turn(&self.b, &self.reference_b, beta, x),
        }
    }

    /// h at B's body-fixed angle: the point turns with B, so B's frame of the unmoved pose is carried along.
    fn half_sq(&self, y: &Grad, angle: f64) -> f64 {
        let point = self.b.point(angle) - self.reference_b;
        let beta = UnitQuaternion::from_scaled_axis(Vec3::new(y[6], y[7], y[8]));
        let moved = self.moved(y);
        let p = moved.reference_b + beta * point;
        let w = p - moved.a.center;
        let z = moved.a.normal.dot(&w);
        let d = z.hypot((w - moved.a.normal.into_inner() * z).norm() - moved.a.radius);
        0.5 * d * d
    }

    fn frame(&self) -> PairFrame {
        PairFrame::new(&self.a, &self.reference_a, &self.b, &self.reference_b)
    }
}

fn unit(k: usize, size: f64) -> Grad {
    let mut y = Grad::zeros();
    y[k] = size;
    y
}

fn close(analytic: f64, difference: f64, tolerance: f64, what: &str) {
    assert!(
        (analytic - difference).abs() <= tolerance * (1.0 + analytic.abs()),
        "{what}: {analytic} against {difference}"
    );
}

#[test]
fn jets_match_finite_differences() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..200 {
        let pair = Pair::random(&mut rng);
        let t: f64 = rng.random_range(-3.0..3.0);
        let jet = pair.frame().jet(t);
        let w = pair.b.point(t) - pair.a.center;
        if (w - pair.a.normal.into_inner() * pair.a.normal.dot(&w)).norm() < 0.1 {
            continue; // near A's axis the derivatives are large and differences useless
        }
        let zero = Grad::zeros();
        let e = 1e-5;
        close(0.5 * jet.distance * jet.distance, pair.half_sq(&zero, t), 1e-14, "h");
        close(jet.h_t, (pair.half_sq(&zero, t + e) - pair.half_sq(&zero, t - e)) / (2.0 * e), 1e-8, "h_t");
        let jets = |t: f64| pair.frame().jet(t);
        let along = |f: &dyn Fn(&PointJet) -> f64| (f(&jets(t + e)) - f(&jets(t - e))) / (2.0 * e);
        close(jet.h_tt, along(&|j| j.h_t), 1e-6, "h_tt");
        close(jet.h_ttt, along(&|j| j.h_tt), 1e-5, "h_ttt");
        for p in 0..9 {
            let value = |y: &Grad| pair.half_sq(y, t);
            close(jet.h_y[p], (value(&unit(p, e)) - value(&unit(p, -e))) / (2.0 * e), 1e-8, "h_y");
            close(jet.h_ty[p], along(&|j| j.h_y[p]), 1e-6, "h_ty");
            close(jet.h_tty[p], along(&|j| j.h_ty[p]), 1e-5, "h_tty");
            for q in 0..9 {
                let e = 1e-4;
                let four = value(&(unit(p, e) + unit(q, e)))
                    - value(&(unit(p, e) - unit(q, e)))
                    - value(&(unit(q, e) - unit(p, e)))
                    + value(&(-unit(p, e) - unit(q, e)));
                close(jet.h_yy[(p, q)], four / (4.0 * e * e), 2e-6, "h_yy");
                close(jet.h_tyy[(p, q)], along(&|j| j.h_yy[(p, q)]), 1e-5, "h_tyy");
            }
        }
    }
}

/// The moving minimum, and the sample beside it: d(θ(y) + δ) with θ(y) found anew for every y.
#[test]
fn moving_minima_and_samples_match_finite_differences() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut checked = 0;
    while checked < 60 {
        let pair = Pair::random(&mut rng);
        let minima = circle_distance_minima(&pair.a, &pair.b);
        let minimum = minima.closest();
        let root = pair.frame().jet(minimum.angle_b_rad());
        if root.h_tt < 0.05 || minimum.distance < 0.02 {
            continue; // about to merge, or the distance has its own kink at 0
        }
        checked += 1;
        close(root.distance, minimum.distance, 1e-12, "distance");
        assert!(root.h_t.abs() < 1e-12, "h_t at a minimum: {}", root.h_t);
        let motion = RootMotion::at(&root);
        for offset in [0.0, 0.05] {
            let jet = pair.frame().jet(minimum.angle_b_rad() + offset);
            let (grad, hess): (Grad, Hess) = jet.distance_derivatives(&motion);
            let value = |y: &Grad| {
                // Newton on h_t from the old angle, in B's carried frame.
                let mut angle = minimum.angle_b_rad();
                for _ in 0..30 {
                    let e = 1e-4;
                    let (m, h, p) = (pair.half_sq(y, angle - e), pair.half_sq(y, angle), pair.half_sq(y, angle + e));
                    let step = (p - m) / 2.0 / ((p - 2.0 * h + m) / e);
                    angle -= step;
                    if step.abs() < 1e-13 {
                        break;
                    }
                }
                (2.0 * pair.half_sq(y, angle + offset)).sqrt()
            };
            for p in 0..9 {
                let e = 1e-4;
                close(grad[p], (value(&unit(p, e)) - value(&unit(p, -e))) / (2.0 * e), 2e-5, "gradient");
                for q in 0..9 {
                    let e = 2e-3;
                    let four = value(&(unit(p, e) + unit(q, e)))
                        - value(&(unit(p, e) - unit(q, e)))
                        - value(&(unit(q, e) - unit(p, e)))
                        + value(&(-unit(p, e) - unit(q, e)));
                    let difference = four / (4.0 * e * e);
                    let scale = hess.amax().max(1.0);
                    assert!((hess[(p, q)] - difference).abs() < 5e-3 * scale, "{p} {q}: {} {difference}", hess[(p, q)]);
                }
            }
        }
    }
}
