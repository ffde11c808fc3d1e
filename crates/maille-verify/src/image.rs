//! Own images that would be too near: a proof that no state of one cell has an l2.
//!
//! All images of an element have its orientation, so an element and its image differ by a translation w. Let S be the set of all w at which the
//! two overlap, or are linked. If S contains the ball |w| ≤ ρ, no two images that the design does not link are as near as ρ. |F v|
//! grows with l1, so |F v| ≤ ρ at an upper bound of l1 excludes every l1.
//!
//! **Why a ball is in S.** The ball is covered by cubes. Let a ring and a ring of the image be d apart at the centre w of a cube, and δ the sum
//! of their wires. All translations nearer to w than δ − d overlap. If the two are linked at w, all nearer than d + δ are in S: until the cores
//! meet, after d at least, they stay linked, and from there they overlap for δ. A cube within such a ball is in S; others are cut into
//! eight. And |w| < 2r is in S for a ring of wire r, as each of its points is |w| from its image.

use crate::{
    apart::{Apart, Arc, apart, some_distance},
    linking::linking_number,
    sheet::{Ring, Vec3},
    tie::Linked,
};
use maille_geometry::Circle;
use nalgebra::{Unit, Vector2};
use std::f64::consts::TAU;

/// Half an edge of the least cube, in reference radii.
const LEAST: f64 = 1e-3;
/// Points of a circle that are looked at for a small distance.
const POINTS: usize = 96;
/// Part of a distance that was seen which is then proved.
const PROVED: f64 = 0.999;
/// Cubes at most.
const MOST_CUBES: usize = 300_000;

/// An element and an image of it, not linked in the design, that are too near for every l1 up to `most`.
pub(crate) fn too_near(
    start: Linked<'_>,
    most: f64,
    l2: f64,
    (along, across): (Vector2<f64>, Vector2<f64>),
) -> Option<(usize, [i32; 2])> {
    let sheet = start.sheet;
    for element in 0..sheet.bodies.len() {
        let rings: Vec<&Ring> = sheet.rings.iter().filter(|ring| ring.element == element).collect();
        // Balls of translations are derived of circles alone.
        if rings.iter().any(|ring| ring.curve.is_some()) {
            continue;
        }
        let reach = rings.iter().map(|r| r.arm.norm() + r.radius + r.wire).fold(0.0, f64::max);
        for shift in near_shifts() {
            let of = |ring: usize| sheet.rings[ring].element;
            let linked = start.links.iter().any(|((a, b, s), _)| {
                of(*a) == element && of(*b) == element && (*s == shift || *s == shift.map(|x| -x))
            });
            let v = sheet.translation(shift).xy();
            let distance = ((1.0 + most) * v.dot(&along)).hypot((1.0 + l2) * v.dot(&across));
            // More than rounding makes of it.
            let distance = distance * (1.0 + 1e-9) + 1e-12 * reach;
            if !linked && distance < 2.0 * reach && ball_is_out(&rings, distance) {
                return Some((element, shift));
            }
        }
    }
    None
}

/// One shift of each pair of opposite ones, next to the cell.
fn near_shifts() -> impl Iterator<Item = [i32; 2]> {
    (-2..=2).flat_map(|i| (-2..=2).map(move |j| [i, j])).filter(|shift| *shift > [0, 0])
}

/// Whether all translations up to `radius` are proved to be in S.
fn ball_is_out(rings: &[&Ring], radius: f64) -> bool {
    let wire = rings.iter().map(|ring| ring.wire).fold(0.0, f64::max);
    if radius < 2.0 * wire * (1.0 - 1e-12) {
        return true;
    }
    let mut open = vec![(Vec3::zeros(), radius)];
    let mut cubes = 0;
    while let Some((center, half)) = open.pop() {
        cubes += 1;
        let nearest = center.map(|x| (x.abs() - half).max(0.0)).norm();
        let farthest = center.map(|x| x.abs() + half).norm();
        // The opposite translation has the same pairs, so half of the ball is enough.
        if nearest > radius || center.x + half <= 0.0 || farthest < 2.0 * wire * (1.0 - 1e-12) {
            continue;
        }
        let corner = half * 3.0_f64.sqrt() * (1.0 + 1e-12);
        if out(rings, &center, corner) {
            continue;
        }
        if half < LEAST || cubes > MOST_CUBES {
            return false;
        }
        let quarter = 0.5 * half;
        let moved = |k: i32, bit: i32| if k & bit > 0 { quarter } else { -quarter };
        open.extend((0..8).map(|k| (center + Vec3::new(moved(k, 1), moved(k, 2), moved(k, 4)), quarter)));
    }
    true
}

/// Whether all translations nearer to `w` than `within` are in S by one pair of rings.
fn out(rings: &[&Ring], w: &Vec3, within: f64) -> bool {
    let circle = |ring: &Ring, by: Vec3| Circle::new(ring.arm + by, Unit::new_normalize(ring.normal), ring.radius);
    let size = rings.iter().map(|r| r.arm.norm() + r.radius).fold(0.0, f64::max) + w.norm();
    let slack = 1e-13 * size;
    for a in rings {
        for b in rings {
            let (one, other) = (circle(a, Vec3::zeros()), circle(b, *w));
            let wires = a.wire + b.wire;
            let between = (other.center - one.center).norm();
            if between > one.radius + other.radius + wires {
                continue;
            }
            let arc = Arc::new(&one, &other);
            let seen =
                (0..POINTS).map(|k| arc.at(TAU * k as f64 / POINTS as f64).distance).fold(f64::INFINITY, f64::min);
            if wires - seen - slack >= within {
                return true;
            }
            // What a linked pair would rule out at most.
            if seen + wires < within {
                continue;
            }
            let proved = match apart(&one, &other, PROVED * seen, slack) {
                Apart::Proved => Some(PROVED * seen),
                Apart::Nearer(found) => match apart(&one, &other, PROVED * found, slack) {
                    Apart::Proved => Some(PROVED * found),
                    _ => some_distance(&one, &other, slack),
                },
                Apart::Unknown(_) => None,
            };
            let Some(proved) = proved else { continue };
            if proved + wires - slack >= within && linking_number(&one, &other, proved).is_ok_and(|number| number != 0)
            {
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(normal: Vec3, wire: f64) -> Ring {
        Ring { element: 0, arm: Vec3::zeros(), normal, radius: 1.0, wire, curve: None }
    }

    /// A ring can lie flat on its image, 2r away; three circles across each other are linked nearer than 2/√3, however thin the wire.
    #[test]
    fn balls_of_a_ring_and_of_a_gyroscope() {
        let single = ring(Vec3::z(), 0.1);
        assert!(ball_is_out(&[&single], 0.1999));
        assert!(!ball_is_out(&[&single], 0.21));
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| ring(axis, 0.05));
        let all: Vec<&Ring> = axes.iter().collect();
        assert!(ball_is_out(&all, 1.15));
        // They touch two radii apart.
        assert!(!ball_is_out(&all, 2.15));
    }
}
