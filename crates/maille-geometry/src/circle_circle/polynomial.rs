//! The minima by the polynomial of degree 8 in the cosine of the angle (Appendix A).
//!
//! A second way to the same answers, to check the enumeration and to show what the polynomial costs: how it finds the
//! minima is its own, what it then polishes and evaluates is the same `h`.

use crate::circle::{Circle, Vec3};
use crate::circle_circle::exhaustive::MinimumAngles;
use crate::circle_circle::minimum::Minima;
use crate::circle_circle::pair_frame::PairFrame;
use crate::tolerance::ROUNDING;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Real coefficients, constant first.
type Polynomial = [f64; DEGREE + 1];
const DEGREE: usize = 8;

/// Real roots may be off the real line, and off `[−1, 1]`, by this much: double roots split by `√ε`, quadruple ones by
/// `ε^¼`, and every symmetric pair has multiple roots.
const SPLIT: f64 = 1e-3;
/// Polishing may move an angle by this much; candidates that would go farther are no critical points.
const REACH_RAD: f64 = 0.1;

/// The local minima of the distance between two circles from the roots of `φ(γ)`, `γ = cos θ`, θ the angle on B
/// (section 3.2 and Appendix A).
///
/// With `Δ = P_B(θ) − c_A` a critical point satisfies `Δ·Δ′ = R_A (N×Δ)·(N×Δ′)/|N×Δ|`. Squared once for the root,
/// and once more for `sin θ`, it becomes `φ(γ) = p₆² − (1 − γ²) p₇² = 0`. The roots are candidates only: for each, both
/// signs of `sin θ` are polished by Newton's method on the unsquared equation, and minima are kept.
///
/// **Fragile.** `φ` holds the fourth power of small quantities, so that roots which are well separated as angles can be
/// multiple to rounding, and it vanishes for coaxial, Villarceau and meridian pairs. Where it vanishes (to
/// [`ROUNDING`]²) the lowest of 64 points is returned as the representative of a continuum; where no candidate passes,
/// the lowest of them, polished. Always at least one answer, not always all; see [`crate::circle_distance_minima`] for
/// the one to use.
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
    if angles.as_slice().is_empty() {
        let start_rad = lowest_sample();
        angles.add(&pair, polish(&pair, start_rad).unwrap_or(start_rad));
    }
    pair.minima_at_angles(angles.as_slice(), angles.continuum, false)
}

/// The coefficients of `φ`, lengths in units of `scale`; nothing if it vanishes to rounding.
///
/// With `D = c_B − c_A` and `⟂` for the part in the plane of A (for which `N×x · N×y = x⟂·y⟂`):
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

    // p₂² + σ² p₃², and p₆ + σ p₇ = (p₀ + σp₁)(p₂ + σp₃)² − R_A² (p₄ + σp₅)².
    let even = sum(&product(&p2, &p2), 1.0, &product(&sin_sq, &product(&p3, &p3)));
    let cross = product(&p2, &p3);
    let p6 = sum(&product(&p0, &even), 2.0, &product(&sin_sq, &product(&p1, &cross)));
    let p6 = sum(&p6, -radius_sq, &sum(&product(&p4, &p4), 1.0, &product(&sin_sq, &product(&p5, &p5))));
    let p7 = sum(&product(&p1, &even), 2.0, &product(&p0, &cross));
    let p7 = sum(&p7, -2.0 * radius_sq, &product(&p4, &p5));
    let phi = sum(&product(&p6, &p6), -1.0, &product(&sin_sq, &product(&p7, &p7)));

    let flat_size = radius_b * (d_flat.norm() + radius_b);
    let size = (d_flat.norm() + radius_b).powi(2) * (a0 * a0 + a1 * a1) + radius_sq * flat_size * flat_size;
    let vanishes = phi.iter().all(|c| c.abs() <= (ROUNDING * size).powi(2));
    (!vanishes).then_some(phi)
}

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

/// All complex roots, by the simultaneous iteration of Ehrlich and Aberth: Newton steps that repel one another. Simple
/// roots converge cubically, multiple ones linearly to the accuracy that they have; leading coefficients that are
/// rounding are dropped, and their roots, which are far outside of `[−1, 1]`, given as infinite.
fn roots(coefficients: &Polynomial) -> [Complex<f64>; DEGREE] {
    let largest = coefficients.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
    let leading = (0..=DEGREE).rev().find(|&i| coefficients[i].abs() > 1e-16 * largest).unwrap_or(0);
    let mut roots = [Complex::new(f64::INFINITY, 0.0); DEGREE];
    for (i, root) in roots[..leading].iter_mut().enumerate() {
        // No start may lie on the real line or opposite another.
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
            // Roots that coincide to the bit, and flat values, divide by zero: the root is as good as it gets.
            if step.re.is_finite() && step.im.is_finite() {
                roots[i] -= step;
                // At values that are rounding, so are the steps.
                done[i] = value.norm() <= 4.0 * f64::EPSILON * terms || step.norm() <= f64::EPSILON * size;
            } else {
                done[i] = true;
            }
        }
    }
    roots
}

/// The minimum near a candidate by Newton's method on `h′`, or nothing.
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
