//! Pairs of pieces, segments and arcs, of any 18 floats.

use crate::circles::CLOSE;
use maille_geometry::{Arc, Circle, MAX_PIECE_MINIMA, Piece, Segment, Vec3, piece_distance_minima};
use nalgebra::UnitVector3;

/// Bytes as two pieces: what each is, and nine floats, little-endian; missing bytes are 0. A segment has a start and an end, an arc a start, a
/// tangent there and an end, or the centre, normal and radius of a circle, an angle and a sweep. What makes no piece is refused by its constructor.
pub fn pieces(bytes: &[u8]) {
    let piece = |bytes: &[u8]| {
        let mut x = [0.0; 9];
        for (number, chunk) in x.iter_mut().zip(bytes.get(1..).unwrap_or_default().chunks(8)) {
            let mut eight = [0; 8];
            eight[..chunk.len()].copy_from_slice(chunk);
            *number = f64::from_le_bytes(eight);
        }
        let [one, other, third] = [0, 3, 6].map(|k| Vec3::new(x[k], x[k + 1], x[k + 2]));
        let circle = || Circle { center: one, normal: UnitVector3::new_normalize(other / other.amax()), radius: x[6] };
        match bytes.first().copied().unwrap_or_default() % 4 {
            0 => Segment::new(one, other).map(Piece::Segment),
            1 => Arc::from_tangent(one, other, third).map(Piece::Arc),
            2 => Arc::new(circle(), x[7], x[8]).map(Piece::Arc),
            _ => Some(Piece::circle(circle())),
        }
    };
    let (first, second) = bytes.split_at(bytes.len().min(PIECE));
    let (Some(a), Some(b)) = (piece(first), piece(second)) else { return };
    let minima = piece_distance_minima(&a, &b);
    assert!((1..=MAX_PIECE_MINIMA).contains(&minima.as_slice().len()), "{minima:?}");
    if !is_sound(&a) || !is_sound(&b) {
        return;
    }
    let distance = minima.closest().distance;
    let (size_a, size_b) = (size(&a), size(&b));
    let close = CLOSE * size_a.max(size_b);
    assert!(minima.as_slice().is_sorted_by(|p, q| p.distance <= q.distance), "{minima:?}");
    for m in minima.as_slice() {
        assert!(((m.point_a - m.point_b).norm() - m.distance).abs() <= close, "{m:?} of {a:?} and {b:?}");
        assert!((a.point(a.nearest(&m.point_a)) - m.point_a).norm() <= close, "{m:?} on {a:?}");
        assert!((b.point(b.nearest(&m.point_b)) - m.point_b).norm() <= close, "{m:?} on {b:?}");
    }
    for k in 0..=32 {
        let p = a.point(f64::from(k) / 32.0);
        let sampled = (b.point(b.nearest(&p)) - p).norm();
        assert!(distance <= sampled + close, "{distance} is above {sampled} of {a:?} and {b:?}");
    }
    let swapped = piece_distance_minima(&b, &a).closest().distance;
    assert!((swapped - distance).abs() <= close, "{distance}, and {swapped} the other way round");
}

/// Bytes of one piece.
pub(crate) const PIECE: usize = 1 + 9 * 8;

/// Its length and radius, and how far it is from the origin: rounding is counted in this.
fn size(piece: &Piece) -> f64 {
    let (radius, at) = match piece {
        Piece::Segment(_) => (0.0, piece.point(0.5)),
        Piece::Arc(arc) => (arc.circle().radius, arc.circle().center),
    };
    // A maximum would leave NaN out.
    [piece.length(), radius, at.norm()].iter().sum()
}

/// Whether squares of its sizes are ordinary numbers.
fn is_sound(piece: &Piece) -> bool {
    let ordinary = |x: f64| (1e-90..=1e90).contains(&x);
    let round = match piece {
        Piece::Segment(_) => true,
        Piece::Arc(arc) => ordinary(arc.circle().radius) && (arc.circle().normal.norm() - 1.0).abs() < 1e-12,
    };
    round && ordinary(piece.length()) && size(piece) <= 1e90
}
