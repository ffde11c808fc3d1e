//! The chain bound: a lattice vector is no longer than the shortest chain of links between its ends.
//!
//! **Bound.** On the periodic graph of rings, a link of rings a, b weighs R_a + R_b − r_a − r_b, and two rings of one
//! element are joined by a rigid edge of weight |o_a − o_b|, o being their offsets. By the lemma of
//! [`crate::bound`] an edge's weight is the most that the ring centres at its ends can be apart. A walk of length d
//! from a ring to its own image at the lattice vector v therefore proves |F v| ≤ d, that is
//!
//! (1 + l1)² (v·D)² + (1 + l2)² (v·D⊥)² ≤ d².
//!
//! **Completeness.** Infinitely many walks, finitely many that matter. A closed walk of the quotient graph falls apart
//! into simple cycles (no ring twice) with Σ v_k = v and Σ d_k = d, and |F v| ≤ Σ |F v_k| ≤ Σ d_k: what the simple cycles
//! prove implies the rest. With x = v/d each says |F x| ≤ 1, a convex condition on x: it holds on the polygon
//! K = conv{x of all cycles} iff it holds at K's vertices. The support function of K, max p·v/d over cycles, is a
//! largest-ratio cycle problem, solved exactly by raising the ratio λ until p·v − λ d has no positive cycle
//! (Bellman–Ford). So the vertices are found by asking for the normal of every edge of the polygon known so far, until
//! no edge can be moved outward: no window of lattice vectors, nothing left out.
//!
//! **Cells.** In a supercell the cycles of the primitive cell appear repeated, with x unchanged, and each of its cycles is
//! a closed walk of the primitive cell: K, and with it the bound, is the same for every cell and basis of the sheet.

use super::outcome::{BindingChain, Bound, BoundKind};
use crate::{
    lattice::{ACROSS, Direction, Shift},
    model::Model,
};
use nalgebra::Vector2;

/// A chain that no other chain makes superfluous: a vertex of K.
#[derive(Clone, Debug)]
struct Vertex {
    chain: BindingChain,
    /// v/d in the reference lattice.
    x: Vector2<f64>,
}

/// The chain bound of one design; computing it once takes micro- to milliseconds, a query much less.
#[derive(Clone, Debug)]
pub struct ChainBound {
    vertices: Vec<Vertex>,
}

/// Two chains whose directions differ by a smaller sine are taken as parallel.
const PARALLEL: f64 = 1e-9;
/// Excess of (1 + l2) |v·D⊥| over d(v), relative to d(v), that is no rounding error.
const EXCESS: f64 = 1e-12;

impl ChainBound {
    /// Finds the chains that can bind.
    pub fn new(model: &Model) -> Self {
        let graph = RingGraph::new(model);
        let mut vertices = Vec::new();
        let axes = [Vector2::x(), Vector2::y()];
        if let Some(first) = axes.iter().find_map(|p| graph.farthest(p, 0.0)) {
            // The farthest along its own direction, so that a K without width ends there too.
            let along = first.x.normalize();
            let first = graph.farthest(&along, along.dot(&first.x)).unwrap_or(first);
            let left = Vector2::new(-first.x.y, first.x.x).normalize();
            if let Some(second) = graph.farthest(&left, 0.0) {
                let opposite = Vertex { chain: first.chain.clone(), x: -first.x };
                graph.refine(&first, &second, &mut vertices);
                vertices.push(second.clone());
                graph.refine(&second, &opposite, &mut vertices);
            }
            vertices.push(first);
        }
        ChainBound { vertices }
    }

    /// The chains that can bind.
    pub fn chains(&self) -> impl Iterator<Item = &BindingChain> {
        self.vertices.iter().map(|v| &v.chain)
    }

    /// x = v/d of the chains that can bind: |F x| ≤ 1 for each of them.
    pub(crate) fn directions(&self) -> impl Iterator<Item = Vector2<f64>> {
        self.vertices.iter().map(|v| v.x)
    }

    /// A stretch that no line in the sheet exceeds; infinite where all chains are parallel.
    ///
    /// With two chains e = α x + β x′ for a unit vector e, so |F e| ≤ |α| + |β|.
    pub(crate) fn largest_stretch(&self) -> f64 {
        let mut least = f64::INFINITY;
        for (k, a) in self.vertices.iter().enumerate() {
            for b in &self.vertices[..k] {
                let det = a.x.x * b.x.y - a.x.y * b.x.x;
                if det.abs() > PARALLEL * a.x.norm() * b.x.norm() {
                    // |α|, |β| ≤ |x′|/|det|, |x|/|det|.
                    least = least.min((a.x.norm() + b.x.norm()) / det.abs());
                }
            }
        }
        least
    }

    /// The bound of l1 along a direction with l2 held.
    pub fn limit(&self, direction: Direction, l2: f64) -> Bound {
        let (along, across) = (direction.along(), direction.across());
        let mut best: Option<(f64, &Vertex)> = None;
        let mut worst: Option<(f64, &Vertex)> = None;
        for vertex in &self.vertices {
            let used = (1.0 + l2) * vertex.x.dot(&across).abs();
            if used > 1.0 + EXCESS && worst.is_none_or(|(most, _)| used > most) {
                worst = Some((used, vertex));
            }
            let reach = vertex.x.dot(&along).abs();
            if reach > ACROSS * vertex.x.norm() {
                // (1 − used)(1 + used) keeps the digits that 1 − used² would lose.
                let l1 = ((1.0 - used) * (1.0 + used)).max(0.0).sqrt() / reach - 1.0;
                if best.is_none_or(|(least, _)| l1 < least) {
                    best = Some((l1, vertex));
                }
            }
        }
        let kind = BoundKind::Chain;
        match (worst, best) {
            (Some((_, vertex)), _) => {
                Bound::L2Unreachable { kind, chain: Some(vertex.chain.clone()), dual: Vec::new() }
            }
            (None, Some((l1, vertex))) => {
                Bound::Finite { l1, kind, chain: Some(vertex.chain.clone()), dual: Vec::new() }
            }
            (None, None) => Bound::Unbounded,
        }
    }

    /// The largest l2 that the chains allow with this direction, at any l1; infinite where none binds across it.
    pub fn most_l2(&self, direction: Direction) -> f64 {
        let across = direction.across();
        self.vertices.iter().map(|v| 1.0 / v.x.dot(&across).abs() - 1.0).fold(f64::INFINITY, f64::min)
    }
}

/// An edge of the periodic graph, from a ring of the main cell to one of the image `shift`.
struct Edge {
    from: usize,
    to: usize,
    shift: Shift,
    /// The image's translation in the reference lattice.
    vector: Vector2<f64>,
    length: f64,
}

struct RingGraph {
    n_rings: usize,
    edges: Vec<Edge>,
}

impl RingGraph {
    fn new(model: &Model) -> Self {
        let mut graph = RingGraph { n_rings: model.rings.len(), edges: Vec::new() };
        for link in &model.links {
            let (a, b) = (link.pair.ring_a, link.pair.ring_b);
            let length = model.rings[a].major_radius + model.rings[b].major_radius - model.contact_distance(a, b);
            graph.join(model, a, b, link.pair.shift, length);
        }
        for element in &model.elements {
            for a in element.rings.clone() {
                for b in a + 1..element.rings.end {
                    graph.join(model, a, b, [0, 0], (model.rings[a].offset - model.rings[b].offset).norm());
                }
            }
        }
        graph
    }

    fn join(&mut self, model: &Model, a: usize, b: usize, shift: Shift, length: f64) {
        let vector = model.start.translation(shift).xy();
        self.edges.push(Edge { from: a, to: b, shift, vector, length });
        self.edges.push(Edge { from: b, to: a, shift: shift.map(|s| -s), vector: -vector, length });
    }

    /// Adds the vertices of K that lie beyond the edge from `a` to `b` (counter-clockwise), in order.
    fn refine(&self, a: &Vertex, b: &Vertex, out: &mut Vec<Vertex>) {
        let edge = b.x - a.x;
        let Some(normal) = Vector2::new(edge.y, -edge.x).try_normalize(0.0) else { return };
        if let Some(beyond) = self.farthest(&normal, normal.dot(&a.x).max(normal.dot(&b.x))) {
            self.refine(a, &beyond, out);
            out.push(beyond.clone());
            self.refine(&beyond, b, out);
        }
    }

    /// The cycle of largest p·v/d, if it exceeds `floor`: λ rises from one positive cycle of p·v − λ d to the next.
    fn farthest(&self, p: &Vector2<f64>, floor: f64) -> Option<Vertex> {
        let (mut ratio, mut found) = (floor, None);
        while let Some(vertex) = self.positive_cycle(p, ratio) {
            let higher = p.dot(&vertex.x);
            // What is left is rounding: a vertex that stands out by less would not change the bound's digits.
            if higher <= ratio + 4.0 * f64::EPSILON * vertex.x.norm() {
                break;
            }
            (ratio, found) = (higher, Some(vertex));
        }
        found
    }

    /// Some cycle with p·v − λ d > 0, by longest walks from everywhere (Bellman–Ford).
    fn positive_cycle(&self, p: &Vector2<f64>, ratio: f64) -> Option<Vertex> {
        let gains: Vec<f64> = self.edges.iter().map(|e| p.dot(&e.vector) - ratio * e.length).collect();
        let noise = 1e-15 * self.edges.iter().map(|e| p.dot(&e.vector).abs() + ratio * e.length).fold(0.0, f64::max);
        let mut height = vec![0.0; self.n_rings];
        let mut through: Vec<Option<usize>> = vec![None; self.n_rings];
        for _ in 0..self.n_rings {
            let mut risen = None;
            for (k, edge) in self.edges.iter().enumerate() {
                if height[edge.from] + gains[k] > height[edge.to] + noise {
                    height[edge.to] = height[edge.from] + gains[k];
                    through[edge.to] = Some(k);
                    risen = Some(edge.to);
                }
            }
            // A walk that is longer than there are rings has a cycle behind it.
            let at = risen?;
            if let Some(cycle) = self.cycle_behind(at, &through) {
                return Some(self.vertex(&cycle));
            }
        }
        None
    }

    /// The cycle met when walking back from `at`, edges in walking order, if there is one.
    fn cycle_behind(&self, at: usize, through: &[Option<usize>]) -> Option<Vec<usize>> {
        let mut ring = at;
        for _ in 0..self.n_rings {
            ring = self.edges[through[ring]?].from;
        }
        let (first, mut cycle) = (ring, Vec::new());
        loop {
            let k = through[ring]?;
            cycle.push(k);
            ring = self.edges[k].from;
            if ring == first {
                cycle.reverse();
                return Some(cycle);
            }
        }
    }

    fn vertex(&self, cycle: &[usize]) -> Vertex {
        let mut at = [0, 0];
        let mut rings = vec![(self.edges[cycle[0]].from, at)];
        let mut length = 0.0;
        let mut vector = Vector2::zeros();
        for &k in cycle {
            let edge = &self.edges[k];
            at = [at[0] + edge.shift[0], at[1] + edge.shift[1]];
            rings.push((edge.to, at));
            length += edge.length;
            vector += edge.vector;
        }
        Vertex { x: vector / length, chain: BindingChain { vector: at, length, rings } }
    }
}
