//! Sheets to look at: pictures, and meshes for widgets.

use crate::{design::Design, error};
use maille::{
    model::Model,
    record::{ContactRecord, PoseRecord, StateRecord},
    state::State,
};
use maille_geometry::Vec3;
use maille_io::Tile;
use maille_mesh::{Fineness, Kind, Scene, state_of};
use maille_render::{ColorBy, Extent, Forces, RenderOptions, Subject, View, render};
use nalgebra::Isometry3;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::{prelude::*, types::PyBytes};
use serde::Deserialize;

/// A design in one state, compiled for its cell.
#[pyclass(frozen, module = "maille._native")]
pub struct Sheet {
    model: Model,
    state: State,
    contacts: Vec<ContactRecord>,
    unit: Option<String>,
}

/// What is read of a state.
#[derive(Deserialize)]
struct Document {
    #[serde(default)]
    a1: Option<[f64; 3]>,
    #[serde(default)]
    a2: Option<[f64; 3]>,
    poses: Vec<PoseRecord>,
    #[serde(default)]
    contacts: Vec<ContactRecord>,
}

/// Vertices and corners of triangles.
type Triangles = (Vec<[f32; 3]>, Vec<[u32; 3]>);
/// Triangles of one kind of element: its name, vertices (V, 3) and corners (T, 3).
type KindMesh<'py> = (String, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<u32>>);

#[pymethods]
impl Sheet {
    /// `state` is a document with `poses` of the elements of the cell (of a finite sheet: of all), and perhaps `a1`, `a2`
    /// and `contacts`, as records have them; without it, the start of the design.
    #[new]
    fn new(design: &Design, cell: &str, finite: bool, state: Option<&str>) -> PyResult<Self> {
        let cell = cell.parse().map_err(|e| error::invalid(&e))?;
        let design = design.tolerant();
        let model = if finite { design.compile_sheet(cell)? } else { design.compile(cell)? };
        let unit = design.design.unit.clone();
        let Some(text) = state else {
            return Ok(Self { state: model.start.clone(), model, contacts: Vec::new(), unit });
        };
        let wrong = |problem: String| error::argument("state", problem, "give one that maille has made");
        let Document { a1, a2, poses, contacts } = serde_json::from_str(text).map_err(|e| wrong(e.to_string()))?;
        let lattice = |a: Option<[f64; 3]>, start: Vec3| a.unwrap_or_else(|| (start * model.unit).into());
        let (a1, a2) = (lattice(a1, model.start.a1), lattice(a2, model.start.a2));
        let record = StateRecord { poses, a1, a2, ..StateRecord::default() };
        let state = state_of(&model, &record).map_err(|e| wrong(e.to_string()))?;
        Ok(Self { state, model, contacts, unit })
    }

    /// A picture as PNG, as `maille render` draws it.
    fn picture<'py>(
        &self,
        py: Python<'py>,
        tile: Option<[u32; 2]>,
        size: [u32; 2],
        view: &str,
        color: &str,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let wrong = |name: &str, problem: String| error::argument(name, problem, "see maille.show");
        let view: View = view.parse().map_err(|e: String| wrong("view", e))?;
        let color = match color {
            "element" => ColorBy::Element,
            "load" => ColorBy::Load,
            _ => return Err(wrong("color", format!("\"{color}\" is none; give element or load"))),
        };
        let extent = match tile {
            _ if !self.model.periodic => Extent::Cells([1, 1]),
            Some(tile) => Extent::Cells(tile),
            None => Extent::filling(size, view, self.model.unit),
        };
        let forces = if self.contacts.is_empty() { Forces::None } else { Forces::Arrows };
        let options = RenderOptions { size, view, color, forces, ..RenderOptions::new(extent) };
        let Self { model, state, contacts, unit } = self;
        let subject = Subject { model, state, contacts, unit: unit.as_deref() };
        let png = py.detach(|| render(&subject, &options).and_then(|picture| picture.to_png()));
        png.map(|png| PyBytes::new(py, &png)).map_err(|e| wrong("sheet", e.to_string()))
    }

    /// The tori of a piece of the sheet as triangles, in the file's unit: an entry for each kind of element. A torus has
    /// `around` times `across` quads.
    fn mesh<'py>(&self, py: Python<'py>, tile: [u32; 2], around: usize, across: usize) -> PyResult<Vec<KindMesh<'py>>> {
        let tile = if self.model.periodic { tile } else { [1, 1] };
        let fineness = Fineness::Segments(around, Some(across));
        let scene = Scene::new(&self.model, &self.state, Tile(tile), fineness, 1.0);
        let scene = scene.map_err(|e| error::argument("tile", e.to_string(), "show fewer cells"))?;
        let mut kinds: Vec<Triangles> = vec![(Vec::new(), Vec::new()); scene.kinds.len()];
        for ring in scene.rings() {
            let (vertices, triangles) = &mut kinds[ring.placed.kind];
            let first = vertices.len();
            let shape = &scene.shapes[ring.shape];
            vertices.extend(shape.vertices.iter().map(|v| placed(&ring.pose, v)));
            triangles.extend(shape.triangles().map(|corners| corners.map(|k| (first + k) as u32)));
        }
        let mesh = |(kind, (vertices, triangles)): (&Kind, Triangles)| {
            let (v, t) = (vertices.len(), triangles.len());
            let vertices = vertices.into_flattened().into_pyarray(py).reshape([v, 3])?;
            let triangles = triangles.into_flattened().into_pyarray(py).reshape([t, 3])?;
            Ok((kind.name.clone(), vertices, triangles))
        };
        scene.kinds.iter().zip(kinds).map(mesh).collect()
    }
}

fn placed(pose: &Isometry3<f64>, vertex: &Vec3) -> [f32; 3] {
    (pose.transform_vector(vertex) + pose.translation.vector).map(|x| x as f32).into()
}
