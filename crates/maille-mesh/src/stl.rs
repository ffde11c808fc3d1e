//! Binary STL: triangles of all rings, but for those of which two corners are one point. The format has no unit; the numbers are millimetres.

use super::{number::singles, scene::Scene, torus::TorusMesh};
use std::io::{self, Write};

pub(super) fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    // "solid" at the beginning would mean the text variant.
    let mut header = format!("maille {}, unit mm", scene.name).into_bytes();
    header.resize(80, b' ');
    out.write_all(&header)?;
    let has_area = |shape: &TorusMesh, [a, b, c]: [usize; 3]| {
        let [a, b, c] = [a, b, c].map(|k| shape.vertices[k]);
        a != b && b != c && c != a
    };
    let of_shape = |shape: &TorusMesh| shape.triangles().filter(|corners| has_area(shape, *corners)).count();
    let counts: Vec<usize> = scene.shapes.iter().map(of_shape).collect();
    let count: usize = scene.rings().map(|ring| counts[ring.shape]).sum();
    out.write_all(&(count as u32).to_le_bytes())?;
    let mut facet = [0; 50];
    for ring in scene.rings() {
        let shape = &scene.shapes[ring.shape];
        let points: Vec<_> = shape.vertices.iter().map(|v| scene.in_file(&ring, v)).collect();
        for corners in shape.triangles().filter(|corners| has_area(shape, *corners)) {
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
