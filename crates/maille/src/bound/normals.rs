//! A tighter upper bound from the normals of the rings: forces of ties whose proof counts each ring with one normal.
//!
//! **Lemma.** Let the rings a, b with normals N_a, N_b be linked, their tori disjoint. For every vector y
//!
//! y·(c_b − c_a) ≤ R_a |y × N_a| + R_b |y × N_b| − (r_a + r_b) |y|.
//!
//! Let |y| = 1; other |y| follow by scaling. Shifted by less than r_a + r_b, b stays apart from the circle of a, so the two stay linked, and their discs meet. So
//! y·(c_b + (r_a + r_b) y − c_a) is at most the half-widths of the two discs along y. ∎
//!
//! **Proof of a bound.** In the sum Σ y_k·g_k over the links of [`super::link`] each ring has one normal in all of its links. So
//!
//! Σ y_k·g_k ≤ Σ_a R_a max_N Σ_(k at a) |y_k × N| − Σ_k |y_k| s_k,  s_k = r_a + r_b,
//!
//! which is at most Σ |y_k| L_k, and less where the forces at a ring do not lie in a plane. In a supercell each copy of a ring has a normal of its own, and the
//! same maximum: the bound holds for every cell.
//!
//! **Search.** The forces are found by descent on the smoothed maximum over a set of normals. Nothing is claimed of them: what they
//! prove is evaluated by [`super::width`].

use super::{
    proof::Query,
    width::{largest_width, wider, width},
};
use maille_geometry::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// Steps of the descent.
const STEPS: usize = 400;
/// Steps between two looks at the largest widths.
const LOOK: usize = 20;
/// Normals of half of the sphere.
const GRID: usize = 64;
/// Normals of largest width kept beside them, for each ring.
const MOST_KEPT: usize = 24;
/// First step and last one, in the mean length of the forces.
const STEP: [f64; 2] = [0.2, 0.004];
/// Width over which the maximum is smoothed first and last, in the mean over rings.
const SMOOTHED: [f64; 2] = [0.1, 1e-5];

/// A ring's major radius and the ties that are links at it.
pub(super) struct Linked {
    radius: f64,
    ties: Vec<usize>,
    /// Normals at which its width was large.
    normals: Vec<Vec3>,
}

/// `count` normals of half of the sphere, evenly (a Fibonacci lattice).
fn grid(count: usize) -> Vec<Vec3> {
    let turn_rad = std::f64::consts::PI * (1.0 + 5.0_f64.sqrt());
    let normal = |k: usize| {
        let z = (k as f64 + 0.5) / count as f64;
        let (sin, cos) = (turn_rad * (k as f64 + 0.5)).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        Vec3::new(flat * cos, flat * sin, z)
    };
    (0..count).map(normal).collect()
}

impl Query<'_> {
    /// The rings that have links.
    fn linked_rings(&self) -> Vec<Linked> {
        let mut rings: Vec<Linked> =
            self.radii.iter().map(|&radius| Linked { radius, ties: Vec::new(), normals: grid(GRID) }).collect();
        for (k, tie) in self.ties.iter().enumerate().filter(|(_, tie)| tie.is_link()) {
            tie.rings.iter().for_each(|(ring, _)| rings[*ring].ties.push(k));
        }
        rings.retain(|ring| !ring.ties.is_empty());
        rings
    }

    /// Σ over the links of the most that their forces can do, each ring with one normal.
    pub(super) fn most_of_links(&self, forces: &[Vec3]) -> f64 {
        let links = self.ties.iter().zip(forces).filter(|(tie, _)| tie.is_link());
        let wires: f64 = links.map(|(tie, y)| y.norm() * self.wires(tie)).sum();
        let widths = self.linked_rings().into_iter().map(|ring| ring.radius * largest_width(&ring.at(forces)));
        widths.sum::<f64>() - wires
    }

    /// r_a + r_b of a link.
    fn wires(&self, tie: &super::tie::Tie) -> f64 {
        tie.rings.iter().map(|(ring, _)| self.radii[*ring]).sum::<f64>() - tie.length
    }

    /// The forces that descent reaches, with the l1 that they prove.
    pub(super) fn descend(&self) -> Option<(f64, Vec<Vec3>)> {
        let mut rings = self.linked_rings();
        let every = vec![true; self.ties.len()];
        let mut forces = self.first_forces()?;
        let mean = |forces: &[Vec3]| forces.iter().map(Vec3::norm).sum::<f64>() / forces.len() as f64;
        let (mut momentum, mut size_sq) = (vec![Vec3::zeros(); forces.len()], 0.0);
        let mut best: Option<(f64, Vec<Vec3>)> = None;
        for step in 0..=STEPS {
            let pull = self.pull(&forces);
            if !(pull > 0.0 && pull.is_finite()) {
                break;
            }
            forces.iter_mut().for_each(|y| *y /= pull);
            if step % LOOK == 0 {
                rings.iter_mut().for_each(|ring| ring.look(&forces));
                let (value, _) = self.smoothed(&rings, &forces, 0.0);
                if best.as_ref().is_none_or(|(least, _)| value < *least) {
                    best = Some((value, forces.clone()));
                }
            }
            let between = |[first, last]: [f64; 2]| first * (last / first).powf(step as f64 / STEPS as f64);
            let scale = mean(&forces);
            let (value, mut slope) = self.smoothed(&rings, &forces, between(SMOOTHED) * scale);
            // Of the quotient value/P at P = 1.
            for (tie, slope) in self.ties.iter().zip(&mut slope) {
                *slope -= self.along * (value * tie.span.dot(&self.along));
            }
            let slope = self.balanced(&slope, &every);
            let mean_sq = slope.iter().map(Vec3::norm_squared).sum::<f64>() / (3 * slope.len()) as f64;
            size_sq = 0.99 * size_sq + 0.01 * mean_sq;
            for ((y, momentum), slope) in forces.iter_mut().zip(&mut momentum).zip(slope) {
                *momentum = *momentum * 0.9 + slope * 0.1;
                *y -= *momentum * (between(STEP) * scale / size_sq.sqrt().max(f64::MIN_POSITIVE));
            }
        }
        let forces = self.balanced(&best?.1, &every);
        self.prove(&forces, self.most_of_links(&forces)).map(|l1| (l1, forces))
    }

    /// Forces that pull, balanced, and not in a plane: in a plane the normals say nothing.
    fn first_forces(&self) -> Option<Vec<Vec3>> {
        let spread = |k: usize| ((k + 1) as f64 * std::f64::consts::SQRT_2).fract() - 0.5;
        let along = self.ties.iter().map(|tie| self.along * tie.span.dot(&self.along));
        let size = along.clone().map(|y| y.norm()).fold(0.0, f64::max);
        let aside = along.enumerate().map(|(k, y)| y + Vec3::from_fn(|i, _| 0.2 * size * spread(3 * k + i)));
        let forces = self.balanced(&aside.collect::<Vec<_>>(), &vec![true; self.ties.len()]);
        (self.pull(&forces) > 0.0).then_some(forces)
    }

    /// What the forces prove times P, with the maxima over normals smoothed over `by` (0: not at all), and its gradient.
    fn smoothed(&self, rings: &[Linked], forces: &[Vec3], by: f64) -> (f64, Vec<Vec3>) {
        let mut total = 0.0;
        let mut slope = vec![Vec3::zeros(); forces.len()];
        let mut moments = vec![Matrix3::zeros(); self.turn.len()];
        for ((tie, y), slope) in self.ties.iter().zip(forces).zip(&mut slope) {
            let length = if tie.is_link() { -self.wires(tie) } else { tie.length };
            total += length * y.norm();
            *slope += y.try_normalize(f64::MIN_POSITIVE).unwrap_or_default() * length;
            if !self.free.lateral_free {
                let width = (1.0 + self.l2) * tie.span.dot(&self.across);
                total -= width * y.dot(&self.across);
                *slope -= self.across * width;
            }
            for term in &tie.terms {
                moments[term.element] -= term.weight * y * term.offset.transpose();
            }
        }
        for ring in rings {
            total += ring.smoothed(forces, by, &mut slope);
        }
        let rotations: Vec<Option<Matrix3<f64>>> = moments
            .iter()
            .zip(self.turn)
            .map(|(moment, turn)| {
                turn.map(|_| {
                    let rotation = widest_rotation(moment);
                    total += rotation.dot(moment);
                    rotation
                })
            })
            .collect();
        for (tie, slope) in self.ties.iter().zip(&mut slope) {
            for term in &tie.terms {
                if let Some(rotation) = rotations[term.element] {
                    *slope -= rotation * term.offset * term.weight;
                }
            }
        }
        (total, slope)
    }
}

/// The rotation Q of largest ⟨Q, M⟩.
fn widest_rotation(moment: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = SymmetricEigen::new(super::proof::quaternion_form(moment));
    let u = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    *nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(u[0], u[1], u[2], u[3]))
        .to_rotation_matrix()
        .matrix()
}

impl Linked {
    fn at(&self, forces: &[Vec3]) -> Vec<Vec3> {
        self.ties.iter().map(|k| forces[*k]).collect()
    }

    /// Climbs from the widest normals of the grid, and keeps where that ends.
    fn look(&mut self, forces: &[Vec3]) {
        let here = self.at(forces);
        let mut widths: Vec<(f64, Vec3)> = self.normals.iter().map(|n| (width(&here, n), *n)).collect();
        widths.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, mut normal) in widths.into_iter().take(4) {
            (0..10).for_each(|_| normal = wider(&here, &normal));
            if self.normals.iter().all(|known| known.cross(&normal).norm() > 1e-3) {
                self.normals.push(normal);
            }
        }
        let surplus = self.normals.len().saturating_sub(GRID + MOST_KEPT);
        self.normals.drain(GRID..GRID + surplus);
    }

    /// R times the smoothed maximum of the widths; adds its gradient.
    fn smoothed(&self, forces: &[Vec3], by: f64, slope: &mut [Vec3]) -> f64 {
        let here = self.at(forces);
        let widths: Vec<f64> = self.normals.iter().map(|n| width(&here, n)).collect();
        let most = widths.iter().copied().fold(0.0, f64::max);
        let weight = |w: f64| if by > 0.0 { ((w - most) / by).exp() } else { f64::from(w >= most) };
        let all: f64 = widths.iter().map(|w| weight(*w)).sum();
        for (normal, w) in self.normals.iter().zip(&widths) {
            let share = self.radius * weight(*w) / all;
            if share < 1e-9 * self.radius {
                continue;
            }
            for (k, y) in self.ties.iter().zip(&here) {
                let across = y - normal * y.dot(normal);
                slope[*k] += across * (share / across.norm().max(f64::MIN_POSITIVE));
            }
        }
        self.radius * (most + if by > 0.0 { by * all.ln() } else { 0.0 })
    }
}
