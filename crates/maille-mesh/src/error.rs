//! What can go wrong.

use miette::Diagnostic;
use std::io;
use thiserror::Error;

/// What keeps a mesh from being made or written.
#[derive(Debug, Error)]
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

impl Diagnostic for MeshError {}
