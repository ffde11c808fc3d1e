//! The surface of attainable strains as files: a journal that a run goes on from, a table, and meshes.
//!
//! Meshes have E_xx, E_yy and E_xy as coordinates. The colours of the PLY file tell the status.

use maille::{
    limit::boundary::{Boundary, BoundaryVertex},
    record::Status,
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt::Write};

/// First line of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundaryHead {
    /// Version of the program.
    pub program_version: String,
    /// Hash of design and parameters.
    pub input_hash: String,
    /// Name of the design.
    pub design: String,
}

/// The first line.
pub fn journal_head(head: &BoundaryHead) -> String {
    serde_json::to_string(head).unwrap_or_default() + "\n"
}

/// The line of a vertex.
pub fn journal_line(number: usize, vertex: &BoundaryVertex) -> String {
    serde_json::to_string(&(number, vertex)).unwrap_or_default() + "\n"
}

/// What a journal holds; a line that was cut off is left out. `None` where the first line is no head.
pub fn read_journal(text: &str) -> Option<(BoundaryHead, BTreeMap<usize, BoundaryVertex>)> {
    let mut lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
    let head = serde_json::from_str(lines.next()?).ok()?;
    Some((head, lines.map_while(|line| serde_json::from_str(line).ok()).collect()))
}

/// A vertex's point; the origin where nothing was found.
pub(crate) fn point(vertex: &BoundaryVertex) -> [f64; 3] {
    vertex.point(vertex.distance.unwrap_or_default())
}

/// The table: a line a vertex.
pub fn boundary_csv(boundary: &Boundary) -> String {
    let mut out =
        "vertex,direction_xx,direction_yy,direction_xy,status,distance,exx,eyy,exy,first_exit,bound,n_distinct\n"
            .to_owned();
    let cell = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:?}"));
    for (k, v) in boundary.vertices.iter().enumerate() {
        let [x, y, z] = v.direction;
        let at = v.distance.map(|distance| v.point(distance));
        let [exx, eyy, exy] = std::array::from_fn(|i| cell(at.map(|p| p[i])));
        let (distance, first, bound) = (cell(v.distance), cell(v.first), cell(v.bound));
        let (status, distinct) = (v.status.name(), v.n_distinct);
        let _ = writeln!(out, "{k},{x:?},{y:?},{z:?},{status},{distance},{exx},{eyy},{exy},{first},{bound},{distinct}");
    }
    out
}

/// Triangles whose corners were all solved.
pub(crate) fn triangles(boundary: &Boundary) -> impl Iterator<Item = &[usize; 3]> {
    boundary.triangles.iter().filter(|corners| corners.iter().all(|k| *k < boundary.vertices.len()))
}

/// Wavefront OBJ.
pub fn boundary_obj(boundary: &Boundary, description: &str) -> String {
    let mut out = format!("# {}\n# coordinates exx eyy exy (Green strain, tensor shear)\n", one_line(description));
    for vertex in &boundary.vertices {
        let [x, y, z] = point(vertex);
        let _ = writeln!(out, "v {x} {y} {z}");
    }
    for [a, b, c] in triangles(boundary) {
        let _ = writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    out
}

/// PLY in text, with distance and bound of each vertex and a colour for its status.
pub fn boundary_ply(boundary: &Boundary, description: &str) -> String {
    let count = triangles(boundary).count();
    let mut out = format!(
        "ply\nformat ascii 1.0\ncomment {}\ncomment coordinates exx eyy exy (Green strain, tensor shear)\n\
         element vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty double bound\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {count}\nproperty list uchar int vertex_indices\nend_header\n",
        one_line(description),
        boundary.vertices.len(),
    );
    for vertex in &boundary.vertices {
        let [x, y, z] = point(vertex);
        let [r, g, b] = colour(vertex.status);
        let _ = writeln!(out, "{x} {y} {z} {} {r} {g} {b}", vertex.bound.unwrap_or(-1.0));
    }
    for [a, b, c] in triangles(boundary) {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    out
}

/// Blue what is proved, ochre what is certified, grey the rest.
pub(crate) fn colour(status: Status) -> [u8; 3] {
    match status {
        Status::Global => [31, 119, 180],
        Status::Local => [222, 158, 54],
        _ => [140, 140, 140],
    }
}

fn one_line(text: &str) -> String {
    text.replace(['\r', '\n'], " ")
}
