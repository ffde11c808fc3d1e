//! Core curves: circles, and closed curves of segments and arcs; an open curve is there and back.

mod level;
mod minima;
mod tree;

pub use minima::{CurveMinimum, curve_distance_minima};
pub(crate) use minima::{curve_distance, distance_lower_bound, owned_distance_minima};

use self::{level::Middle, tree::Node};
use crate::state::{Pose, images::Image};
use maille_design::{
    CurveKind,
    shape::{CorePieces, Owned, SMOOTH},
};
use maille_geometry::{Circle, Piece, Place, Vec3};
use nalgebra::UnitQuaternion;
use std::{borrow::Cow, f64::consts::TAU, sync::Arc};

/// A closed curve of segments and arcs, in its element's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What it stands for.
    pub kind: CurveKind,
    /// The pieces, each from where the one before ends.
    pub pieces: Vec<Piece>,
    /// What of each belongs to this curve: the struts of a frame lie on several, and count on one; an open curve is there and back, and counts there.
    pub(crate) owned: Vec<Owned>,
    /// How far the form that they stand for is from them, at sampled points.
    pub deviation: f64,
    /// Length of the curve up to the start of each piece, and all of it.
    lengths: Vec<f64>,
    /// Whether the tangent goes on from the piece before into each.
    smooth: Vec<bool>,
    /// The middle of each piece.
    middles: Vec<Middle>,
    /// Runs of pieces, with balls around them and cones of their tangents.
    nodes: Vec<Node>,
}

impl Curve {
    /// The curve of these pieces.
    pub(crate) fn new(CorePieces { kind, pieces, owned, deviation }: CorePieces) -> Self {
        let mut lengths = vec![0.0];
        for piece in &pieces {
            lengths.push(lengths[lengths.len() - 1] + piece.length());
        }
        let before = pieces.iter().cycle().skip(pieces.len() - 1);
        let smooth: Vec<bool> = pieces
            .iter()
            .zip(before)
            .map(|(piece, before)| {
                let (arrives, leaves) = (before.tangent(1.0), piece.tangent(0.0));
                arrives.dot(&leaves) > 0.0 && arrives.cross(&leaves).norm() < SMOOTH
            })
            .collect();
        let n = pieces.len();
        // The one piece of a circle meets itself.
        let joins = |k: usize| n == 1 || smooth[k % n];
        let middles =
            pieces.iter().enumerate().map(|(k, piece)| Middle::new(piece, joins(k) && joins(k + 1))).collect();
        let nodes = tree::nodes(&pieces);
        Curve { kind, pieces, owned, deviation, lengths, smooth, middles, nodes }
    }

    /// The pieces that belong to it: all, but those of a frame that lie on a curve before it, too, and those of an open curve's way back.
    pub fn own_pieces(&self) -> impl Iterator<Item = &Piece> {
        self.pieces.iter().zip(&self.owned).filter(|(_, owned)| owned.inside).map(|(piece, _)| piece)
    }

    /// Length of the pieces that belong to it.
    pub fn own_length(&self) -> f64 {
        self.own_pieces().map(Piece::length).sum()
    }

    /// Whether the piece with this point belongs to it.
    pub(crate) fn owns(&self, point: &CurvePoint) -> bool {
        self.owned[point.piece].inside
    }

    /// Length of the curve.
    pub fn length(&self) -> f64 {
        self.lengths[self.pieces.len()]
    }

    /// Radii of its arcs.
    pub fn arc_radii(&self) -> Vec<f64> {
        let radius = |piece: &Piece| match piece {
            Piece::Segment(_) => None,
            Piece::Arc(arc) => Some(arc.circle().radius),
        };
        self.own_pieces().filter_map(radius).collect()
    }

    /// Whether `map`, an isometry, takes the pieces to those of `other`, in any order and direction.
    pub(crate) fn maps_to(&self, other: &Curve, map: impl Fn(Vec3) -> Vec3, tolerance: f64) -> bool {
        let points = |piece: &Piece| [0.0, 0.5, 1.0].map(|t| piece.point(t));
        let there: Vec<[Vec3; 3]> = other.pieces.iter().map(points).collect();
        let mut taken = vec![false; there.len()];
        self.pieces.len() == there.len()
            && self.pieces.iter().all(|piece| {
                let [start, middle, end] = points(piece).map(&map);
                let close = |p: Vec3, q: Vec3| (p - q).norm() <= tolerance;
                let fits = |k: &usize| {
                    let [first, between, last] = there[*k];
                    let ends = close(start, first) && close(end, last) || close(start, last) && close(end, first);
                    !taken[*k] && close(middle, between) && ends
                };
                let found = (0..taken.len()).find(fits);
                found.inspect(|k| taken[*k] = true).is_some()
            })
    }
}

/// A core curve as it stands.
#[derive(Clone, Debug)]
pub enum Core {
    /// A circle.
    Circle(Circle),
    /// Another curve, in its element's frame, and the element's pose.
    Curve(Arc<Curve>, Pose),
}

/// A point of a core curve with what its neighbourhood is like.
#[derive(Clone, Copy, Debug)]
pub struct CurvePoint {
    /// Where it is.
    pub point: Vec3,
    /// Part of the curve's length up to it, times 2π.
    pub angle_rad: f64,
    /// Unit tangent.
    pub tangent: Vec3,
    /// Derivative of the tangent by arc length.
    pub curvature: Vec3,
    /// Whether it lies inside a piece, or at a joint without a corner.
    pub smooth: bool,
    /// Piece on which it lies.
    pub piece: usize,
}

impl Curve {
    /// The point at `t` of a piece.
    fn at(&self, piece: usize, t: f64) -> CurvePoint {
        let [from, to] = [self.lengths[piece], self.lengths[piece + 1]];
        let closed = self.pieces.len() == 1;
        let joint = |k: usize| closed || self.smooth[k % self.smooth.len()];
        let of = &self.pieces[piece];
        CurvePoint {
            point: of.point(t),
            angle_rad: TAU * (from + (to - from) * t) / self.length(),
            tangent: of.tangent(t),
            curvature: of.curvature(t),
            smooth: (t > 0.0 || joint(piece)) && (t < 1.0 || joint(piece + 1)),
            piece,
        }
    }

    /// The pieces that come within an arc length of one of its points.
    fn pieces_within(&self, point: &CurvePoint, away: f64) -> Vec<usize> {
        let (n, whole) = (self.pieces.len(), self.length());
        let at = point.angle_rad / TAU * whole;
        let ahead = |from: f64, to: f64| (to - from).rem_euclid(whole) <= away;
        let mut out = vec![point.piece];
        out.extend((1..n).map(|k| (point.piece + k) % n).take_while(|k| ahead(at, self.lengths[*k])));
        out.extend((1..n).map(|k| (point.piece + n - k) % n).take_while(|k| ahead(self.lengths[*k + 1], at)));
        out
    }

    /// Derivative of the tangent on the piece that meets another one at this end.
    fn beyond(&self, piece: usize, end: Place) -> Option<Vec3> {
        let n = self.pieces.len();
        match end {
            Place::Inside => None,
            Place::Start => Some(self.pieces[(piece + n - 1) % n].curvature(1.0)),
            Place::End => Some(self.pieces[(piece + 1) % n].curvature(0.0)),
        }
    }

    pub(crate) fn at_angle(&self, angle_rad: f64) -> CurvePoint {
        let length = angle_rad.rem_euclid(TAU) / TAU * self.length();
        let piece = self.lengths.partition_point(|l| *l <= length).clamp(1, self.pieces.len()) - 1;
        let [from, to] = [self.lengths[piece], self.lengths[piece + 1]];
        self.at(piece, ((length - from) / (to - from)).clamp(0.0, 1.0))
    }

    fn nearest(&self, p: &Vec3) -> CurvePoint {
        let near = self.pieces.iter().enumerate().map(|(k, piece)| {
            let t = piece.nearest(p);
            (k, t, (piece.point(t) - p).norm_squared())
        });
        let (piece, t, _) = near.min_by(|x, y| x.2.total_cmp(&y.2)).expect("a curve has a piece");
        self.at(piece, t)
    }
}

impl CurvePoint {
    /// It, of a curve in a frame, where the frame's pose takes it.
    fn moved(self, pose: &Pose) -> CurvePoint {
        let turned = |v: Vec3| pose.rotation * v;
        CurvePoint {
            point: turned(self.point) + pose.position,
            tangent: turned(self.tangent),
            curvature: turned(self.curvature),
            ..self
        }
    }
}

impl Core {
    /// The circle of a core that is one.
    ///
    /// # Panics
    /// For another curve.
    pub(crate) fn circle(&self) -> &Circle {
        match self {
            Core::Circle(circle) => circle,
            Core::Curve(..) => panic!("the core is no circle"),
        }
    }

    /// It as an image has it.
    pub(crate) fn image(&self, image: &Image) -> Core {
        match self {
            Core::Circle(circle) => Core::Circle(image.circle(circle)),
            Core::Curve(curve, pose) => Core::Curve(Arc::clone(curve), image.pose(pose)),
        }
    }

    /// Its curve and the pose that takes it where it stands; a circle is a curve of one piece.
    fn curve(&self) -> (Cow<'_, Curve>, Pose) {
        match self {
            Core::Circle(circle) => {
                let pose = Pose { position: circle.center, rotation: UnitQuaternion::identity() };
                let circle = Circle { center: Vec3::zeros(), ..*circle };
                (Cow::Owned(Curve::new(CorePieces::closed(vec![Piece::circle(circle)], 0.0))), pose)
            }
            Core::Curve(curve, pose) => (Cow::Borrowed(&**curve), *pose),
        }
    }

    /// Its pieces as they stand.
    pub fn pieces(&self) -> Vec<Piece> {
        let (curve, pose) = self.curve();
        curve.pieces.iter().map(|piece| piece.moved(&pose.rotation, &pose.position)).collect()
    }

    /// Length of the curve.
    pub(crate) fn length(&self) -> f64 {
        self.curve().0.length()
    }

    /// Piece `k` as it stands.
    pub(crate) fn piece(&self, k: usize) -> Piece {
        let (curve, pose) = self.curve();
        curve.pieces[k].moved(&pose.rotation, &pose.position)
    }

    /// The point at `t` of a piece.
    pub(crate) fn on_piece(&self, piece: usize, t: f64) -> CurvePoint {
        let (curve, pose) = self.curve();
        curve.at(piece, t).moved(&pose)
    }

    /// Its own pieces that come within an arc length of one of its points.
    pub(crate) fn pieces_within(&self, point: &CurvePoint, away: f64) -> Vec<usize> {
        let curve = self.curve().0;
        curve.pieces_within(point, away).into_iter().filter(|k| curve.owned[*k].inside).collect()
    }

    /// Its own pieces as they stand.
    pub fn own_pieces(&self) -> Vec<Piece> {
        let (curve, pose) = self.curve();
        curve.own_pieces().map(|piece| piece.moved(&pose.rotation, &pose.position)).collect()
    }

    /// The point at an angle: see [`CurvePoint::angle_rad`].
    pub fn at_angle(&self, angle_rad: f64) -> CurvePoint {
        let (curve, pose) = self.curve();
        curve.at_angle(angle_rad).moved(&pose)
    }

    /// Its least and largest coordinate along a unit vector.
    pub fn extent(&self, axis: &Vec3) -> [f64; 2] {
        let (curve, pose) = self.curve();
        let (axis, at) = (pose.rotation.inverse() * axis, pose.position.dot(axis));
        let support =
            |axis: Vec3| curve.pieces.iter().map(|piece| piece.support(&axis)).fold(f64::NEG_INFINITY, f64::max);
        [at - support(-axis), at + support(axis)]
    }

    /// The nearest point to `p`.
    pub(crate) fn nearest(&self, p: &Vec3) -> CurvePoint {
        let (curve, pose) = self.curve();
        curve.nearest(&(pose.rotation.inverse() * (p - pose.position))).moved(&pose)
    }
}
