//! Ctrl-C and SIGTERM end a run cleanly; a second Ctrl-C ends it at once. Schedulers send SIGTERM again and again, so a second one of
//! those does nothing.

use crate::exit;
use miette::{IntoDiagnostic, Result, WrapErr};
use std::sync::{
    Arc, Mutex,
    atomic::{AtomicBool, Ordering},
};

/// The flag of the one handler that a program may have.
static FLAG: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);

/// The flag that Ctrl-C and SIGTERM set; listens from the first call on, which decides whether anything is said.
pub fn flag(quiet: bool) -> Result<Arc<AtomicBool>> {
    let mut known = FLAG.lock().unwrap_or_else(|e| e.into_inner());
    if let Some(flag) = &*known {
        return Ok(Arc::clone(flag));
    }
    let flag = Arc::new(AtomicBool::new(false));
    listen(Arc::clone(&flag), quiet).into_diagnostic().wrap_err("cannot listen for Ctrl-C")?;
    *known = Some(Arc::clone(&flag));
    Ok(flag)
}

/// A thread of its own waits for both signals.
#[cfg(unix)]
fn listen(flag: Arc<AtomicBool>, quiet: bool) -> std::io::Result<()> {
    use signal_hook::{
        consts::{SIGINT, SIGTERM},
        iterator::Signals,
    };
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        for signal in signals.forever() {
            match signal {
                SIGTERM => flag.store(true, Ordering::Relaxed),
                _ => pressed(&flag, quiet),
            }
        }
    })?;
    Ok(())
}

#[cfg(not(unix))]
fn listen(flag: Arc<AtomicBool>, quiet: bool) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || pressed(&flag, quiet))
}

/// Ctrl-C.
fn pressed(flag: &AtomicBool, quiet: bool) {
    if flag.swap(true, Ordering::Relaxed) {
        std::process::exit(i32::from(exit::INTERRUPTED));
    }
    if !quiet {
        eprintln!("\nstopping: what is finished is written (Ctrl-C again ends at once)");
    }
}
