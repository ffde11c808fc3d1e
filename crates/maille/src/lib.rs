//! Mechanics of discrete interlocking materials: from a design to its deformation limits.
//!
//! Data flows one way: [`design`] → [`model`] → [`state`] → [`contact`]s → [`energy`] → [`solve`]r → [`limit`] → [`record`].
//! Inside, lengths are in units of the design's reference radius; records are in the file's unit.

pub mod answer;
pub mod bound;
pub mod characterize;
pub mod constraint;
pub mod contact;
pub mod design;
pub mod energy;
pub mod error;
pub mod lattice;
pub mod limit;
pub mod model;
pub mod question;
pub mod record;
pub mod sheet;
pub mod simulate;
pub mod solve;
pub mod state;
pub mod symmetry;
pub mod topology;
