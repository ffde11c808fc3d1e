//! Solvers' outer loops. They know no ring: they see an objective.

pub mod eigen;
pub mod newton;
