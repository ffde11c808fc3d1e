//! Exact distances, contacts and linking of circles and tori in space.
