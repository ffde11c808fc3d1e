//! A tree of boxes: which shapes may a ray meet, nearest first.

use super::torus::Ray;
use maille_geometry::Vec3;

/// A box with faces along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Bounds {
    pub(super) const EMPTY: Bounds = Bounds {
        low: Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    pub(super) fn around(center: Vec3, half: Vec3) -> Self {
        Self { low: center - half, high: center + half }
    }

    pub(super) fn join(self, other: Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    pub(super) fn center(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }

    /// Where the ray enters, if it does before `most`.
    fn entry(&self, origin: &Vec3, inverse: &Vec3, most: f64) -> Option<f64> {
        let (one, other) = ((self.low - origin).component_mul(inverse), (self.high - origin).component_mul(inverse));
        let (near, far) = (one.inf(&other), one.sup(&other));
        let (enter, leave) = (near.x.max(near.y).max(near.z).max(0.0), far.x.min(far.y).min(far.z).min(most));
        (enter <= leave).then_some(enter)
    }
}

/// Children of a node, or the shapes of a leaf.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Inner { left: u32, right: u32 },
    Leaf { first: u32, count: u32 },
}

/// The tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<(Bounds, Kind)>,
    order: Vec<u32>,
}

const LEAF: usize = 3;

impl Tree {
    /// The tree of shapes with these bounds; halved at the median along the longest side.
    pub(super) fn new(bounds: &[Bounds]) -> Self {
        let mut tree = Tree { nodes: Vec::new(), order: (0..bounds.len() as u32).collect() };
        if !bounds.is_empty() {
            tree.split(bounds, 0, bounds.len());
        }
        tree
    }

    fn split(&mut self, bounds: &[Bounds], first: usize, end: usize) -> u32 {
        let node = self.nodes.len() as u32;
        let shapes = &mut self.order[first..end];
        let all = shapes.iter().map(|&k| bounds[k as usize]).fold(Bounds::EMPTY, Bounds::join);
        self.nodes.push((all, Kind::Leaf { first: first as u32, count: (end - first) as u32 }));
        if end - first > LEAF {
            let axis = (all.high - all.low).imax();
            let place = |k: u32| bounds[k as usize].center()[axis];
            shapes.sort_by(|&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
            let middle = first + (end - first) / 2;
            let left = self.split(bounds, first, middle);
            let right = self.split(bounds, middle, end);
            self.nodes[node as usize].1 = Kind::Inner { left, right };
        }
        node
    }

    /// The nearest hit: `hit(k, most)` gives that of shape `k` if it is nearer than `most`.
    pub(super) fn nearest(&self, ray: &Ray, hit: impl Fn(usize, f64) -> Option<f64>) -> Option<(usize, f64)> {
        let inverse = ray.direction.map(|x| 1.0 / x);
        let (mut best, mut most) = (None, f64::INFINITY);
        let mut open = [(0.0, 0u32); 64];
        let mut count = 0;
        if let Some(enter) = self.nodes.first().and_then(|n| n.0.entry(&ray.origin, &inverse, most)) {
            open[0] = (enter, 0);
            count = 1;
        }
        while count > 0 {
            count -= 1;
            let (enter, node) = open[count];
            if enter > most {
                continue;
            }
            match self.nodes[node as usize].1 {
                Kind::Leaf { first, count: n } => {
                    for &k in &self.order[first as usize..(first + n) as usize] {
                        if let Some(t) = hit(k as usize, most)
                            && t < most
                        {
                            (best, most) = (Some((k as usize, t)), t);
                        }
                    }
                }
                Kind::Inner { left, right } => {
                    let enter = |k: u32| Some((self.nodes[k as usize].0.entry(&ray.origin, &inverse, most)?, k));
                    let (mut near, mut far) = (enter(left), enter(right));
                    if let (Some(l), Some(r)) = (near, far)
                        && r.0 < l.0
                    {
                        (near, far) = (Some(r), Some(l));
                    }
                    for child in [far, near].into_iter().flatten() {
                        open[count] = child;
                        count += 1;
                    }
                }
            }
        }
        best
    }
}
