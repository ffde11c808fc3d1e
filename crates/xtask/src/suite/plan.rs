//! What is said before anything is done.

use super::{
    found::Found,
    step::{Kind, Step},
};
use std::{collections::BTreeMap, fmt::Write, path::Path};

/// How long it takes, for a reader who wonders whether to wait.
fn time(kind: Kind) -> &'static str {
    match kind {
        Kind::Ci => "about 20 minutes on two cores from nothing",
        Kind::Test => "about 17 minutes on two cores from nothing, 10 when all is built",
        Kind::All => "an hour or more on two cores",
    }
}

const DISK: &str = "several GB in the build folder, 1 GB of it for Python";

/// The plan.
pub fn text(found: &Found, steps: &[Step], target: &Path, logs: &Path, kind: Kind) -> String {
    let skipped = skipped(steps);
    let planned = steps.iter().map(|step| step.name).filter(|name| !skipped.contains_key(name));
    let runner = if found.nextest { "cargo nextest" } else { "cargo test, for there is no cargo nextest" };
    let mut out = String::new();
    let _ = writeln!(out, "Steps     {}", planned.collect::<Vec<_>>().join(", "));
    let _ = writeln!(out, "Time      {}", time(kind));
    let _ = writeln!(out, "Disk      {DISK}: {}", target.display());
    let _ = writeln!(out, "Logs      {}", logs.join("<step>.log").display());
    let _ = writeln!(out, "Rust      tests run with {runner}");
    for line in installs(found, target) {
        let _ = writeln!(out, "Installs  {line}");
    }
    for lack in found.lacks() {
        let steps: Vec<&str> = skipped.iter().filter(|(_, why)| **why == lack.what).map(|(name, _)| *name).collect();
        let _ = writeln!(out, "Skips     {}, for there is {}: {}", steps.join(", "), lack.what, lack.how);
    }
    out
}

/// What is installed, and where.
fn installs(found: &Found, target: &Path) -> Vec<String> {
    let python =
        format!("the packages of crates/maille-py/requirements.lock, by pip, in {}", target.join("python").display());
    let node = "the packages of its package-lock.json, by npm, in crates/maille-view/web/node_modules";
    let browser = "Chromium, by apt-get, in the system";
    let all = [
        (found.python == Ok(false), python.as_str()),
        (found.node == Ok(false), node),
        (found.browser == Ok(false) && found.node.is_ok(), browser),
    ];
    all.into_iter().filter(|(lacking, _)| *lacking).map(|(_, line)| line.to_owned()).collect()
}

/// Steps that will be skipped, with the reason: it is theirs, or that of a step that they need.
fn skipped(steps: &[Step]) -> BTreeMap<&'static str, &str> {
    let mut out: BTreeMap<&'static str, &str> = BTreeMap::new();
    loop {
        let before = out.len();
        for step in steps {
            let reason = step.skip.as_deref().or_else(|| step.needs.iter().find_map(|name| out.get(name).copied()));
            if let Some(reason) = reason {
                out.insert(step.name, reason);
            }
        }
        if out.len() == before {
            return out;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suite::{self, found::Lack};

    fn text_of(found: &Found) -> String {
        let root = Path::new("/repository");
        let steps = suite::tests(root, Path::new("xtask"), found, Kind::Test);
        text(found, &steps, Path::new("/target"), Path::new("/target/xtask"), Kind::Test)
    }

    fn line<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
        text.lines().filter_map(|line| line.strip_prefix(word)).map(str::trim).collect()
    }

    #[test]
    fn what_is_not_there_is_installed() {
        let text = text_of(&Found { nextest: true, python: Ok(false), node: Ok(true), browser: Ok(false) });
        let installs = line(&text, "Installs");
        assert_eq!(installs.len(), 2);
        assert!(
            installs[0].ends_with("requirements.lock, by pip, in /target/python") && installs[1].contains("apt-get")
        );
        assert_eq!(line(&text, "Skips"), [""; 0]);
        assert!(line(&text, "Steps")[0].contains("Chromium, build, "), "{text}");
        assert!(line(&text, "Rust")[0].ends_with("with cargo nextest"));
    }

    #[test]
    fn what_cannot_be_got_skips_all_that_needs_it() {
        let lack = |what: &str| Lack { what: what.into(), how: "get it".into() };
        let found =
            Found { nextest: false, python: Err(lack("no Python")), node: Ok(true), browser: Err(lack("no Chromium")) };
        let text = text_of(&found);
        assert_eq!(
            line(&text, "Skips"),
            [
                "Python environment, Python tests, wheel, for there is no Python: get it",
                "Chromium, browser tests, for there is no Chromium: get it"
            ]
        );
        let steps = line(&text, "Steps")[0];
        assert!(!steps.contains("Python") && steps.contains("Rust tests") && steps.contains("build"), "{steps}");
        assert!(line(&text, "Rust")[0].contains("cargo test"));
        let no_node = Found { nextest: true, python: Ok(true), node: Err(lack("no Node")), browser: Ok(false) };
        let expected = "browser tests, page, types of the page, for there is no Node: get it";
        assert_eq!(line(&text_of(&no_node), "Skips"), [expected]);
        assert_eq!(line(&text_of(&no_node), "Installs"), [""; 0], "no browser that nothing drives");
    }
}
