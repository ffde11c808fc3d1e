//! What forces of ties prove: the proof of [`super::link`], evaluated.

use super::tie::Tie;
use crate::{lattice::Across, solver::cone::eigenvalues};
use maille_geometry::Vec3;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix4};

/// One direction and l2 of a bound.
pub(super) struct Query<'a> {
    pub ties: &'a [Tie],
    /// Major radii of the rings.
    pub radii: &'a [f64],
    /// For each element whether it has a matrix Q.
    pub turn: &'a [Option<usize>],
    pub along: Vec3,
    pub across: Vec3,
    pub l2: f64,
    pub free: Across,
    pub largest_stretch: f64,
}

impl Query<'_> {
    /// Where lines across the pull may be moved: along D⊥ where l2 is free, along D where the shear is.
    pub(crate) fn free_axes(&self) -> impl Iterator<Item = Vec3> {
        let lateral = self.free.lateral_free.then_some(self.across);
        lateral.into_iter().chain(self.free.shear_free.then_some(self.along))
    }

    /// T and U of what is free: they should be 0.
    fn unheld(&self, forces: &[Vec3]) -> Vec<f64> {
        let across = |axis: Vec3| {
            let ties = self.ties.iter().zip(forces);
            ties.map(|(tie, y)| y.dot(&axis) * tie.span.dot(&self.across)).sum()
        };
        self.free_axes().map(across).collect()
    }

    /// Forces y of the multipliers z: (|y|, −y) in each cone.
    pub(crate) fn forces(&self, z: &DVector<f64>) -> Vec<Vec3> {
        (0..self.ties.len()).map(|k| -Vec3::new(z[4 * k + 1], z[4 * k + 2], z[4 * k + 3])).collect()
    }

    /// P.
    pub(crate) fn pull(&self, forces: &[Vec3]) -> f64 {
        self.ties.iter().zip(forces).map(|(tie, y)| y.dot(&self.along) * tie.span.dot(&self.along)).sum()
    }

    /// What is left of the balance on each element.
    fn imbalance(&self, forces: &[Vec3]) -> Vec<Vec3> {
        let mut out = vec![Vec3::zeros(); self.turn.len()];
        for (tie, y) in self.ties.iter().zip(forces) {
            for term in &tie.terms {
                out[term.element] += term.weight * y;
            }
        }
        out
    }

    /// Σ |y| L over the links.
    pub(super) fn lengths_of_links(&self, forces: &[Vec3]) -> f64 {
        self.ties.iter().zip(forces).filter(|(tie, _)| tie.is_link()).map(|(tie, y)| y.norm() * tie.length).sum()
    }

    /// The l1 that these forces prove if those of the links do no more than `links`; `None` where they do not pull.
    pub(super) fn prove(&self, forces: &[Vec3], links: f64) -> Option<f64> {
        let pull = self.pull(forces);
        if !(pull > 0.0 && pull.is_finite()) {
            return None;
        }
        let mut total = links;
        let mut moments = vec![Matrix3::zeros(); self.turn.len()];
        let mut farthest = 0.0;
        for (tie, y) in self.ties.iter().zip(forces) {
            if !tie.is_link() {
                total += y.norm() * tie.length;
            }
            if !self.free.lateral_free {
                total -= (1.0 + self.l2) * y.dot(&self.across) * tie.span.dot(&self.across);
            }
            farthest += tie.length + self.largest_stretch * tie.span.norm();
            for term in &tie.terms {
                moments[term.element] -= term.weight * y * term.offset.transpose();
                farthest += term.offset.norm();
            }
        }
        for (moment, turn) in moments.iter().zip(self.turn) {
            if turn.is_some() {
                total += eigenvalues(quaternion_form(moment)).into_iter().fold(f64::NEG_INFINITY, f64::max);
            }
        }
        // Every centre is within `farthest` of the one that is held: along a path of ties each is used at most once.
        let left: f64 = self.imbalance(forces).iter().map(|r| r.norm()).sum();
        let unheld: f64 = self.unheld(forces).iter().map(|u| u.abs()).sum();
        if unheld > 0.0 {
            total += unheld * self.largest_stretch;
        }
        let l1 = (total + left * farthest) / pull - 1.0;
        l1.is_finite().then_some(l1)
    }

    /// The best that forces near `forces` prove, with them.
    ///
    /// Slack ties keep a small force in an interior point. Without them the value is flat to first order in the rest, so
    /// that half of the digits of y give all digits of the bound: cut at several levels, balance, and take the least.
    pub(crate) fn polished(&self, forces: &[Vec3]) -> Option<(f64, Vec<Vec3>)> {
        let most = forces.iter().map(|y| y.norm()).fold(0.0, f64::max);
        let mut best: Option<(f64, Vec<Vec3>)> = None;
        let mut kept_before = usize::MAX;
        for cut in [0.0, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3] {
            let kept: Vec<bool> = forces.iter().map(|y| y.norm() > cut * most).collect();
            let n_kept = kept.iter().filter(|k| **k).count();
            if n_kept == kept_before {
                continue;
            }
            kept_before = n_kept;
            let balanced = self.balanced(forces, &kept);
            if let Some(l1) = self.prove(&balanced, self.lengths_of_links(&balanced))
                && best.as_ref().is_none_or(|(least, _)| l1 < *least)
            {
                best = Some((l1, balanced));
            }
        }
        best
    }

    /// The nearest balanced forces that vanish where `kept` is false: y − Bᵀ(B Bᵀ)⁺ B y.
    ///
    /// B Bᵀ is singular (a connected part moves freely); a small shift and a few rounds give the pseudo-inverse. The rows of
    /// what is free couple the three axes of space; without them each axis is solved for itself.
    pub(super) fn balanced(&self, forces: &[Vec3], kept: &[bool]) -> Vec<Vec3> {
        let n = self.turn.len();
        let mut square = DMatrix::<f64>::identity(n, n) * 1e-6;
        for (tie, _) in self.ties.iter().zip(kept).filter(|(_, k)| **k) {
            for a in &tie.terms {
                for b in &tie.terms {
                    square[(a.element, b.element)] += a.weight * b.weight;
                }
            }
        }
        let mut out: Vec<Vec3> = forces.iter().zip(kept).map(|(y, k)| if *k { *y } else { Vec3::zeros() }).collect();
        if self.free.any() {
            self.balance_all(&mut out, kept);
            return out;
        }
        let Some(factor) = square.cholesky() else { return out };
        for _ in 0..4 {
            let left = self.imbalance(&out);
            let right = DMatrix::from_fn(n, 3, |i, axis| left[i][axis]);
            let shift = factor.solve(&right);
            for ((tie, y), _) in self.ties.iter().zip(&mut out).zip(kept).filter(|(_, k)| **k) {
                for term in &tie.terms {
                    *y -= term.weight
                        * Vec3::new(shift[(term.element, 0)], shift[(term.element, 1)], shift[(term.element, 2)]);
                }
            }
        }
        out
    }

    /// The same with the rows of what is free.
    fn balance_all(&self, forces: &mut [Vec3], kept: &[bool]) {
        let n = 3 * self.turn.len();
        let axes: Vec<Vec3> = self.free_axes().collect();
        // The rows of B that a tie's force enters, with its part in each of them.
        let entries = |tie: &Tie| -> Vec<(usize, Vec3)> {
            let balance = tie.terms.iter().flat_map(|term| {
                let axis = |k: usize| Vec3::from_fn(|i, _| if i == k { term.weight } else { 0.0 });
                (0..3).map(move |k| (3 * term.element + k, axis(k)))
            });
            let free = axes.iter().enumerate().map(|(m, axis)| (n + m, axis * tie.span.dot(&self.across)));
            balance.chain(free).collect()
        };
        let rows: Vec<Vec<(usize, Vec3)>> = self.ties.iter().map(entries).collect();
        let mut square = DMatrix::<f64>::identity(n + axes.len(), n + axes.len()) * 1e-6;
        for (rows, _) in rows.iter().zip(kept).filter(|(_, k)| **k) {
            for (i, a) in rows {
                rows.iter().for_each(|(j, b)| square[(*i, *j)] += a.dot(b));
            }
        }
        let Some(factor) = square.cholesky() else { return };
        for _ in 0..4 {
            let balance = self.imbalance(forces).into_iter().flat_map(|r| [r.x, r.y, r.z]);
            let right: Vec<f64> = balance.chain(self.unheld(forces)).collect();
            let shift = factor.solve(&DVector::from_vec(right));
            for ((rows, y), _) in rows.iter().zip(&mut *forces).zip(kept).filter(|(_, k)| **k) {
                rows.iter().for_each(|(i, part)| *y -= part * shift[*i]);
            }
        }
    }
}

/// N(M): uᵀN(M)u = ⟨M, R(u)⟩ for the rotation R(u) of the unit quaternion u = (w, x, y, z).
pub(super) fn quaternion_form(m: &Matrix3<f64>) -> Matrix4<f64> {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]));
    Matrix4::new(
        xx + yy + zz,
        zy - yz,
        xz - zx,
        yx - xy, //
        zy - yz,
        xx - yy - zz,
        xy + yx,
        xz + zx, //
        xz - zx,
        xy + yx,
        yy - xx - zz,
        yz + zy, //
        yx - xy,
        xz + zx,
        yz + zy,
        zz - xx - yy,
    )
}
