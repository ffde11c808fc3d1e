//! Forms of core curves other than circles, and the segments and arcs that they are made of.

use maille_geometry::{Arc, Circle, Piece, Segment, Vec3, biarc, piece_distance_minima};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// The form of a closed core curve in its own frame: about the origin, plane forms in z = 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// Two straight sides along x and two half circles: a link of a chain.
    Stadium {
        /// Length of a straight side.
        straight: f64,
        /// Radius of the half circles.
        radius: f64,
    },
    /// A square with sides along x and y.
    Square {
        /// Length of a side, from corner to corner.
        side: f64,
        /// Radius that rounds the corners; 0 leaves them sharp.
        #[serde(default)]
        fillet: f64,
    },
    /// A regular hexagon with two corners on the x axis.
    Hexagon {
        /// Length of a side, from corner to corner.
        side: f64,
        /// Radius that rounds the corners; 0 leaves them sharp.
        #[serde(default)]
        fillet: f64,
    },
    /// A closed polygon in space.
    Polyline {
        /// Its corners.
        points: Vec<[f64; 3]>,
        /// Radius that rounds the corners; 0 leaves them sharp.
        #[serde(default)]
        fillet: f64,
    },
    /// An ellipse.
    Ellipse {
        /// Half of its width along x.
        a: f64,
        /// Half of its width along y.
        b: f64,
    },
    /// The curve ((R + a cos qt) cos pt, (R + a cos qt) sin pt, −a sin qt), 0 ≤ t ≤ 2π: p times round the z axis, and q times
    /// round the circle of radius R.
    TorusKnot {
        /// Turns about the axis.
        p: f64,
        /// Turns about the circle.
        q: f64,
        /// Radius of the circle.
        #[serde(rename = "R")]
        circle_radius: f64,
        /// Distance from the circle.
        a: f64,
    },
}

/// Most pieces of one curve.
pub(crate) const MOST_PIECES: usize = 10_000;
/// Sine of the angle below which two tangents are one.
pub(crate) const SMOOTH: f64 = 1e-7;

impl Shape {
    /// Its key in a design file.
    pub fn name(&self) -> &'static str {
        match self {
            Shape::Stadium { .. } => "stadium",
            Shape::Square { .. } => "square",
            Shape::Hexagon { .. } => "hexagon",
            Shape::Polyline { .. } => "polyline",
            Shape::Ellipse { .. } => "ellipse",
            Shape::TorusKnot { .. } => "torus_knot",
        }
    }

    /// Its numbers with their names in a design file, but for the points of a polyline.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let mut copy = self.clone();
        copy.numbers_mut().into_iter().map(|(name, number)| (name, *number)).collect()
    }

    fn numbers_mut(&mut self) -> Vec<(&'static str, &mut f64)> {
        match self {
            Shape::Stadium { straight, radius } => vec![("straight", straight), ("radius", radius)],
            Shape::Square { side, fillet } | Shape::Hexagon { side, fillet } => {
                vec![("side", side), ("fillet", fillet)]
            }
            Shape::Polyline { fillet, .. } => vec![("fillet", fillet)],
            Shape::Ellipse { a, b } => vec![("a", a), ("b", b)],
            Shape::TorusKnot { p, q, circle_radius, a } => {
                vec![("p", p), ("q", q), ("R", circle_radius), ("a", a)]
            }
        }
    }

    /// The number of this name: `straight`, or `points[2][0]`.
    pub(super) fn number_mut(&mut self, name: &str) -> Option<&mut f64> {
        match (name.strip_prefix("points["), self) {
            (Some(place), Shape::Polyline { points, .. }) => {
                let (point, axis) = place.strip_suffix(']')?.split_once("][")?;
                points.get_mut(point.parse::<usize>().ok()?)?.get_mut(axis.parse::<usize>().ok()?)
            }
            (_, shape) => shape.named_mut(name),
        }
    }

    fn named_mut(&mut self, name: &str) -> Option<&mut f64> {
        self.numbers_mut().into_iter().find(|(known, _)| *known == name).map(|(_, number)| number)
    }

    /// The same form with every length multiplied by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        if let Shape::Polyline { points, .. } = self {
            points.iter_mut().flatten().for_each(|x| *x *= factor);
        }
        let lengths = self.numbers_mut().into_iter().filter(|(name, _)| !["p", "q"].contains(name));
        lengths.for_each(|(_, number)| *number *= factor);
    }

    /// As [`Self::scale`].
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let mut out = self.clone();
        out.scale(factor);
        out
    }

    /// What is wrong with its numbers: the name of one, what is wrong, and what would be right.
    pub(super) fn problem(&self) -> Option<(String, String, &'static str)> {
        for (name, x) in self.numbers() {
            let (least, what) = match (name, self) {
                ("straight" | "fillet", _) | ("a", Shape::TorusKnot { .. }) => (0.0, "a length of 0 or more"),
                _ => (f64::MIN_POSITIVE, "a positive number"),
            };
            if !(x.is_finite() && x >= least) {
                return Some((name.into(), format!("{x} is not {what}"), "give a length in the file's unit"));
            }
        }
        let whole = |x: f64| x.fract() == 0.0 && x <= 1000.0;
        match self {
            Shape::TorusKnot { p, q, .. } if !(whole(*p) && whole(*q)) => {
                let problem = format!("p = {p}, q = {q} are not whole numbers of turns, at most 1000");
                Some(("p".into(), problem, "write p = 1, q = 4"))
            }
            Shape::TorusKnot { p, q, .. } if greatest_divisor(*p as u32, *q as u32) > 1 => {
                let problem = format!("p = {p} and q = {q} have a common divisor: the curve runs through itself");
                Some(("p".into(), problem, "take numbers without one, as p = 2, q = 3"))
            }
            Shape::TorusKnot { p, a, .. } if *a == 0.0 && *p > 1.0 => {
                let problem = format!("a = 0 with p = {p} runs {p} times through the same circle");
                Some(("a".into(), problem, "take a positive a, or p = 1"))
            }
            Shape::TorusKnot { circle_radius, a, .. } if a >= circle_radius => {
                let problem = format!("a = {a} is not smaller than R = {circle_radius}: the curve meets the axis");
                Some(("a".into(), problem, "take a < R"))
            }
            Shape::Polyline { points, .. } if points.len() < 3 || points.len() > MOST_PIECES / 2 => {
                let problem = format!("{} points", points.len());
                Some(("points".into(), problem, "a closed polygon has 3 corners or more, at most 5000"))
            }
            Shape::Polyline { points, .. } if points.iter().flatten().any(|x| !x.is_finite()) => {
                Some(("points".into(), "are not all finite".into(), "give three finite numbers for each corner"))
            }
            Shape::Polyline { .. } | Shape::Square { .. } | Shape::Hexagon { .. } => self.problem_of_corners(),
            _ => None,
        }
    }

    /// What is wrong with a polygon: edges without length, spikes, and fillets for which an edge is too short.
    fn problem_of_corners(&self) -> Option<(String, String, &'static str)> {
        let (corners, fillet) = self.polygon()?;
        let n = corners.len();
        let edge = |k: usize| corners[(k + 1) % n] - corners[k % n];
        for k in 0..n {
            if edge(k).norm() == 0.0 {
                let problem = format!("points {k} and {} are one", (k + 1) % n);
                return Some(("points".into(), problem, "leave one of them out; the last is joined to the first"));
            }
            let turn_rad = edge(k).angle(&edge(k + 1));
            if PI - turn_rad < 1e-3 {
                let problem = format!("the polygon turns back on itself at point {}", (k + 1) % n);
                return Some(("points".into(), problem, "spread the two edges: a wire cannot lie in itself"));
            }
        }
        let short = (0..n).find(|&k| {
            setback(&corners, k, fillet) + setback(&corners, k + 1, fillet) > edge(k).norm() * (1.0 + 1e-12)
        })?;
        let needs = setback(&corners, short, fillet) + setback(&corners, short + 1, fillet);
        let problem = format!("{fillet} takes {needs:.4} of an edge of length {:.4}", edge(short).norm());
        Some(("fillet".into(), problem, "take a smaller fillet, or a longer edge"))
    }

    /// Corners and fillet of a form with corners.
    fn polygon(&self) -> Option<(Vec<Vec3>, f64)> {
        match self {
            Shape::Square { side, fillet } => {
                let h = 0.5 * side;
                let corners = [[h, -h], [h, h], [-h, h], [-h, -h]];
                Some((corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(), *fillet))
            }
            Shape::Hexagon { side, fillet } => {
                let corner = |k: usize| {
                    let (sin, cos) = (PI / 3.0 * k as f64).sin_cos();
                    Vec3::new(cos, sin, 0.0) * *side
                };
                Some(((0..6).map(corner).collect(), *fillet))
            }
            Shape::Polyline { points, fillet } => Some((points.iter().map(|p| Vec3::from(*p)).collect(), *fillet)),
            _ => None,
        }
    }

    /// Its segments and arcs, in order. Smooth forms become biarcs, spans halved until no sampled point is farther than
    /// `tolerance` from them. None where the numbers make no curve.
    pub fn pieces(&self, tolerance: f64) -> Option<Vec<Piece>> {
        self.approximation(tolerance).map(|(pieces, _)| pieces)
    }

    /// The same, and how far the form is from its pieces at most, at sampled points.
    pub fn approximation(&self, tolerance: f64) -> Option<(Vec<Piece>, f64)> {
        let exact = |pieces: Vec<Piece>| Some((pieces, 0.0));
        match self {
            Shape::Stadium { straight, radius } => exact(stadium(*straight, *radius)),
            Shape::Ellipse { a, b } if a == b => {
                exact(vec![Piece::circle(Circle::new(Vec3::zeros(), Vec3::z_axis(), *a))])
            }
            Shape::Ellipse { a, b } => smooth(4, tolerance, |t| {
                let (sin, cos) = t.sin_cos();
                [Vec3::new(a * cos, b * sin, 0.0), Vec3::new(-a * sin, b * cos, 0.0)]
            }),
            Shape::TorusKnot { p, q, circle_radius, a } => {
                let at = |t: f64| {
                    let ((sin_p, cos_p), (sin_q, cos_q)) = ((p * t).sin_cos(), (q * t).sin_cos());
                    let out = circle_radius + a * cos_q;
                    let grows = -a * q * sin_q;
                    [
                        Vec3::new(out * cos_p, out * sin_p, -a * sin_q),
                        Vec3::new(grows * cos_p - out * p * sin_p, grows * sin_p + out * p * cos_p, -a * q * cos_q),
                    ]
                };
                smooth(8 * (p.max(*q) as usize), tolerance, at)
            }
            _ => {
                let (corners, fillet) = self.polygon()?;
                rounded(&corners, fillet).and_then(exact)
            }
        }
    }
}

impl Shape {
    /// No point of it is farther than this from the origin.
    pub fn reach(&self) -> f64 {
        match self {
            Shape::Stadium { straight, radius } => 0.5 * straight + radius,
            Shape::Ellipse { a, b } => a.max(*b),
            Shape::TorusKnot { circle_radius, a, .. } => circle_radius + a,
            Shape::Square { side, .. } => side * 0.5_f64.sqrt(),
            Shape::Hexagon { side, .. } => *side,
            Shape::Polyline { points, .. } => points.iter().map(|p| Vec3::from(*p).norm()).fold(0.0, f64::max),
        }
    }
}

/// A ball around a piece.
pub(crate) fn ball(piece: &Piece) -> (Vec3, f64) {
    let middle = (piece.point(0.0) + piece.point(1.0)) * 0.5;
    let at = match piece {
        Piece::Arc(arc) if arc.sweep_rad() > std::f64::consts::PI => arc.circle().center,
        _ => middle,
    };
    (at, (piece.point(piece.farthest(&at)) - at).norm())
}

/// Least radius of the arcs among `pieces`; none where all are straight.
pub(super) fn tightest(pieces: &[Piece]) -> Option<f64> {
    let radii = pieces.iter().filter_map(|piece| match piece {
        Piece::Segment(_) => None,
        Piece::Arc(arc) => Some(arc.circle().radius),
    });
    radii.min_by(f64::total_cmp)
}

/// How near the core comes to itself where the tube of radius `r` runs into itself; none where it does not.
///
/// Points count that are a local minimum of their distance, or, at corners, pieces that are no neighbours. Those that are nearer along the curve than
/// half of the circle with the wire's radius, π r, are parts of one bend.
pub(super) fn self_overlap(pieces: &[Piece], r: f64) -> Option<f64> {
    let n = pieces.len();
    let mut at = vec![0.0];
    pieces.iter().for_each(|piece| at.push(at[at.len() - 1] + piece.length()));
    let total = at[n];
    let balls: Vec<(Vec3, f64)> = pieces.iter().map(ball).collect();
    let mut least: Option<f64> = None;
    for i in 0..n {
        for j in i + 1..n {
            if (balls[i].0 - balls[j].0).norm() - balls[i].1 - balls[j].1 >= 2.0 * r {
                continue;
            }
            for m in piece_distance_minima(&pieces[i], &pieces[j]).as_slice() {
                let place = |k: usize, p: &Vec3| at[k] + pieces[k].length() * pieces[k].nearest(p);
                let way = (place(j, &m.point_b) - place(i, &m.point_a)).abs();
                if m.distance < 2.0 * r && way.min(total - way) > PI * r && least.is_none_or(|d| m.distance < d) {
                    least = Some(m.distance);
                }
            }
        }
    }
    least
}

fn greatest_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}

fn stadium(straight: f64, radius: f64) -> Vec<Piece> {
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
fn setback(corners: &[Vec3], k: usize, fillet: f64) -> f64 {
    let n = corners.len();
    let (before, at, after) = (corners[(k + n - 1) % n], corners[k % n], corners[(k + 1) % n]);
    fillet * (0.5 * (at - before).angle(&(after - at))).tan()
}

/// A closed polygon with its corners rounded.
fn rounded(corners: &[Vec3], fillet: f64) -> Option<Vec<Piece>> {
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

/// Points of a span at which its deviation is measured.
const SAMPLES: usize = 8;

/// A smooth closed curve, given by point and derivative at 0 ≤ t ≤ 2π, as biarcs of equal spans of t, so many that sampled points are
/// within `tolerance`. From `spans` on, always twice as many.
fn smooth(spans: usize, tolerance: f64, at: impl Fn(f64) -> [Vec3; 2]) -> Option<(Vec<Piece>, f64)> {
    let mut spans = spans.max(1);
    while 2 * spans <= MOST_PIECES {
        let t = |k: f64| TAU * k / spans as f64;
        let mut pieces = Vec::with_capacity(2 * spans);
        let mut worst: f64 = 0.0;
        for k in 0..spans {
            // The last point is the first one, to the last digit.
            let ([start, leaving], [end, arriving]) = (at(t(k as f64)), at(t(((k + 1) % spans) as f64)));
            let pair = biarc(start, leaving, end, arriving)?;
            for sample in 1..SAMPLES {
                let point = at(t(k as f64 + sample as f64 / SAMPLES as f64))[0];
                let away = pair.iter().map(|piece| (piece.point(piece.nearest(&point)) - point).norm());
                worst = worst.max(away.fold(f64::INFINITY, f64::min));
            }
            pieces.extend(pair);
        }
        if worst <= tolerance {
            return Some((pieces, worst));
        }
        spans *= 2;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_closed(pieces: &[Piece]) -> bool {
        (0..pieces.len()).all(|k| {
            let next = &pieces[(k + 1) % pieces.len()];
            (pieces[k].point(1.0) - next.point(0.0)).norm() < 1e-12
        })
    }

    fn length(pieces: &[Piece]) -> f64 {
        pieces.iter().map(Piece::length).sum()
    }

    #[test]
    fn lengths_are_those_of_the_forms() {
        let of = |shape: Shape, tolerance: f64| {
            assert_eq!(shape.problem(), None);
            let pieces = shape.pieces(tolerance).unwrap();
            assert!(is_closed(&pieces), "{shape:?}");
            length(&pieces)
        };
        let close = |x: f64, y: f64| assert!((x - y).abs() < 1e-10, "{x} {y}");
        close(of(Shape::Stadium { straight: 3.0, radius: 0.5 }, 1e-6), 6.0 + PI);
        close(of(Shape::Square { side: 2.0, fillet: 0.0 }, 1e-6), 8.0);
        close(of(Shape::Square { side: 2.0, fillet: 0.3 }, 1e-6), 8.0 - 8.0 * 0.3 + TAU * 0.3);
        close(of(Shape::Square { side: 2.0, fillet: 1.0 }, 1e-6), TAU);
        close(of(Shape::Hexagon { side: 1.0, fillet: 0.0 }, 1e-6), 6.0);
        close(of(Shape::Ellipse { a: 1.5, b: 1.5 }, 1e-6), 3.0 * PI);
        // Ramanujan's second formula, exact to 1e-8 here.
        let (a, b): (f64, f64) = (1.2, 1.0);
        let h = ((a - b) / (a + b)).powi(2);
        let ramanujan = PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()));
        assert!((of(Shape::Ellipse { a, b }, 1e-9) - ramanujan).abs() < 1e-7);
    }

    /// The deviation falls as the third power of the spans: halving the tolerance eightfold costs at most twice the pieces.
    #[test]
    fn a_knot_is_within_its_tolerance() {
        let knot = Shape::TorusKnot { p: 1.0, q: 4.0, circle_radius: 5.5, a: 2.7 };
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let pieces = knot.pieces(tolerance).unwrap();
            assert!(is_closed(&pieces));
            for k in 0..1000 {
                let t = TAU * f64::from(k) / 1000.0 + 1e-4;
                let out = 5.5 + 2.7 * (4.0 * t).cos();
                let point = Vec3::new(out * t.cos(), out * t.sin(), -2.7 * (4.0 * t).sin());
                let away = pieces.iter().map(|p| (p.point(p.nearest(&point)) - point).norm());
                let away = away.fold(f64::INFINITY, f64::min);
                assert!(away < 1.1 * tolerance, "{tolerance}: {away}");
            }
        }
    }

    #[test]
    fn wrong_numbers_are_named() {
        let wrong = |shape: Shape, name: &str, words: &str| {
            let (field, problem, _) = shape.problem().unwrap();
            assert!(field == name && problem.contains(words), "{field}: {problem}");
        };
        wrong(Shape::Stadium { straight: -1.0, radius: 1.0 }, "straight", "not a length");
        wrong(Shape::Square { side: 1.0, fillet: 0.6 }, "fillet", "takes 1.2000 of an edge of length 1.0000");
        let knot = |p, q, a| Shape::TorusKnot { p, q, circle_radius: 1.0, a };
        wrong(knot(2.0, 4.0, 0.3), "p", "common divisor");
        wrong(knot(1.5, 4.0, 0.3), "p", "whole numbers");
        wrong(knot(1.0, 4.0, 1.0), "a", "meets the axis");
        let polygon = |points: &[[f64; 3]]| Shape::Polyline { points: points.to_vec(), fillet: 0.0 };
        wrong(polygon(&[[0.0; 3], [1.0, 0.0, 0.0]]), "points", "2 points");
        wrong(polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), "points", "are one");
        wrong(polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), "points", "turns back");
    }
}
