//! Whether a small motion could raise l1, to second order: the curvature of −Σ μ g on the motions that keep the loaded contacts.
//!
//! **Unknowns.** A translation and a turn of every element, but no translation of one of them, the first of the cell that was solved, and no spin of a single ring about its own axis, which
//! change nothing; then l1 and what is free. The lattice carries the copies of the design's cell along.
//!
//! **A contact.** The distance d(y, θ) of the point θ of ring b from the circle of ring a, as the elements move by y. Its gradient is the
//! velocity of the point against the nearest point of a, along the normal between them. Second derivatives are differences of these gradients, of fourth
//! order. The least distance min d(y, θ) over θ has
//!
//! ∇²g = d_yy − d_yθ d_θy/d_θθ.
//!
//! Derivatives are taken along translations and turns of the moved bodies, not in coordinates. Of rotations they do not commute; half the sum of both
//! orders is the second derivative in rotation vectors.
//!
//! **Flat pairs.** Equal rings that lie on one another are closed along the whole circle, d_θθ = 0. Such a pair keeps its contacts
//! only without tilt, if its force N = Σ μ and the moment T = Σ μ u, u the directions of the points, have |T| < N: a height h + R τ·u that is nowhere negative and whose weighted
//! sum N h + R τ·T is 0 has τ = 0. With the offset e of the axes the gap is (e·u)²/2s above the height, which is linear in u: each way to spread
//! the force over the circle with the same N and T balances. Of all ways the one with the least Σ μ (δe·u)² = (T·δe)²/N counts for a motion with
//! δe = v_b − v_a − ω_a × (c_b − c_a); it stands in place of the recorded points' own.

use crate::{
    balance::Closed,
    sheet::{Pair, Sheet, Vec3, frame},
};
use nalgebra::{DMatrix, DVector, SMatrix, SVector, UnitQuaternion};
use std::collections::BTreeMap;

/// Step of the differences, in core distances.
const STEP: f64 = 1e-3;
/// Contacts that carry more are kept.
const LOADED: f64 = 1e-8;
/// Rows count as dependent below this share of the largest eigenvalue of their Gram matrix.
const DEPENDENT: f64 = 1e-12;
/// Curvature below this share of the largest is none.
pub(crate) const ZERO_MODE: f64 = 1e-7;
/// A recorded curvature is the one that is found within this share of it.
pub(crate) const CURVATURE: f64 = 1e-3;
/// d_θθ below which a contact has no place of its own.
pub(crate) const FLATTEST: f64 = 1e-6;
/// Tilt, and distance of the axes and difference of the radii in radii, of a pair that lies flat.
const FLAT: f64 = 1e-3;
/// |T|/N of a pair that is held flat, at most.
const ROCKING: f64 = 0.99;
/// The matrices are dense.
const MOST_UNKNOWNS: usize = 3000;

/// What was found.
#[derive(Clone, Debug)]
pub(crate) struct Curvature {
    /// Eigenvalues on the motions that keep the loaded contacts, ascending.
    pub values: Vec<f64>,
    /// Unknowns that no contact meets.
    pub idle: usize,
    /// Whether a pair lies flat.
    pub flat: bool,
}

impl Curvature {
    /// The largest |eigenvalue|, at least 1.
    pub fn scale(&self) -> f64 {
        self.values.iter().fold(1.0, |most, v| most.max(v.abs()))
    }

    /// The least that is not zero.
    pub fn least(&self) -> Option<f64> {
        let zero = ZERO_MODE * self.scale();
        self.values.iter().copied().find(|v| v.abs() > zero)
    }

    /// Whether one is about the size that counts as zero.
    pub fn near_zero(&self) -> bool {
        let zero = ZERO_MODE * self.scale();
        self.values.iter().any(|v| (0.1..10.0).contains(&(v.abs() / zero)))
    }

    /// How many are zero.
    pub fn zero_modes(&self) -> u64 {
        let zero = ZERO_MODE * self.scale();
        (self.idle + self.values.iter().filter(|v| v.abs() <= zero).count()) as u64
    }
}

/// Motions of a pair: translation and turn of a's element, then of b's image, then θ.
pub(crate) type Local = SVector<f64, 13>;

/// The gradient of the distance of the point from circle a after a motion of size h along `along`.
fn gradient(point: &Closed<'_>, along: usize, h: f64) -> Local {
    let (a, b, shift) = point.pair;
    let sheet = point.sheet;
    let body = |ring: usize, first: usize| {
        let (ring, body) = (&sheet.rings[ring], &sheet.bodies[sheet.rings[ring].element]);
        let mut step = [Vec3::zeros(), Vec3::zeros()];
        if (first..first + 6).contains(&along) {
            step[(along - first) / 3][(along - first) % 3] = h;
        }
        let turn = UnitQuaternion::from_scaled_axis(step[1]) * body.turn;
        (body.position + step[0], turn * ring.arm, turn * ring.normal, turn)
    };
    let (at_a, arm_a, axis, _) = body(a, 0);
    let (at_b, arm_b, _, turn) = body(b, 6);
    let at_b = at_b + sheet.translation(shift);
    // The frame in which the angle was measured, carried by the body.
    let (u, v) = frame(&sheet.circle(b, shift).normal);
    let carried = turn * sheet.bodies[sheet.rings[b].element].turn.inverse();
    let (u, v) = (carried * u, carried * v);
    let (sin, cos) = (point.angle + if along == 12 { h } else { 0.0 }).sin_cos();
    let radius = sheet.rings[b].radius;
    let (out, forward) = ((u * cos + v * sin) * radius, (v * cos - u * sin) * radius);
    let p = at_b + arm_b + out;
    let x = p - (at_a + arm_a);
    let across = x - axis * x.dot(&axis);
    let q = at_a + arm_a + across.normalize() * sheet.rings[a].radius;
    let n = (p - q).normalize();
    let (of_a, of_b) = ((q - at_a).cross(&n), (p - at_b).cross(&n));
    Local::from_column_slice(&[
        -n.x,
        -n.y,
        -n.z,
        -of_a.x,
        -of_a.y,
        -of_a.z,
        n.x,
        n.y,
        n.z,
        of_b.x,
        of_b.y,
        of_b.z,
        forward.dot(&n),
    ])
}

/// Second derivatives of the distance, symmetric.
fn hessian(point: &Closed<'_>) -> SMatrix<f64, 13, 13> {
    let (a, b, _) = point.pair;
    let step = STEP * point.sheet.touching(a, b);
    let mut out = SMatrix::<f64, 13, 13>::zeros();
    for along in 0..13 {
        let turns = !matches!(along % 6, 0..3) || along == 12;
        let size = point.sheet.rings[a].radius.max(point.sheet.rings[b].radius)
            + point.sheet.rings[a].arm.norm().max(point.sheet.rings[b].arm.norm());
        let h = if turns { step / size.max(1.0) } else { step };
        let g = |x: f64| gradient(point, along, x);
        let column = ((g(h) - g(-h)) * 8.0 - (g(2.0 * h) - g(-2.0 * h))) / (12.0 * h);
        out.set_column(along, &column);
    }
    (out + out.transpose()) * 0.5
}

/// Axes of the turns of an element: a single ring has none about its own axis.
pub(crate) fn turns(sheet: &Sheet, element: usize) -> Vec<Vec3> {
    let rings: Vec<usize> = (0..sheet.rings.len()).filter(|&r| sheet.rings[r].element == element).collect();
    match &rings[..] {
        [ring] if sheet.rings[*ring].arm.norm() < 1e-12 && sheet.rings[*ring].curve.is_none() => {
            let (u, v) = frame(&sheet.circle(*ring, [0, 0]).normal);
            vec![u, v]
        }
        _ => vec![Vec3::x(), Vec3::y(), Vec3::z()],
    }
}

/// The unknowns that move an element, with their motions: translation and turn.
struct Unknowns {
    of_element: Vec<Vec<(usize, [Vec3; 2])>>,
    first_parameter: usize,
    /// For each parameter the rates of the lattice vectors.
    rates: Vec<[Vec3; 2]>,
    /// Where the lattice carries each element, in lattice vectors.
    anchors: Vec<[f64; 2]>,
}

impl Unknowns {
    fn new(sheet: &Sheet, anchors: Vec<[f64; 2]>, rates: &[[Vec3; 2]], still: usize) -> Self {
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        let mut next = 0;
        let mut of_element = Vec::new();
        for element in 0..sheet.bodies.len() {
            let turns = turns(sheet, element);
            let shifts = axes.iter().filter(|_| element != still).map(|axis| [*axis, Vec3::zeros()]);
            let motions = shifts.chain(turns.into_iter().map(|axis| [Vec3::zeros(), axis]));
            of_element.push(motions.enumerate().map(|(k, motion)| (next + k, motion)).collect::<Vec<_>>());
            next += of_element[element].len();
        }
        Unknowns { of_element, first_parameter: next, rates: rates.to_vec(), anchors }
    }

    fn count(&self) -> usize {
        self.first_parameter + self.rates.len()
    }

    /// The unknowns that move a pair, each with the motion of a's element and of b's image.
    fn of_pair(&self, sheet: &Sheet, (a, b, shift): Pair) -> Vec<(usize, Local)> {
        let (i, j) = (sheet.rings[a].element, sheet.rings[b].element);
        let mut out: BTreeMap<usize, Local> = BTreeMap::new();
        let mut add = |unknown: usize, first: usize, [shift, turn]: [Vec3; 2]| {
            let local = out.entry(unknown).or_insert_with(Local::zeros);
            for axis in 0..3 {
                local[first + axis] += shift[axis];
                local[first + 3 + axis] += turn[axis];
            }
        };
        self.of_element[i].iter().for_each(|(k, motion)| add(*k, 0, *motion));
        self.of_element[j].iter().for_each(|(k, motion)| add(*k, 6, *motion));
        for (m, rate) in self.rates.iter().enumerate() {
            let moved = |by: [f64; 2]| [rate[0] * by[0] + rate[1] * by[1], Vec3::zeros()];
            add(self.first_parameter + m, 0, moved(self.anchors[i]));
            add(self.first_parameter + m, 6, moved([0, 1].map(|k| self.anchors[j][k] + f64::from(shift[k]))));
        }
        out.into_iter().collect()
    }
}

/// A pair that lies flat, with its contacts.
#[derive(Default)]
struct FlatPair {
    force: f64,
    moment: Vec3,
    /// Σ μ f, f being δe·u of a contact.
    drift: Local,
    /// Σ μ f fᵀ.
    drift_sq: SMatrix<f64, 13, 13>,
}

/// What one pair of rings adds to the curvature, in the motions of the two elements.
pub(crate) struct Term {
    pub pair: Pair,
    /// −Σ μ ∇²g.
    pub hessian: SMatrix<f64, 13, 13>,
    /// What a motion must keep.
    pub rows: Vec<Local>,
}

/// The terms of `points` with their forces, and whether a pair lies flat; or why they cannot be told.
pub(crate) fn terms(sheet: &Sheet, points: &[(Closed<'_>, f64)]) -> Result<(Vec<Term>, bool), String> {
    let mut out = Vec::new();
    let mut flat: BTreeMap<Pair, FlatPair> = BTreeMap::new();
    let round = |point: &Closed<'_>| point.curve.is_none();
    for (point, force) in points.iter().filter(|(point, _)| round(point) && lies_flat(sheet, point.pair)) {
        flat.entry(point.pair).or_default().add(sheet, point, *force);
    }
    // One that is held on one side alone has a least distance as any other pair.
    flat.retain(|_, found| found.moment.norm() <= ROCKING * found.force);
    for (point, force) in points {
        if let Some(contact) = &point.curve {
            let (a, b, shift) = point.pair;
            let found = contact.hessian();
            let h = found.map_err(|words| format!("rings {a} and {b} at {shift:?}: {words}"))?;
            let rows = if *force > LOADED { vec![contact.gradient()] } else { Vec::new() };
            out.push(Term { pair: point.pair, hessian: h * -*force, rows });
            continue;
        }
        let mut h = hessian(point);
        let bend = h[(12, 12)];
        let aside = h.column(12).into_owned();
        if !flat.contains_key(&point.pair) {
            if bend.is_nan() || bend <= FLATTEST {
                let (a, b, shift) = point.pair;
                return Err(format!("rings {a} and {b} at {shift:?} touch along an arc, and are not held flat"));
            }
            h -= aside * aside.transpose() / bend;
        }
        h.row_mut(12).fill(0.0);
        h.column_mut(12).fill(0.0);
        let rows = if *force > LOADED { vec![gradient(point, 0, 0.0)] } else { Vec::new() };
        out.push(Term { pair: point.pair, hessian: h * -*force, rows });
    }
    for (pair, found) in &flat {
        let least = found.drift * found.drift.transpose() / found.force;
        let (u, v) = frame(&sheet.circle(pair.0, [0, 0]).normal);
        let tilt = |axis: Vec3| {
            let mut tilt = Local::zeros();
            (0..3).for_each(|k| (tilt[3 + k], tilt[9 + k]) = (-axis[k], axis[k]));
            tilt
        };
        let hessian = (found.drift_sq - least) / sheet.touching(pair.0, pair.1);
        out.push(Term { pair: *pair, hessian, rows: vec![tilt(u), tilt(v)] });
    }
    Ok((out, !flat.is_empty()))
}

/// The sum of some terms over `n` unknowns, each with the unknowns that move its pair.
pub(crate) struct Sum {
    of_sum: DMatrix<f64>,
    gram: DMatrix<f64>,
}

impl Sum {
    pub fn new(n: usize) -> Self {
        Sum { of_sum: DMatrix::zeros(n, n), gram: DMatrix::zeros(n, n) }
    }

    pub fn add(&mut self, term: &Term, columns: &[(usize, Local)]) {
        for (i, x) in columns {
            let image = term.hessian * x;
            columns.iter().for_each(|(j, y)| self.of_sum[(*i, *j)] += y.dot(&image));
        }
        for gradient in &term.rows {
            let entries: Vec<(usize, f64)> = columns.iter().map(|(k, motion)| (*k, motion.dot(gradient))).collect();
            for (i, x) in &entries {
                entries.iter().for_each(|(j, y)| self.gram[(*i, *j)] += x * y);
            }
        }
    }

    /// Its curvatures on the motions that keep the rows.
    pub fn curvature(&self, flat: bool) -> Result<Curvature, String> {
        let (values, idle) = kept(&self.of_sum, &self.gram);
        if values.iter().any(|v| !v.is_finite()) {
            return Err("the eigenvalues of the curvature are not finite".into());
        }
        Ok(Curvature { values, idle, flat })
    }
}

/// The curvature at `points` with their forces, or why it cannot be told. `rates` are those of the lattice with l1 and what is free; element `still`
/// does not move.
pub(crate) fn curvature(
    sheet: &Sheet,
    points: &[(Closed<'_>, f64)],
    rates: &[[Vec3; 2]],
    anchors: Vec<[f64; 2]>,
    still: usize,
) -> Result<Curvature, String> {
    let unknowns = Unknowns::new(sheet, anchors, rates, still);
    let n = unknowns.count();
    if n > MOST_UNKNOWNS {
        return Err(format!("{n} unknowns; the curvature is derived of up to {MOST_UNKNOWNS}"));
    }
    let (terms, flat) = terms(sheet, points)?;
    let mut sum = Sum::new(n);
    terms.iter().for_each(|term| sum.add(term, &unknowns.of_pair(sheet, term.pair)));
    sum.curvature(flat)
}

/// Eigenvalues of `of_sum`, ascending, on the motions that keep the rows with this Gram matrix, and the number of unknowns that
/// neither meets.
pub(crate) fn kept(of_sum: &DMatrix<f64>, gram: &DMatrix<f64>) -> (Vec<f64>, usize) {
    let n = gram.nrows();
    let is_met = |k: &usize| gram[(*k, *k)] != 0.0 || of_sum.column(*k).iter().any(|x| *x != 0.0);
    let met: Vec<usize> = (0..n).filter(is_met).collect();
    if met.is_empty() {
        return (Vec::new(), n);
    }
    let block = |of: &DMatrix<f64>| DMatrix::from_fn(met.len(), met.len(), |i, j| of[(met[i], met[j])]);
    let eigen = block(gram).symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let free: Vec<DVector<f64>> = (0..met.len())
        .filter(|&k| eigen.eigenvalues[k] < DEPENDENT * largest)
        .map(|k| eigen.eigenvectors.column(k).into_owned())
        .collect();
    let mut values = Vec::new();
    if !free.is_empty() {
        let basis = DMatrix::from_columns(&free);
        let reduced = basis.transpose() * block(of_sum) * &basis;
        let reduced = (&reduced + reduced.transpose()) * 0.5;
        values = reduced.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
    }
    (values, n - met.len())
}

/// Whether two rings are equal, parallel and coaxial, nearly.
fn lies_flat(sheet: &Sheet, (a, b, shift): Pair) -> bool {
    let (one, other) = (sheet.circle(a, [0, 0]), sheet.circle(b, shift));
    let x = other.center - one.center;
    let apart = (x - one.normal.into_inner() * x.dot(&one.normal)).norm();
    let tilt = one.normal.cross(&other.normal).norm();
    tilt <= FLAT && apart.max((one.radius - other.radius).abs()) <= FLAT * one.radius
}

impl FlatPair {
    /// Adds a contact of the pair.
    fn add(&mut self, sheet: &Sheet, point: &Closed<'_>, force: f64) {
        let (a, b, shift) = point.pair;
        let (one, other) = (sheet.circle(a, [0, 0]), sheet.circle(b, shift));
        let x = other.center - one.center;
        let (u, v) = frame(&other.normal);
        let u = u * point.angle.cos() + v * point.angle.sin();
        let at = |ring: usize| sheet.bodies[sheet.rings[ring].element].position;
        let (arm_a, arm_b) = (one.center - at(a), other.center - at(b) - sheet.translation(shift));
        let (of_a, of_b) = (arm_a.cross(&u) + x.cross(&u), arm_b.cross(&u));
        let drift = Local::from_column_slice(&[
            -u.x, -u.y, -u.z, -of_a.x, -of_a.y, -of_a.z, u.x, u.y, u.z, of_b.x, of_b.y, of_b.z, 0.0,
        ]);
        self.force += force;
        self.moment += u * force;
        self.drift += drift * force;
        self.drift_sq += drift * drift.transpose() * force;
    }
}

#[cfg(test)]
mod tests;
