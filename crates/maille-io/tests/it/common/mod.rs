//! What several tests share.

pub mod foreign;
pub mod rows;
