//! Mechanics of discrete interlocking materials: from a design to its deformation limits.
//!
//! Data flows one way: [`design`] → [`model`] → [`state`] → contacts → energy → solver → limit → record.

pub mod design;
pub mod error;
pub mod record;
