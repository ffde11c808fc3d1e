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

    /// The files that this format writes for `scene`.
    pub fn files(self, scene: &Scene) -> Vec<MeshFile> {
        match self {
            Format::Stl => vec![MeshFile::Stl],
            Format::ThreeMf => vec![MeshFile::ThreeMf],
            Format::Obj => vec![MeshFile::Obj],
            Format::Glb => vec![MeshFile::Glb],
            Format::Ply => vec![MeshFile::Ply],
            Format::Vtk if scene.contacts.is_empty() => vec![MeshFile::VtkRings, MeshFile::VtkPoses],
            Format::Vtk => vec![MeshFile::VtkRings, MeshFile::VtkPoses, MeshFile::VtkContacts],
        }
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
