//! The Python package: its wheel, built, installed into an environment of its own, tried and tested.

use crate::program::{self, done, target};
use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Folder of the package.
const PACKAGE: &str = "crates/maille-py";
/// What is installed beside the wheel, the build backend and what the tests need, with versions and hashes.
const LOCK: &str = "crates/maille-py/requirements.lock";
/// The file in an environment that says what is installed.
const READY: &str = "ready";
/// The oldest Python that the package runs on, and programs that may be one.
pub const OLDEST: &str = "3.10";
const PYTHONS: &[&str] = &["python3", "python", "python3.13", "python3.12", "python3.11", "python3.10"];
/// Debian has venv without ensurepip where python3-venv is not installed.
const NEW_ENOUGH: &str = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))";

/// A Python from which an environment can be made.
pub fn python() -> Option<&'static str> {
    let is_new = |name: &&&str| {
        let probe = Command::new(name).args(["-c", NEW_ENOUGH]).stderr(Stdio::null()).status();
        probe.is_ok_and(|status| status.success())
    };
    PYTHONS.iter().find(is_new).copied()
}

/// Whether the environment has what the lockfile says.
pub fn is_ready(root: &Path) -> bool {
    let installed = std::fs::read_to_string(target(root).join("python").join(READY));
    installed.is_ok_and(|installed| std::fs::read_to_string(root.join(LOCK)).is_ok_and(|wanted| installed == wanted))
}

/// An environment with the wheel in it.
pub struct Environment {
    root: PathBuf,
    folder: PathBuf,
}

impl Environment {
    /// The environment without the wheel. With `clean` it is made anew; else one that is there is used again.
    pub fn there(root: &Path, clean: bool) -> Result<Self, String> {
        let out = Environment { root: root.to_owned(), folder: target(root).join("python") };
        if clean || !is_ready(root) {
            out.create()?;
            let (lock, ready) = (root.join(LOCK), out.folder.join(READY));
            std::fs::copy(&lock, &ready).map_err(|e| format!("cannot write {}: {e}", ready.display()))?;
        }
        Ok(out)
    }

    /// Builds the wheel with the profile of the tests and installs it into the environment.
    pub fn new(root: &Path, clean: bool) -> Result<Self, String> {
        let out = Self::there(root, clean)?;
        let wheels = out.folder.join("wheels");
        if wheels.is_dir() {
            std::fs::remove_dir_all(&wheels).map_err(|e| format!("cannot empty {}: {e}", wheels.display()))?;
        }
        let manifest = root.join(PACKAGE).join("Cargo.toml");
        let arguments = [OsStr::new("build"), "--profile".as_ref(), "dev".as_ref(), "--locked".as_ref()];
        let places = ["--manifest-path".as_ref(), manifest.as_os_str(), "--out".as_ref(), wheels.as_os_str()];
        out.run(Command::new(out.program("maturin")).args(arguments).args(places), "build the wheel")?;
        let wheel = std::fs::read_dir(&wheels).ok().and_then(|mut files| files.next()?.ok());
        let wheel = wheel.ok_or_else(|| format!("maturin has left no wheel in {}", wheels.display()))?.path();
        let install = ["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"];
        out.run(out.python().args(install).arg(&wheel), "install the wheel")?;
        Ok(out)
    }

    fn create(&self) -> Result<(), String> {
        self.make()?;
        self.add(LOCK)
    }

    fn make(&self) -> Result<(), String> {
        let Some(python) = python() else {
            return Err(format!(
                "no Python of {OLDEST} or later with its module venv was found; install one, as python3 and python3-venv of \
                 the system"
            ));
        };
        self.run(Command::new(python).args(["-m", "venv", "--clear"]).arg(&self.folder), "make an environment")
    }

    /// An environment below the build folder with the programs of a lockfile alone.
    pub fn of_tools(root: &Path, name: &str, lock: &str) -> Result<Self, String> {
        let out = Environment { root: root.to_owned(), folder: target(root).join(format!("python-{name}")) };
        out.make()?;
        out.add(lock)?;
        Ok(out)
    }

    /// A command that finds the environment's programs.
    pub fn tool(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        let own = self.program("python").parent().map(Path::to_path_buf).into_iter();
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders: Vec<PathBuf> = own.chain(std::env::split_paths(&path)).collect();
        if let Ok(path) = std::env::join_paths(folders) {
            command.env("PATH", path);
        }
        command
    }

    /// Installs more packages, as a lockfile names them.
    pub fn add(&self, lock: &str) -> Result<(), String> {
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--require-hashes", "-r"];
        let done = self.run(self.python().args(install).arg(self.root.join(lock)), "install packages");
        done.map_err(|e| {
            format!("{e}\npip must reach a package index, or find wheels by PIP_FIND_LINKS; wanted: those of {lock}")
        })
    }

    /// A program of the environment.
    pub fn program(&self, name: &str) -> PathBuf {
        if cfg!(windows) { self.folder.join("Scripts").join(name) } else { self.folder.join("bin").join(name) }
    }

    /// Its Python.
    pub fn python(&self) -> Command {
        Command::new(self.program("python"))
    }

    /// Runs the examples of the package.
    pub fn examples(&self) -> Result<(), String> {
        for file in
            crate::repository::files(&self.root, &format!("{PACKAGE}/examples"), "py").map_err(|e| e.to_string())?
        {
            println!("   {file}");
            self.run(self.python().arg(self.root.join(&file)).current_dir(&self.folder), &format!("run {file}"))?;
        }
        Ok(())
    }

    /// Runs the tests of the package and the examples of its docstrings. Maps are compared with those of the program, which
    /// the step `build` has built.
    pub fn test(&self) -> Result<(), String> {
        let program = program::of(&self.root, "debug");
        let pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--doctest-modules", "--pyargs", "maille"];
        let tests = self.root.join(PACKAGE).join("tests");
        let mut command = self.python();
        command.args(pytest).arg(tests).env("MAILLE", program).env("MPLBACKEND", "Agg").current_dir(&self.folder);
        self.run(&mut command, "test the Python package")
    }

    /// Runs a command to its end; `what` says in an error what could not be done.
    pub fn run(&self, command: &mut Command, what: &str) -> Result<(), String> {
        done(command.env("PYTHONDONTWRITEBYTECODE", "1"), what)
    }
}
