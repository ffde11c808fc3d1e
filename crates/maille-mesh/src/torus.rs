//! The mesh of a torus: closed, oriented outward, within a chordal tolerance.

use super::error::MeshError;
use maille_geometry::Vec3;
use std::f64::consts::{PI, TAU};

/// How finely tori are cut into faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fineness {
    /// No point of the mesh is farther than this from the torus, and none of the torus from the mesh.
    Tolerance(f64),
    /// Segments around the core circle, and across the wire (to match the error of the first, at least 6).
    Segments(usize, Option<usize>),
}

/// Segments of one torus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segments {
    /// Around the core circle: n.
    pub around: usize,
    /// Around the wire's circle: m.
    pub across: usize,
}

/// Most segments of a circle: what needs more is a slip of the unit.
pub(super) const MOST: usize = 4096;

impl Fineness {
    /// The segments for a torus of radii R and r, in the tolerance's unit.
    pub fn segments(self, major_radius: f64, minor_radius: f64) -> Result<Segments, MeshError> {
        let outer = major_radius + minor_radius;
        let found = match self {
            Fineness::Tolerance(tolerance) => {
                let share = 0.5 * tolerance;
                Segments { around: polygon(outer, share), across: polygon(minor_radius, share) }
            }
            Fineness::Segments(around, Some(across)) => Segments { around, across },
            Fineness::Segments(around, None) => {
                let error = sagitta(outer, around);
                Segments { around, across: polygon(minor_radius, error).max(6) }
            }
        };
        if found.around.max(found.across) > MOST {
            return Err(MeshError::TooFine { segments: found.around.max(found.across), most: MOST });
        }
        if found.around.min(found.across) < 3 {
            return Err(MeshError::TooCoarse);
        }
        Ok(found)
    }
}

impl Fineness {
    /// No mesh of this fineness lies farther than this outside a torus of the major radius R, in the tolerance's unit; see
    /// [`TorusMesh::protrusion`].
    pub fn protrusion(self, major_radius: f64) -> f64 {
        match self {
            // Half of it is left to the segments around a larger circle.
            Fineness::Tolerance(tolerance) => 0.5 * tolerance,
            Fineness::Segments(around, _) => sagitta(major_radius, around),
        }
    }
}

/// Height of a circle's arc over its chord, the circle cut into `n`: ϱ (1 − cos π/n).
pub(super) fn sagitta(radius: f64, n: usize) -> f64 {
    radius * 2.0 * (PI / (2.0 * n as f64)).sin().powi(2)
}

/// Least number of chords, at least 3, that stay within `tolerance` of a circle.
pub(super) fn polygon(radius: f64, tolerance: f64) -> usize {
    let half_angle_rad = 2.0 * (0.5 * tolerance / radius).min(1.0).sqrt().asin();
    // A whole number that rounding lifted by 1e-12 stays that number.
    ((PI / half_angle_rad * (1.0 - 1e-12)).ceil() as usize).max(3)
}

/// The mesh of a torus around the z axis, centre at the origin; or that of the tube round another curve (`curve.rs`), in the frame of its
/// element.
///
/// Vertices lie on the torus at u = 2πi/n around the axis and v = 2πj/m around the wire,
/// ((R + r cos v) cos u, (R + r cos v) sin u, r sin v), numbered i m + j. The faces between are plane trapezoids, because
/// the chords of one slice are parallel, so with s(ϱ, k) = ϱ (1 − cos π/k):
///
/// - distance between mesh and torus ≤ s(R + r, n) + s(r, m);
/// - volume = n sin(2π/n) · R · (m/2) r² sin(2π/m), which tends to 2π² R r² from below.
#[derive(Clone, Debug)]
pub struct TorusMesh {
    /// Radius R of the core circle.
    pub major_radius: f64,
    /// Radius r of the wire.
    pub minor_radius: f64,
    /// Segments n and m.
    pub segments: Segments,
    /// Of another curve, how far its chords may stray; of a torus it follows from the radii.
    pub chords: Option<f64>,
    /// Of rods with round ends, struts of a frame or an open curve, sections of each: the first and the last are its poles, and no faces join two rods.
    pub sections_of_rod: Option<usize>,
    /// Vertices.
    pub vertices: Vec<Vec3>,
    /// Outward unit normals of the torus at the vertices.
    pub normals: Vec<Vec3>,
}

impl TorusMesh {
    /// The mesh of the torus with radii R and r.
    pub fn new(major_radius: f64, minor_radius: f64, segments: Segments) -> TorusMesh {
        let Segments { around, across } = segments;
        let (mut vertices, mut normals) = (Vec::new(), Vec::new());
        for i in 0..around {
            let (sin_u, cos_u) = (TAU * i as f64 / around as f64).sin_cos();
            for j in 0..across {
                let (sin_v, cos_v) = (TAU * j as f64 / across as f64).sin_cos();
                let rho = major_radius + minor_radius * cos_v;
                vertices.push(Vec3::new(rho * cos_u, rho * sin_u, minor_radius * sin_v));
                normals.push(Vec3::new(cos_v * cos_u, cos_v * sin_u, sin_v));
            }
        }
        TorusMesh { major_radius, minor_radius, segments, chords: None, sections_of_rod: None, vertices, normals }
    }

    /// Number of quadrilaterals: as many as vertices, but for those that would join two rods.
    pub fn quad_count(&self) -> usize {
        let Segments { around, across } = self.segments;
        (around - self.sections_of_rod.map_or(0, |sections| around / sections)) * across
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        let Segments { around, across } = self.segments;
        2 * self.quad_count() - self.sections_of_rod.map_or(0, |sections| 2 * around / sections) * across
    }

    /// The quadrilaterals, counter-clockwise seen from outside; at the pole of a rod two corners are one.
    pub fn quads(&self) -> impl Iterator<Item = [usize; 4]> + use<> {
        let Segments { around, across } = self.segments;
        let sections = self.sections_of_rod;
        let is_last = move |i: usize| sections.is_some_and(|n| i % n == n - 1);
        let is_pole = move |i: usize| sections.is_some_and(|n| i.is_multiple_of(n) || i % n == n - 1);
        let at = move |i: usize, j: usize| i * across + if is_pole(i) { 0 } else { j };
        (0..around).filter(move |i| !is_last(*i)).flat_map(move |i| {
            let next = (i + 1) % around;
            (0..across).map(move |j| {
                let k = (j + 1) % across;
                [at(i, j), at(next, j), at(next, k), at(i, k)]
            })
        })
    }

    /// The triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let split = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
        self.quads().flat_map(split).filter(|[a, b, c]| a != b && b != c && c != a)
    }

    /// Bound of the distance between mesh and torus.
    pub fn chordal_error(&self) -> f64 {
        let outer = self.major_radius + self.minor_radius;
        self.chords.unwrap_or_else(|| sagitta(outer, self.segments.around))
            + sagitta(self.minor_radius, self.segments.across)
    }

    /// The mesh lies no farther than this outside the torus: R (1 − cos π/n).
    ///
    /// A point of the mesh lies on a chord between two slices, at a point (ϱ, z) of their polygon, which is inside the wire:
    /// (ϱ − R)² + z² ≤ r². There its distance from the axis is ϱ′, with ϱ cos π/n ≤ ϱ′ ≤ ϱ. If ϱ ≤ R, or ϱ′ ≤ R, the distance
    /// from the core circle is at most r + R (1 − cos π/n); else it is at most r.
    pub fn protrusion(&self) -> f64 {
        self.chords.unwrap_or_else(|| sagitta(self.major_radius, self.segments.around))
    }

    /// Volume of the mesh of a torus, by the formula.
    pub fn volume(&self) -> f64 {
        let (n, m) = (self.segments.around as f64, self.segments.across as f64);
        n * (TAU / n).sin() * self.major_radius * 0.5 * m * self.minor_radius.powi(2) * (TAU / m).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Signed volume by the divergence theorem.
    fn signed_volume(mesh: &TorusMesh) -> f64 {
        let v = &mesh.vertices;
        mesh.triangles().map(|[a, b, c]| v[a].dot(&v[b].cross(&v[c])) / 6.0).sum()
    }

    #[test]
    fn every_edge_is_used_once_each_way() {
        for (n, m) in [(3, 3), (4, 3), (33, 10)] {
            let mesh = TorusMesh::new(1.0, 0.3, Segments { around: n, across: m });
            let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
            for [a, b, c] in mesh.triangles() {
                for edge in [(a, b), (b, c), (c, a)] {
                    *edges.entry(edge).or_default() += 1;
                }
            }
            assert_eq!(mesh.triangles().count(), mesh.triangle_count());
            assert!(edges.iter().all(|(&(a, b), &count)| count == 1 && edges.contains_key(&(b, a))));
            // Euler's characteristic of a torus.
            assert_eq!(mesh.vertices.len() + mesh.triangle_count(), edges.len() / 2);
        }
    }

    #[test]
    fn the_volume_is_that_of_the_formula_and_tends_to_the_torus() {
        let torus = |big: f64, small: f64| 2.0 * PI * PI * big * small * small;
        for (big, small) in [(1.0, 0.1), (4.9, 1.15), (2.0, 1.9)] {
            let mut last = f64::INFINITY;
            for tolerance in [0.1, 0.01, 0.001] {
                let segments = Fineness::Tolerance(tolerance * small).segments(big, small).unwrap();
                let mesh = TorusMesh::new(big, small, segments);
                let volume = signed_volume(&mesh);
                assert!((volume - mesh.volume()).abs() < 1e-12 * volume);
                let lacks = torus(big, small) - volume;
                // The mesh keeps all of the torus but a skin as thick as the tolerance.
                let skin = 4.0 * PI * PI * big * small * tolerance * small;
                assert!(lacks > 0.0 && lacks < skin && lacks < last, "{big} {small} {tolerance}: {lacks} of {skin}");
                last = lacks;
            }
        }
    }

    #[test]
    fn the_tolerance_holds_on_every_face() {
        let (big, small, tolerance) = (1.0, 0.25, 0.02);
        let segments = Fineness::Tolerance(tolerance).segments(big, small).unwrap();
        let mesh = TorusMesh::new(big, small, segments);
        assert!(mesh.chordal_error() <= tolerance && mesh.chordal_error() > 0.7 * tolerance);
        let mut worst = 0.0_f64;
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|i| mesh.vertices[i]);
            for s in 0..=8 {
                for t in 0..=8 - s {
                    let p = a + (b - a) * (f64::from(s) / 8.0) + (c - a) * (f64::from(t) / 8.0);
                    let distance = (p.x.hypot(p.y) - big).hypot(p.z) - small;
                    worst = worst.max(distance.abs());
                }
            }
        }
        assert!(worst <= mesh.chordal_error() && worst > 0.9 * mesh.chordal_error(), "{worst}");
    }

    #[test]
    fn the_mesh_lies_outside_its_torus_by_no_more_than_it_says() {
        for (big, small, around, across) in [(1.0, 0.25, 8, 6), (1.0, 0.05, 12, 40), (1.0, 0.9, 5, 7)] {
            let mesh = TorusMesh::new(big, small, Segments { around, across });
            let mut worst = f64::NEG_INFINITY;
            for corners in mesh.triangles() {
                let [a, b, c] = corners.map(|i| mesh.vertices[i]);
                for (s, t) in
                    (0..=20).flat_map(|s| (0..=20 - s).map(move |t| (f64::from(s) / 20.0, f64::from(t) / 20.0)))
                {
                    let p = a + (b - a) * s + (c - a) * t;
                    worst = worst.max((p.x.hypot(p.y) - big).hypot(p.z) - small);
                }
            }
            // At the bore it is (R − r) (1 − cos π/n).
            let bore = (1.0 - small / big) * mesh.protrusion();
            assert!(worst <= mesh.protrusion() && worst >= bore - 1e-12, "{worst} of {}", mesh.protrusion());
        }
    }

    #[test]
    fn segments_are_refused_where_they_make_no_torus() {
        assert!(matches!(Fineness::Tolerance(1e-9).segments(1.0, 0.1), Err(MeshError::TooFine { .. })));
        assert!(matches!(Fineness::Segments(2, None).segments(1.0, 0.1), Err(MeshError::TooCoarse)));
        assert!(matches!(Fineness::Segments(8, Some(2)).segments(1.0, 0.1), Err(MeshError::TooCoarse)));
        assert_eq!(Fineness::Tolerance(9.0).segments(1.0, 0.1).unwrap(), Segments { around: 3, across: 3 });
        assert_eq!(Fineness::Segments(12, None).segments(1.0, 0.1).unwrap().across, 6);
        assert_eq!(polygon(1.0, sagitta(1.0, 17)), 17);
    }
}
