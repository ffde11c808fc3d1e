//! Nesterov–Todd scalings of single cones.

use super::packed::{pack, singular, unpack};
use nalgebra::Matrix4;

/// t² − |u|² as (t − |u|)(t + |u|).
pub(super) fn split_square(v: &[f64]) -> f64 {
    let norm = (1..4).map(|i| v[i] * v[i]).sum::<f64>().sqrt();
    (v[0] - norm) * (v[0] + norm)
}

/// W of one cone, with W z = W⁻ᵀ s = λ.
pub(super) enum Block {
    /// W = β (2 v vᵀ − J), symmetric.
    Norm { beta: f64, v: [f64; 4] },
    /// W u = Rᵀ u R.
    Positive { r: Box<Matrix4<f64>>, r_inverse: Box<Matrix4<f64>> },
}

impl Block {
    pub(super) fn norm(s: &[f64], z: &[f64]) -> Option<Block> {
        let (s_sq, z_sq) = (split_square(s), split_square(z));
        if !(s_sq > 0.0 && z_sq > 0.0 && s[0] > 0.0 && z[0] > 0.0) {
            return None;
        }
        let (s_norm, z_norm) = (s_sq.sqrt(), z_sq.sqrt());
        let dot: f64 = (0..4).map(|i| s[i] / s_norm * (z[i] / z_norm)).sum();
        let gamma = (0.5 * (1.0 + dot)).sqrt();
        let sign = [1.0, -1.0, -1.0, -1.0];
        let mut v: [f64; 4] = std::array::from_fn(|i| (s[i] / s_norm + sign[i] * z[i] / z_norm) / (2.0 * gamma));
        let half = (2.0 * (v[0] + 1.0)).sqrt();
        v[0] += 1.0;
        Some(Block::Norm { beta: (s_norm / z_norm).sqrt(), v: v.map(|x| x / half) })
    }

    pub(super) fn positive(s: &[f64], z: &[f64]) -> Option<Block> {
        let l1 = unpack(s).cholesky()?.l();
        let l2 = unpack(z).cholesky()?.l();
        let (values, right) = singular(l2.transpose() * l1);
        let roots = values.map(|x| 1.0 / x.sqrt());
        if !roots.iter().all(|x| x.is_finite()) {
            return None;
        }
        let r = l1 * right * Matrix4::from_diagonal(&roots.into());
        // R⁻¹ = Λ^(−1/2) Uᵀ L2ᵀ = Λ^(−1) Rᵀ Z by the same factors.
        let r_inverse = Matrix4::from_diagonal(&values.map(|x| 1.0 / x).into()) * r.transpose() * unpack(z);
        Some(Block::Positive { r: Box::new(r), r_inverse: Box::new(r_inverse) })
    }

    /// W v.
    pub(super) fn forward(&self, x: &[f64], out: &mut [f64]) {
        match self {
            Block::Norm { beta, v } => {
                let dot: f64 = (0..4).map(|i| v[i] * x[i]).sum();
                out[0] = beta * (2.0 * v[0] * dot - x[0]);
                (1..4).for_each(|i| out[i] = beta * (2.0 * v[i] * dot + x[i]));
            }
            Block::Positive { r, .. } => out.copy_from_slice(&pack(&(r.transpose() * unpack(x) * **r))),
        }
    }

    /// Wᵀ v.
    pub(super) fn transpose(&self, x: &[f64], out: &mut [f64]) {
        match self {
            Block::Norm { .. } => self.forward(x, out),
            Block::Positive { r, .. } => out.copy_from_slice(&pack(&(**r * unpack(x) * r.transpose()))),
        }
    }

    /// W⁻¹ v.
    pub(super) fn inverse(&self, x: &[f64], out: &mut [f64]) {
        match self {
            Block::Norm { beta, v } => {
                let dot = v[0] * x[0] - (1..4).map(|i| v[i] * x[i]).sum::<f64>();
                out[0] = (2.0 * v[0] * dot - x[0]) / beta;
                (1..4).for_each(|i| out[i] = (x[i] - 2.0 * v[i] * dot) / beta);
            }
            Block::Positive { r_inverse, .. } => {
                out.copy_from_slice(&pack(&(r_inverse.transpose() * unpack(x) * **r_inverse)));
            }
        }
    }

    /// W⁻ᵀ v.
    pub(super) fn inverse_transpose(&self, x: &[f64], out: &mut [f64]) {
        match self {
            Block::Norm { .. } => self.inverse(x, out),
            Block::Positive { r_inverse, .. } => {
                out.copy_from_slice(&pack(&(**r_inverse * unpack(x) * r_inverse.transpose())));
            }
        }
    }
}
