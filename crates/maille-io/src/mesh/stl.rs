//! Binary STL: triangles of all rings. The format has no unit; the numbers are millimetres.

use super::{number::singles, scene::Scene};
use std::io::{self, Write};

pub(super) fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    // "solid" at the beginning would mean the text variant.
    let mut header = format!("maille {}, unit mm", scene.name).into_bytes();
    header.resize(80, b' ');
    out.write_all(&header)?;
    out.write_all(&(scene.triangle_count() as u32).to_le_bytes())?;
    let mut facet = [0; 50];
    for ring in scene.rings() {
        let shape = &scene.shapes[ring.shape];
        let points: Vec<_> = shape.vertices.iter().map(|v| scene.in_file(&ring, v)).collect();
        for corners in shape.triangles() {
            let [a, b, c] = corners.map(|i| points[i]);
            let normal = (b - a).cross(&(c - a)).normalize();
            let numbers = [normal, a, b, c].map(|v| singles(&v));
            for (bytes, number) in facet.chunks_exact_mut(4).zip(numbers.as_flattened()) {
                bytes.copy_from_slice(&number.to_le_bytes());
            }
            out.write_all(&facet)?;
        }
    }
    Ok(())
}
