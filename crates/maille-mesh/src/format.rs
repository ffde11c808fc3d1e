//! The formats, and the files that each writes.

use super::{
    colour::Colours,
    error::MeshError,
    glb, obj, ply,
    scene::Scene,
    stl,
    three_mf::{self, Objects},
    vtk,
};
use std::io::{Seek, Write};

/// A format of the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary STL.
    Stl,
    /// 3MF.
    ThreeMf,
    /// Wavefront OBJ.
    Obj,
    /// Binary glTF.
    Glb,
    /// VTK XML poly data.
    Vtk,
    /// Binary PLY.
    Ply,
}

impl Format {
    /// The format of files that end so, in small letters and without the dot.
    pub fn of_ending(ending: &str) -> Option<Format> {
        match ending {
            "3mf" => Some(Format::ThreeMf),
            "stl" => Some(Format::Stl),
            "obj" => Some(Format::Obj),
            "glb" => Some(Format::Glb),
            "vtp" => Some(Format::Vtk),
            "ply" => Some(Format::Ply),
            _ => None,
        }
    }

    /// The files that this format writes, the last of VTK only for a state with contacts.
    pub fn all_files(self) -> &'static [MeshFile] {
        match self {
            Format::Stl => &[MeshFile::Stl],
            Format::ThreeMf => &[MeshFile::ThreeMf],
            Format::Obj => &[MeshFile::Obj],
            Format::Glb => &[MeshFile::Glb],
            Format::Ply => &[MeshFile::Ply],
            Format::Vtk => &[MeshFile::VtkRings, MeshFile::VtkPoses, MeshFile::VtkContacts],
        }
    }

    /// The files that this format writes for `scene`.
    pub fn files(self, scene: &Scene) -> impl Iterator<Item = MeshFile> {
        let contacts = !scene.contacts.is_empty();
        self.all_files().iter().copied().filter(move |file| contacts || *file != MeshFile::VtkContacts)
    }
}

/// One file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFile {
    /// Triangles of all rings.
    Stl,
    /// Objects and where they are.
    ThreeMf,
    /// Triangles of all rings, grouped by element.
    Obj,
    /// Nodes that share meshes.
    Glb,
    /// Triangles of all rings, coloured.
    Ply,
    /// Quadrilaterals of all rings, with ids.
    VtkRings,
    /// A point for each ring, with its normal, radii and ids.
    VtkPoses,
    /// A point for each contact, with its force.
    VtkContacts,
}

/// What a file may leave open.
#[derive(Clone, Copy, Debug, Default)]
pub struct WriteOptions {
    /// Objects of a 3MF file.
    pub objects: Objects,
    /// Colours of GLB and PLY files.
    pub colours: Colours,
    /// GLB: one node for each mesh with EXT_mesh_gpu_instancing, in place of one node for each ring. Smaller and fast to
    /// draw, but only for viewers that know the extension; others refuse the file.
    pub gpu_instancing: bool,
}

impl MeshFile {
    /// What is added to the name of the file.
    pub fn ending(self) -> &'static str {
        match self {
            MeshFile::Stl => ".stl",
            MeshFile::ThreeMf => ".3mf",
            MeshFile::Obj => ".obj",
            MeshFile::Glb => ".glb",
            MeshFile::Ply => ".ply",
            MeshFile::VtkRings => ".vtp",
            MeshFile::VtkPoses => "-poses.vtp",
            MeshFile::VtkContacts => "-contacts.vtp",
        }
    }

    /// About how many bytes the file of `scene` will have, within a third.
    pub fn estimated_bytes(self, scene: &Scene) -> u64 {
        let (rings, triangles) = (scene.ring_count() as u64, scene.triangle_count() as u64);
        // A torus has half as many vertices, and as many quadrilaterals, as triangles.
        let corners = triangles / 2;
        let shapes = scene.shapes.iter().map(|shape| shape.triangle_count() as u64).sum::<u64>();
        let head =
            if matches!(self, MeshFile::VtkRings | MeshFile::VtkPoses | MeshFile::VtkContacts) { 2_500 } else { 1_000 };
        head + match self {
            MeshFile::Stl => 50 * triangles,
            MeshFile::Ply => 15 * corners + 13 * triangles,
            MeshFile::Obj => {
                let index = u64::from(corners.max(1).ilog10()) + 2;
                32 * corners + (3 * index + 1) * triangles
            }
            // Deflated text: meshes once, a line for each ring.
            MeshFile::ThreeMf => 17 * shapes / 2 + 7 * rings / 2,
            MeshFile::Glb => 18 * shapes + 130 * rings,
            MeshFile::VtkRings => (24 + 20 + 20) * corners,
            MeshFile::VtkPoses => 60 * rings,
            MeshFile::VtkContacts => 56 * scene.contacts.len() as u64,
        }
    }

    /// Writes `scene`. The same scene gives the same bytes.
    pub fn write(self, scene: &Scene, options: WriteOptions, mut out: impl Write + Seek) -> Result<(), MeshError> {
        let triangles = scene.triangle_count();
        let baked = matches!(self, MeshFile::Stl | MeshFile::Obj | MeshFile::Ply | MeshFile::VtkRings);
        // Signed 32-bit indices, and twice as many corners as triangles where the faces are quadrilaterals.
        if baked && triangles > i32::MAX as usize / 2 {
            return Err(MeshError::TooManyTriangles { triangles });
        }
        match self {
            MeshFile::Stl => stl::write(scene, &mut out)?,
            MeshFile::ThreeMf => three_mf::write(scene, options.objects, &mut out)?,
            MeshFile::Obj => obj::write(scene, &mut out)?,
            MeshFile::Glb => glb::write(scene, options.colours, options.gpu_instancing, &mut out)?,
            MeshFile::Ply => ply::write(scene, options.colours, &mut out)?,
            MeshFile::VtkRings => vtk::write_rings(scene, &mut out)?,
            MeshFile::VtkPoses => vtk::write_poses(scene, &mut out)?,
            MeshFile::VtkContacts => vtk::write_contacts(scene, &mut out)?,
        }
        Ok(out.flush()?)
    }
}
