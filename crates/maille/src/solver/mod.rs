//! Solvers' outer loops. They know no ring: they see an objective.

pub(crate) mod balance;
pub mod certificate;
pub mod cholesky;
pub mod cone;
pub mod constraints;
pub mod convexify;
pub mod curvature;
pub mod descent;
pub mod eigen;
pub mod hermitian;
mod kkt_system;
pub mod newton;
pub mod polish;
pub mod qp;
pub(crate) mod reduced_hessian;
pub mod shifted;
pub mod sparse;
pub mod sqp;
pub mod symmetric;
