//! So that cargo heeds the build dependencies.

fn main() {}
