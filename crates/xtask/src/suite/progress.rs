//! One line for each step that starts or ends; in between, what is running.

use std::{
    io::{IsTerminal, Write, stdout},
    time::{Duration, Instant},
};

/// How often the line of running steps is written anew on a terminal, and elsewhere.
const LIVE: Duration = Duration::from_secs(1);
const SIGN_OF_LIFE: Duration = Duration::from_secs(60);
/// Longer lines would be broken by a narrow terminal, and stay.
const WIDTH: usize = 79;

/// Writes to standard output.
pub struct Progress {
    begun: Instant,
    terminal: bool,
    said: Instant,
    /// Characters of the line that will be written over.
    live: usize,
}

impl Progress {
    pub fn new() -> Progress {
        let now = Instant::now();
        Progress { begun: now, terminal: stdout().is_terminal(), said: now, live: 0 }
    }

    /// A line that stays.
    pub fn say(&mut self, text: &str) {
        self.clear();
        println!("{} {text}", clock(self.begun.elapsed()));
        self.said = Instant::now();
    }

    /// Says what is running, and for how long, if it is time to.
    pub fn running(&mut self, steps: &[(&str, Duration)]) {
        if steps.is_empty() || self.said.elapsed() < if self.terminal { LIVE } else { SIGN_OF_LIFE } {
            return;
        }
        let steps: Vec<String> = steps.iter().map(|(name, time)| format!("{name} {} s", time.as_secs())).collect();
        let text = format!("running: {}", steps.join(", "));
        if !self.terminal {
            return self.say(&text);
        }
        self.clear();
        let line: String = format!("{} {text}", clock(self.begun.elapsed())).chars().take(WIDTH).collect();
        print!("{line}");
        self.live = line.chars().count();
        // What a terminal does not show, it does not show.
        let _ = stdout().flush();
        self.said = Instant::now();
    }

    fn clear(&mut self) {
        if self.live > 0 {
            print!("\r{}\r", " ".repeat(self.live));
            self.live = 0;
        }
    }
}

/// Time since the start, as `[ 3:12]`.
fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    format!("[{:2}:{:02}]", seconds / 60, seconds % 60)
}

/// As `92 s`; short ones with a digit.
pub fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 10.0 { format!("{seconds:.1} s") } else { format!("{seconds:.0} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        assert_eq!(clock(Duration::from_secs(192)), "[ 3:12]");
        assert_eq!(clock(Duration::from_secs(4205)), "[70:05]");
        assert_eq!(duration(Duration::from_millis(2340)), "2.3 s");
        assert_eq!(duration(Duration::from_millis(92_400)), "92 s");
    }
}
