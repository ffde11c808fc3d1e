//! The record: the folder that a run leaves behind.
//!
//! | file | content |
//! | --- | --- |
//! | `limits.csv` | one [`LimitRow`](maille::record::LimitRow) a line, [`LIMIT_COLUMNS`] first; text columns that could be taken for numbers are quoted |
//! | `states.jsonl` | one [`StateRecord`](maille::record::StateRecord) a line |
//! | `run.json` | a [`RunRecord`]: design, parameters, hash of both, counters |
//! | `polar.svg`, `polar.png` | the plot |
//!
//! Numbers are written with the fewest digits that read back bit for bit.

mod error;
mod folder;
mod limits;
mod run;
mod states;

pub use error::RecordError;
pub use folder::{Record, RecordFolder};
pub use limits::{LIMIT_COLUMNS, read_limits, write_limits};
pub use run::{Counters, RunRecord, input_hash, read_run, write_run};
pub use states::{read_states, write_states};
