//! The smallest ball around a set of points, of which only the farthest point from any place has to be known.

use crate::Vec3;
use arrayvec::ArrayVec;
use nalgebra::Matrix3;

/// Points that hold a ball, and one more.
const MOST: usize = 5;

type Points = ArrayVec<Vec3, MOST>;

/// Steps at most.
const STEPS: usize = 1000;
/// The ball holds the set if no point lies further out than by this share of its radius.
const HELD: f64 = 1e-14;

/// The centre of the smallest ball that holds a set; `farthest` gives its point that is farthest from a place.
///
/// The ball of a few of its points grows by the point that is farthest out, until none is (exchange of support points, as in
/// Gärtner, "Fast and robust smallest enclosing balls", 1999). The radius, the largest distance from the centre, is exact to
/// rounding; the centre of curves along which many points are nearly farthest to fewer digits. `start` is any place near.
/// The centre of a single point is that point.
pub fn smallest_ball_center(start: Vec3, farthest: impl Fn(&Vec3) -> Vec3) -> Vec3 {
    let mut held: Points = [farthest(&start)].into_iter().collect();
    let (mut center, mut radius) = (held[0], 0.0);
    let mut best = (f64::INFINITY, start);
    for _ in 0..STEPS {
        let far = farthest(&center);
        let reach = (far - center).norm();
        if reach < best.0 {
            best = (reach, center);
        }
        if reach <= radius * (1.0 + HELD) {
            break;
        }
        held.push(far);
        let (found, ball) = ball_of(&held);
        // Rounding is all that is left.
        if ball.0 <= radius {
            break;
        }
        held = found;
        (radius, center) = ball;
    }
    best.1
}

/// The smallest ball around a few points: those that hold it, its radius and its centre.
fn ball_of(points: &[Vec3]) -> (Points, (f64, Vec3)) {
    let mut best = (Points::new(), (f64::INFINITY, Vec3::zeros()));
    for chosen in 1_u32..1 << points.len() {
        if chosen.count_ones() >= MOST as u32 {
            continue;
        }
        let on: Points = (0..points.len()).filter(|k| chosen >> k & 1 == 1).map(|k| points[k]).collect();
        let Some(center) = circumcenter(&on) else { continue };
        let radius = points.iter().map(|p| (p - center).norm()).fold(0.0, f64::max);
        if radius < best.1.0 {
            best = (on, (radius, center));
        }
    }
    best
}

/// The point in the flat through up to four points that is as far from each of them. `None` where they lie too badly for one.
fn circumcenter(on: &[Vec3]) -> Option<Vec3> {
    let sides: Points = on[1..].iter().map(|p| p - on[0]).collect();
    let (mut gram, mut half) = (Matrix3::identity(), Vec3::zeros());
    for (i, a) in sides.iter().enumerate() {
        half[i] = 0.5 * a.norm_squared();
        for (j, b) in sides.iter().enumerate() {
            gram[(i, j)] = a.dot(b);
        }
    }
    let weights = gram.lu().solve(&half)?;
    let center = sides.iter().enumerate().map(|(i, side)| side * weights[i]).sum::<Vec3>() + on[0];
    center.iter().all(|x| x.is_finite()).then_some(center)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn among(points: &[Vec3]) -> impl Fn(&Vec3) -> Vec3 + '_ {
        |p| *points.iter().max_by(|a, b| (*a - p).norm().total_cmp(&(*b - p).norm())).unwrap()
    }

    #[test]
    fn few_points_have_their_ball() {
        let triangle = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(4.0, 0.0, 1.0), Vec3::new(2.0, 0.1, 1.0)];
        assert!((smallest_ball_center(triangle[2], among(&triangle)) - Vec3::new(2.0, 0.0, 1.0)).norm() < 1e-14);
        assert_eq!(smallest_ball_center(Vec3::zeros(), |_| triangle[0]), triangle[0]);
        let cube = |k: usize| Vec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
        let corners: Vec<Vec3> = (0..8).map(cube).collect();
        assert!((smallest_ball_center(Vec3::zeros(), among(&corners)) - Vec3::repeat(0.5)).norm() < 1e-14);
    }

    #[test]
    fn no_other_place_has_a_smaller_reach() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for count in [2, 3, 5, 40, 400] {
            let points: Vec<Vec3> = (0..count).map(|_| Vec3::new(next(), next(), 0.3 * next())).collect();
            let reach = |p: &Vec3| points.iter().map(|q| (q - p).norm()).fold(0.0, f64::max);
            let center = smallest_ball_center(Vec3::zeros(), among(&points));
            for _ in 0..200 {
                let aside = center + Vec3::new(next(), next(), next()) * 10.0_f64.powf(-8.0 * (next() + 0.5));
                assert!(reach(&aside) >= reach(&center) * (1.0 - 1e-13));
            }
        }
    }

    #[test]
    fn an_ellipse_is_held_by_its_long_axis_and_a_circle_by_itself() {
        for short in [0.2, 0.999, 1.0] {
            let ellipse: Vec<Vec3> = (0..20_000)
                .map(|k| f64::from(k) * std::f64::consts::TAU / 20_000.0)
                .map(|t| Vec3::new(3.0 + t.cos(), short * t.sin(), -2.0))
                .collect();
            let center = smallest_ball_center(ellipse[7], among(&ellipse));
            assert!((center - Vec3::new(3.0, 0.0, -2.0)).norm() < 1e-7, "{short}: {center:?}");
        }
    }
}
