//! Stadia, polygons with sharp and rounded corners, and paths of segments and arcs.

use super::core::{MOST_PIECES, PathPart, SMOOTH};
use maille_geometry::{Arc, Circle, Piece, Segment, Vec3};
use nalgebra::{Rotation3, Unit};
use std::f64::consts::PI;

pub(super) fn stadium(straight: f64, radius: f64) -> Vec<Piece> {
    let half = 0.5 * straight;
    if straight == 0.0 {
        return vec![Piece::circle(Circle::new(Vec3::zeros(), Vec3::z_axis(), radius))];
    }
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

/// How much of an edge the fillet of corner `k` takes: ϱ tan(τ/2), τ the turn.
pub(super) fn setback(corners: &[Vec3], k: usize, fillet: f64) -> f64 {
    let n = corners.len();
    let (before, at, after) = (corners[(k + n - 1) % n], corners[k % n], corners[(k + 1) % n]);
    fillet * (0.5 * (at - before).angle(&(after - at))).tan()
}

/// A closed polygon with its corners rounded.
pub(super) fn rounded(corners: &[Vec3], fillet: f64) -> Option<Vec<Piece>> {
    let n = corners.len();
    let along = |k: usize| (corners[(k + 1) % n] - corners[k % n]).normalize();
    let mut out = Vec::new();
    for k in 0..n {
        let (from, to) = (corners[k], corners[(k + 1) % n]);
        let (first, last) = (setback(corners, k, fillet), setback(corners, k + 1, fillet));
        let (start, end) = (from + along(k) * first, to - along(k) * last);
        // Fillets may take all of an edge.
        if (end - start).norm() > SMOOTH * (to - from).norm() {
            out.push(Piece::Segment(Segment::new(start, end)?));
        }
        if last > 0.0 {
            let beyond = to + along(k + 1) * last;
            out.push(Piece::Arc(Arc::from_tangent(end, along(k), beyond)?));
        }
    }
    Some(out)
}

/// Sine of the angle below which the three points of an arc lie on a line.
const STRAIGHT: f64 = 1e-9;

/// The ends of a part of a path, and its point on the way.
fn ends(parts: &[PathPart], k: usize) -> (Vec3, Vec3, Option<Vec3>) {
    let before = &parts[(k + parts.len() - 1) % parts.len()];
    (before.to.into(), parts[k].to.into(), parts[k].through.map(Vec3::from))
}

/// What is wrong with a path.
pub(super) fn problem_of_parts(parts: &[PathPart]) -> Option<(String, String, &'static str)> {
    if parts.len() < 2 || parts.len() > MOST_PIECES {
        return Some((
            "parts".into(),
            format!("{} part{}", parts.len(), if parts.len() == 1 { "" } else { "s" }),
            "a closed path has 2 parts or more, at most 10000; for a circle write a ring",
        ));
    }
    for k in 0..parts.len() {
        let (from, to, through) = ends(parts, k);
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
    let pieces = through_parts(parts)?;
    let back = (0..pieces.len()).find(|&k| {
        let (before, after) = (pieces[k].tangent(1.0), pieces[(k + 1) % pieces.len()].tangent(0.0));
        PI - before.angle(&after) < 1e-3
    })?;
    let problem = format!("the path turns back on itself where part {back} ends");
    Some((format!("parts[{back}].to"), problem, "spread the two parts: a wire cannot lie in itself"))
}

/// The pieces of a path. An arc goes from one end over a point to the other.
pub(super) fn through_parts(parts: &[PathPart]) -> Option<Vec<Piece>> {
    let piece = |k: usize| {
        let (from, to, through) = ends(parts, k);
        let Some(via) = through else { return Segment::new(from, to).map(Piece::Segment) };
        // The tangent at the start makes the angle with the chord that the chords make where they meet, on the other side of the point.
        let (first, second) = (via - from, to - via);
        let axis = Unit::try_new(first.cross(&second), 0.0)?;
        let turn = Rotation3::from_axis_angle(&axis, -first.angle(&second));
        Arc::from_tangent(from, (turn * (to - from)).normalize(), to).map(Piece::Arc)
    };
    (0..parts.len()).map(piece).collect()
}
