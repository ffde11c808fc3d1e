//! Core curves that are no circles: closed curves of segments and arcs, from the forms of a design. An open curve goes there and back.

use crate::{ball::farthest, record::Form};
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};

type Vec3 = Vector3<f64>;

/// A segment (no curvature) or an arc: the point at arc length s is p + s t, or c + ϱ (u cos s/ϱ + v sin s/ϱ).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Start of a segment, or centre of an arc.
    at: Vec3,
    /// Direction of a segment; from the centre to the start of an arc.
    u: Vec3,
    /// Tangent at the start of an arc.
    v: Vec3,
    /// Radius of an arc.
    radius: Option<f64>,
    pub length: f64,
}

/// Tangents that differ by a smaller sine are one.
const SMOOTH: f64 = 1e-7;
/// Arcs whose circles differ by less are of one.
const ONE_CIRCLE: f64 = 1e-12;
/// Pieces of a curve at most.
const MOST_PIECES: usize = 10_000;

impl Piece {
    fn segment(from: Vec3, to: Vec3) -> Piece {
        let length = (to - from).norm();
        Piece { at: from, u: (to - from) / length, v: Vec3::zeros(), radius: None, length }
    }

    /// The arc from `from`, which it leaves along the unit vector `tangent`, to `to`; straight where that lies ahead.
    fn arc(from: Vec3, tangent: Vec3, to: Vec3) -> Option<Piece> {
        let chord = to - from;
        let ahead = chord.dot(&tangent);
        let aside = chord - tangent * ahead;
        if aside.norm() == 0.0 {
            return (ahead > 0.0).then(|| Piece::segment(from, to));
        }
        // The centre lies aside, as far from both ends.
        let inward = aside.normalize();
        let radius = chord.norm_squared() / (2.0 * chord.dot(&inward));
        let half_rad = chord.dot(&inward).atan2(ahead);
        let piece = Piece {
            at: from + inward * radius,
            u: -inward,
            v: tangent,
            radius: Some(radius),
            length: 2.0 * half_rad * radius,
        };
        (radius.is_finite() && half_rad > 0.0).then_some(piece)
    }

    pub fn position(&self, s: f64) -> Vec3 {
        match self.radius {
            None => self.at + self.u * s,
            Some(radius) => {
                let (sin, cos) = (s / radius).sin_cos();
                self.at + (self.u * cos + self.v * sin) * radius
            }
        }
    }

    pub fn tangent(&self, s: f64) -> Vec3 {
        match self.radius {
            None => self.u,
            Some(radius) => {
                let (sin, cos) = (s / radius).sin_cos();
                self.v * cos - self.u * sin
            }
        }
    }

    /// Derivative of the tangent by arc length.
    pub fn bend(&self, s: f64) -> Vec3 {
        match self.radius {
            None => Vec3::zeros(),
            Some(radius) => {
                let (sin, cos) = (s / radius).sin_cos();
                (self.u * cos + self.v * sin) / -radius
            }
        }
    }

    /// Its length.
    pub fn curvature(&self) -> f64 {
        self.radius.map_or(0.0, |radius| 1.0 / radius)
    }

    /// The arc length of its point that is nearest to `p`.
    pub fn nearest(&self, p: &Vec3) -> f64 {
        let x = p - self.at;
        match self.radius {
            None => x.dot(&self.u).clamp(0.0, self.length),
            Some(radius) => {
                // The angle nearest to the middle of the arc.
                let middle = 0.5 * self.length / radius;
                let angle = x.dot(&self.v).atan2(x.dot(&self.u));
                let angle = middle + (angle - middle + PI).rem_euclid(TAU) - PI;
                (radius * angle).clamp(0.0, self.length)
            }
        }
    }

    /// Its point that is farthest from `p`.
    pub fn farthest(&self, p: &Vec3) -> Vec3 {
        // An end, or of an arc the point across the centre, if that lies on it.
        let across = self.radius.map_or(0.0, |_| self.nearest(&(self.at * 2.0 - p)));
        farthest([0.0, across, self.length].into_iter().map(|s| self.position(s)), p)
    }

    /// Largest distance of its points from `p`.
    fn reach(&self, p: &Vec3) -> f64 {
        (self.farthest(p) - p).norm()
    }

    /// From its end to its start.
    fn back(&self) -> Piece {
        let (at, tangent) = (self.position(self.length), self.tangent(self.length));
        match self.radius {
            None => Piece { at, u: -self.u, ..*self },
            Some(radius) => Piece { u: (at - self.at) / radius, v: -tangent, ..*self },
        }
    }

    fn moved(&self, turn: &UnitQuaternion<f64>, by: &Vec3) -> Piece {
        Piece { at: turn * self.at + by, u: turn * self.u, v: turn * self.v, ..*self }
    }

    /// Centre and radius of a ball that holds it.
    pub fn ball(&self) -> (Vec3, f64) {
        let center = (self.position(0.0) + self.position(self.length)) * 0.5;
        (center, self.reach(&center) * (1.0 + 1e-12))
    }
}

/// A closed curve.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub pieces: Vec<Piece>,
}

/// A point of a curve, on a piece; a corner is no part of its neighbours' inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub piece: usize,
    pub s: f64,
    pub corner: bool,
}

impl Curve {
    /// The closed curves of a form in its own frame: one, that of an open curve there and back, or those of a frame's cycles.
    pub fn all_of(form: &Form, unit: f64, tolerance: f64) -> Result<Vec<Curve>, String> {
        let Form::Frame { vertices, edges } = form else {
            let mut curve = Curve::of(form, unit, tolerance)?;
            if is_open(form) {
                let back: Vec<Piece> = curve.pieces.iter().rev().map(Piece::back).collect();
                curve.pieces.extend(back);
            }
            return Ok(vec![curve]);
        };
        let at = |v: usize| vertices.get(v).map(|p| Vec3::from(*p) / unit).ok_or("a strut to no vertex".to_owned());
        let of = |walk: Vec<usize>| {
            let corners: Vec<Vec3> = walk.into_iter().map(at).collect::<Result<_, String>>()?;
            let n = corners.len();
            let pieces = (0..n).map(|k| Piece::segment(corners[k], corners[(k + 1) % n])).collect();
            Ok(Curve { pieces })
        };
        walks(vertices.len(), edges)?.into_iter().map(of).collect()
    }

    /// The form in its own frame, in units of `unit`; `tolerance` is that of biarcs, in the same units.
    pub fn of(form: &Form, unit: f64, tolerance: f64) -> Result<Curve, String> {
        let flat = |x: f64, y: f64| Vec3::new(x, y, 0.0) / unit;
        let corners: Vec<Vec3>;
        let rounding;
        match form {
            Form::Stadium { straight, radius } => {
                let (h, r) = (0.5 * straight, *radius);
                let half = |side: f64| half_circle(flat(side * h, 0.0), r / unit, side);
                let pieces = match *straight == 0.0 {
                    true => vec![half(1.0), half(-1.0)],
                    false => vec![
                        Piece::segment(flat(-h, -r), flat(h, -r)),
                        half(1.0),
                        Piece::segment(flat(h, r), flat(-h, r)),
                        half(-1.0),
                    ],
                };
                return Ok(Curve { pieces });
            }
            Form::Square { side, fillet } => {
                let h = 0.5 * side;
                corners = [(h, -h), (h, h), (-h, h), (-h, -h)].map(|(x, y)| flat(x, y)).to_vec();
                rounding = fillet / unit;
            }
            Form::Hexagon { side, fillet } => {
                let corner = |k: usize| {
                    let (sin, cos) = (PI / 3.0 * k as f64).sin_cos();
                    flat(side * cos, side * sin)
                };
                corners = (0..6).map(corner).collect();
                rounding = fillet / unit;
            }
            Form::Polyline { points, fillet, .. } => {
                corners = points.iter().map(|p| Vec3::from(*p) / unit).collect();
                rounding = fillet / unit;
            }
            Form::Path { from: start, parts } => {
                let at = |k: usize| Vec3::from(parts[k % parts.len()].to) / unit;
                let pieces = (0..parts.len()).map(|k| {
                    let before = start.filter(|_| k == 0).map(|p| Vec3::from(p) / unit);
                    let (from, to) = (before.unwrap_or_else(|| at(k + parts.len() - 1)), at(k));
                    let Some(via) = parts[k].through else { return Some(Piece::segment(from, to)) };
                    // The centre of the circle through three points, from the first.
                    let (a, b) = (Vec3::from(via) / unit - from, to - from);
                    let n = a.cross(&b);
                    let center = (b * a.norm_squared() - a * b.norm_squared()).cross(&n) / (2.0 * n.norm_squared());
                    Piece::arc(from, n.cross(&-center).normalize(), to)
                });
                return Curve::whole(pieces.collect());
            }
            Form::Spline { points, closed } => {
                let n = points.len();
                let at = |k: usize| Vec3::from(points[k % n]) / unit;
                let span = |k: usize| (at(k + 1) - at(k)).norm();
                // The slope, at point k and from there on a way x, of the parabola through it and its neighbours.
                let parabola = |k: usize, x: f64| {
                    let (h, g) = (span(k + n - 1), span(k));
                    let rise = (at(k + 1) - at(k)) / g - (at(k) - at(k + n - 1)) / h;
                    (at(k + 1) - at(k)) / g + rise * ((2.0 * x - g) / (g + h))
                };
                let slope = |k: usize| match k {
                    0 if !closed => parabola(1, -span(0)),
                    _ if !closed && k == n - 1 => parabola(n - 2, span(n - 2)),
                    _ => parabola(k, 0.0),
                };
                let spans = n - usize::from(!closed);
                return Curve::biarcs(spans, tolerance, |x| {
                    let x = if *closed { x % spans as f64 } else { x };
                    let k = (x.floor() as usize).min(spans - 1);
                    let (h, u) = (span(k), x - k as f64);
                    // The four cubics of Hermite.
                    let (p, q, v, w) = (at(k), at(k + 1), slope(k) * h, slope((k + 1) % n) * h);
                    let (u2, u3) = (u * u, u * u * u);
                    let point = p * (2.0 * u3 - 3.0 * u2 + 1.0)
                        + v * (u3 - 2.0 * u2 + u)
                        + q * (3.0 * u2 - 2.0 * u3)
                        + w * (u3 - u2);
                    let along = (q - p) * (6.0 * (u - u2)) + v * (3.0 * u2 - 4.0 * u + 1.0) + w * (3.0 * u2 - 2.0 * u);
                    [point, along]
                });
            }
            Form::Frame { .. } => return Err("a frame is no single curve".into()),
            Form::Ellipse { a, b } => {
                let (a, b) = (a / unit, b / unit);
                return Curve::smooth(4, tolerance, |t| {
                    let (sin, cos) = t.sin_cos();
                    [Vec3::new(a * cos, b * sin, 0.0), Vec3::new(-a * sin, b * cos, 0.0)]
                });
            }
            Form::TorusKnot { p, q, circle_radius, a } => {
                let (big, small) = (circle_radius / unit, a / unit);
                return Curve::smooth(8 * p.max(*q) as usize, tolerance, |t| {
                    let ((sp, cp), (sq, cq)) = ((p * t).sin_cos(), (q * t).sin_cos());
                    let (rho, slope) = (big + small * cq, -small * q * sq);
                    let at = Vec3::new(rho * cp, rho * sp, -small * sq);
                    let along = Vec3::new(slope * cp - rho * p * sp, slope * sp + rho * p * cp, -small * q * cq);
                    [at, along]
                });
            }
        }
        Curve::rounded(&corners, rounding, !is_open(form))
    }

    fn whole(pieces: Vec<Option<Piece>>) -> Result<Curve, String> {
        let pieces: Option<Vec<Piece>> = pieces.into_iter().collect();
        pieces.map(|pieces| Curve { pieces }).ok_or_else(|| "a curve's form makes no curve".into())
    }

    fn rounded(corners: &[Vec3], radius: f64, closed: bool) -> Result<Curve, String> {
        let n = corners.len();
        let at = |k: usize| corners[k % n];
        let way = |k: usize| (at(k + 1) - at(k)).normalize();
        // What the arc at a corner takes of both edges: ϱ tan τ/2. There is none at an end.
        let taken = |k: usize| match closed || k > 0 && k < n - 1 {
            true => radius * (0.5 * way(k + n - 1).angle(&way(k))).tan(),
            false => 0.0,
        };
        let mut pieces = Vec::new();
        for k in 0..n - usize::from(!closed) {
            let (from, to) = (at(k) + way(k) * taken(k), at(k + 1) - way(k) * taken(k + 1));
            if (to - from).norm() > SMOOTH * (at(k + 1) - at(k)).norm() {
                pieces.push(Some(Piece::segment(from, to)));
            }
            if taken(k + 1) > 0.0 {
                pieces.push(Piece::arc(to, way(k), at(k + 1) + way(k + 1) * taken(k + 1)));
            }
        }
        Curve::whole(pieces)
    }

    /// A closed curve, given by point and derivative at 0 ≤ t ≤ 2π, as [`Self::biarcs`] of equal spans.
    fn smooth(spans: usize, tolerance: f64, at: impl Fn(f64) -> [Vec3; 2]) -> Result<Curve, String> {
        Curve::biarcs(spans, tolerance, |x| at(TAU * (x % spans as f64) / spans as f64))
    }

    /// Biarcs of spans, of which each is halved until seven points of it are within the tolerance. `point` counts spans.
    fn biarcs(spans: usize, tolerance: f64, point: impl Fn(f64) -> [Vec3; 2]) -> Result<Curve, String> {
        let mut pieces = Vec::new();
        for k in 0..spans {
            let (mut from, mut width) = (k as f64, 1.0);
            while from < k as f64 + 1.0 {
                let ([p, leaves], [q, arrives]) = (point(from), point(from + width));
                let Some(pair) = two_arcs(p, leaves.normalize(), q, arrives.normalize()) else {
                    return Err("a span of a smooth curve has no two arcs".into());
                };
                let worst = (1..8).map(|part| {
                    let p = point(from + width * f64::from(part) / 8.0)[0];
                    let away = pair.iter().map(|piece| (piece.position(piece.nearest(&p)) - p).norm());
                    away.fold(f64::INFINITY, f64::min)
                });
                if worst.fold(0.0, f64::max) > tolerance {
                    width *= 0.5;
                    continue;
                }
                pieces.extend(pair);
                if pieces.len() > MOST_PIECES {
                    return Err("a smooth curve needs too many arcs".into());
                }
                from += width;
                // As wide as the span that begins here may be: what is left of the one that was halved.
                while width < 1.0 && ((from - k as f64) / width) % 2.0 == 0.0 {
                    width *= 2.0;
                }
            }
        }
        Ok(Curve { pieces })
    }

    /// A circle: two halves. The vectors u and v are of length 1, in its plane and across each other.
    pub fn ring(center: Vec3, (u, v): (Vec3, Vec3), radius: f64) -> Curve {
        let half =
            |sign: f64| Piece { at: center, u: u * sign, v: v * sign, radius: Some(radius), length: PI * radius };
        Curve { pieces: vec![half(1.0), half(-1.0)] }
    }

    pub fn moved(&self, turn: &UnitQuaternion<f64>, by: &Vec3) -> Curve {
        Curve { pieces: self.pieces.iter().map(|piece| piece.moved(turn, by)).collect() }
    }

    /// Largest distance of its points from `p`.
    pub fn reach(&self, p: &Vec3) -> f64 {
        self.pieces.iter().map(|piece| piece.reach(p)).fold(0.0, f64::max)
    }

    /// Centre, normal and radius of the circle of which all pieces are arcs.
    pub fn circle(&self) -> Option<(Vec3, Vec3, f64)> {
        let of = |piece: &Piece| piece.radius.map(|radius| (piece.at, piece.u.cross(&piece.v), radius));
        let first = of(self.pieces.first()?)?;
        let same = |piece: &Piece| {
            of(piece).is_some_and(|(at, normal, radius)| {
                (at - first.0).norm() < ONE_CIRCLE
                    && (normal - first.1).norm() < ONE_CIRCLE
                    && (radius - first.2).abs() < ONE_CIRCLE
            })
        };
        self.pieces.iter().all(same).then_some(first)
    }

    /// Whether pieces `k` − 1 and `k` meet in a corner.
    fn is_corner(&self, k: usize) -> bool {
        let n = self.pieces.len();
        let before = &self.pieces[(k + n - 1) % n];
        let (arrives, leaves) = (before.tangent(before.length), self.pieces[k % n].tangent(0.0));
        arrives.cross(&leaves).norm() > SMOOTH || arrives.dot(&leaves) < 0.0
    }

    /// The nearest point to `p`. At a joint without a corner it is on the piece that has it inside, or the first.
    pub fn nearest(&self, p: &Vec3) -> Place {
        let away = |k: usize| {
            let s = self.pieces[k].nearest(p);
            (k, s, (self.pieces[k].position(s) - p).norm())
        };
        let all: Vec<(usize, f64, f64)> = (0..self.pieces.len()).map(away).collect();
        let least = all.iter().map(|x| x.2).fold(f64::INFINITY, f64::min);
        let inside = |x: &&(usize, f64, f64)| x.1 > 0.0 && x.1 < self.pieces[x.0].length;
        let near = || all.iter().filter(|x| x.2 <= least + 1e-13);
        let (piece, s, _) = near().find(inside).or_else(|| near().next()).copied().unwrap_or_default();
        let length = self.pieces[piece].length;
        let corner = s <= CORNER && self.is_corner(piece) || s >= length - CORNER && self.is_corner(piece + 1);
        Place { piece, s, corner }
    }
}

impl Curve {
    /// The same place on the piece that meets its own there without a corner.
    pub fn across_joint(&self, place: Place) -> Option<Place> {
        let n = self.pieces.len();
        let (start, end) = (place.s <= JOINT, place.s >= self.pieces[place.piece].length - JOINT);
        if place.corner || !(start || end) {
            return None;
        }
        let piece = if end { (place.piece + 1) % n } else { (place.piece + n - 1) % n };
        Some(Place { piece, s: if end { 0.0 } else { self.pieces[piece].length }, corner: false })
    }
}

/// A point this near to where two pieces meet is on both: rounding.
const JOINT: f64 = 1e-13;
/// A point this near to a corner is at it, in reference radii.
const CORNER: f64 = 1e-9;

/// Whether a form is a curve with two ends.
fn is_open(form: &Form) -> bool {
    match form {
        Form::Polyline { closed, .. } | Form::Spline { closed, .. } => !closed,
        Form::Path { from, .. } => from.is_some(),
        _ => false,
    }
}

/// The closed walks of a frame, as `docs/theory/curves.md` has them: those of each strut beside the tree, back through it; then each strut that
/// is on none, there and back.
fn walks(vertices: usize, edges: &[[usize; 2]]) -> Result<Vec<Vec<usize>>, String> {
    // Steps from vertex 0, and the vertex before; vertices in the order in which they are reached.
    let mut before: Vec<Option<(usize, usize)>> = vec![None; vertices];
    let mut reached = vec![0];
    *before.first_mut().ok_or("a frame without vertices")? = Some((0, 0));
    let mut next = 0;
    let mut beside = vec![true; edges.len()];
    while let Some(&v) = reached.get(next) {
        next += 1;
        for (k, edge) in edges.iter().enumerate().filter(|(_, edge)| edge.contains(&v)) {
            let w = edge[0] + edge[1] - v;
            if before.get(w).ok_or("a strut to no vertex")?.is_none() {
                before[w] = before[v].map(|(steps, _)| (steps + 1, v));
                beside[k] = false;
                reached.push(w);
            }
        }
    }
    let before: Vec<(usize, usize)> =
        before.into_iter().collect::<Option<_>>().ok_or("a frame that falls into parts")?;
    let mut on_cycle = vec![false; edges.len()];
    let mut out = Vec::new();
    for (_, &[a, b]) in edges.iter().enumerate().filter(|(k, _)| beside[*k]) {
        // From b up, and up to a, until both meet.
        let (mut up, mut down) = (vec![b], vec![a]);
        loop {
            let (x, y) = (up[up.len() - 1], down[down.len() - 1]);
            if x == y {
                break;
            }
            match before[x].0 >= before[y].0 {
                true => up.push(before[x].1),
                false => down.push(before[y].1),
            }
        }
        down.pop();
        up.extend(down.into_iter().rev());
        for (k, edge) in edges.iter().enumerate() {
            let n = up.len();
            on_cycle[k] |=
                (0..n).any(|i| edge.contains(&up[i]) && edge.contains(&up[(i + 1) % n]) && up[i] != up[(i + 1) % n]);
        }
        out.push(up);
    }
    out.extend(edges.iter().zip(&on_cycle).filter(|(_, on)| !**on).map(|(edge, _)| edge.to_vec()));
    Ok(out)
}

/// The half circle about `center`, to the side of +x or −x, counter-clockwise about z.
fn half_circle(center: Vec3, radius: f64, side: f64) -> Piece {
    Piece { at: center, u: Vec3::y() * -side, v: Vec3::x() * side, radius: Some(radius), length: PI * radius }
}

/// Two arcs from one point to another with these unit tangents, and one tangent where they meet: the middle of the middle leg of the polygon from,
/// from + d t₀, to − d t₁, to, in which that leg is 2d long.
fn two_arcs(from: Vec3, t0: Vec3, to: Vec3, t1: Vec3) -> Option<[Piece; 2]> {
    let v = to - from;
    // |v − d (t₀ + t₁)| = 2d.
    let (square, linear, constant) = (2.0 * (1.0 - t0.dot(&t1)), v.dot(&(t0 + t1)), v.norm_squared());
    let square = if square < 1e-3 { (t0 - t1).norm_squared() } else { square };
    let root = (linear * linear + square * constant).sqrt();
    let d = if linear >= 0.0 { constant / (linear + root) } else { (root - linear) / square };
    let (one, other) = (from + t0 * d, to - t1 * d);
    let (joint, along) = ((one + other) * 0.5, (other - one).try_normalize(0.0)?);
    Some([Piece::arc(from, t0, joint)?, Piece::arc(joint, along, to)?])
}
