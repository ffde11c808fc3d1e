//! What standard error can show of an error: colours, Unicode, lines drawn at all.

use maille_io::report::Drawing;
use miette::{NarratableReportHandler, ReportHandler};
use std::{
    env,
    io::{IsTerminal, stderr},
};

/// How errors are told: drawn, or in plain sentences with `NO_GRAPHICS=1`, for screen readers.
pub fn handler() -> Box<dyn ReportHandler> {
    match env::var("NO_GRAPHICS") {
        Ok(value) if value != "0" => Box::new(NarratableReportHandler::new()),
        _ => Box::new(Drawing { unicode: shows_unicode(), colours: shows_colours() }),
    }
}

/// Colours are for terminals. `NO_COLOR` and `FORCE_COLOR` decide otherwise, as they do elsewhere.
fn shows_colours() -> bool {
    let forced = match (env::var("FORCE_COLOR"), env::var("CLICOLOR_FORCE")) {
        (Ok(forced), _) => forced != "false" && forced != "0",
        (_, Ok(forced)) => forced != "0",
        _ => false,
    };
    let refused = env::var("NO_COLOR").is_ok_and(|value| value != "0");
    let said = |name| env::var(name).is_ok_and(|value| value != "0");
    let shown = match env::var("TERM") {
        Ok(terminal) => terminal != "dumb" && !(cfg!(windows) && terminal == "cygwin"),
        _ => cfg!(windows) || ["COLORTERM", "CLICOLOR", "CI"].into_iter().any(said),
    };
    forced || !refused && shown && stderr().is_terminal()
}

/// Files and other programs take Unicode; so do terminals that say it.
fn shows_unicode() -> bool {
    let is = |name, value: &str| env::var(name).is_ok_and(|set| set == value);
    if !stderr().is_terminal() {
        return true;
    }
    if cfg!(windows) {
        let modern = ["CI", "WT_SESSION"].into_iter().any(|name| env::var_os(name).is_some());
        return modern || is("TERM_PROGRAM", "vscode") || is("TERM", "xterm-256color") || is("TERM", "alacritty");
    }
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(|name| env::var(name).ok()).unwrap_or_default();
    let locale = locale.to_uppercase();
    !is("TERM", "linux") && (locale.ends_with("UTF8") || locale.ends_with("UTF-8"))
}
