//! The viewer: its page, the program with the page inside, and what a user does with it in a browser.

use crate::program::{self, cargo, done};
use std::{
    env, fs,
    hash::{DefaultHasher, Hash, Hasher},
    io,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Folder of the page.
const PAGE: &str = "crates/maille-view/web";
/// The oldest Node.js that builds it.
pub const OLDEST: &str = "20.19";
/// What is installed for it, by npm; and files that say what was installed and built last.
const LOCK: &str = "package-lock.json";
const INSTALLED: &str = "node_modules/.maille-lock";
const BUILT: &str = "node_modules/.maille-page";
/// What the page depends on, and where it is built.
const SOURCES: &[&str] = &["index.html", "src", "vite.config.ts", "tsconfig.json", "package.json", LOCK, "dist"];
/// How Chromium is installed on Debian.
pub const INSTALL: &str = "apt-get update && apt-get install -y --no-install-recommends chromium";
/// Programs that may be the browser of the tests.
const BROWSERS: &[&str] = &["chromium", "chromium-browser", "google-chrome-stable", "google-chrome"];

/// Builds the page and the program; says where the program lies.
pub fn build(root: &Path) -> Result<PathBuf, String> {
    page(root)?;
    let build = ["build", "--release", "--package", "maille-cli", "--features", "view", "--locked"];
    done(Command::new(cargo()).args(build).current_dir(root), "build the program with the viewer")?;
    Ok(program::of(root, "release"))
}

/// Checks the page's types.
pub fn check_types(root: &Path) -> Result<(), String> {
    npm(root, &["run", "check"])
}

/// Runs the page's tests in a browser, with the program that the step `build` has built.
pub fn test(root: &Path) -> Result<(), String> {
    let mut command = Command::new("npm");
    command.args(["run", "test"]).current_dir(root.join(PAGE));
    done(command.env("MAILLE", program::of(root, "debug")).env("CHROMIUM", installed_browser()?), "test the viewer")
}

/// Builds the script of the atlas's page.
pub fn atlas(root: &Path, folder: &Path) -> Result<(), String> {
    let mut command = Command::new("npm");
    command.args(["--silent", "run", "atlas"]).current_dir(root.join(PAGE)).env("OUT", folder);
    done(&mut command, "build the atlas's page")
}

/// Reads the static site in a browser: its links, its looks, its viewers.
pub fn check_site(root: &Path, site: &Path) -> Result<(), String> {
    let browser = installed_browser()?;
    let mut command = Command::new("npm");
    command.args(["run", "site"]).current_dir(root.join(PAGE)).env("SITE", site).env("CHROMIUM", browser);
    done(&mut command, "check the site")
}

/// Looks for a Node.js that is new enough, and npm; says what was found instead.
pub fn node() -> Result<(), String> {
    let node = Command::new("node").args(["-p", "process.versions.node"]).stderr(Stdio::null()).output();
    let found = node.ok().filter(|out| out.status.success());
    let found = found.map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned()).ok_or("there is no Node.js")?;
    let number = |text: &str| -> Vec<u32> { text.split('.').map(|n| n.parse().unwrap_or(0)).collect() };
    if number(&found) < number(OLDEST) {
        return Err(format!("this is {found}"));
    }
    find(&["npm"]).map(drop).ok_or_else(|| "there is no npm".into())
}

/// Installs what the page is built with, as its lockfile says, and builds the page if it is another.
///
/// A page that is the same is left as it is: cargo would compile the viewer anew for a newer file.
pub fn page(root: &Path) -> Result<(), String> {
    node().map_err(|found| {
        format!("the viewer's page needs Node.js {OLDEST} or later with npm; {found}: install both from your system")
    })?;
    if !is_installed(root) {
        npm(root, &["ci", "--no-audit", "--no-fund"])?;
        write(root, INSTALLED, &read(root, LOCK).unwrap_or_default())?;
    }
    if read(root, BUILT).is_none_or(|built| Ok(built) != state(root)) {
        npm(root, &["run", "build"])?;
        write(root, BUILT, &state(root)?)?;
    }
    Ok(())
}

/// Whether what the lockfile says is installed.
pub fn is_installed(root: &Path) -> bool {
    read(root, INSTALLED).is_some_and(|installed| read(root, LOCK) == Some(installed))
}

fn read(root: &Path, name: &str) -> Option<String> {
    fs::read_to_string(root.join(PAGE).join(name)).ok()
}

fn write(root: &Path, name: &str, text: &str) -> Result<(), String> {
    let path = root.join(PAGE).join(name);
    fs::write(&path, text).map_err(|e| format!("cannot write {}: {e}", path.display()))
}

/// A number that changes with what the page is built of and with what was built.
fn state(root: &Path) -> Result<String, String> {
    let folder = root.join(PAGE);
    let mut hasher = DefaultHasher::new();
    for name in SOURCES {
        hash(&folder.join(name), &mut hasher).map_err(|e| format!("{name} cannot be read: {e}"))?;
    }
    Ok(format!("{:016x}", hasher.finish()))
}

/// Adds a file, or all files below a folder, with their names.
fn hash(path: &Path, hasher: &mut DefaultHasher) -> io::Result<()> {
    path.file_name().hash(hasher);
    if !path.is_dir() {
        fs::read(path)?.hash(hasher);
        return Ok(());
    }
    let mut entries = fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    entries.sort();
    entries.iter().try_for_each(|entry| hash(entry, hasher))
}

fn npm(root: &Path, arguments: &[&str]) -> Result<(), String> {
    // Browsers come from the system.
    let mut command = Command::new("npm");
    command.arg("--silent").args(arguments).current_dir(root.join(PAGE)).env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1");
    done(&mut command, &format!("run npm {}", arguments.join(" ")))
}

/// What there is to be driven by the tests.
pub enum Browser {
    There(PathBuf),
    /// Apt may install one.
    Installable,
    Missing,
}

/// Looks for a browser: the one that CHROMIUM names, or one of the system.
pub fn browser() -> Browser {
    if let Some(path) = env::var_os("CHROMIUM").map(PathBuf::from).or_else(|| find(BROWSERS)) {
        return Browser::There(path);
    }
    let root = Command::new("id").arg("-u").output().is_ok_and(|out| out.stdout.trim_ascii() == b"0");
    if root && find(&["apt-get"]).is_some() { Browser::Installable } else { Browser::Missing }
}

/// The browser; where apt may install one, it does.
pub fn installed_browser() -> Result<PathBuf, String> {
    match browser() {
        Browser::There(path) => return Ok(path),
        Browser::Installable => {
            let mut install = Command::new("sh");
            install.args(["-c", INSTALL]).env("DEBIAN_FRONTEND", "noninteractive");
            done(&mut install, "install Chromium")?;
        }
        Browser::Missing => {}
    }
    find(BROWSERS).ok_or_else(|| {
        format!(
            "the viewer's tests need Chromium; on Debian, as root:\n  {INSTALL}\nor name a browser with CHROMIUM=PATH"
        )
    })
}

fn find(names: &[&str]) -> Option<PathBuf> {
    let folders: Vec<PathBuf> = env::split_paths(&env::var_os("PATH")?).collect();
    let places = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    places.into_iter().find(|path| path.is_file())
}
