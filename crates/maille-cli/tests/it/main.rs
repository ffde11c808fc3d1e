//! All tests of this crate that use it from outside, in one program.

mod adversarial;
#[cfg(unix)]
mod blocks;
mod common;
mod errors;
mod faults;
mod fit;
mod guide;
mod makers;
mod old_record;
mod overwrite;
mod plot;
mod program;
mod prove;
mod reproduce;
mod roll;
mod sensitivity;
#[cfg(unix)]
mod slurm;
mod sweep;
mod symmetry;
mod table;
mod verify;
