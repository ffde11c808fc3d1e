//! Surveys: many questions to one sheet on the current thread pool, as maps and as the surface of all strains.

mod extremes;
mod icosphere;
mod image;
mod map;
mod request;
mod rolls;
mod row;
pub mod surface;
mod threads;

pub use extremes::{direction_slope, extremes};
pub(crate) use map::one;
pub use map::{chains, characterize};
pub use request::{CellChoice, Finished, MapQuestion, Method, Task, Work};
pub(crate) use rolls::rolls;
pub use rolls::{KnownRoll, RollTask};
pub use threads::{MOST_THREADS, thread_pool};
