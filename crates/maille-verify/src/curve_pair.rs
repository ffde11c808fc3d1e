//! Two curves: how far apart they are at least, their linking number, and their contacts with first and second derivatives.
//!
//! **Apart.** With points a(s), b(t), W = b − a and f = ½ W², on a box of half sides h_s, h_t around a middle,
//!
//! - |W| ≥ |W(m)| − h_s − h_t;
//! - the Hessian of f is (1 − W·k_a, −t_a·t_b; ·, 1 + W·k_b), tangents t and their derivatives k. Let λ be a lower bound of its least
//!   eigenvalue on the box. Then f ≥ f(m) − |f_s| h_s − |f_t| h_t + min(λ, 0) (h_s² + h_t²)/2;
//! - with H the Hessian at the middle and Δ what its eigenvalues can change, f ≥ f(m) − ½ gᵀ (H − Δ)⁻¹ g, g = (f_s, f_t), if H − Δ is positive
//!   definite: sharp near a contact.
//!
//! λ is the least eigenvalue at the middle less Δ, which bounds what the entries change: W by h_s + h_t, k_a by κ_a² h_s, t_a by κ_a h_s, and b alike. Boxes on
//! which no bound proves what is asked are halved.

use crate::{
    apart::Apart,
    curve::{Curve, Piece, Place},
    linking::gauss,
    sheet::{Sheet, Vec3},
};
use nalgebra::{Matrix2, SMatrix, SVector, UnitQuaternion, Vector2};
use std::f64::consts::PI;

/// Derivatives in translation and turn of a's element, then of b's; the last entry is that along a ring, for pairs of rings.
type Local = SVector<f64, 13>;

/// Boxes that are examined at most.
const BOXES: usize = 4_000_000;
/// The same where some distance will do.
const FEW_BOXES: usize = 20_000;
/// Step of the differences of slopes, in core distances: points may go along the curves much faster than the elements.
const STEP: f64 = 1e-4;
/// The step is shorter where curves run along each other, down to this share.
const SOFTEST: f64 = 1e-2;
/// Points of each piece from which a nearer point is sought.
const SEEDS: usize = 4;

/// Whether two curves are at least `least` apart, `slack` being the error of their coordinates.
pub(crate) fn apart(a: &Curve, b: &Curve, least: f64, slack: f64) -> Apart {
    apart_within(a, b, least, slack, BOXES)
}

fn apart_within(a: &Curve, b: &Curve, least: f64, slack: f64, most_boxes: usize) -> Apart {
    let mut nearest = f64::INFINITY;
    let mut boxes = 0;
    let balls: Vec<(Vec3, f64)> = b.pieces.iter().map(Piece::ball).collect();
    for x in &a.pieces {
        let (center, radius) = x.ball();
        for (y, ball) in b.pieces.iter().zip(&balls) {
            if (ball.0 - center).norm() - radius - ball.1 - slack >= least {
                continue;
            }
            // What is nearer is found at once, before all that is hardly farther is examined.
            let found = nearest_of(x, y);
            if found + slack < least {
                return Apart::Nearer(found);
            }
            let halves = (0.5 * x.length, 0.5 * y.length);
            let mut open = vec![(halves.0, halves.0, halves.1, halves.1)];
            while let Some((s, hs, t, ht)) = open.pop() {
                boxes += 1;
                let here = At::new(x, y, s, t);
                let d = here.way.norm();
                nearest = nearest.min(d);
                if d + slack < least {
                    return Apart::Nearer(nearer(x, y, [s, t]));
                }
                if boxes > most_boxes {
                    return Apart::Unknown(nearest);
                }
                // Boxes reach a little beyond, so that rounded halves leave nothing between.
                if here.keeps(hs * (1.0 + 1e-9) + 1e-15, ht * (1.0 + 1e-9) + 1e-15, [x, y], least, slack) {
                    continue;
                }
                if hs >= ht {
                    open.extend([(s - 0.5 * hs, 0.5 * hs, t, ht), (s + 0.5 * hs, 0.5 * hs, t, ht)]);
                } else {
                    open.extend([(s, hs, t - 0.5 * ht, 0.5 * ht), (s, hs, t + 0.5 * ht, 0.5 * ht)]);
                }
            }
        }
    }
    Apart::Proved
}

/// A lower bound of the distance, at least half of it, if it is not 0 to rounding.
pub(crate) fn some_distance(a: &Curve, b: &Curve, slack: f64) -> Option<f64> {
    let mut least = 1.0;
    while least > 1e3 * slack {
        match apart_within(a, b, least, slack, FEW_BOXES) {
            Apart::Proved => return Some(least),
            Apart::Nearer(found) | Apart::Unknown(found) => least = (0.7 * found).min(0.7 * least),
        }
    }
    None
}

/// A small distance of two pieces: from the best of some points.
fn nearest_of(x: &Piece, y: &Piece) -> f64 {
    let part = |k: usize| (k as f64 + 0.5) / SEEDS as f64;
    let seeds = (0..SEEDS * SEEDS).map(|k| [part(k / SEEDS) * x.length, part(k % SEEDS) * y.length]);
    let away = |at: &[f64; 2]| (y.position(at[1]) - x.position(at[0])).norm();
    let best = seeds.min_by(|p, q| away(p).total_cmp(&away(q))).unwrap_or_default();
    nearer(x, y, best)
}

/// A distance near two points, given by their arc lengths.
fn nearer(x: &Piece, y: &Piece, from: [f64; 2]) -> f64 {
    let [s, t] = nearer_at(x, y, from);
    (y.position(t) - x.position(s)).norm()
}

/// Arc lengths of points that are nearer than two given ones, by steps of halving size.
fn nearer_at(x: &Piece, y: &Piece, from: [f64; 2]) -> [f64; 2] {
    let (mut at, mut step) = (from, [0.25 * x.length, 0.25 * y.length]);
    let distance = |at: [f64; 2]| (y.position(at[1]) - x.position(at[0])).norm();
    let mut least = distance(at);
    while step[0] > 1e-12 * x.length {
        let mut moved = false;
        for (k, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
            let mut there = at;
            there[k] = (at[k] + sign * step[k]).clamp(0.0, [x.length, y.length][k]);
            if distance(there) < least {
                (at, least, moved) = (there, distance(there), true);
            }
        }
        if !moved {
            step = step.map(|h| 0.5 * h);
        }
    }
    at
}

/// Points of two pieces.
struct At {
    way: Vec3,
    slope: Vector2<f64>,
    hessian: Matrix2<f64>,
}

impl At {
    fn new(x: &Piece, y: &Piece, s: f64, t: f64) -> At {
        let way = y.position(t) - x.position(s);
        let (along_a, along_b) = (x.tangent(s), y.tangent(t));
        let across = -along_a.dot(&along_b);
        At {
            way,
            slope: Vector2::new(-way.dot(&along_a), way.dot(&along_b)),
            hessian: Matrix2::new(1.0 - way.dot(&x.bend(s)), across, across, 1.0 + way.dot(&y.bend(t))),
        }
    }

    /// Whether all of the box around it is proved to be `least` apart.
    fn keeps(&self, hs: f64, ht: f64, [x, y]: [&Piece; 2], least: f64, slack: f64) -> bool {
        let (d, h) = (self.way.norm(), hs + ht);
        if d - h - slack >= least {
            return true;
        }
        let (ka, kb) = (x.curvature(), y.curvature());
        let changes = [(ka, hs), (kb, ht)].map(|(k, own)| k * h + (d + h) * k * k * own);
        let change = changes[0].max(changes[1]) + ka * hs + kb * ht + 1e-12;
        let lowest = self.hessian.symmetric_eigenvalues().min() - change;
        // Rounding of W is charged to f and to its slopes; that of the eigenvalues is far below.
        let value = 0.5 * d * d - d * slack - 2.0 * slack * h;
        let wanted = 0.5 * least * least;
        let linear = self.slope.x.abs() * hs + self.slope.y.abs() * ht;
        if value - linear + 0.5 * lowest.min(0.0) * (hs * hs + ht * ht) >= wanted {
            return true;
        }
        let quadratic = (self.hessian - Matrix2::identity() * change).cholesky();
        quadratic.is_some_and(|of| value - 0.5 * self.slope.dot(&of.solve(&self.slope)) >= wanted)
    }
}

/// Points nearer than this are one, in reference radii.
const ONE_POINT: f64 = 1e-7;

/// The contacts of two curves with a gap of at most `closed`, each a point to which seeds on two pieces lead.
pub(crate) fn closed_points(sheet: &Sheet, pair: (usize, usize, [i32; 2]), closed: f64) -> Vec<CurveContact> {
    let (a, b) = (sheet.curve(pair.0, [0, 0]), sheet.curve(pair.1, pair.2));
    let most = sheet.touching(pair.0, pair.1) + closed;
    let mut out: Vec<(CurveContact, [Vec3; 2])> = Vec::new();
    let part = |k: usize| (k as f64 + 0.5) / SEEDS as f64;
    for (x, y) in a.pieces.iter().flat_map(|x| b.pieces.iter().map(move |y| (x, y))) {
        let ((p, reach), (q, other)) = (x.ball(), y.ball());
        if (q - p).norm() - reach - other > most {
            continue;
        }
        for seed in 0..SEEDS * SEEDS {
            let [s, t] = nearer_at(x, y, [part(seed / SEEDS) * x.length, part(seed % SEEDS) * y.length]);
            let points = [x.position(s), y.position(t)];
            let near = |known: &[Vec3; 2]| (0..2).all(|k| (known[k] - points[k]).norm() < ONE_POINT);
            if (points[1] - points[0]).norm() > most || out.iter().any(|(_, known)| near(known)) {
                continue;
            }
            let mut contact = CurveContact::new(sheet, pair, points);
            if let Ok(s) = contact.least(&contact.poses) {
                (0..2).for_each(|k| contact.places[k].s = s[k]);
            }
            if contact.gap().abs() <= closed {
                out.push((contact, points));
            }
        }
    }
    out.into_iter().map(|(contact, _)| contact).collect()
}

/// Corners of a polygon at most.
const CORNERS: usize = 8_000;

/// The linking number of two curves that are `apart`, or why it is not known.
pub(crate) fn linking_number(a: &Curve, b: &Curve, apart: f64) -> Result<i32, String> {
    let polygon = |curve: &Curve| {
        let mut out = Vec::new();
        for piece in &curve.pieces {
            // The sagitta of each chord is below 0.4 of the distance.
            let k = piece.curvature();
            let half = if k > 0.0 { (1.0 - (0.4 * apart * k).min(1.0)).acos() } else { PI };
            let n = (0.5 * piece.length * k / half).ceil().max(1.0);
            if n.is_nan() || n > CORNERS as f64 {
                return Err(format!("curves {apart:.1e} R apart need too fine polygons"));
            }
            out.extend((0..n as usize).map(|i| piece.position(piece.length * i as f64 / n)));
        }
        if out.len() > CORNERS {
            return Err(format!("curves {apart:.1e} R apart need polygons of {} corners", out.len()));
        }
        Ok(out)
    };
    gauss(&polygon(a)?, &polygon(b)?)
}

/// A contact of two tubes of which one is no torus.
#[derive(Clone, Debug)]
pub(crate) struct CurveContact {
    /// The curves in the frames of their elements.
    own: [Curve; 2],
    places: [Place; 2],
    /// Where the elements stand; the second in its image.
    poses: [(Vec3, UnitQuaternion<f64>); 2],
    touching: f64,
}

/// Steps to a least distance.
const STEPS: usize = 40;
/// Determinants below this are none: the curves run along each other.
const FLATTEST: f64 = 1e-6;

impl CurveContact {
    /// The contact nearest to two points.
    pub fn new(sheet: &Sheet, (a, b, shift): (usize, usize, [i32; 2]), points: [Vec3; 2]) -> Self {
        let poses = [sheet.place(a, [0, 0]), sheet.place(b, shift)];
        let own = [sheet.own_curve(a), sheet.own_curve(b)];
        let place = |k: usize| {
            let (at, turn): &(Vec3, UnitQuaternion<f64>) = &poses[k];
            own[k].nearest(&(turn.inverse() * (points[k] - at)))
        };
        let mut places = [place(0), place(1)];
        // Where two pieces meet the second derivative jumps. The larger one along the curve is the stricter: with it the least distance grows most.
        for k in 0..2 {
            if let Some(other) = own[k].across_joint(places[k]) {
                let way = poses[k].1.inverse() * (points[1] - points[0]) * (2.0 * k as f64 - 1.0);
                let bend = |at: &Place| way.dot(&own[k].pieces[at.piece].bend(at.s));
                if bend(&other) > bend(&places[k]) {
                    places[k] = other;
                }
            }
        }
        CurveContact { places, poses, touching: sheet.touching(a, b), own }
    }

    /// Points, tangents and their derivatives at two arc lengths, where the elements have moved.
    fn at(&self, poses: &[(Vec3, UnitQuaternion<f64>); 2], s: [f64; 2]) -> [[Vec3; 3]; 2] {
        [0, 1].map(|k| {
            let (piece, (at, turn)) = (&self.own[k].pieces[self.places[k].piece], &poses[k]);
            [turn * piece.position(s[k]) + at, turn * piece.tangent(s[k]), turn * piece.bend(s[k])]
        })
    }

    /// The points.
    pub fn points(&self) -> [Vec3; 2] {
        self.at(&self.poses, self.places.map(|place| place.s)).map(|found| found[0])
    }

    /// Distance less the sum of the minor radii.
    pub fn gap(&self) -> f64 {
        let [a, b] = self.points();
        (b - a).norm() - self.touching
    }

    /// Slope of the distance along the curves, of the points that are at no corner.
    pub fn slope(&self) -> f64 {
        let found = self.at(&self.poses, self.places.map(|place| place.s));
        let way = (found[1][0] - found[0][0]).normalize();
        let of = |k: usize| if self.places[k].corner { 0.0 } else { way.dot(&found[k][1]).abs() };
        of(0).max(of(1))
    }

    /// The arc lengths of the least distance where the elements have moved, from those of the contact, by Newton's method. Pieces go on beyond
    /// their ends, and corners stay.
    pub fn least(&self, poses: &[(Vec3, UnitQuaternion<f64>); 2]) -> Result<[f64; 2], String> {
        let mut s = self.places.map(|place| place.s);
        let free = self.places.map(|place| !place.corner);
        for _ in 0..STEPS {
            let [[pa, ta, ka], [pb, tb, kb]] = self.at(poses, s);
            let way = pb - pa;
            let across = -ta.dot(&tb);
            let mut h = Matrix2::new(1.0 - way.dot(&ka), across, across, 1.0 + way.dot(&kb));
            let mut g = Vector2::new(-way.dot(&ta), way.dot(&tb));
            for k in 0..2 {
                if !free[k] {
                    (h[(0, 1)], h[(1, 0)], h[(k, k)], g[k]) = (0.0, 0.0, 1.0, 0.0);
                }
            }
            if h.determinant() < FLATTEST || h[(0, 0)] <= 0.0 {
                return Err("two curves touch along a stretch".into());
            }
            let step = h.try_inverse().unwrap_or_default() * g;
            (s[0], s[1]) = (s[0] - step[0], s[1] - step[1]);
            if step.amax() < 1e-14 {
                break;
            }
        }
        Ok(s)
    }

    /// How fast the distance grows along the curves, as they slide most easily: 1 for straight ones across each other, little where they run along
    /// each other, and the points move fast with the elements.
    fn stiffness(&self) -> f64 {
        let [[pa, ta, ka], [pb, tb, kb]] = self.at(&self.poses, self.arc_lengths());
        let (way, across) = (pb - pa, -ta.dot(&tb));
        let along = [1.0 - way.dot(&ka), 1.0 + way.dot(&kb)];
        match self.places.map(|place| place.corner) {
            [false, false] => Matrix2::new(along[0], across, across, along[1]).symmetric_eigenvalues().min(),
            [true, true] => 1.0,
            [one, _] => along[usize::from(one)],
        }
    }

    /// The step of differences of slopes.
    pub fn step(&self) -> f64 {
        STEP * self.stiffness().clamp(SOFTEST, 1.0) * self.touching
    }

    /// The arc lengths of the points.
    pub fn arc_lengths(&self) -> [f64; 2] {
        self.places.map(|place| place.s)
    }

    /// Distance of the points at two arc lengths where the elements have moved to these places, less the sum of the minor radii.
    pub fn gap_at(&self, poses: &[(Vec3, UnitQuaternion<f64>); 2], s: [f64; 2]) -> f64 {
        let [[p, ..], [q, ..]] = self.at(poses, s);
        (q - p).norm() - self.touching
    }

    /// The derivative of the distance in translations and turns of both elements (the last entry belongs to pairs of circles), after a motion.
    fn gradient_after(&self, along: usize, h: f64) -> Result<Local, String> {
        let mut poses = self.poses;
        if h != 0.0 {
            let (at, turn) = &mut poses[along / 6];
            let mut axis = Vec3::zeros();
            axis[along % 3] = h;
            match along % 6 < 3 {
                true => *at += axis,
                false => *turn = UnitQuaternion::from_scaled_axis(axis) * *turn,
            }
        }
        let [[p, ..], [q, ..]] = self.at(&poses, self.least(&poses)?);
        let n = (q - p).normalize();
        let (of_a, of_b) = ((p - poses[0].0).cross(&n), (q - poses[1].0).cross(&n));
        let entries = [-n.x, -n.y, -n.z, -of_a.x, -of_a.y, -of_a.z, n.x, n.y, n.z, of_b.x, of_b.y, of_b.z, 0.0];
        Ok(Local::from_column_slice(&entries))
    }

    /// The derivative of the distance at the recorded points.
    pub fn gradient(&self) -> Local {
        let [p, q] = self.points();
        let n = (q - p).normalize();
        let (of_a, of_b) = ((p - self.poses[0].0).cross(&n), (q - self.poses[1].0).cross(&n));
        Local::from_column_slice(&[
            -n.x, -n.y, -n.z, -of_a.x, -of_a.y, -of_a.z, n.x, n.y, n.z, of_b.x, of_b.y, of_b.z, 0.0,
        ])
    }

    /// Second derivatives of the least distance, symmetric, by differences of fourth order.
    pub fn hessian(&self) -> Result<SMatrix<f64, 13, 13>, String> {
        let mut out = SMatrix::<f64, 13, 13>::zeros();
        let step = self.step();
        let size = self.own.iter().map(|curve| curve.reach(&Vec3::zeros())).fold(1.0, f64::max);
        for along in 0..12 {
            let h = if along % 6 < 3 { step } else { step / size };
            let g = |x: f64| self.gradient_after(along, x);
            let column = ((g(h)? - g(-h)?) * 8.0 - (g(2.0 * h)? - g(-2.0 * h)?)) / (12.0 * h);
            out.set_column(along, &column);
        }
        Ok((out + out.transpose()) * 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{record::Form, sheet::frame};
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn forms() -> Vec<Form> {
        vec![
            Form::Stadium { straight: 1.0, radius: 0.6 },
            Form::Square { side: 1.8, fillet: 0.0 },
            Form::Hexagon { side: 1.0, fillet: 0.3 },
            Form::Ellipse { a: 1.3, b: 0.8 },
            Form::TorusKnot { p: 1.0, q: 4.0, circle_radius: 1.0, a: 0.4 },
        ]
    }

    fn points(curve: &Curve, n: usize) -> Vec<Vec3> {
        let of = |piece: &Piece| (0..n).map(|k| piece.position(piece.length * k as f64 / n as f64)).collect::<Vec<_>>();
        curve.pieces.iter().flat_map(of).collect()
    }

    /// Against many points: what is proved is never above the least that is seen, and a little below it is proved. Circles by their own code have
    /// the same linking numbers.
    #[test]
    fn random_pairs_are_as_far_apart_as_their_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut linked = 0;
        for k in 0..60 {
            let form = |k: usize| Curve::of(&forms()[k % 5], 1.0, 1e-3).unwrap();
            let mut vector = |size: f64| Vec3::from([0; 3].map(|_| size * rng.random_range(-1.0..1.0)));
            let (turn, by) = (UnitQuaternion::from_scaled_axis(vector(3.0)), vector(1.5));
            let (a, b) = (form(k), form(k / 5).moved(&turn, &by));
            let steps = if a.pieces.len().max(b.pieces.len()) > 20 { 20 } else { 200 };
            let (p, q) = (points(&a, steps), points(&b, steps));
            let seen = p.iter().flat_map(|x| q.iter().map(move |y| (y - x).norm())).fold(f64::INFINITY, f64::min);
            let step = |curve: &Curve| curve.pieces.iter().map(|piece| piece.length / steps as f64).fold(0.0, f64::max);
            let off = 0.5 * (step(&a) + step(&b));
            assert!(matches!(apart(&a, &b, seen - off, 1e-14), Apart::Proved), "{k}");
            match apart(&a, &b, seen + 1e-9, 1e-14) {
                Apart::Nearer(found) => {
                    assert!(found <= seen + 1e-9 && found >= seen - off, "{k}");
                    // To the ninth digit, as contacts are.
                    assert!(matches!(apart(&a, &b, found - 1e-6, 1e-14), Apart::Proved | Apart::Nearer(_)), "{k}");
                }
                other => panic!("{k}: {other:?}"),
            }
            if let Some(distance) = some_distance(&a, &b, 1e-14).filter(|d| *d > 1e-2) {
                let number = linking_number(&a, &b, distance).unwrap();
                assert_eq!(linking_number(&b, &a, 0.5 * distance), Ok(number), "{k}");
                linked += number.abs();
            }
        }
        assert!(linked > 5, "{linked}");
    }

    /// Two squares, corner in corner, touch with each side of one at each of the other: docs/theory/curves.md has where.
    #[test]
    fn squares_touch_where_their_sides_cross() {
        let (side, r) = (2.0_f64, 0.1);
        let apart = 2.0_f64.sqrt() * side - 2.0 * 3.0_f64.sqrt() * r;
        let element = |name: &str, x: f64, normal: [f64; 3], along: [f64; 3]| {
            let shape = serde_json::json!({ "square": { "side": side } });
            let curve =
                serde_json::json!({ "shape": shape, "normal": normal, "along": along, "offset": [0.0, 0.0, 0.0] });
            serde_json::json!({ "name": name, "center": [x, 0.0, 0.0], "rings": [], "curves": [curve] })
        };
        let design = serde_json::json!({
            "name": "squares", "minor_radius": r, "reference_radius": 1.0,
            "lattice": { "a1": [2.0 * apart, 0.0, 0.0], "a2": [0.0, 50.0, 0.0], "single": true },
            "elements": [
                element("flat", 0.0, [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]),
                element("up", apart, [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]),
            ],
        });
        let design = serde_json::from_value(design).unwrap();
        let sheet = Sheet::start(&design, &crate::sheet::cell("1x1").unwrap(), &["flat", "up"]).unwrap();
        for shift in [[0, 0], [-1, 0]] {
            let found = closed_points(&sheet, (0, 1, shift), 1e-9);
            assert_eq!(found.len(), 4, "{shift:?}");
            for contact in found {
                assert!(contact.gap().abs() < 1e-12 && contact.slope() < 1e-10, "{contact:?}");
                // So far from each other, and √2/3 of the corners' distance from both.
                let corner = [2.0_f64.sqrt() * if shift == [0, 0] { 1.0 } else { -1.0 }, 0.0];
                let from = (contact.points()[0] - Vec3::new(corner[0], corner[1], 0.0)).norm();
                assert!((from - 2.0 * 3.0_f64.sqrt() * r * 2.0_f64.sqrt() / 3.0).abs() < 1e-9, "{from}");
            }
        }
    }

    /// A ring as two halves, and as the program's circles are seen.
    #[test]
    fn circles_are_linked_as_by_their_own_code() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..100 {
            let mut vector = |size: f64| Vec3::from([0; 3].map(|_| size * rng.random_range(-1.0..1.0)));
            let (n, m, by) = (vector(1.0).normalize(), vector(1.0).normalize(), vector(1.2));
            let circle = |at: Vec3, n: Vec3| maille_geometry::Circle::new(at, nalgebra::Unit::new_normalize(n), 1.0);
            let (a, b) = (circle(Vec3::zeros(), n), circle(by, m));
            let Some(d) = crate::apart::some_distance(&a, &b, 1e-14).filter(|d| *d > 1e-3) else { continue };
            let curves = [Curve::ring(Vec3::zeros(), frame(&n), 1.0), Curve::ring(by, frame(&m), 1.0)];
            let own = linking_number(&curves[0], &curves[1], d);
            assert_eq!(own, crate::linking::linking_number(&a, &b, d));
        }
    }
}
