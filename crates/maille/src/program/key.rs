//! Keys of rows, by which they are known from state to state: numbers, for the solver knows no pairs.

use crate::topology::RingPair;

/// Number of a pair that stays the same from state to state.
pub fn pair_key(pair: &RingPair) -> u64 {
    let small = |x: i32| (x & 0xfff) as u64;
    (pair.ring_a as u64) << 44 | (pair.ring_b as u64) << 24 | small(pair.shift[0]) << 12 | small(pair.shift[1])
}

/// The pair of a key.
pub fn pair_of_key(key: u64) -> RingPair {
    let small = |bits: u64| ((bits & 0xfff) as i32) << 20 >> 20;
    RingPair {
        ring_a: (key >> 44) as usize,
        ring_b: (key >> 24 & 0xf_ffff) as usize,
        shift: [small(key >> 12), small(key)],
    }
}

/// Key of the row that holds parameter `m` below its bound.
pub fn bound_key(m: usize) -> u64 {
    u64::MAX - m as u64
}
