//! The viewer: its page, the program with the page inside, and what a user does with it in a browser.

use crate::program::{cargo, done, target};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Folder of the page.
const PAGE: &str = "crates/maille-view/web";
/// Programs that may be the browser of the tests.
const BROWSERS: &[&str] = &["chromium", "chromium-browser", "google-chrome-stable", "google-chrome"];

/// Builds the page and the program; says where the program lies.
pub fn build(root: &Path) -> Result<PathBuf, String> {
    page(root)?;
    program(root, &["--release"])?;
    Ok(target(root).join("release").join(name()))
}

/// Builds both with the profile of the tests, checks the page's types, and runs its tests in a browser.
pub fn test(root: &Path) -> Result<(), String> {
    let browser = browser()?;
    page(root)?;
    npm(root, &["run", "check"])?;
    program(root, &[])?;
    // A copy: the other tests build the program without the viewer in its place.
    let built = target(root).join("debug").join(name());
    let copy = target(root).join("debug").join(format!("view-{}", name()));
    fs::copy(&built, &copy).map_err(|e| format!("cannot copy {}: {e}", built.display()))?;
    let mut command = Command::new("npm");
    command.args(["run", "test"]).current_dir(root.join(PAGE)).env("MAILLE", copy).env("CHROMIUM", browser);
    done(&mut command, "test the viewer")
}

/// Builds the script of the atlas's page.
pub fn atlas(root: &Path, folder: &Path) -> Result<(), String> {
    let mut command = Command::new("npm");
    command.args(["--silent", "run", "atlas"]).current_dir(root.join(PAGE)).env("OUT", folder);
    done(&mut command, "build the atlas's page")
}

/// Reads the static site in a browser: its links, its looks, its viewers.
pub fn check_site(root: &Path, site: &Path) -> Result<(), String> {
    let browser = browser()?;
    let mut command = Command::new("npm");
    command.args(["run", "site"]).current_dir(root.join(PAGE)).env("SITE", site).env("CHROMIUM", browser);
    done(&mut command, "check the site")
}

/// Installs what the page is built with, as its lockfile says, and builds it.
pub fn page(root: &Path) -> Result<(), String> {
    let node = Command::new("node").args(["-p", "process.versions.node"]).stderr(Stdio::null()).output();
    let found =
        node.ok().filter(|out| out.status.success()).map(|out| String::from_utf8_lossy(&out.stdout).into_owned());
    let mut numbers = found.iter().flat_map(|text| text.trim().split('.')).map(|n| n.parse::<u32>().unwrap_or(0));
    if (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) < (20, 19) {
        let found = found.map_or("there is none".to_owned(), |version| format!("this is {}", version.trim()));
        return Err(format!(
            "the viewer's page needs Node.js 20.19 or later with npm; {found}: install both from your system"
        ));
    }
    // What is installed is that of the lockfile, or is installed anew.
    let read = |name: &str| fs::read_to_string(root.join(PAGE).join(name)).ok();
    if read("node_modules/.maille-lock").is_none() || read("node_modules/.maille-lock") != read("package-lock.json") {
        npm(root, &["ci", "--no-audit", "--no-fund"])?;
        let lock = read("package-lock.json").unwrap_or_default();
        let mark = root.join(PAGE).join("node_modules/.maille-lock");
        fs::write(&mark, lock).map_err(|e| format!("cannot write {}: {e}", mark.display()))?;
    }
    npm(root, &["run", "build"])
}

fn npm(root: &Path, arguments: &[&str]) -> Result<(), String> {
    // Browsers come from the system.
    let mut command = Command::new("npm");
    command.arg("--silent").args(arguments).current_dir(root.join(PAGE)).env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1");
    done(&mut command, &format!("run npm {}", arguments.join(" ")))
}

fn program(root: &Path, profile: &[&str]) -> Result<(), String> {
    let build = ["build", "--package", "maille-cli", "--features", "view", "--locked"];
    done(Command::new(cargo()).args(build).args(profile).current_dir(root), "build the program with the viewer")
}

fn name() -> String {
    format!("maille{}", env::consts::EXE_SUFFIX)
}

/// The browser of the system; where apt may install one, it does.
fn browser() -> Result<PathBuf, String> {
    if let Some(named) = env::var_os("CHROMIUM") {
        return Ok(named.into());
    }
    if let Some(found) = find(BROWSERS) {
        return Ok(found);
    }
    let install = "apt-get update && apt-get install -y --no-install-recommends chromium";
    let root = Command::new("id").arg("-u").output().is_ok_and(|out| out.stdout.trim_ascii() == b"0");
    if root && find(&["apt-get"]).is_some() {
        done(Command::new("sh").args(["-c", install]).env("DEBIAN_FRONTEND", "noninteractive"), "install Chromium")?;
    }
    find(BROWSERS).ok_or_else(|| {
        format!(
            "the viewer's tests need Chromium; on Debian, as root:\n  {install}\nor name a browser with CHROMIUM=PATH"
        )
    })
}

fn find(names: &[&str]) -> Option<PathBuf> {
    let folders: Vec<PathBuf> = env::split_paths(&env::var_os("PATH")?).collect();
    let places = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    places.into_iter().find(|path| path.is_file())
}
