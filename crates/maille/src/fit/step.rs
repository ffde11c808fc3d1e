//! The step of a least-squares problem within bounds.

use nalgebra::{DMatrix, DVector};

/// The minimum of gᵀd + ½ dᵀA d over `lower` ≤ d ≤ `upper`, where the bounds include 0 and A is symmetric and positive definite.
///
/// Active sets: the free entries are solved for; those that leave their bounds are held there, and the one whose force points inwards the
/// most is set free again. Ends at the minimum, or after a fixed number of rounds at a feasible step; zeros where A is not positive definite.
pub(super) fn within_bounds(a: &DMatrix<f64>, g: &DVector<f64>, lower: &[f64], upper: &[f64]) -> DVector<f64> {
    let n = g.len();
    let mut held: Vec<Option<f64>> = vec![None; n];
    let mut d = DVector::zeros(n);
    for _ in 0..4 * n + 4 {
        let free: Vec<usize> = (0..n).filter(|i| held[*i].is_none()).collect();
        let at = DVector::from_fn(n, |i, _| held[i].unwrap_or(0.0));
        let force = g + a * &at;
        let part = DMatrix::from_fn(free.len(), free.len(), |i, j| a[(free[i], free[j])]);
        let right = DVector::from_fn(free.len(), |i, _| -force[free[i]]);
        let Some(factors) = part.cholesky() else { return DVector::zeros(n) };
        let solved = factors.solve(&right);
        d = at;
        free.iter().zip(solved.iter()).for_each(|(i, x)| d[*i] = *x);
        let mut outside = false;
        for &i in &free {
            let bounded = d[i].clamp(lower[i], upper[i]);
            if bounded != d[i] {
                (held[i], outside) = (Some(bounded), true);
            }
        }
        if outside {
            continue;
        }
        let force = g + a * &d;
        // At its lower bound an entry is pushed back by a force below 0, at the upper one by a force above 0.
        let inwards = |i: &usize| held[*i].map_or(0.0, |x| if x == lower[*i] { -force[*i] } else { force[*i] });
        match (0..n).max_by(|i, j| inwards(i).total_cmp(&inwards(j))).filter(|i| inwards(i) > 1e-14) {
            Some(i) if lower[i] < upper[i] => held[i] = None,
            _ => return d,
        }
    }
    DVector::from_fn(n, |i, _| d[i].clamp(lower[i], upper[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn random_steps_meet_the_conditions_of_a_minimum() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for n in 1..9 {
            for _ in 0..50 {
                let root = DMatrix::from_fn(n, n, |_, _| rng.random_range(-1.0..1.0));
                let a = root.transpose() * root + DMatrix::identity(n, n) * 1e-3;
                let g = DVector::from_fn(n, |_, _| rng.random_range(-1.0..1.0));
                let lower: Vec<f64> = (0..n).map(|_| rng.random_range(-0.5..0.0)).collect();
                let upper: Vec<f64> = (0..n).map(|_| rng.random_range(0.0..0.5)).collect();
                let d = within_bounds(&a, &g, &lower, &upper);
                let force = &g + &a * &d;
                for i in 0..n {
                    assert!(lower[i] <= d[i] && d[i] <= upper[i]);
                    let right = match d[i] {
                        x if x == lower[i] => force[i] >= -1e-9,
                        x if x == upper[i] => force[i] <= 1e-9,
                        _ => force[i].abs() < 1e-9,
                    };
                    assert!(right, "entry {i} of {n}: {} with force {}", d[i], force[i]);
                }
            }
        }
    }
}
