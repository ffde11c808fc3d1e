//! Several maps at once, as of a study.

use super::map::{MapError, OpenMap};
use crate::record::Record;
use maille::record::LimitRow;
use maille::survey::{Task, Work};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

/// Runs maps side by side on the current thread pool, so that no thread waits for the last limit of a map, and gives the record of
/// each, in order. `found` hears of each limit with the name of its map, `work` of when it is begun and ended; after `cancel` what
/// is finished is written.
pub fn run_all(
    open: Vec<(&str, OpenMap)>,
    cancel: &AtomicBool,
    work: &(dyn Fn(&str, Task, Work) + Sync),
    found: &(dyn Fn(&str, &LimitRow) + Sync),
) -> Result<Vec<Record>, MapError> {
    let each = |(name, open): (&str, OpenMap)| {
        open.run(cancel, &|task, what| work(name, task, what), &|row, _| found(name, row))
    };
    open.into_par_iter().with_max_len(1).map(each).collect()
}
