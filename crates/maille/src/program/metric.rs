//! Lattices whose metric is affine in the parameters: C = C₀ + Σ p_m C_m, a_k = F(C) ref_k.
//!
//! F is the upper triangular factor of C = FᵀF with positive diagonal: a common turn of the sheet changes nothing, so any F
//! of this C does. With dF the change of F along dC, A = F⁻ᵀ dC F⁻¹ and Φ(A) the upper triangle of A, its diagonal halved:
//!
//! dF = Φ(A) F,  d²F(1, 2) = −Φ(F⁻ᵀ (dF₁ᵀ dF₂ + dF₂ᵀ dF₁) F⁻¹) F,
//!
//! from FᵀF = C, once and twice differentiated along directions in which C is linear.

use maille_geometry::Vec3;
use nalgebra::Matrix2;

/// F with F(C)ᵀ F(C) = C, upper triangular; `None` where C is not positive definite.
pub(crate) fn factor(c: &Matrix2<f64>) -> Option<Matrix2<f64>> {
    let f11 = c[(0, 0)].sqrt();
    let f12 = c[(0, 1)] / f11;
    let f22 = (c[(1, 1)] - f12 * f12).sqrt();
    (f11 > 0.0 && f22 > 0.0).then(|| Matrix2::new(f11, f12, 0.0, f22))
}

/// F with its derivatives along the rates of C.
pub(super) struct Factored {
    f: Matrix2<f64>,
    inverse: Matrix2<f64>,
    first: Vec<Matrix2<f64>>,
}

impl Factored {
    /// `None` where `c` is not positive definite.
    pub(crate) fn new(c: &Matrix2<f64>, rates: &[Matrix2<f64>]) -> Option<Self> {
        let f = factor(c)?;
        let inverse = f.try_inverse()?;
        let mut out = Factored { f, inverse, first: Vec::new() };
        out.first = rates.iter().map(|rate| out.half(rate)).collect();
        Some(out)
    }

    /// Φ(F⁻ᵀ M F⁻¹) F.
    fn half(&self, m: &Matrix2<f64>) -> Matrix2<f64> {
        let a = self.inverse.transpose() * m * self.inverse;
        Matrix2::new(0.5 * a[(0, 0)], a[(0, 1)], 0.0, 0.5 * a[(1, 1)]) * self.f
    }

    /// Rate of the lattice vector of `reference` with parameter m.
    pub(crate) fn rate(&self, m: usize, reference: &Vec3) -> Vec3 {
        apply(&self.first[m], reference)
    }

    /// Its second derivative with parameters m and n.
    pub(crate) fn bend(&self, m: usize, n: usize, reference: &Vec3) -> Vec3 {
        let product = self.first[m].transpose() * self.first[n];
        apply(&-self.half(&(product + product.transpose())), reference)
    }
}

/// The lattice vector of `reference`.
pub(super) fn apply(f: &Matrix2<f64>, reference: &Vec3) -> Vec3 {
    let v = f * reference.xy();
    Vec3::new(v.x, v.y, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_factor() {
        let c = Matrix2::new(1.7, 0.4, 0.4, 0.9);
        let rates = [Matrix2::new(2.0, 0.0, 0.0, 0.0), Matrix2::new(0.3, 1.0, 1.0, -0.5)];
        let at = |p: [f64; 2]| factor(&(c + rates[0] * p[0] + rates[1] * p[1])).unwrap();
        assert!((at([0.1, 0.2]).transpose() * at([0.1, 0.2]) - (c + rates[0] * 0.1 + rates[1] * 0.2)).norm() < 1e-15);
        let known = Factored::new(&c, &rates).unwrap();
        let v = Vec3::new(0.8, -1.3, 0.0);
        let h = 1e-4;
        let step = |m: usize, x: f64| std::array::from_fn(|k| if k == m { x } else { 0.0 });
        for m in 0..2 {
            let (up, down) = (at(step(m, h)), at(step(m, -h)));
            assert!((apply(&((up - down) / (2.0 * h)), &v) - known.rate(m, &v)).norm() < 1e-7);
            for n in 0..2 {
                let moved = |x: f64| Factored::new(&(c + rates[n] * x), &rates).unwrap().rate(m, &v);
                let second = (moved(h) - moved(-h)) / (2.0 * h);
                assert!((second - known.bend(m, n, &v)).norm() < 1e-7, "{m} {n}");
            }
        }
    }
}
