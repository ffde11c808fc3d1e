//! What other programs read in the exported meshes: trimesh, lib3mf, VTK and the glTF validator (`tests/foreign`).

use crate::programs::{checkers, installed, python, run};
use maille::{lattice::Cell, model::Model, record::ContactRecord};
use maille_io::Tile;
use maille_mesh::{Colours, Fineness, Format, MeshFile, Objects, Scene, TorusMesh, WriteOptions, between, write_pvd};
use serde_json::{Value, json};
use std::{
    f64::consts::PI,
    fs::{self, File},
    path::{Path, PathBuf},
    process::Command,
};

/// A folder with the glTF validator.
fn node_folder() -> PathBuf {
    installed("node", &checkers().join("package-lock.json"), |folder| {
        fs::create_dir_all(folder).unwrap();
        for file in ["package.json", "package-lock.json"] {
            fs::copy(checkers().join(file), folder.join(file)).unwrap();
        }
        run(Command::new("npm").args(["ci", "--no-audit", "--no-fund", "--ignore-scripts"]).current_dir(folder));
    })
}

fn write(scene: &Scene, file: MeshFile, options: WriteOptions, path: &Path) {
    file.write(scene, options, File::create(path).unwrap()).unwrap();
}

fn torus_volume(mesh: &TorusMesh) -> f64 {
    2.0 * PI * PI * mesh.major_radius * mesh.minor_radius.powi(2)
}

/// Writes `scene` in every format; gives what the readers should find.
fn export(scene: &Scene, name: &str, folder: &Path) -> Value {
    let path = |ending: &str| folder.join(format!("{name}{ending}"));
    let options = WriteOptions { colours: Colours::Load, ..WriteOptions::default() };
    for format in [Format::Stl, Format::Obj, Format::Ply, Format::Glb, Format::Vtk] {
        for file in format.files(scene) {
            write(scene, file, options, &path(file.ending()));
        }
    }
    write(scene, MeshFile::Glb, WriteOptions { gpu_instancing: true, ..options }, &path("-instanced.glb"));
    for (objects, ending) in
        [(Objects::Element, "-element.3mf"), (Objects::Ring, "-ring.3mf"), (Objects::Sheet, "-sheet.3mf")]
    {
        write(scene, MeshFile::ThreeMf, WriteOptions { objects, ..options }, &path(ending));
    }
    let lacks = scene.shapes.iter().map(|s| 1.0 - s.volume() / torus_volume(s)).fold(0.0, f64::max);
    let mut meshes: Vec<(usize, String)> = Vec::new();
    for ring in scene.rings() {
        let colour = match &scene.loads {
            Some(loads) => format!("{:.4}", loads[ring.placed.member]),
            None => scene.kinds[ring.placed.kind].name.clone(),
        };
        meshes.push((ring.shape, colour));
    }
    meshes.sort();
    meshes.dedup();
    json!({
        "name": name,
        "rings": scene.ring_count(),
        "elements": scene.elements.len(),
        "shapes": scene.shapes.len(),
        "glb_meshes": meshes.len(),
        "contacts": scene.contacts.len(),
        "force": scene.contacts.iter().map(|c| c.force.norm()).sum::<f64>(),
        "volume": scene.rings().map(|r| torus_volume(&scene.shapes[r.shape])).sum::<f64>(),
        "volume_tolerance": lacks + 1e-5,
        "box": scene.bounds().map(|v| [v.x, v.y, v.z]),
    })
}

#[test]
fn other_programs_read_watertight_rings_at_their_places() {
    let dir = tempfile::tempdir().unwrap();
    let mut expected = Vec::new();
    // One ring; small and large; several rings of several radii in an element; a supercell.
    let cases = [
        ("1.1", "1x1", Tile([2, 2]), 1.0),
        ("3.4", "1x1", Tile([1, 2]), 25.4),
        ("4.2", "1x1", Tile([2, 1]), 0.5),
        ("1.1", "2x1", Tile([1, 1]), 10.0),
    ];
    for (k, (name, cell, tile, mm)) in cases.into_iter().enumerate() {
        let design = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap();
        let model = Model::compile(&design, cell.parse::<Cell>().unwrap()).unwrap();
        let mut scene = Scene::new(&model, &model.start, tile, Fineness::Tolerance(0.005), mm).unwrap();
        scene.description = format!("{name} <&\"> {cell} µ");
        if k == 0 {
            let (point_a, point_b) = ([1.0, 0.0, 0.0], [1.25, 0.0, 0.0]);
            let contact = |ring_b: usize, force: f64| ContactRecord {
                ring_a: 0,
                ring_b,
                shift: [0, 0],
                point_a,
                point_b,
                normal: [1.0, 0.0, 0.0],
                force,
            };
            scene.add_contacts(&model, &model.start, tile, &[contact(1, 0.5), contact(2, 0.125)]);
        }
        expected.push(export(&scene, &format!("case-{k}"), dir.path()));
    }

    // A series of frames.
    let design = maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap();
    let model = Model::compile(&design, Cell::PRIMITIVE).unwrap();
    let mut end = model.start.clone();
    end.a1 *= 1.1;
    let mut files = Vec::new();
    for k in 0..3 {
        let time = f64::from(k) / 2.0;
        let state = between(&model.start, &end, time);
        let scene = Scene::new(&model, &state, Tile([1, 1]), Fineness::Segments(12, None), 1.0).unwrap();
        let name = format!("frame-{k}");
        expected.push(export(&scene, &name, dir.path()));
        files.push((time, 0, format!("{name}.vtp")));
    }
    fs::write(dir.path().join("frames.pvd"), write_pvd(&files)).unwrap();

    fs::write(dir.path().join("expected.json"), serde_json::to_string_pretty(&expected).unwrap()).unwrap();
    run(Command::new(python()).arg(checkers().join("check_meshes.py")).arg(dir.path()));

    let mut glb: Vec<PathBuf> = fs::read_dir(dir.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    glb.retain(|path| path.extension().is_some_and(|e| e == "glb"));
    glb.sort();
    assert_eq!(glb.len(), 2 * expected.len());
    run(Command::new("node").arg(checkers().join("check_gltf.mjs")).args(&glb).current_dir(node_folder()));
}

/// A sheet of 30,000 rings stays small and quick where rings are instanced.
#[test]
fn a_large_sheet_is_instanced() {
    let design = maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap();
    let model = Model::compile(&design, Cell::PRIMITIVE).unwrap();
    let begun = std::time::Instant::now();
    let scene = Scene::new(&model, &model.start, Tile([100, 100]), Fineness::Tolerance(0.01), 1.0).unwrap();
    assert_eq!(scene.ring_count(), 30_000);
    for file in [MeshFile::ThreeMf, MeshFile::Glb] {
        for objects in [Objects::Element, Objects::Ring, Objects::Sheet] {
            let mut out = std::io::Cursor::new(Vec::new());
            file.write(&scene, WriteOptions { objects, ..WriteOptions::default() }, &mut out).unwrap();
            assert!(out.into_inner().len() < 20_000_000);
        }
    }
    // Six files, each allowed ten seconds.
    assert!(begun.elapsed().as_secs_f64() < 60.0);
}
