//! The minima from the roots of a polynomial of degree 8 in the cosine of the angle (Appendix A): a cross-check.
//!
//! It finds candidates independently of the fast and the exhaustive method; refinement and evaluation use the same
//! `h`.
//!
//! Symbols: `γ = cos θ` and `σ = sin θ` with the angle `θ` on circle B in its own frame `(U, V)`; `N` is the normal
//! of A.

use crate::circle::{Circle, Vec3};
use crate::circle_circle::exhaustive::MinimumAngles;
use crate::circle_circle::minimum::Minima;
use crate::circle_circle::pair_frame::PairFrame;
use crate::tolerance::ROUNDING;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Real coefficients, the constant one first.
type Polynomial = [f64; DEGREE + 1];
/// Degree of the polynomial.
const DEGREE: usize = 8;

/// Tolerance on the imaginary part of a real root and on `[−1, 1]`. Rounding splits double roots by `√ε`, quadruple
/// ones by `ε^¼`, and every symmetric pair has multiple roots.
const SPLIT: f64 = 1e-3;
/// Candidates that Newton's method would move farther than this are not critical points.
const REACH_RAD: f64 = 0.1;

/// Local minima of the distance between two circles, from the roots of a polynomial `φ(γ)` of degree 8, `γ = cos θ`
/// with the angle `θ` on B (section 3.2 and Appendix A). A cross-check only: use
/// [`circle_distance_minima`](crate::circle_distance_minima).
///
/// With `Δ = P_B(θ) − c_A`, a critical point satisfies `Δ·Δ′ = R_A (N×Δ)·(N×Δ′)/|N×Δ|`. Squaring once removes the
/// root, and squaring again removes `sin θ`: `φ(γ) = p₆² − (1 − γ²) p₇² = 0`. Its roots are only candidates. For
/// each, both signs of `sin θ` are refined by Newton's method on the original equation, and the minima are kept.
///
/// **Accuracy.** Fragile in `f64`: `φ` contains the fourth power of small quantities, so that well separated angles
/// can become a multiple root up to rounding. At least one minimum is always returned, but not always all of them.
///
/// **Degenerate cases.** `φ` vanishes for coaxial, Villarceau and meridian pairs. If all its coefficients are zero
/// up to [`ROUNDING`]², the lowest of 64 points is returned as the representative of a continuum. If no candidate
/// is a minimum, the lowest of the 64 points is refined and returned.
///
/// # Examples
///
/// ```
/// use maille_geometry::{Circle, Vec3, circle_distance_minima, circle_distance_minima_polynomial};
///
/// let a = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
/// let b = Circle::new(Vec3::new(0.9, 0.2, 0.3), Vec3::y_axis(), 0.7);
/// let [p, q] = [circle_distance_minima(&a, &b), circle_distance_minima_polynomial(&a, &b)];
/// assert!((p.closest().distance - q.closest().distance).abs() < 1e-14);
/// ```
pub fn circle_distance_minima_polynomial(a: &Circle, b: &Circle) -> Minima {
    let pair = PairFrame::new(a, b);
    let lowest_sample = || {
        let distance = |angle_rad: &f64| pair.sample_at_angle(*angle_rad).distance();
        let samples = (0..64).map(|i| (f64::from(i) + 0.5) * TAU / 64.0);
        samples.min_by(|p, q| distance(p).total_cmp(&distance(q))).unwrap_or(0.0)
    };
    let Some(phi) = phi(a, b, pair.scale) else {
        return pair.minima_at_angles(&[lowest_sample()], true, false);
    };
    // Candidates, both signs of sin θ each.
    let offset_rad = pair.moving_frame_angle_rad();
    let mut angles = MinimumAngles::default();
    for root in roots(&phi) {
        if root.im.abs() > SPLIT || root.re.abs() > 1.0 + SPLIT {
            continue;
        }
        let angle_rad = root.re.clamp(-1.0, 1.0).acos();
        for signed_rad in [angle_rad, -angle_rad] {
            if let Some(minimum_rad) = polish(&pair, signed_rad - offset_rad) {
                angles.add(&pair, minimum_rad);
            }
        }
    }
    // No candidate is a minimum.
    if angles.as_slice().is_empty() {
        let start_rad = lowest_sample();
        angles.add(&pair, polish(&pair, start_rad).unwrap_or(start_rad));
    }
    pair.minima_at_angles(angles.as_slice(), angles.continuum, false)
}

/// The coefficients of `φ`, lengths in units of `scale`; `None` if it vanishes up to rounding.
///
/// With `D = c_B − c_A`, and `x⟂` the part of `x` in the plane of A (so that `N×x · N×y = x⟂·y⟂`):
/// `a₀ = R_B D·U`, `a₁ = R_B D·V`, `a₂ = |D⟂|²`, `a₃ = R_B D⟂·U⟂`, `a₄ = R_B D⟂·V⟂`, `a₅ = R_B² |U⟂|²`,
/// `a₆ = R_B² U⟂·V⟂`, `a₇ = R_B² |V⟂|²`, and in `γ`, `σ`: `|Δ⟂|² = p₀ + σp₁`, `Δ·Δ′ = p₂ + σp₃`, `Δ⟂·Δ′⟂ = p₄ + σp₅`.
fn phi(a: &Circle, b: &Circle, scale: f64) -> Option<Polynomial> {
    let (radius_a, radius_b) = (a.radius / scale, b.radius / scale);
    let d = (b.center - a.center) / scale;
    let (u, v) = b.frame();
    let (u, v) = (u * radius_b, v * radius_b);
    let flat = |x: &Vec3| x - *a.normal * a.normal.dot(x);
    let (d_flat, u_flat, v_flat) = (flat(&d), flat(&u), flat(&v));
    let (a0, a1, a2) = (d.dot(&u), d.dot(&v), d_flat.norm_squared());
    let (a3, a4) = (d_flat.dot(&u_flat), d_flat.dot(&v_flat));
    let (a5, a6, a7) = (u_flat.norm_squared(), u_flat.dot(&v_flat), v_flat.norm_squared());

    let p0 = polynomial(&[a2 + a7, 2.0 * a3, a5 - a7]);
    let p1 = polynomial(&[2.0 * a4, 2.0 * a6]);
    let p2 = polynomial(&[0.0, a1]);
    let p3 = polynomial(&[-a0]);
    let p4 = polynomial(&[-a6, a4, 2.0 * a6]);
    let p5 = polynomial(&[-a3, a7 - a5]);
    let sin_sq = polynomial(&[1.0, 0.0, -1.0]);
    let radius_sq = radius_a * radius_a;

    // The even part p₂² + σ² p₃² of (p₂ + σp₃)², and p₆ + σ p₇ = (p₀ + σp₁)(p₂ + σp₃)² − R_A² (p₄ + σp₅)².
    let even = sum(&product(&p2, &p2), 1.0, &product(&sin_sq, &product(&p3, &p3)));
    let cross = product(&p2, &p3);
    let p6 = sum(&product(&p0, &even), 2.0, &product(&sin_sq, &product(&p1, &cross)));
    let p6 = sum(&p6, -radius_sq, &sum(&product(&p4, &p4), 1.0, &product(&sin_sq, &product(&p5, &p5))));
    let p7 = sum(&product(&p1, &even), 2.0, &product(&p0, &cross));
    let p7 = sum(&p7, -2.0 * radius_sq, &product(&p4, &p5));
    let phi = sum(&product(&p6, &p6), -1.0, &product(&sin_sq, &product(&p7, &p7)));

    // Does φ vanish, compared with the size of its terms?
    let flat_size = radius_b * (d_flat.norm() + radius_b);
    let size = (d_flat.norm() + radius_b).powi(2) * (a0 * a0 + a1 * a1) + radius_sq * flat_size * flat_size;
    let vanishes = phi.iter().all(|c| c.abs() <= (ROUNDING * size).powi(2));
    (!vanishes).then_some(phi)
}

/// A polynomial of lower degree.
fn polynomial(coefficients: &[f64]) -> Polynomial {
    let mut result = [0.0; DEGREE + 1];
    result[..coefficients.len()].copy_from_slice(coefficients);
    result
}

/// `p + factor q`.
fn sum(p: &Polynomial, factor: f64, q: &Polynomial) -> Polynomial {
    std::array::from_fn(|i| p[i] + factor * q[i])
}

/// `p q`, whose degree must not exceed eight.
fn product(p: &Polynomial, q: &Polynomial) -> Polynomial {
    std::array::from_fn(|i| (0..=i).map(|k| p[k] * q[i - k]).sum())
}

/// All complex roots, by the Ehrlich–Aberth iteration: simultaneous Newton steps in which the roots repel each other.
///
/// Simple roots converge cubically, multiple ones linearly and only to their limited accuracy. Leading coefficients
/// that are mere rounding are dropped; their roots lie far outside of `[−1, 1]` and are returned as infinite.
fn roots(coefficients: &Polynomial) -> [Complex<f64>; DEGREE] {
    let largest = coefficients.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
    let leading = (0..=DEGREE).rev().find(|&i| coefficients[i].abs() > 1e-16 * largest).unwrap_or(0);
    let mut roots = [Complex::new(f64::INFINITY, 0.0); DEGREE];
    for (i, root) in roots[..leading].iter_mut().enumerate() {
        // Starts on a circle, none on the real line and no two complex conjugate.
        *root = Complex::from_polar(0.9, 0.4 + i as f64 * TAU / leading as f64);
    }
    let one = Complex::new(1.0, 0.0);
    let mut done = [false; DEGREE];
    for _ in 0..100 {
        for i in 0..leading {
            if done[i] {
                continue;
            }
            let x = roots[i];
            let size = x.norm();
            let (mut value, mut slope) = (Complex::new(coefficients[leading], 0.0), Complex::new(0.0, 0.0));
            let mut terms = coefficients[leading].abs();
            for &c in coefficients[..leading].iter().rev() {
                slope = slope * x + value;
                value = value * x + c;
                terms = terms * size + c.abs();
            }
            let newton = value * slope.inv();
            let others = (0..leading).filter(|&k| k != i);
            let repulsion: Complex<f64> = others.map(|k| (x - roots[k]).inv()).sum();
            let step = newton * (one - newton * repulsion).inv();
            // Coinciding roots and zero slopes divide by zero: the root is as good as it gets.
            if step.re.is_finite() && step.im.is_finite() {
                roots[i] -= step;
                // Converged: the value or the step is rounding.
                done[i] = value.norm() <= 4.0 * f64::EPSILON * terms || step.norm() <= f64::EPSILON * size;
            } else {
                done[i] = true;
            }
        }
    }
    roots
}

/// The minimum near a candidate by Newton's method on `h′` (radians), if there is one.
fn polish(pair: &PairFrame<'_>, start_rad: f64) -> Option<f64> {
    let mut angle_rad = start_rad;
    for _ in 0..40 {
        let sample = pair.sample_at_angle(angle_rad);
        if sample.curvature <= 0.0 {
            return None;
        }
        let step = sample.slope / sample.curvature;
        angle_rad -= step;
        if (angle_rad - start_rad).abs() > REACH_RAD {
            return None;
        }
        if step.abs() < 1e-9 {
            return Some(angle_rad);
        }
    }
    None
}
