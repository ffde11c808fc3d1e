//! What can go wrong.

use miette::Diagnostic;
use std::io;
use thiserror::Error;

/// What keeps a mesh from being made or written.
#[derive(Debug, Error, Diagnostic)]
pub enum MeshError {
    /// The tolerance asks for too many segments.
    #[error("the tolerance asks for {segments} segments of a circle; {most} are possible")]
    #[diagnostic(help("take a coarser --tolerance; it counts in the design file's unit of length"))]
    TooFine {
        /// Segments that the tolerance asks for.
        segments: usize,
        /// Most segments.
        most: usize,
    },
    /// Fewer than three segments make no body.
    #[error("a circle needs at least 3 segments")]
    #[diagnostic(help("give --segments 48, or 48x16 for 48 around the ring and 16 across the wire"))]
    TooCoarse,
    /// The tile is too large.
    #[error("the tile has {rings} rings; {most} are possible")]
    #[diagnostic(help("take a smaller --tile"))]
    TooManyRings {
        /// Rings of the tile.
        rings: usize,
        /// Most rings.
        most: usize,
    },
    /// A format that writes every ring's triangles cannot number them.
    #[error("{triangles} triangles are too many for this format")]
    #[diagnostic(help("take 3mf or glb, which store each ring once, a smaller --tile, or a coarser --tolerance"))]
    TooManyTriangles {
        /// Triangles of the scene.
        triangles: usize,
    },
    /// A state's elements are not those of the cell.
    #[error("the state has {state} elements that are not those of the cell ({cell} elements)")]
    #[diagnostic(help("the record's files do not belong together: compute it again with --overwrite"))]
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
