//! What is drawn: a torus, or the tube round a piece of another curve.

use super::torus::{self, Ray};
use maille_geometry::{Circle, Piece, Torus, Vec3, biarc};

/// A torus, or the points within the minor radius of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) enum Tube {
    Torus(Torus),
    Piece(Piece, f64),
}

/// Points of a piece that stand for it where its extent is measured.
const POINTS: usize = 24;
/// A ray is followed until it is as near to the surface as this part of the wire.
const NEAR: f64 = 1e-5;
/// Steps of a ray, at most.
const STEPS: usize = 400;

/// How far a drawn piece may be from those that it stands for, in reference radii.
const COARSE: f64 = 3e-4;

/// The pieces of a closed curve that are drawn: where many follow each other smoothly, two arcs for as many as they fit.
pub(super) fn drawn(pieces: &[Piece]) -> Vec<Piece> {
    let mut out = Vec::new();
    let mut first = 0;
    while first < pieces.len() {
        let (mut end, mut found) = (first + 1, vec![pieces[first]]);
        // Twice as many at each try.
        while let Some(next) =
            pieces.get(first..(2 * end - first).min(pieces.len())).filter(|run| run.len() > end - first)
        {
            let Some(pair) = replaced(next) else { break };
            (end, found) = (first + next.len(), pair.to_vec());
        }
        out.extend(found);
        first = end;
    }
    out
}

/// Two arcs in place of a smooth run of pieces, if they are near enough.
fn replaced(run: &[Piece]) -> Option<[Piece; 2]> {
    let (first, last) = (run.first()?, run.last()?);
    let smooth = run.windows(2).all(|pair| pair[0].tangent(1.0).angle(&pair[1].tangent(0.0)) < 1e-6);
    let pair = biarc(first.point(0.0), first.tangent(0.0), last.point(1.0), last.tangent(1.0)).filter(|_| smooth)?;
    let away =
        |p: Vec3| pair.iter().map(|piece| (piece.point(piece.nearest(&p)) - p).norm()).fold(f64::INFINITY, f64::min);
    run.iter().all(|piece| away(piece.point(0.5)).max(away(piece.point(1.0))) < COARSE).then_some(pair)
}

impl Tube {
    pub(super) fn minor_radius(&self) -> f64 {
        match self {
            Tube::Torus(torus) => torus.minor_radius,
            Tube::Piece(_, minor_radius) => *minor_radius,
        }
    }

    /// Centre and radius of a ball that holds it.
    pub(super) fn ball(&self) -> (Vec3, f64) {
        match self {
            Tube::Torus(torus) => (torus.circle.center, torus.circle.radius + torus.minor_radius),
            Tube::Piece(piece, minor_radius) => {
                let center = (piece.point(0.0) + piece.point(0.5) + piece.point(1.0)) / 3.0;
                (center, (piece.point(piece.farthest(&center)) - center).norm() + minor_radius)
            }
        }
    }

    /// Its least and largest coordinate along a unit vector: R sin∠(axis, N) + r to both sides of a torus.
    pub(super) fn extent(&self, axis: &Vec3) -> (f64, f64) {
        match self {
            Tube::Torus(torus) => {
                let Circle { center, normal, radius } = torus.circle;
                let along = normal.dot(axis);
                let half = radius * (1.0 - along * along).max(0.0).sqrt() + torus.minor_radius;
                (center.dot(axis) - half, center.dot(axis) + half)
            }
            Tube::Piece(piece, minor_radius) => {
                let (low, high) = (-piece.support(&-axis), piece.support(axis));
                (low - minor_radius, high + minor_radius)
            }
        }
    }

    /// Point `k` of 24 on its core.
    pub(super) fn outline(&self, k: usize) -> Vec3 {
        match self {
            Tube::Torus(torus) => torus.circle.point(k as f64 * std::f64::consts::TAU / POINTS as f64),
            Tube::Piece(piece, _) => piece.point(k as f64 / (POINTS - 1) as f64),
        }
    }

    /// Distance of a point from the surface, negative inside.
    pub(super) fn distance(&self, p: &Vec3) -> f64 {
        match self {
            Tube::Torus(torus) => torus::distance(torus, p),
            Tube::Piece(piece, minor_radius) => (piece.point(piece.nearest(p)) - p).norm() - minor_radius,
        }
    }

    /// The smallest `t` in `[0, most]` at which a ray that starts outside meets it. To a tube round a piece the ray goes in steps as long as
    /// its distance.
    pub(super) fn first_hit(&self, ray: &Ray, most: f64) -> Option<f64> {
        let minor_radius = match self {
            Tube::Torus(torus) => return torus::first_hit(torus, ray, most),
            Tube::Piece(_, minor_radius) => *minor_radius,
        };
        let (center, radius) = self.ball();
        let from = ray.origin - center;
        let nearest = -from.dot(&ray.direction);
        let half_sq = radius * radius - (from + ray.direction * nearest).norm_squared();
        if half_sq < 0.0 {
            return None;
        }
        let (mut t, end) = ((nearest - half_sq.sqrt()).max(0.0), (nearest + half_sq.sqrt()).min(most));
        for _ in 0..STEPS {
            if t > end {
                return None;
            }
            let distance = self.distance(&ray.at(t));
            if distance < NEAR * minor_radius {
                return Some(t);
            }
            t += distance;
        }
        Some(t)
    }

    /// Outward unit normal and unit tangent along the core at a point of the surface.
    pub(super) fn frame_at(&self, p: &Vec3) -> (Vec3, Vec3) {
        match self {
            Tube::Torus(torus) => torus::frame_at(torus, p),
            Tube::Piece(piece, _) => {
                let t = piece.nearest(p);
                let tangent = piece.tangent(t);
                let normal = (p - piece.point(t)).normalize();
                // At an end the surface is that of a ball.
                (normal, (tangent - normal * normal.dot(&tangent)).try_normalize(1e-9).unwrap_or(tangent))
            }
        }
    }
}
