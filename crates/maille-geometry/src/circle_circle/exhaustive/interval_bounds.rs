//! What one sample proves about `h(θ) = ½ d²` on an interval around it.
//!
//! Let `m` be the centre of the interval, `σ` its half width (radians), and `M` an upper bound of `|h‴|` on it. By
//! Taylor's theorem:
//!
//! 1. `|h′(m)| > σ |h″(m)| + ½ σ² M`: no critical point.
//! 2. `h″(m) + σ M < 0`: h is concave, no minimum.
//! 3. `h″(m) − σ M > 0`: h is convex, at most one minimum.
//!
//! Near the axis of the base circle, where no `M` exists, a fourth test applies. At a critical point `w·w′ = R ρ′`
//! (`w` from the base centre), so that
//!
//! `h″ = (w·w′)′ − R ρ″ = (w·w′)′ − R ((|e′|² − (w·w′)²/R²)/ρ + e·e″/ρ)`.
//!
//! 4. `(w·w′)² < R² (|e′|² − ρ K)` with `K = (max |(w·w′)′| + R max |e″|)/R`: `h″ < 0` at every critical point, no
//!    minimum.

use crate::circle_circle::pair_frame::{PairFrame, Sample};

/// What is proved about an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// No minimum inside.
    NoMinimum,
    /// `h″ > 0` throughout.
    Convex,
    /// Nothing is proved.
    Unknown,
}

/// Maxima over the whole circle. With the sample at its centre they give bounds on an interval.
pub(crate) struct IntervalBounds {
    /// Amplitude of `z`.
    rise: f64,
    /// Bounds of `|(e·e′)′|`, `|(e·e′)″|` and `|(e·e′)‴|`.
    ee: [f64; 3],
    /// Amplitude of `w·w′`.
    ww: f64,
}

impl IntervalBounds {
    /// Of a pair.
    pub fn new(pair: &PairFrame<'_>) -> Self {
        let [x0, y0, _] = pair.offset;
        let rise = pair.radius * pair.tilt_sin;
        let first = pair.radius * (pair.tilt_cos * x0).hypot(y0);
        let second = rise * rise;
        Self {
            rise,
            ee: [first + second, first + 2.0 * second, first + 4.0 * second],
            ww: pair.half_distance_sq_amplitude(),
        }
    }

    /// The four tests of the module documentation, for the interval of half width `σ` around a sample.
    pub fn verdict(&self, pair: &PairFrame<'_>, at: &Sample, half_width: f64) -> Verdict {
        let (r, base_radius) = (pair.radius, pair.base_radius);
        // Tests 1 to 3. From |e′|² + z′² = r²: the speed |e′| at the centre, and how far e can move.
        let speed = (r * r - at.z1 * at.z1).max(0.0).sqrt();
        let travel = half_width * (speed + 0.5 * half_width * r).min(r);
        if at.rho > travel {
            let speed_max = (speed + half_width * r).min(r);
            let third = self.third_derivative(pair, at, at.rho - travel, speed_max, half_width);
            if at.slope.abs() > half_width * (at.curvature.abs() + 0.5 * half_width * third)
                || at.curvature + half_width * third < 0.0
            {
                return Verdict::NoMinimum;
            }
            if at.curvature - half_width * third > 0.0 {
                return Verdict::Convex;
            }
        }
        // Test 4.
        let ww = (at.ee[0] + at.z * at.z1).abs() + half_width * self.ww;
        let speed_min = speed - half_width * r;
        let k = self.ww / base_radius + r;
        if speed_min > 0.0 && ww * ww < base_radius * base_radius * (speed_min * speed_min - (at.rho + travel) * k) {
            return Verdict::NoMinimum;
        }
        Verdict::Unknown
    }

    /// An upper bound of `|h‴|` on the interval: the smaller of two.
    ///
    /// The first is from `h‴ = 3 z′z″ + z z‴ + 3 ρ′ρ″ + (ρ − R) ρ‴`, factor by factor, which stays small for nearly
    /// coaxial pairs; the second from `h‴ = (w·w′)″ − R ρ‴`. Both use `ρ′ = e·e′/ρ`, `ρ″ = ((e·e′)′ − ρ′²)/ρ`,
    /// `ρ‴ = ((e·e′)″ − 3 ρ′ρ″)/ρ`, and `|ρ′| ≤ |e′|`.
    fn third_derivative(
        &self,
        pair: &PairFrame<'_>,
        at: &Sample,
        rho_min: f64,
        speed_max: f64,
        half_width: f64,
    ) -> f64 {
        // (e·e′)″, (e·e′)′ and e·e′.
        let inverse = 1.0 / rho_min;
        let ee2 = self.ee[1].min((at.ee[0] + 3.0 * at.z1 * at.z2).abs() + half_width * self.ee[2]);
        let ee1 = self.ee[0].min(at.ee[1].abs() + half_width * ee2);
        let ee0 = at.ee[0].abs() + half_width * ee1;
        // ρ′, ρ″ and ρ‴.
        let rho1 = speed_max.min(ee0 * inverse);
        // The term −ρ′² can only lower ρ″.
        let rho2 = (at.ee[1].max(rho1 * rho1 - at.ee[1]) + half_width * ee2) * inverse;
        let rho3 = (ee2 + 3.0 * rho1 * rho2) * inverse;
        // The two forms of h‴.
        let (rise, z1) = (self.rise, at.z1.abs() + half_width * self.rise);
        let height = (1.5 * rise * rise).min(3.0 * z1 * rise) + (at.z.abs() + half_width * z1) * z1;
        let radial = 3.0 * rho1 * rho2 + (at.radial.abs() + half_width * rho1) * rho3;
        (height + radial).min(self.ww + pair.base_radius * rho3)
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::{Circle, Vec3};

    /// Every verdict on random intervals of random pairs agrees with 400 samples inside.
    #[test]
    fn verdicts_hold_on_dense_samples() {
        let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(3);
        let mut seen = [0; 3];
        for _ in 0..40_000 {
            let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
            let normal = |v: Vec3| nalgebra::UnitVector3::new_normalize(v);
            let a = Circle::new(Vec3::zeros(), normal(vector(1.0)), 1.0);
            let b = Circle::new(vector(1.5), normal(vector(1.0)), rng.random_range(0.1..1.5));
            let pair = PairFrame::new(&a, &b);
            let (center, half_width) = (rng.random_range(-3.0..3.0), 0.4 * rng.random_range(0.01_f64..1.0).powi(2));
            let verdict = IntervalBounds::new(&pair).verdict(&pair, &pair.sample_at_angle(center), half_width);
            let inside = (0..=400).map(|i| pair.sample_at_angle(center + half_width * (f64::from(i) / 200.0 - 1.0)));
            let inside: Vec<_> = inside.collect();
            let minimum = inside.windows(2).any(|pair| pair[0].slope < -1e-14 && pair[1].slope > 1e-14);
            match verdict {
                Verdict::NoMinimum => assert!(!minimum, "{a:?} {b:?} {center} {half_width}"),
                Verdict::Convex => assert!(inside.iter().all(|sample| sample.curvature > -1e-12)),
                Verdict::Unknown => {}
            }
            seen[verdict as usize] += 1;
        }
        // All three verdicts occur, and most intervals are decided.
        assert!(seen[0] > 10_000 && seen[1] > 500 && seen[2] > 100 && seen[2] < 10_000, "{seen:?}");
    }
}
