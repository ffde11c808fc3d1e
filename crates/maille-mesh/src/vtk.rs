//! VTK XML poly data, as ParaView reads it: rings, poses and contacts, and a series of frames.
//!
//! Numbers follow the XML as raw bytes, so that a file is written as it is computed. The lengths are millimetres.

use super::{
    number::singles,
    scene::{PlacedRing, Scene},
};
use std::io::{self, Write};

/// Writes an array's bytes.
type Bytes<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + 'a>;

/// An array of the appended data: its place in the XML, and how its bytes are written.
struct Array<'a> {
    name: &'static str,
    kind: &'static str,
    components: usize,
    count: usize,
    bytes: Bytes<'a>,
}

impl<'a> Array<'a> {
    fn vectors<I: Iterator<Item = [f32; 3]>>(name: &'static str, count: usize, items: impl Fn() -> I + 'a) -> Self {
        let bytes = move |out: &mut dyn Write| {
            items().try_for_each(|v| v.iter().try_for_each(|x| out.write_all(&x.to_le_bytes())))
        };
        Array { name, kind: "Float32", components: 3, count, bytes: Box::new(bytes) }
    }

    fn floats<I: Iterator<Item = f64>>(name: &'static str, count: usize, items: impl Fn() -> I + 'a) -> Self {
        let bytes = move |out: &mut dyn Write| items().try_for_each(|x| out.write_all(&(x as f32).to_le_bytes()));
        Array { name, kind: "Float32", components: 1, count, bytes: Box::new(bytes) }
    }

    fn integers<I: Iterator<Item = usize>>(name: &'static str, count: usize, items: impl Fn() -> I + 'a) -> Self {
        let bytes = move |out: &mut dyn Write| items().try_for_each(|n| out.write_all(&(n as i32).to_le_bytes()));
        Array { name, kind: "Int32", components: 1, count, bytes: Box::new(bytes) }
    }

    fn byte_count(&self) -> usize {
        4 * self.components * self.count
    }
}

/// The file's sections in the order of the XML.
struct PolyData<'a> {
    points: Array<'a>,
    point_data: Vec<Array<'a>>,
    cell_data: Vec<Array<'a>>,
    /// `Verts` or `Polys`.
    cells: &'static str,
    connectivity: [Array<'a>; 2],
}

fn write_file(scene: &Scene, data: PolyData<'_>, out: &mut dyn Write) -> io::Result<()> {
    let (points, cells) = (data.points.count, data.connectivity[1].count);
    let (verts, polys) = if data.cells == "Verts" { (cells, 0) } else { (0, cells) };
    write!(
        out,
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n"
    )?;
    let text: Vec<String> = scene.description.bytes().chain([0]).map(|b| b.to_string()).collect();
    writeln!(
        out,
        "<DataArray type=\"String\" Name=\"description\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>",
        text.join(" ")
    )?;
    writeln!(
        out,
        "<DataArray type=\"Float64\" Name=\"mm_per_unit\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n</FieldData>",
        scene.mm
    )?;
    writeln!(
        out,
        "<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"{verts}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{polys}\">"
    )?;
    let mut offset = 0;
    let mut section = |tag: &str, arrays: &[&Array<'_>], out: &mut dyn Write| -> io::Result<()> {
        writeln!(out, "<{tag}>")?;
        for a in arrays {
            writeln!(
                out,
                "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{offset}\"/>",
                a.kind, a.name, a.components
            )?;
            offset += 8 + a.byte_count();
        }
        writeln!(out, "</{}>", tag.split(' ').next().unwrap_or_default())
    };
    section("PointData", &data.point_data.iter().collect::<Vec<_>>(), out)?;
    section("CellData", &data.cell_data.iter().collect::<Vec<_>>(), out)?;
    section("Points", &[&data.points], out)?;
    section(data.cells, &data.connectivity.iter().collect::<Vec<_>>(), out)?;
    write!(out, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
    let all = data.point_data.iter().chain(&data.cell_data).chain([&data.points]).chain(&data.connectivity);
    for array in all {
        out.write_all(&(array.byte_count() as u64).to_le_bytes())?;
        (array.bytes)(out)?;
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

/// Quadrilaterals of all rings; on each its ring, element, kind, cell and load.
pub(super) fn write_rings(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let count = scene.triangle_count() / 2;
    let shape = |k: usize| &scene.shapes[k];
    let repeated = move |value: fn(&Scene, &PlacedRing<'_>) -> usize| {
        move || scene.rings().flat_map(move |r| std::iter::repeat_n(value(scene, &r), shape(r.shape).quad_count()))
    };
    let mut cell_data = vec![
        Array::integers("ring", count, repeated(|_, r| r.ring)),
        Array::integers("element", count, repeated(|_, r| r.element)),
        Array::integers("kind", count, repeated(|_, r| r.placed.kind)),
        Array::integers("cell_1", count, repeated(|_, r| r.placed.cell[0] as usize)),
        Array::integers("cell_2", count, repeated(|_, r| r.placed.cell[1] as usize)),
    ];
    if let Some(loads) = &scene.loads {
        let items = move || {
            scene.rings().flat_map(move |r| std::iter::repeat_n(loads[r.placed.member], shape(r.shape).quad_count()))
        };
        cell_data.push(Array::floats("load", count, items));
    }
    let points = move || {
        scene.rings().flat_map(move |r| {
            shape(r.shape).vertices.iter().map(move |v| singles(&(r.pose.rotation * v + r.pose.translation.vector)))
        })
    };
    let normals = move || {
        scene.rings().flat_map(move |r| shape(r.shape).normals.iter().map(move |n| singles(&(r.pose.rotation * n))))
    };
    let corners = move || {
        scene
            .rings()
            .scan(0, move |first, r| {
                let begin = *first;
                *first += shape(r.shape).vertices.len();
                Some(shape(r.shape).quads().flatten().map(move |k| begin + k))
            })
            .flatten()
    };
    let data = PolyData {
        points: Array::vectors("Points", count, points),
        point_data: vec![Array::vectors("Normals", count, normals)],
        cell_data,
        cells: "Polys",
        connectivity: [
            Array::integers("connectivity", 4 * count, corners),
            Array::integers("offsets", count, move || (1..=count).map(|k| 4 * k)),
        ],
    };
    write_file(scene, data, out)
}

/// A vertex cell for each point.
fn vertices<'a>(count: usize) -> [Array<'a>; 2] {
    [Array::integers("connectivity", count, move || 0..count), Array::integers("offsets", count, move || 1..=count)]
}

/// A point for each ring: centre, normal, radii and ids, for glyphs and statistics.
pub(super) fn write_poses(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let count = scene.ring_count();
    let mut point_data = vec![
        Array::vectors("normal", count, || scene.rings().map(|r| singles(&(r.pose.rotation * nalgebra::Vector3::z())))),
        Array::floats("R", count, || scene.rings().map(|r| scene.shapes[r.shape].major_radius)),
        Array::floats("r", count, || scene.rings().map(|r| scene.shapes[r.shape].minor_radius)),
        Array::integers("ring", count, || scene.rings().map(|r| r.ring)),
        Array::integers("element", count, || scene.rings().map(|r| r.element)),
        Array::integers("kind", count, || scene.rings().map(|r| r.placed.kind)),
        Array::integers("cell_1", count, || scene.rings().map(|r| r.placed.cell[0] as usize)),
        Array::integers("cell_2", count, || scene.rings().map(|r| r.placed.cell[1] as usize)),
    ];
    if let Some(loads) = &scene.loads {
        point_data.push(Array::floats("load", count, || scene.rings().map(|r| loads[r.placed.member])));
    }
    let data = PolyData {
        points: Array::vectors("Points", count, || scene.rings().map(|r| singles(&r.pose.translation.vector))),
        point_data,
        cell_data: Vec::new(),
        cells: "Verts",
        connectivity: vertices(count),
    };
    write_file(scene, data, out)
}

/// A point for each contact, with the force on ring B per unit of pull.
pub(super) fn write_contacts(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let contacts = &scene.contacts;
    let count = contacts.len();
    let data = PolyData {
        points: Array::vectors("Points", count, || contacts.iter().map(|c| singles(&c.point))),
        point_data: vec![
            Array::vectors("force", count, || contacts.iter().map(|c| singles(&c.force))),
            Array::floats("force_magnitude", count, || contacts.iter().map(|c| c.force.norm())),
            Array::integers("ring_a", count, || contacts.iter().map(|c| c.ring_a)),
            Array::integers("ring_b", count, || contacts.iter().map(|c| c.ring_b)),
            Array::integers("cell_1", count, || contacts.iter().map(|c| c.cell[0] as usize)),
            Array::integers("cell_2", count, || contacts.iter().map(|c| c.cell[1] as usize)),
            Array::integers("inside", count, || contacts.iter().map(|c| usize::from(c.inside))),
        ],
        cell_data: Vec::new(),
        cells: "Verts",
        connectivity: vertices(count),
    };
    write_file(scene, data, out)
}

/// A series for ParaView: time, part and file name (beside the series) of each file.
pub fn write_pvd(files: &[(f64, usize, String)]) -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, part, file) in files {
        let file = file.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        out += &format!("<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>\n");
    }
    out + "</Collection>\n</VTKFile>\n"
}
