//! Runs steps beside each other, each as soon as what it needs is there and cores are free.

use super::{
    counts::Counts,
    progress::{Progress, duration},
    step::{Ended, Outcome, Step},
};
use std::{
    fs::{self, File},
    io::{self, Write},
    path::Path,
    process::{Child, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

/// Cores that steps share: two of one core each run beside each other, one of two alone.
pub const CORES: usize = 2;
/// How often it is looked what has ended.
const TICK: Duration = Duration::from_millis(50);

struct Running {
    step: Step,
    child: Child,
    begun: Instant,
}

/// The steps by what has become of them.
struct House<'a> {
    logs: &'a Path,
    progress: &'a mut Progress,
    waiting: Vec<Step>,
    running: Vec<Running>,
    ended: Vec<Ended>,
}

/// Runs all steps, and says how each ended, in the order in which they are given. Of those that may start, the first
/// does.
pub fn run(steps: Vec<Step>, logs: &Path, progress: &mut Progress) -> Vec<Ended> {
    let order: Vec<&str> = steps.iter().map(|step| step.name).collect();
    let mut house = House { logs, progress, waiting: steps, running: Vec::new(), ended: Vec::new() };
    while !house.waiting.is_empty() || !house.running.is_empty() {
        house.start();
        assert!(!house.running.is_empty() || house.waiting.is_empty(), "steps wait for each other");
        sleep(TICK);
        house.collect();
    }
    house.ended.sort_by_key(|ended| order.iter().position(|name| *name == ended.name));
    house.ended
}

impl House<'_> {
    /// Starts what may start.
    fn start(&mut self) {
        let mut index = 0;
        while index < self.waiting.len() {
            if !self.may_start(&self.waiting[index]) {
                index += 1;
                continue;
            }
            let step = self.waiting.remove(index);
            match self.hindrance(&step) {
                Some(outcome) => self.end(&step, outcome, Duration::ZERO, Counts::default()),
                None => self.spawn(step),
            }
            // Those before it may have waited for it.
            index = 0;
        }
    }

    /// Whether nothing is waited for any more; what is skipped needs no cores.
    fn may_start(&self, step: &Step) -> bool {
        let open = |name: &&str| {
            self.waiting.iter().any(|step| step.name == *name) || self.running.iter().any(|r| r.step.name == *name)
        };
        let used: usize = self.running.iter().map(|running| running.step.cores).sum();
        let free = step.cores == 0 || used + step.cores <= CORES || used == 0;
        step.skip.is_some() || free && !step.needs.iter().chain(&step.after).any(open)
    }

    /// Why a step cannot run.
    fn hindrance(&self, step: &Step) -> Option<Outcome> {
        let needed = self.ended.iter().filter(|ended| step.needs.contains(&ended.name));
        let of_needed = needed.map(|ended| match &ended.outcome {
            Outcome::Ok => None,
            Outcome::Failed(_) => Some(Outcome::Blocked(ended.name)),
            Outcome::Blocked(name) => Some(Outcome::Blocked(name)),
            Outcome::Skipped(reason) => Some(Outcome::Skipped(reason.clone())),
        });
        step.skip.clone().map(Outcome::Skipped).or_else(|| of_needed.flatten().next())
    }

    fn spawn(&mut self, mut step: Step) {
        let log = self.logs.join(step.log());
        match start(&mut step, &log) {
            Ok(child) => {
                self.progress.say(&format!("{}: started", step.name));
                self.running.push(Running { step, child, begun: Instant::now() });
            }
            Err(e) => {
                let problem = format!("`{}` did not start: {e}", step.line());
                self.end(&step, Outcome::Failed(problem), Duration::ZERO, Counts::default());
            }
        }
    }

    /// Notes what has ended, and says what is running.
    fn collect(&mut self) {
        let mut index = 0;
        while index < self.running.len() {
            let status = match self.running[index].child.try_wait() {
                Ok(None) => {
                    index += 1;
                    continue;
                }
                Ok(Some(status)) => Ok(status),
                Err(e) => Err(e),
            };
            let Running { step, begun, .. } = self.running.remove(index);
            let (outcome, counts) = judge(&step, status, &self.logs.join(step.log()));
            self.end(&step, outcome, begun.elapsed(), counts);
        }
        let running: Vec<_> = self.running.iter().map(|r| (r.step.name, r.begun.elapsed())).collect();
        self.progress.running(&running);
    }

    fn end(&mut self, step: &Step, outcome: Outcome, time: Duration, counts: Counts) {
        let words = match &outcome {
            Outcome::Ok => format!("ok in {}", duration(time)),
            Outcome::Failed(_) => format!("FAILED in {}", duration(time)),
            Outcome::Skipped(reason) => format!("skipped ({reason})"),
            Outcome::Blocked(name) => format!("not run ({name} has failed)"),
        };
        self.progress.say(&format!("{}: {words}", step.name));
        let log = self.logs.join(step.log());
        self.ended.push(Ended { name: step.name, outcome, wall_s: time.as_secs_f64(), counts, log });
    }
}

/// Starts a step, with all that it prints in its log.
fn start(step: &mut Step, log: &Path) -> io::Result<Child> {
    if let Some(folder) = log.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut file = File::create(log)?;
    writeln!(file, "$ {}", step.line())?;
    // A log is read without colours. No more is said about them, for tests see the environment.
    step.command.env("CARGO_TERM_COLOR", "never").env("CARGO_TERM_PROGRESS_WHEN", "never");
    step.command.stdin(Stdio::null()).stdout(file.try_clone()?).stderr(file).spawn()
}

/// How a step ended, with the tests of its log. A runner that ends well and leaves no summary has failed.
fn judge(step: &Step, status: io::Result<ExitStatus>, log: &Path) -> (Outcome, Counts) {
    let printed = fs::read(log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let counts = step.runner.map(|runner| (runner, runner.counts(&printed)));
    let outcome = match (status, counts) {
        (Ok(status), _) if !status.success() => Outcome::Failed(format!("ended with {status}")),
        (Err(e), _) => Outcome::Failed(format!("cannot be waited for: {e}")),
        (_, Some((runner, None))) => {
            Outcome::Failed(format!("ended well, but the summary of {} was not found in its log", runner.name()))
        }
        _ => Outcome::Ok,
    };
    (outcome, counts.and_then(|(_, counts)| counts).unwrap_or_default())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::{folder::remove, suite::counts::Runner};
    use std::{path::PathBuf, process::Command};

    fn shell(name: &'static str, script: &str) -> Step {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        Step::new(name, command)
    }

    /// Runs steps in an empty folder; gives their ends and the folder.
    fn of(name: &str, steps: Vec<Step>) -> (Vec<Ended>, PathBuf) {
        let folder = std::env::temp_dir().join(format!("maille-suite-{name}-{}", std::process::id()));
        remove(&folder).unwrap();
        (run(steps, &folder, &mut Progress::new()), folder)
    }

    #[test]
    fn steps_wait_for_what_they_need_and_write_logs() {
        let folder = std::env::temp_dir().join(format!("maille-suite-mark-{}", std::process::id()));
        let mark = folder.display();
        remove(&folder).unwrap();
        let steps = vec![
            shell("read it", &format!("test -d {mark} && echo read && echo warned >&2")).needs(&["make"]),
            shell("make", &format!("sleep 0.2; mkdir {mark}")).cores(2),
            shell("first", &format!("test ! -d {mark}")).cores(0),
        ];
        let (ended, logs) = of("waits", steps);
        assert!(ended.iter().all(|step| step.outcome == Outcome::Ok), "{ended:?}");
        assert_eq!(ended.iter().map(|step| step.name).collect::<Vec<_>>(), ["read it", "make", "first"]);
        let text = fs::read_to_string(logs.join("read-it.log")).unwrap();
        assert!(text.starts_with("$ sh -c test -d") && text.ends_with("\nread\nwarned\n"), "{text}");
        remove(&logs).unwrap();
        remove(&folder).unwrap();
    }

    #[test]
    fn what_needs_a_failed_step_is_not_run_and_all_else_is() {
        let steps = vec![
            shell("bad", "exit 7"),
            shell("needs", "true").needs(&["bad"]),
            shell("deeper", "true").needs(&["needs"]),
            shell("later", "true").after(&["bad", "needs"]),
            shell("absent", "true").needs(&["nowhere"]),
            Step { skip: Some("no reason".into()), ..shell("cannot", "true") },
            shell("neither", "true").needs(&["cannot"]),
            Step::new("nothing", Command::new("/nowhere/at/all")),
        ];
        let (ended, logs) = of("needs", steps);
        let outcomes: Vec<Outcome> = ended.into_iter().map(|step| step.outcome).collect();
        let skipped = Outcome::Skipped("no reason".into());
        assert!(matches!(&outcomes[0], Outcome::Failed(why) if why.contains('7')));
        assert_eq!(outcomes[1..3], [Outcome::Blocked("bad"), Outcome::Blocked("bad")]);
        assert_eq!(outcomes[3..7], [Outcome::Ok, Outcome::Ok, skipped.clone(), skipped]);
        assert!(matches!(&outcomes[7], Outcome::Failed(why) if why.contains("did not start")));
        remove(&logs).unwrap();
    }

    #[test]
    fn tests_are_counted_and_a_missing_summary_is_a_failure() {
        let steps = vec![
            shell("counted", "echo '3 passed, 1 skipped in 0.1s'").tests(Runner::Pytest),
            shell("silent", "echo done").tests(Runner::Nextest),
            shell("failing", "echo '  2 failed'; echo '  5 passed (1s)'; exit 1").tests(Runner::Playwright),
        ];
        let (ended, logs) = of("counts", steps);
        assert_eq!(ended[0].counts, Counts { passed: 3, failed: 0, skipped: 1 });
        assert!(matches!(&ended[1].outcome, Outcome::Failed(why) if why.contains("summary of cargo nextest")));
        assert!(matches!(&ended[2].outcome, Outcome::Failed(_)));
        assert_eq!(ended[2].counts, Counts { passed: 5, failed: 2, skipped: 0 });
        remove(&logs).unwrap();
    }
}
