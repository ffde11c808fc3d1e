//! Stadia, polygons with sharp and rounded corners, and paths of segments and arcs.

use super::core::{MOST_PIECES, PathPart, SMOOTH};
use maille_geometry::{Arc, Circle, Piece, Segment, Vec3};
use nalgebra::{Rotation3, Unit};
use std::f64::consts::PI;

pub(super) fn stadium(straight: f64, radius: f64) -> Vec<Piece> {
    let half = 0.5 * straight;
    let corner = |x: f64, y: f64| Vec3::new(x * half, y * radius, 0.0);
    let side = |from, to| Segment::new(from, to).map(Piece::Segment);
    let cap = |x: f64| {
        let circle = Circle::new(Vec3::x() * (x * half), Vec3::z_axis(), radius);
        let start_rad = circle.angle_rad(&corner(x, -x));
        Arc::new(circle, start_rad, PI).map(Piece::Arc)
    };
    let pieces =
        [side(corner(-1.0, -1.0), corner(1.0, -1.0)), cap(1.0), side(corner(1.0, 1.0), corner(-1.0, 1.0)), cap(-1.0)];
    pieces.into_iter().flatten().collect()
}

/// What is wrong with a form: the name of a number, what is wrong, and what would be right.
pub(super) type Problem = (String, String, &'static str);

/// A polygon, with the radius that rounds its corners.
pub(super) struct Polygon {
    pub corners: Vec<Vec3>,
    pub fillet: f64,
    pub closed: bool,
}

impl Polygon {
    fn edges(&self) -> usize {
        self.corners.len() - usize::from(!self.closed)
    }

    fn edge(&self, k: usize) -> Vec3 {
        let n = self.corners.len();
        self.corners[(k + 1) % n] - self.corners[k % n]
    }

    /// Whether corner `k` lies between two edges.
    fn is_between(&self, k: usize) -> bool {
        self.closed || k > 0 && k + 1 < self.corners.len()
    }

    /// How much of an edge the fillet of corner `k` takes: ϱ tan(τ/2), τ the turn.
    fn setback(&self, k: usize) -> f64 {
        let before = || self.edge(k + self.corners.len() - 1);
        if self.is_between(k) { self.fillet * (0.5 * before().angle(&self.edge(k))).tan() } else { 0.0 }
    }

    /// Its sides and fillets.
    pub fn pieces(&self) -> Option<Vec<Piece>> {
        let n = self.corners.len();
        let mut out = Vec::new();
        for k in 0..self.edges() {
            let (from, to, along) = (self.corners[k], self.corners[(k + 1) % n], self.edge(k).normalize());
            let (first, last) = (self.setback(k), self.setback(k + 1));
            let (start, end) = (from + along * first, to - along * last);
            // Fillets may take all of an edge.
            if (end - start).norm() > SMOOTH * (to - from).norm() {
                out.push(Piece::Segment(Segment::new(start, end)?));
            }
            if last > 0.0 {
                let beyond = to + self.edge(k + 1).normalize() * last;
                out.push(Piece::Arc(Arc::from_tangent(end, along, beyond)?));
            }
        }
        Some(out)
    }

    /// What is wrong with it: edges without length, spikes, and fillets for which an edge is too short.
    pub fn problem(&self) -> Option<Problem> {
        let n = self.corners.len();
        for k in 0..self.edges() {
            if self.edge(k).norm() == 0.0 {
                return Some(are_one(k, n));
            }
            if self.is_between(k + 1) && PI - self.edge(k).angle(&self.edge(k + 1)) < 1e-3 {
                let problem = format!("the polygon turns back on itself at point {}", (k + 1) % n);
                return Some(("points".into(), problem, "spread the two edges: a wire cannot lie in itself"));
            }
        }
        let needs = |k: usize| self.setback(k) + self.setback(k + 1);
        let short = (0..self.edges()).find(|&k| needs(k) > self.edge(k).norm() * (1.0 + 1e-12))?;
        let (needs, length) = (needs(short), self.edge(short).norm());
        let problem = format!("{} takes {needs:.4} of an edge of length {length:.4}", self.fillet);
        Some(("fillet".into(), problem, "take a smaller fillet, or a longer edge"))
    }
}

/// Two points that follow each other, of `n`, and are one.
pub(super) fn are_one(k: usize, n: usize) -> Problem {
    let help = match k + 1 == n {
        true => "leave one of them out; the last is joined to the first",
        false => "leave one of them out",
    };
    ("points".into(), format!("points {k} and {} are one", (k + 1) % n), help)
}

/// Sine of the angle below which the three points of an arc lie on a line.
const STRAIGHT: f64 = 1e-9;

/// The ends of a part of a path, and its point on the way.
fn ends(start: Option<[f64; 3]>, parts: &[PathPart], k: usize) -> (Vec3, Vec3, Option<Vec3>) {
    let before = start.filter(|_| k == 0).unwrap_or_else(|| parts[(k + parts.len() - 1) % parts.len()].to);
    (before.into(), parts[k].to.into(), parts[k].through.map(Vec3::from))
}

/// What is wrong with a path; one with a start is open.
pub(super) fn problem_of_parts(start: Option<[f64; 3]>, parts: &[PathPart]) -> Option<Problem> {
    let (least, help) = match start {
        Some(_) => (1, "a path has 1 part or more, at most 10000"),
        None => (2, "a closed path has 2 parts or more, at most 10000; for a circle write a ring"),
    };
    if parts.len() < least || parts.len() > MOST_PIECES {
        let problem = format!("{} part{}", parts.len(), if parts.len() == 1 { "" } else { "s" });
        return Some(("parts".into(), problem, help));
    }
    if start.is_some_and(|start| start == parts[parts.len() - 1].to) {
        return Some(("from".into(), "the path ends where it starts".into(), "leave it out: the path is closed then"));
    }
    for k in 0..parts.len() {
        let (from, to, through) = ends(start, parts, k);
        if from == to {
            let problem = format!("the part ends where it begins, at {:?}", parts[k].to);
            return Some((format!("parts[{k}].to"), problem, "leave it out, or let it end elsewhere"));
        }
        let on_line =
            |via: Vec3| (via - from).cross(&(to - via)).norm() < STRAIGHT * (via - from).norm() * (to - via).norm();
        if through.is_some_and(|via| via == from || via == to || on_line(via)) {
            let problem = "the point lies on the line between the ends of the part: no arc goes through them";
            return Some((
                format!("parts[{k}].through"),
                problem.into(),
                "leave it out of a straight part, or move it aside",
            ));
        }
    }
    let pieces = through_parts(start, parts)?;
    let back = (0..pieces.len() - usize::from(start.is_some())).find(|&k| {
        let (before, after) = (pieces[k].tangent(1.0), pieces[(k + 1) % pieces.len()].tangent(0.0));
        PI - before.angle(&after) < 1e-3
    })?;
    let problem = format!("the path turns back on itself where part {back} ends");
    Some((format!("parts[{back}].to"), problem, "spread the two parts: a wire cannot lie in itself"))
}

/// The pieces of a path. An arc goes from one end over a point to the other.
pub(super) fn through_parts(start: Option<[f64; 3]>, parts: &[PathPart]) -> Option<Vec<Piece>> {
    let piece = |k: usize| {
        let (from, to, through) = ends(start, parts, k);
        let Some(via) = through else { return Segment::new(from, to).map(Piece::Segment) };
        // The tangent at the start makes the angle with the chord that the chords make where they meet, on the other side of the point.
        let (first, second) = (via - from, to - via);
        let axis = Unit::try_new(first.cross(&second), 0.0)?;
        let turn = Rotation3::from_axis_angle(&axis, -first.angle(&second));
        Arc::from_tangent(from, (turn * (to - from)).normalize(), to).map(Piece::Arc)
    };
    (0..parts.len()).map(piece).collect()
}
