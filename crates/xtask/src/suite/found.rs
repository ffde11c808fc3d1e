//! What there is on this machine to test with.

use crate::{program::cargo, view, view::Browser, wheel};
use std::{
    path::Path,
    process::{Command, Stdio},
};

/// Something that is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lack {
    pub what: String,
    /// How to get it.
    pub how: String,
}

/// What was looked for.
pub struct Found {
    /// `cargo nextest`.
    pub nextest: bool,
    /// A Python, and whether its packages are installed.
    pub python: Result<bool, Lack>,
    /// Node.js with npm, and whether the page's packages are installed.
    pub node: Result<bool, Lack>,
    /// A browser, and whether it is installed.
    pub browser: Result<bool, Lack>,
}

impl Found {
    /// Looks.
    pub fn look(root: &Path) -> Found {
        let python = || Lack {
            what: format!("no Python {} or later with venv", wheel::OLDEST),
            how: "install it, on Debian as python3 and python3-venv".into(),
        };
        let node = |found: String| Lack {
            what: format!("no Node.js {} or later with npm", view::OLDEST),
            how: format!("install both, from your system or from nodejs.org ({found})"),
        };
        let browser = || Lack {
            what: "no Chromium".into(),
            how: format!("as root, {}; or name a browser with CHROMIUM=PATH", view::INSTALL),
        };
        Found {
            nextest: has_nextest(root),
            python: wheel::python().map(|_| wheel::is_ready(root)).ok_or_else(python),
            node: view::node().map(|()| view::is_installed(root)).map_err(node),
            browser: match view::browser() {
                Browser::There(_) => Ok(true),
                Browser::Installable => Ok(false),
                Browser::Missing => Err(browser()),
            },
        }
    }

    /// What is lacking.
    pub fn lacks(&self) -> Vec<&Lack> {
        [&self.python, &self.node, &self.browser].into_iter().filter_map(|found| found.as_ref().err()).collect()
    }
}

fn has_nextest(root: &Path) -> bool {
    let mut probe = Command::new(cargo());
    probe.args(["nextest", "--version"]).current_dir(root).stdout(Stdio::null()).stderr(Stdio::null());
    probe.status().is_ok_and(|status| status.success())
}
