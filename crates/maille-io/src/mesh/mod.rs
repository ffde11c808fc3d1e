//! Meshes of a sheet: files to print, to show and to analyse.
//!
//! A [`Scene`] is a tile of the sheet in one state, in millimetres. Every format writes one:
//!
//! | format | rings | for |
//! | --- | --- | --- |
//! | `3mf` | one mesh for each pair of radii, placed by transforms | printing: real units |
//! | `stl`, `obj`, `ply` | every ring with triangles of its own | printing, modelling, other programs |
//! | `glb` | as `3mf`; in metres, y up, a colour for each kind of element or its load | showing |
//! | `vtk` | three files: rings, poses as points, contact points with forces | analysing (ParaView) |
//!
//! The rings of one element are closed bodies that may overlap where they are joined. The formats do not cut them to one
//! surface: slicers unite overlapping bodies of one object, and most do so for bodies of one file.

mod clearance;
mod colour;
mod distance;
mod glb;
mod number;
mod obj;
mod ply;
mod scene;
mod stl;
mod three_mf;
mod torus;
mod vtk;

pub use clearance::{TooClose, smallest_clearance, too_close};
pub use scene::{
    Kind, KindRing, Placed, PlacedContact, PlacedRing, Scene, Tile, between, millimetres, state_of, state_words,
};
pub use torus::{Fineness, Segments, TorusMesh};
pub use vtk::write_pvd;

use miette::Diagnostic;
use std::io::{self, Seek, Write};
use thiserror::Error;

/// What keeps a mesh from being made or written.
#[derive(Debug, Error, Diagnostic)]
pub enum MeshError {
    /// The tolerance asks for too many segments.
    #[error("the tolerance asks for {segments} segments of a circle; {most} are possible")]
    TooFine {
        /// Segments that the tolerance asks for.
        segments: usize,
        /// Most segments.
        most: usize,
    },
    /// Fewer than three segments make no body.
    #[error("a circle needs at least 3 segments")]
    TooCoarse,
    /// The tile is too large.
    #[error("the tile has {rings} rings; {most} are possible")]
    TooManyRings {
        /// Rings of the tile.
        rings: usize,
        /// Most rings.
        most: usize,
    },
    /// A format that writes every ring's triangles cannot number them.
    #[error("{triangles} triangles are too many for this format")]
    TooManyTriangles {
        /// Triangles of the scene.
        triangles: usize,
    },
    /// A state's elements are not those of the cell.
    #[error("the state has {state} elements that are not those of the cell ({cell} elements)")]
    OtherElements {
        /// Elements of the state.
        state: usize,
        /// Elements of the cell.
        cell: usize,
    },
    /// The writer refused.
    #[error(transparent)]
    Write(#[from] io::Error),
}

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

/// What the colours show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// The kind of element.
    #[default]
    Kind,
    /// The load on the element, from grey (none) to yellow (most). Without loads as [`Colours::Kind`].
    Load,
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
