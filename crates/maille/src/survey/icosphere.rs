//! Triangles on the sphere of directions, refined where the surface over them bends.

use maille_geometry::Vec3;
use std::collections::BTreeMap;

/// Directions and triangles between them; new directions come last.
#[derive(Clone, Debug)]
pub(crate) struct Sphere {
    /// Unit vectors.
    pub directions: Vec<Vec3>,
    /// The two directions that a direction lies between; itself where there are none.
    pub parents: Vec<[usize; 2]>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[usize; 3]>,
}

/// Edges with an angle below this are not divided: across a jump of the distance there would be no end of it.
const LEAST_ANGLE: f64 = 0.004;

/// An edge whose middle is far from the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bent {
    /// Its corners.
    pub edge: [usize; 2],
    /// Expected distance of its middle from the surface.
    pub arch: f64,
    /// Whether it is long enough to be divided.
    pub wide: bool,
}

impl Sphere {
    /// An icosahedron, each edge divided `times` times.
    pub(crate) fn new(times: usize) -> Self {
        let g = (1.0 + 5f64.sqrt()) / 2.0;
        let corners = [
            [-1.0, g, 0.0],
            [1.0, g, 0.0],
            [-1.0, -g, 0.0],
            [1.0, -g, 0.0],
            [0.0, -1.0, g],
            [0.0, 1.0, g],
            [0.0, -1.0, -g],
            [0.0, 1.0, -g],
            [g, 0.0, -1.0],
            [g, 0.0, 1.0],
            [-g, 0.0, -1.0],
            [-g, 0.0, 1.0],
        ];
        let triangles = [
            [0, 11, 5],
            [0, 5, 1],
            [0, 1, 7],
            [0, 7, 10],
            [0, 10, 11],
            [1, 5, 9],
            [5, 11, 4],
            [11, 10, 2],
            [10, 7, 6],
            [7, 1, 8],
            [3, 9, 4],
            [3, 4, 2],
            [3, 2, 6],
            [3, 6, 8],
            [3, 8, 9],
            [4, 9, 5],
            [2, 4, 11],
            [6, 2, 10],
            [8, 6, 7],
            [9, 8, 1],
        ];
        let mut out = Sphere {
            directions: corners.map(|c| Vec3::from(c).normalize()).into(),
            parents: (0..12).map(|k| [k, k]).collect(),
            triangles: triangles.into(),
        };
        for _ in 0..times {
            let all: Vec<[usize; 2]> = out.edges().into_keys().collect();
            out.divide(&all);
        }
        out
    }

    /// Edges, lower corner first, with the corners opposite to them.
    fn edges(&self) -> BTreeMap<[usize; 2], Vec<usize>> {
        let mut edges: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for [a, b, c] in &self.triangles {
            for [from, to, opposite] in [[a, b, c], [b, c, a], [c, a, b]] {
                edges.entry([*from.min(to), *from.max(to)]).or_default().push(*opposite);
            }
        }
        edges
    }

    /// Divides edges; triangles with one, two or three of them fall into two, three or four.
    pub(crate) fn divide(&mut self, marked: &[[usize; 2]]) {
        let mut middles = BTreeMap::new();
        for &[a, b] in marked {
            middles.insert([a, b], self.directions.len());
            self.directions.push((self.directions[a] + self.directions[b]).normalize());
            self.parents.push([a, b]);
        }
        let middle = |a: usize, b: usize| middles.get(&[a.min(b), a.max(b)]).copied();
        let mut triangles = Vec::new();
        for &[a, b, c] in &self.triangles {
            // Turned so that a divided edge comes first, and of two the pair is a–b, b–c.
            let turned = [[a, b, c], [b, c, a], [c, a, b]]
                .into_iter()
                .max_by_key(|[a, b, c]| (middle(*a, *b).is_some(), middle(*b, *c).is_some()));
            let [a, b, c] = turned.unwrap_or([a, b, c]);
            match (middle(a, b), middle(b, c), middle(c, a)) {
                (Some(d), Some(e), Some(f)) => triangles.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]),
                (Some(d), Some(e), None) => triangles.extend([[d, b, e], [a, d, e], [a, e, c]]),
                (Some(d), None, _) => triangles.extend([[a, d, c], [d, b, c]]),
                (None, ..) => triangles.push([a, b, c]),
            }
        }
        self.triangles = triangles;
    }

    /// Edges whose middle is expected further than `tolerance` from the surface through `points`, the worst first: an edge of
    /// length L between triangles that meet at the angle θ has an arch of about L θ/8. Of edges beside a direction without a
    /// point nothing is known.
    pub(crate) fn bent(&self, points: &[Option<Vec3>], tolerance: f64) -> Vec<Bent> {
        let mut out = Vec::new();
        for ([a, b], opposite) in self.edges() {
            let [c, d] = opposite[..] else { continue };
            let [Some(p), Some(q), Some(left), Some(right)] = [a, b, c, d].map(|k| points[k]) else { continue };
            let (n1, n2) = ((q - p).cross(&(left - p)), (p - q).cross(&(right - q)));
            // One of the two has the edge the other way round.
            let (n1, n2) = (n1 * n1.dot(&p).signum(), n2 * n2.dot(&p).signum());
            let theta = n1.cross(&n2).norm().atan2(n1.dot(&n2));
            let arch = (q - p).norm() * theta / 8.0;
            if arch > tolerance {
                out.push(Bent {
                    edge: [a, b],
                    arch,
                    wide: self.directions[a].angle(&self.directions[b]) > LEAST_ANGLE,
                });
            }
        }
        out.sort_by(|x, y| y.arch.total_cmp(&x.arch));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed whatever is divided: V − E + F = 2, each edge in two triangles, all seen from outside.
    #[test]
    fn divided_spheres_are_closed() {
        let mut sphere = Sphere::new(2);
        assert_eq!(sphere.directions.len(), 162);
        for every in [7, 3, 2] {
            let some: Vec<[usize; 2]> = sphere.edges().into_keys().step_by(every).collect();
            sphere.divide(&some);
            let edges = sphere.edges();
            assert!(edges.values().all(|opposite| opposite.len() == 2));
            assert_eq!(sphere.directions.len() + sphere.triangles.len(), edges.len() + 2);
            for [a, b, c] in &sphere.triangles {
                let [a, b, c] = [a, b, c].map(|k| sphere.directions[*k]);
                assert!((b - a).cross(&(c - a)).dot(&a) > 0.0);
            }
        }
    }

    /// A sphere's arch is 1 − cos(angle/2) of an edge, twice that of a triangle's middle at most.
    #[test]
    fn arches_of_a_sphere() {
        let sphere = Sphere::new(3);
        let points: Vec<Option<Vec3>> = sphere.directions.iter().copied().map(Some).collect();
        let Bent { edge, arch, .. } = sphere.bent(&points, 0.0)[0];
        let half = 0.5 * sphere.directions[edge[0]].angle(&sphere.directions[edge[1]]);
        let true_arch = 1.0 - half.cos();
        assert!(arch > 0.3 * true_arch && arch < 2.0 * true_arch, "{arch} {true_arch}");
        assert!(sphere.bent(&points, 2.0 * true_arch).is_empty());
        // A direction without a point bends nothing.
        let mut without = points.clone();
        without[0] = None;
        let all = sphere.bent(&without, 0.0);
        assert!(all.len() < sphere.bent(&points, 0.0).len() && all.iter().all(|bent| !bent.edge.contains(&0)));
    }
}
