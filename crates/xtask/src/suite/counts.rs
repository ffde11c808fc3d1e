//! How many tests passed, failed and were skipped, as each runner says at its end.

use std::{iter::Sum, ops::Add};

/// Numbers of tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub passed: u64,
    pub failed: u64,
    pub skipped: u64,
}

impl Add for Counts {
    type Output = Counts;

    fn add(self, other: Counts) -> Counts {
        Counts {
            passed: self.passed + other.passed,
            failed: self.failed + other.failed,
            skipped: self.skipped + other.skipped,
        }
    }
}

impl Sum for Counts {
    fn sum<I: Iterator<Item = Counts>>(all: I) -> Counts {
        all.fold(Counts::default(), Add::add)
    }
}

impl std::fmt::Display for Counts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} passed, {} failed", self.passed, self.failed)?;
        if self.skipped > 0 { write!(f, ", {} skipped", self.skipped) } else { Ok(()) }
    }
}

/// Who runs tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runner {
    Nextest,
    /// `cargo test`, of documentation examples as well.
    Cargo,
    Pytest,
    Playwright,
}

impl Runner {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Runner::Nextest => "cargo nextest",
            Runner::Cargo => "cargo test",
            Runner::Pytest => "pytest",
            Runner::Playwright => "Playwright",
        }
    }

    /// The counts of its summary in what it printed; none if there is no summary.
    pub fn counts(self, printed: &str) -> Option<Counts> {
        let printed = plain(printed);
        match self {
            Runner::Nextest => printed.lines().rev().find_map(nextest),
            Runner::Cargo => sum(printed.lines().filter_map(cargo)),
            Runner::Pytest => printed.lines().rev().find_map(pytest),
            Runner::Playwright => sum(printed.lines().filter_map(playwright)),
        }
    }
}

/// Without the signs that colour a terminal.
fn plain(text: &str) -> String {
    let mut parts = text.split("\x1b[");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |out, part| out + part.split_once('m').map_or(part, |(_, rest)| rest))
}

/// The sum of the lines of a summary, of which there is at least one.
fn sum(lines: impl Iterator<Item = Counts>) -> Option<Counts> {
    let mut lines = lines.peekable();
    lines.peek().is_some().then(|| lines.sum())
}

/// `3 failed`, as a number and what was counted.
fn number(words: &str) -> Option<(u64, &str)> {
    let (number, what) = words.trim().split_once(' ')?;
    Some((number.parse().ok()?, what.trim()))
}

/// `Summary [  92.1s] 20 tests run: 19 passed (2 slow), 1 timed out, 4 skipped`
fn nextest(line: &str) -> Option<Counts> {
    let (_, counted) = line.trim().strip_prefix("Summary [")?.split_once(" run: ")?;
    let mut out = Counts::default();
    for (count, what) in counted.split([',', '(', ')']).filter_map(number) {
        match what {
            "passed" => out.passed = count,
            "failed" | "exec failed" | "timed out" => out.failed += count,
            "skipped" => out.skipped = count,
            // What is slow, flaky or leaky is among those.
            _ => {}
        }
    }
    Some(out)
}

/// `test result: ok. 12 passed; 0 failed; 3 ignored; 0 measured; 0 filtered out; finished in 0.01s`, for each binary
fn cargo(line: &str) -> Option<Counts> {
    let (_, counted) = line.trim().strip_prefix("test result: ")?.split_once(". ")?;
    let mut out = Counts::default();
    for (count, what) in counted.split(';').filter_map(number) {
        match what {
            "passed" => out.passed = count,
            "failed" => out.failed = count,
            "ignored" | "filtered out" => out.skipped += count,
            _ => {}
        }
    }
    Some(out)
}

/// `1 failed, 12 passed, 2 skipped in 75.20s (0:01:15)`, between equals signs or not
fn pytest(line: &str) -> Option<Counts> {
    let (counted, time) = line.trim_matches(['=', ' ']).rsplit_once(" in ")?;
    if !time.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let mut out = Counts::default();
    for part in counted.split(", ") {
        let (count, what) = number(part)?;
        match what {
            "passed" | "xfailed" => out.passed += count,
            "failed" | "error" | "errors" | "xpassed" => out.failed += count,
            "skipped" | "deselected" => out.skipped += count,
            "warning" | "warnings" => {}
            _ => return None,
        }
    }
    Some(out)
}

/// A line of its own for each count: `1 failed`, `2 did not run`, `12 passed (1.2m)`
fn playwright(line: &str) -> Option<Counts> {
    let (count, what) = number(line.split(" (").next()?)?;
    let none = Counts::default();
    match what {
        // Flaky ones passed when they were tried again.
        "passed" | "flaky" => Some(Counts { passed: count, ..none }),
        "failed" | "interrupted" => Some(Counts { failed: count, ..none }),
        "skipped" | "did not run" => Some(Counts { skipped: count, ..none }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(runner: Runner, printed: &str) -> Option<[u64; 3]> {
        runner.counts(printed).map(|c| [c.passed, c.failed, c.skipped])
    }

    #[test]
    fn nextest_is_read() {
        let of =
            |line: &str| counts(Runner::Nextest, &format!("   PASS [0.1s] a b\n{line}\n   FAIL [0.2s] c d\nerror: x"));
        assert_eq!(of("     Summary [  12.345s] 123 tests run: 123 passed, 0 skipped"), Some([123, 0, 0]));
        let all = "     Summary [   9.1s] 9/12 tests run: 5 passed (3 slow, 1 leaky), 1 failed, 2 exec failed, \
            1 timed out, 31 skipped";
        assert_eq!(of(all), Some([5, 4, 31]));
        let colours = "\x1b[32;1m     Summary\x1b[0m [   0.2s] \x1b[1m1\x1b[0m test run: \x1b[1m1\x1b[0m \
            \x1b[32;1mpassed\x1b[0m, 0 skipped";
        assert_eq!(of(colours), Some([1, 0, 0]));
        assert_eq!(of("error: could not compile `maille`"), None);
    }

    #[test]
    fn cargo_test_is_read() {
        let two = "test result: ok. 12 passed; 0 failed; 3 ignored; 0 measured; 0 filtered out; finished in 0.01s\n\
            \x20  Doc-tests maille\ntest a ... FAILED\n\
            test result: FAILED. 4 passed; 2 failed; 0 ignored; 0 measured; 1 filtered out; finished in 2.00s\n";
        assert_eq!(counts(Runner::Cargo, two), Some([16, 2, 4]));
        assert_eq!(counts(Runner::Cargo, "error: could not compile"), None);
    }

    #[test]
    fn pytest_is_read() {
        let of =
            |line: &str| counts(Runner::Pytest, &format!("....s.  [100%]\nFAILED a.py::b - passed in 3\n{line}\n"));
        assert_eq!(of("120 passed in 75.20s (0:01:15)"), Some([120, 0, 0]));
        assert_eq!(of("==== 1 failed, 12 passed, 2 skipped, 3 warnings, 1 error in 0.12s ===="), Some([12, 2, 2]));
        assert_eq!(of("no tests ran in 0.01s"), None);
        assert_eq!(counts(Runner::Pytest, "....\nmeasured in 3 runs\n"), None);
    }

    #[test]
    fn playwright_is_read() {
        let printed = "Running 15 tests using 1 worker\n\n  ✓   1 tests/draw.spec.ts:3:1 › 12 passed (2.3s)\n\n  1 failed\n    \
            tests/looks.spec.ts:9:1 › looks ───\n  1 flaky\n  2 did not run\n  3 skipped\n  8 passed (1.2m)\n";
        assert_eq!(counts(Runner::Playwright, printed), Some([9, 1, 5]));
        assert_eq!(counts(Runner::Playwright, "Error: no browser\n"), None);
    }

    #[test]
    fn a_sum_is_one_line() {
        let one = Counts { passed: 3, failed: 1, skipped: 0 };
        assert_eq!(one.to_string(), "3 passed, 1 failed");
        let all: Counts = [one, Counts { passed: 4, failed: 0, skipped: 2 }].into_iter().sum();
        assert_eq!(all.to_string(), "7 passed, 1 failed, 2 skipped");
    }
}
