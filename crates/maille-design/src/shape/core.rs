//! What all forms become: the pieces of closed curves; those of open ones go there and back.

use maille_geometry::{Piece, Place, Vec3};
use serde::{Deserialize, Serialize};

/// Most pieces of one curve.
pub(crate) const MOST_PIECES: usize = 10_000;
/// Sine of the angle below which two tangents are one.
pub const SMOOTH: f64 = 1e-7;

/// What a closed curve of pieces stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// A closed curve.
    Closed,
    /// An open one: it goes there, and back the same way. What lies on the way back belongs to none.
    Open,
    /// A cycle of a frame, or a strut there and back.
    Frame,
}

/// The pieces of one closed core curve.
#[derive(Clone, Debug)]
pub struct CorePieces {
    /// What it stands for.
    pub kind: CurveKind,
    /// Segments and arcs, in order.
    pub pieces: Vec<Piece>,
    /// What of each belongs to this curve alone: see [`Owned`].
    pub owned: Vec<Owned>,
    /// How far the form is from its pieces at most, at sampled points.
    pub deviation: f64,
}

impl CorePieces {
    /// A closed curve.
    pub fn closed(pieces: Vec<Piece>, deviation: f64) -> Self {
        CorePieces { kind: CurveKind::Closed, owned: vec![Owned::ALL; pieces.len()], pieces, deviation }
    }

    /// An open curve of these pieces, there and back.
    pub fn open(mut pieces: Vec<Piece>, deviation: f64) -> Self {
        let mut owned = vec![Owned::ALL; pieces.len()];
        let back: Vec<Piece> = pieces.iter().rev().map(Piece::reversed).collect();
        owned.resize(2 * pieces.len(), Owned::NONE);
        pieces.extend(back);
        CorePieces { kind: CurveKind::Open, pieces, owned, deviation }
    }
}

/// What of a piece belongs to its curve. A strut of a frame lies on several cycles, and belongs to the first; so does a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Owned {
    /// The piece without its ends.
    pub inside: bool,
    /// Its first point.
    pub start: bool,
    /// Its last point.
    pub end: bool,
}

impl Owned {
    /// All of it.
    pub const ALL: Owned = Owned { inside: true, start: true, end: true };
    /// Nothing.
    pub const NONE: Owned = Owned { inside: false, start: false, end: false };

    /// Whether anything of it does.
    pub fn any(self) -> bool {
        self.inside || self.start || self.end
    }

    /// Whether a place of the piece belongs to the curve.
    pub fn at(self, place: Place) -> bool {
        match place {
            Place::Start => self.start,
            Place::Inside => self.inside,
            Place::End => self.end,
        }
    }
}

/// A part of a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathPart {
    /// Where it ends.
    pub to: [f64; 3],
    /// A point of the arc on the way; without one the part is straight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub through: Option<[f64; 3]>,
}

/// A ball around a piece.
#[inline]
pub fn ball(piece: &Piece) -> (Vec3, f64) {
    let middle = (piece.point(0.0) + piece.point(1.0)) * 0.5;
    let at = match piece {
        Piece::Arc(arc) if arc.sweep_rad() > std::f64::consts::PI => arc.circle().center,
        _ => middle,
    };
    (at, (piece.point(piece.farthest(&at)) - at).norm())
}
