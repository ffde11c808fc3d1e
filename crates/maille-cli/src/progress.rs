//! Progress on standard error: a bar or a spinner on a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use std::{
    io::IsTerminal,
    sync::{
        Mutex,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

/// Progress of a number of limits.
pub struct Progress {
    bar: ProgressBar,
    total: AtomicU64,
    what: &'static str,
    plain: Option<Mutex<(u64, Instant)>>,
}

/// Time between plain lines.
const PLAIN_INTERVAL: Duration = Duration::from_secs(5);

impl Progress {
    /// Starts at 0 of `total` limits.
    pub fn new(total: u64, quiet: bool) -> Progress {
        Progress::of(total, quiet, "limits")
    }

    /// Starts at 0 of `total` of something.
    pub fn of(total: u64, quiet: bool, what: &'static str) -> Progress {
        let terminal = std::io::stderr().is_terminal();
        let bar = if quiet || !terminal { ProgressBar::hidden() } else { ProgressBar::new(total) };
        let style = format!("{{bar:30}} {{pos}} of {{len}} {what}, {{eta}} left  {{msg}}");
        bar.set_style(ProgressStyle::with_template(&style).unwrap_or_else(|_| ProgressStyle::default_bar()));
        if !quiet && terminal {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        let plain = (!quiet && !terminal).then(|| Mutex::new((0, Instant::now())));
        Progress { bar, total: AtomicU64::new(total), what, plain }
    }

    /// One limit is done; `what` names it.
    pub fn step(&self, what: String) {
        if let Some(plain) = &self.plain {
            let mut plain = plain.lock().unwrap_or_else(|e| e.into_inner());
            plain.0 += 1;
            if plain.1.elapsed() >= PLAIN_INTERVAL {
                plain.1 = Instant::now();
                let last = if what.is_empty() { String::new() } else { format!(", last {what}") };
                eprintln!("{} of {} {}{last}", plain.0, self.total.load(Ordering::Relaxed), self.what);
            }
        }
        self.bar.set_message(what);
        self.bar.inc(1);
    }

    /// There are more than were known.
    pub fn more(&self, count: u64) {
        self.total.fetch_add(count, Ordering::Relaxed);
        self.bar.inc_length(count);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Progress of work whose end is not known.
pub struct Spinner {
    bar: ProgressBar,
    said: Option<Mutex<Instant>>,
}

impl Spinner {
    /// Starts.
    pub fn new(quiet: bool) -> Spinner {
        let terminal = std::io::stderr().is_terminal();
        let bar = if quiet || !terminal { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        let said = (!quiet && !terminal).then(|| Mutex::new(Instant::now()));
        Spinner { bar, said }
    }

    /// Where the work is; `what` is asked only if it is shown.
    pub fn says(&self, what: impl Fn() -> String) {
        if !self.bar.is_hidden() {
            self.bar.set_message(what());
            self.bar.tick();
        }
        if let Some(said) = &self.said {
            let mut said = said.lock().unwrap_or_else(|e| e.into_inner());
            if said.elapsed() >= PLAIN_INTERVAL {
                *said = Instant::now();
                eprintln!("{}", what());
            }
        }
    }

    /// Removes the line.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
