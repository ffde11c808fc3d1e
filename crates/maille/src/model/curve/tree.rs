//! Runs of a curve's pieces, halved again and again: what can be ruled out of two runs at once.

use maille_design::shape::ball;
use maille_geometry::{Piece, Vec3};
use std::f64::consts::PI;

/// Neighbouring pieces of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    /// Where its pieces begin and end.
    pub first: usize,
    pub end: usize,
    /// Its second half; the first one follows it in the list.
    pub second: usize,
    /// A ball that holds the pieces.
    pub center: Vec3,
    pub radius: f64,
    /// Axis and half angle of a cone that holds their tangents, and what lies between the tangents at corners.
    pub axis: Vec3,
    pub half_angle_rad: f64,
    pub sin: f64,
    pub cos: f64,
}

/// Rounding of tangents, and what is taken for a smooth joint.
const SLACK_RAD: f64 = 1e-6;

/// A node before its children's, for pieces `first` to `end`.
pub(super) fn nodes(pieces: &[Piece]) -> Vec<Node> {
    let mut out = Vec::with_capacity(2 * pieces.len());
    add(pieces, 0, pieces.len(), &mut out);
    out
}

fn add(pieces: &[Piece], first: usize, end: usize, out: &mut Vec<Node>) -> Node {
    let at = out.len();
    let leaf = |k: usize| {
        let (center, radius) = ball(&pieces[k]);
        let half = match &pieces[k] {
            Piece::Segment(_) => 0.0,
            Piece::Arc(arc) => 0.5 * arc.sweep_rad(),
        };
        let n = pieces.len();
        // Corners at its ends belong to it.
        let beyond = [pieces[(k + n - 1) % n].tangent(1.0), pieces[(k + 1) % n].tangent(0.0)];
        let axis = pieces[k].tangent(0.5);
        let half = beyond.iter().map(|tangent| axis.angle(tangent)).fold(half, f64::max);
        Node::new(first, end, (center, radius), axis, half + SLACK_RAD)
    };
    if end - first == 1 {
        let node = leaf(first);
        out.push(node);
        return node;
    }
    let middle = (first + end) / 2;
    out.push(Node::new(first, end, (Vec3::zeros(), 0.0), Vec3::x(), PI));
    let one = add(pieces, first, middle, out);
    let second = out.len();
    let other = add(pieces, middle, end, out);
    let way = other.center - one.center;
    let (apart, sum) = (way.norm(), one.radius + other.radius);
    let ball = if apart + other.radius <= one.radius {
        (one.center, one.radius)
    } else if apart + one.radius <= other.radius {
        (other.center, other.radius)
    } else {
        let radius = 0.5 * (apart + sum);
        (one.center + way * ((radius - one.radius) / apart), radius)
    };
    let axis = (one.axis + other.axis).try_normalize(1e-9);
    let wide = |axis: &Vec3, node: &Node| axis.angle(&node.axis) + node.half_angle_rad;
    let half = axis.map_or(PI, |axis| wide(&axis, &one).max(wide(&axis, &other)));
    out[at] = Node { second, ..Node::new(first, end, ball, axis.unwrap_or(one.axis), half) };
    out[at]
}

impl Node {
    fn new(first: usize, end: usize, (center, radius): (Vec3, f64), axis: Vec3, half_angle_rad: f64) -> Node {
        let half_angle_rad = half_angle_rad.min(PI);
        let (sin, cos) = half_angle_rad.sin_cos();
        Node { first, end, second: 0, center, radius, axis, half_angle_rad, sin, cos }
    }

    /// Whether it is one piece.
    pub fn is_leaf(&self) -> bool {
        self.end - self.first == 1
    }

    /// Whether one of its tangents may stand across a direction that is within an angle of this sine and cosine of the unit vector `e`.
    pub fn may_be_across(&self, e: &Vec3, sin: f64, cos: f64) -> bool {
        // |90° − φ| ≤ the sum of both angles, which counts only below 90°.
        let cos_of_sum = self.cos * cos - self.sin * sin;
        cos_of_sum <= 0.0 || self.cos <= 0.0 || self.axis.dot(e).abs() <= self.sin * cos + self.cos * sin
    }
}
