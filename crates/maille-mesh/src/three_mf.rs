//! 3MF: each torus stored once, placed by transforms, in millimetres.
//!
//! The package is the least that the core specification 1.3 asks for. Objects are placed from the origin into the positive
//! octant, as the specification recommends.

use super::{number::singles, scene::Scene};
use nalgebra::{Isometry3, Translation3, Vector3};
use std::io::{self, Seek, Write};
use zip::{CompressionMethod, ZipWriter, write::SimpleFileOptions};

/// What is one object of a 3MF file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Objects {
    /// Each element, its rings as components.
    #[default]
    Element,
    /// Each ring.
    Ring,
    /// The whole tile, its rings as components: slicers keep their places.
    Sheet,
}

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;

const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

pub(super) fn write(scene: &Scene, objects: Objects, out: &mut (impl Write + Seek)) -> io::Result<()> {
    let mut zip = ZipWriter::new(out);
    // No time of day: the same scene gives the same bytes.
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    zip.start_file("[Content_Types].xml", options)?;
    zip.write_all(CONTENT_TYPES.as_bytes())?;
    zip.start_file("_rels/.rels", options)?;
    zip.write_all(RELATIONSHIPS.as_bytes())?;
    zip.start_file("3D/3dmodel.model", options.large_file(true))?;
    let mut model = io::BufWriter::with_capacity(1 << 16, &mut zip);
    write_model(scene, objects, &mut model)?;
    model.flush()?;
    drop(model);
    zip.finish()?;
    Ok(())
}

fn write_model(scene: &Scene, objects: Objects, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n\
         <metadata name=\"Title\">{}</metadata>\n<metadata name=\"Description\">{}</metadata>\n\
         <metadata name=\"Application\">maille {}</metadata>\n<resources>",
        escaped(&scene.name),
        escaped(&scene.description),
        env!("CARGO_PKG_VERSION"),
    )?;
    for (id, shape) in scene.shapes.iter().enumerate() {
        let (big, small) = (shape.major_radius as f32, shape.minor_radius as f32);
        writeln!(out, "<object id=\"{}\" type=\"model\" name=\"ring R {big} r {small}\"><mesh>\n<vertices>", id + 1)?;
        for vertex in &shape.vertices {
            let [x, y, z] = singles(vertex);
            writeln!(out, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")?;
        }
        writeln!(out, "</vertices>\n<triangles>")?;
        for [a, b, c] in shape.triangles() {
            writeln!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>")?;
        }
        writeln!(out, "</triangles></mesh></object>")?;
    }
    let first = scene.shapes.len() + 1;
    match objects {
        Objects::Ring => {}
        Objects::Element => {
            for (id, kind) in scene.kinds.iter().enumerate() {
                writeln!(
                    out,
                    "<object id=\"{}\" type=\"model\" name=\"{}\"><components>",
                    first + id,
                    escaped(&kind.name)
                )?;
                for ring in &kind.rings {
                    placed(out, "component", ring.shape + 1, &ring.local)?;
                }
                writeln!(out, "</components></object>")?;
            }
        }
        Objects::Sheet => {
            writeln!(out, "<object id=\"{first}\" type=\"model\" name=\"{}\"><components>", escaped(&scene.name))?;
            for ring in scene.rings() {
                placed(out, "component", ring.shape + 1, &ring.pose)?;
            }
            writeln!(out, "</components></object>")?;
        }
    }
    writeln!(out, "</resources>\n<build>")?;
    let move_in = Translation3::from(-scene.origin);
    match objects {
        Objects::Ring => {
            for ring in scene.rings() {
                placed(out, "item", ring.shape + 1, &(move_in * ring.pose))?;
            }
        }
        Objects::Element => {
            for element in &scene.elements {
                placed(out, "item", first + element.kind, &(move_in * element.pose))?;
            }
        }
        Objects::Sheet => placed(out, "item", first, &Isometry3::from(move_in))?,
    }
    writeln!(out, "</build>\n</model>")
}

/// An object with its transform: a 4 × 3 matrix for row vectors, so the images of x, y, z and the origin in turn.
fn placed(out: &mut impl Write, tag: &str, object: usize, pose: &Isometry3<f64>) -> io::Result<()> {
    write!(out, "<{tag} objectid=\"{object}\" transform=\"")?;
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| pose.rotation * axis);
    let rows = [axes[0], axes[1], axes[2], pose.translation.vector].map(|v| singles(&v));
    for (k, number) in rows.as_flattened().iter().enumerate() {
        write!(out, "{}{number}", if k == 0 { "" } else { " " })?;
    }
    writeln!(out, "\"/>")
}

/// Text of an XML element or attribute; characters that XML lacks are left out.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}
