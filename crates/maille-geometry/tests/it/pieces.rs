//! No minimum of two pieces is missed, and none is false: `piece_distance_minima` against a search on a grid.
//!
//! `MAILLE_HARDEST` names a file for the pairs nearest to a change of what is a minimum, which `validation/pairs.py`
//! solves with 50 digits.

use crate::common::{Rng, direction, rng, rotation};
use maille_geometry::{
    Arc, Circle, Piece, PieceMinimum, Place, Segment, Vec3, circle_distance_minima, piece_distance_minima,
};
use rand::RngExt;
use std::{
    collections::BTreeSet,
    f64::consts::{PI, TAU},
};

/// Grid points along each piece.
const GRID: usize = 40;

fn segment(start: Vec3, end: Vec3) -> Piece {
    Piece::Segment(Segment::new(start, end).unwrap())
}

fn any_point(rng: &mut Rng, size: f64) -> Vec3 {
    Vec3::from_fn(|_, _| rng.random_range(-size..size))
}

fn any_arc(rng: &mut Rng, center: Vec3) -> Piece {
    let circle = Circle::new(center, direction(rng), rng.random_range(0.3..1.5));
    Piece::Arc(Arc::new(circle, rng.random_range(0.0..TAU), rng.random_range(0.05..6.0)).unwrap())
}

fn any_piece(rng: &mut Rng) -> Piece {
    let at = any_point(rng, 1.5);
    match rng.random_range(0..8) {
        0..4 => segment(at, at + any_point(rng, 2.0)),
        4 => Piece::circle(Circle::new(at, direction(rng), rng.random_range(0.3..1.5))),
        _ => any_arc(rng, at),
    }
}

type Family = fn(&mut Rng) -> (Piece, Piece);
const FAMILIES: [(&str, Family); 7] = [
    ("any", |rng| (any_piece(rng), any_piece(rng))),
    ("nearly parallel", |rng| {
        let (along, by) = (*direction(rng), 10f64.powf(rng.random_range(-16.0..-2.0)));
        let (from, aside) = (along * rng.random_range(-1.5..1.5), any_point(rng, 0.5));
        let other = (along + *direction(rng) * by) * rng.random_range(0.2..2.0);
        (segment(Vec3::zeros(), along), segment(from + aside, from + aside + other))
    }),
    ("nearly coaxial", |rng| {
        let by = 10f64.powf(rng.random_range(-16.0..-2.0));
        let normal = nalgebra::UnitVector3::new_normalize(Vec3::z() + *direction(rng) * by);
        let above = Circle::new(Vec3::new(0.0, 0.0, 0.4) + *direction(rng) * by, normal, rng.random_range(0.5..1.5));
        let [a, b] = [Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0), above].map(|circle| {
            Piece::Arc(Arc::new(circle, rng.random_range(0.0..TAU), rng.random_range(0.1..TAU)).unwrap())
        });
        (a, b)
    }),
    ("touching", |rng| {
        let (a, b) = (any_piece(rng), any_piece(rng));
        let shift = a.point(rng.random_range(0.0..1.0)) - b.point(rng.random_range(0.0..1.0));
        (a, moved(&b, &nalgebra::Rotation3::identity(), &shift))
    }),
    ("end to end", |rng| {
        let (a, b) = (any_arc(rng, Vec3::zeros()), any_piece(rng));
        let shift = a.point(1.0) - b.point(0.0) + *direction(rng) * 10f64.powf(rng.random_range(-12.0..-1.0));
        (a, moved(&b, &nalgebra::Rotation3::identity(), &shift))
    }),
    ("nested", |rng| {
        let outer = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
        let inner = Circle::new(any_point(rng, 0.1), Vec3::z_axis(), rng.random_range(0.5..0.95));
        let arc = |rng: &mut Rng, c| Arc::new(c, rng.random_range(0.0..TAU), rng.random_range(0.5..TAU)).unwrap();
        (Piece::Arc(arc(rng, outer)), Piece::Arc(arc(rng, inner)))
    }),
    // Ends on axes, centres on other arcs, planes that are one.
    ("on a grid", |rng| (piece_on_grid(rng), piece_on_grid(rng))),
];

fn piece_on_grid(rng: &mut Rng) -> Piece {
    let mut at = || Vec3::from_fn(|_, _| 0.5 * f64::from(rng.random_range(-2..=2)));
    let (start, mut end) = (at(), at());
    if end == start {
        end += Vec3::x();
    }
    let normal = [Vec3::x_axis(), Vec3::y_axis(), Vec3::z_axis()][rng.random_range(0..3)];
    let circle = Circle::new(start, normal, 0.5 * f64::from(rng.random_range(1..=3)));
    let quarters = [rng.random_range(0..4), rng.random_range(1..=4)].map(f64::from);
    match rng.random_range(0..3) {
        0 => segment(start, end),
        _ => Piece::Arc(Arc::new(circle, TAU / 4.0 * quarters[0], TAU / 4.0 * quarters[1]).unwrap()),
    }
}

fn moved(piece: &Piece, by: &nalgebra::Rotation3<f64>, shift: &Vec3) -> Piece {
    let to = |p: Vec3| by * p + shift;
    match piece {
        Piece::Segment(_) => segment(to(piece.point(0.0)), to(piece.point(1.0))),
        Piece::Arc(arc) => {
            let circle = arc.circle();
            let turned = Circle::new(
                to(circle.center),
                nalgebra::UnitVector3::new_normalize(by * *circle.normal),
                circle.radius,
            );
            let start = turned.angle_rad(&to(piece.point(0.0)));
            Piece::Arc(Arc::new(turned, start, arc.sweep_rad()).unwrap())
        }
    }
}

/// The point of a piece nearest to another point, as t, by its own means: the foot on a line, clamped, or the best of
/// the nearest angle and both ends.
fn nearest(p: &Vec3, piece: &Piece) -> f64 {
    match piece {
        Piece::Segment(_) => {
            let (start, end) = (piece.point(0.0), piece.point(1.0));
            ((p - start).dot(&(end - start)) / (end - start).norm_squared()).clamp(0.0, 1.0)
        }
        Piece::Arc(arc) => {
            let past = (arc.circle().angle_rad(p) - arc.circle().angle_rad(&piece.point(0.0))).rem_euclid(TAU);
            let far = |t: &f64| (p - piece.point(*t)).norm();
            [0.0, 1.0, (past / arc.sweep_rad()).min(1.0)].into_iter().min_by(|t, u| far(t).total_cmp(&far(u))).unwrap()
        }
    }
}

/// Local minima on a grid, each followed downhill on smaller and smaller steps, as (t on A, t on B, distance).
fn searched(a: &Piece, b: &Piece) -> Vec<[f64; 3]> {
    let is_closed = |p: &Piece| matches!(p, Piece::Arc(arc) if arc.is_closed());
    let (round_a, round_b) = (is_closed(a), is_closed(b));
    let points = |p: &Piece| -> Vec<Vec3> { (0..=GRID).map(|i| p.point(i as f64 / GRID as f64)).collect() };
    let (at_a, at_b) = (points(a), points(b));
    let distance = |i: usize, j: usize| (at_a[i] - at_b[j]).norm();
    let to = |t: f64, round: bool| if round { t.rem_euclid(1.0) } else { t.clamp(0.0, 1.0) };
    let next = |i: usize, d: i32, round: bool| {
        let k = i as i32 + d;
        let n = GRID as i32;
        if round { Some(k.rem_euclid(n) as usize) } else { (0..=n).contains(&k).then_some(k as usize) }
    };
    // Steps that go on together where pieces are parallel or arcs coaxial, so that valleys are followed.
    let together = match (a, b) {
        (Piece::Arc(a), Piece::Arc(b)) => a.sweep_rad() / b.sweep_rad(),
        _ => a.length() / b.length(),
    };
    const AROUND: [(i32, i32); 8] = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];
    let mut out = Vec::new();
    for i in 0..=GRID {
        for j in 0..=GRID {
            let here = distance(i, j);
            let beside = AROUND.iter().filter_map(|&(di, dj)| Some((next(i, di, round_a)?, next(j, dj, round_b)?)));
            if beside.into_iter().any(|(k, l)| distance(k, l) < here) {
                continue;
            }
            let (mut s, mut t, mut best) = (i as f64 / GRID as f64, j as f64 / GRID as f64, here);
            let mut step = 1.0 / GRID as f64;
            let mut tries = 0;
            while step > 1e-10 && tries < 300 {
                tries += 1;
                let (ds, dt) = (step, step * together);
                let tried = AROUND.map(|(k, l)| {
                    let (s, t) = (to(s + f64::from(k) * ds, round_a), to(t + f64::from(l) * dt, round_b));
                    (s, t, (a.point(s) - b.point(t)).norm())
                });
                let lowest = tried.into_iter().min_by(|x, y| x.2.total_cmp(&y.2)).unwrap();
                if lowest.2 < best {
                    (s, t, best) = lowest;
                } else {
                    step *= 0.5;
                }
            }
            // Curves that nearly meet have valleys too narrow for that: on along A, with the nearest point of B.
            let mut step = 0.25 / GRID as f64;
            while step > 1e-11 {
                let lower = [-step, step].into_iter().find_map(|ds| {
                    let s = to(s + ds, round_a);
                    let other = nearest(&a.point(s), b);
                    let beside = (b.point(other) - b.point(t)).norm() < 0.1 * b.length();
                    let distance = (a.point(s) - b.point(other)).norm();
                    (beside && distance < best).then_some((s, other, distance))
                });
                match lower {
                    Some(lower) => (s, t, best) = lower,
                    None => step *= 0.5,
                }
            }
            out.push([s, t, best]);
        }
    }
    out
}

/// Whether a way on which the distance does not grow leads from a point to where it is less: along a whole circle, say, with one point of an
/// arc through its centre.
fn falls(a: &Piece, b: &Piece, [s, t]: [f64; 2], distance: f64, size: f64) -> bool {
    let is_closed = |p: &Piece| matches!(p, Piece::Arc(arc) if arc.is_closed());
    let round = [is_closed(a), is_closed(b)];
    let to = |t: f64, round: bool| if round { t.rem_euclid(1.0) } else { t.clamp(0.0, 1.0) };
    let mut seen = BTreeSet::from([(0, 0)]);
    let mut open = vec![(0, 0)];
    while let Some((i, j)) = open.pop() {
        for (k, l) in [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)] {
            if !(-80..=80).contains(&k) || !(-80..=80).contains(&l) || !seen.insert((k, l)) {
                continue;
            }
            let at = |t: f64, k: i32, round: bool| to(t + f64::from(k) / 80.0, round);
            let here = (a.point(at(s, k, round[0])) - b.point(at(t, l, round[1]))).norm();
            if here < distance - 1e-6 * size {
                return true;
            }
            if here < distance + 1e-9 * size {
                open.push((k, l));
            }
        }
    }
    false
}

/// Compares a pair; returns what is wrong.
fn problem(a: &Piece, b: &Piece) -> Option<String> {
    let minima = piece_distance_minima(a, b);
    let found = minima.as_slice();
    let size = a.length().max(b.length());
    if found.is_empty() {
        return Some("none found".into());
    }
    for m in found {
        let off = |p: &Vec3, piece: &Piece| (p - piece.point(nearest(p, piece))).norm();
        let [on_a, on_b] = [off(&m.point_a, a), off(&m.point_b, b)];
        if on_a.max(on_b) > 1e-12 * size || (m.distance - (m.point_a - m.point_b).norm()).abs() > 1e-14 * size {
            return Some(format!("not on the pieces: {m:?}"));
        }
    }
    for [s, t, distance] in searched(a, b) {
        let [x, y] = [a.point(s), b.point(t)];
        // The same minimum, or one that is deeper on the way down a flat valley.
        let is_near = |m: &PieceMinimum| {
            let apart = (m.point_a - x).norm().max((m.point_b - y).norm());
            m.distance < distance + 1e-9 * size && (distance - m.distance < 1e-6 * size || apart < 0.2 * size)
        };
        if !found.iter().any(is_near) && !falls(a, b, [s, t], distance, size) {
            return Some(format!("missed {distance} at {s} {t}"));
        }
    }
    None
}

/// How far a minimum inside is from an end, and one at an end from moving inside, as the slope there; relative to the
/// pair's size.
fn hardness(a: &Piece, b: &Piece) -> f64 {
    let size = a.length().max(b.length());
    let of = |piece: &Piece, place: Place, x: &Vec3, y: &Vec3| match place {
        Place::Inside => (x - piece.point(0.0)).norm().min((x - piece.point(1.0)).norm()) / size,
        Place::Start => (x - y).dot(&(piece.point(1e-7) - x)).abs() / (1e-7 * piece.length() * size),
        Place::End => (x - y).dot(&(piece.point(1.0 - 1e-7) - x)).abs() / (1e-7 * piece.length() * size),
    };
    let minima = piece_distance_minima(a, b);
    let each = minima
        .as_slice()
        .iter()
        .map(|m| of(a, m.place_a, &m.point_a, &m.point_b).min(of(b, m.place_b, &m.point_b, &m.point_a)));
    each.fold(f64::INFINITY, f64::min)
}

/// A line for `validation/pairs.py`: both pieces, and the distances found. The first piece must have ends.
fn line(a: &Piece, b: &Piece) -> Option<String> {
    let is_closed = |piece: &Piece| matches!(piece, Piece::Arc(arc) if arc.is_closed());
    let (a, b) = if is_closed(a) { (b, a) } else { (a, b) };
    if is_closed(a) {
        return None;
    }
    let numbers = |v: &Vec3| v.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let piece = |piece: &Piece| match piece {
        Piece::Segment(_) => format!("segment {} {}", numbers(&piece.point(0.0)), numbers(&piece.point(1.0))),
        Piece::Arc(arc) => {
            let (circle, start) = (arc.circle(), piece.point(0.0));
            let [center, normal, start] = [&circle.center, &*circle.normal, &start].map(numbers);
            format!("arc {center} {normal} {} {start} {}", circle.radius, arc.sweep_rad())
        }
    };
    let found: Vec<_> = piece_distance_minima(a, b).as_slice().iter().map(|m| m.distance.to_string()).collect();
    Some(format!("{},{},{}\n", piece(a), piece(b), found.join(" ")))
}

fn compare(pairs: usize) {
    let mut hardest = Vec::new();
    for (seed, (name, family)) in FAMILIES.iter().enumerate() {
        let mut rng = rng(seed as u64);
        let mut most = 0;
        for index in 0..pairs {
            let (a, b) = family(&mut rng);
            if let Some(problem) = problem(&a, &b) {
                panic!("{name} {index}: {problem}\n{a:?}\n{b:?}\n{:?}", piece_distance_minima(&a, &b));
            }
            most = most.max(piece_distance_minima(&a, &b).as_slice().len());
            hardest.extend(line(&a, &b).map(|line| (hardness(&a, &b), line)));
        }
        println!("{name}: {pairs} pairs, at most {most} minima");
    }
    if let Some(file) = std::env::var_os("MAILLE_HARDEST") {
        hardest.sort_by(|x, y| x.0.total_cmp(&y.0));
        let lines: String = hardest.into_iter().take(2_000).map(|(_, line)| line).collect();
        std::fs::write(file, lines).unwrap();
    }
}

#[test]
fn every_minimum_of_a_grid_is_found() {
    compare(2_000);
}

/// `cargo test --release -p maille-geometry --test it pieces:: -- --ignored`
#[test]
#[ignore = "200,000 pairs, some minutes"]
fn every_minimum_of_a_grid_is_found_200_000() {
    compare(200_000 / FAMILIES.len() + 1);
}

/// No point beside a minimum is nearer.
#[test]
fn what_is_found_is_a_minimum() {
    let mut rng = rng(7);
    for _ in 0..20_000 {
        let (a, b) = (any_piece(&mut rng), any_piece(&mut rng));
        for m in piece_distance_minima(&a, &b).as_slice() {
            for (from, other, to) in [(m.point_a, &a, &m.point_b), (m.point_b, &b, &m.point_a)] {
                for step in [1e-3, 1e-5] {
                    let near = (0..=200)
                        .map(|i| other.point(f64::from(i) / 200.0))
                        .filter(|x| (x - from).norm() < step)
                        .all(|x| (x - to).norm() > m.distance - 1e-14);
                    assert!(near, "{m:?} {a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn swap_motion_and_scale_change_nothing() {
    let mut rng = rng(8);
    for _ in 0..5_000 {
        let (a, b) = (any_piece(&mut rng), any_piece(&mut rng));
        let known = piece_distance_minima(&a, &b);
        let swapped = piece_distance_minima(&b, &a);
        let (by, shift) = (rotation(&mut rng), any_point(&mut rng, 3.0));
        let carried = piece_distance_minima(&moved(&a, &by, &shift), &moved(&b, &by, &shift));
        for other in [&swapped, &carried] {
            assert_eq!(known.as_slice().len(), other.as_slice().len(), "{a:?} {b:?}");
            for (m, n) in known.as_slice().iter().zip(other.as_slice()) {
                assert!((m.distance - n.distance).abs() < 1e-12, "{m:?} {n:?}");
            }
        }
        for (m, n) in known.as_slice().iter().zip(swapped.as_slice()) {
            assert_eq!([m.place_a, m.place_b], [n.place_b, n.place_a], "{m:?} {n:?}");
        }
    }
}

#[test]
fn a_circle_in_four_arcs_has_the_minima_of_the_circle() {
    let mut rng = rng(9);
    for _ in 0..5_000 {
        let [a, b] = [0.0, 0.5]
            .map(|shift| Circle::new(Vec3::new(shift, 0.0, 0.0) + any_point(&mut rng, 0.5), direction(&mut rng), 1.0));
        let quarters =
            |c: Circle| [0.0, 1.0, 2.0, 3.0].map(|k| Piece::Arc(Arc::new(c, 0.1 + k * PI / 2.0, PI / 2.0).unwrap()));
        let mut found: Vec<f64> = Vec::new();
        for x in quarters(a) {
            for y in quarters(b) {
                let inside = |m: &&PieceMinimum| m.place_a == Place::Inside && m.place_b == Place::Inside;
                found.extend(piece_distance_minima(&x, &y).as_slice().iter().filter(inside).map(|m| m.distance));
            }
        }
        found.sort_by(f64::total_cmp);
        let known: Vec<f64> = circle_distance_minima(&a, &b).as_slice().iter().map(|m| m.distance).collect();
        assert_eq!(found.len(), known.len());
        assert!(found.iter().zip(&known).all(|(x, y)| (x - y).abs() < 1e-14), "{found:?} {known:?}");
        // Whole circles have the same.
        let whole = piece_distance_minima(&Piece::circle(a), &Piece::circle(b));
        assert!(whole.as_slice().iter().zip(&known).all(|(x, y)| (x.distance - y).abs() < 1e-14));
    }
}

/// Where the distance is constant, both ends of the common stretch are found.
#[test]
fn constant_distances_have_both_ends() {
    let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
    let places = |a: &Piece, b: &Piece| {
        let minima = piece_distance_minima(a, b);
        assert!(minima.as_slice().iter().all(|m| (m.distance - 1.0).abs() < 1e-15), "{minima:?}");
        let mut out: Vec<_> = minima.as_slice().iter().map(|m| (m.place_a, m.place_b)).collect();
        out.sort_by_key(|(x, y)| (*x as u8, *y as u8));
        out
    };
    let bar = |from: f64, to: f64, y: f64| segment(at(from, y), at(to, y));
    use Place::{End, Inside, Start};
    assert_eq!(places(&bar(0.0, 2.0, 0.0), &bar(1.0, 3.0, 1.0)), [(Inside, Start), (End, Inside)]);
    assert_eq!(places(&bar(0.0, 3.0, 0.0), &bar(1.0, 2.0, 1.0)), [(Inside, Start), (Inside, End)]);
    assert_eq!(places(&bar(0.0, 1.0, 0.0), &bar(0.0, 1.0, 1.0)), [(Start, Start), (End, End)]);
    assert_eq!(places(&bar(0.0, 1.0, 0.0), &bar(1.0, 2.0, 1.0)), [(End, Start)]);
    let arc = |radius: f64, from: f64, sweep: f64| {
        Piece::Arc(Arc::new(Circle::new(Vec3::zeros(), Vec3::z_axis(), radius), from, sweep).unwrap())
    };
    assert_eq!(places(&arc(1.0, 0.0, 2.0), &arc(2.0, 1.0, 2.0)), [(Inside, Start), (End, Inside)]);
    // Two common stretches.
    assert_eq!(places(&arc(1.0, 0.0, 4.0), &arc(2.0, 3.0, 4.0)).len(), 4);
    assert_eq!(places(&arc(1.0, 0.0, TAU), &arc(2.0, 3.0, TAU)).len(), 1);
    assert_eq!(places(&arc(1.0, 0.0, TAU), &arc(2.0, 3.0, 1.0)), [(Inside, Start), (Inside, End)]);
}

#[test]
fn what_is_not_finite_is_refused_or_has_no_distance() {
    let unit = Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0);
    for (start, sweep) in [(0.0, f64::NAN), (f64::NAN, 1.0), (0.0, 0.0), (0.0, -1.0), (f64::INFINITY, 1.0)] {
        assert!(Arc::new(unit, start, sweep).is_none(), "{start} {sweep}");
    }
    for end in [f64::NAN, f64::INFINITY] {
        assert!(Segment::new(Vec3::zeros(), Vec3::repeat(end)).is_none());
        assert!(Arc::from_tangent(Vec3::zeros(), Vec3::x(), Vec3::repeat(end)).is_none());
    }
    let nowhere = Piece::circle(Circle::new(Vec3::repeat(f64::NAN), Vec3::z_axis(), 1.0));
    for other in [Piece::circle(unit), segment(Vec3::zeros(), Vec3::x())] {
        assert!(piece_distance_minima(&nowhere, &other).closest().distance.is_nan());
    }
}

#[test]
fn arcs_from_a_tangent_end_where_they_should() {
    let mut rng = rng(10);
    for _ in 0..1_000 {
        let (start, end, tangent) = (any_point(&mut rng, 1.0), any_point(&mut rng, 1.0), *direction(&mut rng));
        let piece = Piece::Arc(Arc::from_tangent(start, tangent, end).unwrap());
        let scale = piece.length();
        assert!((piece.point(0.0) - start).norm() < 1e-13 * scale && (piece.point(1.0) - end).norm() < 1e-13 * scale);
        assert!(((piece.point(1e-6) - start).normalize() - tangent).norm() < 1e-4);
    }
    assert!(Arc::from_tangent(Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0).is_none());
    assert!(Segment::new(Vec3::x(), Vec3::x()).is_none());
}

#[test]
fn a_reversed_piece_has_the_same_points() {
    let mut rng = rng(12);
    for _ in 0..200 {
        let piece = any_piece(&mut rng);
        let back = piece.reversed();
        assert_eq!(back.length(), piece.length());
        for t in [0.0, 0.2, 0.5, 1.0] {
            assert!((back.point(t) - piece.point(1.0 - t)).norm() < 1e-14);
            assert!((back.tangent(t) + piece.tangent(1.0 - t)).norm() < 1e-14);
            assert!((back.curvature(t) - piece.curvature(1.0 - t)).norm() < 1e-13);
        }
    }
}
