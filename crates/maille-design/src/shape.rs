//! Forms of core curves other than circles, and the segments and arcs that they are made of.

mod core;
mod corners;
mod frame;
mod overlap;
mod smooth;

pub(crate) use self::core::MOST_PIECES;
pub use self::core::{CorePieces, CurveKind, Owned, PathPart, SMOOTH, ball};
pub(crate) use overlap::tightest;

use self::{
    corners::{Polygon, Problem, are_one, problem_of_parts, stadium, through_parts},
    overlap::{frame_overlap, self_overlap},
    smooth::{smooth, through_points},
};
use maille_geometry::{Circle, Piece, Vec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The form of a core curve in its own frame: about the origin, plane forms in z = 0.
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
    /// A polygon in space.
    Polyline {
        /// Its corners; of an open one the first and the last are its ends.
        points: Vec<[f64; 3]>,
        /// Radius that rounds the corners; 0 leaves them sharp.
        #[serde(default)]
        fillet: f64,
        /// Whether the last point is joined to the first.
        #[serde(default = "yes", skip_serializing_if = "is_true")]
        closed: bool,
    },
    /// A path of segments and arcs in space.
    Path {
        /// Where it starts, of an open one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from: Option<[f64; 3]>,
        /// Its parts; each begins where the one before it ends, and the first where the path starts or, of a closed one, where the last ends.
        parts: Vec<PathPart>,
    },
    /// A smooth curve through points in space: between two of them a cubic, which leaves each point as the parabola through it
    /// and its two neighbours does, with the lengths of the chords as parameter; an end of an open one, as that through the three points there.
    Spline {
        /// The points.
        points: Vec<[f64; 3]>,
        /// Whether the last point is joined to the first.
        #[serde(default = "yes", skip_serializing_if = "is_true")]
        closed: bool,
    },
    /// A cage: straight struts between vertices.
    Frame {
        /// The vertices.
        vertices: Vec<[f64; 3]>,
        /// Struts, by the numbers of their two vertices, from 0.
        edges: Vec<[u32; 2]>,
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

fn yes() -> bool {
    true
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_true(x: &bool) -> bool {
    *x
}

impl Shape {
    /// Its key in a design file.
    pub fn name(&self) -> &'static str {
        match self {
            Shape::Stadium { .. } => "stadium",
            Shape::Square { .. } => "square",
            Shape::Hexagon { .. } => "hexagon",
            Shape::Polyline { .. } => "polyline",
            Shape::Path { .. } => "path",
            Shape::Spline { .. } => "spline",
            Shape::Frame { .. } => "frame",
            Shape::Ellipse { .. } => "ellipse",
            Shape::TorusKnot { .. } => "torus_knot",
        }
    }

    /// Its points with their names in a design file, as `points[2]` or `parts[0].through`.
    pub fn points(&self) -> Vec<(String, [f64; 3])> {
        let mut copy = self.clone();
        copy.points_mut().into_iter().map(|(name, point)| (name, *point)).collect()
    }

    fn points_mut(&mut self) -> Vec<(String, &mut [f64; 3])> {
        let numbered = |name: &'static str| move |(k, p): (usize, _)| (format!("{name}[{k}]"), p);
        match self {
            Shape::Polyline { points, .. } | Shape::Spline { points, .. } => {
                points.iter_mut().enumerate().map(numbered("points")).collect()
            }
            Shape::Frame { vertices, .. } => vertices.iter_mut().enumerate().map(numbered("vertices")).collect(),
            Shape::Path { from, parts } => {
                let start = from.as_mut().map(|p| ("from".to_owned(), p));
                let named = parts.iter_mut().enumerate().flat_map(|(k, PathPart { to, through })| {
                    let through = through.as_mut().map(|p| (format!("parts[{k}].through"), p));
                    std::iter::once((format!("parts[{k}].to"), to)).chain(through)
                });
                start.into_iter().chain(named).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Its numbers with their names in a design file, but for those of points.
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
            Shape::Path { .. } | Shape::Spline { .. } | Shape::Frame { .. } => Vec::new(),
            Shape::Ellipse { a, b } => vec![("a", a), ("b", b)],
            Shape::TorusKnot { p, q, circle_radius, a } => {
                vec![("p", p), ("q", q), ("R", circle_radius), ("a", a)]
            }
        }
    }

    /// The number of this name: `straight`, or `points[2][0]`.
    pub(super) fn number_mut(&mut self, name: &str) -> Option<&mut f64> {
        let Some((point, axis)) = name.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) else {
            return self.named_mut(name);
        };
        let found = self.points_mut().into_iter().find(|(known, _)| known == point);
        found.and_then(|(_, p)| p.get_mut(axis.parse::<usize>().ok()?))
    }

    fn named_mut(&mut self, name: &str) -> Option<&mut f64> {
        self.numbers_mut().into_iter().find(|(known, _)| *known == name).map(|(_, number)| number)
    }

    /// The same form with every length multiplied by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        self.points_mut().into_iter().flat_map(|(_, point)| point).for_each(|x| *x *= factor);
        let lengths = self.numbers_mut().into_iter().filter(|(name, _)| !["p", "q"].contains(name));
        lengths.for_each(|(_, number)| *number *= factor);
    }

    /// The largest of its lengths and coordinates.
    pub(super) fn size(&self) -> f64 {
        let lengths = self.numbers().into_iter().filter(|(name, _)| !["p", "q"].contains(name)).map(|(_, x)| x);
        let coordinates = self.points().into_iter().flat_map(|(_, point)| point);
        lengths.chain(coordinates).fold(0.0, |most, x| most.max(x.abs()))
    }

    /// The same form with all its lengths multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut out = self.clone();
        out.scale(factor);
        out
    }

    /// What is wrong with its numbers: the name of one, what is wrong, and what would be right.
    pub(super) fn problem(&self) -> Option<Problem> {
        for (name, x) in self.numbers() {
            let (least, what) = match (name, self) {
                ("straight" | "fillet", _) | ("a", Shape::TorusKnot { .. }) => (0.0, "a length of 0 or more"),
                _ => (f64::MIN_POSITIVE, "a positive number"),
            };
            if !(x.is_finite() && x >= least) {
                return Some((name.into(), format!("{x} is not {what}"), "give a length in the file's unit"));
            }
        }
        if let Some((name, point)) = self.points().into_iter().find(|(_, p)| p.iter().any(|x| !x.is_finite())) {
            return Some((name, format!("{point:?} is not finite"), "give three finite numbers"));
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
            Shape::Polyline { points, closed: false, .. } if points.len() < 2 || points.len() > MOST_PIECES / 2 => {
                let problem = format!("{} point{}", points.len(), if points.len() == 1 { "" } else { "s" });
                Some(("points".into(), problem, "an open polyline has 2 points or more, at most 5000"))
            }
            Shape::Polyline { points, closed: true, .. } | Shape::Spline { points, .. }
                if points.len() < 3 || points.len() > MOST_PIECES / 2 =>
            {
                let problem = format!("{} points", points.len());
                Some(("points".into(), problem, "such a curve has 3 points or more, at most 5000"))
            }
            Shape::Polyline { points, closed: false, .. } | Shape::Spline { points, closed: false }
                if points.first() == points.last() =>
            {
                let help = "leave the last point out, and closed = false, too";
                Some(("points".into(), "the curve ends where it starts".into(), help))
            }
            Shape::Path { from, parts } => problem_of_parts(*from, parts),
            Shape::Frame { vertices, edges } => frame::problem(vertices, edges),
            Shape::Spline { points, closed } => same_points(points, *closed),
            _ => self.polygon()?.problem(),
        }
    }

    /// The polygon of a form with corners.
    fn polygon(&self) -> Option<Polygon> {
        let (corners, fillet, closed) = match self {
            Shape::Square { side, fillet } => {
                let h = 0.5 * side;
                let corners = [[h, -h], [h, h], [-h, h], [-h, -h]];
                (corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(), *fillet, true)
            }
            Shape::Hexagon { side, fillet } => {
                let corner = |k: usize| {
                    let (sin, cos) = (PI / 3.0 * k as f64).sin_cos();
                    Vec3::new(cos, sin, 0.0) * *side
                };
                ((0..6).map(corner).collect(), *fillet, true)
            }
            Shape::Polyline { points, fillet, closed } => {
                (points.iter().map(|p| Vec3::from(*p)).collect(), *fillet, *closed)
            }
            _ => return None,
        };
        Some(Polygon { corners, fillet, closed })
    }

    /// Whether it is a curve with two ends.
    pub fn is_open(&self) -> bool {
        match self {
            Shape::Polyline { closed, .. } | Shape::Spline { closed, .. } => !closed,
            Shape::Path { from, .. } => from.is_some(),
            _ => false,
        }
    }

    /// The segments and arcs of a curve, in order, and the struts of a frame. Smooth forms become biarcs, spans halved until no sampled point
    /// is farther than `tolerance` from them. None where the numbers make no curve.
    pub fn pieces(&self, tolerance: f64) -> Option<Vec<Piece>> {
        self.approximation(tolerance).map(|(pieces, _)| pieces)
    }

    /// How far it is from its pieces at most, at sampled points: 0 where they are the form itself.
    pub fn deviation(&self, tolerance: f64) -> Option<f64> {
        self.approximation(tolerance).map(|(_, deviation)| deviation)
    }

    /// How near the core comes to itself where the tube of radius `r` round its pieces runs into itself; none where it does not.
    pub(super) fn overlap(&self, pieces: &[Piece], r: f64) -> Option<f64> {
        match self {
            Shape::Frame { edges, .. } => frame_overlap(pieces, edges, r),
            _ => self_overlap(pieces, !self.is_open(), r),
        }
    }

    /// Its closed curves: one, that of an open curve there and back, or those of a frame (`docs/theory/curves.md`).
    pub fn cores(&self, tolerance: f64) -> Option<Vec<CorePieces>> {
        if let Shape::Frame { vertices, edges } = self {
            return frame::cores(vertices, edges);
        }
        let (pieces, deviation) = self.approximation(tolerance)?;
        let of = if self.is_open() { CorePieces::open } else { CorePieces::closed };
        Some(vec![of(pieces, deviation)])
    }

    /// The radius of the circle about the origin, in z = 0, that it is in other words.
    pub fn circle(&self) -> Option<f64> {
        match self {
            Shape::Stadium { straight, radius } if *straight == 0.0 => Some(*radius),
            Shape::Square { side, fillet } if *side == 2.0 * fillet => Some(*fillet),
            Shape::Ellipse { a, b } if a == b => Some(*a),
            Shape::TorusKnot { p, circle_radius, a, .. } if *p == 1.0 && *a == 0.0 => Some(*circle_radius),
            _ => None,
        }
    }

    /// As [`Self::pieces`], and how far the form is from its pieces at most, at sampled points.
    fn approximation(&self, tolerance: f64) -> Option<(Vec<Piece>, f64)> {
        let exact = |pieces: Vec<Piece>| Some((pieces, 0.0));
        if let Some(radius) = self.circle() {
            return exact(vec![Piece::circle(Circle::new(Vec3::zeros(), Vec3::z_axis(), radius))]);
        }
        match self {
            Shape::Stadium { straight, radius } => exact(stadium(*straight, *radius)),
            Shape::Path { from, parts } => through_parts(*from, parts).and_then(exact),
            Shape::Spline { points, closed } => through_points(points, *closed, tolerance),
            Shape::Frame { vertices, edges } => frame::struts(vertices, edges).and_then(exact),
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
            _ => self.polygon()?.pieces().and_then(exact),
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
            Shape::Frame { vertices, .. } => vertices.iter().map(|p| Vec3::from(*p).norm()).fold(0.0, f64::max),
            Shape::Path { .. } | Shape::Spline { .. } => {
                let pieces = self.pieces(f64::INFINITY).unwrap_or_default();
                let farthest = |piece: &Piece| piece.point(piece.farthest(&Vec3::zeros())).norm();
                pieces.iter().map(farthest).fold(0.0, f64::max)
            }
        }
    }
}

fn same_points(points: &[[f64; 3]], closed: bool) -> Option<Problem> {
    let n = points.len();
    (0..n - usize::from(!closed)).find(|&k| points[k] == points[(k + 1) % n]).map(|k| are_one(k, n))
}

fn greatest_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

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
        let part = |to: [f64; 3], through: Option<[f64; 3]>| PathPart { to, through };
        let third = [(-0.5f64), 0.75_f64.sqrt(), 0.0];
        let parts = vec![part([-1.0, 0.0, 0.0], Some(third)), part([1.0, 0.0, 0.0], None)];
        close(of(Shape::Path { from: None, parts }, 1e-6), PI + 2.0);
        let parts = vec![part([-0.5, -third[1], 0.0], Some(third)), part([1.0, 0.0, 0.0], None)];
        close(of(Shape::Path { from: None, parts }, 1e-6), 2.0 / 3.0 * TAU + 3.0_f64.sqrt());
        // Cubics through so many points of a circle are as long as it is, to the fourth power of their distance.
        let on_circle = |k: usize| [(TAU * k as f64 / 64.0).cos(), (TAU * k as f64 / 64.0).sin(), 0.0];
        let spline = of(Shape::Spline { points: (0..64).map(on_circle).collect(), closed: true }, 1e-9);
        assert!((spline - TAU).abs() < 1e-5, "{spline}");
        // The same points without the last chord, and a half circle with a straight end.
        let open = |shape: Shape| {
            assert!(shape.problem().is_none() && shape.is_open());
            length(&shape.pieces(1e-9).unwrap())
        };
        let spline = open(Shape::Spline { points: (0..64).map(on_circle).collect(), closed: false });
        assert!((spline - TAU * 63.0 / 64.0).abs() < 1e-4, "{spline}");
        let parts = vec![part([-1.0, 0.0, 0.0], Some(third)), part([-1.0, -2.0, 0.0], None)];
        close(open(Shape::Path { from: Some([1.0, 0.0, 0.0]), parts }), PI + 2.0);
        let points = vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0]];
        close(open(Shape::Polyline { points: points.clone(), fillet: 0.0, closed: false }), 5.0);
        close(open(Shape::Polyline { points, fillet: 0.5, closed: false }), 4.0 + 0.25 * PI);
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
        let polygon = |points: &[[f64; 3]]| Shape::Polyline { points: points.to_vec(), fillet: 0.0, closed: true };
        wrong(polygon(&[[0.0; 3], [1.0, 0.0, 0.0]]), "points", "2 points");
        wrong(polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), "points", "are one");
        wrong(polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), "points", "turns back");
        let path = |parts: &[([f64; 3], Option<[f64; 3]>)]| Shape::Path {
            from: None,
            parts: parts.iter().map(|(to, through)| PathPart { to: *to, through: *through }).collect(),
        };
        let (a, b) = ([1.0, 0.0, 0.0], [0.0; 3]);
        wrong(path(&[(a, None)]), "parts", "1 part");
        wrong(path(&[(a, None), (a, None)]), "parts[0].to", "ends where it begins");
        wrong(path(&[(a, Some([0.5, 0.0, 0.0])), (b, Some([0.5, 1.0, 0.0]))]), "parts[0].through", "on the line");
        wrong(path(&[(a, None), (b, None)]), "parts[0].to", "turns back");
        wrong(Shape::Spline { points: vec![a, b, b], closed: true }, "points", "points 1 and 2 are one");
        let open =
            |points: &[[f64; 3]], fillet: f64| Shape::Polyline { points: points.to_vec(), fillet, closed: false };
        wrong(open(&[a], 0.0), "points", "1 point");
        wrong(open(&[b, a, [0.5, 0.0, 0.0]], 0.0), "points", "turns back on itself at point 1");
        wrong(open(&[b, a, [1.0, 1.0, 0.0], b], 0.0), "points", "ends where it starts");
        // A fillet may take all of an edge that has none at its other end.
        let corner = [b, a, [1.0, 2.0, 0.0]];
        assert_eq!(open(&corner, 1.0).problem(), None);
        wrong(open(&corner, 1.1), "fillet", "takes 1.1000 of an edge of length 1.0000");
        let start = |parts: Vec<PathPart>| Shape::Path { from: Some(b), parts };
        wrong(start(vec![]), "parts", "0 parts");
        wrong(start(vec![PathPart { to: b, through: None }]), "from", "ends where it starts");
    }
}
