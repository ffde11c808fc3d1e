//! Contact energy E_c of a cell: every overlapping local minimum (eq. 4.1.3), and the sampled points beside it (§4.1.2);
//! points around the circles where a pair is flat. Of cores that are not both circles the minima alone count.

use super::{
    barrier::ContactLaw,
    flat::{self, FLAT_CURVATURE, FlatPair, Side},
};
use crate::{
    model::Model,
    model::curve::curve_distance_minima,
    program::curve_kernel::CurveContact,
    program::gap_kernel::{Grad, Hess, Jet, PairFrame, RootMotion, symmetric},
    solver::curvature::Curvature,
    state::State,
    topology::{RingPair, broad_phase::in_chunks, close_pairs},
};
use maille_geometry::{
    Approach, Approaches, Circle, MAX_MINIMA, Vec3, circle_distance_approaches, circle_distance_minima_polynomial,
};
use serde::{Deserialize, Serialize};

/// Which way the minima of the circle–circle distance are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MinimaMethod {
    /// Complete enumeration.
    Enumeration,
    /// The degree-8 polynomial of Appendix A; loses minima in near-degenerate pairs.
    Polynomial,
}

/// Parameters of the contact energy, in units of the reference radius.
#[doc(hidden)]
#[derive(Clone, Debug, PartialEq)]
pub struct ContactOptions {
    /// What an overlap costs.
    pub law: ContactLaw,
    /// Its weight α (eq. 4.1.1, 4.1.3).
    pub alpha: f64,
    /// Offsets δ of the non-minimal points θ + δ on the second circle (eq. 4.1.4), radians.
    pub sample_offsets_rad: Vec<f64>,
    /// How minima are found.
    pub minima: MinimaMethod,
    /// Points on each circle of a flat pair, in place of its minima; 0: no pair counts as flat.
    pub flat_points: usize,
}

/// An overlapping pair.
#[expect(clippy::large_enum_variant, reason = "nearly all are rings")]
enum Overlap {
    /// Two rings.
    Rings(RingOverlap),
    /// Cores of which one is no circle: their overlapping minima.
    Curves { pair: RingPair, contact_distance: f64, minima: Vec<CurveContact> },
}

/// Two overlapping rings with their frame and the angles on B of their overlapping minima.
struct RingOverlap {
    pair: RingPair,
    frame: PairFrame,
    contact_distance: f64,
    minima: [(f64, f64); MAX_MINIMA],
    count: usize,
    flat: Option<FlatPair>,
}

impl RingOverlap {
    fn minima(&self) -> &[(f64, f64)] {
        &self.minima[..self.count]
    }
}

/// The overlaps of some pairs, in their order.
fn overlaps(
    model: &Model,
    state: &State,
    circles: &[Circle],
    options: &ContactOptions,
    pairs: &[RingPair],
) -> Vec<Overlap> {
    let round = |pair: &RingPair| [pair.ring_a, pair.ring_b].iter().all(|ring| model.rings[*ring].is_round());
    let (rings, curves): (Vec<RingPair>, Vec<RingPair>) = pairs.iter().partition(|pair| round(pair));
    let mut out = ring_overlaps(model, state, circles, options, &rings);
    out.extend(curves.iter().filter_map(|pair| curve_overlap(model, state, pair)));
    out
}

/// The overlap of cores that are not both circles.
fn curve_overlap(model: &Model, state: &State, pair: &RingPair) -> Option<Overlap> {
    let contact_distance = model.contact_distance(pair.ring_a, pair.ring_b);
    let (a, b) = (state.core(model, pair.ring_a, [0, 0]), state.core(model, pair.ring_b, pair.shift));
    let reference_a = state.poses[model.rings[pair.ring_a].element].position;
    let reference_b = state.poses[model.rings[pair.ring_b].element].position + state.translation(pair.shift);
    let found = curve_distance_minima(&a, &b, contact_distance);
    let overlapping = found.iter().filter(|m| m.distance < contact_distance);
    let minima: Vec<CurveContact> =
        overlapping.map(|m| CurveContact::of([m.a, m.b], &reference_a, &reference_b)).collect();
    (!minima.is_empty()).then_some(Overlap::Curves { pair: *pair, contact_distance, minima })
}

/// The overlaps of pairs of rings.
fn ring_overlaps(
    model: &Model,
    state: &State,
    circles: &[Circle],
    options: &ContactOptions,
    pairs: &[RingPair],
) -> Vec<Overlap> {
    let of = |pair: &RingPair| {
        let b = circles[pair.ring_b];
        (circles[pair.ring_a], Circle { center: b.center + state.translation(pair.shift), ..b })
    };
    let placed: Vec<(Circle, Circle)> = pairs.iter().map(of).collect();
    let reach: Vec<f64> = pairs.iter().map(|p| model.contact_distance(p.ring_a, p.ring_b)).collect();
    let mut found = vec![Approaches::NONE; pairs.len()];
    if options.minima == MinimaMethod::Enumeration {
        circle_distance_approaches(&placed, &reach, &mut found);
    }
    let mut out = Vec::new();
    for (k, pair) in pairs.iter().enumerate() {
        let ((a, b), contact_distance) = (&placed[k], reach[k]);
        let (mut minima, mut count) = ([(0.0, 0.0); MAX_MINIMA], 0);
        let mut add = |angle_rad: f64, distance: f64| {
            if distance < contact_distance {
                minima[count] = (angle_rad, distance);
                count += 1;
            }
        };
        match options.minima {
            MinimaMethod::Enumeration => {
                let (u, v) = b.frame();
                let angle = |m: &Approach| m.direction_b.dot(&v).atan2(m.direction_b.dot(&u));
                found[k].as_slice().iter().for_each(|m| add(angle(m), m.distance));
            }
            MinimaMethod::Polynomial => {
                let found = circle_distance_minima_polynomial(a, b);
                found.as_slice().iter().for_each(|m| add(m.angle_b_rad(), m.distance));
            }
        }
        let flat = flat_pair(model, state, options, pair, &placed[k], contact_distance);
        if count > 0 || flat.is_some() {
            let reference_a = state.poses[model.rings[pair.ring_a].element].position;
            let reference_b = state.poses[model.rings[pair.ring_b].element].position + state.translation(pair.shift);
            let frame = PairFrame::new(a, &reference_a, b, &reference_b);
            out.push(Overlap::Rings(RingOverlap { pair: *pair, frame, contact_distance, minima, count, flat }));
        }
    }
    out
}

/// The pair as a flat one, if it is one at least in part.
fn flat_pair(
    model: &Model,
    state: &State,
    options: &ContactOptions,
    pair: &RingPair,
    (a, b): &(Circle, Circle),
    touching: f64,
) -> Option<FlatPair> {
    let flat = options.flat_points > 0 && flat::curvature_sq(a, b, touching) < FLAT_CURVATURE * FLAT_CURVATURE;
    flat.then(|| {
        let a = Side::new(model, state, pair.ring_a, Vec3::zeros());
        let b = Side::new(model, state, pair.ring_b, state.translation(pair.shift));
        FlatPair::new(&a, &b, touching, options.flat_points)
    })
}

/// `of` applied to the overlaps of the cell piece by piece, the results in the order of the pairs: nothing depends on the
/// number of threads.
fn for_overlaps<R: Send>(
    model: &Model,
    state: &State,
    options: &ContactOptions,
    of: impl Fn(Vec<Overlap>) -> Vec<R> + Sync,
) -> Vec<R> {
    let circles: Vec<Circle> = (0..model.rings.len()).map(|ring| state.circle(model, ring, [0, 0])).collect();
    in_chunks(&close_pairs(model, state, 0.0), |pairs| of(overlaps(model, state, &circles, options, pairs)))
}

/// E_c of one cell.
pub(super) fn energy(model: &Model, options: &ContactOptions, state: &State) -> f64 {
    let parts = for_overlaps(model, state, options, |overlaps| {
        let of_minima = |overlap: &RingOverlap| {
            let mut sum = 0.0;
            for &(angle, distance) in overlap.minima() {
                sum += options.law.at(distance, overlap.contact_distance, options.alpha)[0];
                for offset in &options.sample_offsets_rad {
                    let distance = overlap.frame.distance(angle + offset);
                    sum += options.law.at(distance, overlap.contact_distance, options.alpha)[0];
                }
            }
            sum
        };
        let of_rings = |overlap: &RingOverlap| match &overlap.flat {
            None => of_minima(overlap),
            Some(flat) => {
                let weight = flat.weight().value;
                // An infinite energy of minima has no part in what is wholly flat.
                let minima = if weight < 1.0 { (1.0 - weight) * of_minima(overlap) } else { 0.0 };
                minima + weight * flat.energy(options.law, options.alpha)
            }
        };
        let of = |overlap: &Overlap| match overlap {
            Overlap::Rings(overlap) => of_rings(overlap),
            Overlap::Curves { contact_distance, minima, .. } => {
                let law =
                    |contact: &CurveContact| options.law.at(contact.gradient().0, *contact_distance, options.alpha)[0];
                minima.iter().map(law).sum()
            }
        };
        vec![overlaps.iter().map(of).sum::<f64>()]
    });
    parts.into_iter().sum()
}

/// The minima of an overlap with the points beside them.
fn minima_jet(options: &ContactOptions, overlap: &RingOverlap) -> Jet {
    let mut sum = Jet::ZERO;
    for &(angle, _) in overlap.minima() {
        let root = overlap.frame.jet(angle);
        let motion = RootMotion::at(&root);
        let samples = options
            .sample_offsets_rad
            .iter()
            .filter(|offset| overlap.frame.distance(angle + **offset) < overlap.contact_distance)
            .map(|offset| overlap.frame.jet(angle + offset));
        for jet in std::iter::once(root).chain(samples) {
            let (grad, hess) = jet.distance_derivatives(&motion);
            let law = options.law.at(jet.distance, overlap.contact_distance, options.alpha);
            sum.add_of(law, &grad, &hess);
        }
    }
    sum
}

/// The energy of an overlap: of its minima, of its circles where it is flat, or of both.
fn overlap_jet(options: &ContactOptions, overlap: &Overlap) -> Jet {
    let overlap = match overlap {
        Overlap::Rings(overlap) => overlap,
        Overlap::Curves { contact_distance, minima, .. } => {
            let mut sum = Jet::ZERO;
            for contact in minima {
                let (distance, grad) = contact.gradient();
                let law = options.law.at(distance, *contact_distance, options.alpha);
                sum.add_of(law, &grad, &contact.hessian());
            }
            return sum;
        }
    };
    let Some(flat) = &overlap.flat else { return minima_jet(options, overlap) };
    let (weight, circle) = (flat.weight(), flat.jet(options.law, options.alpha));
    if weight.value == 1.0 {
        return circle;
    }
    let minima = minima_jet(options, overlap);
    let (lack, grad) = (circle.value - minima.value, circle.grad - minima.grad);
    Jet {
        value: minima.value + weight.value * lack,
        grad: minima.grad + grad * weight.value + weight.grad * lack,
        hess: minima.hess
            + (circle.hess - minima.hess) * weight.value
            + symmetric(&grad, &weight.grad)
            + weight.hess * lack,
    }
}

/// Adds gradient and Hessian of E_c; returns E_c.
pub(super) fn add_derivatives(
    model: &Model,
    options: &ContactOptions,
    state: &State,
    gradient: &mut [f64],
    hessian: &mut Curvature,
) -> f64 {
    let parts = for_overlaps(model, state, options, |overlaps| {
        let of = |overlap: &Overlap| {
            let (Overlap::Rings(RingOverlap { pair, .. }) | Overlap::Curves { pair, .. }) = overlap;
            (*pair, overlap_jet(options, overlap))
        };
        overlaps.iter().map(of).collect()
    });
    let mut sum = 0.0;
    for (pair, jet) in parts {
        sum += jet.value;
        scatter(model, &pair, &jet.grad, &jet.hess, gradient, hessian);
    }
    sum
}

/// Adds a pair's derivatives in y = (x, α, β) to those in the cell's unknowns: x = x_j + s1 a1 + s2 a2 − x_i.
fn scatter(model: &Model, pair: &RingPair, grad: &Grad, hess: &Hess, gradient: &mut [f64], hessian: &mut Curvature) {
    let (i, j) = (model.rings[pair.ring_a].element, model.rings[pair.ring_b].element);
    let lattice = 6 * model.elements.len();
    let (s1, s2) = (f64::from(pair.shift[0]), f64::from(pair.shift[1]));
    let mut entries: Vec<(usize, usize, f64)> = Vec::with_capacity(18);
    for axis in 0..3 {
        if i != j {
            entries.push((axis, 6 * i + axis, -1.0));
            entries.push((axis, 6 * j + axis, 1.0));
        }
        if s1 != 0.0 {
            entries.push((axis, lattice + axis, s1));
        }
        if s2 != 0.0 {
            entries.push((axis, lattice + 3 + axis, s2));
        }
        entries.push((3 + axis, 6 * i + 3 + axis, 1.0));
        entries.push((6 + axis, 6 * j + 3 + axis, 1.0));
    }
    for &(p, column, c) in &entries {
        gradient[column] += c * grad[p];
    }
    hessian.add(&entries, 9, |p, q| hess[(p, q)]);
}
