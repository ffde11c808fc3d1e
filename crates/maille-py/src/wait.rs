//! Long calls: the work on threads of its own, the interpreter free meanwhile, Ctrl-C and progress heard.

use crate::error;
use maille::survey::thread_pool;
use pyo3::prelude::*;
use std::{
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    time::Duration,
};

/// What the work tells meanwhile.
pub enum Step {
    /// So many more things are to be done.
    More(usize),
    /// One of them is.
    Done,
}

/// Signals are looked for at least this often.
const PATIENCE: Duration = Duration::from_millis(50);

/// Does `work` on a pool of `threads` (all cores, if none) while other Python threads run. `progress` is called with what
/// is done and what there is to do. After Ctrl-C, or an exception from `progress`, the flag that `work` gets is set; what
/// it has written stays, and the exception is raised when it has come back.
pub fn wait<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&AtomicBool, &(dyn Fn(Step) + Sync)) -> T + Send,
) -> PyResult<T> {
    let pool = thread_pool(threads).map_err(|e| error::invalid(&e))?;
    let cancel = AtomicBool::new(false);
    let (send, mut receive) = mpsc::channel::<Step>();
    let mut failure: Option<PyErr> = None;
    let (mut done, mut total) = (0, 0);
    let out = std::thread::scope(|scope| {
        let (cancel, pool) = (&cancel, &pool);
        let worker = scope.spawn(move || {
            let tell = |step| drop(send.send(step)); // nobody listens any more only if this thread is no longer waited for
            pool.install(|| work(cancel, &tell))
        });
        loop {
            let (back, step) = py.detach(move || {
                let step = receive.recv_timeout(PATIENCE);
                (receive, step)
            });
            receive = back;
            match step {
                Ok(Step::More(more)) => total += more,
                Ok(Step::Done) => done += 1,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            let told = match (step, progress, &failure) {
                (Ok(_), Some(progress), None) => progress.call1((done, total)).map(drop),
                _ => Ok(()),
            };
            if let Err(error) = told.and_then(|()| py.check_signals()) {
                failure.get_or_insert(error);
                cancel.store(true, Ordering::Relaxed);
            }
        }
        py.detach(|| worker.join())
    });
    match (failure, out) {
        (Some(failure), _) => Err(failure),
        (None, Ok(out)) => Ok(out),
        (None, Err(_)) => Err(error::other("maille itself is at fault: a thread has panicked; please report this")),
    }
}
