//! The local minima of the distance between two circles.
//!
//! | module | what it holds |
//! | --- | --- |
//! | `minimum`, `approach` | result types: one pair, many pairs |
//! | `angle` | angles as cosine and sine |
//! | `pair_frame`, `normalized_pair` | the common frame of a pair, and its six numbers |
//! | `simd_frame` | the common frame on SIMD registers |
//! | `fast` | isolation by root counting, then Halley's iteration: ordinary pairs |
//! | `exhaustive` | bisection with derivative bounds: degenerate and nearly degenerate pairs |
//! | `one_pair`, `many_pairs` | the public functions, which choose between the two |
//! | `lower_bound` | a cheap lower bound of the distance |
//! | `polynomial` | an independent method, for cross-checks |

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
