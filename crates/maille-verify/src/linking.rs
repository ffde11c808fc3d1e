//! The linking number of two circles by Gauss's integral,
//!
//! Lk = 1/4π ∮∮ (x − y)·(dx × dy)/|x − y|³,
//!
//! exact on polygons: over two straight pieces it is the solid angle of the parallelogram that x − y runs over, seen from the
//! origin, the sum of two triangles (Van Oosterom, Strackee 1983)
//!
//! tan(Ω/2) = a·(b × c)/(|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|).
//!
//! **Why polygons will do.** An inscribed n-gon is moved into its circle along the radii, each point by at most the sagitta
//! R (1 − cos π/n). If the circles are δ apart and both sagittas sum to less than δ, the curves never meet on the way, and the linking
//! number stays. So the error is rounding alone, some 1e-16 n², and the sum must be a whole number to [`WHOLE`].

use crate::sheet::{Vec3, frame};
use maille_geometry::Circle;
use std::f64::consts::{PI, TAU};

/// How far from a whole number the integral may be.
const WHOLE: f64 = 1e-3;
/// Corners of a polygon at most.
const CORNERS: usize = 5_000;

/// The linking number of circles that are `apart` from each other (proved), or why it is not known.
pub(crate) fn linking_number(a: &Circle, b: &Circle, apart: f64) -> Result<i32, String> {
    let allowed = 0.9 * apart / (a.radius + b.radius);
    let corners = if allowed >= 1.0 { 4.0 } else { (PI / (1.0 - allowed).acos()).ceil().max(4.0) };
    if corners > CORNERS as f64 {
        return Err(format!("circles {apart:.1e} R apart need polygons of {corners} corners"));
    }
    gauss(&polygon(a, corners as usize), &polygon(b, corners as usize))
}

/// The linking number of two closed polygons that do not meet.
pub(crate) fn gauss(one: &[Vec3], other: &[Vec3]) -> Result<i32, String> {
    let mut angle = 0.0;
    for (k, x) in one.iter().enumerate() {
        let x2 = &one[(k + 1) % one.len()];
        for (m, y) in other.iter().enumerate() {
            let y2 = &other[(m + 1) % other.len()];
            let corners = [y - x, y - x2, y2 - x2, y2 - x];
            angle += triangle(&corners[0], &corners[1], &corners[2]) + triangle(&corners[0], &corners[2], &corners[3]);
        }
    }
    let number = angle / (2.0 * TAU);
    let whole = number.round();
    if (number - whole).abs() <= WHOLE { Ok(whole as i32) } else { Err(format!("Gauss's integral is {number}")) }
}

fn polygon(circle: &Circle, corners: usize) -> Vec<Vec3> {
    let (u, v) = frame(&circle.normal);
    let corner = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / corners as f64).sin_cos();
        circle.center + (u * cos + v * sin) * circle.radius
    };
    (0..corners).map(corner).collect()
}

/// Solid angle of a triangle seen from the origin, with sign.
fn triangle(a: &Vec3, b: &Vec3, c: &Vec3) -> f64 {
    let (p, q, r) = (a.norm(), b.norm(), c.norm());
    let volume = a.dot(&b.cross(c));
    2.0 * volume.atan2(p * q * r + a.dot(b) * r + b.dot(c) * p + c.dot(a) * q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Unit;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn circle(center: Vec3, normal: Vec3, radius: f64) -> Circle {
        Circle::new(center, Unit::new_normalize(normal), radius)
    }

    /// How often circle b passes the disc of a along its normal, less how often against it: the other way to count.
    fn crossings(a: &Circle, b: &Circle) -> i32 {
        let (u, v) = frame(&b.normal);
        let x = b.center - a.center;
        let (h, p, q) = (x.dot(&a.normal), b.radius * u.dot(&a.normal), b.radius * v.dot(&a.normal));
        let (size, at) = (p.hypot(q), q.atan2(p));
        if h.abs() >= size {
            return 0;
        }
        let inside = |angle: f64| {
            let y = x + (u * angle.cos() + v * angle.sin()) * b.radius;
            (y - a.normal.into_inner() * y.dot(&a.normal)).norm() < a.radius
        };
        let half = (-h / size).acos();
        // Downwards at +half, upwards at −half.
        i32::from(inside(at - half)) - i32::from(inside(at + half))
    }

    #[test]
    fn random_pairs_have_the_number_of_crossings() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut linked = [0; 3];
        for _ in 0..2000 {
            let mut vector = || Vec3::from([0; 3].map(|_| rng.random_range(-1.0..1.0)));
            let (center, n, m) = (vector(), vector(), vector());
            let (a, b) = (circle(Vec3::zeros(), n, 1.0), circle(center, m, rng.random_range(0.2..1.0)));
            let Some(apart) = crate::apart::some_distance(&a, &b, 1e-14).filter(|d| *d > 1e-3) else { continue };
            let number = linking_number(&a, &b, apart).unwrap();
            assert_eq!(number, crossings(&a, &b), "{a:?} {b:?}");
            linked[(number + 1) as usize] += 1;
        }
        assert!(linked.iter().all(|&n| n > 100), "{linked:?}");
    }

    #[test]
    fn flat_and_coplanar_pairs_have_none() {
        let a = circle(Vec3::zeros(), Vec3::z(), 1.0);
        for b in [
            circle(Vec3::z() * 0.2, Vec3::z(), 1.0),
            circle(Vec3::x() * 2.2, Vec3::z(), 1.0),
            circle(Vec3::zeros(), Vec3::z(), 0.5),
            circle(Vec3::x() * 2.2, Vec3::x(), 1.0),
        ] {
            assert_eq!(linking_number(&a, &b, 0.19), Ok(0), "{b:?}");
        }
        assert_eq!(linking_number(&a, &circle(Vec3::x(), Vec3::y(), 1.0), 0.19).map(i32::abs), Ok(1));
    }
}
