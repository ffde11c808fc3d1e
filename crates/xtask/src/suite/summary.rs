//! What is said at the end: the logs of steps that failed, how each step ended, and how many tests passed.

use super::{
    counts::Counts,
    progress::duration,
    step::{Ended, Outcome},
};
use std::{fmt::Write, fs, path::Path, time::Duration};

/// Lines of a log that are printed.
const TAIL: usize = 200;

/// Exit codes: all ran and passed, something failed, something was skipped.
pub const PASSED: u8 = 0;
pub const FAILED: u8 = 1;
pub const SKIPPED: u8 = 3;

/// The exit code. With `strict` what was skipped has failed.
pub fn code(ended: &[Ended], strict: bool) -> u8 {
    let any = |of: fn(&Outcome) -> bool| ended.iter().any(|step| of(&step.outcome));
    if any(|outcome| matches!(outcome, Outcome::Failed(_) | Outcome::Blocked(_))) {
        return FAILED;
    }
    match any(|outcome| matches!(outcome, Outcome::Skipped(_))) {
        true if strict => FAILED,
        true => SKIPPED,
        false => PASSED,
    }
}

/// The text, which ends with the counts on a line of their own.
pub fn text(ended: &[Ended], strict: bool) -> String {
    let mut out = logs(ended);
    out += "\nSummary\n";
    let width = ended.iter().map(|step| step.name.chars().count()).max().unwrap_or(0);
    for step in ended {
        let _ = writeln!(out, "  {:width$}  {}", step.name, words(step));
    }
    let skipped = skipped(ended);
    if !skipped.is_empty() {
        let verdict = if strict { "; here that is a failure" } else { "" };
        let _ = writeln!(out, "Not everything was tested: {skipped}{verdict}");
    }
    let counts: Counts = ended.iter().map(|step| step.counts).sum();
    let _ = writeln!(out, "{counts}");
    out
}

fn words(step: &Ended) -> String {
    let time = duration(Duration::from_secs_f64(step.wall_s));
    match &step.outcome {
        Outcome::Ok => format!("ok in {time}"),
        Outcome::Failed(why) => format!("FAILED in {time}: {why}; {}", step.log.display()),
        Outcome::Skipped(reason) => format!("skipped ({reason})"),
        Outcome::Blocked(name) => format!("FAILED: not run, as {name} has failed"),
    }
}

/// What was skipped, by reason.
fn skipped(ended: &[Ended]) -> String {
    let mut out: Vec<(&str, Vec<&str>)> = Vec::new();
    for step in ended {
        let Outcome::Skipped(reason) = &step.outcome else { continue };
        match out.iter_mut().find(|(known, _)| known == reason) {
            Some((_, names)) => names.push(step.name),
            None => out.push((reason, vec![step.name])),
        }
    }
    let parts = out.iter().map(|(reason, names)| format!("{} ({reason})", names.join(", ")));
    parts.collect::<Vec<_>>().join("; ")
}

/// The ends of the logs of steps that failed, in the order of the steps.
fn logs(ended: &[Ended]) -> String {
    let mut out = String::new();
    for step in ended.iter().filter(|step| matches!(step.outcome, Outcome::Failed(_))) {
        let _ = writeln!(out, "\n── {}: {}", step.name, words(step));
        out += &tail(&step.log);
    }
    out
}

/// The last lines of a log.
fn tail(log: &Path) -> String {
    let Ok(bytes) = fs::read(log) else { return String::new() };
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().collect();
    let from = lines.len().saturating_sub(TAIL);
    let before = if from > 0 { format!("… {from} lines before\n") } else { String::new() };
    before + &lines[from..].iter().map(|line| format!("{line}\n")).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folder::remove;
    use std::path::PathBuf;

    fn step(name: &'static str, outcome: Outcome, passed: u64, log: PathBuf) -> Ended {
        Ended { name, outcome, wall_s: 12.0, counts: Counts { passed, failed: 0, skipped: 0 }, log }
    }

    #[test]
    fn the_exit_code_tells_skipped_from_failed() {
        let of = |outcomes: &[Outcome], strict| {
            let ended: Vec<Ended> = outcomes.iter().map(|o| step("a", o.clone(), 0, PathBuf::new())).collect();
            code(&ended, strict)
        };
        let (skipped, failed) = (Outcome::Skipped("no Node".into()), Outcome::Failed("why".into()));
        assert_eq!(of(&[Outcome::Ok, Outcome::Ok], true), PASSED);
        assert_eq!(of(&[Outcome::Ok, skipped.clone()], false), SKIPPED);
        assert_eq!(of(&[Outcome::Ok, skipped.clone()], true), FAILED);
        assert_eq!(of(&[failed, skipped.clone()], false), FAILED);
        assert_eq!(of(&[Outcome::Blocked("a"), skipped], false), FAILED);
    }

    #[test]
    fn the_counts_stand_alone_at_the_end() {
        let ended = [
            step("build", Outcome::Ok, 0, PathBuf::new()),
            step("Rust tests", Outcome::Ok, 20, PathBuf::new()),
            step("Python tests", Outcome::Skipped("no Python".into()), 0, PathBuf::new()),
            step("examples", Outcome::Ok, 3, PathBuf::new()),
            step("wheel", Outcome::Skipped("no Python".into()), 0, PathBuf::new()),
        ];
        let text = text(&ended, false);
        let expected = "\nSummary\n  build         ok in 12 s\n  Rust tests    ok in 12 s\n  \
            Python tests  skipped (no Python)\n  examples      ok in 12 s\n  wheel         skipped (no Python)\n\
            Not everything was tested: Python tests, wheel (no Python)\n23 passed, 0 failed\n";
        assert_eq!(text, expected);
        assert!(super::text(&ended, true).contains("(no Python); here that is a failure\n"));
        assert!(!super::text(&ended[..2], false).contains("Not everything"));
    }

    #[test]
    fn logs_of_failures_come_before_the_summary_in_the_order_of_the_steps() {
        let folder = std::env::temp_dir().join(format!("maille-summary-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let log = |name: &str, text: &str| {
            fs::write(folder.join(name), text).unwrap();
            folder.join(name)
        };
        let long: String = (0..500).map(|k| format!("line {k}\n")).collect();
        let ended = [
            step("one", Outcome::Failed("ended with 1".into()), 0, log("one.log", &long)),
            step("two", Outcome::Ok, 1, log("two.log", "fine\n")),
            step("three", Outcome::Failed("ended with 2".into()), 0, log("three.log", "broken\n")),
            step("four", Outcome::Blocked("three"), 0, folder.join("four.log")),
        ];
        let text = text(&ended, false);
        remove(&folder).unwrap();
        let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part} in {text}"));
        assert!(at("── one: FAILED in 12 s: ended with 1; ") < at("… 300 lines before\nline 300\n"));
        assert!(at("line 499\n\n── three: ") < at("broken\n\nSummary\n"));
        assert!(at("Summary") < at("  four   FAILED: not run, as three has failed\n1 passed, 0 failed\n"));
        assert!(text.contains("one.log") && !text.contains("line 299\n") && !text.contains("fine"));
    }
}
