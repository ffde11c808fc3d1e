//! What is run for all front ends: limits are asked for, records kept, plots drawn, rows of records solved again.

mod map;
mod replay;
mod sensitivities;
mod side_by_side;

pub use map::{Chain, Map, MapError, OpenMap, save_record};
pub use replay::{ReplayError, Replayed, replay};
pub use sensitivities::sensitivities;
pub use side_by_side::run_all;
