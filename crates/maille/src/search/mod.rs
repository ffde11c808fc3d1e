//! The exact method: answers by local maximisation from many starts, certified and compared with proven bounds.
//!
//! `starts` are states to begin with, `stop` says when they are enough, `local` is one maximisation, `multistart` the search from
//! many starts and in larger cells, and the other files say what is maximised and from where: `stretch` (with `stretch_lattices`,
//! `along` for the limits of one direction, and `unlinked` where no chain of links binds), `strain`, and `extreme`: `room` (wire and clearance) or `closest` (the area of
//! the cell), `curl`, the tightest roll, and `tube`, what is sought of a closed tube. `family` is the program that an answer solves. `near` begins with the state of another design. `waves` tells whether a limit can go on in a larger cell. `overlap` frees a start that overlaps. Every tolerance is in `options`.

mod along;
mod closest;
pub(crate) mod curl;
#[doc(hidden)]
pub mod extreme;
pub(crate) mod family;
mod local;
mod multistart;
mod near;
mod options;
mod overlap;
pub(crate) mod rolled;
mod room;
mod starts;
mod stop;
#[doc(hidden)]
pub mod strain;
#[doc(hidden)]
pub mod stretch;
mod stretch_lattices;
mod unlinked;
mod waves;

pub use extreme::Extreme;
pub use options::{ExactOptions, ExactParameters, ExtremeOptions};
