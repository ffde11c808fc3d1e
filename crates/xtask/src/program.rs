//! The program, built and run as a user runs it.

use serde_json::Value;
use std::{
    fs::File,
    path::{Path, PathBuf},
    process::{Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

/// Builds the program with a profile of cargo and says where it lies.
pub fn build(root: &Path, profile: &str) -> Result<PathBuf, String> {
    built(root, &["--profile", profile, "--package", "maille-cli"])
}

/// Builds an example. Of its package alone the libraries would have other features than in all other builds, and be compiled once more.
pub fn example(root: &Path, name: &str) -> Result<PathBuf, String> {
    built(root, &["--workspace", "--example", name])
}

fn built(root: &Path, what: &[&str]) -> Result<PathBuf, String> {
    let mut command = Command::new(cargo());
    command.arg("build").args(what).args(["--message-format", "json-render-diagnostics"]);
    command.current_dir(root).stderr(Stdio::inherit());
    let output = command.output().map_err(|e| format!("cargo did not start: {e}"))?;
    let messages = String::from_utf8_lossy(&output.stdout);
    let executables = messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let executable = executables.filter_map(|message| message["executable"].as_str().map(PathBuf::from)).next_back();
    executable
        .filter(|_| output.status.success())
        .ok_or_else(|| format!("`cargo build {}` has built no program", what.join(" ")))
}

/// The built-in designs, as a program lists them with `maille designs --json`.
pub fn designs(program: &Path) -> Result<Vec<Value>, String> {
    let listed = Command::new(program).args(["designs", "--json"]).output();
    let listed = listed.map_err(|e| format!("{} did not start: {e}", program.display()))?;
    let listed: Value =
        serde_json::from_slice(&listed.stdout).map_err(|e| format!("`maille designs --json` printed no JSON: {e}"))?;
    listed["designs"].as_array().cloned().ok_or_else(|| "`maille designs --json` lists no designs".into())
}

/// The cargo that started this, or the one in the path.
pub fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// A program of crates.io, as `mdbook@0.5.4`; installed below the build folder where it is not there.
pub fn installed(root: &Path, package: &str) -> Result<PathBuf, String> {
    let tools = target(root).join("tools").join(package);
    let name = package.split('@').next().unwrap_or(package);
    let program = tools.join("bin").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        let install = ["install", package, "--locked", "--quiet", "--root"];
        done(Command::new(cargo()).args(install).arg(&tools), &format!("install {name}"))?;
    }
    Ok(program)
}

/// Where cargo puts the program, by the name of the profile's folder.
pub fn of(root: &Path, profile: &str) -> PathBuf {
    target(root).join(profile).join(format!("maille{}", std::env::consts::EXE_SUFFIX))
}

/// Where cargo builds.
pub fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |path| root.join(path))
}

/// Runs a command to its end; `what` says in an error what could not be done.
pub fn done(command: &mut Command, what: &str) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("cannot {what}: `{}` ended with {status}", command.get_program().display())),
        Err(e) => Err(format!("cannot {what}: `{}` did not start: {e}", command.get_program().display())),
    }
}

/// How a command ended that had a time limit.
pub struct Ended {
    /// Its own status.
    pub status: ExitStatus,
    /// Whether it was asked to stop as its time was over.
    pub stopped: bool,
    /// Time that it took.
    pub wall_s: f64,
}

/// What a command may need to write its results after it was asked to stop.
const GRACE: Duration = Duration::from_secs(60);

/// Runs a command with standard output and error in files; after `limit` it gets an interrupt, as by Ctrl-C, and is killed
/// where that does not end it.
pub fn run(command: &mut Command, output: &Path, errors: &Path, limit: Duration) -> Result<Ended, String> {
    let file = |path: &Path| File::create(path).map_err(|e| format!("{} cannot be made: {e}", path.display()));
    command.stdin(Stdio::null()).stdout(file(output)?).stderr(file(errors)?);
    let begun = Instant::now();
    let mut child = command.spawn().map_err(|e| format!("{command:?} did not start: {e}"))?;
    let mut stopped = false;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|e| format!("{command:?}: {e}"))? {
            break status;
        }
        if begun.elapsed() > limit && !stopped {
            stopped = true;
            let asked = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
            if !asked.is_ok_and(|status| status.success()) {
                child.kill().map_err(|e| format!("{command:?} cannot be stopped: {e}"))?;
            }
        }
        if begun.elapsed() > limit + GRACE {
            child.kill().map_err(|e| format!("{command:?} cannot be stopped: {e}"))?;
        }
        sleep(Duration::from_millis(20));
    };
    Ok(Ended { status, stopped, wall_s: begun.elapsed().as_secs_f64() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_stopped_after_its_time() {
        let folder = std::env::temp_dir().join(format!("maille-xtask-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (out, errors) = (folder.join("out"), folder.join("errors"));
        let shell = |script: &str, limit_s: f64| {
            run(Command::new("sh").args(["-c", script]), &out, &errors, Duration::from_secs_f64(limit_s)).unwrap()
        };
        let quick = shell("echo said; echo warned >&2; exit 5", 60.0);
        assert_eq!((quick.status.code(), quick.stopped), (Some(5), false));
        assert_eq!(std::fs::read_to_string(&out).unwrap(), "said\n");
        assert_eq!(std::fs::read_to_string(&errors).unwrap(), "warned\n");
        let slow = shell("trap 'exit 7' INT; while :; do sleep 0.02; done", 0.2);
        assert_eq!((slow.status.code(), slow.stopped), (Some(7), true));
        assert!(slow.wall_s < 30.0, "{}", slow.wall_s);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
