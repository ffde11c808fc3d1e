//! The minima of the distance between two circles.

pub(crate) mod angle;
pub(crate) mod approach;
pub(crate) mod exhaustive;
pub(crate) mod fast;
pub(crate) mod lower_bound;
pub(crate) mod many_pairs;
pub(crate) mod minimum;
pub(crate) mod normalized_pair;
pub(crate) mod one_pair;
pub(crate) mod pair_frame;
pub(crate) mod polynomial;
pub(crate) mod simd_frame;
