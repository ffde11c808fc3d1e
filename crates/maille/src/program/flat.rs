//! Pairs of rings that touch along nearly the whole circle.
//!
//! Two equal, parallel rings with offset e of their axes touch along the circle where e = 0, and at the two points across e
//! elsewhere. Sixteen heights of the one over the other's plane are smooth rows for both, exact where e = 0; elsewhere they are
//! stricter than the gap, by (e·u)²/2s in direction u. So what they lock with e ≠ 0 may be no limit. Forces are found
//! on points that are closed by their gap; where there are none, or where e is large, the pair is released and solved on by its gaps.

use super::{
    Posed, SheetProgram,
    gap_kernel::Grad,
    key::{pair_key, pair_of_key},
    metric::Factored,
    pair::height_angles_rad,
};
use crate::{
    solver::constraints::{Multiplier, Row},
    topology::{self, RingPair, near_pairs::NearPair},
};
use maille_geometry::Vec3;
use std::collections::BTreeSet;

/// Sine of the tilt below which a pair can be flat.
const FLAT_TILT: f64 = 0.08;
/// Offset of the axes below which a pair can be flat, in radii.
const FLAT_APART: f64 = 0.08;
/// Offset of the axes in radii above which a pair that carries is not left to its heights: its two contacts stand well apart
/// from what is open.
pub(crate) const SHIFTED: f64 = 1e-3;
/// The same where no forces on closed points balance.
pub(crate) const COAXIAL: f64 = 1e-6;
/// Pairs are released by the order of their offsets: Newton's method hardly converges on two contacts that are nearly a circle.
const MUCH_LESS: f64 = 0.1;
/// Gap of a closed point, in units of the reference radius.
const CLOSED: f64 = 1e-9;

impl SheetProgram<'_> {
    /// Takes the pairs of `x` that touch along nearly the whole circle as flat: equal radii, nearly parallel and
    /// coaxial. Their one gap is a cone there, h − s − R |tilt|, with its tip at the limit; from now on sixteen heights
    /// of B's points over A's plane must be at least s, which implies the gap, is smooth, and is exact where the rings
    /// are parallel and coaxial. Returns whether the set of flat pairs has changed.
    pub fn take_flat_pairs(&mut self, x: &Posed) -> bool {
        let (model, state) = (self.model, &x.state);
        let mut flat = BTreeSet::new();
        let round = |pair: &RingPair| [pair.ring_a, pair.ring_b].iter().all(|ring| model.rings[*ring].is_round());
        for pair in topology::close_pairs(model, state, 0.0).into_iter().filter(round) {
            let a = state.circle(model, pair.ring_a, [0, 0]);
            let b = state.circle(model, pair.ring_b, pair.shift);
            let touching = self.required(x, model.contact_distance(pair.ring_a, pair.ring_b));
            let between = b.center - a.center;
            let height = between.dot(&a.normal);
            let apart = (between - a.normal.into_inner() * height).norm();
            let tilt = a.normal.cross(&b.normal).norm();
            let equal = (a.radius - b.radius).abs() < 1e-9 * a.radius;
            let near = tilt < FLAT_TILT && apart < FLAT_APART * a.radius && height.abs() < touching * 1.1;
            if equal && near && !self.released.contains(&pair_key(&pair)) {
                flat.insert(pair_key(&pair));
            }
        }
        let changed = flat != self.flat;
        self.flat = flat;
        changed
    }

    /// Releases the flat pairs that carry and whose axes at `x` are more than `beyond` radii apart, and more than
    /// a tenth of the largest such offset: from now on they are pairs like all others, and their forces in
    /// `multipliers` are shared by their closed points. Returns whether there was one.
    pub(crate) fn release_flat_pairs(&mut self, x: &Posed, multipliers: &mut Vec<Multiplier>, beyond: f64) -> bool {
        let carrying = self.shifted(x, multipliers, beyond);
        let largest = carrying.iter().map(|(.., offset)| *offset).fold(0.0, f64::max);
        let shifted = carrying.into_iter().filter(|(.., offset)| *offset > MUCH_LESS * largest);
        let shifted: Vec<(u64, f64)> = shifted.map(|(key, force, _)| (key, force)).collect();
        for &(key, force) in &shifted {
            self.flat.remove(&key);
            self.released.insert(key);
            multipliers.retain(|m| m.key != key);
            let near = self.near(x).iter().filter(|near| pair_key(&near.pair) == key);
            let minima = near.flat_map(|near| near.minima().iter().map(|m| (m, self.required(x, near.touching))));
            let closed: Vec<f64> =
                minima.filter(|(m, required)| m.distance - required < CLOSED).map(|(m, _)| m.angle_b_rad()).collect();
            let value = force / closed.len() as f64;
            multipliers.extend(closed.iter().map(|&angle| Multiplier {
                key,
                angle,
                angle_a: 0.0,
                minimum: true,
                value,
            }));
        }
        !shifted.is_empty()
    }

    /// The flat pairs that carry and whose axes at `x` are more than `beyond` radii apart: key, force and offset.
    pub(crate) fn shifted(&self, x: &Posed, multipliers: &[Multiplier], beyond: f64) -> Vec<(u64, f64, f64)> {
        let of = |&key: &u64| {
            let force: f64 = multipliers.iter().filter(|m| m.key == key).map(|m| m.value.max(0.0)).sum();
            let offset = self.offset(x, key) / self.model.rings[pair_of_key(key).ring_a].major_radius;
            (force > 0.0 && offset > beyond).then_some((key, force, offset))
        };
        self.flat.iter().filter_map(of).collect()
    }

    /// Distance of the axes of the pair at `x`, measured in the plane of its first ring.
    fn offset(&self, x: &Posed, key: u64) -> f64 {
        let pair = pair_of_key(key);
        let a = x.state.circle(self.model, pair.ring_a, [0, 0]);
        let between = x.state.circle(self.model, pair.ring_b, pair.shift).center - a.center;
        (between - a.normal.into_inner() * between.dot(&a.normal)).norm()
    }

    /// Angles of B's points where a flat pair may be closed: those of its heights, its minima, and points beside these where
    /// (e·u)²/2s is still nearly 0.
    fn closed_angles_rad(&self, x: &Posed, near: &NearPair) -> Vec<f64> {
        let opens = self.offset(x, pair_key(&near.pair)).max(f64::MIN_POSITIVE);
        let beside = ((2.0 * near.touching * CLOSED).sqrt() / opens).min(1.0);
        let minima = near.minima().iter().map(|m| m.angle_b_rad());
        let around = minima.flat_map(|m| [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| m + part * beside));
        height_angles_rad().chain(around).collect()
    }

    /// Gaps at the points of the flat pair `near` that are closed.
    pub(super) fn closed_gaps(
        &self,
        x: &Posed,
        near: &NearPair,
        at: (&[Vec<Vec3>], Option<&Factored>),
        rows: &mut Vec<Row>,
    ) {
        let found = self.gaps_at(x, near, at, &self.closed_angles_rad(x, near));
        rows.extend(found.into_iter().filter(|row| row.gap < CLOSED));
    }

    /// Takes back that pairs were released: for a solve from elsewhere.
    pub(crate) fn forget_released_pairs(&mut self) {
        self.released.clear();
    }

    /// The pairs that are flat.
    pub fn flat_pairs(&self) -> &BTreeSet<u64> {
        &self.flat
    }

    /// The same program with these pairs flat.
    pub fn with_flat_pairs(self, flat: BTreeSet<u64>) -> Self {
        SheetProgram { flat, ..self }
    }

    /// A flat pair with offset e of its axes: the true gap at B's direction u is (e·u)²/2s above the height. Of all ways
    /// to spread the pair's force Σ μ = N and moment Σ μ u = T over the circle, the one that uses this least leaves a
    /// curvature −(T·e)²/(N s): the square of v·y in the motion y of the kernel. `None` for a pair that carries nothing.
    pub(super) fn flat_curvature(&self, x: &Posed, multipliers: &[Multiplier], key: u64) -> Option<Grad> {
        let (model, state) = (self.model, &x.state);
        let pair = pair_of_key(key);
        let b = state.circle(model, pair.ring_b, pair.shift);
        let (u, v) = b.frame();
        let (mut force, mut moment) = (0.0, Vec3::zeros());
        for m in multipliers.iter().filter(|m| m.key == key && m.value > 0.0) {
            force += m.value;
            moment += (u * m.angle.cos() + v * m.angle.sin()) * m.value;
        }
        if force < 1e-9 {
            return None;
        }
        let weight = (force * self.required(x, model.contact_distance(pair.ring_a, pair.ring_b))).sqrt();
        let reference = |ring: usize| state.poses[model.rings[ring].element].position;
        // From the element's reference point: to B's centre on B, and on A.
        let own = state.image(pair.shift).way_from(&reference(pair.ring_b), &b.center);
        let seen = b.center - reference(pair.ring_a);
        // The axes come apart by what B's centre moves in A's frame: e = x + β × own − α × seen.
        let parts = [moment, -seen.cross(&moment), own.cross(&moment)].map(|part| part / weight);
        Some(Grad::from_fn(|k, _| parts[k / 3][k % 3]))
    }
}
