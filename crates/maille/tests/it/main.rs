//! All tests of this crate that use it from outside, in one program; `tests/memory.rs` measures its own
//! process and stays alone.

mod between;
mod bounds;
mod broad;
mod closest;
mod common;
mod curves;
mod designs;
mod energy;
mod exact;
mod extreme;
mod fit;
mod images;
mod kernel;
mod limits;
mod oracle;
mod question;
mod roll;
mod roll_limits;
mod rows;
mod sensitivity;
mod side_signs;
mod simulate;
mod statics;
mod strain;
mod symmetry;
mod waves;
