//! Wavefront OBJ: triangles of all rings, an object for each element. The numbers are millimetres.

use super::{number::singles, scene::Scene};
use std::io::{self, Write};

pub(super) fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "# {}\n# unit mm", scene.description.replace(['\r', '\n'], " "))?;
    let (mut first, mut last) = (1, usize::MAX);
    for ring in scene.rings() {
        if ring.element != last {
            last = ring.element;
            let [i, j] = ring.placed.cell;
            // Spaces would end the name.
            let name = scene.kinds[ring.placed.kind].name.replace(char::is_whitespace, "_");
            writeln!(out, "o {name}@{i},{j}")?;
        }
        let shape = &scene.shapes[ring.shape];
        for vertex in &shape.vertices {
            let [x, y, z] = singles(&scene.in_file(&ring, vertex));
            writeln!(out, "v {x} {y} {z}")?;
        }
        for corners in shape.triangles() {
            let [a, b, c] = corners.map(|k| first + k);
            writeln!(out, "f {a} {b} {c}")?;
        }
        first += shape.vertices.len();
    }
    Ok(())
}
