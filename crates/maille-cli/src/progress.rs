//! Progress on standard error: a bar or a spinner on a terminal, plain lines elsewhere.

use indicatif::{FormattedDuration, ProgressBar, ProgressStyle};
use std::{
    fmt::Write,
    io::IsTerminal,
    sync::{Arc, Condvar, Mutex, MutexGuard},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// Progress of a number of things, with the time that it takes. A thread of its own shows it, so that it goes on while nothing is
/// finished.
pub struct Progress {
    shared: Arc<Shared>,
    shown: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    finished: Condvar,
}

/// How far the work is.
struct State {
    /// What is counted, as `limits`.
    what: &'static str,
    done: u64,
    /// Those of `done` that were there at the start.
    there: u64,
    total: u64,
    /// Whether more are planned as the work goes on.
    grows: bool,
    begun: Instant,
    /// What is at work, and since when.
    at_work: Vec<(String, Instant)>,
    finished: bool,
}

/// Time between two looks at the state on a terminal.
const TERMINAL_INTERVAL: Duration = Duration::from_millis(250);
/// Time between plain lines: at first, and at most. In between it is a tenth of the time that has passed.
const PLAIN_INTERVAL: [Duration; 2] = [Duration::from_secs(5), Duration::from_secs(60)];
/// What is at work for longer than this is named.
const LONG: Duration = Duration::from_secs(10);
/// So many are named.
const NAMED: usize = 2;

impl State {
    /// One line: `12 of 37 limits, 00:00:10 so far, 1.2 per second, about 00:00:21 left`.
    fn line(&self, now: Instant) -> String {
        let State { done, there, total, what, .. } = *self;
        let elapsed = now.duration_since(self.begun);
        let planned = if self.grows { " planned so far" } else { "" };
        let mut line = format!("{done} of {total} {what}{planned}, {} so far", FormattedDuration(elapsed));
        let mut long: Vec<(Duration, &str)> =
            self.at_work.iter().map(|(name, since)| (now.duration_since(*since), name.as_str())).collect();
        long.sort_by(|a, b| b.cmp(a));
        let longest = long.first().map_or(Duration::ZERO, |(time, _)| *time);
        let rate = (done - there) as f64 / elapsed.as_secs_f64();
        if rate > 0.0 {
            let (number, unit) = if rate >= 1.0 { (rate, "second") } else { (60.0 * rate, "minute") };
            let _ = write!(line, ", {number:.1} per {unit}");
            let left = Duration::try_from_secs_f64((total - done) as f64 / rate).unwrap_or(Duration::MAX);
            // Where one limit takes longer than all that are left were to take, the estimate is worth nothing.
            if !self.grows && done < total && longest <= left {
                let _ = write!(line, ", about {} left", FormattedDuration(left));
            }
        }
        long.retain(|(time, _)| *time >= LONG);
        for (k, (time, name)) in long.iter().take(NAMED).enumerate() {
            let _ =
                write!(line, "{}{name} for {}", if k == 0 { "; at work: " } else { ", " }, FormattedDuration(*time));
        }
        if long.len() > NAMED {
            let _ = write!(line, " and {} more", long.len() - NAMED);
        }
        line
    }
}

impl Progress {
    /// Starts with `there` of `total` things that are done already.
    pub fn new(what: &'static str, there: usize, total: usize, quiet: bool) -> Progress {
        Self::start(what, there, total, false, quiet)
    }

    /// Starts with `there` things that are done; [`Self::more`] are planned as the work goes on.
    pub fn growing(what: &'static str, there: usize, quiet: bool) -> Progress {
        Self::start(what, there, there, true, quiet)
    }

    fn start(what: &'static str, there: usize, total: usize, grows: bool, quiet: bool) -> Progress {
        let (there, total) = (there as u64, total as u64);
        let begun = Instant::now();
        let state = State { what, done: there, there, total, grows, begun, at_work: Vec::new(), finished: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), finished: Condvar::new() });
        let shown = (!quiet).then(|| {
            let shared = Arc::clone(&shared);
            thread::spawn(move || if std::io::stderr().is_terminal() { shared.bar() } else { shared.lines() })
        });
        Progress { shared, shown }
    }

    /// One more is done.
    pub fn step(&self) {
        self.shared.state().done += 1;
    }

    /// There are more than were known.
    pub fn more(&self, count: usize) {
        self.shared.state().total += count as u64;
    }

    /// Something is begun that may take long.
    pub fn begins(&self, name: String) {
        self.shared.state().at_work.push((name, Instant::now()));
    }

    /// It is ended.
    pub fn ends(&self, name: &str) {
        let mut state = self.shared.state();
        if let Some(at) = state.at_work.iter().position(|(begun, _)| begun == name) {
            state.at_work.swap_remove(at);
        }
    }

    /// Something else is at work, alone.
    pub fn only(&self, name: Option<String>) {
        self.shared.state().at_work = name.into_iter().map(|name| (name, Instant::now())).collect();
    }

    /// Nothing more is shown.
    pub fn finish(mut self) {
        self.end();
    }

    fn end(&mut self) {
        self.shared.state().finished = true;
        self.shared.finished.notify_all();
        if let Some(shown) = self.shown.take() {
            let _ = shown.join();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(|e| e.into_inner())
    }

    /// Waits; gives the state, if the work is not finished by then.
    fn after(&self, time: Duration) -> Option<MutexGuard<'_, State>> {
        let waited = self.finished.wait_timeout_while(self.state(), time, |state| !state.finished);
        let (state, _) = waited.unwrap_or_else(|e| e.into_inner());
        (!state.finished).then_some(state)
    }

    fn bar(&self) {
        let bar = ProgressBar::new(0);
        let style = ProgressStyle::with_template("{bar:20} {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        while let Some(state) = self.after(TERMINAL_INTERVAL) {
            let (done, total, line) = (state.done, state.total, state.line(Instant::now()));
            drop(state);
            bar.set_length(total);
            bar.set_position(done);
            bar.set_message(line);
        }
        bar.finish_and_clear();
    }

    fn lines(&self) {
        let [first, last] = PLAIN_INTERVAL;
        let mut wait = first;
        while let Some(state) = self.after(wait) {
            let (now, begun) = (Instant::now(), state.begun);
            let line = state.line(now);
            drop(state);
            eprintln!("{line}");
            wait = (now.duration_since(begun) / 10).clamp(first, last);
        }
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
            if said.elapsed() >= PLAIN_INTERVAL[0] {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn state(done: u64, there: u64, grows: bool, begun: Instant) -> State {
        State { what: "limits", done, there, total: 40, grows, begun, at_work: Vec::new(), finished: false }
    }

    /// What was there at the start counts as done, but not for the rate.
    #[test]
    fn a_line_has_elapsed_time_rate_and_remaining_time() {
        let begun = Instant::now();
        let line = |state: &State, seconds| state.line(begun + Duration::from_secs(seconds));
        let resumed = state(20, 10, false, begun);
        assert_eq!(line(&resumed, 5), "20 of 40 limits, 00:00:05 so far, 2.0 per second, about 00:00:10 left");
        assert_eq!(line(&state(10, 10, false, begun), 5), "10 of 40 limits, 00:00:05 so far");
        let grows = line(&state(20, 10, true, begun), 100);
        assert_eq!(grows, "20 of 40 limits planned so far, 00:01:40 so far, 6.0 per minute");
    }

    #[test]
    fn what_takes_long_is_named_longest_first() {
        let begun = Instant::now();
        let at = |name: &str, second| (name.to_owned(), begun + Duration::from_secs(second));
        let mut slow = state(40, 0, false, begun);
        slow.at_work = vec![at("short", 95), at("b", 10), at("a", 5), at("c", 60)];
        let line = slow.line(begun + Duration::from_secs(100));
        assert!(line.ends_with("; at work: a for 00:01:35, b for 00:01:30 and 1 more"), "{line}");
        // The last one takes longer than the estimate.
        slow.done = 39;
        let line = slow.line(begun + Duration::from_secs(100));
        assert!(line.starts_with("39 of 40 limits, 00:01:40 so far, 23.4 per minute; at work"), "{line}");
    }
}
