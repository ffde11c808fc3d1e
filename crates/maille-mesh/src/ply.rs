//! Binary PLY: triangles of all rings, with colours. The numbers are millimetres.

use super::{
    colour::{self, Colours},
    number::singles,
    scene::Scene,
};
use std::io::{self, Write};

pub(super) fn write(scene: &Scene, colours: Colours, out: &mut impl Write) -> io::Result<()> {
    let triangles = scene.triangle_count();
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment {}\ncomment unit mm\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {triangles}\nproperty list uchar int vertex_indices\nend_header\n",
        scene.description.replace(['\r', '\n'], " "),
        triangles / 2,
    )?;
    let colours = colour::of_members(scene, colours);
    for ring in scene.rings() {
        for vertex in &scene.shapes[ring.shape].vertices {
            for number in singles(&scene.in_file(&ring, vertex)) {
                out.write_all(&number.to_le_bytes())?;
            }
            out.write_all(&colours[ring.placed.member].srgb)?;
        }
    }
    let mut first = 0;
    for ring in scene.rings() {
        let shape = &scene.shapes[ring.shape];
        for corners in shape.triangles() {
            out.write_all(&[3])?;
            for corner in corners {
                out.write_all(&((first + corner) as i32).to_le_bytes())?;
            }
        }
        first += shape.vertices.len();
    }
    Ok(())
}
