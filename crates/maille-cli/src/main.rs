//! The `maille` program.
fn main() {}
