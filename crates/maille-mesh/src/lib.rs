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
//! What is printed stands on the bed, in the corner of it: the smallest x, y and z of the meshes are 0 in every format but
//! VTK, which keeps the coordinates of the state (in GLB y is up, and the sheet's y is −z).
//!
//! The rings of one element are closed bodies that may overlap where they are joined. The formats do not cut them to one
//! surface: slicers unite overlapping bodies of one object, and most do so for bodies of one file.

mod clearance;
mod colour;
mod curve;
mod distance;
mod error;
mod format;
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
pub use colour::Colours;
pub use error::MeshError;
pub use format::{Format, MeshFile, WriteOptions};
pub use scene::{Kind, KindRing, Placed, PlacedContact, PlacedRing, Scene, between, state_of, state_words};
pub use three_mf::Objects;
pub use torus::{Fineness, Segments, TorusMesh};
pub use vtk::write_pvd;
