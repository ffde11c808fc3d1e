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
    let set = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if set.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(exit::INTERRUPTED));
        }
        if !quiet {
            eprintln!("\nstopping: what is finished is written (Ctrl-C again ends at once)");
        }
    })
    .into_diagnostic()
    .wrap_err("cannot listen for Ctrl-C")?;
    signal_hook::flag::register(signal_hook::consts::SIGTERM, Arc::clone(&flag))
        .into_diagnostic()
        .wrap_err("cannot listen for SIGTERM")?;
    *known = Some(Arc::clone(&flag));
    Ok(flag)
}
