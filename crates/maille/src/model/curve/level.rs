//! What rules out a minimum of the distance of two short pieces: a slope that keeps its sign all over them.
//!
//! With arc lengths s and t from the middles, W = a(s) − b(t), curvatures κ and half lengths h, the slope g = W·a' has the derivatives
//!
//! ```text
//! ∂g/∂s = 1 + W·a'',   ∂g/∂t = −b'·a'.
//! ```
//!
//! On an arc a''' = −κ² a', so the first differs from its value in the middle by at most κ_a² |W| h_a + κ_a h_b, the second by at most κ_a h_a +
//! κ_b h_b. The slope in t is that of the pair with its sides changed.

use crate::state::Pose;
use maille_design::shape::SMOOTH;
use maille_geometry::{Piece, Vec3};

/// The middle of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Middle {
    point: Vec3,
    tangent: Vec3,
    /// Derivative of the tangent by arc length.
    curvature: Vec3,
    /// Length of the curvature.
    bend: f64,
    half_length: f64,
    /// Whether it has no corner at its ends.
    smooth: bool,
}

/// Slopes are rounded, and may change at a joint by as much as a smooth one may be turned.
const SLACK: f64 = 2.0 * SMOOTH;

impl Middle {
    pub fn new(piece: &Piece, smooth: bool) -> Self {
        let curvature = piece.curvature(0.5);
        Middle {
            point: piece.point(0.5),
            tangent: piece.tangent(0.5),
            curvature,
            bend: curvature.norm(),
            half_length: 0.5 * piece.length(),
            smooth,
        }
    }

    pub fn moved(&self, motion: &Pose) -> Self {
        Middle {
            point: motion.rotation * self.point + motion.position,
            tangent: motion.rotation * self.tangent,
            curvature: motion.rotation * self.curvature,
            ..*self
        }
    }

    /// Whether both slopes of the distance from this piece to the other one may vanish at a point of both.
    pub fn may_be_level(&self, other: &Middle) -> bool {
        !(self.smooth && other.smooth) || self.slope_may_vanish(other) && other.slope_may_vanish(self)
    }

    fn slope_may_vanish(&self, other: &Middle) -> bool {
        let (way, [h, k]) = (self.point - other.point, [self.half_length, other.half_length]);
        let apart = way.norm() + h + k;
        let own = (1.0 + way.dot(&self.curvature)).abs() + self.bend * (self.bend * apart * h + k);
        let others = self.tangent.dot(&other.tangent).abs() + self.bend * h + other.bend * k;
        way.dot(&self.tangent).abs() <= own * h + others * k + SLACK * apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maille_geometry::Arc;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
    use std::f64::consts::TAU;

    /// No pair that has a point where both slopes vanish is ruled out: short arcs and long ones whose middles are off that point by up to half of
    /// their length, in all positions and with one in which the slope hardly changes.
    #[test]
    fn what_is_level_is_not_ruled_out() {
        let mut stream = ChaCha8Rng::seed_from_u64(1);
        let mut random = |from: f64, to: f64| stream.random_range(from..to);
        let mut ruled_out = 0;
        for case in 0..40_000 {
            let sweep = if case % 2 == 0 { 0.1 } else { 2.0 };
            let way = Vec3::z() * random(0.3, 3.0);
            let mut arc = |foot: Vec3, level: bool| {
                let angle = random(0.0, TAU);
                let (tangent, aside) =
                    (Vec3::new(angle.cos(), angle.sin(), 0.0), Vec3::new(-angle.sin(), angle.cos(), 0.0));
                let lean = if level { 0.0 } else { random(0.0, TAU) };
                let out = Vec3::z() * lean.cos() + aside * lean.sin();
                let radius = if level { way.norm() } else { random(0.3, 3.0) };
                let turned =
                    if case % 3 == 0 { random(-0.5, 0.5) } else { random(-1.0, 1.0).signum() * 0.4999 } * sweep;
                let at = |angle: f64| foot - out * radius + (out * angle.cos() + tangent * angle.sin()) * radius;
                // The foot, at the angle 0, lies on it.
                let (from, to) = (turned - 0.5 * sweep, turned + 0.5 * sweep);
                let leaves = tangent * from.cos() - out * from.sin();
                Piece::Arc(Arc::from_tangent(at(from), leaves, at(to)).unwrap())
            };
            // The far end of the way is the centre of its first arc.
            let one = arc(way, case % 5 == 0);
            let other = arc(Vec3::zeros(), false);
            let [a, b] = [one, other].map(|piece| Middle::new(&piece, true));
            assert!(a.may_be_level(&b) && b.may_be_level(&a), "{case}: {one:?} {other:?}");
            let far = Pose { position: Vec3::x() * 6.0, rotation: nalgebra::UnitQuaternion::identity() };
            ruled_out += usize::from(!a.may_be_level(&b.moved(&far)));
        }
        // It rules out pairs that are elsewhere.
        assert!(ruled_out > 10_000, "{ruled_out}");
    }
}
