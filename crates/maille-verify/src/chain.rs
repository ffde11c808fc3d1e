//! The chain bound of a row, from the chain that its state names.
//!
//! The centres of linked, disjoint rings a, b are at most R_a + R_b − r_a − r_b apart: circle a passes the disc of b at a point p, at least
//! r_a + r_b from circle b, so |p − c_b| ≤ R_b − r_a − r_b, and |c_a − p| = R_a. Two rings of one element are |o_a − o_b| apart. So a
//! chain of both kinds from a ring to its image at v, of length d in all, proves |F v| ≤ d, and with l2 held
//!
//! l1 ≤ √(d² − (1 + l2)² (v·D⊥)²)/|v·D| − 1.

use crate::{
    record::Chain,
    sheet::{Pair, Sheet},
    strain::axes,
};

/// What a chain proves of l1, where l2 is held and the shear is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ChainBound {
    AtMost(f64),
    /// No state has this l2.
    Impossible,
}

/// Ends across the pull bind nothing along it.
const ACROSS: f64 = 1e-9;

/// The bound of `chain` on `sheet`, the start in the cell that the chain's shifts count, whose linked pairs are `links`.
pub(crate) fn bound(
    sheet: &Sheet,
    links: &[(Pair, i32)],
    chain: &Chain,
    unit: f64,
    direction_deg: f64,
    l2: f64,
) -> Result<ChainBound, String> {
    let linked = |a: usize, b: usize, [m, n]: [i32; 2]| {
        links.iter().any(|((x, y, s), _)| (*x, *y, *s) == (a, b, [m, n]) || (*x, *y, *s) == (b, a, [-m, -n]))
    };
    let (Some(first), Some(last)) = (chain.rings.first(), chain.rings.last()) else {
        return Err("the chain is empty".into());
    };
    let along = [last.1[0] - first.1[0], last.1[1] - first.1[1]];
    if first.0 != last.0 || along != chain.vector || along == [0, 0] {
        return Err("the chain does not lead from a ring to its image at the vector it names".into());
    }
    let mut length = 0.0;
    for pair in chain.rings.windows(2) {
        let ((a, p), (b, q)) = (pair[0], pair[1]);
        if a.max(b) >= sheet.rings.len() {
            return Err(format!("the chain names ring {}, of {} rings", a.max(b), sheet.rings.len()));
        }
        let (one, other) = (&sheet.rings[a], &sheet.rings[b]);
        let shift = [q[0] - p[0], q[1] - p[1]];
        length += if one.element == other.element && shift == [0, 0] {
            (one.arm - other.arm).norm()
        } else if linked(a, b, shift) {
            one.radius + other.radius - one.wire - other.wire
        } else {
            return Err(format!("the chain joins rings {a} and {b} at {shift:?}, which are not linked"));
        };
    }
    if (length - chain.length / unit).abs() > 1e-12 * length {
        return Err(format!("the chain's length is {length:?} R, {:?} in the state", chain.length / unit));
    }
    let v = sheet.translation(along).xy();
    let (d, side) = axes(direction_deg);
    let (reach, used) = (v.dot(&d).abs(), (1.0 + l2) * v.dot(&side).abs());
    if used > length * (1.0 + 1e-12) {
        return Ok(ChainBound::Impossible);
    }
    if reach <= ACROSS * v.norm() {
        return Err("the chain lies across the pull".into());
    }
    Ok(ChainBound::AtMost(((length - used) * (length + used)).max(0.0).sqrt() / reach - 1.0))
}
