//! Solvers' outer loops. They know no ring: they see an objective.

pub mod certificate;
pub mod cholesky;
pub mod cone;
pub mod convex;
pub mod curvature;
pub mod descent;
pub mod eigen;
pub mod kkt;
pub mod newton;
pub mod qp;
mod reduced;
pub mod rows;
mod saddle;
pub mod shifted;
pub mod sparse;
pub mod sqp;
pub mod symmetric;
