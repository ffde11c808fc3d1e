//! The chain bound of a row, from the chain that its state names.
//!
//! The centres of linked, disjoint rings a, b are at most R_a + R_b − r_a − r_b apart: circle a passes the disc of b at a point p, at least
//! r_a + r_b from circle b, so |p − c_b| ≤ R_b − r_a − r_b, and |c_a − p| = R_a. Two rings of one element are |o_a − o_b| apart. So a
//! chain of both kinds from a ring to its image at v, of length d in all, proves |F v| ≤ d, and with l2 held
//!
//! l1 ≤ √(d² − (1 + l2)² (v·D⊥)²)/|v·D| − 1.

use crate::{
    record::Chain,
    strain::{ACROSS, axes},
    tie::Linked,
};

/// What a chain proves of l1, where l2 is held and the shear is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ChainBound {
    AtMost(f64),
    /// No state has this l2.
    Impossible,
}

/// The bound of `chain` on the start in the cell that the chain's shifts count.
pub(crate) fn bound(
    start: Linked<'_>,
    chain: &Chain,
    unit: f64,
    direction_deg: f64,
    l2: f64,
) -> Result<ChainBound, String> {
    let (vector, length) = start.chain(&chain.rings)?;
    if vector != chain.vector {
        return Err(format!("the chain leads to {vector:?}, {:?} is written", chain.vector));
    }
    if (length - chain.length / unit).abs() > 1e-12 * length {
        return Err(format!("the chain's length is {length:?} R, {:?} in the state", chain.length / unit));
    }
    let v = start.sheet.translation(vector).xy();
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
