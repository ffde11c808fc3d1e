//! The threads of a survey.

use maille_design::InvalidInput;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads at most: more than any machine has cores, and fewer than a system refuses.
pub const MOST_THREADS: usize = 1024;

/// A pool of so many threads, or of one for each core where none is given.
///
/// # Errors
/// For none and for more than [`MOST_THREADS`], and where the system does not start them.
pub fn thread_pool(threads: Option<usize>) -> Result<ThreadPool, InvalidInput> {
    let wrong =
        |problem: String| InvalidInput::new("threads", problem, format!("give a number from 1 to {MOST_THREADS}"));
    if let Some(n) = threads.filter(|n| !(1..=MOST_THREADS).contains(n)) {
        return Err(wrong(format!("{n} threads cannot be started")));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    pool.map_err(|e| wrong(format!("the threads cannot be started: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_threads_than_any_machine_has_cores_are_refused() {
        assert_eq!(thread_pool(Some(3)).unwrap().current_num_threads(), 3);
        assert!(thread_pool(None).unwrap().current_num_threads() >= 1);
        for n in [0, MOST_THREADS + 1, 1_000_000, usize::MAX] {
            let problem = thread_pool(Some(n)).unwrap_err();
            assert_eq!((problem.field.as_str(), problem.problem.contains(&n.to_string())), ("threads", true));
        }
    }
}
