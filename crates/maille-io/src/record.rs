//! The record: the folder that a run leaves behind.
//!
//! | file | content |
//! | --- | --- |
//! | `limits.csv` | one [`LimitRow`](maille::record::LimitRow) a line, [`LIMIT_COLUMNS`](maille::record::LIMIT_COLUMNS) first; text columns that could be taken for numbers are quoted |
//! | `states.jsonl` | one [`StateRecord`](maille::record::StateRecord) a line |
//! | `run.json` | a [`RunRecord`]: design, parameters, hash of both, counters |
//! | `polar.svg`, `polar.png` | the plot |
//! | `sensitivities.csv` | where it was asked for: one [`SensitivityRow`] a line |
//!
//! A simulated sheet leaves `simulation.json`, a [`SimulationRecord`], `frames.jsonl`, one
//! [`FrameRecord`](maille::record::FrameRecord) a line, and `forces.csv`, a [`ForceTable`].
//!
//! Numbers are written with the fewest digits that read back bit for bit.

mod csv;
mod error;
mod folder;
mod forces;
pub(crate) mod journal;
mod limits;
mod lock;
mod plan;
mod reference;
mod run;
mod sensitivities;
mod simulation;
mod states;

pub(crate) use csv::{csv_number, csv_text};
pub use error::RecordError;
pub use folder::{NamedRecord, Record, RecordFolder, file_name};
pub use forces::{BEND_COLUMN, FORCE_COLUMNS, ForceTable, PLACE_COLUMNS, read_forces, write_forces};
pub use journal::JournalHead;
pub(crate) use limits::csv_cell;
pub use limits::{read_limits, write_limits};
pub use lock::{FolderLock, Mark, RECORDS};
pub use plan::{LoadedPlace, PulledPlace, SheetPlan};
pub use reference::{Reference, ReferenceCell};
pub(crate) use run::sha256;
pub use run::{Counters, RunRecord, input_hash, read_run, write_run};
pub use sensitivities::{SENSITIVITY_COLUMNS, SensitivityRow, read_sensitivities, write_sensitivities};
pub use simulation::{
    KeptStep, SIMULATION, SimulationFiles, SimulationFolder, SimulationOutcome, SimulationRecord, StepJournal,
    open_simulation, read_frames, read_simulation, write_frames, write_simulation,
};
pub use states::{read_states, write_states};
