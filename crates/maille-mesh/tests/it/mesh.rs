//! Meshes: the right tori at the right places, in every format.

use maille::{
    design::Design,
    lattice::Cell,
    model::Model,
    record::{ContactRecord, PoseRecord, StateRecord},
    state::State,
};
use maille_geometry::{Circle, Vec3, point_circle_distance};
use maille_io::Tile;
use maille_mesh::{
    Colours, Fineness, Format, MeshError, MeshFile, Objects, Scene, Segments, WriteOptions, between,
    smallest_clearance, state_of, too_close, write_pvd,
};
use nalgebra::{Isometry3, Matrix4, Point3, Quaternion, Translation3, UnitQuaternion};
use serde_json::Value;
use std::{
    f64::consts::PI,
    io::{Cursor, Read},
};

fn design(name: &str) -> Design {
    maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap()
}

fn model(name: &str, cell: &str) -> Model {
    Model::compile(&design(name), cell.parse::<Cell>().unwrap()).unwrap()
}

fn bytes(scene: &Scene, file: MeshFile, options: WriteOptions) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    file.write(scene, options, &mut out).unwrap();
    out.into_inner()
}

/// A state that is turned, moved and stretched.
fn some_state(model: &Model) -> State {
    let mut state = model.start.clone();
    state.a1 *= 1.1;
    state.a2 += Vec3::new(0.2, 0.0, 0.0);
    for (k, pose) in state.poses.iter_mut().enumerate() {
        let k = k as f64;
        *pose = pose.moved(&Vec3::new(0.05 * k, -0.02, 0.03), &Vec3::new(0.1, 0.2 * k - 0.3, 0.4));
    }
    state
}

fn single(bytes: &[u8]) -> f64 {
    f64::from(f32::from_le_bytes(bytes.try_into().unwrap()))
}

/// Triangles of a binary STL.
fn stl_triangles(bytes: &[u8]) -> Vec<[Vec3; 3]> {
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let vector = |b: &[u8]| Vec3::new(single(&b[0..4]), single(&b[4..8]), single(&b[8..12]));
    bytes[84..].chunks(50).map(|facet| [1, 2, 3].map(|k| vector(&facet[12 * k..12 * k + 12]))).collect()
}

fn volume(triangles: &[[Vec3; 3]]) -> f64 {
    triangles.iter().map(|[a, b, c]| a.dot(&b.cross(c)) / 6.0).sum()
}

#[test]
fn stl_vertices_lie_on_the_tori_of_the_state() {
    let (mm, tile) = (2.5, Tile([2, 3]));
    for (name, cell) in [("1.1", "1x1"), ("3.4", "1x1"), ("1.1", "1,0;-1,2")] {
        let model = model(name, cell);
        let state = some_state(&model);
        let scene = Scene::new(&model, &state, tile, Fineness::Segments(24, Some(8)), mm).unwrap();
        let triangles = stl_triangles(&bytes(&scene, MeshFile::Stl, WriteOptions::default()));
        assert_eq!(triangles.len(), 2 * 24 * 8 * 6 * model.rings.len());
        assert_eq!((triangles.len(), 6 * model.rings.len()), (scene.triangle_count(), scene.ring_count()));
        let mut of_rings = triangles.chunks(2 * 24 * 8);
        for i in 0..2 {
            for j in 0..3 {
                for (index, ring) in model.rings.iter().enumerate() {
                    let circle = state.circle(&model, index, [i, j]);
                    let to_mm = model.unit * mm;
                    let center = circle.center * to_mm - scene.origin;
                    let circle = Circle::new(center, circle.normal, circle.radius * to_mm);
                    let of_ring = of_rings.next().unwrap();
                    for point in of_ring.iter().flatten() {
                        let off = point_circle_distance(point, &circle).distance - ring.minor_radius * to_mm;
                        assert!(off.abs() < 1e-5, "{name} {cell} ring {index}: {off}");
                    }
                    let near = |a: f64, b: f64| (a - b).abs() < 1e-4 * b;
                    assert!(near(volume(of_ring), scene.shapes[0].volume()) || scene.shapes.len() > 1);
                    let torus = 2.0 * PI * PI * circle.radius * (ring.minor_radius * to_mm).powi(2);
                    assert!(volume(of_ring) > 0.85 * torus && volume(of_ring) < torus);
                }
            }
        }
    }
}

/// Sorted points of a file, to compare files that store them in other orders.
fn sorted(mut points: Vec<Vec3>) -> Vec<Vec3> {
    let key = |p: &Vec3| [p.x, p.y, p.z].map(|x| (x * 1e3).round() as i64);
    points.sort_by_key(key);
    points.dedup_by_key(|p| key(p));
    points
}

fn assert_same(a: Vec<Vec3>, b: Vec<Vec3>, tolerance: f64) {
    assert_eq!(a.len(), b.len());
    // Quadratic, but independent of how rounding sorts.
    for p in &a {
        assert!(b.iter().any(|q| (p - q).norm() < tolerance), "{p:?} is only in one");
    }
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    tag.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|x| x.parse().unwrap()).collect()
}

/// Points of all objects of a 3MF file at their places, by a reader of its own.
fn three_mf_points(bytes: Vec<u8>) -> (Vec<Vec3>, usize, usize) {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let names: Vec<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    assert_eq!(names, ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]);
    let mut text = String::new();
    archive.by_name("3D/3dmodel.model").unwrap().read_to_string(&mut text).unwrap();
    assert!(text.contains("unit=\"millimeter\""));
    let transform = |tag: &str| {
        let m = numbers(attribute(tag, "transform"));
        Matrix4::new(m[0], m[3], m[6], m[9], m[1], m[4], m[7], m[10], m[2], m[5], m[8], m[11], 0.0, 0.0, 0.0, 1.0)
    };
    let mut objects: Vec<Vec<Point3<f64>>> = vec![Vec::new()];
    let (mut points, mut items, mut meshes) = (Vec::new(), 0, 0);
    for tag in text.split('<') {
        if tag.starts_with("object ") {
            assert_eq!(attribute(tag, "id"), objects.len().to_string());
            objects.push(Vec::new());
        } else if tag.starts_with("mesh>") {
            meshes += 1;
        } else if tag.starts_with("vertex ") {
            let [x, y, z] = ["x", "y", "z"].map(|k| attribute(tag, k).parse().unwrap());
            objects.last_mut().unwrap().push(Point3::new(x, y, z));
        } else if tag.starts_with("component ") || tag.starts_with("item ") {
            let object = &objects[attribute(tag, "objectid").parse::<usize>().unwrap()];
            let matrix = transform(tag);
            let moved: Vec<Point3<f64>> = object.iter().map(|p| matrix.transform_point(p)).collect();
            match tag.starts_with("item ") {
                true => {
                    items += 1;
                    points.extend(moved.iter().map(|p| p.coords));
                }
                false => objects.last_mut().unwrap().extend(moved),
            }
        }
    }
    (points, items, meshes)
}

#[test]
fn instances_of_3mf_are_the_baked_rings_in_the_positive_octant() {
    let tile = Tile([2, 1]);
    let model = model("3.4", "1x1");
    let scene = Scene::new(&model, &some_state(&model), tile, Fineness::Segments(8, Some(4)), 1.0).unwrap();
    let baked = stl_triangles(&bytes(&scene, MeshFile::Stl, WriteOptions::default()));
    let [least, largest] = scene.bounds();
    let baked = sorted(baked.into_iter().flatten().collect());
    let elements = model.elements.len();
    let rings = model.rings.len();
    for (objects, expected) in [(Objects::Element, 2 * elements), (Objects::Ring, 2 * rings), (Objects::Sheet, 1)] {
        let options = WriteOptions { objects, ..WriteOptions::default() };
        let (points, items, meshes) = three_mf_points(bytes(&scene, MeshFile::ThreeMf, options));
        assert_eq!((items, meshes), (expected, scene.shapes.len()));
        assert_eq!(points.len(), 2 * rings * 8 * 4);
        assert!(points.iter().all(|p| p.min() > -1e-4 && (p - (largest - least)).max() < 1e-4));
        assert_same(sorted(points), baked.clone(), 1e-4);
    }
}

fn glb_parts(bytes: &[u8]) -> (Value, &[u8]) {
    assert_eq!(&bytes[..4], b"glTF");
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((number(4), number(8)), (2, bytes.len()));
    let end = 20 + number(12);
    assert_eq!((&bytes[16..20], &bytes[end + 4..end + 8], end % 4), (&b"JSON"[..], &b"BIN\0"[..], 0));
    (serde_json::from_slice(&bytes[20..end]).unwrap(), &bytes[end + 8..])
}

fn floats(document: &Value, binary: &[u8], accessor: &Value, width: usize) -> Vec<Vec<f64>> {
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let at = |key: &str| view[key].as_u64().unwrap() as usize;
    let count = accessor["count"].as_u64().unwrap() as usize;
    assert_eq!(at("byteLength"), 4 * width * count);
    let bytes = &binary[at("byteOffset")..at("byteOffset") + at("byteLength")];
    bytes.chunks(4 * width).map(|item| item.chunks(4).map(single).collect()).collect()
}

fn placement(translation: &[f64], rotation: &[f64]) -> Isometry3<f64> {
    let q = Quaternion::new(rotation[3], rotation[0], rotation[1], rotation[2]);
    assert!((q.norm() - 1.0).abs() < 1e-6);
    Isometry3::from_parts(
        Translation3::new(translation[0], translation[1], translation[2]),
        UnitQuaternion::new_normalize(q),
    )
}

/// Points of all nodes, in the frame of the root's children.
fn glb_points(bytes: &[u8]) -> (Vec<Vec3>, Value) {
    let (document, binary) = glb_parts(bytes);
    let list = |v: &Value| v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<f64>>();
    let mut points = Vec::new();
    let mut stack: Vec<(usize, Isometry3<f64>)> = Vec::new();
    let children = |node: &Value| -> Vec<usize> {
        node["children"].as_array().map_or(Vec::new(), |c| c.iter().map(|k| k.as_u64().unwrap() as usize).collect())
    };
    stack.extend(children(&document["nodes"][0]).into_iter().map(|k| (k, Isometry3::identity())));
    while let Some((k, parent)) = stack.pop() {
        let node = &document["nodes"][k];
        let mut poses = Vec::new();
        match node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"].as_object() {
            Some(attributes) => {
                let translations = floats(&document, binary, &attributes["TRANSLATION"], 3);
                let rotations = floats(&document, binary, &attributes["ROTATION"], 4);
                poses.extend(translations.iter().zip(&rotations).map(|(t, q)| placement(t, q)));
            }
            None => poses.push(placement(&list(&node["translation"]), &list(&node["rotation"]))),
        }
        stack.extend(children(node).into_iter().map(|k| (k, parent * poses[0])));
        if let Some(mesh) = node["mesh"].as_u64() {
            let primitive = &document["meshes"][mesh as usize]["primitives"][0];
            let vertices = floats(&document, binary, &primitive["attributes"]["POSITION"], 3);
            for pose in poses {
                points.extend(vertices.iter().map(|v| (parent * pose * Point3::new(v[0], v[1], v[2])).coords));
            }
        }
    }
    (points, document)
}

#[test]
fn nodes_and_instances_of_glb_are_the_baked_rings() {
    for name in ["1.1", "3.4"] {
        let model = model(name, "1x1");
        let scene = Scene::new(&model, &some_state(&model), Tile([2, 1]), Fineness::Segments(8, Some(4)), 1.0).unwrap();
        let baked = stl_triangles(&bytes(&scene, MeshFile::Stl, WriteOptions::default()));
        let baked = sorted(baked.into_iter().flatten().collect());
        for gpu_instancing in [false, true] {
            let options = WriteOptions { gpu_instancing, ..WriteOptions::default() };
            let (points, document) = glb_points(&bytes(&scene, MeshFile::Glb, options));
            // The root stands it on the floor y = 0, turned by -90° about x, in metres.
            let moved = &document["nodes"][0]["translation"];
            let to_file = |p: Vec3| {
                p + Vec3::new(1.0, 0.0, 0.0) * 1000.0 * moved[0].as_f64().unwrap()
                    - Vec3::y() * 1000.0 * moved[2].as_f64().unwrap()
                    + Vec3::z() * 1000.0 * moved[1].as_f64().unwrap()
            };
            assert_same(sorted(points.into_iter().map(to_file).collect()), baked.clone(), 1e-4);
            assert_eq!(document["materials"].as_array().unwrap().len(), scene.kinds.len());
            assert_eq!(document["nodes"][0]["scale"][0], 0.001);
        }
    }
}

/// What is printed stands on the bed: no vertex is below it or beyond its corner, and one touches each of the three planes.
#[test]
fn meshes_stand_on_the_bed() {
    for name in ["1.1", "3.4", "european-4-in-1"] {
        let model = model(name, "1x1");
        let scene =
            Scene::new(&model, &some_state(&model), Tile([3, 2]), Fineness::Segments(12, Some(5)), 2.0).unwrap();
        let of = |file: MeshFile| bytes(&scene, file, WriteOptions::default());
        let obj = String::from_utf8(of(MeshFile::Obj)).unwrap();
        let vertex = |line: &str| line.strip_prefix("v ").map(|text| Vec3::from_vec(numbers(text)));
        let ply = of(MeshFile::Ply);
        let start = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let ply = ply[start..start + 15 * scene.triangle_count() / 2].chunks(15);
        let ply = ply.map(|v| Vec3::new(single(&v[..4]), single(&v[4..8]), single(&v[8..12])));
        let files = [
            stl_triangles(&of(MeshFile::Stl)).into_iter().flatten().collect::<Vec<Vec3>>(),
            obj.lines().filter_map(vertex).collect(),
            ply.collect(),
            three_mf_points(of(MeshFile::ThreeMf)).0,
        ];
        for points in files {
            assert!(points.len() >= scene.triangle_count() / 2);
            let corner = points.iter().fold(points[0], |least, p| least.inf(p));
            assert!(corner.norm() < 1e-4, "{name}: {corner}");
        }
        // A torus is only just larger than its mesh.
        assert!((scene.origin - scene.bounds()[0]).min() >= 0.0);
    }
}

#[test]
fn sizes_of_files_are_estimated_within_a_third() {
    for (name, tile, fineness) in [
        ("1.1", Tile([12, 12]), Fineness::Tolerance(0.01)),
        ("3.4", Tile([5, 9]), Fineness::Tolerance(0.003)),
        ("european-4-in-1", Tile([40, 40]), Fineness::Segments(16, Some(8))),
    ] {
        let model = model(name, "1x1");
        let mut scene = Scene::new(&model, &model.start, tile, fineness, 1.0).unwrap();
        scene.add_contacts(&model, &model.start, tile, &[contact(0, 1, [0, 0], 0.25)]);
        for format in [Format::Stl, Format::ThreeMf, Format::Obj, Format::Glb, Format::Vtk, Format::Ply] {
            for file in format.files(&scene) {
                let written = bytes(&scene, file, WriteOptions::default()).len() as f64;
                let ratio = file.estimated_bytes(&scene) as f64 / written;
                assert!((0.75..1.34).contains(&ratio), "{name} {file:?}: {ratio} of {written}");
            }
        }
    }
}

/// The cells nearest to a size are those whose box is nearest, found by trying them.
#[test]
fn the_nearest_tile_has_the_nearest_size() {
    for (name, size) in [("european-4-in-1", [7.3, 11.9]), ("1.1", [9.0, 6.1]), ("kings-mail", [0.1, 30.0])] {
        let model = model(name, "1x1");
        let boxed = |tile: [u32; 2]| {
            let scene = Scene::new(&model, &model.start, Tile(tile), Fineness::Segments(6, Some(3)), 1.0).unwrap();
            let [least, largest] = scene.bounds();
            [largest.x - least.x, largest.y - least.y].map(|length| length / model.unit)
        };
        let nearest = |k: usize| {
            let length = |n: u32| boxed(if k == 0 { [n, 1] } else { [1, n] })[k];
            (1..60).min_by(|m, n| (length(*m) - size[k]).abs().total_cmp(&(length(*n) - size[k]).abs())).unwrap()
        };
        let tile = Tile::nearest(&model, &model.start, size);
        assert_eq!(tile.0, [nearest(0), nearest(1)], "{name}");
        let told = tile.size(&model, &model.start);
        let found = boxed(tile.0);
        assert!((0..2).all(|k| (told[k] - found[k]).abs() < 1e-9), "{name}: {told:?} {found:?}");
    }
}

fn contact(ring_a: usize, ring_b: usize, shift: [i32; 2], force: f64) -> ContactRecord {
    let (point_a, normal) = ([0.9, 0.0, 0.0], [1.0, 0.0, 0.0]);
    ContactRecord { ring_a, ring_b, shift, point_a, point_b: [1.1, 0.0, 0.0], normal, force }
}

#[test]
fn loads_are_sums_of_forces_and_colour_the_elements() {
    let model = model("1.1", "1x1");
    let tile = Tile([2, 2]);
    let mut scene = Scene::new(&model, &model.start, tile, Fineness::Segments(8, Some(4)), 3.0).unwrap();
    assert_eq!(Format::Vtk.files(&scene).count(), 2);
    scene.add_contacts(&model, &model.start, tile, &[contact(0, 1, [0, 0], 0.25), contact(0, 1, [-1, 0], 0.5)]);
    assert_eq!(Format::Vtk.files(&scene).count(), 3);
    assert_eq!(scene.loads, Some(vec![0.75, 0.75, 0.0]));
    assert_eq!(scene.contacts.len(), 8);
    assert_eq!(scene.contacts.iter().filter(|c| c.inside).count(), 4 + 2);
    assert!((scene.contacts[0].point - Vec3::new(3.0, 0.0, 0.0)).norm() < 1e-12);
    assert_eq!(scene.contacts[0].force, Vec3::new(0.25, 0.0, 0.0));
    let options = WriteOptions { colours: Colours::Load, ..WriteOptions::default() };
    let (_, document) = glb_points(&bytes(&scene, MeshFile::Glb, options));
    let names: Vec<&str> =
        document["materials"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["load 0.7500", "load 0.0000"]);
}

#[test]
fn a_state_of_a_record_is_the_state_that_was_recorded() {
    let model = model("1.1", "2x1");
    let state = some_state(&model);
    let array = |v: Vec3| -> [f64; 3] { (v * model.unit).into() };
    let poses = model.elements.iter().zip(&state.poses).map(|(element, pose)| {
        let q = pose.rotation;
        PoseRecord { element: element.name.clone(), position: array(pose.position), rotation: [q.w, q.i, q.j, q.k] }
    });
    let mut record =
        StateRecord { a1: array(state.a1), a2: array(state.a2), poses: poses.collect(), ..StateRecord::default() };
    let read = state_of(&model, &record).unwrap();
    assert!((read.a1 - state.a1).norm() < 1e-12 && (read.a2 - state.a2).norm() < 1e-12);
    for (a, b) in read.poses.iter().zip(&state.poses) {
        assert!((a.position - b.position).norm() < 1e-12 && a.rotation.angle_to(&b.rotation) < 1e-7);
    }
    let middle = between(&model.start, &state, 0.5);
    assert!((middle.a1 - (model.start.a1 + state.a1) * 0.5).norm() < 1e-12);
    for (k, (a, b)) in middle.poses.iter().zip(&state.poses).enumerate() {
        let (near, far) = (a.rotation.angle_to(&model.start.poses[k].rotation), b.rotation.angle());
        assert!((near - 0.5 * far).abs() < 1e-7);
    }
    for (end, expected) in [(0.0, &model.start), (1.0, &state)] {
        let reached = between(&model.start, &state, end);
        assert!(reached.poses.iter().zip(&expected.poses).all(|(a, b)| a.rotation.angle_to(&b.rotation) < 1e-7));
    }
    record.poses.swap(0, 1);
    assert!(matches!(state_of(&model, &record), Err(MeshError::OtherElements { .. })));
}

#[test]
fn the_advice_on_clearance_is_right() {
    let (mm, tile) = (2.0, Tile([3, 3]));
    let base = design("1.1");
    let compiled = |design: &Design| Model::compile(design, Cell::PRIMITIVE).unwrap();
    let close = |model: &Model, fineness: Fineness, mm: f64, wanted: f64| {
        let scene = Scene::new(model, &model.start, tile, fineness, mm).unwrap();
        too_close(&scene, model, &model.start, tile, fineness, wanted)
    };
    let model = compiled(&base);
    let state = &model.start;
    let gap = maille::topology::smallest_gap(&model, state).unwrap().0 * model.unit * mm;
    for fineness in [Fineness::Tolerance(0.02), Fineness::Segments(12, None), Fineness::Segments(40, Some(9))] {
        let scene = Scene::new(&model, state, tile, fineness, mm).unwrap();
        let clearance = smallest_clearance(&scene, &model, state, tile).unwrap();
        assert!((clearance - gap).abs() <= 2.0 * scene.chordal_error(), "{clearance} of {gap}");
        assert!(close(&model, fineness, mm, 0.999 * clearance).is_none());
        let wanted = 1.2 * gap.max(clearance);
        let found = close(&model, fineness, mm, wanted).unwrap();
        assert!((found.gap - clearance).abs() < 1e-12 && (found.torus_gap - gap).abs() < 0.1 * gap);
        let thinner = compiled(&base.with_minor_radius(0.1 * found.minor_radius_factor.unwrap()));
        assert!(close(&thinner, fineness, mm, wanted).is_none());
        let scale = mm * found.scale_factor.unwrap();
        assert!(
            close(&model, fineness, scale, wanted).is_none()
                && close(&model, fineness, 0.999 * scale, wanted).is_some()
        );
        // The tori themselves are nearer than that; a little more than the mesh has, they are not.
        assert_eq!(found.segments, None);
        if clearance < 0.99 * gap {
            let Segments { around, across } = close(&model, fineness, mm, 0.99 * gap).unwrap().segments.unwrap();
            assert!(close(&model, Fineness::Segments(around, Some(across)), mm, 0.99 * gap).is_none());
        }
        // Nothing is thin enough; and a tile of one cell has fewer neighbours than a sheet.
        assert_eq!(close(&model, fineness, mm, 10.0).unwrap().minor_radius_factor, None);
        let pairs = |tile: Tile| too_close(&scene, &model, state, tile, fineness, wanted).unwrap().pairs;
        assert!(pairs(Tile([1, 1])) < pairs(tile));
    }
    // The place is half way between the two tori, so half of their gap from either.
    let found = close(&model, Fineness::Tolerance(0.02), mm, 1.2 * gap).unwrap();
    let [cell_a, cell_b] = found.cells;
    assert!(found.cells.as_flattened().iter().all(|k| (0..3).contains(k)));
    for (ring, shift) in [(found.pair.ring_a, cell_a), (found.pair.ring_b, cell_b)] {
        let circle = state.circle(&model, ring, shift);
        let circle = Circle::new(circle.center * mm, circle.normal, circle.radius * mm);
        let distance = point_circle_distance(&found.place, &circle).distance;
        assert!((distance - 0.1 * mm - 0.5 * found.torus_gap).abs() < 1e-9);
    }
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let model = model("4.2", "1x1");
    let scene = || {
        let mut scene = Scene::new(&model, &model.start, Tile([2, 2]), Fineness::Tolerance(0.05), 1.0).unwrap();
        scene.description = "\"a\" < & > b\nnext".into();
        scene
    };
    for file in [MeshFile::Stl, MeshFile::ThreeMf, MeshFile::Obj, MeshFile::Glb, MeshFile::Ply, MeshFile::VtkRings] {
        let written = bytes(&scene(), file, WriteOptions::default());
        assert_eq!(written, bytes(&scene(), file, WriteOptions::default()));
        assert!(written.len() > 1000);
    }
}

#[test]
fn what_cannot_be_made_is_refused() {
    let model = model("1.1", "1x1");
    let scene = |tile: Tile, fineness: Fineness| Scene::new(&model, &model.start, tile, fineness, 1.0);
    let huge = scene(Tile([50_000, 50_000]), Fineness::Tolerance(0.01));
    assert!(matches!(huge, Err(MeshError::TooManyRings { .. })));
    assert!(matches!(scene(Tile([1, 1]), Fineness::Tolerance(1e-12)), Err(MeshError::TooFine { .. })));
    let fine = scene(Tile([100, 100]), Fineness::Segments(4096, Some(64))).unwrap();
    let refused = MeshFile::Stl.write(&fine, WriteOptions::default(), Cursor::new(Vec::new()));
    assert!(matches!(refused, Err(MeshError::TooManyTriangles { .. })));
    for text in ["8x8", "1x100"] {
        assert_eq!(text.parse::<Tile>().unwrap().to_string(), text);
    }
    for wrong in ["", "8", "0x1", "8x", "-1x2", "8x8x8", "1e3x1"] {
        assert!(wrong.parse::<Tile>().is_err(), "{wrong}");
    }
}

#[test]
fn a_series_names_its_files() {
    let text = write_pvd(&[(0.0, 0, "a_f0.vtp".into()), (0.5, 1, "a&b.vtp".into())]);
    assert!(text.contains("<DataSet timestep=\"0.5\" part=\"1\" file=\"a&amp;b.vtp\"/>"));
}
