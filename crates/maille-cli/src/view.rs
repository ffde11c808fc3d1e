//! `maille view`: the viewer in the browser.

use crate::{
    input::Setting,
    numbers::{Numbers, parse, parse_l2},
};
use std::path::PathBuf;

/// See it lock: the sheet, its limits and its locked states in the browser
///
/// Starts a server that only this machine can reach, and opens its page: the sheet in 3D beside its limit map. Wire,
/// spacing, width and the parameters of the file are dragged and solved anew as `characterize` does; designs are drawn,
/// edited, checked and exported.
/// Records, simulations, rolls and sweeps are opened without solving; the page lists those in maille-out, and compares any two.
/// Ctrl-C ends it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille view                              the built-in design 1.1, and a list of the others
  maille view my-weave.toml                a design of your own; the page can save it
  maille view my-weave.toml --set play=1.1  the same with another value for one of its parameters
  maille view maille-out/1.1               a record: its limits, with nothing solved
  maille view maille-out/1.1-simulate      a simulation: its states and its forces
  maille view maille-out/1.1-roll          rolls: a piece of the sheet in each state
  maille view maille-out/radius            a sweep: its first record, and a list of the others
  maille view 3.1 --no-open --port 8080    prints the address alone
  maille view 1.1 --bundle 1.1.html        one file that opens without a server, to send or to publish
  maille view 1.1 --bundle 1.1.html --directions 0:180:5 --l2 -0.125,0,0.125")]
pub struct Args {
    /// A built-in design (see `maille designs`), a TOML file, - for standard input, or the folder of a record, a
    /// simulation, rolls or a sweep
    #[arg(default_value = "1.1")]
    design: String,
    /// A value for a parameter of the design's file, that its slider begins with, as radius=5.0; several with commas
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    set: Vec<Setting>,
    /// Port to listen on [default: a free one]
    #[arg(long, default_value_t = 0, hide_default_value = true, conflicts_with = "bundle")]
    port: u16,
    /// Open no browser
    #[arg(long, conflicts_with = "bundle")]
    no_open: bool,
    /// Write one file that needs no server, with the limits of a record, or of the design at --directions and --l2
    #[arg(long, value_name = "FILE")]
    bundle: Option<PathBuf>,
    #[command(flatten)]
    replace: crate::output::Replace,
    /// Directions of a bundle's map, degrees: a list, or first:last:step
    #[arg(long, default_value = "0:180:15", value_parser = parse, allow_hyphen_values = true)]
    directions: Numbers,
    /// Stretch - 1 held across the pull, of a bundle's map: a list, or first:last:step
    #[arg(long, default_value = "-0.25:0.25:0.125", value_parser = parse_l2, allow_hyphen_values = true)]
    l2: Numbers,
    /// Threads of solves [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

/// Runs the command.
#[cfg(not(feature = "view"))]
pub fn run(_: &Args) -> miette::Result<()> {
    use crate::exit::{USAGE, wrong};
    let help = "build one with\n  cargo xtask view\nin the repository of maille; it needs Node.js 20.19 or later";
    Err(wrong(USAGE, "this program was built without the viewer", help))
}

#[cfg(feature = "view")]
pub use with_viewer::run;

#[cfg(feature = "view")]
mod with_viewer {
    use super::Args;
    use crate::{
        exit::{self, wrong},
        input::{Input, Setting},
        interrupt,
        map::pool,
        output::{self, say},
        progress::Progress,
    };
    use maille_view::{App, Opened, Recorded, ViewError, bundle_file, map_of_bundle, serve, solve_map};
    use miette::{IntoDiagnostic, Report, Result, WrapErr};
    use std::{
        path::Path,
        process::{Command, Stdio},
        sync::atomic::Ordering,
    };

    /// Runs the command.
    pub fn run(args: &Args) -> Result<()> {
        let opened = open(&args.design, &args.set)?;
        if let Some(out) = &args.bundle {
            args.replace.check(out)?;
            return bundle(args, opened, out);
        }
        let folder = std::env::current_dir().into_diagnostic().wrap_err("there is no current folder")?;
        let named = Path::new(&args.design).is_dir().then_some(args.design.as_str());
        let app = App::new(&opened, args.threads.map(usize::from), folder, named).map_err(report)?;
        let stop = interrupt::flag(false)?;
        let ready = |address| {
            let address = format!("http://{address}/");
            say!("{} is at {address}   (Ctrl-C ends it)", opened.name);
            if !args.no_open {
                browse(&address);
            }
        };
        serve(app, args.port, &stop, ready).map_err(report)
    }

    fn open(what: &str, set: &[Setting]) -> Result<Opened> {
        let path = Path::new(what);
        if path.is_dir() {
            if !set.is_empty() {
                let help = "leave --set out, or name the design: its page solves what --set changes";
                return Err(wrong(exit::USAGE, format!("--set is for designs, and {what} is a folder"), help));
            }
            let none = || {
                let help = "give a folder that `maille characterize`, `maille simulate`, `maille roll` or `maille sweep` wrote";
                wrong(exit::RECORD, format!("{what} holds no record, no simulation, no rolls and no sweep"), help)
            };
            return Opened::folder(what, path)?.ok_or_else(none);
        }
        // Wrong names and values are refused as by other commands.
        let input = Input::read_with(what, set, None)?;
        let file = path.is_file().then(|| path.to_owned());
        Ok(Opened {
            name: what.to_owned(),
            file,
            text: input.text().to_owned(),
            parameters: set.iter().map(Setting::pair).collect(),
            record: None,
        })
    }

    fn bundle(args: &Args, mut opened: Opened, out: &Path) -> Result<()> {
        if opened.record.is_none() {
            let input = Input::read_with(&args.design, &args.set, None)?;
            input.compile(&input.design, maille::lattice::Cell::PRIMITIVE)?;
            let map = map_of_bundle(args.directions.0.clone(), args.l2.0.clone()).map_err(report)?;
            let cancel = interrupt::flag(false)?;
            let total = map.question.tasks().len();
            let progress = Progress::new("limits", 0, total, false);
            let record = pool(args.threads)?.install(|| solve_map(&opened, &map, &cancel, &|_| progress.step()));
            progress.finish();
            if cancel.load(Ordering::Relaxed) {
                return Err(wrong(exit::INTERRUPTED, "interrupted", "nothing was written"));
            }
            let source = format!("maille {} of {}", env!("CARGO_PKG_VERSION"), opened.name);
            opened.record = Some((source, Recorded::Limits(Box::new(record.map_err(report)?))));
        }
        let page = bundle_file(&opened).map_err(report)?;
        output::write(out, page.as_bytes())?;
        if !output::is_standard(out) {
            say!("{}  {:.1} MB", out.display(), page.len() as f64 / 1e6);
        }
        Ok(())
    }

    /// Opens the address; where that fails, it is on the screen.
    fn browse(address: &str) {
        let mut command = match std::env::consts::OS {
            "macos" => Command::new("open"),
            "windows" => Command::new("explorer"),
            _ => Command::new("xdg-open"),
        };
        let _ = command.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    }

    fn report(error: ViewError) -> Report {
        match error {
            ViewError::NoPage => {
                let help = "build both with\n  cargo xtask view\nin the repository of maille";
                wrong(exit::USAGE, error.to_string(), help)
            }
            ViewError::Listen { port, source } => {
                wrong(exit::USAGE, format!("cannot listen on port {port}: {source}"), "take another --port, or none")
            }
            ViewError::Refused(refusal) => wrong(exit::DESIGN, refusal.refused.problem, refusal.refused.help),
            error => Report::msg(error.to_string()),
        }
    }
}
