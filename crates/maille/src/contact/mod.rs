//! Contacts: where two rings are nearest, how far the tori are from touching there, and how that changes with the poses.

pub mod kernel;
