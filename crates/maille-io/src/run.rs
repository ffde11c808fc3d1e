//! What is run for all doors: limits are asked for, records kept, plots drawn.

mod map;

pub use map::{Chain, Map, MapError, OpenMap, save_record};
