//! The rows of one pair of rings: gaps at the minima of the distance, beside flat ones, and a flat pair's heights.

use super::{
    Posed, SheetProgram,
    key::{bound_key, pair_key},
    metric::Factored,
};
use crate::{
    program::gap_kernel::{Grad, Hess, PairFrame, RootMotion},
    solver::constraints::{Derivatives, Row},
    topology::{RingPair, near_pairs::NearPair},
};
use maille_geometry::Vec3;

/// Contacts whose 2×2 Hessian in the contact angles is below this (and whose gap is below [`NEAR`]) get extra rows.
pub(super) const FLAT: f64 = 0.3;
/// See [`FLAT`]; in units of the reference radius.
pub(super) const NEAR: f64 = 0.1;
/// Angles of the extra rows beside a flat contact.
const BESIDE_RAD: [f64; 6] = [-0.18, -0.12, -0.06, 0.06, 0.12, 0.18];
/// Heights that stand for a flat pair's gap.
const HEIGHTS: usize = 16;

/// The unknowns that move a pair, and how: column by column, the motion y = (x, α, β) of the kernel.
pub(super) struct PairMap {
    pub columns: Vec<usize>,
    pub motions: Vec<Grad>,
    /// Second derivatives of the motion with two of these columns, where the lattice moves on a curve.
    pub(super) bends: Vec<(usize, usize, Grad)>,
    /// Parameters among the columns: parameter and place.
    pub(super) parameters: Vec<(usize, usize)>,
}

impl PairMap {
    pub(super) fn new() -> Self {
        let room = || Vec::with_capacity(14);
        PairMap { columns: room(), motions: Vec::with_capacity(14), bends: Vec::new(), parameters: Vec::new() }
    }

    /// The motions of the kernel themselves as unknowns.
    pub fn local() -> Self {
        let motions = (0..9).map(|k| Grad::from_fn(|i, _| f64::from(u8::from(i == k))));
        PairMap { columns: (0..9).collect(), motions: motions.collect(), ..PairMap::new() }
    }

    /// Place of a column, which is added where it is new.
    pub(super) fn place(&mut self, column: usize) -> usize {
        self.columns.iter().position(|&c| c == column).unwrap_or_else(|| {
            self.columns.push(column);
            self.motions.push(Grad::zeros());
            self.columns.len() - 1
        })
    }

    pub(super) fn add(&mut self, column: usize, block: usize, v: &Vec3, sign: f64) {
        let at = self.place(column);
        for axis in 0..3 {
            self.motions[at][3 * block + axis] += sign * v[axis];
        }
    }

    pub fn gradient(&self, grad: &Grad) -> Vec<f64> {
        self.motions.iter().map(|motion| motion.dot(grad)).collect()
    }

    pub(super) fn hessian(&self, grad: &Grad, hess: &Hess) -> Vec<f64> {
        let k = self.columns.len();
        let mut out = vec![0.0; k * k];
        for (c, motion) in self.motions.iter().enumerate() {
            let image = hess * motion;
            for (r, other) in self.motions.iter().enumerate().take(c + 1) {
                let value = other.dot(&image);
                (out[c * k + r], out[r * k + c]) = (value, value);
            }
        }
        for (r, c, bend) in &self.bends {
            out[c * k + r] += grad.dot(bend);
        }
        out
    }
}

/// A vector as that part of a motion y = (x, α, β).
pub(super) fn in_block(block: usize, v: &Vec3) -> Grad {
    let mut out = Grad::zeros();
    out.fixed_rows_mut::<3>(3 * block).copy_from(v);
    out
}

impl SheetProgram<'_> {
    /// The unknowns that move the pair, with their motions.
    pub(super) fn pair_map(
        &self,
        x: &Posed,
        pair: &RingPair,
        turns: &[Vec<Vec3>],
        factored: Option<&Factored>,
    ) -> PairMap {
        if let Some(roll) = &x.state.roll {
            return self.rolled_map(&x.state, roll, pair, turns);
        }
        let (i, j) = (self.model.rings[pair.ring_a].element, self.model.rings[pair.ring_b].element);
        let mut map = PairMap::new();
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        if i != j {
            for (element, sign) in [(i, -1.0), (j, 1.0)] {
                if let Some(t) = self.columns[element].0 {
                    axes.iter().enumerate().for_each(|(k, axis)| map.add(t + k, 0, axis, sign));
                }
            }
        }
        for (element, block) in [(i, 1), (j, 2)] {
            let first = self.columns[element].1;
            turns[element].iter().enumerate().for_each(|(k, axis)| map.add(first + k, block, axis, 1.0));
        }
        let [from, to] = [i, j].map(|e| self.model.elements[e].anchor);
        let shift: [f64; 2] = std::array::from_fn(|k| f64::from(pair.shift[k]) + (to[k] - from[k]));
        let image = |[a1, a2]: [Vec3; 2]| a1 * shift[0] + a2 * shift[1];
        for (m, parameter) in self.pull.parameters.iter().enumerate() {
            let rate = image(factored.map_or(parameter.rate, |f| self.pull.base.map(|a| f.rate(m, &a))));
            if rate != Vec3::zeros() || parameter.keeps(1.0) != 0.0 {
                map.add(self.first_parameter + m, 0, &rate, 1.0);
                map.parameters.push((m, map.columns.len() - 1));
            }
        }
        for (f, &(m, r)) in factored.iter().flat_map(|f| map.parameters.iter().map(move |at| (f, at))) {
            let bend = |&(n, c): &(usize, usize)| (r, c, in_block(0, &image(self.pull.base.map(|a| f.bend(m, n, &a)))));
            map.bends.extend(map.parameters.iter().map(bend));
        }
        map
    }

    /// Rows that hold parameters below their bounds.
    pub(super) fn bound_rows(&self, x: &Posed) -> Vec<Row> {
        let bounded = self.pull.parameters.iter().enumerate().filter_map(|(m, p)| Some((m, p.most?)));
        let row = |(m, most): (usize, f64)| Row {
            columns: vec![self.first_parameter + m],
            gradient: vec![-1.0],
            hessian: vec![0.0],
            ..Row::value(bound_key(m), 0.0, most - x.p[m])
        };
        bounded.map(row).chain(self.area_rows(x)).chain(self.neutral_rows(x)).collect()
    }

    fn frame(&self, x: &Posed, near: &NearPair) -> PairFrame {
        let (pair, state) = (&near.pair, &x.state);
        let reference_a = state.poses[self.model.rings[pair.ring_a].element].position;
        let reference_b = state.position(self.model.rings[pair.ring_b].element, pair.shift);
        PairFrame::new(near.a.circle(), &reference_a, near.b.circle(), &reference_b)
    }

    /// Gradient of a gap in the unknowns of `map`, from that of the distance.
    pub(super) fn gap_gradient(&self, map: &PairMap, near: &NearPair, distance: &Grad) -> Vec<f64> {
        let mut out = map.gradient(distance);
        for &(m, at) in &map.parameters {
            out[at] -= self.pull.parameters[m].keeps(near.touching);
        }
        out
    }

    /// The gaps of a pair at the points of B at `angles_rad`.
    pub(super) fn gaps_at(
        &self,
        x: &Posed,
        near: &NearPair,
        (turns, factored): (&[Vec<Vec3>], Option<&Factored>),
        angles_rad: &[f64],
    ) -> Vec<Row> {
        let frame = self.frame(x, near);
        let map = self.pair_map(x, &near.pair, turns, factored);
        let required = self.required(x, near.touching);
        let gap = |&angle: &f64| {
            let (distance, grad) = frame.distance_gradient(angle);
            Row {
                minimum: false,
                columns: map.columns.clone(),
                gradient: self.gap_gradient(&map, near, &grad),
                ..Row::value(pair_key(&near.pair), angle, distance - required)
            }
        };
        angles_rad.iter().map(gap).collect()
    }

    /// Adds the rows of a pair up to `band` in the unknowns of `map`, with first derivatives, and second ones where they are asked for.
    pub(super) fn pair_rows(
        &self,
        x: &Posed,
        near: &NearPair,
        band: f64,
        map: &PairMap,
        derivatives: Derivatives<'_>,
        rows: &mut Vec<Row>,
    ) {
        if near.circles().is_none() {
            return self.curve_rows(x, near, band, map, derivatives, rows);
        }
        let key = pair_key(&near.pair);
        let frame = self.frame(x, near);
        let required = self.required(x, near.touching);
        let loaded = |angle: f64, minimum: bool| match derivatives {
            Derivatives::Second(loads) => loads.may_load(&Row { minimum, ..Row::value(key, angle, 0.0) }),
            _ => false,
        };
        let mut add = |angle: f64, minimum: bool, distance: f64, grad: &Grad, hess: Option<&Hess>| {
            rows.push(Row {
                minimum,
                columns: map.columns.clone(),
                gradient: self.gap_gradient(map, near, grad),
                hessian: hess.map_or_else(Vec::new, |h| map.hessian(grad, h)),
                ..Row::value(key, angle, distance - required)
            });
        };
        if self.flat.contains(&key) {
            let (a, b) = (near.a.circle(), near.b.circle());
            let side = (b.center - a.center).dot(&a.normal).signum();
            for angle in height_angles_rad() {
                let (z, grad, hess) = frame.height(angle);
                let hess = loaded(angle, false).then(|| hess * side);
                add(angle, false, side * z, &(grad * side), hess.as_ref());
            }
            return;
        }
        for m in near.minima().iter().filter(|m| m.distance - required <= band) {
            let (_, grad) = frame.distance_gradient(m.angle_b_rad());
            let hess = loaded(m.angle_b_rad(), true).then(|| {
                let root = frame.jet(m.angle_b_rad());
                root.distance_derivatives(&RootMotion::at(&root)).1
            });
            add(m.angle_b_rad(), true, m.distance, &grad, hess.as_ref());
            let [[aa, ab], [_, bb]] = m.hessian;
            let least = 0.5 * (aa + bb) - (0.5 * (aa - bb)).hypot(ab);
            if least < FLAT && m.distance - required < NEAR {
                for offset in BESIDE_RAD {
                    let angle = m.angle_b_rad() + offset;
                    let (distance, grad) = frame.distance_gradient(angle);
                    let hess = loaded(angle, false).then(|| frame.jet(angle).distance_derivatives_fixed().1);
                    add(angle, false, distance, &grad, hess.as_ref());
                }
            }
        }
    }
}

/// The angles of a flat pair's heights.
pub(super) fn height_angles_rad() -> impl Iterator<Item = f64> {
    (0..HEIGHTS).map(|k| std::f64::consts::TAU * k as f64 / HEIGHTS as f64)
}
