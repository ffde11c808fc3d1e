//! The least distance between two sets of triangles.
//!
//! Two triangles that do not meet are nearest at a corner of one and a point of the other, or at a point of an edge of each
//! (Ericson, Real-Time Collision Detection, 5.1.10): six distances of a corner and nine of two edges. They meet where an edge of
//! one goes through the other; where they meet in one plane, one of the fifteen distances is 0.
//!
//! Sets are halved along their longest sides until few triangles are left; halves whose boxes are farther apart than the least
//! distance found are left out. Nothing is kept of the halving, so that memory stays that of the triangles.
//!
//! Accuracy: 1e-15 of the coordinates. Triangles without an area are edges or points, as they should be.

use maille_geometry::Vec3;

/// A triangle by its corners.
pub(super) type Triangle = [Vec3; 3];

/// So many pairs of triangles are not halved further.
const FEW: usize = 8;

/// The least distance between a triangle of `a` and one of `b` where it is less than `most`, else `most`; 0 where they
/// meet. In the unit of the corners. Changes the order of both.
pub(super) fn least_distance(a: &mut [Triangle], b: &mut [Triangle], most: f64) -> f64 {
    let boxes = [Span::of(a), Span::of(b)];
    let mut least_sq = most * most;
    nearer(a, boxes[0], b, boxes[1], &mut least_sq);
    if least_sq < most * most { least_sq.sqrt() } else { most }
}

fn nearer(a: &mut [Triangle], around_a: Span, b: &mut [Triangle], around_b: Span, least_sq: &mut f64) {
    if a.is_empty() || b.is_empty() || around_a.distance_sq(&around_b) >= *least_sq {
        return;
    }
    if a.len() * b.len() <= FEW {
        for one in a.iter() {
            for other in b.iter() {
                *least_sq = least_sq.min(distance_sq(one, other));
            }
        }
        return;
    }
    let halve_a = b.len() == 1 || a.len() > 1 && around_a.longest().1 >= around_b.longest().1;
    if !halve_a {
        return nearer(b, around_b, a, around_a, least_sq);
    }
    let axis = around_a.longest().0;
    let middle = a.len() / 2;
    let place = |t: &Triangle| t[0][axis] + t[1][axis] + t[2][axis];
    a.select_nth_unstable_by(middle, |s, t| place(s).total_cmp(&place(t)));
    let (low, high) = a.split_at_mut(middle);
    let (around_low, around_high) = (Span::of(low), Span::of(high));
    if around_low.distance_sq(&around_b) <= around_high.distance_sq(&around_b) {
        nearer(low, around_low, b, around_b, least_sq);
        nearer(high, around_high, b, around_b, least_sq);
    } else {
        nearer(high, around_high, b, around_b, least_sq);
        nearer(low, around_low, b, around_b, least_sq);
    }
}

/// A box around triangles, faces along the axes.
#[derive(Clone, Copy)]
struct Span {
    low: Vec3,
    high: Vec3,
}

impl Span {
    fn of(triangles: &[Triangle]) -> Span {
        let none = Span { low: Vec3::repeat(f64::INFINITY), high: Vec3::repeat(f64::NEG_INFINITY) };
        triangles.iter().flatten().fold(none, |s, p| Span { low: s.low.inf(p), high: s.high.sup(p) })
    }

    fn distance_sq(&self, other: &Span) -> f64 {
        (self.low - other.high).sup(&(other.low - self.high)).sup(&Vec3::zeros()).norm_squared()
    }

    /// The axis of the longest side, and that side.
    fn longest(&self) -> (usize, f64) {
        let side = self.high - self.low;
        (side.imax(), side.max())
    }
}

/// The square of the distance of two triangles.
fn distance_sq(a: &Triangle, b: &Triangle) -> f64 {
    let edges = |t: &Triangle| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let through = |edges: [[Vec3; 2]; 3], t: &Triangle| edges.iter().any(|[p, q]| goes_through(p, q, t));
    if through(edges(a), b) || through(edges(b), a) {
        return 0.0;
    }
    let mut least_sq = f64::INFINITY;
    for (corners, triangle) in [(a, b), (b, a)] {
        for p in corners {
            least_sq = least_sq.min((nearest_of_triangle(p, triangle) - p).norm_squared());
        }
    }
    for one in edges(a) {
        for other in edges(b) {
            least_sq = least_sq.min(segments_sq(one, other));
        }
    }
    least_sq
}

/// Whether the segment from `p` to `q` goes through the triangle's inside: its ends lie on both sides of the plane, and seen
/// along it all edges turn the same way.
fn goes_through(p: &Vec3, q: &Vec3, [a, b, c]: &Triangle) -> bool {
    let side = |x: &Vec3| (b - a).cross(&(c - a)).dot(&(x - a));
    if side(p) * side(q) >= 0.0 {
        return false;
    }
    let way = q - p;
    let turn = |from: &Vec3, to: &Vec3| (from - p).cross(&(to - p)).dot(&way);
    let turns = [turn(a, b), turn(b, c), turn(c, a)];
    turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0)
}

/// The point of a triangle nearest to `p` (Ericson 5.1.5): the region of corner, edge or face that `p` lies over.
fn nearest_of_triangle(p: &Vec3, [a, b, c]: &Triangle) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let all = va + vb + vc;
    a + ab * (vb / all) + ac * (vc / all)
}

/// The square of the distance of two segments (Ericson 5.1.9).
fn segments_sq([p, p_end]: [Vec3; 2], [q, q_end]: [Vec3; 2]) -> f64 {
    let (u, v, r) = (p_end - p, q_end - q, p - q);
    let (a, e, f) = (u.norm_squared(), v.norm_squared(), v.dot(&r));
    let part = |x: f64, of: f64| if of > 0.0 { (x / of).clamp(0.0, 1.0) } else { 0.0 };
    let (b, c) = (u.dot(&v), u.dot(&r));
    let s = part(b * f - c * e, a * e - b * b);
    let t = part(b * s + f, e);
    // The nearest of the first segment to that point of the second.
    let s = part(b * t - c, a);
    (p + u * s - q - v * t).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    fn random(rng: &mut ChaCha8Rng, size: f64) -> Triangle {
        let at = Vec3::from_fn(|_, _| rng.random_range(-2.0..2.0));
        std::array::from_fn(|_| at + Vec3::from_fn(|_, _| rng.random_range(-size..size)))
    }

    /// Least distance of points of a grid on either triangle, an upper bound, and by how much it may be too large.
    fn by_points(a: &Triangle, b: &Triangle) -> (f64, f64) {
        const N: usize = 24;
        let grid = |t: &Triangle| -> Vec<Vec3> {
            let at = |i: usize, j: usize| {
                t[0] + (t[1] - t[0]) * (i as f64 / N as f64) + (t[2] - t[0]) * (j as f64 / N as f64)
            };
            (0..=N).flat_map(|i| (0..=N - i).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
        };
        let longest = |t: &Triangle| [t[1] - t[0], t[2] - t[1], t[0] - t[2]].iter().map(Vec3::norm).fold(0.0, f64::max);
        let (of_a, of_b) = (grid(a), grid(b));
        let near = of_a.iter().flat_map(|p| of_b.iter().map(move |q| (p - q).norm())).fold(f64::INFINITY, f64::min);
        (near, (longest(a) + longest(b)) / N as f64)
    }

    #[test]
    fn two_triangles_are_as_far_apart_as_their_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut meet = 0;
        for round in 0..400 {
            let size = [0.3, 1.0, 2.5][round % 3];
            let (mut a, b) = (random(&mut rng, size), random(&mut rng, size));
            if round % 10 == 0 {
                a[2] = a[1]; // no area
            }
            let found = distance_sq(&a, &b).sqrt();
            let (near, coarse) = by_points(&a, &b);
            assert!(found <= near + 1e-12 && found >= near - coarse, "{found} of {near} ± {coarse}: {a:?} {b:?}");
            meet += usize::from(found == 0.0);
        }
        assert!((10..390).contains(&meet), "{meet} of 400 meet");
    }

    #[test]
    fn closed_forms() {
        let t = |p: [[f64; 3]; 3]| p.map(Vec3::from);
        let flat = t([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let cases = [
            // Over a corner, over the face, crossed edges, in one plane, touching at a corner, going through.
            (t([[-3.0, -4.0, 0.0], [-4.0, -4.0, 0.0], [-3.0, -5.0, 1.0]]), 5.0),
            (t([[0.2, 0.2, 0.5], [0.2, 0.3, 3.0], [0.3, 0.2, 3.0]]), 0.5),
            (t([[0.5, -1.0, 0.25], [0.5, 1.0, 0.25], [0.5, 0.0, 2.0]]), 0.25),
            (t([[0.1, 0.1, 0.0], [0.2, 0.1, 0.0], [0.1, 0.2, 0.0]]), 0.0),
            (t([[1.0, 0.0, 0.0], [2.0, 0.0, 1.0], [2.0, 0.0, -1.0]]), 0.0),
            (t([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [5.0, 5.0, 0.0]]), 0.0),
        ];
        for (other, expected) in cases {
            assert!((distance_sq(&flat, &other).sqrt() - expected).abs() < 1e-15, "{other:?}");
            assert!((distance_sq(&other, &flat).sqrt() - expected).abs() < 1e-15, "{other:?}");
        }
    }

    #[test]
    fn halving_leaves_nothing_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..40 {
            let apart = Vec3::new(rng.random_range(2.5..5.0), 0.0, 0.0);
            let mut a: Vec<Triangle> = (0..60).map(|_| random(&mut rng, 0.2)).collect();
            let mut b: Vec<Triangle> = (0..35).map(|_| random(&mut rng, 0.4).map(|p| p + apart)).collect();
            let pairs = a.iter().flat_map(|s| b.iter().map(move |t| distance_sq(s, t)));
            let expected = pairs.fold(f64::INFINITY, f64::min).sqrt();
            let found = least_distance(&mut a, &mut b, 100.0);
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            assert_eq!(least_distance(&mut b, &mut a, 0.5 * expected), 0.5 * expected);
        }
        assert_eq!(least_distance(&mut [], &mut [random(&mut rng, 1.0)], 2.0), 2.0);
    }
}
