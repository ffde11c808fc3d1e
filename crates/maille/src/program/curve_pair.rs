//! The rows of a pair of cores that are not both circles.
//!
//! A row stands for each local minimum of the distance. Where curves run beside each other, as parallel sides do, the least distance is
//! at one end of the stretch that they have in common, or jumps from one to the other: so both ends are rows, and where arcs are
//! involved points between, as beside a flat contact of circles. All are distances of points of the one from the other curve, and so are
//! not smaller than the gap.

use super::{
    Posed, SheetProgram,
    curve_kernel::CurveContact,
    gap_kernel::{Grad, Hess},
    key::pair_key,
    pair::{FLAT, NEAR, PairMap},
};
use crate::{
    model::curve::{Core, CurveMinimum, CurvePoint},
    solver::constraints::{Derivatives, Row},
    topology::near_pairs::NearPair,
};
use maille_geometry::Piece;
use std::f64::consts::TAU;

/// Sine of the angle of segments beside each other below which both ends of their common stretch are rows.
const PARALLEL: f64 = 0.1;
/// Segments are looked for within this arc length of a minimum, in reference radii: where sides lie beside each other, the nearest point of
/// one that ends in an arc is on the arc.
const BEFORE: f64 = 0.1;
/// Arc lengths from a flat contact at which there are rows beside it, in reference radii.
const BESIDE: [f64; 6] = [-0.18, -0.12, -0.06, 0.06, 0.12, 0.18];
/// Points of a pair that are nearer than this, in reference radii, are one row.
const SAME: f64 = 1e-7;

/// A row that is to be: its points, which of them move, and whether it is a minimum.
#[derive(Clone, Copy)]
struct Candidate {
    points: [CurvePoint; 2],
    moves: [bool; 2],
    minimum: bool,
}

impl Candidate {
    fn of(m: &CurveMinimum) -> Self {
        Candidate { points: [m.a, m.b], moves: [m.a.smooth, m.b.smooth], minimum: true }
    }

    fn is(&self, other: &Candidate) -> bool {
        (0..2).all(|k| (self.points[k].point - other.points[k].point).norm() < SAME)
    }
}

/// The point of `a` at an end of its piece, and the nearest one of piece `j` of `b`, if that is no end.
fn end_beside(a: &Core, (i, end): (usize, f64), b: &Core, j: usize) -> Option<[CurvePoint; 2]> {
    let t = b.piece(j).nearest(&a.piece(i).point(end));
    (t > 0.0 && t < 1.0).then(|| [a.on_piece(i, end), b.on_piece(j, t)])
}

/// The rows beside the minimum `m`, which may be one end of a stretch where the curves keep their distance.
fn beside(near: &NearPair, m: &CurveMinimum) -> Vec<Candidate> {
    let segments = |core: &Core, at: &CurvePoint| {
        let pieces = core.pieces_within(at, BEFORE).into_iter().map(|k| (k, core.piece(k)));
        pieces.filter_map(|(k, piece)| if let Piece::Segment(it) = piece { Some((k, it)) } else { None }).collect()
    };
    let (of_a, of_b): (Vec<_>, Vec<_>) = (segments(&near.a, &m.a), segments(&near.b, &m.b));
    let mut out = Vec::new();
    for ((i, one), (j, other)) in of_a.iter().flat_map(|x| of_b.iter().map(move |y| (x, y))) {
        if one.along().cross(&other.along()).norm() < PARALLEL {
            // A held point and one that moves along its segment.
            for end in [0.0, 1.0] {
                let there = end_beside(&near.a, (*i, end), &near.b, *j);
                out.extend(there.map(|points| Candidate { points, moves: [false, true], minimum: true }));
                let back = end_beside(&near.b, (*j, end), &near.a, *i);
                out.extend(back.map(|[b, a]| Candidate { points: [a, b], moves: [true, false], minimum: true }));
            }
        }
    }
    let on_segments =
        [(&near.a, m.a), (&near.b, m.b)].map(|(core, at)| matches!(core.piece(at.piece), Piece::Segment(_)));
    let contact = CurveContact::of([m.a, m.b], &m.a.point, &m.b.point);
    let least = (contact.along() / m.distance.max(1e-12)).symmetric_eigenvalues().min();
    if on_segments != [true, true] && m.a.smooth && m.b.smooth && least < FLAT {
        let whole = near.b.length();
        out.extend(BESIDE.map(|along| {
            let b = near.b.at_angle(m.b.angle_rad + TAU * along / whole);
            let a = near.a.nearest(&b.point);
            Candidate { points: [a, b], moves: [a.smooth, false], minimum: false }
        }));
    }
    out
}

impl SheetProgram<'_> {
    fn contact(&self, x: &Posed, near: &NearPair, candidate: &Candidate) -> CurveContact {
        let (pair, state) = (&near.pair, &x.state);
        let reference_a = state.poses[self.model.rings[pair.ring_a].element].position;
        let reference_b = state.position(self.model.rings[pair.ring_b].element, pair.shift);
        CurveContact { moves: candidate.moves, ..CurveContact::of(candidate.points, &reference_a, &reference_b) }
    }

    /// As `pair_rows`, of cores that are not both circles.
    pub(super) fn curve_rows(
        &self,
        x: &Posed,
        near: &NearPair,
        band: f64,
        map: &PairMap,
        derivatives: Derivatives<'_>,
        rows: &mut Vec<Row>,
    ) {
        let (key, required) = (pair_key(&near.pair), self.required(x, near.touching));
        let mut all: Vec<Candidate> = Vec::new();
        let mut take = |candidate: Candidate| {
            if !all.iter().any(|known| known.is(&candidate)) {
                all.push(candidate);
            }
        };
        let minima = near.curve_minima(band + required);
        let minima = minima.iter().filter(|m| m.distance - required <= band);
        for m in minima {
            take(Candidate::of(m));
            if m.distance - required < NEAR {
                beside(near, m).into_iter().for_each(&mut take);
            }
        }
        for candidate in all {
            let contact = self.contact(x, near, &candidate);
            let (distance, grad): (f64, Grad) = contact.gradient();
            let [angle_a, angle] = candidate.points.map(|p| p.angle_rad);
            let mut row = Row {
                minimum: candidate.minimum,
                angle_a,
                columns: map.columns.clone(),
                gradient: self.gap_gradient(map, near, &grad),
                ..Row::value(key, angle, distance - required)
            };
            if let Derivatives::Second(loads) = derivatives
                && loads.may_load(&row)
            {
                let hess: Hess = contact.hessian();
                row.hessian = map.hessian(&grad, &hess);
            }
            rows.push(row);
        }
    }
}
