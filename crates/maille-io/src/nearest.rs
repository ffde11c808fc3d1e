//! "Did you mean …?"

pub(crate) use maille::error::nearest;
