//! Nothing but dependencies: with them the program, the Python package and the tests ask for the same features of the libraries that
//! they share, so that `cargo xtask test` compiles each library once.
