//! Arrows in space, for forces.

use super::{bvh::Bounds, torus::Ray};
use maille_geometry::Vec3;

/// A round shaft with a conical head.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrow {
    from: Vec3,
    axis: Vec3,
    length: f64,
    shaft: f64,
    head: f64,
    head_radius: f64,
}

impl Arrow {
    /// The arrow along the unit vector `axis`; `thickness` is the shaft's radius. A short arrow is thinner.
    pub(super) fn new(from: Vec3, axis: Vec3, length: f64, thickness: f64) -> Self {
        let size = (length / (9.0 * thickness)).min(1.0);
        let shaft = thickness * size;
        Self { from, axis, length, shaft, head: 5.2 * shaft, head_radius: 2.5 * shaft }
    }

    pub(super) fn bounds(&self) -> Bounds {
        let half = Vec3::repeat(self.head_radius);
        Bounds::around(self.from, half).join(Bounds::around(self.from + self.axis * self.length, half))
    }

    /// First hit beyond `t = 0`, with the normal there.
    pub(super) fn hit(&self, ray: &Ray) -> Option<(f64, Vec3)> {
        let neck = self.length - self.head;
        let mut best: Option<(f64, Vec3)> = None;
        let mut offer = |hit: Option<(f64, Vec3)>| {
            if let Some(hit) = hit
                && hit.0 > 0.0
                && best.is_none_or(|best| hit.0 < best.0)
            {
                best = Some(hit);
            }
        };
        offer(self.disc(ray, 0.0, self.shaft));
        offer(self.disc(ray, neck, self.head_radius));
        offer(self.side(ray, 0.0, neck, self.shaft, 0.0));
        offer(self.side(ray, neck, self.length, self.head_radius, -self.head_radius / self.head));
        best
    }

    /// The disc across the axis at height `z`, seen from behind.
    fn disc(&self, ray: &Ray, z: f64, radius: f64) -> Option<(f64, Vec3)> {
        let along = ray.direction.dot(&self.axis);
        if along <= 0.0 {
            return None;
        }
        let t = (z - (ray.origin - self.from).dot(&self.axis)) / along;
        let off = ray.at(t) - self.from - self.axis * z;
        (off.norm_squared() <= radius * radius).then_some((t, -self.axis))
    }

    /// The side between two heights, of radius `radius + slope (z − low)`.
    fn side(&self, ray: &Ray, low: f64, high: f64, radius: f64, slope: f64) -> Option<(f64, Vec3)> {
        let o = ray.origin - self.from;
        let (oz, dz) = (o.dot(&self.axis), ray.direction.dot(&self.axis));
        let (op, dp) = (o - self.axis * oz, ray.direction - self.axis * dz);
        // |op + t dp|² = (at + t rate)²
        let (at, rate) = (radius + slope * (oz - low), slope * dz);
        let a = dp.norm_squared() - rate * rate;
        let b = op.dot(&dp) - at * rate;
        let c = op.norm_squared() - at * at;
        let root = (b * b - a * c).max(0.0).sqrt();
        if a == 0.0 || b * b < a * c {
            return None;
        }
        let ends = [(-b - root) / a, (-b + root) / a];
        let t = ends
            .into_iter()
            .filter(|t| (low..=high).contains(&(oz + t * dz)) && *t > 0.0)
            .fold(f64::INFINITY, f64::min);
        if t == f64::INFINITY {
            return None;
        }
        let radial = (op + dp * t).normalize();
        Some((t, (radial - self.axis * slope).normalize()))
    }
}
