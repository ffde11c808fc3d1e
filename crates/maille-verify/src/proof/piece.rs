//! A box of poses of the two rings, and what is known of the rings in it.

use super::form::{Form, Forms, Numbers, UNKNOWNS, dot, plain, scaled};

/// Which side of a cube a normal passes through: the normal is along (s, p, q), the coordinates counted on from `axis`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Side {
    /// 0, 1 or 2: along D, along D⊥, out of the plane.
    pub axis: usize,
    /// Whether s is −1 and not 1.
    pub negative: bool,
}

/// A box: λ = 1 + l1, the place of ring 1 relative to ring 0 in the undeformed cell along D and D⊥, its height, then p and q
/// of the normals of both rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Lower ends.
    pub lo: [f64; UNKNOWNS],
    /// Upper ends.
    pub hi: [f64; UNKNOWNS],
    /// Sides of the cube that the normals pass through.
    pub sides: [Side; 2],
}

impl Piece {
    /// Its two halves along an unknown; they share a face. None where no number is left between the ends.
    pub fn halves(&self, unknown: usize) -> Option<[Piece; 2]> {
        let (lo, hi) = (self.lo[unknown], self.hi[unknown]);
        let middle = 0.5 * lo + 0.5 * hi;
        let (mut low, mut high) = (*self, *self);
        low.hi[unknown] = middle;
        high.lo[unknown] = middle;
        (lo < middle && middle < hi).then_some([low, high])
    }

    /// Where p of the line along a normal is.
    pub(crate) fn line(&self, ring: usize) -> [f64; 2] {
        let (lo, hi) = (self.lo[4 + 2 * ring], self.hi[4 + 2 * ring]);
        if self.sides[ring].negative { [-hi, -lo] } else { [lo, hi] }
    }
}

/// The rings of a box.
pub struct Rings {
    /// 1 + l1, the two coordinates of the place, the height.
    pub(crate) place: [Form; 4],
    /// Along the normals, not of unit length: linear in p and q.
    pub(crate) along: [Forms; 2],
    /// The normals.
    pub(crate) normals: [Forms; 2],
    /// The normals at the centre of the box, and the lengths of `along` there: plain numbers.
    pub(crate) middle: [Numbers; 2],
    pub(crate) lengths: [f64; 2],
}

impl Rings {
    /// The rings of a box.
    pub fn of(piece: &Piece) -> Rings {
        let unknown = |i: usize| Form::unknown(i, piece.lo[i], piece.hi[i]);
        let along = [0, 1].map(|ring| {
            let side = piece.sides[ring];
            let mut m = [Form::number(0.0); 3];
            m[side.axis] = Form::number(if side.negative { -1.0 } else { 1.0 });
            m[(side.axis + 1) % 3] = unknown(4 + 2 * ring);
            m[(side.axis + 2) % 3] = unknown(5 + 2 * ring);
            m
        });
        // |m|² ≥ 1, so that the root is there unless the box is no box.
        let normals = along.map(|m| match dot(&m, &m).inverse_root() {
            Some(k) => scaled(&m, &k),
            None => [Form::about(0.0, f64::NAN); 3],
        });
        let centres = along.map(|m| m.map(|x| x.c));
        Rings {
            place: [0, 1, 2, 3].map(unknown),
            along,
            normals,
            middle: centres.map(|m| plain::unit(&m)),
            lengths: centres.map(|m| plain::length(&m)),
        }
    }

    /// The normals at the centre of the box, to choose inequalities by.
    pub fn middle(&self) -> &[[f64; 3]; 2] {
        &self.middle
    }
}
