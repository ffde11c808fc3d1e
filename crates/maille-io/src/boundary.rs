//! The surface of attainable strains as files: a journal that a run goes on from, a table, and meshes.
//!
//! Meshes have E_xx, E_yy and E_xy as coordinates. The colours of the PLY file tell the status.

mod folder;
mod journal;

pub use self::folder::{SURFACE_STATES, SurfaceRecord, open_surface, surface_states};
pub use self::journal::{SURFACE, SurfaceFolder, read_surface, surface_head, surface_line, write_surface};

use crate::record::{csv_number, csv_text};
use maille::{
    record::Status,
    survey::surface::{Boundary, BoundaryVertex},
};
use serde_json::{Value, json};
use std::fmt::Write;

/// A vertex's point; none where nothing was found.
pub(crate) fn point(vertex: &BoundaryVertex) -> Option<[f64; 3]> {
    Some(vertex.point(vertex.distance?))
}

/// Columns of the table: name, type, unit (1: a strain or another number without one), and meaning.
const COLUMNS: [(&str, &str, Option<&str>, &str); 13] = [
    ("vertex", "count", None, "number of the vertex, from 0"),
    ("direction_xx", "number", Some("1"), "exx of the ray's unit vector"),
    ("direction_yy", "number", Some("1"), "eyy of the ray's unit vector"),
    ("direction_xy", "number", Some("1"), "exy of the ray's unit vector"),
    ("status", "text", None, "how sure the end of the ray is, or why there is none"),
    ("distance", "number", Some("1"), "distance of the end of the ray from the sheet in the file"),
    ("exx", "number", Some("1"), "Green strain along x at the end of the ray"),
    ("eyy", "number", Some("1"), "Green strain along y at the end of the ray"),
    ("exy", "number", Some("1"), "tensor shear at the end of the ray"),
    ("bound", "number", Some("1"), "proven bound of the distance"),
    ("n_distinct", "count", None, "number of distinct certified values"),
    ("wave_curvature", "number", Some("1"), "least curvature found on waves through the sheet"),
    ("cell", "text", None, "cell in which the end of the ray was found"),
];

/// The table as JSON, with `columns` and `rows` as other tables have them: the first `most` rows.
pub fn boundary_json(boundary: &Boundary, most: usize) -> String {
    let column = |(name, kind, unit, meaning): &(&str, &str, Option<&str>, &str)| json!({ "name": name, "type": kind, "unit": unit, "meaning": meaning });
    let row = |(k, v): (usize, &BoundaryVertex)| {
        let ([x, y, z], at) = (v.direction, v.distance.map(|distance| v.point(distance)));
        let [exx, eyy, exy] = std::array::from_fn(|i| at.map(|p| p[i]));
        let values: [Value; COLUMNS.len()] = [
            json!(k),
            json!(x),
            json!(y),
            json!(z),
            json!(v.status.name()),
            json!(v.distance),
            json!(exx),
            json!(eyy),
            json!(exy),
            json!(v.bound),
            json!(v.n_distinct),
            json!(v.wave_curvature),
            json!(v.cell.to_string()),
        ];
        Value::Object(COLUMNS.iter().map(|(name, ..)| (*name).to_owned()).zip(values).collect())
    };
    let lines = |values: Vec<Value>| {
        let lines: Vec<String> = values.iter().map(|value| format!("    {value}")).collect();
        if lines.is_empty() { "[]".to_owned() } else { format!("[\n{}\n  ]", lines.join(",\n")) }
    };
    let rows = boundary.vertices.iter().enumerate().take(most).map(row).collect();
    format!("{{\n  \"columns\": {},\n  \"rows\": {}\n}}\n", lines(COLUMNS.iter().map(column).collect()), lines(rows))
}

/// The table: a line a vertex.
pub fn boundary_csv(boundary: &Boundary) -> String {
    let mut out = COLUMNS.map(|(name, ..)| name).join(",") + "\n";
    for (k, v) in boundary.vertices.iter().enumerate() {
        let [x, y, z] = v.direction;
        let at = v.distance.map(|distance| v.point(distance));
        let [exx, eyy, exy] = std::array::from_fn(|i| csv_number(at.map(|p| p[i])));
        let (distance, bound) = (csv_number(v.distance), csv_number(v.bound));
        let (status, distinct, cell) = (v.status.name(), v.n_distinct, csv_text(&v.cell.to_string()));
        let wave = csv_number(v.wave_curvature);
        let _ = writeln!(
            out,
            "{k},{x:?},{y:?},{z:?},{status},{distance},{exx},{eyy},{exy},{bound},{distinct},{wave},{cell}"
        );
    }
    out
}

/// Triangles whose corners all have a point.
pub(crate) fn triangles(boundary: &Boundary) -> impl Iterator<Item = &[usize; 3]> {
    let there = |k: &usize| boundary.vertices.get(*k).is_some_and(|vertex| vertex.distance.is_some());
    boundary.triangles.iter().filter(move |corners| corners.iter().all(there))
}

/// The vertices that have a point, with it, and the triangles that count among them: a ray that was not reached is a hole.
struct Mesh<'a> {
    vertices: Vec<(&'a BoundaryVertex, [f64; 3])>,
    triangles: Vec<[usize; 3]>,
}

fn mesh(boundary: &Boundary) -> Mesh<'_> {
    let mut numbers = vec![0; boundary.vertices.len()];
    let mut vertices = Vec::new();
    for (number, vertex) in numbers.iter_mut().zip(&boundary.vertices) {
        *number = vertices.len();
        vertices.extend(point(vertex).map(|at| (vertex, at)));
    }
    let triangles = triangles(boundary).map(|corners| corners.map(|k| numbers[k])).collect();
    Mesh { vertices, triangles }
}

/// Wavefront OBJ.
pub fn boundary_obj(boundary: &Boundary, description: &str) -> String {
    let mut out = format!("# {}\n# coordinates exx eyy exy (Green strain, tensor shear)\n", one_line(description));
    let Mesh { vertices, triangles } = mesh(boundary);
    for (_, [x, y, z]) in vertices {
        let _ = writeln!(out, "v {x} {y} {z}");
    }
    for [a, b, c] in triangles {
        let _ = writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    out
}

/// PLY in text, with the proven bound of each vertex's distance from the origin (−1 where none is known) and a colour for its
/// status.
pub fn boundary_ply(boundary: &Boundary, description: &str) -> String {
    let Mesh { vertices, triangles } = mesh(boundary);
    let mut out = format!(
        "ply\nformat ascii 1.0\ncomment {}\ncomment coordinates exx eyy exy (Green strain, tensor shear)\n\
         comment bound: proven bound of the distance from the origin along the ray; -1: none is known\n\
         element vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty double bound\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        one_line(description),
        vertices.len(),
        triangles.len(),
    );
    for (vertex, [x, y, z]) in vertices {
        let [r, g, b] = colour(vertex.status);
        let _ = writeln!(out, "{x} {y} {z} {} {r} {g} {b}", vertex.bound.unwrap_or(-1.0));
    }
    for [a, b, c] in triangles {
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

#[cfg(test)]
mod tests {
    use super::*;
    use maille::lattice::Cell;

    fn vertex(direction: [f64; 3], distance: Option<f64>, bound: Option<f64>) -> BoundaryVertex {
        let status = if distance.is_some() { Status::Local } else { Status::L2NotReached };
        let (lattice, poses) = ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], Vec::new());
        BoundaryVertex {
            direction,
            status,
            distance,
            bound,
            n_distinct: 0,
            wave_curvature: None,
            cell: Cell::PRIMITIVE,
            lattice,
            poses,
        }
    }

    #[test]
    fn an_unreached_ray_is_a_hole() {
        let vertices = vec![
            vertex([1.0, 0.0, 0.0], None, None),
            vertex([0.0, 1.0, 0.0], Some(0.5), None),
            vertex([0.0, 0.0, 1.0], Some(0.25), Some(0.75)),
            vertex([-1.0, 0.0, 0.0], Some(0.125), None),
        ];
        let triangles = vec![[0, 1, 2], [1, 3, 2], [0, 2, 3], [0, 3, 1]];
        let surface = Boundary { vertices, triangles, arch: 0.0, open: 0, jumps: 0, complete: true };
        let obj = boundary_obj(&surface, "a");
        assert_eq!(obj.lines().skip(2).collect::<Vec<_>>(), ["v 0 0.5 0", "v 0 0 0.25", "v -0.125 0 0", "f 1 3 2"]);
        let ply = boundary_ply(&surface, "a");
        assert!(ply.contains("element vertex 3\n") && ply.contains("element face 1\n"));
        assert!(ply.contains("0 0.5 0 -1 ") && ply.contains("0 0 0.25 0.75 ") && ply.ends_with("3 0 2 1\n"));
        assert!(boundary_csv(&surface).contains("\n0,1.0,0.0,0.0,l2-not-reached,,,,,,0,,1x1\n"));
        let table: Value = serde_json::from_str(&boundary_json(&surface, 3)).unwrap();
        let names: Vec<&str> =
            table["columns"].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap()).collect();
        assert_eq!(boundary_csv(&surface).lines().next(), Some(names.join(",").as_str()));
        let rows = table["rows"].as_array().unwrap();
        assert_eq!((rows.len(), &rows[0]["exx"], &rows[2]["exy"]), (3, &Value::Null, &json!(0.25)));
        assert_eq!((&rows[2]["bound"], &rows[2]["cell"]), (&json!(0.75), &json!("1x1")));
        assert!(names.iter().all(|name| rows[0].get(name).is_some()));
    }
}
