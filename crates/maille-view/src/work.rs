//! Work that takes time: how much runs at once, what a newer request ends, and how it ends when nobody listens.

use crate::refusal::Refusal;
use axum::http::StatusCode;
use maille::{InvalidInput, survey::thread_pool};
use std::{
    collections::HashMap,
    sync::{
        Arc, Mutex, MutexGuard,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};
use tokio::sync::Semaphore;

/// Solves that run at once: two sheets may be compared.
const SOLVES: usize = 2;
/// Solves that run or wait, at most.
const MOST_SOLVES: usize = 16;
/// Other work at once.
const SHORT: usize = 4;

/// What is at work.
#[derive(Debug)]
pub struct Work {
    /// Threads of solves and pictures.
    pub pool: rayon::ThreadPool,
    /// Places of solves.
    pub solves: Arc<Semaphore>,
    /// Places of checks and files.
    pub short: Arc<Semaphore>,
    live: AtomicUsize,
    slots: Mutex<HashMap<String, (u64, Arc<AtomicBool>)>>,
    next: AtomicUsize,
}

/// A solve under way. When it is dropped the solve no longer counts.
#[derive(Debug)]
pub struct Ticket {
    work: Arc<Work>,
    slot: String,
    number: u64,
    /// Set when nobody wants the solve any more.
    pub cancel: Arc<AtomicBool>,
}

/// Ends a solve when it is dropped: with the answer, when the socket closes.
#[derive(Debug)]
pub struct CancelOnDrop(pub Arc<AtomicBool>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Work {
    /// With `threads`, or one for each core.
    pub fn new(threads: Option<usize>) -> Result<Self, InvalidInput> {
        Ok(Self {
            pool: thread_pool(threads)?,
            solves: Arc::new(Semaphore::new(SOLVES)),
            short: Arc::new(Semaphore::new(SHORT)),
            live: AtomicUsize::new(0),
            slots: Mutex::default(),
            next: AtomicUsize::new(0),
        })
    }

    fn slots(&self) -> MutexGuard<'_, HashMap<String, (u64, Arc<AtomicBool>)>> {
        self.slots.lock().unwrap_or_else(|e| e.into_inner())
    }

    /// Solves that run or wait.
    pub fn live(&self) -> usize {
        self.live.load(Ordering::SeqCst)
    }

    /// Ends the older solve of `slot` and takes its place.
    pub fn claim(self: &Arc<Self>, slot: &str) -> Result<Ticket, Refusal> {
        if slot.is_empty() || slot.len() > 64 {
            return Err(Refusal::wrong("the slot has no name, or a long one", "give 1 to 64 bytes"));
        }
        let cancel = Arc::new(AtomicBool::new(false));
        let number = self.next.fetch_add(1, Ordering::Relaxed) as u64;
        let mut slots = self.slots();
        if let Some((_, older)) = slots.get(slot) {
            older.store(true, Ordering::Relaxed);
        }
        if self.live.fetch_add(1, Ordering::SeqCst) >= MOST_SOLVES {
            self.live.fetch_sub(1, Ordering::SeqCst);
            return Err(Refusal::of(
                StatusCode::SERVICE_UNAVAILABLE,
                format!("{MOST_SOLVES} solves are under way"),
                "wait until one has ended",
            ));
        }
        slots.insert(slot.to_owned(), (number, Arc::clone(&cancel)));
        drop(slots);
        Ok(Ticket { work: Arc::clone(self), slot: slot.to_owned(), number, cancel })
    }

    /// Ends all solves.
    pub fn cancel_all(&self) {
        self.slots().values().for_each(|(_, cancel)| cancel.store(true, Ordering::Relaxed));
    }
}

impl Drop for Ticket {
    fn drop(&mut self) {
        let mut slots = self.work.slots();
        if slots.get(&self.slot).is_some_and(|(number, _)| *number == self.number) {
            slots.remove(&self.slot);
        }
        drop(slots);
        self.work.live.fetch_sub(1, Ordering::SeqCst);
    }
}
