//! Formats of maille.
