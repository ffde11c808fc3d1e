//! Binary glTF 2.0: nodes that share one mesh for each torus and colour.
//!
//! The meshes are in millimetres with the sheet in the plane z = 0; the root node scales to glTF's metres and turns the
//! sheet flat (y up). Elements of several rings are nodes with a child for each ring.

use super::{
    colour::{self, Colour, Colours},
    number::{quaternion, singles},
    scene::Scene,
    torus::TorusMesh,
};
use nalgebra::Isometry3;
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{self, Write};

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

#[derive(Serialize)]
struct Node {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<usize>,
    translation: [f32; 3],
    rotation: [f32; 4],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<usize>,
}

impl Node {
    fn new(name: Option<String>, mesh: Option<usize>, pose: &Isometry3<f64>) -> Node {
        let translation = singles(&pose.translation.vector);
        Node { name, mesh, translation, rotation: quaternion(pose), children: Vec::new() }
    }
}

/// The binary chunk, with the views and accessors that describe it.
#[derive(Default)]
struct Chunk {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Chunk {
    /// Appends `count` items and gives the accessor; the length of the bytes is a multiple of four after it.
    fn push(&mut self, bytes: &[u8], target: Option<u32>, mut accessor: Value) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        accessor["bufferView"] = self.views.len().into();
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Appends numbers, `N` an item.
    fn floats<const N: usize>(&mut self, numbers: &[[f32; N]], target: Option<u32>, mut accessor: Value) -> usize {
        accessor["componentType"] = FLOAT.into();
        accessor["count"] = numbers.len().into();
        accessor["type"] = format!("VEC{N}").into();
        let bytes: Vec<u8> = numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        self.push(&bytes, target, accessor)
    }

    /// Appends a mesh: the accessors of its positions, normals and indices.
    fn mesh(&mut self, shape: &TorusMesh) -> [usize; 3] {
        let [positions, normals]: [Vec<[f32; 3]>; 2] =
            [&shape.vertices, &shape.normals].map(|vectors| vectors.iter().map(singles).collect());
        let bound = |pick: fn(f32, f32) -> f32| {
            positions.iter().copied().reduce(|a, b| [0, 1, 2].map(|k| pick(a[k], b[k]))).unwrap_or_default()
        };
        let bounds = json!({ "min": bound(f32::min), "max": bound(f32::max) });
        let indices = shape.triangles().flatten();
        let (bytes, kind): (Vec<u8>, u32) = if shape.vertices.len() < usize::from(u16::MAX) {
            (indices.flat_map(|i| (i as u16).to_le_bytes()).collect(), UNSIGNED_SHORT)
        } else {
            (indices.flat_map(|i| (i as u32).to_le_bytes()).collect(), UNSIGNED_INT)
        };
        let accessor = json!({ "componentType": kind, "count": 3 * shape.triangle_count(), "type": "SCALAR" });
        let positions = self.floats(&positions, Some(VERTICES), bounds);
        let normals = self.floats(&normals, Some(VERTICES), json!({}));
        [positions, normals, self.push(&bytes, Some(INDICES), accessor)]
    }
}

/// Where an item stands among those that are known; a new one is added at the end.
fn place<T: PartialEq>(known: &mut Vec<T>, item: T) -> usize {
    known.iter().position(|k| *k == item).unwrap_or_else(|| {
        known.push(item);
        known.len() - 1
    })
}

pub(super) fn write(scene: &Scene, colours: Colours, gpu_instancing: bool, out: &mut impl Write) -> io::Result<()> {
    let colours = colour::of_members(scene, colours);
    let mut materials: Vec<&Colour> = Vec::new();
    let material_of: Vec<usize> = colours.iter().map(|colour| place(&mut materials, colour)).collect();
    let mut chunk = Chunk::default();
    let parts: Vec<[usize; 3]> = scene.shapes.iter().map(|shape| chunk.mesh(shape)).collect();
    // A mesh for each pair of shape and material that occurs.
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    let mesh_of = |shape: usize, member: usize| place(&mut pairs, [shape, material_of[member]]);
    let mut nodes: Vec<Value> = vec![Value::Null];
    let children = match gpu_instancing {
        true => add_instances(scene, mesh_of, &mut chunk, &mut nodes),
        false => add_elements(scene, mesh_of, &mut nodes),
    };
    // −90° about x, and millimetres to metres.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let [x, y, z] = singles(&(scene.origin * -0.001));
    nodes[0] = json!({
        "name": scene.name,
        "translation": [x, z, -y],
        "rotation": [-half, 0.0, 0.0, half],
        "scale": [0.001, 0.001, 0.001],
        "children": children,
    });

    let mesh = |&[shape, material]: &[usize; 2]| {
        let [positions, normals, indices] = parts[shape];
        json!({
            "name": materials[material].name,
            "primitives": [{
                "attributes": { "POSITION": positions, "NORMAL": normals }, "indices": indices, "material": material,
            }],
        })
    };
    let material = |colour: &&Colour| {
        let [r, g, b] = colour.linear();
        json!({
            "name": colour.name,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5 },
        })
    };
    let mut document = json!({
        "asset": {
            "version": "2.0",
            "generator": format!("maille {}", env!("CARGO_PKG_VERSION")),
            "extras": { "description": scene.description },
        },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes,
        "meshes": pairs.iter().map(mesh).collect::<Vec<_>>(),
        "materials": materials.iter().map(material).collect::<Vec<_>>(),
        "accessors": chunk.accessors,
        "bufferViews": chunk.views,
        "buffers": [{ "byteLength": chunk.bytes.len() }],
    });
    if gpu_instancing {
        document["extensionsUsed"] = json!([INSTANCING]);
        document["extensionsRequired"] = json!([INSTANCING]);
    }
    container(&document, &chunk.bytes, out)
}

/// A node for each mesh, with the poses of its instances; gives the nodes.
fn add_instances(
    scene: &Scene,
    mut mesh_of: impl FnMut(usize, usize) -> usize,
    chunk: &mut Chunk,
    nodes: &mut Vec<Value>,
) -> Vec<usize> {
    let mut poses: Vec<Vec<Isometry3<f64>>> = Vec::new();
    for ring in scene.rings() {
        let mesh = mesh_of(ring.shape, ring.placed.member);
        poses.resize_with(poses.len().max(mesh + 1), Vec::new);
        poses[mesh].push(ring.pose);
    }
    let first = nodes.len();
    for (mesh, poses) in poses.iter().enumerate() {
        let places: Vec<[f32; 3]> = poses.iter().map(|p| singles(&p.translation.vector)).collect();
        let translation = chunk.floats(&places, None, json!({}));
        let rotations: Vec<[f32; 4]> = poses.iter().map(quaternion).collect();
        let rotation = chunk.floats(&rotations, None, json!({}));
        let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation });
        nodes.push(json!({ "mesh": mesh, "extensions": { INSTANCING: { "attributes": attributes } } }));
    }
    (first..nodes.len()).collect()
}

/// A node for each element, with a child for each ring where it has several; gives the nodes of the elements.
fn add_elements(scene: &Scene, mut mesh_of: impl FnMut(usize, usize) -> usize, nodes: &mut Vec<Value>) -> Vec<usize> {
    let mut out = Vec::new();
    for element in &scene.elements {
        let kind = &scene.kinds[element.kind];
        let name = Some(format!("{} {},{}", kind.name, element.cell[0], element.cell[1]));
        out.push(nodes.len());
        if let [ring] = &kind.rings[..] {
            let mesh = mesh_of(ring.shape, element.member);
            nodes.push(json!(Node::new(name, Some(mesh), &(element.pose * ring.local))));
            continue;
        }
        let mut parent = Node::new(name, None, &element.pose);
        parent.children = (1..=kind.rings.len()).map(|k| nodes.len() + k).collect();
        nodes.push(json!(parent));
        for ring in &kind.rings {
            nodes.push(json!(Node::new(None, Some(mesh_of(ring.shape, element.member)), &ring.local)));
        }
    }
    out
}

/// The header, the JSON chunk and the binary chunk; the lengths of both are multiples of four.
fn container(document: &Value, binary: &[u8], out: &mut impl Write) -> io::Result<()> {
    let mut text = serde_json::to_vec(document)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let number =
        |n: usize| u32::try_from(n).map_err(|_| io::Error::other("a GLB file ends at 4 GiB: take a smaller tile"));
    out.write_all(b"glTF")?;
    for n in [2, number(total)?, number(text.len())?] {
        out.write_all(&n.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&number(binary.len())?.to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(binary)
}
