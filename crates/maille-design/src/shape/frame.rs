//! Cages: struts between vertices, as closed curves.
//!
//! A frame becomes the closed curves of a basis of its cycles: a breadth-first tree from vertex 0 that takes struts in the order in which they are
//! written, and for each strut that is not in it, in order, the strut with the way back through the tree. What is linked with the
//! frame is linked with one of these. Struts that are on no cycle follow, each as a curve there and back.

use super::core::{CorePieces, CurveKind, MOST_PIECES, Owned};
use maille_geometry::{Piece, Segment, Vec3};
use std::collections::{BTreeSet, VecDeque};

/// What is wrong with a frame.
pub(super) fn problem(vertices: &[[f64; 3]], edges: &[[u32; 2]]) -> Option<(String, String, &'static str)> {
    if edges.is_empty() || edges.len() > MOST_PIECES / 2 {
        let problem = format!("{} edges", edges.len());
        return Some(("edges".into(), problem, "a frame has 1 edge or more, at most 5000"));
    }
    let mut known = BTreeSet::new();
    for (k, &[a, b]) in edges.iter().enumerate() {
        let field = format!("edges[{k}]");
        if let Some(wrong) = [a, b].into_iter().find(|v| *v as usize >= vertices.len()) {
            let problem = format!("there is no vertex {wrong}: the {} vertices count from 0", vertices.len());
            return Some((field, problem, "give the numbers of two vertices, as [0, 1]"));
        }
        if a == b || !known.insert([a.min(b), a.max(b)]) {
            let problem = if a == b { format!("[{a}, {b}] is no edge") } else { format!("[{a}, {b}] is there before") };
            return Some((field, problem, "join two vertices once"));
        }
        if vertices[a as usize] == vertices[b as usize] {
            return Some((field, format!("vertices {a} and {b} are one point"), "join two points that differ"));
        }
    }
    let tree = Tree::new(vertices.len(), edges);
    if let Some(alone) = tree.parent.iter().position(Option::is_none) {
        let problem = format!("no way along edges leads from vertex 0 to vertex {alone}");
        return Some(("edges".into(), problem, "join all vertices, or leave those out that are not joined"));
    }
    let way = |v: u32, edge: &[u32; 2]| {
        let other = if edge[0] == v { edge[1] } else { edge[0] };
        Vec3::from(vertices[other as usize]) - Vec3::from(vertices[v as usize])
    };
    for v in 0..vertices.len() as u32 {
        let at: Vec<usize> = (0..edges.len()).filter(|k| edges[*k].contains(&v)).collect();
        for (n, &i) in at.iter().enumerate() {
            for &j in &at[n + 1..] {
                if way(v, &edges[i]).angle(&way(v, &edges[j])) < 1e-3 {
                    let problem = format!("edges {i} and {j} leave vertex {v} the same way");
                    return Some((format!("edges[{j}]"), problem, "a strut cannot lie in another"));
                }
            }
        }
    }
    None
}

/// The struts, in order.
pub(super) fn struts(vertices: &[[f64; 3]], edges: &[[u32; 2]]) -> Option<Vec<Piece>> {
    let at = |v: u32| Vec3::from(vertices[v as usize]);
    edges.iter().map(|&[a, b]| Segment::new(at(a), at(b)).map(Piece::Segment)).collect()
}

/// A breadth-first tree from vertex 0.
struct Tree {
    /// The vertex before each, and the edge to it; of vertex 0 itself and no edge.
    parent: Vec<Option<(u32, Option<usize>)>>,
}

impl Tree {
    fn new(vertices: usize, edges: &[[u32; 2]]) -> Tree {
        let mut at = vec![Vec::new(); vertices];
        for (k, &[a, b]) in edges.iter().enumerate() {
            at[a as usize].push((b, k));
            at[b as usize].push((a, k));
        }
        let mut parent = vec![None; vertices];
        parent[0] = Some((0, None));
        let mut queue = VecDeque::from([0]);
        while let Some(v) = queue.pop_front() {
            for &(w, k) in &at[v as usize] {
                if parent[w as usize].is_none() {
                    parent[w as usize] = Some((v, Some(k)));
                    queue.push_back(w);
                }
            }
        }
        Tree { parent }
    }

    /// Vertices and edges from `v` up to vertex 0.
    fn up(&self, v: u32) -> Vec<(u32, Option<usize>)> {
        let mut out = vec![(v, None)];
        while let Some((next, Some(edge))) = self.parent[out[out.len() - 1].0 as usize] {
            out.push((next, Some(edge)));
        }
        out
    }

    /// The vertices of the way from `from` to `to`.
    fn way(&self, from: u32, to: u32) -> Vec<u32> {
        let vertices = |v: u32| self.up(v).into_iter().map(|(v, _)| v).collect::<Vec<_>>();
        let (up, mut down) = (vertices(from), vertices(to));
        // Both end at vertex 0; where they meet first is the last that they have in common from there.
        let common = up.iter().rev().zip(down.iter().rev()).take_while(|(a, b)| a == b).count();
        down.truncate(down.len() - common);
        up[..=up.len() - common].iter().copied().chain(down.into_iter().rev()).collect()
    }
}

/// The closed curves of a frame.
pub(super) fn cores(vertices: &[[f64; 3]], edges: &[[u32; 2]]) -> Option<Vec<CorePieces>> {
    let tree = Tree::new(vertices.len(), edges);
    let in_tree: BTreeSet<usize> = tree.parent.iter().filter_map(|parent| (*parent)?.1).collect();
    let chords = edges.iter().enumerate().filter(|(k, _)| !in_tree.contains(k)).map(|(_, edge)| edge);
    // Corners in order; the last is joined to the first.
    let mut walks: Vec<Vec<u32>> = chords.map(|&[a, b]| tree.way(b, a)).collect();
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let sides = |walk: &Vec<u32>| (0..walk.len()).map(|k| key(walk[k], walk[(k + 1) % walk.len()])).collect::<Vec<_>>();
    let on_cycles: BTreeSet<[u32; 2]> = walks.iter().flat_map(sides).collect();
    walks.extend(edges.iter().filter(|[a, b]| !on_cycles.contains(&key(*a, *b))).map(|edge| edge.to_vec()));
    let (mut edges_taken, mut vertices_taken) = (BTreeSet::new(), BTreeSet::new());
    let at = |v: u32| Vec3::from(vertices[v as usize]);
    let mut core = |walk: Vec<u32>| {
        let (mut pieces, mut owned) = (Vec::new(), Vec::new());
        for (k, &from) in walk.iter().enumerate() {
            let to = walk[(k + 1) % walk.len()];
            pieces.push(Piece::Segment(Segment::new(at(from), at(to))?));
            let inside = edges_taken.insert(key(from, to));
            let mut first = |v: u32| inside && vertices_taken.insert(v);
            owned.push(Owned { inside, start: first(from), end: first(to) });
        }
        Some(CorePieces { kind: CurveKind::Frame, pieces, owned, deviation: 0.0 })
    };
    walks.into_iter().map(&mut core).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> (Vec<[f64; 3]>, Vec<[u32; 2]>) {
        let axis = |k: usize| {
            let mut v = [0.0; 3];
            v[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            v
        };
        let pairs = (0..6).flat_map(|a| (a + 1..6).map(move |b| [a, b]));
        ((0..6).map(axis).collect(), pairs.filter(|[a, b]| a / 2 != b / 2).collect())
    }

    /// As many cycles as edges beyond a tree's, each strut and each vertex owned once, and curves that close.
    #[test]
    fn cycles_of_an_octahedron_and_of_a_frame_with_a_loose_end() {
        let (mut vertices, mut edges) = octahedron();
        for loose in [false, true] {
            if loose {
                vertices.push([2.0, 0.0, 0.0]);
                edges.push([0, 6]);
            }
            assert_eq!(problem(&vertices, &edges), None);
            let cores = cores(&vertices, &edges).unwrap();
            assert_eq!(cores.len(), 7 + usize::from(loose));
            let owned = || cores.iter().flat_map(|core| &core.owned);
            assert_eq!(owned().filter(|o| o.inside).count(), edges.len());
            let ends: usize = owned().map(|o| usize::from(o.start) + usize::from(o.end)).sum();
            assert_eq!(ends, vertices.len());
            for core in &cores {
                let n = core.pieces.len();
                assert!((0..n).all(|k| core.pieces[k].point(1.0) == core.pieces[(k + 1) % n].point(0.0)));
            }
        }
    }

    #[test]
    fn wrong_frames_are_named() {
        let (vertices, edges) = octahedron();
        let wrong = |edges: &[[u32; 2]], field: &str, words: &str| {
            let (name, problem, _) = problem(&vertices, edges).unwrap();
            assert!(name == field && problem.contains(words), "{name}: {problem}");
        };
        wrong(&[], "edges", "0 edges");
        wrong(&[[0, 6]], "edges[0]", "no vertex 6");
        wrong(&[[0, 2], [2, 0]], "edges[1]", "there before");
        wrong(&edges[..4], "edges", "no way along edges leads from vertex 0 to vertex 1");
        let (mut more, mut longer) = (vertices.clone(), edges.clone());
        more.push([2.0, -1.0, 0.0]);
        longer.push([3, 6]);
        assert_eq!(problem(&more, &longer), None);
        more[6] = [0.5, 0.5, 0.0];
        longer[12] = [0, 6];
        assert!(problem(&more, &longer).unwrap().1.contains("leave vertex 0 the same way"));
    }
}
